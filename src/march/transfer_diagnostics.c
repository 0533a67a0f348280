/* Measures the weights C1 and C2, the source term and the ringing content of a march. */
#include <mpmstab/errors.h>
#include "march/transfer_diagnostics.h"
#include "scheme/maps.h"
#include <math.h>

static MPI_Comm CommOf(const MpmTransferDiagnostics *x)
{
  return PetscObjectComm((PetscObject)x->march->grid->da);
}

PetscErrorCode MpmTransferDiagnosticsCreate(MpmMarch *march, const MpmRequest *request,
                                            MpmTransferDiagnostics **diagnostics)
{
  const MpmScene         *scene = march->scene;
  MpmTransferDiagnostics *x;

  PetscFunctionBegin;
  *diagnostics = NULL;
  if (!request->weights && !request->source_term && !request->ringing) PetscFunctionReturn(PETSC_SUCCESS);
  MpmCheckInput(scene->layout.dim == 1,
                "%s true: C1, C2 and ringing are of the two sides of a node on a line; allowed: only with dim 1",
                request->weights       ? "weights"
                : request->source_term ? "source_term"
                                       : "ringing");
  MpmCheckInput(
      !request->source_term || !MpmSceneDrifts(scene) || march->slack,
      "source_term true: with drift %.6g particles leave what a rank with so few cells knows of its neighbours "
      "within a step; allowed: more cells, or fewer ranks",
      scene->step.drift[0].value);
  PetscCall(PetscNew(diagnostics));
  x          = *diagnostics;
  x->march   = march;
  x->request = request;
  PetscCall(DMCreateLocalVector(march->grid->da, &x->node));
  PetscCall(VecDuplicate(x->node, &x->other));
  if (request->source_term) PetscCall(VecDuplicate(x->node, &x->inverse_mass));
  if (request->ringing) PetscCall(MpmNodalSolveCreate(march, &x->solve));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTransferDiagnosticsDestroy(MpmTransferDiagnostics **diagnostics)
{
  PetscFunctionBegin;
  if (!*diagnostics) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDestroy(&(*diagnostics)->node));
  PetscCall(VecDestroy(&(*diagnostics)->other));
  PetscCall(VecDestroy(&(*diagnostics)->inverse_mass));
  PetscCall(MpmNodalSolveDestroy(&(*diagnostics)->solve));
  PetscCall(PetscFree(*diagnostics));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Sums phi_ip m_p of this rank's particles to the nodes. all: from all particles; left: from those at the left of the
   node.
*/
static void SumWeights(const MpmMarchArrays *at, PetscReal left[], PetscReal all[])
{
  const MpmMarch *march = at->march;
  const MpmBasis *basis = march->scheme->basis;

  for (PetscInt p = 0; p < march->particles->count; p++) {
    PetscInt  cell;
    PetscReal xi, row[MPM_MAX_REACH];

    MpmMarchPlaces(at, 0, 1, &at->cell[0][p], &at->xi[0][p], 0, &cell, &xi);
    MpmMapRow(basis, MPM_P2G, xi, march->layout->half_width[0], MpmNoWalls, row);
    for (PetscInt d = 0; d < MpmMapReach(basis); d++) {
      const PetscInt  node   = cell - basis->reach_left + d;
      const PetscReal weight = row[d] * (at->weight[MPM_MASS] ? at->weight[MPM_MASS][p] : 1);

      all[node] += weight;
      if (node > cell) left[node] += weight;
    }
  }
}

static PetscErrorCode Weights(MpmTransferDiagnostics *x, MpmTransferDiagnosticsSample *sample)
{
  const MpmGrid *grid    = x->march->grid;
  PetscReal      sums[2] = {0, 0}, ends[2] = {-INFINITY, -INFINITY}; /* of C1 and of nodes; -least and largest C1 */
  PetscReal     *array[2];
  MpmMarchArrays at = {.march = x->march};

  PetscFunctionBegin;
  PetscCall(MpmMarchGetArrays(x->march, x->march->particles->step, &at));
  PetscCall(VecSet(x->node, 0));
  PetscCall(VecSet(x->other, 0));
  PetscCall(MpmGridGetArray(grid, x->node, &array[0]));
  PetscCall(MpmGridGetArray(grid, x->other, &array[1]));
  SumWeights(&at, array[0], array[1]);
  PetscCall(MpmGridSum(grid, 2, array));
  for (PetscInt i = 0; i < grid->axis[0].nodes; i++) {
    const PetscReal c1 = array[0][i] / array[1][i];

    if (!(array[1][i] > 0)) continue;
    sums[0] += c1;
    sums[1] += 1;
    ends[0] = PetscMax(ends[0], -c1);
    ends[1] = PetscMax(ends[1], c1);
  }
  PetscCall(MpmGridRestoreArray(grid, x->other, &array[1]));
  PetscCall(MpmGridRestoreArray(grid, x->node, &array[0]));
  PetscCall(MpmMarchRestoreArrays(x->march, &at));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPI_SUM, CommOf(x)));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, ends, 2, MPIU_REAL, MPI_MAX, CommOf(x)));
  sample->c1_mean = sums[0] / sums[1];
  sample->c1_min  = -ends[0];
  sample->c1_max  = ends[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Returns the square root of a ratio of sums over the ranks. */
static PetscErrorCode Ratio(const MpmTransferDiagnostics *x, PetscReal part, PetscReal whole, PetscReal *ratio)
{
  PetscReal sums[2] = {part, whole};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPI_SUM, CommOf(x)));
  *ratio = sums[1] > 0 ? sqrt(sums[0] / sums[1]) : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Measures the source term of a field. x->node holds P2G of the field at the particles' places. */
static PetscErrorCode Source(MpmTransferDiagnostics *x, PetscInt field, PetscReal *source)
{
  const MpmGrid *grid = x->march->grid;
  PetscReal     *now, *next, change = 0;

  PetscFunctionBegin;
  PetscCall(MpmMarchProject(x->march, field, x->march->particles->step + 1, x->inverse_mass, x->other));
  PetscCall(MpmGridGetArray(grid, x->node, &now));
  PetscCall(MpmGridGetArray(grid, x->other, &next));
  for (PetscInt i = 0; i < grid->axis[0].nodes; i++) change += PetscSqr(next[i] - now[i]);
  PetscCall(Ratio(x, change, MpmSumSquares(grid->axis[0].nodes, now), source));
  PetscCall(MpmGridRestoreArray(grid, x->other, &next));
  PetscCall(MpmGridRestoreArray(grid, x->node, &now));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums over this rank's particles m_p times two squares: that of q less G2P of y, and that of q. */
static void Remainder(const MpmMarchArrays *at, const PetscReal q[], const PetscReal y[], PetscReal sums[2])
{
  const MpmMarch *march = at->march;
  const MpmBasis *basis = march->scheme->basis;

  for (PetscInt p = 0; p < march->particles->count; p++) {
    const PetscReal m    = at->weight[MPM_MASS] ? at->weight[MPM_MASS][p] : 1;
    PetscReal       rest = q[p], xi, row[MPM_MAX_REACH];
    PetscInt        cell, wall[2];

    MpmMarchPlaces(at, 0, 1, &at->cell[0][p], &at->xi[0][p], 0, &cell, &xi);
    MpmDirectionWalls(&march->layout->grid[0], march->grid->axis[0].first + cell, wall);
    MpmMapRow(basis, MPM_G2P, xi, march->layout->half_width[0], wall, row);
    for (PetscInt d = 0; d < MpmMapReach(basis); d++) rest -= row[d] * y[cell - basis->reach_left + d];
    sums[0] += m * rest * rest;
    sums[1] += m * q[p] * q[p];
  }
}

/* Measures the ringing content of a field. x->node holds P2G of the field at the particles' places. */
static PetscErrorCode Ringing(MpmTransferDiagnostics *x, PetscInt field, PetscReal *ringing)
{
  const MpmMarch    *march  = x->march;
  const MpmParity   *parity = MpmTableParity(march->scheme->table, field);
  PetscReal         *g, *y, sums[2] = {0, 0};
  MpmMarchArrays     at = {.march = march};
  KSPConvergedReason reason;

  PetscFunctionBegin;
  PetscCall(MpmMarchGetArrays(march, march->particles->step, &at));
  PetscCall(MpmGridGetArray(march->grid, x->node, &g));
  PetscCall(MpmGridGetArray(march->grid, x->other, &y));
  PetscCall(MpmNodalSolveApply(x->solve, &at, march->particles->step, parity, g, y, &reason));
  Remainder(&at, at.particle[field], y, sums);
  PetscCall(MpmGridRestoreArray(march->grid, x->other, &y));
  PetscCall(MpmGridRestoreArray(march->grid, x->node, &g));
  PetscCall(MpmMarchRestoreArrays(march, &at));
  PetscCall(Ratio(x, sums[0], sums[1], ringing));
  if (reason <= 0) *ringing = NAN; /* the solve does not converge where particles almost coincide */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps the first, last and largest values. fmin and fmax ignore NaN. */
static void Keep(MpmTransferDiagnostics *x, const MpmTransferDiagnosticsSample *sample)
{
  MpmTransferDiagnosticsSample *most = &x->most;

  x->last = *sample;
  if (!x->measured) x->first = *most = *sample;
  x->measured   = PETSC_TRUE;
  most->c1_min  = fmin(most->c1_min, sample->c1_min);
  most->c1_mean = fmax(most->c1_mean, sample->c1_mean);
  most->c1_max  = fmax(most->c1_max, sample->c1_max);
  for (PetscInt f = 0; f < MPM_MAX_FIELDS; f++) {
    most->source[f]  = fmax(most->source[f], sample->source[f]);
    most->ringing[f] = fmax(most->ringing[f], sample->ringing[f]);
  }
}

PetscErrorCode MpmTransferDiagnosticsMeasure(MpmTransferDiagnostics *x)
{
  MpmTransferDiagnosticsSample sample = {.c1_mean = NAN, .c1_min = NAN, .c1_max = NAN};

  PetscFunctionBegin;
  if (x->request->weights) PetscCall(Weights(x, &sample));
  for (PetscInt f = 0; f < x->march->scheme->table->nstate; f++) {
    sample.source[f] = sample.ringing[f] = NAN;
    if (!x->request->source_term && !x->request->ringing) continue;
    PetscCall(MpmMarchProject(x->march, f, x->march->particles->step, NULL, x->node));
    if (x->request->source_term) PetscCall(Source(x, f, &sample.source[f]));
    if (x->request->ringing) PetscCall(Ringing(x, f, &sample.ringing[f]));
  }
  Keep(x, &sample);
  PetscFunctionReturn(PETSC_SUCCESS);
}
