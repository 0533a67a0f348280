/*
   No step of rk raises the energy of the particles below its limit, and no step of implicit with theta >= 1/2 at any Courant
   number, wherever particles come to: the theorem of docs/theory.md, section 12. usl, usf and musl raise it. Marches from random data show it on several ranks, and the norm of a step in the energy
   for all data.

   Layouts are jittered, with voids, two materials and walls. A drift that is no simple fraction makes another layout of each
   step. The limit is edge / sqrt(the largest eigenvalue of DIV STRESS GRAD over the layouts that are met), by power iterations
   with the maps of each layout. With stages on particles it is that times P2G G2P, and with fmpm of order 2 times 2 - P2G G2P.
*/
#include "check.h"
#include "gather.h"
#include "program/program.h"
#include "singular.h"
#include <mpmstab/critical.h>
#include <mpmstab/march.h>

#define STEPS 24
#define ITERATIONS 300
#define ROUNDING 1e-13

static const PetscReal   edges[] = {1.7320508075688772, 2, 2.8284271247461903, 4}; /* of rk3, kg3, rk4, kg5 */
static const char *const cases[] = {"particles:flip", "nodes:flip", "nodes:pic",  "nodes:blend -blend_ratio 0.9",
                                    "nodes:apic",     "nodes:xpic", "nodes:fmpm", "nodes:xpic -xpic_order 5"};

enum { NODES, PARTICLES, FMPM, KINDS };
static const PetscReal multiples[KINDS][2] = {{1, 0}, {0, 1}, {2, -1}}; /* of 1 and P2G G2P */

static PetscInt KindOf(const char of[])
{
  return strstr(of, "fmpm") ? FMPM : of[0] == 'p' ? PARTICLES : NODES;
}

typedef struct {
  const MpmTable *table;
  MpmMaps         maps;
  Vec             node[MPM_MAX_FIELDS], particle[MPM_MAX_FIELDS], sum;
} Layout;

/* What the lines of DIV, or of GRAD, make of the registers that they read. */
static PetscErrorCode Apply(Layout *l, MpmOpKind kind, MpmOpKind mls, PetscBool to_nodes)
{
  Vec      *to = to_nodes ? l->node : l->particle, *from = to_nodes ? l->particle : l->node;
  PetscBool begun[MPM_MAX_FIELDS] = {PETSC_FALSE};

  PetscFunctionBegin;
  for (PetscInt o = 0; o < l->table->nops; o++) {
    const MpmOp *op = &l->table->ops[o];
    Mat          map;

    if (op->kind != kind && op->kind != mls) continue;
    PetscCall(MpmMapsGet(&l->maps, op, &map));
    if (!begun[op->dst]) PetscCall(VecZeroEntries(to[op->dst]));
    begun[op->dst] = PETSC_TRUE;
    PetscCall(VecDestroy(&l->sum));
    PetscCall(VecDuplicate(to[op->dst], &l->sum));
    PetscCall(MatMult(map, from[op->src], l->sum));
    PetscCall(VecAXPY(to[op->dst], op->factor, l->sum));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The largest eigenvalue of DIV STRESS GRAD times what a kind needs, at a step. scene has usl: v and s are the state, v_i
   the first node registers and a_i the next.
*/
static PetscErrorCode Largest(const MpmScene *scene, PetscInt64 step, PetscInt kind, PetscReal *largest)
{
  const MpmTable *t   = scene->scheme.table;
  const PetscInt  dim = t->dim;
  PetscRandom     random;
  MpmSlab         slab;
  Layout          l = {.table = t};
  PetscReal       before, after;

  PetscFunctionBegin;
  PetscCall(MpmSlabOf(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &scene->step, &slab));
  l.maps = (MpmMaps){.slab = &slab, .step = step};
  for (PetscInt r = 0; r < t->nnodes; r++) PetscCall(VecCreateSeq(PETSC_COMM_SELF, slab.nodes, &l.node[r]));
  for (PetscInt r = 0; r < t->nstate; r++) PetscCall(VecCreateSeq(PETSC_COMM_SELF, slab.particles, &l.particle[r]));
  PetscCall(PetscRandomCreate(PETSC_COMM_SELF, &random));
  for (PetscInt a = 0; a < dim; a++) PetscCall(VecSetRandom(l.node[a], random));
  for (PetscInt i = 0; i < ITERATIONS; i++) {
    before = after = 0;
    for (PetscInt a = 0; a < dim; a++) {
      PetscReal norm;

      PetscCall(VecNorm(l.node[a], NORM_2, &norm));
      before = hypot(before, norm);
    }
    for (PetscInt a = 0; a < dim; a++) PetscCall(VecScale(l.node[a], 1 / before));
    PetscCall(Apply(&l, MPM_GRAD, MPM_GRAD_MLS, PETSC_FALSE));
    PetscCall(Apply(&l, MPM_DIV, MPM_DIV_MLS, PETSC_TRUE));
    for (PetscInt a = 0; a < dim; a++) {
      PetscReal norm;

      const MpmOp g2p = G2P(a, dim + a, ONE), p2g = P2G(dim + a, a);
      Mat         map;

      PetscCall(MpmMapsGet(&l.maps, &g2p, &map));
      PetscCall(MatMult(map, l.node[dim + a], l.particle[a]));
      PetscCall(MpmMapsGet(&l.maps, &p2g, &map));
      PetscCall(MatMult(map, l.particle[a], l.node[a]));
      PetscCall(VecAXPBY(l.node[a], multiples[kind][0], multiples[kind][1], l.node[dim + a]));
      PetscCall(VecNorm(l.node[a], NORM_2, &norm));
      after = hypot(after, norm);
    }
  }
  *largest = PetscMax(*largest, after);
  for (PetscInt r = 0; r < t->nnodes; r++) PetscCall(VecDestroy(&l.node[r]));
  for (PetscInt r = 0; r < t->nstate; r++) PetscCall(VecDestroy(&l.particle[r]));
  PetscCall(VecDestroy(&l.sum));
  PetscCall(PetscRandomDestroy(&random));
  PetscCall(MpmMapsDestroy(&l.maps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The energy of the affine part, sum m D |C|^2 / 2, where D is the same at all places and all masses are 1 / ppc. */
static PetscErrorCode AffineEnergy(MpmMarch *march, const MpmScene *scene, PetscReal D, PetscReal *energy)
{
  const MpmTable *t = scene->scheme.table;

  PetscFunctionBegin;
  *energy = 0;
  if (t->affine == MPM_NONE) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt c = 0; c < t->dim * t->dim; c++) {
    PetscReal *C;

    PetscCall(GatherField(march, t->fields[t->affine_part + c], &C));
    for (PetscInt64 p = 0; p < scene->layout.particles; p++) *energy += D * C[p] * C[p] / 2;
    PetscCall(PetscFree(C));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest factor that a step multiplies the energy with, minus 1, from random data. */
static PetscErrorCode Rise(const char options[], PetscReal D, PetscReal *rise)
{
  MpmScene *scene;
  MpmMarch *march;
  MpmNorms  norms;
  PetscReal before, after, affine, unit = NAN;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  PetscCall(MpmMarchNorms(march, &norms));
  before = norms.energy;
  *rise  = -1;
  for (PetscInt64 step = 0; step < STEPS; step++) {
    PetscCall(MpmMarchStep(march));
    PetscCall(MpmMarchNorms(march, &norms));
    PetscCall(AffineEnergy(march, scene, D, &affine));
    unit  = 1.0 / (PetscReal)scene->layout.particles; /* of a particle's mass, where the domain has 1 in all */
    after = norms.energy + unit * affine;
    if (step) *rise = PetscMax(*rise, after / before - 1);
    before = after;
  }
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The square root of a term of the energy for a register of the state, where Poisson's ratio is 0: the energy of a stress is
   then the sum of s_ab^2 over all a and b, and shear stresses have two of these.
*/
static PetscReal Unit(const MpmTable *t, PetscInt r, PetscReal D)
{
  if (t->field[r] == MPM_NONE) return sqrt(D);
  return strlen(t->fields[r]) == 4 && t->fields[r][2] != t->fields[r][3] ? sqrt(2) : 1;
}

/* The norm of one step in the energy: by how much it can raise the square root of the energy, of any data. */
static PetscErrorCode StepNorm(const char options[], PetscInt step, PetscReal D, PetscReal *norm)
{
  MpmScene  *scene;
  Mat        shell, dense;
  PetscReal *a, ends[2];
  PetscInt   n, fields;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  fields = scene->scheme.table->nstate;
  PetscCall(MpmStepsMatrix(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &scene->step, step, 1, &shell));
  PetscCall(MatComputeOperator(shell, MATSEQDENSE, &dense));
  PetscCall(MatGetSize(dense, &n, NULL));
  PetscCall(MatDenseGetArray(dense, &a));
  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++)
      a[j * n + i] *= Unit(scene->scheme.table, i % fields, D) / Unit(scene->scheme.table, j % fields, D);
  PetscCall(DenseSingular(n, a, ends));
  *norm = ends[1];
  PetscCall(MatDenseRestoreArray(dense, &a));
  PetscCall(MatDestroy(&dense));
  PetscCall(MatDestroy(&shell));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt turn; /* of two layouts one after another each has half of the schemes */

static const PetscReal   courants[] = {0.7, 20};
static const char *const thetas[]   = {"1/2", "0.6", "1"};
static const char *const renewed[]  = {"flip", "pic", "blend", "apic"};

/* Calls with the options of implicit with each theta, transfer and Courant number. */
static PetscErrorCode EachImplicit(const char layout[], PetscReal D,
                                   PetscErrorCode (*check)(const char options[], PetscReal D))
{
  char options[512];

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(renewed); i++)
    for (size_t j = 0; j < PETSC_STATIC_ARRAY_LENGTH(thetas); j++)
      for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(courants); k++) {
        if ((i + j + k + (size_t)turn) % 2 || (!strcmp(renewed[i], "apic") && D == 0)) continue;
        PetscCall(PetscSNPrintf(options, sizeof options, "-formulation implicit -theta %s -transfer %s -courant %g %s",
                                thetas[j], renewed[i], (double)courants[k], layout));
        PetscCall(check(options, D));
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ImplicitNorm(const char options[], PetscReal D)
{
  PetscReal norm;

  PetscFunctionBegin;
  for (PetscInt step = 0; step < 2; step++) {
    PetscCall(StepNorm(options, step, D, &norm));
    CHECK(norm <= 1 + ROUNDING, "%s: step %d: norm 1 + %.3g", options, (int)step, (double)(norm - 1));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ImplicitRise(const char options[], PetscReal D)
{
  char      random[600];
  PetscReal rise;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(random, sizeof random, "%s -initial random", options));
  PetscCall(Rise(random, D, &rise));
  CHECK(rise <= 1e-11, "%s: energy rises by %.3g", options, (double)rise); /* as far as the system is solved */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Norms below and above the limit of two steps of a layout whose particles are alike. */
static PetscErrorCode CheckNorms(const char layout[], PetscReal D)
{
  char      options[512];
  PetscReal norm;
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation usl -courant 0.1 %s", layout));
  for (PetscInt step = 0; step < 2; step++) {
    PetscReal largest[KINDS] = {0};

    PetscCall(CheckScene(options, &scene));
    for (PetscInt kind = 0; kind < KINDS; kind++) PetscCall(Largest(scene, step, kind, &largest[kind]));
    PetscCall(MpmSceneDestroy(&scene));
    for (PetscInt m = 0; MpmRkWord(m); m++)
      for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
        const char     *transfer = strchr(cases[i], ':') + 1;
        const PetscReal limit    = edges[m] / sqrt(largest[KindOf(cases[i])]);
        char            here[512];

        if (((size_t)m + i + (size_t)turn) % 2 || (!strcmp(transfer, "apic") && D == 0)) continue;
        for (int beyond = 0; beyond < 2; beyond++) {
          PetscCall(PetscSNPrintf(
              here, sizeof here, "-formulation rk -rk %s -rk_on %.*s -transfer %s -courant %.17g %s", MpmRkWord(m),
              (int)(transfer - cases[i] - 1), cases[i], transfer, (double)(limit * (beyond ? 1.02 : 0.99)), layout));
          PetscCall(StepNorm(here, step, D, &norm));
          if (!beyond) CHECK(norm <= 1 + ROUNDING, "%s: step %d: norm 1 + %.3g", here, (int)step, (double)(norm - 1));
          if (beyond && cases[i][0] == 'p')
            CHECK(norm > 1 + 1e-6, "%s: step %d beyond the limit: norm 1 + %.3g", here, (int)step, (double)(norm - 1));
        }
      }
  }
  PetscCall(EachImplicit(layout, D, ImplicitNorm));
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation implicit -theta 0.49 -courant 20 %s", layout));
  PetscCall(StepNorm(options, 0, D, &norm));
  CHECK(norm > 1 + 1e-6, "%s: norm 1 + %.3g", options, (double)(norm - 1));
  for (int f = 0; f < 4; f++) {
    static const char *const rings[] = {"usl", "usf", "musl", "usavg"};

    PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -courant 0.1 %s", rings[f], layout));
    PetscCall(StepNorm(options, 0, D, &norm));
    CHECK(norm > 1 + 1e-5, "%s: norm 1 + %.3g", options, (double)(norm - 1));
  }
  turn++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* critical says up to where the theorem holds under a drift: over all layouts that are met, and not beyond what it finds. */
static PetscErrorCode CheckQuiet(const char scheme[], const char layout[], PetscInt steps, PetscReal edge)
{
  char            options[512];
  PetscReal       largest = 0;
  MpmScene       *scene;
  MpmCriticalCase of;
  MpmCritical     critical;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation usl -courant 0.1 %s", layout));
  PetscCall(CheckScene(options, &scene));
  for (PetscInt step = 0; step < steps; step++)
    PetscCall(Largest(scene, step, strstr(scheme, "particles") ? PARTICLES : KindOf(scheme), &largest));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation rk %s %s", scheme, layout));
  PetscCall(CheckSceneOf("critical", options, &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &critical));
  if (edge > 0)
    CHECK(critical.quiet <= edge / sqrt(largest) * (1 + 1e-3) && critical.quiet >= edge / sqrt(largest) * (1 - 1e-2),
          "%s: cannot ring up to %.9g, by eigenvalues %.9g", options, (double)critical.quiet,
          (double)(edge / sqrt(largest)));
  else
    CHECK(critical.quiet == 0 && critical.no_theorem, "%s: no theorem, but %.9g", options, (double)critical.quiet);
  CHECK(!(edge > 0) || !critical.no_theorem, "%s: %s", options, critical.no_theorem);
  CHECK(critical.quiet <= critical.stable_at * (1 + 1e-9), "%s: cannot ring up to %.9g, grows from %.9g", options,
        (double)critical.quiet, (double)critical.stable_at);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt raised[3], layouts; /* in how many layouts usl, usf and musl raise the energy of random data */

/* A layout and the largest eigenvalues over its steps: on nodes, and on particles. */
static PetscErrorCode Check(const char layout[], PetscReal D)
{
  char      options[512];
  PetscReal largest[KINDS] = {0}, rise;
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation usl -courant 0.1 %s", layout));
  PetscCall(CheckScene(options, &scene));
  for (PetscInt64 step = 0; step < STEPS; step++)
    for (PetscInt kind = 0; kind < KINDS; kind++) PetscCall(Largest(scene, step, kind, &largest[kind]));
  PetscCall(MpmSceneDestroy(&scene));
  for (PetscInt m = 0; MpmRkWord(m); m++)
    for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
      const char     *transfer = strchr(cases[i], ':') + 1;
      const PetscReal courant  = 0.99 * edges[m] / sqrt(largest[KindOf(cases[i])]);

      if (((size_t)m + i + (size_t)turn) % 2 || (!strcmp(transfer, "apic") && D == 0)) continue;
      PetscCall(PetscSNPrintf(
          options, sizeof options, "-formulation rk -rk %s -rk_on %.*s -transfer %s -courant %.17g -initial random %s",
          MpmRkWord(m), (int)(transfer - cases[i] - 1), cases[i], transfer, (double)courant, layout));
      PetscCall(Rise(options, D, &rise));
      CHECK(rise <= ROUNDING, "%s: energy rises by %.3g", options, (double)rise);
    }
  layouts++;
  PetscCall(EachImplicit(layout, D, ImplicitRise));
  turn++;
  for (int f = 0; f < 3; f++) {
    static const char *const rings[] = {"usl", "usf", "musl"};

    PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -courant %.17g -initial random %s", rings[f],
                            (double)(1 / sqrt(largest[0])), layout));
    PetscCall(Rise(options, 0, &rise));
    if (rise >= 1e-5) raised[f]++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What needs no other rank, since a rank does it by itself; and layouts of kinds that Test has. */
static PetscErrorCode CheckAlone(void)
{
  PetscFunctionBegin;
  PetscCall(Check("-cells 24 -ppc 2 -jitter 0.9 -drift 0.3819660113", 0));
  PetscCall(Check("-cells 24 -ppc 2 -jitter 0.9 -drift 0.4142135624 -basis quadratic", 1.0 / 4));
  PetscCall(Check("-cells 24 -ppc 1 -jitter 0.9 -drift 0.7320508076 -basis cubic -gradient mls", 1.0 / 3));
  PetscCall(Check("-cells 24 -ppc 2 -jitter 0.5 -drift 0.1 -material two -density_ratio 9 -stiffness_ratio 5", 0));
  PetscCall(Check("-dim 2 -cells 8 -ppc 2 -jitter 0.6 -drift 0.0871 -boundary periodic -poisson 0.45", 0));
  PetscCall(CheckNorms("-cells 12 -ppc 2 -jitter 0.9 -drift 0.3819660113", 0));
  PetscCall(CheckNorms("-cells 14 -ppc 2 -fill 3,11 -jitter 0.7 -drift -0.2360679775", 0));
  PetscCall(CheckNorms("-cells 12 -ppc 2 -jitter 0.9 -drift 0.4142135624 -basis quadratic", 1.0 / 4));
  PetscCall(CheckNorms("-cells 12 -ppc 1 -jitter 0.9 -drift 0.7320508076 -basis cubic -gradient mls", 1.0 / 3));
  PetscCall(CheckNorms("-dim 2 -cells 5 -ppc 1 -jitter 0.9 -drift 0.38,0.23 -poisson 0 -basis quadratic", 1.0 / 4));
  PetscCall(CheckQuiet("-rk_on particles", "-cells 48 -drift 1/8", 8, edges[2]));
  PetscCall(
      CheckQuiet("-rk_on particles -rk kg5 -basis quadratic", "-cells 48 -drift 1/5 -ppc 3 -basis quadratic", 5, 4));
  PetscCall(CheckQuiet("-rk rk3 -transfer pic", "-cells 48 -drift 1/8", 8, edges[0]));
  PetscCall(CheckQuiet("-rk kg3 -transfer apic -basis quadratic", "-cells 48 -drift -1/3 -basis quadratic", 3, 2));
  PetscCall(CheckQuiet("-rk_on nodes", "-dim 2 -cells 8 -drift 1/4,0 -ppc 1 -basis quadratic", 4, edges[2]));
  PetscCall(CheckQuiet("-transfer apic", "-cells 8 -drift 1/8", 0, 0));
  PetscCall(CheckQuiet("-transfer xpic", "-cells 48 -drift 1/8", 8, edges[2]));
  PetscCall(CheckQuiet("-transfer fmpm", "-cells 48 -drift 1/8 -basis quadratic", 8, edges[2]));
  PetscCall(CheckQuiet("-transfer tpic -basis quadratic", "-cells 8 -drift 1/8", 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(Check("-cells 24 -counts 2,1,3,0,0,0,1 -jitter 0.7 -drift -0.2360679775 -basis quadratic", 0));
  PetscCall(Check("-cells 24 -ppc 2 -jitter 0.4 -boundary fixed,free", 0));
  PetscCall(Check("-dim 2 -cells 8 -ppc 1 -jitter 0.9 -drift 0.3819660113,0.2360679775 -basis quadratic", 1.0 / 4));
  PetscCall(Check("-dim 3 -cells 6 -ppc 1 -jitter 0.8 -drift 0.3,0.1,0.2 -basis quadratic -gradient mls", 1.0 / 4));
  if (size == 1) PetscCall(CheckAlone());
  CHECK(raised[0] >= 3 * (size == 1) && raised[1] == layouts && raised[2] == layouts,
        "in %d layouts usl, usf and musl raise the energy in %d, %d and %d", (int)layouts, (int)raised[0],
        (int)raised[1], (int)raised[2]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
