/* Names of the complex routines of LAPACK and BLAS: PETSc with real scalars wraps only the real ones. */
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
