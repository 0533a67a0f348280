/* Which cells each rank has: as many as any other, or as many particles. */
#include "march/partition.h"
#include "scene/layout.h"

/*
   A way to share: its load, and the surface of a rank's part relative to its volume, to which ghosts are proportional.
*/
typedef struct {
  PetscReal load, surface;
} Merit;

/* The number of particles along direction a in cells [lo, hi). */
static PetscInt64 Load(const MpmLayout *layout, PetscInt a, PetscInt lo, PetscInt hi)
{
  return MpmLayoutParticlesBefore(layout, a, hi) - MpmLayoutParticlesBefore(layout, a, lo);
}

/*
   Cuts a direction into ranges of at least least cells with at most most particles each, from the right, each range as
   long as it may be. Returns whether there is a way.
*/
static PetscBool CutAtMost(const MpmLayout *layout, PetscInt a, PetscInt ranks, PetscInt least, PetscInt64 most,
                           PetscInt starts[])
{
  starts[0]     = 0;
  starts[ranks] = layout->grid[a].cells;
  for (PetscInt r = ranks - 1; r >= 0; r--) {
    const PetscInt end = starts[r + 1];
    PetscInt       lo = r * least, hi = end - least; /* the first cell of the range is in [lo, hi] */

    if (hi < lo || Load(layout, a, hi, end) > most) return PETSC_FALSE;
    while (lo < hi) {
      const PetscInt middle = lo + (hi - lo) / 2;

      if (Load(layout, a, middle, end) > most)
        lo = middle + 1;
      else
        hi = middle;
    }
    if (r > 0)
      starts[r] = lo;
    else
      return lo == 0 ? PETSC_TRUE : PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/*
   Cuts a direction such that the fullest range has as few particles as can be, and returns their number. Ranges that
   may not be shorter can make it more: the longest range on the right may leave the next one too dense a place.
*/
static PetscInt64 CutByParticles(const MpmLayout *layout, PetscInt a, PetscInt ranks, PetscInt least, PetscInt starts[])
{
  PetscInt64 lo = (layout->row[a] + ranks - 1) / ranks, hi = layout->row[a];

  while (lo < hi) {
    const PetscInt64 middle = lo + (hi - lo) / 2;

    if (CutAtMost(layout, a, ranks, least, middle, starts))
      hi = middle;
    else
      lo = middle + 1;
  }
  (void)CutAtMost(layout, a, ranks, least, lo, starts);
  return lo;
}

/* Cuts a direction into equal ranges, as DMDA does, and returns the number of particles in the fullest. */
static PetscInt64 CutByCells(const MpmLayout *layout, PetscInt a, PetscInt ranks, PetscInt starts[])
{
  PetscInt64 most = 0;

  for (PetscInt r = 0; r <= ranks; r++)
    starts[r] = MpmGridFirst(layout->grid[a].cells, (PetscMPIInt)ranks, (PetscMPIInt)r);
  for (PetscInt r = 0; r < ranks; r++) most = PetscMax(most, Load(layout, a, starts[r], starts[r + 1]));
  return most;
}

/* Cuts every direction into ranks[a] ranges. Returns false where a range cannot have least cells. */
static PetscBool Share(const MpmLayout *layout, const PetscInt ranks[], PetscInt least, PetscBool by_particles,
                       PetscInt *starts[], Merit *merit)
{
  *merit = (Merit){.load = 1};
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) {
    PetscInt64 most;

    if (a >= layout->dim ? ranks[a] > 1 : layout->grid[a].cells / ranks[a] < least) return PETSC_FALSE;
    if (a >= layout->dim) continue;
    most = by_particles ? CutByParticles(layout, a, ranks[a], least, starts[a])
                        : CutByCells(layout, a, ranks[a], starts[a]);
    merit->load *= (PetscReal)(most * ranks[a]) / (PetscReal)layout->row[a];
    if (ranks[a] > 1) merit->surface += (PetscReal)ranks[a] / layout->grid[a].cells;
  }
  return PETSC_TRUE;
}

static PetscBool IsBetter(const Merit *merit, const Merit *best, PetscBool by_particles)
{
  if (by_particles && merit->load != best->load) return merit->load < best->load ? PETSC_TRUE : PETSC_FALSE;
  return merit->surface < best->surface ? PETSC_TRUE : PETSC_FALSE;
}

/* Takes the best of the ways to write size as a product, and leaves the numbers of ranks 0 where there is none. */
static PetscErrorCode Choose(const MpmLayout *layout, PetscMPIInt size, PetscInt least, PetscBool by_particles,
                             MpmPartition *partition)
{
  Merit merit, best = {PETSC_MAX_REAL, PETSC_MAX_REAL};

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(partition->ranks, MPM_MAX_DIM));
  for (PetscInt x = 1; x <= size; x++) {
    for (PetscInt y = 1; size % x == 0 && y <= size / x; y++) {
      const PetscInt n[MPM_MAX_DIM] = {x, y, size / x / y};

      if (layout->ranks[0] && (x != layout->ranks[0] || y != PetscMax(1, layout->ranks[1]))) continue;
      if (size / x % y || !Share(layout, n, least, by_particles, partition->starts, &merit)) continue;
      if (!IsBetter(&merit, &best, by_particles)) continue;
      best = merit;
      PetscCall(PetscArraycpy(partition->ranks, n, MPM_MAX_DIM));
    }
  }
  partition->load     = best.load;
  partition->smallest = 0;
  if (!partition->ranks[0]) PetscFunctionReturn(PETSC_SUCCESS);
  (void)Share(layout, partition->ranks, least, by_particles, partition->starts, &merit);
  partition->smallest = PETSC_MAX_INT;
  for (PetscInt a = 0; a < layout->dim; a++)
    for (PetscInt r = 0; r < partition->ranks[a]; r++)
      partition->smallest = PetscMin(partition->smallest, partition->starts[a][r + 1] - partition->starts[a][r]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPartitionCreate(const MpmLayout *layout, PetscMPIInt size, PetscInt least, PetscBool drifts,
                                  MpmPartition *partition)
{
  PetscReal equal;

  PetscFunctionBegin;
  *partition = (MpmPartition){0};
  for (PetscInt a = 0; a < layout->dim; a++) PetscCall(PetscMalloc1(size + 1, &partition->starts[a]));
  PetscCall(Choose(layout, size, least, PETSC_FALSE, partition));
  if (layout->balance == MPM_BALANCE_CELLS || !partition->ranks[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (layout->balance == MPM_BALANCE_AUTO && (drifts || partition->load <= MPM_BALANCE_BOUND))
    PetscFunctionReturn(PETSC_SUCCESS);
  equal = partition->load;
  PetscCall(Choose(layout, size, least, PETSC_TRUE, partition));
  if (partition->load >= equal) PetscCall(Choose(layout, size, least, PETSC_FALSE, partition));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPartitionDestroy(MpmPartition *partition)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) PetscCall(PetscFree(partition->starts[a]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
