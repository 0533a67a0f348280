/*
   Mode files: eigenvectors of an operator are written, and a run takes its initial data from them. What is read is
   checked first, by the first rank alone; whatever it finds, all ranks refuse together.
*/
#include "base/textfile.h"
#include "io/mode_file.h"
#include "march/march_private.h"
#include "scene/fields.h"
#include "scene/layout.h"
#include <mpmstab/errors.h>
#include <mpmstab/verdict.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define WRITTEN "allowed: a file that 'mpmstab spectrum -output' has written"

typedef struct {
  const MpmScene *scene;
  MpmHdf5         file;
  char            why[1024]; /* "": nothing is wrong */
} Check;

/* Names the group of the file that holds the scene's mode. */
static void NameGroup(const MpmScene *scene, char group[], size_t room)
{
  (void)snprintf(group, room, "/modes/%04" PetscInt_FMT, scene->mode[0]);
}

/* Keeps the first fault, since the refusal names only one. */
#define Wrong(c, ...) (void)((c)->why[0] || snprintf((c)->why, sizeof(c)->why, __VA_ARGS__))

static void SameText(Check *c, const char name[], const char mine[])
{
  char their[MPM_COUNTS_TEXT];

  if (!MpmHdf5ReadText(&c->file, "/", name, sizeof their, their))
    Wrong(c, "no %s in it; " WRITTEN, name);
  else if (strcmp(mine, their))
    Wrong(c, "its %s is %s, the scene's is %s; allowed: the same", name, their, mine);
}

static void SameNumber(Check *c, const char name[], PetscReal mine)
{
  double theirs = NAN;

  if (!MpmHdf5ReadAttribute(&c->file, "/", name, H5T_NATIVE_DOUBLE, &theirs))
    Wrong(c, "no %s in it; " WRITTEN, name);
  else if (theirs != mine)
    Wrong(c, "its %s is %.17g, the scene's is %.17g; allowed: the same", name, theirs, mine);
}

static void SameCount(Check *c, const char name[], PetscInt mine)
{
  long long theirs = 0;

  if (!MpmHdf5ReadAttribute(&c->file, "/", name, H5T_NATIVE_LLONG, &theirs))
    Wrong(c, "no %s in it; " WRITTEN, name);
  else if (theirs != mine)
    Wrong(c, "its %s is %lld, the scene's is %" PetscInt_FMT "; allowed: the same", name, theirs, mine);
}

/* Compares the value of direction a. */
static void SameValue(Check *c, const MpmValue *mine, PetscInt a)
{
  MpmAttribute of[2];
  PetscInt     n;

  MpmValueAttributes(mine, a, &n, of);
  for (PetscInt i = 0; i < n; i++) {
    if (of[i].kind == MPM_AS_COUNT)
      SameCount(c, of[i].name, of[i].count);
    else if (of[i].kind == MPM_AS_REAL)
      SameNumber(c, of[i].name, of[i].number);
    else
      SameText(c, of[i].name, of[i].text);
  }
}

static PetscErrorCode SameScene(Check *c)
{
  MpmValue mine[MPM_MAX_VALUES];
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(MpmValuesIn(MPM_IN_MODE_FILE, c->scene, NULL, &n, mine));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt a = 0; a < mine[i].n; a++) SameValue(c, &mine[i], a);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks a field of the mode: it needs as many numbers as there are particles, all of them finite. */
static PetscErrorCode Field(Check *c, const char group[], const char field[], const char part[], PetscReal *largest)
{
  const PetscInt64 n = c->scene->layout.particles;
  char             name[128];
  PetscInt64       length;
  double          *values;

  PetscFunctionBegin;
  (void)snprintf(name, sizeof name, "%s/%s_%s", group, field, part);
  PetscCall(MpmHdf5Length(&c->file, name, H5T_NATIVE_DOUBLE, &length));
  if (length != n) {
    Wrong(c, "%s is not %" PetscInt64_FMT " numbers; " WRITTEN, name, n);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscCalloc1(n, &values));
  MpmHdf5Read(&c->file, name, H5T_NATIVE_DOUBLE, 0, n, values);
  if (c->file.failed) Wrong(c, "%s cannot be read; " WRITTEN, name);
  for (PetscInt64 i = 0; i < n && !c->why[0]; i++) {
    if (!isfinite(values[i])) Wrong(c, "%s holds a value that is not finite; " WRITTEN, name);
    *largest = PetscMax(*largest, fabs(values[i]));
  }
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Mode(Check *c)
{
  PetscReal largest = 0;
  double    growth;
  char      group[64];

  PetscFunctionBegin;
  NameGroup(c->scene, group, sizeof group);
  if (!MpmHdf5ReadAttribute(&c->file, group, "growth", H5T_NATIVE_DOUBLE, &growth))
    Wrong(c, "it does not hold mode %" PetscInt_FMT "; allowed: one of those that 'mpmstab spectrum -modes' has kept",
          c->scene->mode[0]);
  for (PetscInt f = 0; c->scene->scheme.table->fields[f] && !c->why[0]; f++) {
    PetscCall(Field(c, group, c->scene->scheme.table->fields[f], "re", &largest));
    PetscCall(Field(c, group, c->scene->scheme.table->fields[f], "im", &largest));
  }
  if (largest == 0) Wrong(c, "mode %" PetscInt_FMT " is zero; " WRITTEN, c->scene->mode[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Examine(Check *c, const char path[])
{
  PetscBool failed;
  int       error;
  FILE     *file = MpmFileOpen(path, &error);

  PetscFunctionBegin;
  if (!file) {
    Wrong(c, "cannot be read; " WRITTEN);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  fclose(file);
  PetscCall(MpmHdf5Open(PETSC_COMM_SELF, path, &c->file));
  if (c->file.failed) {
    Wrong(c, H5Fis_hdf5(path) > 0 ? "cut short or damaged; " WRITTEN : "not an HDF5 file; " WRITTEN);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(SameScene(c));
  if (!c->why[0]) PetscCall(Mode(c));
  PetscCall(MpmHdf5Close(&c->file, &failed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileCheck(const MpmScene *scene, const char path[])
{
  Check check = {.scene = scene};

  PetscFunctionBegin;
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) PetscCall(Examine(&check, path));
  PetscCallMPI(MPI_Bcast(check.why, sizeof check.why, MPI_CHAR, 0, PETSC_COMM_WORLD));
  MpmCheckInput(!check.why[0], "mode_file %s: %s", path, check.why);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- reading, after the check ---- */

/* Closes the file. It was whole when the program began, but somebody may have changed it since. */
static PetscErrorCode CloseRead(const char path[], MpmHdf5 *file)
{
  PetscBool failed;

  PetscFunctionBegin;
  PetscCall(MpmHdf5Close(file, &failed));
  MpmCheckInput(!failed, "mode_file %s: cannot be read any more; allowed: a file that stays as it is", path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileGrowth(const MpmScene *scene, const char path[], PetscReal *growth)
{
  MpmHdf5 file;
  char    group[64];

  PetscFunctionBegin;
  NameGroup(scene, group, sizeof group);
  PetscCall(MpmHdf5Open(PETSC_COMM_WORLD, path, &file));
  if (!MpmHdf5ReadAttribute(&file, group, "growth", H5T_NATIVE_DOUBLE, growth)) file.failed = PETSC_TRUE;
  PetscCall(CloseRead(path, &file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads one field's real or imaginary part at this rank's particles. The file holds it in the order of global ids. */
static PetscErrorCode ReadField(const MpmScene *scene, MpmHdf5 *file, const char name[], const MpmParticles *particles,
                                PetscReal values[])
{
  PetscInt          begin, end;
  PetscReal        *part;
  const PetscInt64 *id;
  PetscInt         *rows;
  const PetscReal  *a;
  Vec               by_id, mine;
  IS                where;
  VecScatter        scatter;

  PetscFunctionBegin;
  PetscCall(VecCreateMPI(file->comm, PETSC_DECIDE, (PetscInt)scene->layout.particles, &by_id));
  PetscCall(VecGetOwnershipRange(by_id, &begin, &end));
  PetscCall(VecGetArray(by_id, &part));
  MpmHdf5Read(file, name, H5T_NATIVE_DOUBLE, begin, end - begin, part);
  PetscCall(VecRestoreArray(by_id, &part));
  PetscCall(PetscMalloc1(particles->count, &rows));
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  for (PetscInt p = 0; p < particles->count; p++) rows[p] = (PetscInt)id[p];
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, particles->count, rows, PETSC_OWN_POINTER, &where));
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, particles->count, &mine));
  PetscCall(VecScatterCreate(by_id, where, mine, NULL, &scatter));
  PetscCall(VecScatterBegin(scatter, by_id, mine, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(scatter, by_id, mine, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArrayRead(mine, &a));
  PetscCall(PetscArraycpy(values, a, particles->count));
  PetscCall(VecRestoreArrayRead(mine, &a));
  PetscCall(VecScatterDestroy(&scatter));
  PetscCall(ISDestroy(&where));
  PetscCall(VecDestroy(&mine));
  PetscCall(VecDestroy(&by_id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads all fields of one part ("re" or "im") into the particles, and finds the largest number among them. */
static PetscErrorCode ReadPart(const MpmScene *scene, MpmHdf5 *file, const char part[], MpmParticles *particles,
                               PetscReal *largest)
{
  char group[64], name[128];

  PetscFunctionBegin;
  NameGroup(scene, group, sizeof group);
  *largest = 0;
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++) {
    PetscReal *q;

    (void)snprintf(name, sizeof name, "%s/%s_%s", group, scene->scheme.table->fields[f], part);
    PetscCall(MpmParticlesGet(particles, scene->scheme.table->fields[f], &q));
    PetscCall(ReadField(scene, file, name, particles, q));
    for (PetscInt p = 0; p < particles->count; p++) *largest = PetscMax(*largest, fabs(q[p]));
    PetscCall(MpmParticlesRestore(particles, scene->scheme.table->fields[f], &q));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 1, MPIU_REAL, MPI_MAX, file->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileFill(const char path[], MpmMarch *march)
{
  const MpmScene *scene     = march->scene;
  MpmParticles   *particles = march->particles;
  PetscReal       largest, imaginary;
  MpmHdf5         file;

  PetscFunctionBegin;
  PetscCall(MpmHdf5Open(PetscObjectComm((PetscObject)particles->swarm), path, &file));
  PetscCall(ReadPart(scene, &file, "im", particles, &imaginary));
  PetscCall(ReadPart(scene, &file, "re", particles, &largest));
  if (imaginary > largest) PetscCall(ReadPart(scene, &file, "im", particles, &largest));
  PetscCall(CloseRead(path, &file));
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++) {
    PetscReal *q;

    PetscCall(MpmParticlesGet(particles, scene->scheme.table->fields[f], &q));
    for (PetscInt p = 0; p < particles->count; p++) q[p] *= scalbn(scene->amplitude, -(int)march->exponent) / largest;
    PetscCall(MpmParticlesRestore(particles, scene->scheme.table->fields[f], &q));
  }
  PetscCall(MpmMarchStart(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- writing ---- */

static void WriteEigenvalue(const MpmOperator *op, const MpmEigen *eigen, PetscInt j, MpmDataFile *file)
{
  const PetscReal re = scalbn(eigen->re[j], (int)op->exponent), im = scalbn(eigen->im[j], (int)op->exponent);
  const PetscReal growth = MpmGrowthPerStep(hypot(eigen->re[j], eigen->im[j]), op->exponent, op->period);
  char            group[64];

  (void)snprintf(group, sizeof group, "/modes/%04" PetscInt_FMT, j + 1);
  MpmHdf5WriteReal(&file->hdf5, group, "re", re);
  MpmHdf5WriteReal(&file->hdf5, group, "im", im);
  MpmHdf5WriteReal(&file->hdf5, group, "growth", growth);
}

/* Writes the particles' starting places, over which a mode's values can be plotted: a row of dim numbers for each. */
static PetscErrorCode WriteCoordinates(const MpmLayout *layout, PetscReal cell_width, MpmDataFile *file)
{
  const PetscInt    dim  = layout->dim;
  const PetscMPIInt rank = MpmRankOf(file->hdf5.comm);
  PetscReal        *x;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(rank ? 0 : dim * layout->particles, &x));
  for (PetscInt64 id = 0; id < layout->particles && rank == 0; id++) {
    MpmLayoutRest(layout, id, &x[dim * id]);
    for (PetscInt a = 0; a < dim; a++) x[dim * id + a] *= cell_width;
  }
  PetscCall(MpmDataFileArray(file, "/modes", "coordinates", (PetscInt)layout->particles, dim, x));
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* fields: the names of the parts of a vector; NULL: it is a whole, in the order of its rows. */
static PetscErrorCode WriteModes(const MpmOperator *op, const char *const fields[], const MpmEigen *eigen,
                                 PetscInt count, MpmDataFile *file)
{
  static const char *const parts[] = {"re", "im"};
  Vec                      x[2], field = NULL;
  char                     name[128];

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(eigen->A, &x[0], &x[1]));
  if (fields) PetscCall(MatCreateVecs(op->p2g, &field, NULL));
  for (PetscInt j = 0; j < PetscMin(count, eigen->n); j++) {
    PetscCall(MpmEigenVector(eigen, j, x[0], x[1]));
    PetscCall(MpmOperatorToState(op, x[0], x[1]));
    for (PetscInt f = 0; f < (fields ? op->fields : 1); f++) {
      for (int part = 0; part < 2; part++) {
        if (fields) PetscCall(VecSetBlockSize(x[part], op->fields));
        if (fields) PetscCall(VecStrideGather(x[part], f, field, INSERT_VALUES));
        (void)snprintf(name, sizeof name, "/modes/%04" PetscInt_FMT "/%s_%s", j + 1, fields ? fields[f] : "vector",
                       parts[part]);
        PetscCall(MpmDataFileVector(file, name, 0, NULL, fields ? field : x[part]));
      }
    }
    WriteEigenvalue(op, eigen, j, file);
  }
  PetscCall(VecDestroy(&x[0]));
  PetscCall(VecDestroy(&x[1]));
  PetscCall(VecDestroy(&field));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModesWrite(const MpmOperator *op, PetscReal cell_width, const MpmEigen *eigen, PetscInt count,
                             MpmDataFile *file)
{
  PetscFunctionBegin;
  if (PetscMin(count, eigen->n) > 0) PetscCall(WriteCoordinates(op->layout, cell_width, file));
  PetscCall(WriteModes(op, op->scheme->table->fields, eigen, count, file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmVectorsWrite(const MpmOperator *op, const MpmEigen *eigen, PetscInt count, MpmDataFile *file)
{
  return WriteModes(op, NULL, eigen, count, file);
}
