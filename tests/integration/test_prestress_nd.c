/*
   Schemes about a stretched state in two and three dimensions, against the tangent of a nonlinear step that is written
   out by itself (tests/support/nonlinear.h): A T q = T q', where q is a random perturbation of all particles, q' what the
   nonlinear step makes of it by complex step, and T takes perturbations of x, v, F and C to the state of the scheme. Then
   the closed forms against the symbol, and waves along an axis against those of one dimension.
*/
#include "base/hash.h"
#include "check.h"
#include "nonlinear.h"
#include "scene/layout.h"
#include "symbol/predict.h"
#include "symbols.h"
#include <mpmstab/operator.h>

#define EPSILON 1e-30 /* of complex steps */
#define ALLOWED 2e-13

typedef double Tensor[NL_DIM][NL_DIM];

/* A stretched state: a law, its numbers, and F0. poisson: of the material at rest. name: how the scene is told of it. */
typedef struct {
  const char *name;
  NlLaw       law;
  double      poisson, exponent;
  Tensor      F;
} State;

/* The state in units of the material at rest: the determinant of F0, sigma0 and rho c^2, c that of P waves along x. */
typedef struct {
  double J, sigma[NL_DIM][NL_DIM], stiffness;
} Stretched;

/* sigma0 = tau / J, and c^2 = d tau_xx / dF_xx F0_xx / rho0 - sigma0_xx J: by complex step as well. */
static Stretched Stretch(const NlRun *run, const State *state)
{
  Stretched at;
  Number    F[NL_DIM][NL_DIM], tau[NL_DIM][NL_DIM];

  for (int a = 0; a < run->dim; a++)
    for (int b = 0; b < run->dim; b++) F[a][b] = state->F[a][b];
  at.J = creal(NlDeterminant(run->dim, F));
  for (int b = 0; b < run->dim; b++) F[0][b] += I * EPSILON * F[0][b]; /* dF = e_x e_x F0 */
  NlStress(run, F, tau);
  for (int a = 0; a < run->dim; a++)
    for (int b = 0; b < run->dim; b++) at.sigma[a][b] = creal(tau[a][b]) / at.J;
  at.stiffness = cimag(tau[0][0]) / EPSILON / at.J - at.sigma[0][0];
  return at;
}

static PetscReal Random(PetscInt i)
{
  return MpmHash(23, i) - 0.5;
}

/* The particles of the stretched state at their places, which move with the velocity of the drift. */
static void Fill(NlRun *run, const MpmScene *scene, const State *state, NlParticle p[])
{
  const MpmLayout *l = &scene->layout;

  run->count = (int)l->particles;
  for (int q = 0; q < run->count; q++) {
    PetscInt  cell[MPM_MAX_DIM];
    PetscReal xi[MPM_MAX_DIM];

    MpmLayoutPlaceAt(l, scene->step.drift, q, 0, cell, xi);
    memset(&p[q], 0, sizeof p[q]);
    for (int a = 0; a < run->dim; a++) {
      p[q].x[a] = cell[a] + xi[a];
      p[q].v[a] = scene->step.drift[a].value / run->dt;
      for (int b = 0; b < run->dim; b++) p[q].F[a][b] = state->F[a][b];
    }
  }
}

/* Adds a random imaginary part to all that a particle has. */
static void Perturb(const NlRun *run, NlParticle p[])
{
  for (int q = 0, n = 0; q < run->count; q++)
    for (int a = 0; a < run->dim; a++) {
      p[q].x[a] += I * EPSILON * Random(n++);
      p[q].v[a] += I * EPSILON * Random(n++);
      for (int b = 0; b < run->dim; b++) {
        p[q].F[a][b] += I * EPSILON * Random(n++);
        if (run->transfer == NL_APIC) p[q].C[a][b] += I * EPSILON * Random(n++);
      }
    }
}

/* A number of the scheme's state: x in cells, v / c, the change of tau over J rho c^2 (of one number: of ln J), C h / c. */
static PetscReal Image(const NlRun *run, const MpmTable *t, const Stretched *at, NlParticle *p, PetscInt r)
{
  const double   speed = sqrt(at->stiffness * at->J);
  const PetscInt c     = t->component[r];
  Number         tau[NL_DIM][NL_DIM];

  if (t->field[r] == MPM_DISPLACEMENT) return cimag(p->x[c]) / EPSILON;
  if (t->field[r] == 0) return cimag(p->v[c]) / EPSILON / speed;
  if (t->field[r] == MPM_NONE) return cimag(p->C[c / run->dim][c % run->dim]) / EPSILON / speed;
  if (run->dim == 1 || run->law == NL_TAIT) return cimag(clog(NlDeterminant(run->dim, p->F))) / EPSILON;
  NlStress(run, p->F, tau);
  for (int a = 0; a < run->dim; a++)
    for (int b = a; b < run->dim; b++)
      if (MpmStressComponent(run->dim, a, b) == c) return cimag(tau[a][b]) / EPSILON / at->J / at->stiffness;
  return NAN;
}

static PetscErrorCode CheckStep(const MpmScene *scene, const char options[], const NlRun *run, const Stretched *at,
                                NlParticle p[])
{
  const PetscInt   fields   = scene->scheme.table->nstate;
  PetscReal        farthest = 0;
  const PetscReal *image;
  PetscReal       *q;
  MpmOperator     *op;
  Vec              from, to;

  PetscFunctionBegin;
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MatCreateVecs(op->A, &from, &to));
  PetscCall(VecGetArrayWrite(from, &q));
  for (PetscInt i = 0; i < fields * run->count; i++)
    q[i] = Image(run, scene->scheme.table, at, &p[i / fields], i % fields);
  PetscCall(VecRestoreArrayWrite(from, &q));
  PetscCall(MatMult(op->A, from, to));
  for (PetscInt step = 0; step < op->period; step++) NlStep(run, p);
  PetscCall(VecGetArrayRead(to, &image));
  for (PetscInt i = 0; i < fields * run->count; i++) {
    const PetscReal expected = Image(run, scene->scheme.table, at, &p[i / fields], i % fields);
    const PetscReal off      = fabs(scalbn(image[i], (int)op->exponent) - expected);

    if (!(off <= farthest)) farthest = off;
  }
  CHECK(farthest <= ALLOWED, "%s: the tangent is off by %.3g", options, (double)farthest);
  PetscCall(VecRestoreArrayRead(to, &image));
  PetscCall(VecDestroy(&from));
  PetscCall(VecDestroy(&to));
  PetscCall(MpmOperatorDestroy(&op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How a scene is told of a state: by a material and its stretch, or by the stress and Poisson's ratio of the stiffness. */
static PetscErrorCode Describe(const NlRun *run, const State *state, const Stretched *at, size_t room, char text[])
{
  char   one[64];
  double lambda, mu;

  PetscFunctionBegin;
  if (state->name[0]) {
    PetscCall(PetscStrncpy(text, state->name, room));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  lambda = run->lambda;
  mu     = run->mu - run->lambda * log(at->J);
  PetscCall(PetscSNPrintf(text, room, "-poisson %.17g -prestress ", lambda / (2 * (lambda + mu))));
  for (int a = 0; a < run->dim; a++)
    for (int b = a; b < run->dim; b++) {
      PetscCall(PetscSNPrintf(one, sizeof one, "%s%.17g", a + b ? "," : "", at->sigma[a][b] / at->stiffness));
      PetscCall(PetscStrlcat(text, one, room));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static NlRun RunOf(int dim, const State *state)
{
  const double nu = state->poisson;

  return (NlRun){.dim      = dim,
                 .law      = state->law,
                 .exponent = state->exponent,
                 .lambda   = nu / (1 - nu),
                 .mu       = (1 - 2 * nu) / (2 * (1 - nu))};
}

/* One scheme about one state. scheme: its options; the run's have to say the same. */
static PetscErrorCode CheckScheme(NlRun run, const State *state, const char scheme[])
{
  static NlParticle p[NL_PARTICLES];
  const Stretched   at = Stretch(&run, state);
  char              stretched[512], options[1024];
  MpmScene         *scene;

  PetscFunctionBegin;
  PetscCall(Describe(&run, state, &at, sizeof stretched, stretched));
  PetscCall(PetscSNPrintf(options, sizeof options, "%s -dim %d %s", scheme, run.dim, stretched));
  PetscCall(CheckScene(options, &scene));
  CHECK(!state->name[0] || fabs(scene->wave_speed / sqrt(at.stiffness * at.J) - 1) <= 1e-14, "%s: c", options);
  for (int a = 0; a < run.dim; a++) {
    run.cells[a]      = (int)scene->layout.grid[a].cells;
    run.half_width[a] = scene->layout.half_width[a];
  }
  run.V0   = 1 / at.J;
  run.mass = run.V0; /* the density at rest is 1 */
  for (int a = 0; a < run.dim; a++) run.V0 /= (double)scene->layout.ppc[a], run.mass /= (double)scene->layout.ppc[a];
  run.dt = scene->step.courant / sqrt(at.stiffness * at.J);
  Fill(&run, scene, state, p);
  Perturb(&run, p);
  PetscCall(CheckStep(scene, options, &run, &at, p));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Uniaxial, biaxial, hydrostatic and shear; neo-Hookean, Saint Venant-Kirchhoff and a liquid. */
static const State plane[] = {
    {"-material neo -stretch 1.5,1 -poisson 0.3", NL_NEO, 0.3, 0, {{1.5, 0}, {0, 1}}},
    {"-material neo -stretch 0.9,1.4 -poisson 0.2", NL_NEO, 0.2, 0, {{0.9, 0}, {0, 1.4}}},
    {"-material neo -stretch 1.3 -poisson 0.4", NL_NEO, 0.4, 0, {{1.3, 0}, {0, 1.3}}},
    {"", NL_NEO, 0.3, 0, {{1.1, 0.4}, {-0.2, 1.3}}},
    {"-material svk -stretch 1.2,0.95 -poisson 0.25", NL_SVK, 0.25, 0, {{1.2, 0}, {0, 0.95}}},
    {"-material tait -exponent 5 -stretch 0.9,1.05 -poisson 0.5", NL_TAIT, 0.3, 5, {{0.9, 0}, {0, 1.05}}},
};
static const State space[] = {
    {"-material neo -stretch 1.2,0.9,1.1 -poisson 0.3", NL_NEO, 0.3, 0, {{1.2, 0, 0}, {0, 0.9, 0}, {0, 0, 1.1}}},
    {"", NL_NEO, 0.35, 0, {{1.1, 0.2, -0.1}, {0.1, 1.2, 0.3}, {0, -0.2, 0.9}}},
};

/* The schemes: every state of the plane meets every basis, and every formulation every transfer. */
static PetscErrorCode CheckAll(int dim, PetscInt nstates, const State states[], const char cells[], PetscInt count)
{
  static const char *const formulations[] = {"usl", "usf", "musl", "musl -move projected"};
  static const char *const transfers[]    = {"flip", "pic", "apic"};
  static const char *const bases[]        = {"quadratic -offset 0.3",
                                             "cubic",
                                             "linear -offset 0.35 -drift 1/3,0",
                                             "quadratic -gradient mls",
                                             "gimp -offset 0.1",
                                             "cubic -gradient mls -offset 0.2 -drift 0,1/2",
                                             "linear -gradient mls"};
  static const NlBasis     basis[]        = {NL_QUADRATIC, NL_CUBIC, NL_HAT, NL_QUADRATIC, NL_GIMP, NL_CUBIC, NL_HAT};
  char                     scheme[512];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < count; i++) {
    const PetscInt s = i % nstates, b = (i + i / nstates) % 7, f = i % 4, t = (i + i / 4) % 3;
    NlRun          run = RunOf(dim, &states[s]);

    if (dim == 3 && strstr(bases[b], "drift")) continue; /* the drifts are of the plane */
    run.basis     = basis[b];
    run.mls       = strstr(bases[b], "mls") ? 1 : 0;
    run.scheme    = f == 0 ? NL_USL : f == 1 ? NL_USF : NL_MUSL;
    run.projected = f == 3;
    run.transfer  = (NlTransfer)t;
    PetscCall(PetscSNPrintf(scheme, sizeof scheme, "-formulation %s -transfer %s -basis %s -courant 0.4 %s",
                            formulations[f], transfers[t], bases[b], cells));
    PetscCall(CheckScheme(run, &states[s], scheme));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- symbols ---- */

static PetscErrorCode CheckClosedForm(const char options[])
{
  MpmComparison comparison;
  PetscReal     growth = NAN;

  PetscFunctionBegin;
  PetscCall(CompareClosedForm(options, 5, &comparison, &growth));
  CHECK(comparison.corrected <= 5e-8, "%s: closed form off by %.3g", options, comparison.corrected);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckClosedForms(void)
{
  static const char *const scenes[] = {
      "-dim 2 -formulation usl -basis quadratic -offset 0.3 -prestress 0.5,-0.1,0.3 -courant 1.5",
      "-dim 2 -formulation musl -move projected -basis cubic -transfer pic -ppc 1 -offset 0.1 -prestress 0.6,0.6 "
      "-courant 2",
      "-dim 2 -formulation usavg -move projected -basis quadratic -gradient mls -transfer apic -prestress 0.3,0.2,-0.1",
      "-dim 2 -formulation usl -basis linear -ppc 1 -offset 0.2 -prestress 0.4,0.1 -courant 1.2",
      "-dim 2 -formulation usl -basis gimp -offset 0.1 -poisson 0.5 -ppc 1,2 -prestress -0.4,-0.4",
      "-dim 3 -formulation usl -basis quadratic -ppc 1 -offset 0.3 -material neo -stretch 1.4,0.9,1 -courant 1.5"};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(scenes); i++) PetscCall(CheckClosedForm(scenes[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define PHASES 8

/* Growth of each of the waves along an axis. */
static PetscErrorCode GrowthsAlong(const char options[], PetscInt axis, PetscReal growth[PHASES])
{
  MpmSymbolWish wish = {.phases = {1, 1, 1}, .tolerance = 1e-6};
  MpmScene     *scene;
  MpmSymbol    *symbol;

  PetscFunctionBegin;
  wish.phases[axis] = PHASES;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmSymbolCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &scene->step, &wish, &symbol));
  for (PetscInt m = 0; m < PHASES; m++) {
    PetscBool conjugate;

    growth[m] = symbol->per_phase[MpmSymbolClass(symbol, m, &conjugate)];
  }
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Waves along an axis: P waves are those of one dimension at their own speed and prestress, and S waves those without a
   prestress. Both schemes see shear on planes across the axis only in the displacement of P waves.
*/
static PetscErrorCode CheckAxis(PetscInt axis, const char scheme[], PetscReal courant, const PetscReal sigma0[])
{
  const PetscReal nu = 0.3, mu = (1 - sigma0[0]) * (1 - 2 * nu) / (2 * (1 - nu)), along = sigma0[axis ? 2 : 0];
  const PetscReal p = sqrt(1 - sigma0[0] + along), s = sqrt(mu + along);
  PetscReal       all[PHASES], of_p[PHASES], of_s[PHASES];
  char            options[512];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-dim 2 -poisson %g %s -courant %.17g -prestress %.17g,%.17g,%.17g",
                          nu, scheme, courant, sigma0[0], sigma0[1], sigma0[2]));
  PetscCall(GrowthsAlong(options, axis, all));
  PetscCall(PetscSNPrintf(options, sizeof options, "%s -courant %.17g -prestress %.17g", scheme, courant * p,
                          along / (p * p)));
  PetscCall(GrowthsAlong(options, 0, of_p));
  PetscCall(PetscSNPrintf(options, sizeof options, "%s -courant %.17g", scheme, courant * s));
  PetscCall(GrowthsAlong(options, 0, of_s));
  for (PetscInt m = 1; m < PHASES; m++) CHECK_NEAR(all[m], PetscMax(of_p[m], of_s[m]), 1e-7);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckAxes(void)
{
  PetscFunctionBegin;
  for (PetscInt axis = 0; axis < 2; axis++) {
    PetscCall(CheckAxis(axis, "-formulation usf -basis quadratic -offset 0.3", 0.8, (PetscReal[]){0.5, 0.2, 0.3}));
    PetscCall(CheckAxis(axis, "-formulation usl -basis cubic -gradient mls -transfer apic", 2,
                        (PetscReal[]){-0.1, 0.1, 0.6}));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckAll(2, PETSC_STATIC_ARRAY_LENGTH(plane), plane, "-cells 4,5 -ppc 2,1", 42));
  PetscCall(CheckAll(3, PETSC_STATIC_ARRAY_LENGTH(space), space, "-cells 4 -ppc 1,2,1", 7));
  PetscCall(CheckClosedForms());
  PetscCall(CheckAxes());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
