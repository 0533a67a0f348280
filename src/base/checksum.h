/*
   Checksum: the first bytes of a file hold a sum over the rest. With it a reader knows that the file is whole before it
   uses the contents.
*/
#pragma once
#include <mpmstab/compat.h>

#define MPM_CHECKSUM_BYTES 512

/*
   MpmChecksumWrite - sums up what follows the first MPM_CHECKSUM_BYTES of a file, and writes its kind, size and sum
   there.

   Collective; each rank reads a part of the file. error: the errno of the first rank, on all ranks; it is 0 when all of
   the file is on the disk.
*/
PetscErrorCode MpmChecksumWrite(MPI_Comm comm, const char path[], int *error);

/*
   MpmChecksumCheck - checks that a file begins with a checksum and that its bytes have this sum.

   Collective. why: what is wrong, in words that follow 'checkpoint PATH: '; empty when nothing is wrong. room: the size
   of why in bytes.
*/
PetscErrorCode MpmChecksumCheck(MPI_Comm comm, const char path[], size_t room, char why[]);
