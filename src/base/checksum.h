/*
   Checksum: the first bytes of a file hold a sum over the rest, by which a reader knows that the file is whole before
   it looks at it.
*/
#pragma once
#include <mpmstab/compat.h>

#define MPM_CHECKSUM_BYTES 512

/*
   MpmChecksumWrite - sums up what follows the first MPM_CHECKSUM_BYTES of a file, and writes kind, size and sum there.

   Collective; ranks share the reading. error: the first rank's errno, on all ranks; 0 when all of the file is on the disk.
*/
PetscErrorCode MpmChecksumWrite(MPI_Comm comm, const char path[], int *error);

/*
   MpmChecksumCheck - whether a file begins with a checksum, and whether its bytes have that sum.

   Collective. why: what is wrong, in words that follow 'checkpoint PATH: ', or empty.
*/
PetscErrorCode MpmChecksumCheck(MPI_Comm comm, const char path[], size_t room, char why[]);
