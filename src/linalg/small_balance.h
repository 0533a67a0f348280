/* The balance of a small complex matrix: what stands alone is set aside, and rows and columns get about the same size. */
#pragma once
#include "linalg/small_columns.h"

/*
   MpmSmallBalance - permutes rows and columns so that those outside lo .. hi are triangular, and scales those inside by
   powers of two. Eigenvalues stay the same.

   Not collective.

   Input Parameters:
+  n - the order
-  a - the matrix by columns, as in small_columns.h; it is overwritten

   Output Parameters: lo, hi - the rows and columns whose eigenvalues are not on the diagonal yet; there are none where hi < lo

   Source: Parlett and Reinsch 1969.
*/
void MpmSmallBalance(PetscInt n, PetscReal a[], PetscInt *lo, PetscInt *hi);
