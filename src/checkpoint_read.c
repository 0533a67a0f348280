/* Going on from a checkpoint. */
#include <mpmstab/checkpoint.h>
#include <mpmstab/errors.h>
#include <mpmstab/facts.h>
#include <mpmstab/seal.h>
#include <mpmstab/slabs.h>
#include <string.h>

enum { STEP, PLACES, REBASED, EXPONENT, BLEW_UP, WHERE };             /* of the array 'where' */
enum { ENERGY_FIRST, ENERGY_LAST, ENERGY_RATIO, LOG_FIRST, NUMBERS }; /* of 'numbers' */

static PetscErrorCode Require(MpmSlabs *s, const char path[], const char name[], hid_t type, PetscInt64 length)
{
  PetscInt64 has;

  PetscFunctionBegin;
  PetscCall(MpmSlabsLength(s, name, type, &has));
  MpmCheckInput(has >= 0 && (length < 0 || has == length),
                "checkpoint %s: no array '%s' of the right length in it; allowed: one that 'mpmstab run' has written",
                path, name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All of an array on every rank, with a zero behind it. */
static PetscErrorCode All(MpmSlabs *s, const char path[], const char name[], hid_t type, size_t bytes, PetscInt64 *n,
                          void *values)
{
  PetscFunctionBegin;
  PetscCall(Require(s, path, name, type, -1));
  PetscCall(MpmSlabsLength(s, name, type, n));
  PetscCall(PetscCalloc1((size_t)(*n + 1) * bytes, (char **)values));
  PetscCall(MpmSlabsRead(s, name, type, 0, *n, *(char **)values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of lines 'name text' the text of one name, or NULL. */
static char *FactIn(const char scene[], const char name[], size_t room, char text[])
{
  const size_t length = strlen(name);

  for (const char *line = scene; *line; line++) {
    const size_t end = strcspn(line, "\n");

    if (!strncmp(line, name, length) && line[length] == ' ') {
      snprintf(text, room, "%.*s", (int)(end - length - 1), line + length + 1);
      return text;
    }
    line += end;
    if (!*line) break;
  }
  return NULL;
}

static PetscErrorCode CompareScenes(const MpmScene *scene, const char path[], const char theirs[])
{
  MpmFact  mine[MPM_MAX_FACTS];
  char     text[MPM_COUNTS_TEXT];
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(MpmSceneFacts(scene, &n, mine));
  for (PetscInt f = 0; f < n; f++) {
    const char *has = FactIn(theirs, mine[f].name, sizeof text, text);

    MpmCheckInput(has && !strcmp(has, mine[f].text),
                  "checkpoint %s: its %s is %s, the scene's is %s; allowed: the scene that it is of, but for steps, "
                  "tolerance, expectations and files",
                  path, mine[f].name, has ? has : "not there", mine[f].text);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckState(MpmSlabs *s, const MpmScene *scene, const char path[])
{
  PetscFunctionBegin;
  PetscCall(Require(s, path, "where", H5T_NATIVE_INT64, WHERE));
  PetscCall(Require(s, path, "numbers", H5T_NATIVE_DOUBLE, NUMBERS));
  PetscCall(Require(s, path, "rank_particles", H5T_NATIVE_INT64, -1));
  PetscCall(Require(s, path, "rank_nodes", H5T_NATIVE_INT64, -1));
  PetscCall(Require(s, path, DMSwarmField_pid, H5T_NATIVE_INT64, scene->particles));
  PetscCall(Require(s, path, MpmFieldCell, H5T_NATIVE_INT64, scene->particles));
  PetscCall(Require(s, path, MpmFieldXi, H5T_NATIVE_DOUBLE, scene->particles));
  for (PetscInt f = 0; scene->table->fields[f]; f++)
    PetscCall(Require(s, path, scene->table->fields[f], H5T_NATIVE_DOUBLE, scene->particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCheckpointCheck(const MpmScene *scene)
{
  const char *path = scene->restart;
  char        why[256], *theirs;
  PetscInt64  n, where[WHERE] = {0};
  PetscBool   failed;
  MpmSlabs    slabs;

  PetscFunctionBegin;
  PetscCall(MpmSealCheck(PETSC_COMM_WORLD, path, sizeof why, why));
  MpmCheckInput(!why[0], "checkpoint %s: %s; allowed: one that 'mpmstab run -checkpoint' has written", path, why);
  PetscCall(MpmSlabsOpen(PETSC_COMM_WORLD, path, &slabs));
  PetscCall(All(&slabs, path, "scene", H5T_NATIVE_CHAR, 1, &n, &theirs));
  PetscCall(CompareScenes(scene, path, theirs));
  PetscCall(PetscFree(theirs));
  PetscCall(CheckState(&slabs, scene, path));
  PetscCall(MpmSlabsRead(&slabs, "where", H5T_NATIVE_INT64, 0, WHERE, where));
  PetscCall(MpmSlabsClose(&slabs, &failed));
  MpmCheckInput(!failed, "checkpoint %s: HDF5 cannot read it; allowed: one that 'mpmstab run' has written", path);
  MpmCheckInput(where[STEP] < scene->steps,
                "checkpoint %s: is at step %" PetscInt64_FMT " of %" PetscInt64_FMT "; allowed: more steps", path,
                where[STEP], scene->steps);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadRun(MpmSlabs *s, const char path[], MpmMarch *march, MpmRun *run, char **csv)
{
  PetscInt64 where[WHERE], n, *step;
  PetscReal  numbers[NUMBERS], *state, *grid;

  PetscFunctionBegin;
  PetscCall(MpmSlabsRead(s, "where", H5T_NATIVE_INT64, 0, WHERE, where));
  PetscCall(MpmSlabsRead(s, "numbers", H5T_NATIVE_DOUBLE, 0, NUMBERS, numbers));
  march->step               = where[STEP];
  march->particles->step    = where[PLACES];
  march->particles->rebased = where[REBASED];
  march->exponent           = (PetscInt)where[EXPONENT];
  run->blew_up_at_step      = where[BLEW_UP];
  run->energy_initial       = numbers[ENERGY_FIRST];
  run->energy_final         = numbers[ENERGY_LAST];
  run->energy_ratio         = numbers[ENERGY_RATIO];
  run->log_energy_first     = numbers[LOG_FIRST];
  PetscCall(All(s, path, "series_step", H5T_NATIVE_INT64, sizeof *step, &n, &step));
  PetscCall(Require(s, path, "series_state", H5T_NATIVE_DOUBLE, n));
  PetscCall(All(s, path, "series_state", H5T_NATIVE_DOUBLE, sizeof *state, &n, &state));
  PetscCall(Require(s, path, "series_grid", H5T_NATIVE_DOUBLE, n));
  PetscCall(All(s, path, "series_grid", H5T_NATIVE_DOUBLE, sizeof *grid, &n, &grid));
  for (PetscInt64 i = 0; i < n; i++) PetscCall(MpmSeriesAppend(&run->series, step[i], state[i], grid[i]));
  PetscCall(PetscFree(step));
  PetscCall(PetscFree(state));
  PetscCall(PetscFree(grid));
  PetscCall(All(s, path, "csv", H5T_NATIVE_CHAR, 1, &n, csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of the file's particles and nodes this rank reads. same: those that it wrote itself. */
typedef struct {
  PetscBool  same;
  PetscInt64 begin, n, node, nodes;
} Share;

static PetscErrorCode FindShare(MpmSlabs *s, const char path[], const MpmMarch *march, Share *share)
{
  PetscMPIInt rank, size;
  PetscInt64  ranks, again, *particles, *nodes;
  PetscInt    mine;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(s->comm, &rank));
  PetscCallMPI(MPI_Comm_size(s->comm, &size));
  PetscCall(VecGetLocalSize(march->inverse_mass, &mine));
  PetscCall(All(s, path, "rank_particles", H5T_NATIVE_INT64, sizeof *particles, &ranks, &particles));
  PetscCall(All(s, path, "rank_nodes", H5T_NATIVE_INT64, sizeof *nodes, &again, &nodes));
  *share = (Share){.same = ranks == size && again == size && nodes[rank] == mine ? PETSC_TRUE : PETSC_FALSE};
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &share->same, 1, MPIU_BOOL, MPI_LAND, s->comm));
  if (share->same) {
    for (PetscMPIInt r = 0; r < rank; r++) {
      share->begin += particles[r];
      share->node += nodes[r];
    }
    share->n     = particles[rank];
    share->nodes = mine;
  } else {
    share->begin = march->particles->total * rank / size;
    share->n     = march->particles->total * (rank + 1) / size - share->begin;
  }
  PetscCall(PetscFree(particles));
  PetscCall(PetscFree(nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadField(MpmSlabs *s, const Share *share, const MpmParticles *particles, const char name[],
                                hid_t type)
{
  void *values;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, name, &values));
  PetscCall(MpmSlabsRead(s, name, type, share->begin, share->n, values));
  PetscCall(MpmParticlesRestore(particles, name, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadCells(MpmSlabs *s, const Share *share, const MpmMarch *march)
{
  PetscInt   *cell;
  PetscInt64 *global;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(share->n, &global));
  PetscCall(MpmSlabsRead(s, MpmFieldCell, H5T_NATIVE_INT64, share->begin, share->n, global));
  PetscCall(MpmParticlesGet(march->particles, MpmFieldCell, &cell));
  for (PetscInt64 p = 0; p < share->n; p++) cell[p] = (PetscInt)(global[p] - march->grid->first);
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell, &cell));
  PetscCall(PetscFree(global));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadParticles(MpmSlabs *s, const Share *share, MpmMarch *march)
{
  MpmParticles *particles = march->particles;

  PetscFunctionBegin;
  particles->count = (PetscInt)share->n;
  PetscCall(DMSwarmSetLocalSizes(particles->swarm, particles->count, 0));
  PetscCall(ReadField(s, share, particles, DMSwarmField_pid, H5T_NATIVE_INT64));
  PetscCall(ReadField(s, share, particles, MpmFieldXi, H5T_NATIVE_DOUBLE));
  PetscCall(ReadCells(s, share, march));
  for (PetscInt f = 0; march->scene->table->fields[f]; f++)
    PetscCall(ReadField(s, share, particles, march->scene->table->fields[f], H5T_NATIVE_DOUBLE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadNode(MpmSlabs *s, const Share *share, const char name[], Vec node)
{
  PetscReal *values;

  PetscFunctionBegin;
  PetscCall(VecGetArray(node, &values));
  PetscCall(MpmSlabsRead(s, name, H5T_NATIVE_DOUBLE, share->node, share->nodes, values));
  PetscCall(VecRestoreArray(node, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadNodes(MpmSlabs *s, const char path[], const Share *share, MpmMarch *march)
{
  PetscInt64 length = share->nodes;
  char       name[32];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &length, 1, MPIU_INT64, MPI_SUM, s->comm));
  PetscCall(Require(s, path, "inverse_mass", H5T_NATIVE_DOUBLE, length));
  PetscCall(ReadNode(s, share, "inverse_mass", march->inverse_mass));
  for (PetscInt f = 0; f < march->nnodes; f++) {
    PetscCall(PetscSNPrintf(name, sizeof name, "node_%" PetscInt_FMT, f));
    PetscCall(Require(s, path, name, H5T_NATIVE_DOUBLE, length));
    PetscCall(ReadNode(s, share, name, march->node[f]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the march takes for granted: each particle there once, in a cell that is near, at a place within it. */
static PetscErrorCode CheckParticles(const MpmMarch *march, const Share *share, const char path[])
{
  const MpmParticles *particles = march->particles;
  const PetscInt64   *id;
  const PetscInt     *cell;
  const PetscReal    *xi;
  const PetscInt64    n = particles->total, least = -1 - (share->same ? 0 : march->grid->first);
  const PetscInt64    most    = share->same ? march->grid->count : march->grid->cells - march->grid->first;
  PetscInt64          sums[2] = {0, 0}; /* particles that cannot be, and the sum of all ids */

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  PetscCall(MpmParticlesGet(particles, MpmFieldCell, &cell));
  PetscCall(MpmParticlesGet(particles, MpmFieldXi, &xi));
  for (PetscInt p = 0; p < particles->count; p++) {
    sums[0] += id[p] < 0 || id[p] >= n || cell[p] < least || cell[p] > most || !(xi[p] >= 0 && xi[p] < 1);
    sums[1] += id[p];
  }
  PetscCall(MpmParticlesRestore(particles, MpmFieldXi, &xi));
  PetscCall(MpmParticlesRestore(particles, MpmFieldCell, &cell));
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_INT64, MPI_SUM, PetscObjectComm((PetscObject)march->grid->da)));
  MpmCheckInput(!sums[0] && sums[1] == n * (n - 1) / 2,
                "checkpoint %s: its particles are not those of the scene; allowed: one that 'mpmstab run' has written",
                path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCheckpointRead(const char path[], MpmMarch *march, MpmRun *run, char **csv)
{
  Share     share;
  PetscBool failed;
  MpmSlabs  slabs;

  PetscFunctionBegin;
  PetscCall(MpmSlabsOpen(PetscObjectComm((PetscObject)march->grid->da), path, &slabs));
  PetscCall(ReadRun(&slabs, path, march, run, csv));
  PetscCall(FindShare(&slabs, path, march, &share));
  PetscCall(ReadParticles(&slabs, &share, march));
  if (share.same) PetscCall(ReadNodes(&slabs, path, &share, march));
  PetscCall(MpmSlabsClose(&slabs, &failed));
  MpmCheckInput(!failed, "checkpoint %s: HDF5 cannot read it; allowed: one that 'mpmstab run' has written", path);
  PetscCall(CheckParticles(march, &share, path));
  if (!share.same) PetscCall(MpmParticlesRebase(march->particles, march->grid));
  PetscCall(MpmParticlesWeigh(march->scene, march->particles));
  if (!share.same) PetscCall(MpmMarchRunPasses(march, 1, &march->schedule.start, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
