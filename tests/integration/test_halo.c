/* Sums over the copies of nodes: the total of all ranks in every copy, in the same bits, however wide the ghosts are. */
#include "check.h"
#include "march/grid.h"

#define FIELDS 3

/* The number of a local node in the grid, or -1 beyond a wall. */
static PetscInt Number(const MpmGrid *grid, const PetscInt node[])
{
  PetscInt number = 0;

  for (PetscInt a = grid->dim - 1; a >= 0; a--) {
    const MpmGridAxis *axis = &grid->axis[a];
    PetscInt           i    = axis->first + node[a];

    if (axis->periodic)
      i = (i + axis->all) % axis->all;
    else if (i < 0 || i >= axis->all)
      return -1;
    number = number * axis->all + i;
  }
  return number;
}

/* Calls for every node and ghost of a rank: its number in the grid, and its place in local arrays. */
typedef void (*ForNode)(PetscInt number, PetscInt local, PetscReal *const local_array[], PetscReal *const global[]);

static void ForAll(const MpmGrid *grid, ForNode call, PetscReal *const local[], PetscReal *const global[])
{
  const MpmGridBox box = MpmGridBoxOf(grid, grid->ghost);
  PetscInt         node[MPM_MAX_DIM];

  for (node[2] = box.lo[2]; node[2] < box.hi[2]; node[2]++)
    for (node[1] = box.lo[1]; node[1] < box.hi[1]; node[1]++)
      for (node[0] = box.lo[0]; node[0] < box.hi[0]; node[0]++) {
        PetscInt at = 0;

        for (PetscInt a = 0; a < grid->dim; a++) at += grid->axis[a].stride * node[a];
        call(Number(grid, node), at, local, global);
      }
}

static void AddTo(PetscInt number, PetscInt at, PetscReal *const local[], PetscReal *const global[])
{
  for (PetscInt f = 0; f < FIELDS && number >= 0; f++) global[f][number] += local[f][at];
}

static void Compare(PetscInt number, PetscInt at, PetscReal *const local[], PetscReal *const global[])
{
  for (PetscInt f = 0; f < FIELDS && number >= 0; f++) CHECK_NEAR(local[f][at], global[f][number], 1e-13);
}

static void Widen(PetscInt number, PetscInt at, PetscReal *const local[], PetscReal *const global[])
{
  for (PetscInt f = 0; f < FIELDS && number >= 0; f++) {
    global[f][number]          = PetscMax(global[f][number], local[f][at]);
    global[FIELDS + f][number] = PetscMax(global[FIELDS + f][number], -local[f][at]);
  }
}

static PetscErrorCode CheckGrid(const MpmGrid *grid, PetscRandom random, const char options[])
{
  const MpmGridAxis *last = &grid->axis[grid->dim - 1];
  const PetscInt     size = last->stride * (last->nodes + 2 * grid->ghost);
  PetscInt           all  = 1;
  PetscReal         *local[FIELDS], *total[FIELDS], *ends[2 * FIELDS];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < grid->dim; a++) all *= grid->axis[a].all;
  for (PetscInt f = 0; f < FIELDS; f++) {
    PetscCall(PetscMalloc1(size, &local[f]));
    PetscCall(PetscCalloc1(all, &total[f]));
    for (PetscInt i = 0; i < size; i++) {
      PetscCall(PetscRandomGetValueReal(random, &local[f][i]));
      local[f][i] /= 3; /* the random numbers themselves are multiples of 2^-48, whose sums are exact in any order */
    }
    local[f] += grid->origin;
  }
  ForAll(grid, AddTo, local, total);
  for (PetscInt f = 0; f < FIELDS; f++)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, total[f], (PetscMPIInt)all, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD));
  PetscCall(MpmGridSum(grid, FIELDS, local));
  ForAll(grid, Compare, local, total);

  for (PetscInt e = 0; e < 2 * FIELDS; e++) {
    PetscCall(PetscMalloc1(all, &ends[e]));
    for (PetscInt i = 0; i < all; i++) ends[e][i] = -PETSC_MAX_REAL;
  }
  ForAll(grid, Widen, local, ends);
  for (PetscInt e = 0; e < 2 * FIELDS; e++)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ends[e], (PetscMPIInt)all, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD));
  for (PetscInt f = 0; f < FIELDS; f++)
    for (PetscInt i = 0; i < all; i++)
      CHECK(ends[f][i] == -ends[FIELDS + f][i], "%s: copies of node %d differ in bits", options, (int)i);

  for (PetscInt e = 0; e < 2 * FIELDS; e++) PetscCall(PetscFree(ends[e]));
  for (PetscInt f = 0; f < FIELDS; f++) {
    local[f] -= grid->origin;
    PetscCall(PetscFree(local[f]));
    PetscCall(PetscFree(total[f]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All widths of ghosts that the shortest range of cells has room for. */
static PetscErrorCode CheckSums(const char options[], PetscRandom random)
{
  MpmScene    *scene;
  PetscMPIInt  size;
  PetscInt     widths = 0;
  MpmPartition p;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(CheckScene(options, &scene));
  for (PetscInt ghost = 1; ghost <= 8; ghost++) {
    MpmGrid *grid;

    PetscCall(MpmPartitionCreate(&scene->layout, size, ghost, PETSC_FALSE, &p));
    if (p.smallest >= ghost) {
      PetscCall(MpmGridCreate(PETSC_COMM_WORLD, scene->layout.dim, scene->layout.grid, &p, ghost, &grid));
      PetscCall(CheckGrid(grid, random, options));
      PetscCall(MpmGridDestroy(&grid));
      widths++;
    }
    PetscCall(MpmPartitionDestroy(&p));
  }
  CHECK(widths > 0, "%s: no ghosts fit", options);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const scenes[] = {"-cells 8",
                                       "-formulation usl -cells 13 -boundary fixed,free",
                                       "-formulation usl -dim 2 -cells 7,8",
                                       "-formulation usl -dim 2 -cells 8,7 -boundary periodic,fixed-free",
                                       "-formulation usl -dim 3 -cells 6,6,6",
                                       "-formulation usl -dim 3 -cells 5,6,7 -boundary fixed,periodic,free"};
  PetscRandom              random;
  PetscMPIInt              rank;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(PetscRandomCreate(PETSC_COMM_SELF, &random));
  PetscCall(PetscRandomSetSeed(random, 7 + rank));
  PetscCall(PetscRandomSeed(random));
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(scenes); s++) PetscCall(CheckSums(scenes[s], random));
  PetscCall(PetscRandomDestroy(&random));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
