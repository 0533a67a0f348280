/* The one place that knows about differences between versions of PETSc, and between compilers. */
#pragma once
#include <petscsys.h>

/* PETSc 3.18 has no name for 'no error'; 3.19 gave it one. */
#ifndef PETSC_SUCCESS
#define PETSC_SUCCESS 0
#endif

/* 'Leave it as it is' for KSPSetTolerances(): named so by 3.22, which deprecates the old name, PETSC_DEFAULT. */
#ifndef PETSC_CURRENT
#define PETSC_CURRENT PETSC_DEFAULT
#endif

/* C11's, which glibc's complex.h has for gcc alone. */
#ifdef __clang__
#define CMPLX(re, im) __builtin_complex((double)(re), (double)(im))
#endif
