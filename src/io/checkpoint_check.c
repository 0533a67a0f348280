/*
   Checks of a checkpoint: that its bytes are those that were written, by a checksum; that what all ranks hold is of the
   scene, and possible; and particles and nodes after they are read.
*/
#include "analysis/run.h"
#include "base/hash.h"
#include "base/textfile.h"
#include "io/checkpoint_file.h"
#include "march/diagnostics.h"
#include <mpmstab/errors.h>
#include "scene/fields.h"
#include "scene/layout.h"
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/*
   The checksum of a file of 64-bit words w_i is

     sum over i of mix(w_i + (i + 1) g)   modulo 2^64

   mix is the output function of splitmix64, and g is its increment (Steele, Lea and Flood 2014). The sum does not
   depend on the order of its terms, so each rank sums up a part of the file.
*/

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

/* ---- whether a run can have written what was read: a file with a right checksum may have been made by hand ---- */

/* A step changes the exponent by at most this much, since doubles lie between 2^-1074 and 2^1024. */
#define MOST_EXPONENT 1100

#define Allow(condition, path, what)                                                                                   \
  MpmCheckInput(condition, "checkpoint %s: %s; allowed: one that 'mpmstab run' has written", path, what)

/* Finds the text of one key among lines 'name text'. Returns NULL when there is no such line. */
static char *FieldIn(const char scene[], const char name[], size_t room, char text[])
{
  const size_t length = strlen(name);

  for (const char *line = scene; *line; line++) {
    const size_t end = strcspn(line, "\n");

    if (!strncmp(line, name, length) && line[length] == ' ') {
      const size_t n = PetscMin(end - length - 1, room - 1);

      memcpy(text, line + length + 1, n);
      text[n] = '\0';
      return text;
    }
    line += end;
    if (!*line) break;
  }
  return NULL;
}

/* Whether a field is among the values. */
static PetscBool IsAmong(const char name[], PetscInt n, const MpmValue values[])
{
  for (PetscInt i = 0; i < n; i++)
    if (!strcmp(values[i].field->name, name)) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscErrorCode CompareScenes(const MpmScene *scene, const MpmCheckpoint *file)
{
  MpmValue  values[MPM_MAX_VALUES];
  char      text[MPM_COUNTS_TEXT], mine[MPM_COUNTS_TEXT];
  PetscInt  n;
  PetscBool agrees = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(MpmValuesIn(MPM_IN_CHECKPOINT, scene, NULL, &n, values));
  for (PetscInt f = 0; f < n; f++) {
    const char *name = values[f].field->name, *has = FieldIn(file->scene, name, sizeof text, text);

    if (has) PetscCall(MpmValueAgrees(&values[f], has, &agrees));
    PetscCall(MpmValueText(&values[f], sizeof mine, mine));
    MpmCheckInput(has && agrees,
                  "checkpoint %s: its %s is %s, the scene's is %s; allowed: the scene that it is of, but for steps, "
                  "tolerance, expectations and files",
                  file->path, name, has ? has : "not there", mine);
  }
  for (const MpmField *o = MpmOptions; o->name; o++)
    MpmCheckInput(IsAmong(o->name, n, values) || !FieldIn(file->scene, o->name, sizeof text, text),
                  "checkpoint %s: its %s is %s, the scene has none; allowed: the scene that it is of, but for steps, "
                  "tolerance, expectations and files",
                  file->path, o->name, text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks the step first, before anything is computed from it. */
static PetscErrorCode CheckStep(const MpmScene *scene, PetscInt64 steps, const MpmCheckpoint *file)
{
  const PetscInt64 step = file->where[MPM_AT_STEP], places = MpmSceneMoves(scene) ? step : 0;

  PetscFunctionBegin;
  MpmCheckInput(step <= steps,
                "checkpoint %s: is at step %" PetscInt64_FMT " of %" PetscInt64_FMT "; allowed: as many steps or more",
                file->path, step, steps);
  Allow(step >= 0, file->path, "its step is negative");
  Allow(file->where[MPM_AT_PLACES] == places, file->path, "its particles are at another step");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks the other counters; the step has been checked. Particles may be ahead of the cells in which they are stored,
   by less than the whole grid.
*/
static PetscErrorCode CheckWhere(const MpmScene *scene, const MpmCheckpoint *file)
{
  const PetscInt64 *where = file->where, step = where[MPM_AT_STEP];
  const PetscInt64  most = PetscMin(MOST_EXPONENT * (step + 1), PETSC_MAX_INT / 2);

  PetscFunctionBegin;
  for (PetscInt a = 0; a < scene->layout.dim; a++) {
    const PetscBool  drifts = scene->step.drift[a].value != 0 && !scene->scheme.space.finite ? PETSC_TRUE : PETSC_FALSE;
    const PetscInt64 slack  = drifts ? scene->layout.grid[a].cells : 0;
    const PetscInt64 has    = where[MpmAtRebased(a)];
    PetscInt64       cells  = 0;
    PetscReal        part;

    if (drifts) MpmFractionMultiple(&scene->step.drift[a], where[MPM_AT_PLACES], &cells, &part);
    Allow(has >= cells - slack && has <= cells + slack, file->path,
          "its particles have not drifted as the scene's have");
  }
  Allow(where[MPM_AT_EXPONENT] >= -most && where[MPM_AT_EXPONENT] <= most, file->path,
        "its exponent is none that so many steps lead to");
  Allow(where[MPM_AT_BLEW_UP] >= MPM_NEVER && where[MPM_AT_BLEW_UP] <= step, file->path,
        "it blew up after its own step");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The norm of a state that has vanished has the logarithm -inf; any other logarithm is finite. */
static PetscBool IsLogarithm(PetscReal value, PetscReal most)
{
  return value <= most && (value >= -most || isinf(value)) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode CheckSeries(const MpmCheckpoint *file)
{
  const PetscReal most = MOST_EXPONENT * ((PetscReal)file->where[MPM_AT_STEP] + 2);

  PetscFunctionBegin;
  Allow(file->samples <= PETSC_MAX_INT / 2, file->path, "its series is too long");
  for (PetscInt64 i = 0; i < file->samples; i++) {
    const PetscInt64 before = i ? file->sample_step[i - 1] : -1;

    Allow(file->sample_step[i] > before && file->sample_step[i] <= file->where[MPM_AT_STEP], file->path,
          "the steps of its series are not in order");
    Allow(IsLogarithm(file->log_state[i], most) && IsLogarithm(file->log_grid[i], most), file->path,
          "its series has a number that is no logarithm of a norm");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckRanks(const MpmScene *scene, const MpmCheckpoint *file)
{
  PetscInt64 left = scene->layout.particles;

  PetscFunctionBegin;
  for (PetscInt64 r = 0; r < file->ranks; r++) {
    Allow(file->rank_particles[r] >= 0 && file->rank_particles[r] <= left, file->path,
          "its ranks' particles do not add up to the scene's");
    left -= file->rank_particles[r];
  }
  Allow(left == 0, file->path, "its ranks' particles do not add up to the scene's");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCheckpointCheckRun(const MpmScene *scene, PetscInt64 steps, const MpmCheckpoint *file)
{
  PetscFunctionBegin;
  PetscCall(CompareScenes(scene, file));
  PetscCall(CheckStep(scene, steps, file));
  PetscCall(CheckWhere(scene, file));
  PetscCall(CheckSeries(file));
  PetscCall(CheckRanks(scene, file));
  Allow((PetscInt64)strlen(file->csv) == file->csv_length, file->path, "its CSV is not text");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCheckpointCheckPace(const MpmCheckpoint *file)
{
  const PetscReal *pace = file->pace;

  PetscFunctionBegin;
  Allow(pace[MPM_PACE_ELAPSED] >= 0 && isfinite(pace[MPM_PACE_ELAPSED]), file->path, "its time is out of range");
  Allow(pace[MPM_PACE_COURANT] > 0 && isfinite(pace[MPM_PACE_COURANT]), file->path, "its last step is out of range");
  for (PetscInt i = MPM_PACE_HOLDS; i < MPM_PACE_CHANGES; i++)
    Allow(isfinite(pace[i]) && (i > MPM_PACE_HOLDS + 1 || pace[i] > 0), file->path,
          "what it knows of steps is out of range");
  for (PetscInt i = MPM_PACE_CHANGES; i < MPM_PACE_NUMBERS; i++)
    Allow(pace[i] >= 0 && pace[i] <= (PetscReal)file->where[MPM_AT_STEP], file->path,
          "it counts more steps than it has taken");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCheckpointCheckWatch(const MpmCheckpoint *file)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < MPM_PACE_HELD; i++)
    Allow(isfinite(file->watch[i]), file->path, "what it knows of steps is out of range");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks that particles are less than the march's slack away from their cells, at this step and the next, so that none
   is beyond the ghost layer.
*/
static PetscErrorCode CheckSlack(const MpmMarch *march, const char path[])
{
  PetscInt  whole[2];
  PetscReal part;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < march->layout->dim; a++) {
    for (int i = 0; i < 2; i++)
      PetscCall(MpmParticlesWhere(march->particles, a, march->particles->step + i, &whole[i], &part));
    if (march->slack)
      Allow(PetscMax(PetscAbsInt(whole[0]), PetscAbsInt(whole[1])) < march->slack, path,
            "its particles have drifted too far from their cells");
    else
      Allow(!MpmMarchDrifts(march) || whole[0] == 0, path, "its particles have drifted from their cells");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks that each id is there once: all ids are in range, and the sum of a hash over them is the same as over all ids
   of the scene.
*/
static PetscErrorCode CheckIds(const MpmMarch *march, const char path[])
{
  const PetscInt64  n   = march->particles->total;
  uint64_t          sum = 0, beyond = 0, sums[2];
  const PetscInt64 *id;
  MPI_Comm          comm = PetscObjectComm((PetscObject)march->grid->da);
  const PetscMPIInt rank = MpmRankOf(comm), size = MpmRanksOf(comm);

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  for (PetscInt p = 0; p < march->particles->count; p++) {
    if (id[p] < 0 || id[p] >= n) beyond++;
    sum += (uint64_t)(0x1p53 * MpmHash(1, id[p]));
  }
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  for (PetscInt64 i = n * rank / size; i < n * (rank + 1) / size; i++) sum -= (uint64_t)(0x1p53 * MpmHash(1, i));
  sums[0] = sum;
  sums[1] = beyond;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_UINT64_T, MPI_SUM, comm));
  Allow(!sums[0] && !sums[1], path, "its particles are not those of the scene");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Counts the particles that are where none can be along an axis. A particle must be within its cell. The cell must be
   in this rank's part of the grid, or in the grid if another rank wrote it. Drift may have moved the particle away from
   its cell by less than slack, and so may its own velocity have done. A cell of -1 belongs to a particle that drift had
   already moved into cell 0. In one dimension particles must be in the order of their cells, since passes rely on it.
*/
static PetscErrorCode CountMisplaced(const MpmMarch *march, PetscBool same, PetscInt a, PetscInt64 *bad)
{
  const MpmGridAxis *axis    = &march->grid->axis[a];
  const PetscBool    drifts  = march->particles->drift[a].value != 0 ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool    own     = march->particles->own;
  const PetscBool    ordered = same && march->layout->dim == 1 && !own ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt     beyond  = !own ? 0 : same ? march->slack : axis->periodic ? axis->cells : 0;
  const PetscInt     least   = (drifts ? -1 : 0) - (same ? 0 : axis->first) - beyond;
  const PetscInt     most    = (same ? axis->count - 1 : axis->cells - 1 - axis->first) + beyond;
  PetscInt           whole;
  PetscReal          part, place;
  const PetscInt    *cell;
  const PetscReal   *xi;

  PetscFunctionBegin;
  PetscCall(MpmParticlesWhere(march->particles, a, march->particles->step, &whole, &part));
  PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell));
  PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[a], &xi));
  for (PetscInt p = 0; p < march->particles->count; p++) {
    PetscInt now = cell[p];

    *bad += cell[p] < least || cell[p] > most || !(xi[p] >= 0 && xi[p] < 1);
    if (drifts) MpmPlaceBlock(1, &cell[p], &xi[p], whole, part, &now, &place);
    *bad += same && (now < -march->slack || now >= axis->count + march->slack);
    *bad += ordered && p && cell[p] < cell[p - 1];
  }
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &xi));
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckPlaces(const MpmMarch *march, PetscBool same, const char path[])
{
  PetscInt64 bad = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < march->layout->dim; a++) PetscCall(CountMisplaced(march, same, a, &bad));
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, &bad, 1, MPIU_INT64, MPI_SUM, PetscObjectComm((PetscObject)march->grid->da)));
  Allow(!bad, path, "its particles are where none can be");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts numbers whose squares are out of the range of doubles. A run stops before a state contains any. */
static PetscErrorCode CountLost(const MpmMarch *march, PetscInt64 *lost)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; march->scheme->table->fields[f]; f++) {
    const PetscReal *q;

    PetscCall(MpmParticlesGet(march->particles, march->scheme->table->fields[f], &q));
    for (PetscInt p = 0; p < march->particles->count; p++) *lost += !isfinite(q[p] * q[p]);
    PetscCall(MpmParticlesRestore(march->particles, march->scheme->table->fields[f], &q));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CountNodesLost(Vec node, PetscBool is_mass, PetscInt64 *lost)
{
  const PetscReal *values;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(node, &n));
  PetscCall(VecGetArrayRead(node, &values));
  for (PetscInt i = 0; i < n; i++) *lost += !isfinite(values[i]) || (is_mass && values[i] < 0);
  PetscCall(VecRestoreArrayRead(node, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks the sum of the nodal masses. Drift moves mass from node to node, but does not change the sum. */
static PetscErrorCode CheckMass(const MpmMarch *march, PetscReal mass, const char path[])
{
  MpmConserved now;

  PetscFunctionBegin;
  PetscCall(MpmConservedSum(march, &now));
  Allow(fabs(now.mass - mass) <= MPM_MASS_ROUNDING * mass, path, "its nodes have not the mass of the particles");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCheckpointCheckState(const MpmMarch *march, PetscBool same, PetscReal mass, const char path[])
{
  PetscInt64 lost = 0;

  PetscFunctionBegin;
  if (same) PetscCall(CheckSlack(march, path));
  PetscCall(CheckIds(march, path));
  PetscCall(CheckPlaces(march, same, path));
  PetscCall(CountLost(march, &lost));
  if (same) {
    PetscCall(CountNodesLost(march->inverse_mass, PETSC_TRUE, &lost));
    for (PetscInt f = 0; f < march->nnodes; f++) PetscCall(CountNodesLost(march->node[f], PETSC_FALSE, &lost));
  }
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, &lost, 1, MPIU_INT64, MPI_SUM, PetscObjectComm((PetscObject)march->grid->da)));
  Allow(!lost, path, "its state has numbers out of range");
  if (same) PetscCall(CheckMass(march, mass, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}
