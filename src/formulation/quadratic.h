/* The larger root of an amplification polynomial. */
#pragma once
#include <petscsys.h>
#include <complex.h>

/* Not collective. max abs(G) over the roots of G^2 - trace G + det = 0. */
PetscReal MpmQuadraticRadius(double complex trace, double complex det);
