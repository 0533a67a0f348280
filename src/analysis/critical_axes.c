/*
   Waves along an axis in two and three dimensions. They are those of one dimension, with that direction's drift. The limit
   of these waves is an upper bound of the limit of all.
*/
#include "analysis/critical_parts.h"
#include "scene/layout.h"
#include "symbol/source.h"
#include <math.h>

/*
   The space of waves along an axis, of one dimension. Returns the speed of P waves along it in units of c: with a prestress
   it depends on the direction (docs/theory.md, section 9).
*/
static PetscReal AlongAxis(const MpmSpace *of, PetscInt axis, MpmSpace *along)
{
  const PetscReal sigma0 = MpmSpacePrestress(of, axis, axis);
  PetscReal       square = 1;

  *along     = *of;
  along->dim = 1;
  if (!MpmSpaceIsPrestressed(of)) return 1;
  square = MpmSpaceTangent(of, axis, axis, axis, axis) - sigma0;
  for (PetscInt c = 0; c < MPM_MAX_STRESS; c++) along->prestress[c] = 0;
  along->prestress[0] = sigma0 / square;
  along->displaced    = sigma0 != 0 && of->curved ? PETSC_TRUE : PETSC_FALSE;
  return sqrt(square);
}

/* Finds the limit of the waves along one axis. */
static PetscErrorCode LimitOfAxis(const MpmCriticalCase *of, MpmCriticalFinder find, PetscInt axis, MpmCritical *c)
{
  MpmLayout       layout = *of->layout;
  MpmScheme       scheme = *of->scheme;
  MpmCriticalCase along  = *of;
  PetscReal       speed;

  PetscFunctionBegin;
  layout.dim       = 1;
  layout.grid[0]   = layout.grid[axis];
  layout.offset[0] = layout.offset[axis];
  MpmLayoutSetPpc(&layout, layout.ppc[axis]);
  speed = AlongAxis(&of->scheme->space, axis, &scheme.space);
  PetscCall(MpmTableCreate(scheme.formulation, scheme.transfer, &scheme.numbers, &scheme.space, &scheme.table));
  along.layout = &layout;
  along.scheme = &scheme;
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) along.step.drift[a] = (MpmFraction){.den = 1};
  along.step.drift[0] = of->step.drift[axis];
  along.step.courant *= speed;
  PetscCall(find(&along, PETSC_TRUE, c));
  c->stable_at /= speed;
  c->unstable_at /= speed;
  c->courant /= speed;
  c->doubtful /= speed;
  PetscCall(MpmTableDestroy(&scheme.table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalAxes(const MpmCriticalCase *of, MpmCriticalFinder find, MpmCritical *least)
{
  PetscBool mirror[MPM_MAX_DIM];
  PetscInt  alike[MPM_MAX_DIM];

  PetscFunctionBegin;
  MpmPhasesSymmetries(of->layout, &of->scheme->space, of->step.drift, mirror, alike);
  *least = (MpmCritical){.stable_at = INFINITY, .unstable_at = INFINITY, .courant = INFINITY, .fading = NAN};
  for (PetscInt axis = 0; axis < of->layout->dim; axis++) {
    MpmCritical c;

    if (alike[axis] < axis) continue; /* it has the same waves as one before it */
    PetscCall(LimitOfAxis(of, find, axis, &c));
    least->evaluations += c.evaluations;
    if (!(c.unstable_at < least->unstable_at)) continue;
    c.evaluations = least->evaluations;
    *least        = c;
    for (PetscInt a = 0; a < MPM_MAX_DIM; a++) least->beta[a] = 0;
    least->beta[axis] = c.beta[0];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
