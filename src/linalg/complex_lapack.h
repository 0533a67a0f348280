/* Names of LAPACK's and BLAS's complex routines: PETSc with real scalars wraps the real ones only. */
#pragma once
#include <mpmstab/compat.h>
#include <petscblaslapack.h>

#if defined(PETSC_BLASLAPACK_CAPS)
#define MPM_LAPACK(name, NAME) NAME
#elif defined(PETSC_BLASLAPACK_UNDERSCORE)
#define MPM_LAPACK(name, NAME) name##_
#else
#define MPM_LAPACK(name, NAME) name
#endif
