/*
   Zip archives without encryption and below 4 GiB. Members are stored, or deflated by zlib's way. The format is that of
   PKWARE's APPNOTE 6.3: headers before the members, and a directory of all at the end.
*/
#include "io/zip.h"
#include <string.h>
#include <zlib.h>

#define END_SIGNATURE 0x06054b50u
#define LIST_SIGNATURE 0x02014b50u
#define MEMBER_SIGNATURE 0x04034b50u
#define END_SIZE 22
#define LIST_SIZE 46
#define MEMBER_SIZE 30
#define LONGEST_NOTE 65535 /* that may follow the directory */
#define STORED 0
#define DEFLATED 8
#define DENSEST 1100 /* deflate packs at most so many bytes into one */
#define TOO_LARGE 0xffffffffu
#define DAY 33 /* 1 January 1980, the first day that zip knows: a file does not depend on when it was written */

static unsigned Get2(const unsigned char *b)
{
  return b[0] | (unsigned)b[1] << 8;
}

static unsigned Get4(const unsigned char *b)
{
  return Get2(b) | Get2(b + 2) << 16;
}

static PetscBool ReadAt(FILE *stream, PetscInt64 at, size_t n, unsigned char *bytes)
{
  return !fseeko(stream, (off_t)at, SEEK_SET) && fread(bytes, 1, n, stream) == n ? PETSC_TRUE : PETSC_FALSE;
}

/* Finds the record at the end, which says where the directory is. */
static PetscErrorCode FindEnd(FILE *stream, PetscInt64 size, unsigned *members, PetscInt64 *list, PetscBool *found)
{
  const PetscInt64 room = PetscMin(size, END_SIZE + LONGEST_NOTE);
  unsigned char   *tail;

  PetscFunctionBegin;
  *found = PETSC_FALSE;
  PetscCall(PetscMalloc1((size_t)room, &tail));
  if (ReadAt(stream, size - room, (size_t)room, tail)) {
    for (PetscInt64 i = room - END_SIZE; i >= 0 && !*found; i--) {
      if (Get4(tail + i) != END_SIGNATURE) continue;
      *found   = PETSC_TRUE;
      *members = Get2(tail + i + 10);
      *list    = Get4(tail + i + 16);
    }
  }
  PetscCall(PetscFree(tail));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmZipList(FILE *stream, int *n, MpmZipMember members[MPM_ZIP_MOST], const char **wrong)
{
  PetscInt64 size, at;
  unsigned   listed = 0;
  PetscBool  found;

  PetscFunctionBegin;
  *n     = 0;
  *wrong = "it is cut off, or no zip archive";
  if (fseeko(stream, 0, SEEK_END)) PetscFunctionReturn(PETSC_SUCCESS);
  size = (PetscInt64)ftello(stream);
  PetscCall(FindEnd(stream, size, &listed, &at, &found));
  if (!found) PetscFunctionReturn(PETSC_SUCCESS);
  for (unsigned i = 0; i < listed && *n < MPM_ZIP_MOST; i++) {
    MpmZipMember *m = &members[*n];
    unsigned char entry[LIST_SIZE];
    size_t        length;

    if (!ReadAt(stream, at, LIST_SIZE, entry) || Get4(entry) != LIST_SIGNATURE) PetscFunctionReturn(PETSC_SUCCESS);
    length = Get2(entry + 28);
    *m     = (MpmZipMember){.method = Get2(entry + 10),
                            .crc    = Get4(entry + 16),
                            .packed = Get4(entry + 20),
                            .size   = Get4(entry + 24),
                            .header = Get4(entry + 42)};
    if (length < MPM_ZIP_NAME && fread(m->name, 1, length, stream) == length) (*n)++;
    at += LIST_SIZE + (PetscInt64)length + Get2(entry + 30) + Get2(entry + 32);
  }
  *wrong = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool Inflate(unsigned char *packed, PetscInt64 from, unsigned char *bytes, PetscInt64 to)
{
  z_stream z = {.next_in = packed, .avail_in = (uInt)from, .next_out = bytes, .avail_out = (uInt)to};
  int      result;

  if (inflateInit2(&z, -MAX_WBITS) != Z_OK) return PETSC_FALSE; /* negative: without zlib's own header */
  result = inflate(&z, Z_FINISH);
  (void)inflateEnd(&z);
  return result == Z_STREAM_END && z.total_out == (uLong)to ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmZipRead(FILE *stream, const MpmZipMember *m, unsigned char **bytes, const char **wrong)
{
  unsigned char header[MEMBER_SIZE], *packed = NULL;
  PetscInt64    size;
  PetscBool     ok;

  PetscFunctionBegin;
  *bytes = NULL;
  *wrong = "one of its arrays is compressed in a way that is not known; allowed: stored or deflated, as numpy does";
  if (m->method != STORED && m->method != DEFLATED) PetscFunctionReturn(PETSC_SUCCESS);
  *wrong = "one of its arrays is larger than 4 GiB; allowed: HDF5 for it";
  if (m->packed == TOO_LARGE || m->size == TOO_LARGE || m->header == TOO_LARGE) PetscFunctionReturn(PETSC_SUCCESS);
  *wrong = "it is cut off, or damaged";
  if (fseeko(stream, 0, SEEK_END)) PetscFunctionReturn(PETSC_SUCCESS);
  size = (PetscInt64)ftello(stream);
  if (m->packed > size || m->size > DENSEST * m->packed || (m->method == STORED && m->size != m->packed) ||
      !ReadAt(stream, m->header, MEMBER_SIZE, header) || Get4(header) != MEMBER_SIGNATURE)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1((size_t)m->packed + 1, &packed));
  ok = ReadAt(stream, m->header + MEMBER_SIZE + Get2(header + 26) + Get2(header + 28), (size_t)m->packed, packed);
  if (ok && m->method == DEFLATED) {
    PetscCall(PetscMalloc1((size_t)m->size + 1, bytes));
    ok = Inflate(packed, m->packed, *bytes, m->size);
    PetscCall(PetscFree(packed));
  } else
    *bytes = packed;
  if (ok && MpmZipSum(0, *bytes, (size_t)m->size) == m->crc)
    *wrong = NULL;
  else
    PetscCall(PetscFree(*bytes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

unsigned MpmZipSum(unsigned sum, const void *bytes, size_t n)
{
  return (unsigned)crc32_z(sum, bytes, n);
}

static void Put2(FILE *stream, unsigned value)
{
  (void)fputc((int)(value & 255), stream);
  (void)fputc((int)(value >> 8 & 255), stream);
}

static void Put4(FILE *stream, unsigned value)
{
  Put2(stream, value & 65535);
  Put2(stream, value >> 16);
}

/* What headers and the directory say alike, from the version of zip on. */
static void PutMember(FILE *stream, const MpmZipMember *m)
{
  Put2(stream, 20);
  Put2(stream, 0);
  Put2(stream, STORED);
  Put2(stream, 0);
  Put2(stream, DAY);
  Put4(stream, m->crc);
  Put4(stream, (unsigned)m->size);
  Put4(stream, (unsigned)m->size);
  Put2(stream, (unsigned)strlen(m->name));
  Put2(stream, 0);
}

void MpmZipBegin(FILE *stream, MpmZipMember *m)
{
  m->header = (PetscInt64)ftello(stream);
  Put4(stream, MEMBER_SIGNATURE);
  PutMember(stream, m);
  (void)fputs(m->name, stream);
}

void MpmZipEnd(FILE *stream, int n, const MpmZipMember members[])
{
  const PetscInt64 begin = (PetscInt64)ftello(stream);
  PetscInt64       end;

  for (int i = 0; i < n; i++) {
    Put4(stream, LIST_SIGNATURE);
    Put2(stream, 20);
    PutMember(stream, &members[i]);
    Put2(stream, 0);
    Put2(stream, 0);
    Put2(stream, 0);
    Put4(stream, 0);
    Put4(stream, (unsigned)members[i].header);
    (void)fputs(members[i].name, stream);
  }
  end = (PetscInt64)ftello(stream);
  Put4(stream, END_SIGNATURE);
  Put4(stream, 0);
  Put2(stream, (unsigned)n);
  Put2(stream, (unsigned)n);
  Put4(stream, (unsigned)(end - begin));
  Put4(stream, (unsigned)begin);
  Put2(stream, 0);
}
