/*
   A table about a state, and its differential as a program. With w the weights of a map, w_c their derivatives along c,
   M the nodal masses and dx the perturbation of the places that the weights are of:

     P2G    y = a (sum w m q) / M          dy = a (sum w m dq + sum_c sum w_c m q dx_c) / M - y dM / M
     mass   M = sum w m                    dM = sum_c sum w_c m dx_c
     G2P    q += a sum w u                 dq += a sum w du + a sum_c (sum w_c u) dx_c
     STRESS t = tau(F)                     dt = sum dtau/dF_ab dF_ab
     VISCOUS t += q(L)                     dt += sum dq/dL_ab dL_ab
     STRESS_AHEAD T = T(L, F)              dT = sum dT/dL_ab dL_ab + sum dT/dF_ab dF_ab
     IMPLICIT a = k f(k (v + theta a))     (1 - k^2 theta f') da = k df at the same a, f' the derivative by w = k (v + theta a)
     LOAD   b                              db = 0
     COLLIDE y += P(u) - u                 dy += dP/du du - du, of the branch of P that u is on
     STRETCH F = A F, A = I + L + a L L    dF = A dF + (dL + a (dL L + L dL)) F
     RETURN F = R(F), with the internal variables of the material      dF = sum dR/dF_ab dF_ab

     ADVANCE x += way       dx += dway. In the middle of a step weights and masses are made anew there, and dx_c is that of these places

   All weights are those of the start of the step, or of its last ADVANCE. Operations that are linear with constant
   numbers are their own differentials.
*/
#include "operator/tangent.h"
#include "march/finite.h"
#include "scene/material.h"
#include "scheme/deform.h"
#include <mpmstab/errors.h>
#include <math.h>

#define MOST_NEWTON 40
#define CONVERGED 1e-11 /* as far as rounding lets it, which Newton's method reaches within a step or two from there */

static const MpmParity even[MPM_MAX_DIM] = {MPM_EVEN, MPM_EVEN, MPM_EVEN};

/*
   The registers of the program: those of the table's particles, then the places, their perturbation where the weights
   are made, and a copy of dF; on nodes those of the table, and the mass.
*/
typedef struct {
  PetscInt place, start, copy, node, mass;
} Slots;

static Slots SlotsOf(const MpmTable *t)
{
  Slots s;

  s.place = t->nparticles;
  s.start = s.place + t->dim;
  s.copy  = s.start + t->dim;
  s.node  = s.copy + MpmTableStretches(t);
  s.mass  = s.node + t->nnodes;
  return s;
}

/*
   program: the tangent. values: what the registers hold in the step itself, and value its vectors. weight: properties
   of particles, NULL where they are 1. inverse: of the nodal masses.
*/
typedef struct {
  const MpmSlab           *sizes;
  const MpmTable          *table;
  PetscReal                courant, time;
  Slots                    slot;
  MpmMaps                  maps;
  MpmStepProgram          *program;
  MpmVectors              *values;
  const Vec               *load;
  const MpmParticlePlaces *start; /* the places at the start of the step; moved: those after an ADVANCE in its middle */
  Vec                     *value, weight[MPM_PROPERTIES], inverse;
  MpmParticlePlaces        moved;
  PetscBool                inverted; /* a particle has no positive volume in the middle of a step */
  MpmBranch                branch;
  PetscInt64               on_surface, met; /* met: in the last slope */
} Builder;

/* ---- the space ---- */

/* Particles go anywhere, and may fill any shape. So each rank has as many, in the order of their ids. */
static PetscErrorCode Share(MpmSlab *r, PetscInt64 particles)
{
  PetscInt all = (PetscInt)particles;

  PetscFunctionBegin;
  r->particles = PETSC_DECIDE;
  PetscCall(PetscSplitOwnership(r->comm, &r->particles, &all));
  PetscCallMPI(MPI_Scan(&r->particles, &r->begin, 1, MPIU_INT, MPI_SUM, r->comm));
  r->begin -= r->particles;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentSpaceCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme,
                                     MpmTangentSpace *space)
{
  const MpmTable *t    = scheme->table;
  const MpmStep   rest = {.courant = 0};
  const Slots     slot = SlotsOf(t);
  MpmRegisters    r;

  PetscFunctionBegin;
  PetscCall(MpmSlabOf(comm, layout, scheme, &rest, &space->sizes));
  PetscCall(Share(&space->sizes, layout->particles));
  space->branch = MPM_BRANCH_OWN;
  space->nstate = t->dim + t->nstate;
  r             = (MpmRegisters){.comm = comm,
                                 .rows = {space->sizes.particles, space->sizes.nodes},
                                 .n    = {slot.node, t->nnodes + 1},
                                 .nin  = space->nstate,
                                 .nout = space->nstate};
  for (PetscInt f = 0; f < r.nin; f++) r.in[f] = r.out[f] = f < t->dim ? slot.place + f : f - t->dim;
  PetscCall(MpmVectorsCreate(&r, &space->work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentSpaceDestroy(MpmTangentSpace *space)
{
  PetscFunctionBegin;
  PetscCall(MpmVectorsDestroy(&space->work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentStateCreate(const MpmTangentSpace *space, MpmTangentState *state)
{
  const MpmSlab *r = &space->sizes;

  PetscFunctionBegin;
  *state = (MpmTangentState){.field = {NULL}};
  for (PetscInt a = 0; a < r->layout->dim; a++) {
    PetscCall(PetscCalloc2(r->particles, &state->places.cell[a], r->particles, &state->places.xi[a]));
    PetscCall(MpmRegisterVector(&space->work->registers, 0, &state->load[a]));
  }
  for (PetscInt f = 0; f < r->scheme->table->nstate; f++)
    PetscCall(MpmRegisterVector(&space->work->registers, 0, &state->field[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentStateDestroy(const MpmTangentSpace *space, MpmTangentState *state)
{
  const MpmSlab *r = &space->sizes;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < r->layout->dim; a++) {
    PetscCall(PetscFree2(state->places.cell[a], state->places.xi[a]));
    PetscCall(VecDestroy(&state->load[a]));
  }
  for (PetscInt f = 0; f < r->scheme->table->nstate; f++) PetscCall(VecDestroy(&state->field[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- lines ---- */

static PetscErrorCode Append(Builder *b, PetscInt dst, PetscInt src, Mat map, PetscBool to_nodes, Vec left, Vec right,
                             PetscReal factor)
{
  const MpmLine line = {.dst         = dst,
                        .src         = src,
                        .accumulates = PETSC_TRUE,
                        .map         = map,
                        .transposed  = to_nodes,
                        .left        = left,
                        .right       = right,
                        .factor      = factor};

  PetscFunctionBegin;
  if (factor != 0) PetscCall(MpmStepProgramAppend(b->program, line));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Appends a line of the step that is linear with constant numbers, which is its own differential. */
static PetscErrorCode AppendLinear(Builder *b, MpmLine line)
{
  PetscFunctionBegin;
  PetscCall(MpmLineRun(&line, &MpmVectorAlgebra, b->values, PETSC_FALSE));
  PetscCall(MpmStepProgramAppend(b->program, line));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets a register and its perturbation to 0. */
static PetscErrorCode Clear(Builder *b, PetscInt slot)
{
  PetscFunctionBegin;
  PetscCall(AppendLinear(b, (MpmLine){.dst = slot, .src = slot}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The property of particles that multiplies what they give or get in an operation. NULL: it is 1. */
static PetscErrorCode WeightOf(Builder *b, MpmOpKind kind, Vec *weight)
{
  const MpmLayout  *layout   = b->sizes->layout;
  const PetscBool   modulus  = kind == MPM_STRESS && layout->varies[MPM_STIFFNESS] ? PETSC_TRUE : PETSC_FALSE;
  const MpmProperty property = modulus ? MPM_STIFFNESS : MpmLayoutWeight(layout, kind, 0);
  PetscReal        *w;

  PetscFunctionBegin;
  *weight = b->weight[property];
  if (*weight || property == MPM_NO_PROPERTY) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDuplicate(b->value[0], &b->weight[property]));
  PetscCall(VecGetArray(b->weight[property], &w));
  for (PetscInt p = 0; p < b->sizes->particles; p++) w[p] = MpmMaterialProperty(layout, property, b->sizes->begin + p);
  PetscCall(VecRestoreArray(b->weight[property], &w));
  *weight = b->weight[property];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodal masses, and their perturbation by that of the places. */
static PetscErrorCode Masses(Builder *b)
{
  Mat        map;
  Vec        m, ones;
  PetscReal *inverse;

  PetscFunctionBegin;
  PetscCall(WeightOf(b, MPM_P2G, &m));
  PetscCall(MpmMapsWeights(&b->maps, MPM_P2G, 0, MPM_NONE, even, &map));
  PetscCall(VecDuplicate(b->value[0], &ones));
  PetscCall(VecSet(ones, 1));
  PetscCall(VecDuplicate(b->value[b->slot.mass], &b->inverse));
  PetscCall(MatMultTranspose(map, m ? m : ones, b->inverse));
  PetscCall(VecGetArray(b->inverse, &inverse));
  for (PetscInt i = 0; i < b->sizes->nodes; i++) inverse[i] = inverse[i] > 0 ? 1 / inverse[i] : 0;
  PetscCall(VecRestoreArray(b->inverse, &inverse));
  PetscCall(VecDestroy(&ones));
  for (PetscInt c = 0; c < b->table->dim; c++) {
    PetscCall(Append(b, b->slot.start + c, b->slot.place + c, NULL, PETSC_FALSE, NULL, NULL, 1));
    PetscCall(MpmMapsWeights(&b->maps, MPM_P2G, 0, c, even, &map));
    PetscCall(Append(b, b->slot.mass, b->slot.start + c, map, PETSC_TRUE, NULL, m, 1));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- operations ---- */

static PetscErrorCode ToNodes(Builder *b, const MpmOp *op)
{
  const PetscInt   dst = b->slot.node + op->dst, src = op->src;
  const MpmParity *parity = b->table->parity[op->dst];
  const PetscReal  a      = MpmOpValue(op, b->courant);
  Vec              weight, given, sum;
  Mat              map;

  PetscFunctionBegin;
  if (!op->accumulates) PetscCall(Clear(b, dst));
  PetscCall(WeightOf(b, op->kind, &weight));
  PetscCall(VecDuplicate(b->value[src], &given));
  PetscCall(weight ? VecPointwiseMult(given, b->value[src], weight) : VecCopy(b->value[src], given));
  PetscCall(MpmMapsWeights(&b->maps, op->kind, op->axis, MPM_NONE, parity, &map));
  PetscCall(Append(b, dst, src, map, PETSC_TRUE, b->inverse, weight, a));
  PetscCall(VecDuplicate(b->value[dst], &sum));
  PetscCall(MatMultTranspose(map, given, sum));
  PetscCall(VecPointwiseMult(sum, sum, b->inverse));
  PetscCall(VecAXPY(b->value[dst], a, sum));
  PetscCall(VecPointwiseMult(sum, sum, b->inverse));
  PetscCall(Append(b, dst, b->slot.mass, NULL, PETSC_FALSE, sum, NULL, -a));
  for (PetscInt c = 0; c < b->table->dim; c++) {
    PetscCall(MpmMapsWeights(&b->maps, op->kind, op->axis, c, parity, &map));
    if (map) PetscCall(Append(b, dst, b->slot.start + c, map, PETSC_TRUE, b->inverse, given, a));
  }
  PetscCall(VecDestroy(&given));
  PetscCall(VecDestroy(&sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ToParticles(Builder *b, const MpmOp *op)
{
  const PetscInt   dst = op->dst, src = b->slot.node + op->src;
  const MpmParity *parity = b->table->parity[op->src];
  const PetscReal  a      = MpmOpValue(op, b->courant);
  Vec              weight, got;
  Mat              map;

  PetscFunctionBegin;
  PetscCall(WeightOf(b, op->kind, &weight));
  for (PetscInt c = MPM_NONE; c < b->table->dim; c++) {
    PetscCall(MpmMapsWeights(&b->maps, op->kind, op->axis, c, parity, &map));
    if (!map) continue;
    PetscCall(VecDuplicate(b->value[dst], &got));
    PetscCall(MatMult(map, b->value[src], got));
    if (weight) PetscCall(VecPointwiseMult(got, got, weight));
    if (c == MPM_NONE) {
      PetscCall(Append(b, dst, src, map, PETSC_FALSE, weight, NULL, a));
      PetscCall(VecAXPY(b->value[dst], a, got));
    } else
      PetscCall(Append(b, dst, b->slot.start + c, NULL, PETSC_FALSE, got, NULL, a));
    PetscCall(VecDestroy(&got));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- operations at finite deformation ---- */

/* The arrays of n registers from one on, for those who loop over particles. */
static PetscErrorCode GetArrays(const Builder *b, PetscInt first, PetscInt n, PetscReal *array[])
{
  PetscFunctionBegin;
  for (PetscInt c = 0; c < n; c++) PetscCall(VecGetArray(b->value[first + c], &array[c]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RestoreArrays(const Builder *b, PetscInt first, PetscInt n, PetscReal *array[])
{
  PetscFunctionBegin;
  for (PetscInt c = 0; c < n; c++) PetscCall(VecRestoreArray(b->value[first + c], &array[c]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The laws of particles, y = f(x) at each by itself. x are the registers that an operation reads and, of one that changes
   registers, these; or the stretch besides. Law: y; the viscous stress of the law alone is added to y, since what has an
   artificial viscosity has no tangent (scene/settings_request.c).
*/
static void Law(Builder *b, const MpmOp *op, const PetscReal *const x[], PetscReal *const y[])
{
  const MpmMaterialNumbers *m   = &b->table->material;
  const PetscInt            dim = b->table->dim, n = b->sizes->particles;

  switch (op->kind) {
  case MPM_STRESS:
    MpmMaterialStress(m, dim, n, x, y);
    break;
  case MPM_VISCOUS:
    m->law->viscous(m, op->factor, dim, n, x, y);
    break;
  case MPM_STRESS_AHEAD:
    b->inverted = MpmStressAhead(m, dim, n, op->factor, x, x + dim * dim, y) < n ? PETSC_TRUE : PETSC_FALSE;
    break;
  case MPM_RETURN:
    MpmMaterialReturn(m, dim, n, y);
    break;
  default:
    (void)MpmStretch(dim, n, MpmOpValue(op, b->courant), y, x);
  }
}

/* F' = F + L G, G = F + a L F: dF' = dF + dL G + L dG, dG = dF + a (dL F + L dF) */
static void StretchSlope(const Builder *b, const MpmOp *op, const PetscReal *const x[], const PetscReal *const dx[],
                         PetscReal *const dy[])
{
  const PetscInt          dim = b->table->dim, n = dim * dim;
  const PetscReal         a = MpmOpValue(op, b->courant);
  const PetscReal *const *L = x, *const *F = x + n, *const *dL = dx, *const *dF = dx + n;

  for (PetscInt p = 0; p < b->sizes->particles; p++) {
    PetscReal G[MPM_MAX_DIM * MPM_MAX_DIM], dG[MPM_MAX_DIM * MPM_MAX_DIM];

    for (PetscInt i = 0; i < n; i++) {
      G[i]     = F[i][p];
      dG[i]    = dF[i][p];
      dy[i][p] = dF[i][p];
    }
    for (PetscInt i = 0; i < 2 * n * dim; i++) { /* first G, and then dy of it */
      const PetscInt ab = i / dim % n, ac = ab / dim * dim + i % dim, cb = i % dim * dim + ab % dim;

      if (i < n * dim) {
        G[ab] += a * L[ac][p] * F[cb][p];
        dG[ab] += a * (dL[ac][p] * F[cb][p] + L[ac][p] * dF[cb][p]);
      } else
        dy[ab][p] += dL[ac][p] * G[cb] + L[ac][p] * dG[cb];
    }
  }
}

/* dy along dx */
static void LawSlope(Builder *b, const MpmOp *op, const PetscReal *const x[], const PetscReal *const dx[],
                     PetscReal *const dy[])
{
  const MpmMaterialNumbers *m   = &b->table->material;
  const PetscInt            dim = b->table->dim, n = b->sizes->particles;

  switch (op->kind) {
  case MPM_STRESS:
    MpmMaterialTangent(m, dim, n, x, dx, dy);
    break;
  case MPM_VISCOUS:
    m->law->viscous_tangent(m, op->factor, dim, n, x, dx, dy);
    break;
  case MPM_STRESS_AHEAD:
    MpmStressAheadTangent(m, dim, n, op->factor, x, x + dim * dim, dx, dx + dim * dim, dy);
    break;
  case MPM_RETURN:
    b->met = MpmMaterialReturnTangent(m, dim, n, b->branch, x, dx, dy);
    break;
  default:
    StretchSlope(b, op, x, dx, dy);
  }
}

/*
   Whether y_r does not depend on x_q. A column of F' depends on this column of F and, where a is 0, a row of it on this
   row of L.
*/
static PetscBool LawIsZero(const Builder *b, const MpmOp *op, PetscInt q, PetscInt r)
{
  const PetscInt dim = b->table->dim, n = dim * dim;

  if (op->kind != MPM_STRETCH) return PETSC_FALSE;
  return q >= n ? (q % dim != r % dim) : (op->factor == 0 && q / dim != r / dim);
}

/* Appends dy_r += (dy_r / dx_q) dx_q for all components. dx_q is in register perturbed[q]. */
static PetscErrorCode AppendLaw(Builder *b, const MpmOp *op, PetscInt nx, PetscInt ny, const PetscReal *const x[],
                                const PetscInt perturbed[], Vec weight)
{
  const PetscInt   n = b->sizes->particles;
  PetscReal       *dy[MPM_MOST_STRETCH], *one, *zero;
  const PetscReal *dx[2 * MPM_MOST_STRETCH];
  Vec              slope[MPM_MOST_STRETCH];

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(n, &one, n, &zero));
  for (PetscInt p = 0; p < n; p++) one[p] = 1;
  for (PetscInt q = 0; q < nx; q++) {
    for (PetscInt c = 0; c < nx; c++) dx[c] = c == q ? one : zero;
    for (PetscInt r = 0; r < ny; r++) {
      PetscCall(VecDuplicate(b->value[op->dst], &slope[r]));
      PetscCall(VecGetArray(slope[r], &dy[r]));
    }
    LawSlope(b, op, x, dx, dy);
    for (PetscInt r = 0; r < ny; r++) {
      PetscCall(VecRestoreArray(slope[r], &dy[r]));
      if (weight) PetscCall(VecPointwiseMult(slope[r], slope[r], weight));
      if (!LawIsZero(b, op, q, r))
        PetscCall(Append(b, op->dst + r, perturbed[q], NULL, PETSC_FALSE, slope[r], NULL, 1));
      PetscCall(VecDestroy(&slope[r]));
    }
  }
  PetscCall(PetscFree2(one, zero));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A law that changes its registers reads a copy of their perturbations. */
static PetscErrorCode ApplyLaw(Builder *b, const MpmOp *op)
{
  const PetscBool      changes = op->kind == MPM_STRETCH || op->kind == MPM_RETURN ? PETSC_TRUE : PETSC_FALSE;
  const MpmFiniteWidth width   = MpmFiniteWidthOf(op->kind, b->table->dim, MpmTableStretches(b->table));
  const PetscInt       nx = width.from, more = changes ? width.to : op->kind == MPM_STRESS_AHEAD ? width.stretch : 0;
  const PetscInt       second = changes ? op->dst : b->table->stretch;
  PetscInt             perturbed[2 * MPM_MOST_STRETCH];
  PetscReal           *x[2 * MPM_MOST_STRETCH], *y[MPM_MOST_STRETCH];
  Vec                  weight = NULL;

  PetscFunctionBegin;
  if (op->kind == MPM_STRESS) PetscCall(WeightOf(b, op->kind, &weight));
  for (PetscInt c = 0; c < nx; c++) perturbed[c] = op->src + c;
  for (PetscInt c = 0; c < more; c++) perturbed[nx + c] = changes ? b->slot.copy + c : second + c;
  for (PetscInt r = 0; r < width.to; r++)
    if (changes) {
      PetscCall(Clear(b, b->slot.copy + r));
      PetscCall(Append(b, b->slot.copy + r, op->dst + r, NULL, PETSC_FALSE, NULL, NULL, 1));
      PetscCall(MpmStepProgramAppend(b->program, (MpmLine){.dst = op->dst + r, .src = op->dst + r}));
    } else if (op->kind != MPM_VISCOUS)
      PetscCall(Clear(b, op->dst + r));
  PetscCall(GetArrays(b, op->src, nx, x));
  PetscCall(GetArrays(b, second, more, x + nx));
  if (!changes) PetscCall(GetArrays(b, op->dst, width.to, y));
  PetscCall(AppendLaw(b, op, nx + more, width.to, (const PetscReal *const *)x, perturbed, weight));
  Law(b, op, (const PetscReal *const *)x, changes ? x + nx : y);
  b->on_surface += b->met;
  b->met = 0;
  if (!changes) PetscCall(RestoreArrays(b, op->dst, width.to, y));
  PetscCall(RestoreArrays(b, second, more, x + nx));
  PetscCall(RestoreArrays(b, op->src, nx, x));
  for (PetscInt r = 0; r < width.to && weight; r++)
    PetscCall(VecPointwiseMult(b->value[op->dst + r], b->value[op->dst + r], weight));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body force is what it is, whatever the state. */
static PetscErrorCode Load(Builder *b, const MpmOp *op)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < b->table->dim; a++) {
    PetscCall(Clear(b, op->dst + a));
    PetscCall(VecCopy(b->load[a], b->value[op->dst + a]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Collide(Builder *b, const MpmOp *op)
{
  const PetscInt first = b->slot.node + op->src - op->axis;
  Vec            adds, slope[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(MpmCollision(b->sizes, op, b->time, &b->value[first], &adds, slope));
  PetscCall(VecAXPY(b->value[b->slot.node + op->dst], 1, adds));
  PetscCall(VecDestroy(&adds));
  for (PetscInt d = 0; d < b->table->dim; d++) {
    PetscCall(Append(b, b->slot.node + op->dst, first + d, NULL, PETSC_FALSE, slope[d], NULL, 1));
    PetscCall(VecDestroy(&slope[d]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The places of particles that have moved in the middle of a step. */
static PetscErrorCode PlacesNow(Builder *b)
{
  const MpmParticlePlaces *start = b->start;
  const PetscReal         *gone;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < b->table->dim; a++) {
    if (!b->moved.xi[a])
      PetscCall(PetscMalloc2(b->sizes->particles, &b->moved.cell[a], b->sizes->particles, &b->moved.xi[a]));
    PetscCall(VecGetArrayRead(b->value[b->slot.place + a], &gone));
    for (PetscInt p = 0; p < b->sizes->particles; p++) {
      const PetscReal place = start->xi[a][p] + gone[p], whole = floor(place);

      b->moved.cell[a][p] = start->cell[a][p] + (PetscInt)whole;
      b->moved.xi[a][p]   = place - whole;
    }
    PetscCall(VecRestoreArrayRead(b->value[b->slot.place + a], &gone));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Weights and masses of where particles are now. */
static PetscErrorCode PlaceAnew(Builder *b)
{
  PetscFunctionBegin;
  PetscCall(PlacesNow(b));
  PetscCall(MpmMapsDestroy(&b->maps));
  b->maps = (MpmMaps){.slab = b->sizes, .places = &b->moved};
  for (PetscInt a = 0; a < b->table->dim; a++) PetscCall(Clear(b, b->slot.start + a));
  PetscCall(Clear(b, b->slot.mass));
  PetscCall(VecDestroy(&b->inverse));
  PetscCall(Masses(b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x += the way that particles go. The places of the builder are how far they have gone. */
static PetscErrorCode Advance(Builder *b, const MpmOp *op)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < b->table->dim; a++) {
    const MpmLine line = {.dst = b->slot.place + a, .src = op->src + a, .factor = 1, .accumulates = PETSC_TRUE};

    PetscCall(AppendLinear(b, line));
  }
  if (op->factor < 1) PetscCall(PlaceAnew(b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyOp(Builder *b, const MpmOp *op);

/*
   What the table of a system makes of w = k (v + theta a) in its registers, where a is in increment; its lines are
   appended.
*/
static PetscErrorCode Ahead(Builder *b, const MpmTable *k, const Vec increment[])
{
  PetscFunctionBegin;
  for (PetscInt c = 0; c < k->dim; c++) {
    Vec w = b->value[b->slot.node + k->solved + c];

    PetscCall(VecWAXPY(w, k->theta, increment[c], b->value[b->slot.node + k->start + c]));
    PetscCall(VecScale(w, b->courant));
  }
  for (PetscInt o = 0; o < k->nops; o++) PetscCall(ApplyOp(b, &k->ops[o]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The line that solves with 1 - k^2 theta f' on the registers of image, at an increment. f(w) is then in their values.
*/
static PetscErrorCode System(const Builder *b, const MpmTable *k, const Vec increment[], PetscBool *inverted,
                             MpmLine *line)
{
  Builder      own = *b;
  MpmRegisters r   = b->values->registers;
  Mat          matrix;

  PetscFunctionBegin;
  r.nin = r.nout = k->dim;
  for (PetscInt c = 0; c < k->dim; c++) {
    r.in[c]  = b->slot.node + k->solved + c;
    r.out[c] = b->slot.node + k->image + c;
  }
  PetscCall(MpmStepProgramCreate(&r, b->courant, &own.program));
  PetscCall(Ahead(&own, k, increment));
  for (PetscInt c = 0; c < k->dim; c++) {
    PetscCall(Append(&own, r.out[c], r.in[c], NULL, PETSC_FALSE, NULL, NULL, -1 / (PetscSqr(b->courant) * k->theta)));
    PetscCall(MpmStepProgramAppend(
        own.program, (MpmLine){.dst = r.out[c], .src = r.out[c], .factor = -PetscSqr(b->courant) * k->theta}));
  }
  PetscCall(MpmStepProgramAssemble(own.program, PETSC_TRUE, &matrix));
  PetscCall(MpmStepProgramDestroy(&own.program));
  *line = (MpmLine){.dst = r.out[0], .src = r.out[0], .nsolve = k->dim};
  PetscCall(MpmFactorised(matrix, &line->solve));
  PetscCall(MatDestroy(&matrix));
  PetscCallMPI(MPI_Allreduce(&own.inverted, inverted, 1, MPIU_BOOL, MPI_LOR, r.comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Newton's method: the increment, and the system at it. Its step is the whole one, since steps that need parts are not
   smooth.
*/
static PetscErrorCode Newton(Builder *b, const MpmTable *k, Vec increment[], MpmLine *system)
{
  PetscReal change = INFINITY, size = 0, before;
  PetscBool inverted;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < MOST_NEWTON; i++) {
    PetscCall(System(b, k, increment, &inverted, system));
    if (i == 0 && inverted) {
      for (PetscInt c = 0; c < k->dim; c++)
        PetscCall(VecAXPY(increment[c], -1 / k->theta, b->value[b->slot.node + k->start + c]));
      PetscCall(KSPDestroy(&system->solve));
      continue;
    }
    for (PetscInt c = 0; c < k->dim; c++) /* the residual, which the system replaces */
      PetscCall(VecAXPBY(b->value[system->dst + c], 1, -b->courant, increment[c]));
    PetscCall(MpmLineRun(system, &MpmVectorAlgebra, b->values, PETSC_FALSE));
    before = change;
    change = size = 0;
    for (PetscInt c = 0; c < k->dim; c++) {
      PetscReal norm;

      PetscCall(VecAXPY(increment[c], -1, b->value[system->dst + c]));
      PetscCall(VecNorm(b->value[system->dst + c], NORM_INFINITY, &norm));
      change = PetscMax(change, norm);
      PetscCall(VecNorm(increment[c], NORM_INFINITY, &norm));
      size = PetscMax(size, norm);
    }
    if (!inverted && change <= CONVERGED * PetscMax(size, 1) && change >= before / 2) break;
    if (change == 0) break;
    PetscCall(KSPDestroy(&system->solve));
  }
  if (!system->solve) PetscCall(System(b, k, increment, &inverted, system));
  MpmCheckInput(change <= CONVERGED * PetscMax(size, 1),
                "courant %g: the nonlinear system of the implicit step did not converge for its tangent; allowed: a "
                "smaller step",
                (double)b->courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Implicit(Builder *b, const MpmOp *op)
{
  const MpmTable *k      = MpmTableStiffness(b->table, op);
  const PetscInt  solved = b->slot.node + k->solved, image = b->slot.node + k->image, start = b->slot.node + k->start;
  Vec             increment[MPM_MAX_DIM];
  MpmLine         system;

  PetscFunctionBegin;
  if (op->axis) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt c = 0; c < k->dim; c++) {
    PetscCall(VecDuplicate(b->value[solved + c], &increment[c]));
    PetscCall(VecSet(increment[c], 0));
  }
  PetscCall(Newton(b, k, increment, &system));
  for (PetscInt c = 0; c < k->dim; c++)
    PetscCall(MpmStepProgramAppend(b->program, (MpmLine){.dst = solved + c, .src = start + c, .factor = b->courant}));
  PetscCall(Ahead(b, k, increment));
  for (PetscInt c = 0; c < k->dim; c++)
    PetscCall(MpmStepProgramAppend(b->program, (MpmLine){.dst = image + c, .src = image + c, .factor = b->courant}));
  PetscCall(MpmStepProgramAppend(b->program, system));
  for (PetscInt c = 0; c < k->dim; c++) {
    PetscCall(MpmStepProgramAppend(b->program, (MpmLine){.dst = solved + c, .src = image + c, .factor = 1}));
    PetscCall(VecCopy(increment[c], b->value[solved + c]));
    PetscCall(VecDestroy(&increment[c]));
  }
  PetscCall(KSPDestroy(&system.solve));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyOp(Builder *b, const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  MpmLine           line[MPM_MAX_DIM];
  const PetscInt    n = MpmLinesOfOp(op, b->table->dim, b->slot.node, line);

  PetscFunctionBegin;
  if (n > 0 && (!line[0].op || op->kind == MPM_WALL)) {
    for (PetscInt i = 0; i < n; i++) {
      PetscCall(MpmLineBind(b->program, &b->maps, &line[i]));
      PetscCall(AppendLinear(b, line[i]));
      PetscCall(MpmLineRelease(&line[i]));
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  switch (op->kind) {
  case MPM_COLLIDE:
    PetscCall(Collide(b, op));
    break;
  case MPM_STRESS:
  case MPM_VISCOUS:
  case MPM_STRESS_AHEAD:
  case MPM_STRETCH:
  case MPM_RETURN:
    PetscCall(ApplyLaw(b, op));
    break;
  case MPM_IMPLICIT:
    PetscCall(Implicit(b, op));
    break;
  case MPM_LOAD:
    PetscCall(Load(b, op));
    break;
  case MPM_ADVANCE:
    PetscCall(Advance(b, op));
    break;
  default:
    if (traits.dst == MPM_NOWHERE) break;
    PetscCall(traits.dst == MPM_ON_NODES ? ToNodes(b, op) : ToParticles(b, op));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the tangent ---- */

static PetscErrorCode Begin(Builder *b, MpmTangentSpace *space, PetscReal courant, const MpmTangentState *state)
{
  const MpmRegisters *r = &space->work->registers;

  PetscFunctionBegin;
  *b = (Builder){.sizes   = &space->sizes,
                 .table   = space->sizes.scheme->table,
                 .courant = courant,
                 .time    = state->time,
                 .load    = state->load,
                 .start   = &state->places,
                 .branch  = space->branch,
                 .slot    = SlotsOf(space->sizes.scheme->table),
                 .maps    = {.slab = &space->sizes, .places = &state->places}};
  PetscCall(MpmVectorsCreate(r, &b->values));
  b->values->courant = courant;
  b->value           = b->values->slot;
  for (PetscInt s = 0; s < r->n[0] + r->n[1]; s++)
    PetscCall(MpmRegisterVector(r, MpmRegisterPlace(r, s), &b->value[s]));
  for (PetscInt f = 0; f < b->table->nstate; f++) PetscCall(VecCopy(state->field[f], b->value[f]));
  PetscCall(MpmStepProgramCreate(r, courant, &b->program));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode End(Builder *b)
{
  PetscFunctionBegin;
  PetscCall(MpmVectorsDestroy(&b->values));
  PetscCall(MpmStepProgramDestroy(&b->program));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++) PetscCall(VecDestroy(&b->weight[w]));
  PetscCall(VecDestroy(&b->inverse));
  PetscCall(MpmMapsDestroy(&b->maps));
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) PetscCall(PetscFree2(b->moved.cell[a], b->moved.xi[a]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentOf(MpmTangentSpace *space, PetscReal courant, const MpmTangentState *state, Mat *tangent,
                            Vec after[])
{
  Builder b;

  PetscFunctionBegin;
  PetscCall(Begin(&b, space, courant, state));
  PetscCall(Masses(&b));
  for (PetscInt o = 0; o < b.table->nops; o++) PetscCall(ApplyOp(&b, &b.table->ops[o]));
  space->on_surface = b.on_surface;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &space->on_surface, 1, MPIU_INT64, MPI_SUM, space->sizes.comm));
  for (PetscInt f = 0; f < space->nstate && after; f++)
    PetscCall(VecCopy(b.value[space->work->registers.out[f]], after[f]));
  PetscCall(MpmStepProgramMatrix(b.program, space->work, tangent));
  PetscCall(End(&b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentAssemble(Mat tangent, Mat *matrix)
{
  const MpmStepProgram *program;

  PetscFunctionBegin;
  PetscCall(MpmMatrixProgram(tangent, &program));
  PetscCall(MpmStepProgramAssemble(program, PETSC_TRUE, matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentBytes(Mat tangent, PetscReal *bytes)
{
  const MpmStepProgram *program;

  PetscFunctionBegin;
  PetscCall(MpmMatrixProgram(tangent, &program));
  PetscCall(MpmStepProgramBytes(program, bytes));
  PetscFunctionReturn(PETSC_SUCCESS);
}
