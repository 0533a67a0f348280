/* Norms of the state: of all particle fields, the formulation's energy, and that energy on the grid. */
#include "march/finite_state.h"
#include <math.h>

static PetscBool Differ(const MpmLayout *layout)
{
  return layout->varies[MPM_MASS] || layout->varies[MPM_STIFFNESS] ? PETSC_TRUE : PETSC_FALSE;
}

static PetscReal CellVolume(const MpmMarch *march)
{
  PetscReal volume = 1;

  for (PetscInt a = 0; a < march->layout->dim; a++) volume *= march->cell_width;
  return volume;
}

PetscErrorCode MpmMarchGetProperty(const MpmMarch *march, MpmProperty property, const PetscReal **values)
{
  PetscFunctionBegin;
  *values = NULL;
  if (march->layout->varies[property]) PetscCall(MpmParticlesGet(march->particles, MpmPropertyNames[property], values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchRestoreProperty(const MpmMarch *march, MpmProperty property, const PetscReal **values)
{
  PetscFunctionBegin;
  if (*values) PetscCall(MpmParticlesRestore(march->particles, MpmPropertyNames[property], values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The sum of squares of a field, weighted by volume, or as in a term of the energy. Where particles differ they are
   gone through again at each sample.
*/
static PetscErrorCode WeighedSquares(const MpmMarch *march, const MpmEnergyTerm *term, const PetscReal q[],
                                     PetscReal *sum)
{
  const MpmProperty by     = term && !term->stress ? MPM_MASS : MPM_VOLUME;
  const PetscBool   stress = term && term->stress ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal  *weight, *stiffness;

  PetscFunctionBegin;
  PetscCall(MpmMarchGetProperty(march, by, &weight));
  PetscCall(MpmMarchGetProperty(march, MPM_STIFFNESS, &stiffness));
  *sum = 0;
  for (PetscInt p = 0; p < march->particles->count; p++)
    *sum += q[p] * q[p] * (weight ? weight[p] : 1) / (stress && stiffness ? stiffness[p] : 1);
  PetscCall(MpmMarchRestoreProperty(march, MPM_STIFFNESS, &stiffness));
  PetscCall(MpmMarchRestoreProperty(march, by, &weight));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of squares of a particle field. The passes of a sampled step have computed it, but for the first step. */
static PetscErrorCode ParticleSquares(const MpmMarch *march, PetscInt field, const MpmEnergyTerm *term, PetscReal *sum)
{
  const char     *name   = march->scheme->table->fields[field];
  const PetscBool differ = Differ(march->layout);
  PetscReal      *q;

  PetscFunctionBegin;
  *sum = march->squares[field];
  if (march->step > 0 && !differ) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmParticlesGet(march->particles, name, &q));
  if (differ)
    PetscCall(WeighedSquares(march, term, q, sum));
  else
    *sum = MpmSumSquares(march->particles->count, q);
  PetscCall(MpmParticlesRestore(march->particles, name, &q));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The squares of a row of n nodes, or of its differences to the nodes stride further on. */
static PetscReal RowSquares(PetscInt n, PetscInt stride, const PetscReal f[])
{
  PetscReal sum = 0;

  if (!stride) return MpmSumSquares(n, f);
  for (PetscInt i = 0; i < n; i++) sum += PetscSqr(f[i + stride] - f[i]);
  return sum;
}

/* The sum of squares of a node field, or of its differences over cells, along all axes. */
static PetscErrorCode NodeSquares(const MpmMarch *march, PetscInt field, PetscBool differences, PetscReal *sum)
{
  const MpmGrid *grid = march->grid;
  PetscReal     *f;

  PetscFunctionBegin;
  *sum = 0;
  PetscCall(MpmGridGetArray(grid, march->node[field], &f));
  for (PetscInt a = 0; a < (differences ? grid->dim : 1); a++) {
    MpmGridBox box = MpmGridBoxOf(grid, 0);

    if (differences) box.hi[a] = grid->axis[a].count;
    for (PetscInt r = 0; r < MpmGridRows(&box); r++)
      *sum += RowSquares(box.hi[0], differences ? grid->axis[a].stride : 0, f + MpmGridRow(grid, &box, r));
  }
  PetscCall(MpmGridRestoreArray(grid, march->node[field], &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the squares of the node fields that the registers of a particle field, or all with MPM_NONE, are sent to. */
static PetscErrorCode SeenSquares(const MpmMarch *march, PetscInt field, PetscReal *sum)
{
  const MpmTable *table                 = march->scheme->table;
  PetscBool       taken[MPM_MAX_FIELDS] = {PETSC_FALSE};

  PetscFunctionBegin;
  for (PetscInt r = 0; r < table->nstate; r++) {
    const MpmOp *seen = MpmTableSeenBy(table, r);
    PetscReal    squares;

    if (!seen || taken[seen->dst] || (field != MPM_NONE && table->field[r] != field)) continue;
    if (field != MPM_NONE) taken[seen->dst] = PETSC_TRUE; /* components of a stress are sent to one field */
    PetscCall(NodeSquares(march, seen->dst, PETSC_FALSE, &squares));
    *sum += CellVolume(march) * squares;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The energy of a stress s with the components 00 01 02 11 12 22, twice: s : C^-1 s = s : s / (2 mu) -
   lambda tr(s)^2 / (2 mu (d lambda + 2 mu)), in units of rho c^2 = lambda + 2 mu. Here of particles that differ.
*/
static PetscErrorCode WeighedStressSquares(const MpmMarch *march, PetscInt first, PetscReal *sum)
{
  const PetscInt   dim = march->layout->dim, n = dim * (dim + 1) / 2;
  const PetscReal  nu = march->scheme->space.poisson, lambda = nu / (1 - nu), mu = (1 - 2 * nu) / (2 * (1 - nu));
  const PetscReal *weight, *stiffness;
  PetscReal       *s[MPM_MAX_DIM * (MPM_MAX_DIM + 1) / 2];

  PetscFunctionBegin;
  for (PetscInt c = 0; c < n; c++)
    PetscCall(MpmParticlesGet(march->particles, march->scheme->table->fields[first + c], &s[c]));
  PetscCall(MpmMarchGetProperty(march, MPM_VOLUME, &weight));
  PetscCall(MpmMarchGetProperty(march, MPM_STIFFNESS, &stiffness));
  *sum = 0;
  for (PetscInt p = 0; p < march->particles->count; p++) {
    PetscReal trace = 0, squares = 0;

    for (PetscInt a = 0, c = 0; a < dim; a++) {
      for (PetscInt b = a; b < dim; b++, c++) {
        squares += (a == b ? 1 : 2) * s[c][p] * s[c][p];
        trace += a == b ? s[c][p] : 0;
      }
    }
    squares = squares / (2 * mu) - lambda / (2 * mu * (dim * lambda + 2 * mu)) * trace * trace;
    *sum += squares * (weight ? weight[p] : 1) / (stiffness ? stiffness[p] : 1);
  }
  PetscCall(MpmMarchRestoreProperty(march, MPM_STIFFNESS, &stiffness));
  PetscCall(MpmMarchRestoreProperty(march, MPM_VOLUME, &weight));
  for (PetscInt c = 0; c < n; c++)
    PetscCall(MpmParticlesRestore(march->particles, march->scheme->table->fields[first + c], &s[c]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of particles that are alike. The squares of the components are known: only those of the trace are to sum. */
static PetscErrorCode StressSquares(const MpmMarch *march, PetscInt first, PetscReal *sum)
{
  const PetscInt  dim = march->layout->dim, count = march->particles->count;
  const PetscReal nu = march->scheme->space.poisson, lambda = nu / (1 - nu), mu = (1 - 2 * nu) / (2 * (1 - nu));
  PetscReal       trace[MPM_BLOCK], *s[MPM_MAX_DIM], squares, of_trace = 0;
  PetscInt        field[MPM_MAX_DIM]; /* of the diagonal's components */

  PetscFunctionBegin;
  *sum = 0;
  for (PetscInt a = 0, c = first; a < dim; a++) {
    field[a] = c;
    for (PetscInt b = a; b < dim; b++, c++) {
      PetscCall(ParticleSquares(march, c, NULL, &squares));
      *sum += (a == b ? 1 : 2) * squares / (2 * mu);
    }
  }
  for (PetscInt a = 0; a < dim; a++)
    PetscCall(MpmParticlesGet(march->particles, march->scheme->table->fields[field[a]], &s[a]));
  for (PetscInt p = 0; p < count; p += MPM_BLOCK) {
    const PetscInt n = PetscMin(count - p, MPM_BLOCK);

    MpmNodeCopy(0, n, 1, s[0] + p, trace);
    for (PetscInt a = 1; a < dim; a++) MpmNodeAdd(0, n, 1, s[a] + p, trace);
    of_trace += MpmSumSquares(n, trace);
  }
  for (PetscInt a = 0; a < dim; a++)
    PetscCall(MpmParticlesRestore(march->particles, march->scheme->table->fields[field[a]], &s[a]));
  *sum -= lambda / (2 * mu * (dim * lambda + 2 * mu)) * of_trace;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of squares of a particle field over its components, as in a term of the energy. */
static PetscErrorCode TermSquares(const MpmMarch *march, const MpmEnergyTerm *term, PetscReal *sum)
{
  const MpmTable *table = march->scheme->table;
  PetscInt        first = 0, n = 0;

  PetscFunctionBegin;
  while (table->field[first] != term->field) first++;
  while (first + n < table->nstate && table->field[first + n] == term->field) n++;
  *sum = 0;
  if (term->stress && n > 1) {
    if (Differ(march->layout) || march->layout->varies[MPM_VOLUME])
      PetscCall(WeighedStressSquares(march, first, sum));
    else
      PetscCall(StressSquares(march, first, sum));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt r = first; r < first + n; r++) {
    PetscReal squares;

    PetscCall(ParticleSquares(march, r, term, &squares));
    *sum += squares;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchNorms(const MpmMarch *march, MpmNorms *norms)
{
  const MpmTable       *table       = march->scheme->table;
  const MpmFormulation *formulation = march->scheme->formulation;
  const PetscInt        terms       = MpmSchemeEnergyTerms(march->scheme);
  const PetscReal       h           = CellVolume(march);
  PetscReal             sums[3]     = {0, 0, 0}, squares;

  PetscFunctionBegin;
  if (march->particles->own) {
    PetscCall(MpmFiniteNorms(march, norms));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt f = 0; f < table->nstate; f++) {
    PetscCall(ParticleSquares(march, f, NULL, &squares));
    sums[0] += h / MpmLayoutPpc(march->layout) * squares;
  }
  if (!terms) PetscCall(SeenSquares(march, MPM_NONE, &sums[2]));
  for (PetscInt t = 0; t < terms; t++) {
    const MpmEnergyTerm *term = &formulation->energy[t];

    if (term->place == MPM_ON_PARTICLES) {
      PetscCall(SeenSquares(march, term->field, &sums[2]));
      PetscCall(TermSquares(march, term, &squares));
      squares /= MpmLayoutPpc(march->layout);
    } else {
      PetscCall(NodeSquares(march, term->field, PETSC_TRUE, &squares));
      sums[2] += h * squares;
    }
    sums[1] += h * squares;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPI_SUM, PetscObjectComm((PetscObject)march->grid->da)));
  norms->state  = sqrt(sums[0]);
  norms->energy = terms ? sums[1] / 2 : NAN;
  norms->grid   = sqrt(sums[2] / 2);
  PetscFunctionReturn(PETSC_SUCCESS);
}
