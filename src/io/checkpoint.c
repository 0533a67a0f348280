/* Writing a checkpoint: what it holds, in which arrays. Reading it: checkpoint_read.c. */
#include "io/checkpoint.h"
#include <mpmstab/errors.h>
#include "scene/scene_keys.h"
#include "base/textfile.h"
#include "base/checksum.h"
#include "io/slabs.h"
#include "base/unfinished.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Arrays of which the first rank writes all. */
static PetscErrorCode FromFirst(MpmSlabs *s, const char name[], hid_t type, PetscInt64 n, const void *values)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(s->comm, &rank));
  PetscCall(MpmSlabsWrite(s, name, type, rank ? 0 : n, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lines 'name text'. */
static PetscErrorCode WriteScene(MpmSlabs *s, const MpmScene *scene)
{
  MpmSceneKey fact[MPM_MAX_SCENE_KEYS];
  char        text[MPM_MAX_SCENE_KEYS * (MPM_COUNTS_TEXT + 32)] = "";
  PetscInt    n;

  PetscFunctionBegin;
  PetscCall(MpmSceneKeys(scene, &n, fact));
  for (PetscInt f = 0; f < n; f++) {
    const size_t used = strlen(text);

    snprintf(text + used, sizeof text - used, "%s %s\n", fact[f].name, fact[f].text);
  }
  PetscCall(FromFirst(s, "scene", H5T_NATIVE_CHAR, (PetscInt64)strlen(text), text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteRun(MpmSlabs *s, const MpmMarch *march, const MpmRun *run, const char csv[])
{
  const MpmSeries *series    = &run->series;
  const PetscInt64 where[]   = {march->step, march->particles->step, march->particles->rebased, march->exponent,
                                run->blew_up_at_step};
  const PetscReal  numbers[] = {run->energy_initial, run->energy_final, run->energy_ratio, run->log_energy_first};

  PetscFunctionBegin;
  PetscCall(FromFirst(s, "where", H5T_NATIVE_INT64, PETSC_STATIC_ARRAY_LENGTH(where), where));
  PetscCall(FromFirst(s, "numbers", H5T_NATIVE_DOUBLE, PETSC_STATIC_ARRAY_LENGTH(numbers), numbers));
  PetscCall(FromFirst(s, "series_step", H5T_NATIVE_INT64, series->n, series->step));
  PetscCall(FromFirst(s, "series_state", H5T_NATIVE_DOUBLE, series->n, series->log_state));
  PetscCall(FromFirst(s, "series_grid", H5T_NATIVE_DOUBLE, series->n, series->log_grid));
  PetscCall(FromFirst(s, "csv", H5T_NATIVE_CHAR, csv ? (PetscInt64)strlen(csv) : 0, csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cells of the whole grid: local ones mean nothing on another number of ranks. */
static PetscErrorCode WriteCells(MpmSlabs *s, const MpmMarch *march)
{
  const PetscInt  n = march->particles->count;
  const PetscInt *cell;
  PetscInt64     *global;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, MpmFieldCell, &cell));
  PetscCall(PetscMalloc1(n, &global));
  for (PetscInt p = 0; p < n; p++) global[p] = (PetscInt64)march->grid->first + cell[p];
  PetscCall(MpmSlabsWrite(s, MpmFieldCell, H5T_NATIVE_INT64, n, global));
  PetscCall(PetscFree(global));
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell, &cell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteField(MpmSlabs *s, const MpmParticles *particles, const char name[], hid_t type)
{
  void *values;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, name, &values));
  PetscCall(MpmSlabsWrite(s, name, type, particles->count, values));
  PetscCall(MpmParticlesRestore(particles, name, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteNode(MpmSlabs *s, const char name[], Vec node)
{
  const PetscReal *values;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(node, &n));
  PetscCall(VecGetArrayRead(node, &values));
  PetscCall(MpmSlabsWrite(s, name, H5T_NATIVE_DOUBLE, n, values));
  PetscCall(VecRestoreArrayRead(node, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteState(MpmSlabs *s, const MpmMarch *march)
{
  const PetscInt64 count = march->particles->count;
  PetscInt64       nodes;
  PetscInt         n;
  char             name[32];

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(march->inverse_mass, &n));
  nodes = n;
  PetscCall(MpmSlabsWrite(s, "rank_particles", H5T_NATIVE_INT64, 1, &count));
  PetscCall(MpmSlabsWrite(s, "rank_nodes", H5T_NATIVE_INT64, 1, &nodes));
  PetscCall(WriteField(s, march->particles, DMSwarmField_pid, H5T_NATIVE_INT64));
  PetscCall(WriteField(s, march->particles, MpmFieldXi, H5T_NATIVE_DOUBLE));
  PetscCall(WriteCells(s, march));
  for (PetscInt f = 0; march->scheme->table->fields[f]; f++)
    PetscCall(WriteField(s, march->particles, march->scheme->table->fields[f], H5T_NATIVE_DOUBLE));
  PetscCall(WriteNode(s, "inverse_mass", march->inverse_mass));
  for (PetscInt f = 0; f < march->nnodes; f++) {
    PetscCall(PetscSNPrintf(name, sizeof name, "node_%" PetscInt_FMT, f));
    PetscCall(WriteNode(s, name, march->node[f]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What all arrays together take, and something for HDF5's own. */
static PetscErrorCode Reserve(const char path[], const char part[], const MpmMarch *march, const MpmRun *run,
                              const char csv[])
{
  char       what[PETSC_MAX_PATH_LEN + 64];
  PetscInt64 bytes = 8 * (3 + march->scheme->table->nstate) * march->particles->total + 24 * run->series.n + (1 << 20);
  PetscInt   nodes;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(march->inverse_mass, &nodes));
  bytes +=
      8 * (1 + march->nnodes) * ((PetscInt64)march->layout->grid.nodes + nodes) + (csv ? (PetscInt64)strlen(csv) : 0);
  PetscCall(PetscSNPrintf(what, sizeof what, "checkpoint %s of step %" PetscInt64_FMT, path, march->step));
  PetscCall(MpmFileReserve(PetscObjectComm((PetscObject)march->grid->da), what, part, bytes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The file aside gets its name once it is on the disk; whatever goes wrong, the checkpoint before it is still there. */
static PetscErrorCode Name(MPI_Comm comm, const char part[], const char path[], PetscBool failed, PetscInt64 step)
{
  PetscMPIInt rank;
  int         error = failed ? EIO : 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (!failed) PetscCall(MpmChecksumWrite(comm, part, &error));
  if (rank == 0) {
    if (!error && rename(part, path)) error = errno;
    if (error) (void)unlink(part);
  }
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, comm));
  MpmCheckInput(!error,
                "checkpoint %s of step %" PetscInt64_FMT ": cannot be written: %s; allowed: a disk with room for it "
                "(an earlier one there is untouched)",
                path, step, failed ? "the disk is full, or HDF5 failed" : strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCheckpointWrite(const char path[], const MpmMarch *march, const MpmRun *run, const char csv[])
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)march->grid->da);
  char           part[PETSC_MAX_PATH_LEN];
  PetscBool      failed;
  MpmSlabs       slabs;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(part, sizeof part, "%s.part", path));
  PetscCall(Reserve(path, part, march, run, csv));
  MpmUnfinishedAdd(part);
  PetscCall(MpmSlabsCreate(comm, part, MPM_SEAL_BYTES, &slabs));
  PetscCall(WriteScene(&slabs, march->scene));
  PetscCall(WriteRun(&slabs, march, run, csv));
  PetscCall(WriteState(&slabs, march));
  PetscCall(MpmSlabsClose(&slabs, &failed));
  PetscCall(Name(comm, part, path, failed, march->step));
  MpmUnfinishedDone(part);
  PetscFunctionReturn(PETSC_SUCCESS);
}
