/* Names of routines of LAPACK and BLAS that PETSc with real scalars does not wrap: the complex ones and some real ones. */
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
