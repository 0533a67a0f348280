/* The growth of one Bloch mode. */
#include "linalg/small_eigen.h"
#include "symbol/bloch_growth.h"
#include <mpmstab/verdict.h>
#include <math.h>

#define LARGEST 1e250 /* of the numbers that nodes give: sums of their products with weights are doubles, too */

/* ---- the nodal operator: the plan of a table, run on the symbols of its maps ---- */

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
  if (b->period > 1 || !scheme->transfer->filter_symbol || !MpmFormulationKeepsUnseen(scheme->formulation)) return;
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
  *factor = scheme->transfer->filter_symbol(&scheme->numbers, 0);
}

/*
   Registers that a step multiplies by c have a part that all images of a plan map to 0. This part stays a multiple of
   itself, and so |c| is a factor where these registers have more numbers than there are images with c. Returns the
   largest; NaN where there are more images than numbers, which then have factors that the particles do not have.
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
  if (b->layout->dim == 1 || b->period > 1 || (all == MPM_NONE && scheme->transfer->filter_symbol) ||
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
  if (!map->product) *symbol = MpmBlochOfNodes(b, P);
  for (PetscInt j = 0; j < b->ppc && map->product; j++)
    *symbol += conj(MpmBlochTie(b, P, j, NULL)) * MpmBlochTie(b, W, j, NULL) / b->mass;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetNodalPhase(MpmBlochNodal *nodal, MpmBloch *b, const PetscReal beta[])
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
  PetscCall(SetNodalPhase(nodal, b, beta));
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

/* ---- particles that move and only gain from nodes: a turn on the vectors that they gain ---- */

/* Whether two parts have the same weights along the moving directions. */
static PetscBool SameKinds(const MpmBlochGained *g, PetscInt dim, const MpmOp *a, const MpmOp *b)
{
  for (PetscInt d = 0; d < dim; d++)
    if (g->moves[d] && MpmKindAlong(a->kind, a->axis, d) != MpmKindAlong(b->kind, b->axis, d)) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Finds the w of all numbers, with the number of each. Returns false where there are too many. */
static PetscBool FindProducts(MpmBlochGained *g, PetscInt dim, PetscInt number[])
{
  for (PetscInt y = 0; y < g->gains->numbers; y++) {
    const MpmTakenGift *gift = &g->gains->gift[g->gains->first[y]];

    for (PetscInt i = 0; i < gift->parts; i++) {
      PetscInt w = 0;

      while (w < g->n && (number[w] != y || !SameKinds(g, dim, &g->part[w], &gift->part[i]))) w++;
      if (w == MPM_MAX_STILL) return PETSC_FALSE;
      number[w]   = y;
      g->part[w]  = gift->part[i];
      g->of[y][i] = w;
      g->n        = PetscMax(g->n, w + 1);
    }
  }
  return PETSC_TRUE;
}

/* The places of particles along the moving directions. */
static void SetPlaces(const MpmBloch *b, MpmBlochGained *g)
{
  const PetscInt *ppc = b->layout->ppc;

  for (PetscInt j = b->ppc - 1; j >= 0; j--) {
    PetscInt rest = j, stride = 1;

    g->place[j] = 0;
    for (PetscInt a = 0; a < b->layout->dim; a++) {
      if (g->moves[a]) g->place[j] += stride * (rest % ppc[a]);
      if (g->moves[a]) stride *= ppc[a];
      rest /= ppc[a];
    }
    g->first[g->place[j]] = j;
  }
}

/* Chooses the vectors. order stays 0 where there are as many of them as rows of the registers. */
static PetscErrorCode Choose(const MpmBloch *b, const MpmFraction drift[], MpmBlochGained *g)
{
  const PetscInt orbits = g->cycles * b->turn * g->gains->numbers;
  PetscInt       number[MPM_MAX_STILL], order = orbits;

  PetscFunctionBegin;
  g->moving = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    g->rests[a] = drift[a].value == 0 ? PETSC_TRUE : PETSC_FALSE;
    g->moves[a] = g->rests[a] ? PETSC_FALSE : PETSC_TRUE;
    if (g->moves[a]) g->moving *= b->layout->ppc[a];
  }
  if (FindProducts(g, b->layout->dim, number)) order = PetscMin(orbits, g->n * g->moving);
  if (order >= b->size || order > MPM_SMALL_QR_MOST) PetscFunctionReturn(PETSC_SUCCESS);
  g->products = order < orbits ? PETSC_TRUE : PETSC_FALSE;
  g->order    = order;
  PetscCall(PetscMalloc4(b->ppc, &g->place, g->moving, &g->first, order, &g->number, order, &g->to));
  /* a row is filled up as the registers' are, which have b->size columns */
  PetscCall(PetscMalloc6(2 * b->turn * g->gains->numbers * (order + MPM_BLOCH_LANES), &g->given, b->turn * order,
                         &g->weight, order, &g->times, order * order, &g->matrix, order, &g->value, b->ppc,
                         &g->beyond));
  SetPlaces(b, g);
  for (PetscInt i = 0; i < order; i++) g->number[i] = g->products ? number[i / g->moving] : i % g->gains->numbers;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochGainedCreate(const MpmBloch *b, const MpmFraction drift[], MpmBlochGained **gained)
{
  MpmBlochGained *g;

  PetscFunctionBegin;
  PetscCall(PetscNew(gained));
  g         = *gained;
  g->cycles = 1;
  for (PetscInt j = b->place[0]; j != 0; j = b->place[j]) g->cycles++;
  PetscCall(MpmTakenFind(b->scheme->table, PETSC_TRUE, &g->gains));
  if (g->gains) PetscCall(Choose(b, drift, g));
  if (g->order == 0) PetscCall(MpmBlochGainedDestroy(gained));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochGainedDestroy(MpmBlochGained **gained)
{
  MpmBlochGained *g = *gained;

  PetscFunctionBegin;
  if (!g) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(g->gains));
  if (g->order) PetscCall(PetscFree4(g->place, g->first, g->number, g->to));
  if (g->order) PetscCall(PetscFree6(g->given, g->weight, g->times, g->matrix, g->value, g->beyond));
  PetscCall(PetscFree(*gained));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What P makes of the vectors. */
static void SetPhase(MpmBlochGained *g, const MpmBloch *b, const PetscReal beta[])
{
  const PetscInt block = b->turn * g->gains->numbers;
  double complex mu    = 1;

  for (PetscInt j = 0; j < b->ppc; j++) g->beyond[j] = MpmBlochPhaseBeyond(b, beta, j);
  for (PetscInt l = 0, j = 0; l < g->cycles; l++, j = b->place[j]) mu *= g->beyond[j];
  for (PetscInt i = 0; i < g->order; i++) {
    const PetscInt m = i % g->moving;

    g->to[i]    = g->products ? i - m + g->place[b->place[g->first[m]]] : (i + block) % g->order;
    g->times[i] = g->products ? g->beyond[g->first[m]] : i + block < g->order ? 1 : mu;
  }
}

/* Adds to the registers at the start of a turn what number y of a step gives: its products, or it and its orbit. */
static void AddColumns(const MpmBlochGained *g, MpmBloch *b, PetscReal courant, PetscInt step, PetscInt y)
{
  const MpmTakenGift *gift = &g->gains->gift[g->gains->first[y]];

  for (PetscInt i = 0; i < gift->parts; i++)
    for (PetscInt j = 0; j < b->ppc; j++) {
      double complex given =
          MpmOpValue(&gift->part[i], courant) * MpmBlochTie(b, &gift->part[i], j, g->products ? g->rests : NULL);

      for (PetscInt l = 0, at = j; l < (g->products ? 1 : g->cycles); l++, at = b->place[at]) {
        PetscReal *row =
            MpmBlochRows(b, gift->part[i].dst) + 2 * at * b->width +
            (g->products ? g->place[j] + g->moving * g->of[y][i] : (l * b->turn + step) * g->gains->numbers + y);

        row[0] += creal(given);
        row[b->width] += cimag(given);
        given *= g->beyond[at];
      }
    }
}

static void Weigh(MpmBlochGained *g, const MpmBloch *b, PetscInt step)
{
  double complex *weight = g->weight + step * g->order;

  for (PetscInt i = 0; i < g->order; i++)
    if (g->products)
      weight[i] = MpmBlochTie(b, &g->part[i / g->moving], g->first[i % g->moving], g->moves);
    else
      weight[i] = i / g->gains->numbers == step;
}

/* The steps of a turn. ok is false where what nodes give might leave the range of doubles. */
static PetscErrorCode March(MpmBlochGained *g, MpmBloch *b, PetscBool *ok)
{
  const PetscInt each = g->gains->numbers * 2 * b->width;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < b->turn * each; i++) g->given[i] = 0;
  for (PetscInt step = 0; step < b->turn; step++) {
    PetscCall(MpmBlochRunStep(b, step, g->gains, g->given + step * each));
    Weigh(g, b, step);
  }
  *ok = PETSC_TRUE;
  for (PetscInt i = 0; i < b->turn * each; i++)
    if (!(fabs(g->given[i]) < LARGEST)) *ok = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is there and what is given goes to the places that particles have taken. */
static void SetMatrix(MpmBlochGained *g, const MpmBloch *b)
{
  const PetscInt n = g->order;

  for (PetscInt i = 0; i < n; i++) {
    double complex *to = g->matrix + g->to[i];

    for (PetscInt c = 0; c < n; c++) to[n * c] = c == i ? 1 : 0;
    for (PetscInt step = 0; step < b->turn; step++) {
      const PetscReal     *row    = g->given + (step * g->gains->numbers + g->number[i]) * 2 * b->width;
      const double complex weight = g->weight[step * n + i];

      for (PetscInt c = 0; c < n && weight != 0; c++) to[n * c] += weight * CMPLX(row[c], row[b->width + c]);
    }
    for (PetscInt c = 0; c < n; c++) to[n * c] *= g->times[i];
  }
}

/*
   Growth per step of a phase. ok is false, and growth is not set, where QR steps have not converged or the numbers of a
   turn might leave the range of doubles.
*/
static PetscErrorCode GainedGrowth(MpmBlochGained *g, MpmBloch *b, PetscReal courant, const PetscReal beta[],
                                   PetscReal *growth, PetscBool *ok)
{
  PetscReal largest = 1;

  PetscFunctionBegin;
  PetscCall(MpmBlochBegin(b, 1, &courant, beta, b->turn, g->order));
  SetPhase(g, b, beta);
  for (PetscInt step = 0; step < (g->products ? 1 : b->turn); step++) {
    MpmBlochSetStep(b, step);
    for (PetscInt y = 0; y < g->gains->numbers; y++) AddColumns(g, b, courant, step, y);
  }
  PetscCall(March(g, b, ok));
  if (!*ok) PetscFunctionReturn(PETSC_SUCCESS);
  SetMatrix(g, b);
  MpmSmallQr(g->order, g->matrix, g->value, ok);
  if (!*ok) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < g->order; i++) largest = PetscMax(largest, cabs(g->value[i]));
  *growth = MpmGrowthPerStep(largest, 0, b->turn);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- growth, by the shortest way ---- */

/* Growth by the matrices of a turn, of up to as many Courant numbers as there are lanes. */
static PetscErrorCode OfTurns(MpmBloch *bloch, MpmSmallEigen *eigen, PetscInt n, const PetscReal courant[],
                              const PetscReal beta[], PetscReal growth[], PetscReal without_null[])
{
  const PetscInt numbers = bloch->turn_size * bloch->turn_size;
  PetscInt       exponent[MPM_BLOCH_LANES];

  PetscFunctionBegin;
  PetscCall(MpmBlochTurns(bloch, n, courant, beta, bloch->turns, exponent));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal largest = 0;

    PetscCall(PetscArraycpy(eigen->matrix, bloch->turns + i * numbers, numbers));
    PetscCall(MpmSmallEigenSolve(eigen, PETSC_FALSE));
    for (PetscInt j = 0; j < eigen->n; j++) largest = PetscMax(largest, cabs(eigen->value[j]));
    growth[i]       = MpmGrowthPerStep(largest, exponent[i], bloch->turn);
    without_null[i] = bloch->nodal && bloch->nodal->all != MPM_NONE ? growth[i] : NAN;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the nodal operator is too large for doubles, growth is not that of the null space. */
PetscErrorCode MpmBlochGrowths(MpmBloch *bloch, MpmSmallEigen *eigen, PetscInt n, const PetscReal courant[],
                               const PetscReal beta[], PetscReal growth[], PetscReal without_null[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0, some; i < n; i += some) {
    PetscBool ok = PETSC_FALSE;

    some = bloch->nodal ? 1 : PetscMin(bloch->most, n - i);
    if (bloch->nodal)
      PetscCall(MpmBlochNodalGrowths(bloch->nodal, bloch, courant[i], beta, &growth[i], &without_null[i], &ok));
    if (bloch->gained) PetscCall(GainedGrowth(bloch->gained, bloch, courant[i], beta, &growth[i], &ok));
    if (bloch->gained) without_null[i] = NAN;
    if (!ok) PetscCall(OfTurns(bloch, eigen, some, courant + i, beta, growth + i, without_null + i));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
