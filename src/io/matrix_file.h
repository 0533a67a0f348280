/*
   Files of matrices and of blocks, as other programs write and read them. Read, a format is known by the bytes at the
   file's begin; written, by the ending of its name:

     .mtx        Matrix Market (NIST): text, coordinate or array, real or integer, general, symmetric or skew-symmetric
     .npz        scipy.sparse.save_npz: csr, csc or coo, stored or deflated
     .h5 .hdf5   arrays data, indices, indptr (with format csc by columns), or MATLAB's data, ir, jc
     .petsc      PETSc's binary, of PetscInt with 32 or 64 bits
*/
#pragma once
#include "io/matrix_csr.h"
#include "scene/request.h"

/*
   MpmMatrixRead - reads a square matrix from a file. *steps: on entry what the user says that it covers, 0 if nothing; on
   return what the user or the file says, else 1. certificates: what the hook says in the file; none are taken elsewhere.

   Collective. Errors: refuses (PETSC_ERR_USER_INPUT) what is no finite square matrix in one of the formats, and steps that
   contradict the file's.
*/
PetscErrorCode MpmMatrixRead(MPI_Comm comm, const char path[], PetscReal tolerance, PetscInt *steps,
                             MpmCertificates *certificates, Mat *A);

/*
   MpmMatrixWrite - writes an AIJ matrix, times 2^exponent, that covers so many steps.

   Collective. The file appears whole or not at all. kept: whether the format has a place for the steps.
*/
PetscErrorCode MpmMatrixWrite(const char path[], Mat A, PetscInt exponent, PetscInt steps, PetscBool *kept);

/* Not collective: the first rank reads and writes single formats. */
PetscErrorCode MpmMatrixReadText(FILE *stream, MpmEntries *entries, char why[MPM_WHY_TEXT]);
PetscErrorCode MpmMatrixReadPetsc(FILE *stream, MpmEntries *entries, char why[MPM_WHY_TEXT]);
void           MpmMatrixWriteText(const MpmCsr *csr, PetscInt steps, FILE *stream);
void           MpmMatrixWritePetsc(const MpmCsr *csr, FILE *stream);
