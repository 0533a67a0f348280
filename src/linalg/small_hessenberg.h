/* The Hessenberg form of a small complex matrix. */
#pragma once
#include "linalg/small_columns.h"

/*
   MpmSmallHessenberg - takes rows and columns lo .. hi to Hessenberg form by Householder's reflections.

   Not collective.

   Input Parameters:
+  n      - the order
.  a      - the matrix by columns, as in small_columns.h; it is overwritten
-  lo, hi - rows and columns outside of these are triangular

   Each reflection changes the whole matrix by a product of two columns with two rows. This is done in the same loop that
   multiplies the next reflection's vector by the matrix, so that every number is taken from memory once a reflection.

   Sources: Golub and Van Loan 2013, 'Matrix Computations', section 7.4.2; Van Zee, van de Geijn, Quintana-Orti and Elizondo
   2012, 'Families of algorithms for reducing a matrix to condensed form', for the one loop.
*/
void MpmSmallHessenberg(PetscInt n, PetscReal a[], PetscInt lo, PetscInt hi);
