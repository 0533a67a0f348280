/* The one place that knows about differences between PETSc versions. */
#pragma once
#include <petscsys.h>

/* PETSc 3.18 has no name for 'no error'. */
#ifndef PETSC_SUCCESS
#define PETSC_SUCCESS 0
#endif
