/*
   Writes and reads checkpoints. What all ranks hold is checked before it is used; particles and nodes are checked after
   they are read (checkpoint_check.c).
*/
#include "io/checkpoint.h"
#include "io/checkpoint_file.h"
#include "base/hdf5.h"
#include "base/memory.h"
#include "march/diagnostics.h"
#include <mpmstab/errors.h>
#include "scene/fields.h"
#include "base/textfile.h"
#include <stdio.h>
#include <string.h>

#define ANY -1 /* a length that is not known before */

/* Writes an array that the first rank holds whole. */
static PetscErrorCode FromFirst(MpmHdf5 *s, const char name[], hid_t type, PetscInt64 n, const void *values)
{
  return MpmHdf5Write(s, name, type, MpmRankOf(s->comm) ? 0 : n, 1, values);
}

/* Writes the scene as lines 'name text'. */
static PetscErrorCode WriteScene(MpmHdf5 *s, const MpmScene *scene)
{
  MpmValue value[MPM_MAX_VALUES];
  char     text[MPM_MAX_VALUES * (MPM_COUNTS_TEXT + 32)] = "", one[MPM_COUNTS_TEXT];
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(MpmValuesIn(MPM_IN_CHECKPOINT, scene, NULL, &n, value));
  for (PetscInt f = 0; f < n; f++) {
    const size_t used = strlen(text);

    PetscCall(MpmValueText(&value[f], sizeof one, one));
    snprintf(text + used, sizeof text - used, "%s %s\n", value[f].field->name, one);
  }
  PetscCall(FromFirst(s, "scene", H5T_NATIVE_CHAR, (PetscInt64)strlen(text), text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WritePace(MpmHdf5 *s, const MpmMarch *march, const MpmPace *pace)
{
  PetscReal numbers[MPM_PACE_NUMBERS] = {
      [MPM_PACE_ELAPSED] = march->elapsed,          [MPM_PACE_COURANT] = march->courant, [MPM_PACE_LEAST] = pace->least,
      [MPM_PACE_LARGEST] = pace->largest,           [MPM_PACE_SUM] = pace->sum,          [MPM_PACE_TOLD] = pace->told,
      [MPM_PACE_CHANGES] = (PetscReal)pace->changes};

  PetscFunctionBegin;
  for (MpmPaceReason r = 0; r < MPM_PACE_REASONS; r++) numbers[MPM_PACE_TAKEN + r] = (PetscReal)pace->taken[r];
  PetscCall(PetscMemcpy(numbers + MPM_PACE_HOLDS, &pace->held, sizeof pace->held));
  PetscCall(FromFirst(s, "pace", H5T_NATIVE_DOUBLE, MPM_PACE_NUMBERS, numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteRun(MpmHdf5 *s, const MpmMarch *march, const MpmRun *run, const char csv[])
{
  const MpmSeries *series    = &run->series;
  const PetscInt   dim       = march->layout->dim;
  const PetscReal  numbers[] = {run->energy_initial, run->energy_final, run->energy_ratio, run->log_energy_first};

  PetscInt64 where[MPM_WHERE_OF(MPM_MAX_DIM)] = {[MPM_AT_STEP]     = march->step,
                                                 [MPM_AT_PLACES]   = march->particles->step,
                                                 [MPM_AT_EXPONENT] = march->exponent,
                                                 [MPM_AT_BLEW_UP]  = run->blew_up_at_step};

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim; a++) where[MpmAtRebased(a)] = march->particles->rebased[a];
  PetscCall(FromFirst(s, "where", H5T_NATIVE_INT64, MPM_WHERE_OF(dim), where));
  PetscCall(FromFirst(s, "numbers", H5T_NATIVE_DOUBLE, PETSC_STATIC_ARRAY_LENGTH(numbers), numbers));
  if (run->pace) PetscCall(WritePace(s, march, run->pace));
  if (run->watch)
    PetscCall(FromFirst(s, "watch", H5T_NATIVE_DOUBLE, MPM_PACE_HELD, (const PetscReal *)&run->watch->held));
  PetscCall(FromFirst(s, "series_step", H5T_NATIVE_INT64, series->n, series->step));
  PetscCall(FromFirst(s, "series_state", H5T_NATIVE_DOUBLE, series->n, series->log_state));
  PetscCall(FromFirst(s, "series_grid", H5T_NATIVE_DOUBLE, series->n, series->log_grid));
  PetscCall(FromFirst(s, "csv", H5T_NATIVE_CHAR, csv ? (PetscInt64)strlen(csv) : 0, csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Require(MpmHdf5 *s, const char path[], const char name[], hid_t type, PetscInt64 length)
{
  PetscInt64 has;

  PetscFunctionBegin;
  PetscCall(MpmHdf5Length(s, name, type, &has));
  MpmCheckInput(has >= 0 && (length == ANY || has == length),
                "checkpoint %s: no array '%s' of the right length in it; allowed: one that 'mpmstab run' has written",
                path, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of the file's particles and nodes that this rank reads. same: each rank reads what it wrote itself. */
typedef struct {
  PetscBool  same;
  PetscInt64 begin, n, node, nodes;
} Share;

/* Writes an array of particles, or of nodes; with a share it reads that part of it. */
static PetscErrorCode Exchange(MpmHdf5 *s, const Share *share, PetscBool of_nodes, const char name[], hid_t type,
                               PetscInt64 n, void *values)
{
  PetscFunctionBegin;
  if (!share)
    PetscCall(MpmHdf5Write(s, name, type, n, 1, values));
  else
    MpmHdf5Read(s, name, type, of_nodes ? share->node : share->begin, of_nodes ? share->nodes : share->n, values);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ExchangeField(MpmHdf5 *s, const Share *share, const MpmParticles *particles, const char name[],
                                    hid_t type)
{
  void *values;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, name, &values));
  PetscCall(Exchange(s, share, PETSC_FALSE, name, type, particles->count, values));
  PetscCall(MpmParticlesRestore(particles, name, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cells in a file are those of the whole grid, since local ones mean nothing on another number of ranks. */
static PetscErrorCode ExchangeCells(MpmHdf5 *s, const Share *share, const MpmMarch *march, PetscInt a)
{
  const MpmGridAxis *axis = &march->grid->axis[a];
  const PetscInt     n = march->particles->count, most = march->particles->own ? axis->cells : 0; /* in ghosts */
  PetscInt          *cell;
  PetscInt64        *global;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell));
  PetscCall(PetscCalloc1(n, &global));
  for (PetscInt p = 0; p < n && !share; p++) global[p] = (PetscInt64)axis->first + cell[p];
  PetscCall(Exchange(s, share, PETSC_FALSE, MpmFieldCell[a], H5T_NATIVE_INT64, n, global));
  for (PetscInt p = 0; p < n && share; p++) /* a cell off the grid stays off and is refused later */
    cell[p] = (PetscInt)PetscClipInterval(global[p], -2 - most, axis->cells + most) - axis->first;
  PetscCall(PetscFree(global));
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ExchangeParticles(MpmHdf5 *s, const Share *share, const MpmMarch *march)
{
  const MpmParticles *particles = march->particles;

  PetscFunctionBegin;
  PetscCall(ExchangeField(s, share, particles, DMSwarmField_pid, H5T_NATIVE_INT64));
  for (PetscInt a = 0; a < march->layout->dim; a++) {
    PetscCall(ExchangeField(s, share, particles, MpmFieldXi[a], H5T_NATIVE_DOUBLE));
    PetscCall(ExchangeCells(s, share, march, a));
  }
  for (PetscInt f = 0; march->scheme->table->fields[f]; f++)
    PetscCall(ExchangeField(s, share, particles, march->scheme->table->fields[f], H5T_NATIVE_DOUBLE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* path: of the file that is read. length: of an array in it. */
static PetscErrorCode ExchangeNode(MpmHdf5 *s, const char path[], const Share *share, PetscInt64 length,
                                   const char name[], Vec node)
{
  PetscReal *values;
  PetscInt   n;

  PetscFunctionBegin;
  if (share) PetscCall(Require(s, path, name, H5T_NATIVE_DOUBLE, length));
  PetscCall(VecGetLocalSize(node, &n));
  PetscCall(VecGetArray(node, &values));
  PetscCall(Exchange(s, share, PETSC_TRUE, name, H5T_NATIVE_DOUBLE, n, values));
  PetscCall(VecRestoreArray(node, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ExchangeNodes(MpmHdf5 *s, const char path[], const Share *share, const MpmMarch *march)
{
  PetscInt64 length = share ? share->nodes : 0;
  char       name[32];

  PetscFunctionBegin;
  if (share) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &length, 1, MPIU_INT64, MPI_SUM, s->comm));
  PetscCall(ExchangeNode(s, path, share, length, "inverse_mass", march->inverse_mass));
  for (PetscInt f = 0; f < march->nnodes; f++) {
    (void)snprintf(name, sizeof name, "node_%" PetscInt_FMT, f);
    PetscCall(ExchangeNode(s, path, share, length, name, march->node[f]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteState(MpmHdf5 *s, const MpmMarch *march)
{
  const PetscInt64 count = march->particles->count;
  PetscInt64       nodes;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(march->inverse_mass, &n));
  nodes = n;
  PetscCall(MpmHdf5Write(s, "rank_particles", H5T_NATIVE_INT64, 1, 1, &count));
  PetscCall(MpmHdf5Write(s, "rank_nodes", H5T_NATIVE_INT64, 1, 1, &nodes));
  PetscCall(ExchangeParticles(s, NULL, march));
  PetscCall(ExchangeNodes(s, NULL, NULL, march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Gives the file its own name once it is on the disk. Whatever goes wrong before, the earlier checkpoint is still
   there.
*/
static PetscErrorCode Finish(MpmHdf5 *file, const char part[], const char path[], PetscInt64 step)
{
  int       error = 0;
  PetscBool failed;

  PetscFunctionBegin;
  PetscCall(MpmHdf5Failed(file, &failed));
  if (failed) MpmUnfinishedDrop(part);
  PetscCall(MpmHdf5Close(file, &failed));
  if (!failed) PetscCall(MpmChecksumWrite(file->comm, part, &error));
  if (failed || error)
    MpmUnfinishedDrop(part);
  else
    PetscCall(MpmFileFinish(file->comm, path, part, &error));
  MpmCheckInput(!failed && !error,
                "checkpoint %s of step %" PetscInt64_FMT ": cannot be written: %s; allowed: a disk with room for it "
                "(an earlier one there is untouched)",
                path, step, failed ? file->why : strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCheckpointWrite(const char path[], const MpmMarch *march, const MpmRun *run, const char csv[])
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)march->grid->da);
  char           part[PETSC_MAX_PATH_LEN];
  int            error;
  MpmHdf5        file;

  PetscFunctionBegin;
  PetscCall(MpmFileCreate(comm, path, part, &error));
  MpmCheckInput(!error,
                "checkpoint %s of step %" PetscInt64_FMT ": cannot be written: %s; allowed: a folder that is there",
                path, march->step, strerror(error));
  PetscCall(MpmHdf5Create(comm, part, MPM_CHECKSUM_BYTES, &file));
  PetscCall(WriteScene(&file, march->scene));
  PetscCall(WriteRun(&file, march, run, csv));
  PetscCall(WriteState(&file, march));
  PetscCall(Finish(&file, part, path, march->step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads a whole array on every rank and appends a zero. n: its length; if it is ANY on entry, it is set. */
static PetscErrorCode All(MpmHdf5 *s, const char path[], const char name[], hid_t type, size_t bytes, PetscInt64 *n,
                          void *values)
{
  PetscFunctionBegin;
  PetscCall(Require(s, path, name, type, *n));
  PetscCall(MpmHdf5Length(s, name, type, n));
  PetscCall(MpmMemoryCheck(PETSC_COMM_WORLD, path,
                           (PetscReal)MpmRanksOf(PETSC_COMM_WORLD) * (PetscReal)*n * (PetscReal)bytes, name));
  PetscCall(PetscCalloc1((size_t)(*n + 1) * bytes, (char **)values));
  MpmHdf5Read(s, name, type, 0, *n, *(char **)values);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadRun(MpmHdf5 *s, PetscInt dim, MpmCheckpoint *f)
{
  const hid_t integer = H5T_NATIVE_INT64, real = H5T_NATIVE_DOUBLE;

  PetscFunctionBegin;
  f->scene_length = f->csv_length = f->samples = f->ranks = ANY;
  PetscCall(All(s, f->path, "scene", H5T_NATIVE_CHAR, 1, &f->scene_length, &f->scene));
  PetscCall(All(s, f->path, "csv", H5T_NATIVE_CHAR, 1, &f->csv_length, &f->csv));
  PetscCall(Require(s, f->path, "where", integer, MPM_WHERE_OF(dim)));
  MpmHdf5Read(s, "where", integer, 0, MPM_WHERE_OF(dim), f->where);
  PetscCall(Require(s, f->path, "numbers", real, MPM_NUMBERS));
  MpmHdf5Read(s, "numbers", real, 0, MPM_NUMBERS, f->numbers);
  PetscCall(All(s, f->path, "series_step", integer, sizeof *f->sample_step, &f->samples, &f->sample_step));
  PetscCall(All(s, f->path, "series_state", real, sizeof *f->log_state, &f->samples, &f->log_state));
  PetscCall(All(s, f->path, "series_grid", real, sizeof *f->log_grid, &f->samples, &f->log_grid));
  PetscCall(All(s, f->path, "rank_particles", integer, sizeof *f->rank_particles, &f->ranks, &f->rank_particles));
  PetscCall(All(s, f->path, "rank_nodes", integer, sizeof *f->rank_nodes, &f->ranks, &f->rank_nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Free(MpmCheckpoint *f)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(f->scene));
  PetscCall(PetscFree(f->csv));
  PetscCall(PetscFree(f->sample_step));
  PetscCall(PetscFree(f->log_state));
  PetscCall(PetscFree(f->log_grid));
  PetscCall(PetscFree(f->rank_particles));
  PetscCall(PetscFree(f->rank_nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a file with an array that HDF5 could not read, before its values are checked. */
static PetscErrorCode CheckRead(MpmHdf5 *s, const char path[])
{
  PetscBool failed;

  PetscFunctionBegin;
  PetscCall(MpmHdf5Failed(s, &failed));
  MpmCheckInput(!failed, "checkpoint %s: HDF5 cannot read it; allowed: one that 'mpmstab run' has written", path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadAndCheckRun(MpmHdf5 *s, const MpmScene *scene, PetscInt64 steps, MpmCheckpoint *file)
{
  const char *path = file->path;

  PetscFunctionBegin;
  PetscCall(ReadRun(s, scene->layout.dim, file));
  PetscCall(CheckRead(s, path));
  PetscCall(MpmCheckpointCheckRun(scene, steps, file));
  if (scene->safety > 0) {
    PetscCall(Require(s, path, "pace", H5T_NATIVE_DOUBLE, MPM_PACE_NUMBERS));
    MpmHdf5Read(s, "pace", H5T_NATIVE_DOUBLE, 0, MPM_PACE_NUMBERS, file->pace);
    PetscCall(CheckRead(s, path));
    PetscCall(MpmCheckpointCheckPace(file));
  }
  if (scene->watched && MpmHdf5Has(s, "watch")) { /* without it the run that goes on is watched from there */
    PetscCall(Require(s, path, "watch", H5T_NATIVE_DOUBLE, MPM_PACE_HELD));
    MpmHdf5Read(s, "watch", H5T_NATIVE_DOUBLE, 0, MPM_PACE_HELD, file->watch);
    PetscCall(CheckRead(s, path));
    PetscCall(MpmCheckpointCheckWatch(file));
    file->watched = PETSC_TRUE;
  }
  PetscCall(Require(s, path, DMSwarmField_pid, H5T_NATIVE_INT64, scene->layout.particles));
  for (PetscInt a = 0; a < scene->layout.dim; a++) {
    PetscCall(Require(s, path, MpmFieldCell[a], H5T_NATIVE_INT64, scene->layout.particles));
    PetscCall(Require(s, path, MpmFieldXi[a], H5T_NATIVE_DOUBLE, scene->layout.particles));
  }
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++)
    PetscCall(Require(s, path, scene->scheme.table->fields[f], H5T_NATIVE_DOUBLE, scene->layout.particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The file is closed whether it is refused or not. */
PetscErrorCode MpmCheckpointCheck(const char path[], const MpmScene *scene, PetscInt64 steps)
{
  MpmCheckpoint  file = {.path = path};
  char           why[256];
  PetscBool      failed;
  MpmHdf5        hdf5;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(MpmChecksumCheck(PETSC_COMM_WORLD, file.path, sizeof why, why));
  MpmCheckInput(!why[0], "checkpoint %s: %s; allowed: one that 'mpmstab run -checkpoint' has written", file.path, why);
  PetscCall(MpmHdf5Open(PETSC_COMM_WORLD, file.path, &hdf5));
  ierr = ReadAndCheckRun(&hdf5, scene, steps, &file);
  PetscCall(Free(&file));
  PetscCall(MpmHdf5Close(&hdf5, &failed));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TakePace(const MpmCheckpoint *file, MpmMarch *march, MpmPace *pace)
{
  const PetscReal *numbers = file->pace;

  PetscFunctionBegin;
  MpmCheckInput(numbers[MPM_PACE_ELAPSED] <= pace->end * (1 + PETSC_SQRT_MACHINE_EPSILON),
                "checkpoint %s: is at time %.6g of %.6g; allowed: as late an end or a later one", file->path,
                MpmSceneTimeStep(march->scene, numbers[MPM_PACE_ELAPSED]), MpmSceneTimeStep(march->scene, pace->end));
  march->elapsed = numbers[MPM_PACE_ELAPSED];
  pace->least    = numbers[MPM_PACE_LEAST];
  pace->largest  = numbers[MPM_PACE_LARGEST];
  pace->sum      = numbers[MPM_PACE_SUM];
  pace->told     = numbers[MPM_PACE_TOLD];
  pace->changes  = (PetscInt64)numbers[MPM_PACE_CHANGES];
  PetscCall(PetscMemcpy(&pace->held, numbers + MPM_PACE_HOLDS, sizeof pace->held));
  for (MpmPaceReason r = 0; r < MPM_PACE_REASONS; r++) pace->taken[r] = (PetscInt64)numbers[MPM_PACE_TAKEN + r];
  PetscCall(MpmMarchSetCourant(march, numbers[MPM_PACE_COURANT]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TakeRun(MpmCheckpoint *file, MpmMarch *march, MpmRun *run)
{
  PetscFunctionBegin;
  if (run->pace) PetscCall(TakePace(file, march, run->pace));
  if (file->watched) PetscCall(PetscMemcpy(&run->watch->held, file->watch, sizeof run->watch->held));
  march->step            = file->where[MPM_AT_STEP];
  march->particles->step = file->where[MPM_AT_PLACES];
  march->exponent        = (PetscInt)file->where[MPM_AT_EXPONENT];
  run->blew_up_at_step   = file->where[MPM_AT_BLEW_UP];
  run->energy_initial    = file->numbers[MPM_ENERGY_FIRST];
  run->energy_final      = file->numbers[MPM_ENERGY_LAST];
  run->energy_ratio      = file->numbers[MPM_ENERGY_RATIO];
  run->log_energy_first  = file->numbers[MPM_LOG_ENERGY_FIRST];
  for (PetscInt a = 0; a < march->layout->dim; a++) march->particles->rebased[a] = file->where[MpmAtRebased(a)];
  for (PetscInt64 i = 0; i < file->samples; i++)
    PetscCall(MpmSeriesAppend(&run->series, file->sample_step[i], file->log_state[i], file->log_grid[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindShare(MPI_Comm comm, const MpmCheckpoint *file, const MpmMarch *march, Share *share)
{
  const PetscMPIInt rank = MpmRankOf(comm), size = MpmRanksOf(comm);
  PetscInt          mine;
  int               same;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(march->inverse_mass, &mine));
  same = file->ranks == size && file->rank_nodes[rank] == mine;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &same, 1, MPI_INT, MPI_MIN, comm));
  *share = (Share){.same = same ? PETSC_TRUE : PETSC_FALSE};
  if (share->same) {
    for (PetscMPIInt r = 0; r < rank; r++) {
      share->begin += file->rank_particles[r];
      share->node += file->rank_nodes[r];
    }
    share->n     = file->rank_particles[rank];
    share->nodes = mine;
  } else {
    share->begin = march->particles->total * rank / size;
    share->n     = march->particles->total * (rank + 1) / size - share->begin;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadState(MpmHdf5 *s, const MpmScene *scene, PetscInt64 steps, MpmCheckpoint *file,
                                MpmMarch *march, MpmRun *run, Share *share)
{
  PetscFunctionBegin;
  PetscCall(ReadAndCheckRun(s, scene, steps, file));
  PetscCall(TakeRun(file, march, run));
  PetscCall(FindShare(s->comm, file, march, share));
  march->particles->count = (PetscInt)share->n;
  PetscCall(DMSwarmSetLocalSizes(march->particles->swarm, (PetscInt)share->n, MpmParticlesRoom(march->particles)));
  PetscCall(ExchangeParticles(s, share, march));
  if (share->same) PetscCall(ExchangeNodes(s, file->path, share, march));
  PetscCall(CheckRead(s, file->path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCheckpointRead(const char path[], PetscInt64 steps, MpmMarch *march, MpmRun *run, char **csv)
{
  MpmCheckpoint  file = {.path = path};
  PetscBool      failed;
  Share          share = {.same = PETSC_FALSE};
  MpmConserved   before;
  MpmHdf5        hdf5;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(MpmConservedSum(march, &before));
  PetscCall(MpmHdf5Open(PetscObjectComm((PetscObject)march->grid->da), path, &hdf5));
  ierr = ReadState(&hdf5, march->scene, steps, &file, march, run, &share);
  if (!ierr) {
    *csv     = file.csv;
    file.csv = NULL;
  }
  PetscCall(Free(&file));
  PetscCall(MpmHdf5Close(&hdf5, &failed));
  PetscCall(ierr);
  PetscCall(MpmCheckpointCheckState(march, share.same, before.mass, path));
  if (!share.same)
    PetscCall(MpmMarchRebase(march));
  else if (march->engine->placed)
    PetscCall(march->engine->placed(march));
  PetscCall(MpmParticlesWeigh(march->particles));
  if (!share.same) PetscCall(MpmMarchStart(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}
