/*
   Names of routines of LAPACK and BLAS that PETSc with real scalars does not wrap: the complex ones and some real ones.
*/
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>
#include <petscblaslapack.h>

#if defined(PETSC_BLASLAPACK_CAPS)
#define MPM_LAPACK(name, NAME) NAME
#elif defined(PETSC_BLASLAPACK_UNDERSCORE)
#define MPM_LAPACK(name, NAME) name##_
#else
#define MPM_LAPACK(name, NAME) name
#endif

#define MPM_ZGESV MPM_LAPACK(zgesv, ZGESV)
#define MPM_ZGEMM MPM_LAPACK(zgemm, ZGEMM)

extern void MPM_ZGESV(const PetscBLASInt *n, const PetscBLASInt *nrhs, double complex *a, const PetscBLASInt *lda,
                      PetscBLASInt *ipiv, double complex *b, const PetscBLASInt *ldb, PetscBLASInt *info);
extern void MPM_ZGEMM(const char *transa, const char *transb, const PetscBLASInt *m, const PetscBLASInt *n,
                      const PetscBLASInt *k, const double complex *alpha, const double complex *a,
                      const PetscBLASInt *lda, const double complex *b, const PetscBLASInt *ldb,
                      const double complex *beta, double complex *c, const PetscBLASInt *ldc);
