/* The phase of largest growth, sought over all phases. */
#include "analysis/worst_phase.h"
#include "analysis/zoom.h"
#include "linalg/small_eigen.h"
#include <mpmstab/verdict.h>

#define MOST_POINTS 64 /* in (0, pi] in each direction, for the phases of the symbol */
#define STARTS 8
#define WITHIN 0.5  /* searches go on from places with at least half of the largest growth */
#define FINEST 1e-8 /* of a phase */

/* By dimension: the fewest points in (0, pi]. Under drift growth may be confined to a thousandth of the phases. */
static const PetscInt fewest[] = {0, 1024, 32, 4};

typedef struct {
  const MpmSource *source;
  MpmSmallEigen    eigen;
} Search;

/* Minus the growth, since the least value is sought. */
static PetscErrorCode MinusGrowth(void *context, const PetscReal beta[], PetscReal *value)
{
  Search   *s       = context;
  PetscReal largest = 0;
  PetscInt  exponent;

  PetscFunctionBegin;
  PetscCall(MpmSourceMatrix(s->source, beta, s->eigen.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&s->eigen, PETSC_FALSE));
  for (PetscInt i = 0; i < s->eigen.n; i++) largest = PetscMax(largest, cabs(s->eigen.value[i]));
  *value = -MpmGrowthPerStep(largest, exponent, s->source->period);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWorstPhase(MPI_Comm comm, const MpmSource *source, const PetscInt phases[], PetscReal beta[],
                             MpmSourceGrowth *at)
{
  Search    search = {.source = source};
  MpmZoom   zoom   = {.dim    = source->dim,
                      .points = fewest[source->dim],
                      .starts = STARTS,
                      .within = WITHIN,
                      .finest = FINEST,
                      .comm   = comm};
  PetscReal value;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < source->dim; a++) {
    zoom.points    = PetscMax(zoom.points, PetscMin(MOST_POINTS, phases[a] / 2));
    zoom.mirror[a] = source->reflects[a];
  }
  PetscCall(MpmSmallEigenCreate(source->size, &search.eigen));
  PetscCall(MpmZoomLeast(&zoom, MinusGrowth, &search, beta, &value));
  PetscCall(MpmSmallEigenDestroy(&search.eigen));
  PetscCall(MpmSourceGrowthAt(source, beta, at));
  PetscFunctionReturn(PETSC_SUCCESS);
}
