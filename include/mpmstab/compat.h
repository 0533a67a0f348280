/* The one place that knows about differences between PETSc versions. */
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
