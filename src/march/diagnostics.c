/*
   Diagnostics of a run: norms of the state (of all particle fields, the formulation's energy, and that energy on the
   grid), sums that it must conserve, and errors against an exact solution.

   By partition of unity the masses of the nodes add up to those of the particles. sum_p m_p P2G is adjoint to G2P, and
   DIV of anything sums to 0. So momentum schemes conserve sum_p m_p v_p where no wall acts on them, with every
   transfer.

   There is one exception. A particle that is on a node, alone in its cell, has weight 0 at the cell's other node but a
   slope there. A force on that node, which has no mass, moves nothing. It occurs for bars that drift through an empty
   grid.
*/
#include "march/diagnostics.h"
#include "march/finite.h"
#include "scene/material.h"
#include "scene/solution.h"
#include <math.h>

/* ---- norms ---- */

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

/* squares: of the registers of the state, where all particles are alike. */
typedef struct {
  MpmMarchArrays at;
  PetscReal      squares[MPM_MAX_FIELDS];
} State;

/* The sum of squares of a register of the state, weighted by volume, or as in a term of the energy. */
static PetscReal ParticleSquares(const State *s, PetscInt r, const MpmEnergyTerm *term)
{
  const PetscReal *q = s->at.particle[r], *weight = s->at.weight[term && !term->stress ? MPM_MASS : MPM_VOLUME];
  const PetscReal *stiffness = term && term->stress ? s->at.weight[MPM_STIFFNESS] : NULL;
  PetscReal        sum       = 0;

  if (!Differ(s->at.march->layout)) return s->squares[r];
  for (PetscInt p = 0; p < s->at.march->particles->count; p++)
    sum += q[p] * q[p] * (weight ? weight[p] : 1) / (stiffness ? stiffness[p] : 1);
  return sum;
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
static PetscReal NodeSquares(const MpmGrid *grid, const PetscReal f[], PetscBool differences)
{
  PetscReal sum = 0;

  for (PetscInt a = 0; a < (differences ? grid->dim : 1); a++) {
    MpmGridBox box = MpmGridBoxOf(grid, 0);

    if (differences) box.hi[a] = grid->axis[a].count;
    for (PetscInt r = 0; r < MpmGridRows(&box); r++)
      sum += RowSquares(box.hi[0], differences ? grid->axis[a].stride : 0, f + MpmGridRow(grid, &box, r));
  }
  return sum;
}

/* The squares of the node fields that the registers of a particle field, or all with MPM_NONE, are sent to. */
static PetscReal SeenSquares(const MpmMarchArrays *at, PetscInt field)
{
  const MpmTable *table                 = at->march->scheme->table;
  PetscBool       taken[MPM_MAX_FIELDS] = {PETSC_FALSE};
  PetscReal       sum                   = 0;

  for (PetscInt r = 0; r < table->nstate; r++) {
    const MpmOp *seen = MpmTableSeenBy(table, r);

    if (!seen || taken[seen->dst] || (field != MPM_NONE && table->field[r] != field)) continue;
    if (field != MPM_NONE) taken[seen->dst] = PETSC_TRUE; /* components of a stress are sent to one field */
    sum += CellVolume(at->march) * NodeSquares(at->march->grid, at->node[seen->dst], PETSC_FALSE);
  }
  return sum;
}

/*
   The energy of a stress s with the components 00 01 02 11 12 22, twice: s : C^-1 s = s : s / (2 mu) -
   lambda tr(s)^2 / (2 mu (d lambda + 2 mu)), in units of rho c^2 = lambda + 2 mu.
*/
static PetscReal StressSquares(const MpmMarchArrays *at, PetscInt first)
{
  const PetscInt   dim = at->march->layout->dim, count = at->march->particles->count;
  const PetscReal  nu     = at->march->scheme->space.poisson;
  const PetscReal *weight = at->weight[MPM_VOLUME], *stiffness = at->weight[MPM_STIFFNESS];
  const PetscReal *own = at->weight[MPM_LAMBDA], *shear = at->weight[MPM_SHEAR];
  PetscReal        trace[MPM_BLOCK], squares[MPM_BLOCK], sum = 0;

  for (PetscInt begin = 0; begin < count; begin += MPM_BLOCK) {
    const PetscInt n = PetscMin(count - begin, MPM_BLOCK);

    for (PetscInt p = 0; p < n; p++) trace[p] = squares[p] = 0;
    for (PetscInt a = 0, c = first; a < dim; a++)
      for (PetscInt b = a; b < dim; b++, c++) {
        const PetscReal *q = at->particle[c] + begin;

        for (PetscInt p = 0; p < n; p++) squares[p] += (a == b ? 1 : 2) * q[p] * q[p];
        for (PetscInt p = 0; p < n && a == b; p++) trace[p] += q[p];
      }
    for (PetscInt p = 0; p < n; p++) {
      const PetscReal over   = stiffness ? stiffness[begin + p] : 1;
      const PetscReal lambda = own ? own[begin + p] / over : nu / (1 - nu);
      const PetscReal mu     = own ? shear[begin + p] / over : (1 - 2 * nu) / (2 * (1 - nu));

      sum += (weight ? weight[begin + p] : 1) / (2 * mu * over) *
             (squares[p] - lambda / (dim * lambda + 2 * mu) * trace[p] * trace[p]);
    }
  }
  return sum;
}

/* The sum of squares of a particle field over its components, as in a term of the energy. */
static PetscReal TermSquares(const State *s, const MpmEnergyTerm *term)
{
  const MpmTable *table = s->at.march->scheme->table;
  PetscInt        first = 0, n = 0;
  PetscReal       sum = 0;

  while (table->field[first] != term->field) first++;
  while (first + n < table->nstate && table->field[first + n] == term->field) n++;
  if (term->stress && n > 1) return StressSquares(&s->at, first);
  for (PetscInt r = first; r < first + n; r++) sum += ParticleSquares(s, r, term);
  return sum;
}

PetscErrorCode MpmMarchNorms(const MpmMarch *march, MpmNorms *norms)
{
  const PetscInt  terms   = MpmSchemeEnergyTerms(march->scheme);
  const PetscReal h       = CellVolume(march);
  PetscReal       sums[3] = {0, 0, 0};
  State           s       = {.at = {.march = march}};

  PetscFunctionBegin;
  if (march->particles->own) {
    PetscCall(MpmFiniteNorms(march, norms));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmMarchGetArrays(march, march->particles->step, &s.at));
  for (PetscInt r = 0; r < march->scheme->table->nstate; r++) {
    if (!Differ(march->layout)) s.squares[r] = MpmSumSquares(march->particles->count, s.at.particle[r]);
    sums[0] += h / MpmLayoutPpc(march->layout) * ParticleSquares(&s, r, NULL);
  }
  if (!terms) sums[2] = SeenSquares(&s.at, MPM_NONE);
  for (const MpmEnergyTerm *term = march->scheme->formulation->energy;
       terms && term < march->scheme->formulation->energy + terms; term++) {
    PetscReal squares;

    if (term->place == MPM_ON_PARTICLES) {
      sums[2] += SeenSquares(&s.at, term->field);
      squares = TermSquares(&s, term) / MpmLayoutPpc(march->layout);
    } else {
      squares = NodeSquares(march->grid, s.at.node[term->field], PETSC_TRUE);
      sums[2] += h * squares;
    }
    sums[1] += h * squares;
  }
  PetscCall(MpmMarchRestoreArrays(march, &s.at));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPI_SUM, PetscObjectComm((PetscObject)march->grid->da)));
  norms->state  = sqrt(sums[0]);
  norms->energy = terms ? sums[1] / 2 : NAN;
  norms->grid   = sqrt(sums[2] / 2);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- sums that are conserved ---- */

/* Adds the sums of m q and of its size over this rank's particles. */
static void SumParticles(const MpmMarchArrays *at, PetscInt field, PetscReal sums[2])
{
  const PetscReal *mass = at->weight[MPM_MASS], *q = at->particle[field];

  for (PetscInt p = 0; p < at->march->particles->count; p++) {
    const PetscReal momentum = mass ? mass[p] * q[p] : q[p];

    sums[0] += momentum;
    sums[1] += fabs(momentum);
  }
}

/* The mass of a node at a wall includes that of its image, in every step. */
static PetscReal SumNodes(const MpmGrid *grid, const PetscReal inverse[])
{
  const MpmGridBox box = MpmGridBoxOf(grid, 0);
  PetscReal        sum = 0;

  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscReal *row = inverse + MpmGridRow(grid, &box, r);

    for (PetscInt i = 0; i < box.hi[0]; i++) sum += row[i] > 0 ? 1 / row[i] : 0;
  }
  return sum;
}

/* Whether some wall stops a component of the velocity. */
static PetscBool IsStopped(const MpmLayout *layout, PetscInt component)
{
  for (PetscInt a = 0; a < layout->dim; a++)
    for (int end = 0; end < 2; end++)
      if (MpmEndIsOdd(layout->grid[a].ends[end], a == component ? MPM_NORMAL : MPM_TANGENTIAL)) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode MpmConservedSum(const MpmMarch *march, MpmConserved *c)
{
  const MpmTable *table                    = march->scheme->table;
  const PetscInt  field                    = march->scheme->formulation->conserved;
  PetscReal       sums[MPM_MAX_DIM + 1][2] = {{0}}, affine[2] = {0, 0};
  MPI_Comm        comm = PetscObjectComm((PetscObject)march->grid->da);
  MpmMarchArrays  at   = {.march = march};

  PetscFunctionBegin;
  PetscCall(MpmMarchGetArrays(march, march->particles->step, &at));
  *c                   = (MpmConserved){.particles = march->particles->count, .exponent = march->exponent};
  sums[MPM_MAX_DIM][0] = SumNodes(march->grid, at.sum[MPM_MASSES]);
  for (PetscInt r = 0; r < table->nstate; r++) {
    const PetscInt component = table->component[r];

    if (r >= table->affine_part && table->affine != MPM_NONE) /* nodes get it too, and its sum over them is 0 */
      SumParticles(&at, r, affine);
    if (field == MPM_NONE || table->field[r] != field || IsStopped(march->layout, component)) continue;
    c->has_momentum = PETSC_TRUE;
    SumParticles(&at, r, sums[component]);
  }
  PetscCall(MpmMarchRestoreArrays(march, &at));
  sums[0][1] += affine[1];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &c->particles, 1, MPIU_INT64, MPI_SUM, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2 * (MPM_MAX_DIM + 1), MPIU_REAL, MPI_SUM, comm));
  c->mass = sums[MPM_MAX_DIM][0];
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) {
    c->momentum[a] = sums[a][0];
    c->size += sums[a][1];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmConservedCheck(const MpmMarch *march, const MpmConserved *before, PetscReal changes[2])
{
  MpmConserved now;
  PetscReal    scale;

  PetscFunctionBegin;
  PetscCall(MpmConservedSum(march, &now));
  scale      = scalbn(1, (int)(before->exponent - now.exponent));
  changes[0] = fabs(now.mass - before->mass) / before->mass;
  changes[1] = NAN;
  if (now.has_momentum) {
    PetscReal largest = 0;

    for (PetscInt a = 0; a < MPM_MAX_DIM; a++)
      largest = PetscMax(largest, fabs(now.momentum[a] - scale * before->momentum[a]));
    changes[1] = largest / PetscMax(now.size, scale * before->size);
  }
  PetscCheck(now.particles == before->particles, PETSC_COMM_WORLD, PETSC_ERR_PLIB,
             "%" PetscInt64_FMT " particles at step %" PetscInt64_FMT ", %" PetscInt64_FMT " at the start",
             now.particles, march->step, before->particles);
  PetscCheck(changes[0] <= MPM_MASS_ROUNDING, PETSC_COMM_WORLD, PETSC_ERR_PLIB,
             "the nodes' mass at step %" PetscInt64_FMT " is %.17g, %.17g at the start", march->step, now.mass,
             before->mass);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- errors ----

   At small strain these are of the state at a particle's Lagrangian coordinate X = x - U0 t, weighted by volume. At
   finite strain they are of places, velocities and deformation gradients. A place in a periodic direction is off by the
   shortest way. Of a gas the density is known: that at rest over F.
*/

/* What is measured: place along an axis, or a state register where that is MPM_NONE. size: of the exact solution. */
typedef struct {
  PetscInt  axis, r;
  PetscReal size;
} Measured;

/* solution: at finite strain. scale: the state is so many times what it would be with the exponent of the start. */
typedef struct {
  MpmMarchArrays     at;
  const MpmSolution *solution;
  MpmProfile         profile;
  PetscReal          scale;
} Errors;

static PetscInt List(const MpmScene *scene, const Errors *e, Measured measured[])
{
  const MpmTable *t = scene->scheme.table;
  PetscReal       size[3];
  PetscInt        n = 0;

  if (!e->solution)
    for (; n < t->nstate; n++)
      measured[n] = (Measured){MPM_NONE, n, scene->scheme.formulation->wave->amplitude(&e->profile, t->field[n])};
  if (!e->solution) return n;
  e->solution->sizes(scene, size);
  for (PetscInt a = 0; a < scene->layout.dim && !e->solution->density; a++)
    measured[n++] = (Measured){a, MPM_NONE, size[0]};
  for (PetscInt r = 0; r < t->nstate; r++)
    if (t->field[r] != MPM_NONE)
      measured[n++] = (Measured){MPM_NONE, r, t->field[r] == MPM_STRETCHED ? size[2] : size[1] / scene->wave_speed};
  return n;
}

/* The error at particle p. */
static PetscReal ErrorAt(const Errors *e, const Measured *m, PetscInt p, PetscReal t)
{
  const MpmMarch    *march    = e->at.march;
  const MpmScene    *scene    = march->scene;
  const MpmSolution *solution = e->solution;
  MpmSolutionState   state;
  PetscReal          X[MPM_MAX_DIM], x[MPM_MAX_DIM], exact, density;

  MpmParticlesLagrangian(march->particles, e->at.id[p], scene->cell_width, X);
  if (!solution) return e->at.particle[m->r][p] - e->scale * MpmSceneExact(scene, &e->profile, m->r, X, t);
  for (PetscInt a = 0; a < march->grid->dim; a++)
    x[a] = scene->cell_width * (march->grid->axis[a].first + e->at.cell[a][p] + e->at.xi[a][p]);
  if (m->axis != MPM_NONE) {
    solution->exact(scene, X, x, t, &state);
    exact = x[m->axis] - state.place[m->axis];
    return scene->layout.grid[m->axis].ends[0] == MPM_PERIODIC ? remainder(exact, scene->length[m->axis]) : exact;
  }
  exact = MpmSolutionRegister(scene, m->r, X, x, t);
  if (!solution->density || scene->scheme.table->field[m->r] != MPM_STRETCHED) return e->at.particle[m->r][p] - exact;
  density = MpmMaterialDensity(&scene->layout, (PetscReal[]){X[0] / scene->cell_width});
  return density / e->at.particle[m->r][p] - density / exact;
}

/* Over this rank: the sums of V abs(e) and V e^2, and the largest abs(e). */
static void LocalSums(const Errors *e, const Measured *m, PetscReal sums[3])
{
  const MpmMarch  *march  = e->at.march;
  const PetscReal  t      = MpmMarchTime(march, march->step);
  const PetscReal *volume = e->solution ? NULL : e->at.weight[MPM_VOLUME];

  sums[0] = sums[1] = sums[2] = 0;
  for (PetscInt p = 0; p < march->particles->count; p++) {
    const PetscReal V = volume ? volume[p] : 1, error = fabs(ErrorAt(e, m, p, t));

    sums[0] += V * error;
    sums[1] += V * error * error;
    if (!(error <= sums[2])) sums[2] = error; /* NaN is the largest */
  }
}

PetscErrorCode MpmDiagnosticsErrors(const MpmMarch *march, MpmError error[])
{
  const MpmScene *scene = march->scene;
  const MPI_Comm  comm  = PetscObjectComm((PetscObject)march->grid->da);
  const PetscBool full  = !scene->scheme.space.finite && MpmSceneIsFull(scene) ? PETSC_TRUE : PETSC_FALSE;
  /* the sum of all volumes: in a full grid it is ppc a cell, however many particles share the cell */
  const PetscReal volume = full ? (PetscReal)MpmLayoutCells(&scene->layout) * MpmLayoutPpc(&scene->layout)
                                : (PetscReal)scene->layout.particles;
  const int start = ilogb(scene->amplitude), grown = scene->scheme.space.finite ? 0 : (int)march->exponent - start;
  Errors    e = {.at = {.march = march}, .scale = scalbn(1, -grown)};
  Measured  measured[MPM_MOST_ERRORS];
  PetscInt  n;

  PetscFunctionBegin;
  if (scene->scheme.space.finite)
    e.solution = MpmSolutionOf(scene);
  else
    e.profile = MpmSceneProfile(scene, scalbn(scene->amplitude, -start));
  n = List(scene, &e, measured);
  PetscCall(MpmMarchGetArrays(march, march->particles->step, &e.at));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal sums[3];

    LocalSums(&e, &measured[i], sums);
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPI_SUM, comm));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sums[2], 1, MPIU_REAL, MPI_MAX, comm));
    error[i].l1   = scalbn(sums[0] / volume / measured[i].size, grown);
    error[i].l2   = scalbn(sqrt(sums[1] / volume) / measured[i].size, grown);
    error[i].linf = scalbn(sums[2] / measured[i].size, grown);
  }
  PetscCall(MpmMarchRestoreArrays(march, &e.at));
  PetscFunctionReturn(PETSC_SUCCESS);
}
