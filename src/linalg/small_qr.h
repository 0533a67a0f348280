/*
   The eigenvalues of one small complex matrix after another. For a matrix of order 4 LAPACK's zgeev mostly calls its own
   parts, and takes three times as long as these loops; at order 144 it takes twice as long.
*/
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>

#define MPM_SMALL_QR_MOST 192 /* the largest order */

/*
   MpmSmallQr - computes the eigenvalues of a matrix. LAPACK balances it, Householder's reflections take it to Hessenberg form,
   and QR steps with Wilkinson's shift take that to triangular form.

   Not collective.

   Input Parameters:
+  n - the order
-  a - the matrix by columns, all of its numbers finite; it is overwritten

   Output Parameters:
+  value - the eigenvalues
-  ok    - false where the steps have not converged, as for zgeev's info > 0; value is then not set

   Sources: Golub and Van Loan 2013, 'Matrix Computations', section 7.5; Ahues and Tisseur 1997 (LAPACK Working Note 122)
   for when a number below the diagonal counts as 0; Parlett and Reinsch 1969 for the balance.
*/
void MpmSmallQr(PetscInt n, double complex a[], double complex value[], PetscBool *ok);
