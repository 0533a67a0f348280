/* The nodal operator of one Bloch mode: the plan of a table, run on the symbols of its maps. */
#include "linalg/small_qr.h"
#include "symbol/bloch_nodal.h"
#include <math.h>

/*
   Nodes have one number of a number, and a vector of a vector or of a stress. An affine part adds to its vector's own
   numbers, and displacements to those of the stress, since nodes feel the two in one force.
*/
void MpmBlochCountNull(const MpmBloch *b, PetscInt *rest, PetscInt *all, PetscReal *factor)
{
  const MpmScheme *scheme     = b->scheme;
  const MpmTable  *t          = scheme->table;
  PetscInt         numbers[2] = {0, 0}; /* without and with filter */

  *all = MPM_NONE;
  if (b->period > 1 || !scheme->transfer->null_factor || !MpmFormulationKeepsUnseen(scheme->formulation)) return;
  for (PetscInt r = 0; r < t->nstate; r++) {
    PetscInt components = 0, seen;

    numbers[t->filtered[r]] += b->ppc;
    if (t->field[r] < 0 || t->component[r] > 0) continue;
    for (PetscInt other = 0; other < t->nstate; other++) components += t->field[other] == t->field[r];
    seen = scheme->formulation->particle_ranks[t->field[r]] == MPM_SCALAR ? 1 : t->dim;
    if (scheme->formulation->particle_ranks[t->field[r]] == MPM_TENSOR && t->displacement != MPM_NONE)
      components += t->dim;
    numbers[t->filtered[r]] -= PetscMin(seen, components * b->ppc);
  }
  *rest   = numbers[0];
  *all    = numbers[0] + numbers[1];
  *factor = scheme->transfer->null_factor(&scheme->numbers);
}

/*
   What no image of a plan sees of the registers that a step multiplies by c stays a multiple of itself, and so |c| is a
   factor where these registers have more numbers than there are images with c. Returns the largest; NaN where there are
   more images than numbers, which then have factors that the particles do not have.
*/
static PetscReal LargestUnseen(const MpmBloch *b, const MpmNodalPlan *plan)
{
  PetscReal largest = 0;

  for (PetscInt i = 0; i < plan->nimages + plan->nstate; i++) {
    const PetscReal c       = i < plan->nimages ? plan->image[i].c : plan->kept[i - plan->nimages];
    PetscInt        numbers = 0, images = 0;

    for (PetscInt r = 0; r < plan->nstate; r++) numbers += plan->kept[r] == c ? b->ppc : 0;
    for (PetscInt g = 0; g < plan->nimages; g++) images += plan->image[g].c == c;
    if (images > numbers) return NAN;
    if (images < numbers) largest = PetscMax(largest, PetscAbsReal(c));
  }
  return largest;
}

PetscErrorCode MpmBlochNodalCreate(const MpmBloch *b, MpmBlochNodal **nodal)
{
  const MpmScheme *scheme = b->scheme;
  PetscInt         rest   = 0, all, n;
  PetscReal        factor;
  const char      *why;
  MpmNodalPlan    *plan;
  MpmBlochNodal *new;

  PetscFunctionBegin;
  *nodal = NULL;
  MpmBlochCountNull(b, &rest, &all, &factor);
  if (b->layout->dim == 1 || b->period > 1 || (all == MPM_NONE && scheme->transfer->null_factor) ||
      scheme->formulation->written)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmNodalPlanCreate(scheme->table, &why, &plan));
  if (!plan) PetscFunctionReturn(PETSC_SUCCESS);
  n = plan->nimages;
  if (all == MPM_NONE) factor = LargestUnseen(b, plan);
  if (all == MPM_NONE ? isnan(factor) : n != b->size - all) {
    PetscCall(MpmNodalPlanDestroy(&plan));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscNew(nodal));
  new  = *nodal;
  *new = (MpmBlochNodal){.plan = plan, .beta = {NAN, NAN, NAN}, .rest = rest, .all = all, .factor = factor};
  PetscCall(PetscMalloc1(plan->degree + 1, &new->coefficient));
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscMalloc1(n * n, &new->coefficient[j]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochNodalDestroy(MpmBlochNodal **nodal)
{
  PetscFunctionBegin;
  if (!*nodal) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt j = 0; j <= (*nodal)->plan->degree; j++) PetscCall(PetscFree((*nodal)->coefficient[j]));
  PetscCall(PetscFree((*nodal)->coefficient));
  PetscCall(MpmNodalPlanDestroy(&(*nodal)->plan));
  PetscCall(PetscFree(*nodal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The symbol of a map: a sum over particles of what goes to them and comes back, or that of an operation of nodes. */
static PetscErrorCode Symbol(void *context, const MpmNodalMap *map, double complex symbol[])
{
  const MpmBloch *b = context;
  const MpmOp    *P = &map->to_nodes, *W = &map->to_particles;

  PetscFunctionBegin;
  if (!map->product) *symbol = MpmBlochOfNodes(b, P, b->beta);
  for (PetscInt j = 0; j < b->ppc && map->product; j++)
    *symbol += conj(MpmBlochTie(b, P, j, NULL)) * MpmBlochTie(b, W, j, NULL) / b->mass;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetPhase(MpmBlochNodal *nodal, MpmBloch *b, const PetscReal beta[])
{
  PetscBool same = PETSC_TRUE;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < nodal->plan->dim; a++)
    if (!(nodal->beta[a] == beta[a])) same = PETSC_FALSE;
  if (same) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscArraycpy(nodal->beta, beta, nodal->plan->dim));
  MpmBlochSetPhase(b, beta);
  PetscCall(MpmNodalRun(nodal->plan, 1, Symbol, b, nodal->coefficient));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochNodalFactors(MpmBlochNodal *nodal, MpmBloch *b, PetscReal courant, const PetscReal beta[],
                                    double complex value[], PetscBool *ok)
{
  const MpmNodalPlan *plan = nodal->plan;
  const PetscInt      n    = plan->nimages;
  const PetscReal     x    = plan->stride == 2 ? courant * courant : courant;
  double complex      matrix[MPM_MAX_IMAGES * MPM_MAX_IMAGES];

  PetscFunctionBegin;
  PetscCall(SetPhase(nodal, b, beta));
  *ok = PETSC_TRUE;
  for (PetscInt i = 0; i < n * n; i++) {
    matrix[i] = 0;
    for (PetscInt j = plan->degree; j >= 0; j--) matrix[i] = x * matrix[i] + nodal->coefficient[j][i];
    if (!isfinite(creal(matrix[i])) || !isfinite(cimag(matrix[i]))) *ok = PETSC_FALSE;
  }
  if (*ok) MpmSmallQr(n, matrix, value, ok);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochNodalGrowths(MpmBlochNodal *nodal, MpmBloch *b, PetscReal courant, const PetscReal beta[],
                                    PetscReal *growth, PetscReal *without_null, PetscBool *ok)
{
  PetscReal      largest = 0;
  double complex value[MPM_MAX_IMAGES];

  PetscFunctionBegin;
  PetscCall(MpmBlochNodalFactors(nodal, b, courant, beta, value, ok));
  if (!*ok) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < nodal->plan->nimages; i++) largest = PetscMax(largest, cabs(value[i]));
  *growth       = largest;
  *without_null = nodal->all == MPM_NONE ? NAN : largest;
  if (nodal->rest > 0) *growth = PetscMax(*growth, 1);
  if (nodal->all == MPM_NONE || nodal->all > nodal->rest) *growth = PetscMax(*growth, PetscAbsReal(nodal->factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}
