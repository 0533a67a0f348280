/*
   Arrays and attributes in HDF5: the first rank writes, each rank reads.

   After a write that fails, an HDF5 file cannot be closed, and the library crashes when the program ends. So the disk
   is asked to grant room before HDF5 writes. When it does not, HDF5 is asked for nothing more.
*/
#define _GNU_SOURCE /* fallocate */
#include "base/hdf5.h"
#include <mpmstab/errors.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define PIECE 4194304 /* bytes that a rank sends at a time */
#define TAG 77
#define SLACK 65536 /* bytes that HDF5 may need beside the numbers of one array */

/* Walks through the descriptions in HDF5's error stack and copies the one that has the system's reason. */
static herr_t FindReason(unsigned n, const H5E_error2_t *error, void *context)
{
  static const char mark[] = "error message = '";
  const char       *said   = error->desc ? strstr(error->desc, mark) : NULL;
  char             *why    = context;

  (void)n;
  if (said && !why[0]) {
    (void)PetscStrncpy(why, said + strlen(mark), sizeof((MpmHdf5 *)0)->why);
    why[strcspn(why, "'")] = '\0';
  }
  return 0;
}

/* Notes a failure of an HDF5 call, which returns a negative number. */
static hid_t Try(MpmHdf5 *f, hid_t result)
{
  if (result >= 0 || f->failed) return result;
  f->failed = PETSC_TRUE;
  (void)H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, FindReason, f->why);
  if (!f->why[0]) (void)PetscStrncpy(f->why, "HDF5 failed", sizeof f->why);
  return result;
}

/*
   Comes before HDF5's first call, which reads the variable. Its locks are switched off. Some file systems do not have
   them, and they are not needed: no other program uses the temporary name of a file that is being written. Links to
   other files are not followed: a file that is read must not open others, of which one may be a pipe that never ends.
*/
static PetscErrorCode Prepare(void)
{
  PetscFunctionBegin;
  (void)setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  PetscCheck(H5Eset_auto2(H5E_DEFAULT, NULL, NULL) >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "HDF5 cannot be kept silent");
  (void)H5Lunregister(H5L_TYPE_EXTERNAL); /* fails where it has been done already */
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Begin(MPI_Comm comm, MpmHdf5 *f)
{
  PetscFunctionBegin;
  *f = (MpmHdf5){.comm = comm, .file = -1, .descriptor = -1};
  PetscCall(Prepare());
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsWriter(const MpmHdf5 *f)
{
  return MpmRankOf(f->comm) == 0 ? PETSC_TRUE : PETSC_FALSE;
}

static void Fail(MpmHdf5 *f, int error)
{
  if (f->failed) return;
  f->failed = PETSC_TRUE;
  (void)PetscStrncpy(f->why, strerror(error), sizeof f->why);
}

/*
   Reserves room on the disk for so many more bytes and HDF5's own data. A file system that cannot reserve room is
   trusted to have it.
*/
static void Reserve(MpmHdf5 *f, PetscInt64 bytes)
{
  hsize_t       size = 0;
  struct rlimit limit;

  if (f->failed || Try(f, H5Fget_filesize(f->file, &size)) < 0) return;
  bytes += (PetscInt64)size + SLACK;
  if (bytes <= f->reserved) return;
  if (!getrlimit(RLIMIT_FSIZE, &limit) && limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur < (rlim_t)bytes)
    Fail(f, EFBIG);
  else if (fallocate(f->descriptor, FALLOC_FL_KEEP_SIZE, 0, (off_t)bytes) && errno != EOPNOTSUPP && errno != ENOSYS)
    Fail(f, errno);
  else
    f->reserved = bytes;
}

PetscErrorCode MpmHdf5Create(MPI_Comm comm, const char path[], PetscInt reserved, MpmHdf5 *f)
{
  hid_t creation;

  PetscFunctionBegin;
  PetscCall(Begin(comm, f));
  if (!IsWriter(f)) PetscFunctionReturn(PETSC_SUCCESS);
  f->descriptor = open(path, O_WRONLY | O_CLOEXEC);
  if (f->descriptor < 0 || fallocate(f->descriptor, FALLOC_FL_KEEP_SIZE, 0, SLACK + reserved)) {
    if (f->descriptor < 0 || (errno != EOPNOTSUPP && errno != ENOSYS)) Fail(f, errno);
    if (f->failed) PetscFunctionReturn(PETSC_SUCCESS);
  }
  creation = Try(f, H5Pcreate(H5P_FILE_CREATE));
  (void)Try(f, H5Pset_userblock(creation, (hsize_t)reserved));
  f->file = Try(f, H5Fcreate(path, H5F_ACC_TRUNC, creation, H5P_DEFAULT));
  (void)Try(f, H5Pclose(creation));
  Reserve(f, 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHdf5Is(const char path[], PetscBool *is)
{
  PetscFunctionBegin;
  PetscCall(Prepare());
  *is = H5Fis_hdf5(path) > 0 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHdf5Open(MPI_Comm comm, const char path[], MpmHdf5 *f)
{
  PetscFunctionBegin;
  PetscCall(Begin(comm, f));
  f->file = Try(f, H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first rank that has failed tells the others why. */
static PetscErrorCode Agree(MpmHdf5 *f, PetscBool *failed)
{
  const PetscMPIInt size = MpmRanksOf(f->comm);
  PetscMPIInt       first;

  PetscFunctionBegin;
  first = f->failed ? MpmRankOf(f->comm) : size;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, f->comm));
  *failed = first < size ? PETSC_TRUE : PETSC_FALSE;
  if (*failed) PetscCallMPI(MPI_Bcast(f->why, sizeof f->why, MPI_CHAR, first, f->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHdf5Failed(MpmHdf5 *f, PetscBool *failed)
{
  unsigned intent = H5F_ACC_RDONLY;

  PetscFunctionBegin;
  if (f->file >= 0) (void)Try(f, H5Fget_intent(f->file, &intent));
  if (intent & H5F_ACC_RDWR) (void)Try(f, H5Fflush(f->file, H5F_SCOPE_LOCAL));
  PetscCall(Agree(f, failed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Closes the file. Reserved room that was not needed goes back to the disk. */
PetscErrorCode MpmHdf5Close(MpmHdf5 *f, PetscBool *failed)
{
  PetscFunctionBegin;
  if (f->file >= 0) (void)Try(f, H5Fclose(f->file));
  f->file = -1;
  if (f->descriptor >= 0) {
    const off_t size = lseek(f->descriptor, 0, SEEK_END);

    if (size < 0 || ftruncate(f->descriptor, size) || close(f->descriptor)) Fail(f, errno);
    f->descriptor = -1;
  }
  PetscCall(Agree(f, failed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MOST_DIMENSIONS 4

/* An array: its number of dimensions and its extents, of which the first is the number of rows. */
typedef struct {
  hid_t   type;
  int     n;
  hsize_t extent[MOST_DIMENSIONS];
} Shape;

/* Writes rows [begin, begin + n) of an array that the first rank has open. */
static void WriteRows(MpmHdf5 *f, hid_t array, const Shape *shape, PetscInt64 begin, PetscInt64 n, const void *values)
{
  hsize_t offset[MOST_DIMENSIONS] = {(hsize_t)begin}, count[MOST_DIMENSIONS] = {(hsize_t)n};
  hid_t   space, memory;

  if (n == 0 || f->failed) return;
  for (int d = 1; d < shape->n; d++) count[d] = shape->extent[d];
  space  = Try(f, H5Dget_space(array));
  memory = Try(f, H5Screate_simple(shape->n, count, NULL));
  (void)Try(f, H5Sselect_hyperslab(space, H5S_SELECT_SET, offset, NULL, count, NULL));
  (void)Try(f, H5Dwrite(array, shape->type, memory, space, H5P_DEFAULT, values));
  (void)Try(f, H5Sclose(memory));
  (void)Try(f, H5Sclose(space));
}

static hid_t CreateArray(MpmHdf5 *f, const char name[], const Shape *shape, size_t width)
{
  hid_t array, space, links;

  Reserve(f, (PetscInt64)(shape->extent[0] * width));
  if (f->failed) return -1;
  space = Try(f, H5Screate_simple(shape->n, shape->extent, NULL));
  links = Try(f, H5Pcreate(H5P_LINK_CREATE));
  (void)Try(f, H5Pset_create_intermediate_group(links, 1));
  array = Try(f, H5Dcreate2(f->file, name, shape->type, space, links, H5P_DEFAULT, H5P_DEFAULT));
  (void)Try(f, H5Pclose(links));
  (void)Try(f, H5Sclose(space));
  return array;
}

static PetscErrorCode SendRows(MpmHdf5 *f, PetscInt64 rows, size_t width, const char *values)
{
  const PetscInt64 piece = PetscMax(1, PIECE / (PetscInt64)width);

  PetscFunctionBegin;
  for (PetscInt64 done = 0; done < rows; done += piece)
    PetscCallMPI(MPI_Send(values + (size_t)done * width, (int)((size_t)PetscMin(piece, rows - done) * width), MPI_BYTE,
                          0, TAG, f->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Writes the rows that the other ranks send. It receives them even after a failure, since the other ranks send them
   anyway.
*/
static PetscErrorCode WriteReceived(MpmHdf5 *f, hid_t array, const Shape *shape, size_t width, PetscMPIInt ranks,
                                    const PetscInt64 rows[])
{
  const PetscInt64 piece  = PetscMax(1, PIECE / (PetscInt64)width);
  PetscInt64       before = rows[0];
  char            *values;

  PetscFunctionBegin;
  if (ranks == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1((size_t)piece * width, &values));
  for (PetscMPIInt r = 1; r < ranks; r++) {
    for (PetscInt64 done = 0; done < rows[r]; done += piece) {
      const PetscInt64 n = PetscMin(piece, rows[r] - done);

      PetscCallMPI(MPI_Recv(values, (int)((size_t)n * width), MPI_BYTE, r, TAG, f->comm, MPI_STATUS_IGNORE));
      WriteRows(f, array, shape, before + done, n, values);
    }
    before += rows[r];
  }
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHdf5WriteRows(MpmHdf5 *f, const char name[], hid_t type, PetscInt64 rows, PetscInt n,
                                const PetscInt row[], const void *part)
{
  Shape             shape = {.type = type, .n = 1 + n};
  size_t            width = H5Tget_size(type);
  const PetscMPIInt size  = MpmRanksOf(f->comm);
  PetscInt64       *all;
  hid_t             array;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < n; d++) {
    shape.extent[1 + d] = (hsize_t)row[d];
    width *= (size_t)row[d];
  }
  PetscCall(PetscCalloc1(size, &all));
  PetscCallMPI(MPI_Gather(&rows, 1, MPIU_INT64, all, 1, MPIU_INT64, 0, f->comm));
  if (MpmRankOf(f->comm) == 0) {
    for (PetscMPIInt r = 0; r < size; r++) shape.extent[0] += (hsize_t)all[r];
    array = CreateArray(f, name, &shape, width);
    WriteRows(f, array, &shape, 0, rows, part);
    PetscCall(WriteReceived(f, array, &shape, width, size, all));
    if (array >= 0) (void)Try(f, H5Dclose(array));
  } else
    PetscCall(SendRows(f, rows, width, part));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHdf5Write(MpmHdf5 *f, const char name[], hid_t type, PetscInt64 rows, PetscInt columns,
                            const void *part)
{
  return MpmHdf5WriteRows(f, name, type, rows, columns > 1, &columns, part);
}

static void WriteAttribute(MpmHdf5 *f, const char object[], const char name[], hid_t type, const void *value)
{
  hid_t space, attribute;

  if (IsWriter(f)) Reserve(f, 0);
  if (!IsWriter(f) || f->failed) return;
  space     = Try(f, H5Screate(H5S_SCALAR));
  attribute = Try(f, H5Acreate_by_name(f->file, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  (void)Try(f, H5Awrite(attribute, type, value));
  if (attribute >= 0) (void)Try(f, H5Aclose(attribute));
  (void)Try(f, H5Sclose(space));
}

void MpmHdf5WriteText(MpmHdf5 *f, const char object[], const char name[], const char text[])
{
  hid_t type;

  type = Try(f, H5Tcopy(H5T_C_S1));
  (void)Try(f, H5Tset_size(type, strlen(text) + 1));
  WriteAttribute(f, object, name, type, text);
  (void)Try(f, H5Tclose(type));
}

void MpmHdf5WriteReal(MpmHdf5 *f, const char object[], const char name[], PetscReal value)
{
  WriteAttribute(f, object, name, H5T_NATIVE_DOUBLE, &value);
}

void MpmHdf5WriteInteger(MpmHdf5 *f, const char object[], const char name[], PetscInt value)
{
  WriteAttribute(f, object, name, sizeof value == sizeof(int) ? H5T_NATIVE_INT : H5T_NATIVE_LLONG, &value);
}

PetscBool MpmHdf5Has(const MpmHdf5 *f, const char name[])
{
  return f->file >= 0 && H5Lexists(f->file, name, H5P_DEFAULT) > 0 ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmHdf5ReadAttribute(const MpmHdf5 *f, const char object[], const char name[], hid_t memory, void *value)
{
  const hid_t attribute = H5Aopen_by_name(f->file, object, name, H5P_DEFAULT, H5P_DEFAULT);
  hid_t       space, type;
  PetscBool   ok;

  if (attribute < 0) return PETSC_FALSE;
  space = H5Aget_space(attribute);
  type  = H5Aget_type(attribute);
  ok    = H5Sget_simple_extent_npoints(space) == 1 && H5Tis_variable_str(type) <= 0 &&
               (H5Tget_class(type) == H5Tget_class(memory) ||
                (H5Tget_class(type) == H5T_INTEGER && H5Tget_class(memory) == H5T_FLOAT)) &&
               H5Aread(attribute, memory, value) >= 0
              ? PETSC_TRUE
              : PETSC_FALSE;
  (void)H5Tclose(type);
  (void)H5Sclose(space);
  (void)H5Aclose(attribute);
  return ok;
}

/* Opens an array whose numbers are in this file; -1: there is none. */
static hid_t OpenArray(const MpmHdf5 *f, const char name[])
{
  const hid_t array   = H5Dopen2(f->file, name, H5P_DEFAULT);
  const hid_t made    = array < 0 ? -1 : H5Dget_create_plist(array);
  const int   is_here = made >= 0 && H5Pget_layout(made) != H5D_VIRTUAL && H5Pget_external_count(made) == 0;

  if (made >= 0) (void)H5Pclose(made);
  if (array >= 0 && !is_here) (void)H5Dclose(array);
  return is_here ? array : -1;
}

#define DENSEST 1100 /* filters pack at most about so many bytes into one */
#define MOST_DIMS 32 /* of HDF5 */

/*
   Opens an array of numbers of the class of type, or where that is negative of any, in at most room dimensions. Returns
   -1 when there is no such array, or when it claims more than the file can hold.
*/
static hid_t Find(const MpmHdf5 *f, const char name[], hid_t type, int room, int *dims, PetscInt64 shape[])
{
  const hid_t array = MpmHdf5Has(f, name) ? OpenArray(f, name) : -1, space = array < 0 ? -1 : H5Dget_space(array),
              has             = array < 0 ? -1 : H5Dget_type(array);
  const H5T_class_t class     = has < 0 ? H5T_NO_CLASS : H5Tget_class(has);
  hsize_t   extent[MOST_DIMS] = {0}, bytes = 0;
  PetscReal claimed = array < 0 ? 0 : (PetscReal)H5Tget_size(has) / DENSEST;
  PetscBool ok;

  if (array < 0) return -1;
  *dims = H5Sget_simple_extent_ndims(space);
  ok    = *dims >= 0 && *dims <= room && H5Sget_simple_extent_dims(space, extent, NULL) == *dims &&
               (type < 0 ? class == H5T_INTEGER || class == H5T_FLOAT : class == H5Tget_class(type)) &&
               H5Fget_filesize(f->file, &bytes) >= 0
              ? PETSC_TRUE
              : PETSC_FALSE;
  for (int d = 0; d < *dims && ok; d++) {
    shape[d] = (PetscInt64)extent[d];
    claimed *= (PetscReal)extent[d];
  }
  (void)H5Tclose(has);
  (void)H5Sclose(space);
  if (ok && claimed <= (PetscReal)bytes) return array;
  (void)H5Dclose(array);
  return -1;
}

PetscErrorCode MpmHdf5Length(MpmHdf5 *f, const char name[], hid_t type, PetscInt64 *length)
{
  int         dims  = 0;
  const hid_t array = Find(f, name, type, 1, &dims, length);

  PetscFunctionBegin;
  if (array < 0 || dims != 1) *length = -1;
  if (array >= 0) (void)Try(f, H5Dclose(array));
  PetscCallMPI(MPI_Bcast(length, 1, MPIU_INT64, 0, f->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmHdf5Read(MpmHdf5 *f, const char name[], hid_t type, PetscInt64 begin, PetscInt64 n, void *part)
{
  const hsize_t offset = (hsize_t)begin, count = (hsize_t)n;
  PetscInt64    length = 0;
  int           dims   = 0;
  hid_t         array, space, memory;

  if (n == 0) return;
  array = Find(f, name, type, 1, &dims, &length);
  if (array < 0 || dims != 1 || begin + n > length) f->failed = PETSC_TRUE;
  space  = Try(f, H5Dget_space(array));
  memory = Try(f, H5Screate_simple(1, &count, NULL));
  (void)Try(f, H5Sselect_hyperslab(space, H5S_SELECT_SET, &offset, NULL, &count, NULL));
  (void)Try(f, H5Dread(array, type, memory, space, H5P_DEFAULT, part));
  if (memory >= 0) (void)H5Sclose(memory);
  if (space >= 0) (void)H5Sclose(space);
  if (array >= 0) (void)H5Dclose(array);
}

PetscBool MpmHdf5Array(const MpmHdf5 *f, const char name[], int room, int *dims, PetscInt64 shape[])
{
  const hid_t array = Find(f, name, -1, room, dims, shape);

  if (array >= 0) (void)H5Dclose(array);
  return array >= 0 ? PETSC_TRUE : PETSC_FALSE;
}

void MpmHdf5ReadArray(MpmHdf5 *f, const char name[], PetscReal numbers[])
{
  hid_t array;

  array = Try(f, OpenArray(f, name));
  (void)Try(f, H5Dread(array, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers));
  if (array >= 0) (void)H5Dclose(array);
}

PetscBool MpmHdf5ReadText(const MpmHdf5 *f, const char object[], const char name[], size_t room, char text[])
{
  const hid_t attribute = H5Aopen_by_name(f->file, object, name, H5P_DEFAULT, H5P_DEFAULT);
  hid_t       type, space, memory;
  char       *variable = NULL;
  PetscBool   ok;

  text[0] = '\0';
  if (attribute < 0) return PETSC_FALSE;
  type   = H5Aget_type(attribute);
  space  = H5Aget_space(attribute);
  memory = H5Tcopy(H5T_C_S1);
  ok = H5Tget_class(type) == H5T_STRING && H5Sget_simple_extent_npoints(space) == 1 && H5Tset_size(memory, room) >= 0
           ? PETSC_TRUE
           : PETSC_FALSE;
  if (ok && H5Tis_variable_str(type) > 0) {
    ok = H5Aread(attribute, type, &variable) >= 0 && variable ? PETSC_TRUE : PETSC_FALSE;
    if (ok) (void)PetscStrncpy(text, variable, room);
    (void)H5free_memory(variable);
  } else if (ok)
    ok = H5Aread(attribute, memory, text) >= 0 ? PETSC_TRUE : PETSC_FALSE;
  text[room - 1] = '\0';
  (void)H5Tclose(memory);
  (void)H5Tclose(type);
  (void)H5Sclose(space);
  (void)H5Aclose(attribute);
  return ok;
}

PetscBool MpmHdf5Group(const MpmHdf5 *f, PetscInt i, size_t room, char name[])
{
  const ssize_t length =
      f->file < 0 ? -1
                  : H5Lget_name_by_idx(f->file, "/", H5_INDEX_NAME, H5_ITER_INC, (hsize_t)i, name, room, H5P_DEFAULT);
  hid_t object;

  if (length < 0) return PETSC_FALSE;
  object = (size_t)length < room ? H5Oopen(f->file, name, H5P_DEFAULT) : -1;
  if (object < 0 || H5Iget_type(object) != H5I_GROUP) name[0] = '\0';
  if (object >= 0) (void)H5Oclose(object);
  return PETSC_TRUE;
}
