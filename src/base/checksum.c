/*
   The checksum of a file of 64-bit words w_i is

     sum over i of mix(w_i + (i + 1) g)   modulo 2^64

   mix is the output function of splitmix64, and g is its increment (Steele, Lea and Flood 2014). The sum does not
   depend on the order of its terms, so each rank sums up a part of the file.
*/
#include "base/checksum.h"
#include "base/hash.h"
#include "base/textfile.h"
#include <mpmstab/errors.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FORMAT 1
#define CHUNK 65536 /* words */

static const char header[] = "mpmstab checkpoint\nformat %d\nbytes %lld\nsum %llx\n";

/* Adds up the words [begin, end) that follow the checksum. The last word of the file is filled up with zeros. */
static int SumWords(FILE *file, long long begin, long long end, uint64_t *sum)
{
  static uint64_t word[CHUNK];

  if (fseeko(file, MPM_CHECKSUM_BYTES + 8 * begin, SEEK_SET)) return errno;
  while (begin < end) {
    const size_t n = (size_t)PetscMin(end - begin, CHUNK);

    memset(word, 0, sizeof word);
    if (fread(word, 1, 8 * n, file) < 8 * n && ferror(file)) return errno ? errno : EIO;
    for (size_t i = 0; i < n; i++)
      *sum += MpmHashMix(word[i] + (uint64_t)(begin + (long long)i + 1) * MPM_HASH_INCREMENT);
    begin += (long long)n;
  }
  return 0;
}

/* Sums up the whole file; each rank reads its part. */
static PetscErrorCode Sum(MPI_Comm comm, const char path[], long long *bytes, uint64_t *sum, int *error)
{
  const PetscMPIInt rank = MpmRankOf(comm), size = MpmRanksOf(comm);
  struct stat       is;
  FILE             *file = fopen(path, "rb");

  PetscFunctionBegin;
  *sum   = 0;
  *bytes = 0;
  *error = file ? 0 : errno;
  if (file) {
    if (fstat(fileno(file), &is))
      *error = errno;
    else {
      const long long words = PetscMax((long long)is.st_size - MPM_CHECKSUM_BYTES + 7, 0) / 8;

      *bytes = (long long)is.st_size;
      *error = SumWords(file, words * rank / size, words * (rank + 1) / size, sum);
    }
    fclose(file);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sum, 1, MPI_UINT64_T, MPI_SUM, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, error, 1, MPI_INT, MPI_MAX, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the checksum to the first bytes and waits until all of the file is on the disk. */
static int Stamp(const char path[], const char text[])
{
  FILE *file  = fopen(path, "r+b");
  int   error = 0;

  if (!file) return errno;
  if (fwrite(text, 1, MPM_CHECKSUM_BYTES, file) != MPM_CHECKSUM_BYTES || fflush(file) || fsync(fileno(file)))
    error = errno ? errno : EIO;
  if (fclose(file) && !error) error = errno;
  return error;
}

PetscErrorCode MpmChecksumWrite(MPI_Comm comm, const char path[], int *error)
{
  char      text[MPM_CHECKSUM_BYTES] = "";
  uint64_t  sum;
  long long bytes;

  PetscFunctionBegin;
  PetscCall(Sum(comm, path, &bytes, &sum, error));
  if (*error) PetscFunctionReturn(PETSC_SUCCESS);
  snprintf(text, sizeof text, header, FORMAT, bytes, (unsigned long long)sum);
  if (MpmRankOf(comm) == 0) *error = Stamp(path, text);
  PetscCallMPI(MPI_Bcast(error, 1, MPI_INT, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rank 0 reads the first bytes and sends them to all ranks. Behind the end of a short file text holds zeros. */
static PetscErrorCode ReadFirstBytes(MPI_Comm comm, const char path[], char text[], int *error)
{
  PetscFunctionBegin;
  memset(text, 0, MPM_CHECKSUM_BYTES + 1);
  *error = 0;
  if (MpmRankOf(comm) == 0) {
    FILE *file = MpmFileOpen(path, error);

    if (file) {
      if (fread(text, 1, MPM_CHECKSUM_BYTES, file) < MPM_CHECKSUM_BYTES && ferror(file)) *error = errno ? errno : EIO;
      fclose(file);
    }
  }
  PetscCallMPI(MPI_Bcast(error, 1, MPI_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(text, MPM_CHECKSUM_BYTES + 1, MPI_CHAR, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmChecksumCheck(MPI_Comm comm, const char path[], size_t room, char why[])
{
  char               text[MPM_CHECKSUM_BYTES + 1];
  int                error, format = 0, fields;
  long long          said     = 0, bytes;
  unsigned long long said_sum = 0;
  uint64_t           sum;

  PetscFunctionBegin;
  why[0] = '\0';
  PetscCall(ReadFirstBytes(comm, path, text, &error));
  fields = sscanf(text, header, &format, &said, &said_sum);
  if (error)
    snprintf(why, room, "cannot be read: %s", MpmFileReason(error));
  else if (fields < 1)
    snprintf(why, room, "not a checkpoint");
  else if (format != FORMAT)
    snprintf(why, room, "of format %d, where this program reads format %d", format, FORMAT);
  else if (fields < 3)
    snprintf(why, room, "damaged: its first line is not whole");
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Sum(comm, path, &bytes, &sum, &error));
  if (error)
    snprintf(why, room, "cannot be read: %s", MpmFileReason(error));
  else if (bytes != said)
    snprintf(why, room, "damaged: it has %lld bytes of %lld", bytes, said);
  else if (sum != said_sum)
    snprintf(why, room, "damaged: its bytes do not have the checksum that it was written with");
  PetscFunctionReturn(PETSC_SUCCESS);
}
