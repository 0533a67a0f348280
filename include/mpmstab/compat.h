/* Differences between versions of PETSc, and between compilers. No other file knows of them. */
#pragma once
#include <petscsys.h>

/* PETSc 3.18 has no name for 'no error'; 3.19 gave it one. */
#ifndef PETSC_SUCCESS
#define PETSC_SUCCESS 0
#endif

/* KSPSetTolerances() leaves a tolerance as it is for PETSC_CURRENT. PETSc before 3.22 calls it PETSC_DEFAULT. */
#ifndef PETSC_CURRENT
#define PETSC_CURRENT PETSC_DEFAULT
#endif

/* CMPLX is C11. glibc's complex.h defines it for gcc alone. */
#ifdef __clang__
#define CMPLX(re, im) __builtin_complex((double)(re), (double)(im))
#endif
