/*
   Files of matrices and of blocks, as other programs write and read them. Read, a format is known by the bytes at the
   file's begin; written, by the ending of its name:

     .mtx        Matrix Market (NIST): text, coordinate or array, real or integer, general, symmetric or skew-symmetric
     .npz        scipy.sparse.save_npz: csr, csc or coo, stored or deflated
     .h5 .hdf5   arrays data, indices, indptr (with format csc by columns), or MATLAB's data, ir, jc
     .petsc      PETSc's binary, of PetscInt with 32 or 64 bits

   Blocks are arrays of .npz or HDF5: d (blocks x directions, whole numbers), A (blocks x unknowns x unknowns), and if
   known steps and cell_width, each one number. A matrix of a whole grid that the hook has written gives blocks, too, if
   all cells are alike.
*/
#pragma once
#include "io/arrays.h"
#include "probe/certificates.h"
#include "scene/request.h"
#include "symbol/blocks.h"
#include <petscmat.h>

#define MPM_MATRIX_ENTRIES 3e8 /* the most that a file may have */

/*
   What the hook says of a matrix in the comments of its Matrix Market file (include/mpmstab_probe.h): how far the
   matrix can be trusted, and where the particles are.

     % steps: 8              that the matrix covers; anybody may write this one
     % numbers: 3            of a particle; unknowns are particle by particle
     % cell_width: 0.0625
     % period: 1 0           of the grid in each direction; 0: none
     % size: 7.6e-06         of the perturbations, in the scales of the fields; in single precision also '% single: 1'
     % moved: 0              and the other certificates
     % scale: 1              of a number of a particle; one comment for each
     % field_scale: 1 found v     of a field, from where it is known, and its name; one comment for each
     % at: 0.015625          a particle's place; one comment for each
*/
#define MPM_HOOKED_NUMBERS 1024 /* of a particle whose scales are kept */

/*S
   MpmHooked - value: of certificates, NaN of those that are not said; other numbers are then 0. x: the places,
   MPM_MAX_DIM numbers a particle, of which the file has place_dim. given: which comments were there.
S*/
typedef struct {
  PetscReal  value[MPM_CERTIFICATES], size, single, numbers, cell_width, period[MPM_MAX_DIM], steps;
  PetscInt   dim, place_dim;
  unsigned   given;
  PetscInt64 places, room, scales;
  PetscReal *x, scale[MPM_HOOKED_NUMBERS];

  PetscInt      nfields;
  MpmFieldScale field[MPM_STEPPER_FIELDS];
} MpmHooked;

/*
   Not collective. MpmHookedBegin - begins with nothing said. MpmHookedFree - frees the places.
   MpmHookedCertificates - gives all ranks what the first one has read. tolerance: of the verdict; single precision has
   a larger one. Collective.
*/
void           MpmHookedBegin(MpmHooked *hooked);
PetscErrorCode MpmHookedFree(MpmHooked *hooked);
PetscErrorCode MpmHookedCertificates(MPI_Comm comm, const MpmHooked *hooked, PetscReal tolerance,
                                     MpmCertificates *certificates);

/*S
   MpmEntries - the entries of a matrix that is read, in any order, with room for a diagonal; those of one place are
   added. Rows and columns count from 0. steps: that the matrix covers; 0: the file does not say. hooked: what the hook
   says of it.
S*/
typedef struct {
  PetscInt64 rows, columns, n, steps;
  PetscInt  *row, *column;
  PetscReal *value;
  MpmHooked  hooked;
} MpmEntries;

/*S
   MpmCsr - a square matrix row by row: those of row i are begin[i] to begin[i + 1], by their columns. The first rank
   has all rows, the others none.
S*/
typedef struct {
  Mat            *whole;
  PetscInt        order;
  const PetscInt *begin, *column;
  PetscReal      *value;
} MpmCsr;

/*
   Not collective. MpmEntriesRoom - makes room, or says why a file with so many may not be; MpmEntriesCheck - says what
   is wrong with entries that are no operator, in why ("": nothing).
*/
PetscErrorCode MpmEntriesRoom(PetscReal rows, PetscReal columns, PetscReal n, MpmEntries *entries,
                              char why[MPM_WHY_TEXT]);
void           MpmEntriesCheck(const MpmEntries *entries, char why[MPM_WHY_TEXT]);
/*
   Not collective. Takes entries to the scales of fields that the hook says, as those of a code that mpmstab itself
   probes.
*/
void MpmEntriesToScales(MpmEntries *entries);

PetscErrorCode MpmEntriesFree(MpmEntries *entries);

/*
   MpmMatrixRead - reads a square matrix from a file. *steps: on entry what the user says that it covers, 0 if nothing;
   on return what the user or the file says, else 1. certificates: what the hook says in the file; none are taken
   elsewhere.

   Collective. Errors: refuses (PETSC_ERR_USER_INPUT) what is no finite square matrix in one of the formats, and steps
   that contradict the file's.
*/
PetscErrorCode MpmMatrixRead(MPI_Comm comm, const char path[], PetscReal tolerance, PetscInt *steps,
                             MpmCertificates *certificates, Mat *A);

/*
   MpmMatrixWrite - writes an AIJ matrix, times 2^exponent, that covers so many steps.

   Collective. The file appears whole or not at all. kept: whether the format has a place for the steps.
*/
PetscErrorCode MpmMatrixWrite(const char path[], Mat A, PetscInt exponent, PetscInt steps, PetscBool *kept);

/*
   MpmBlocksRead - reads blocks to every rank. steps: what the user says that they cover, 0 if nothing; it must not
   contradict the file. certificates: what the hook says in the file, with the tolerance of the verdict; none elsewhere.

   Collective. Refuses (PETSC_ERR_USER_INPUT) what is no file of blocks. They are freed with MpmBlocksFree.
*/
PetscErrorCode MpmBlocksRead(MPI_Comm comm, const char path[], PetscInt steps, PetscReal tolerance,
                             MpmCertificates *certificates, MpmBlocks *blocks);

/* Collective. Writes the first rank's blocks; the ending of the name says in which format. */
PetscErrorCode MpmBlocksWrite(const char path[], const MpmBlocks *blocks);

/* Not collective: the first rank reads and writes single formats. */
PetscErrorCode MpmMatrixReadText(FILE *stream, MpmEntries *entries, char why[MPM_WHY_TEXT]);
PetscErrorCode MpmMatrixReadPetsc(FILE *stream, MpmEntries *entries, char why[MPM_WHY_TEXT]);
void           MpmMatrixWriteText(const MpmCsr *csr, PetscInt steps, FILE *stream);
void           MpmMatrixWritePetsc(const MpmCsr *csr, FILE *stream);
