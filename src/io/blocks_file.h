/*
   Files of the blocks of a lattice: .npz or HDF5, with the arrays d (blocks x directions, whole numbers), A (blocks x
   unknowns x unknowns), and if known steps and cell_width, each one number. A matrix of a whole grid that the hook has
   written gives blocks, too, if all cells are alike.
*/
#pragma once
#include "probe/certificates.h"
#include "symbol/blocks.h"

/*
   MpmBlocksRead - reads blocks to every rank. steps: what the user says that they cover, 0 if nothing; it must not
   contradict the file. certificates: what the hook says in the file, with the tolerance of the verdict; none elsewhere.

   Collective. Refuses (PETSC_ERR_USER_INPUT) what is no file of blocks. They are freed with MpmBlocksFree.
*/
PetscErrorCode MpmBlocksRead(MPI_Comm comm, const char path[], PetscInt steps, PetscReal tolerance,
                             MpmCertificates *certificates, MpmBlocks *blocks);

/* Collective. Writes the first rank's blocks; the ending of the name says in which format. */
PetscErrorCode MpmBlocksWrite(const char path[], const MpmBlocks *blocks);
