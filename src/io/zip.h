/* Members of a zip archive: what numpy's .npz needs of it. Not collective: one process reads or writes. */
#pragma once
#include <mpmstab/compat.h>
#include <stdio.h>

#define MPM_ZIP_NAME 48
#define MPM_ZIP_MOST 64 /* members of a file that is read; of one that is written */

/*S
   MpmZipMember - a member: its name, its place and size in the file, its size when unpacked, and its CRC-32.
S*/
typedef struct {
  char       name[MPM_ZIP_NAME];
  unsigned   method, crc;
  PetscInt64 header, packed, size;
} MpmZipMember;

/*
   MpmZipList - lists the members of an archive. wrong: what is wrong with it, or NULL.
   MpmZipRead - unpacks a member into new memory, freed with PetscFree. Checks its CRC.
*/
PetscErrorCode MpmZipList(FILE *stream, int *n, MpmZipMember members[MPM_ZIP_MOST], const char **wrong);
PetscErrorCode MpmZipRead(FILE *stream, const MpmZipMember *member, unsigned char **bytes, const char **wrong);

/*
   MpmZipBegin - writes the header of a member whose bytes are known: its size, and their CRC-32 (MpmZipSum, which goes on
   from the sum of the bytes before; 0 at the first). The bytes follow, as they are.
   MpmZipEnd - writes the list of all members at the end.

   Whoever closes the stream finds what could not be written.
*/
unsigned MpmZipSum(unsigned sum, const void *bytes, size_t n);
void     MpmZipBegin(FILE *stream, MpmZipMember *member);
void     MpmZipEnd(FILE *stream, int n, const MpmZipMember members[]);
