/*
   The march is compared with the slides' algorithms and the momentum schemes, written here a second time as plain loops
   over particles and nodes. They agree only if the tables, the passes, the halo sums, drift and migration are all
   right.
*/
#include "gather.h"

typedef struct {
  PetscInt   cells, n;
  PetscReal *a, *b, *ai, *bi, *ci, *mass; /* a, b: particle fields; the others: node fields */
  PetscReal *rest, *x;                    /* places at rest and now, in cells */
} Plain;

static PetscErrorCode PlainCreate(const MpmMarch *start, Plain *s)
{
  const MpmScene *scene = start->scene;

  PetscFunctionBegin;
  s->cells = scene->layout.grid[0].cells;
  s->n     = (PetscInt)scene->layout.particles;
  PetscCall(GatherField(start, scene->scheme.table->fields[0], &s->a));
  PetscCall(GatherField(start, scene->scheme.table->fields[1], &s->b));
  PetscCall(PetscMalloc6(s->n, &s->x, s->n, &s->rest, s->cells, &s->ai, s->cells, &s->bi, s->cells, &s->ci, s->cells,
                         &s->mass));
  for (PetscInt p = 0; p < s->n; p++) {
    PetscInt  cell;
    PetscReal xi;

    MpmLayoutPlace(&scene->layout, p, &cell, &xi);
    s->x[p] = s->rest[p] = fmod(cell + xi + s->cells, s->cells);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void SumToNodes(const Plain *s, const PetscReal q[], PetscReal g[])
{
  for (PetscInt i = 0; i < s->cells; i++) g[i] = s->mass[i] = 0;
  for (PetscInt p = 0; p < s->n; p++) {
    const PetscInt  i = (PetscInt)floor(s->x[p]), j = (i + 1) % s->cells;
    const PetscReal xi = s->x[p] - i;

    g[i] += (1 - xi) * q[p];
    g[j] += xi * q[p];
    s->mass[i] += 1 - xi;
    s->mass[j] += xi;
  }
  for (PetscInt i = 0; i < s->cells; i++) g[i] = s->mass[i] > 0 ? g[i] / s->mass[i] : 0;
}

static void AddGradient(const Plain *s, PetscReal k, const PetscReal g[], PetscReal q[])
{
  for (PetscInt p = 0; p < s->n; p++) {
    const PetscInt i = (PetscInt)floor(s->x[p]);

    q[p] += k * (g[(i + 1) % s->cells] - g[i]);
  }
}

static void AddValue(const Plain *s, PetscReal k, const PetscReal g[], PetscReal q[])
{
  for (PetscInt p = 0; p < s->n; p++) {
    const PetscInt  i  = (PetscInt)floor(s->x[p]);
    const PetscReal xi = s->x[p] - i;

    q[p] += k * ((1 - xi) * g[i] + xi * g[(i + 1) % s->cells]);
  }
}

/* Computes g_i = sum_p V_p h dphi_ip/dx q_p / sum_p V_p phi_ip. */
static void Divergence(const Plain *s, const PetscReal q[], PetscReal g[])
{
  for (PetscInt i = 0; i < s->cells; i++) g[i] = 0;
  for (PetscInt p = 0; p < s->n; p++) {
    const PetscInt i = (PetscInt)floor(s->x[p]);

    g[i] -= q[p];
    g[(i + 1) % s->cells] += q[p];
  }
  for (PetscInt i = 0; i < s->cells; i++) g[i] = s->mass[i] > 0 ? g[i] / s->mass[i] : 0;
}

/* A step of a momentum scheme: a = v, b = s; ai = v_i, ci = a_i / -k. */
static void MomentumStep(const char formulation[], PetscReal k, const Plain *s)
{
  SumToNodes(s, s->a, s->ai);
  if (!strcmp(formulation, "usf")) AddGradient(s, k, s->ai, s->b);
  if (!strcmp(formulation, "usavg")) AddGradient(s, k / 2, s->ai, s->b);
  Divergence(s, s->b, s->ci);
  AddValue(s, -k, s->ci, s->a);
  if (!strcmp(formulation, "usl")) {
    for (PetscInt i = 0; i < s->cells; i++) s->ai[i] -= k * s->ci[i];
    AddGradient(s, k, s->ai, s->b);
  } else if (strcmp(formulation, "usf")) {
    SumToNodes(s, s->a, s->ai);
    AddGradient(s, strcmp(formulation, "usavg") ? k : k / 2, s->ai, s->b);
  }
}

/* The part of the strain before the force with verlet, half of it. */
static void VerletStep(PetscReal k, const Plain *s)
{
  SumToNodes(s, s->a, s->ai);
  AddGradient(s, k / 2, s->ai, s->b);
  Divergence(s, s->b, s->ci);
  AddValue(s, -k, s->ci, s->a);
  for (PetscInt i = 0; i < s->cells; i++) s->ai[i] -= k * s->ci[i];
  AddGradient(s, k / 2, s->ai, s->b);
}

/* The classical Runge-Kutta step as text books have it, of d(v, s)/dt = (-G2P DIV s, GRAD P2G v). */
static PetscErrorCode RungeKuttaStep(PetscReal k, const Plain *s)
{
  static const PetscReal at[4] = {0, 0.5, 0.5, 1}, weight[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
  PetscReal             *v, *b, *dv, *db;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(s->n, &v, s->n, &b, s->n, &dv, s->n, &db));
  PetscCall(PetscArraycpy(v, s->a, s->n));
  PetscCall(PetscArraycpy(b, s->b, s->n));
  for (int stage = 0; stage < 4; stage++) {
    PetscReal *stage_v = dv, *stage_b = db;

    for (PetscInt p = 0; p < s->n; p++) {
      stage_v[p] = v[p] + (stage ? at[stage] * dv[p] : 0);
      stage_b[p] = b[p] + (stage ? at[stage] * db[p] : 0);
    }
    SumToNodes(s, stage_v, s->ai);
    Divergence(s, stage_b, s->ci);
    PetscCall(PetscArrayzero(dv, s->n));
    PetscCall(PetscArrayzero(db, s->n));
    AddValue(s, -k, s->ci, dv);
    AddGradient(s, k, s->ai, db);
    for (PetscInt p = 0; p < s->n; p++) {
      s->a[p] += weight[stage] * dv[p];
      s->b[p] += weight[stage] * db[p];
    }
  }
  PetscCall(PetscFree4(v, b, dv, db));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The midpoint rule: (M + k^2 / 4 K) d = - k M DIV (s + k / 2 GRAD v_i) by Gauss and Seidel's sweeps, where K has springs as
   stiff as there are particles in a cell.
*/
static PetscErrorCode MidpointStep(PetscReal k, const Plain *s)
{
  const PetscInt n = s->cells;
  PetscReal     *middle, *spring, *d = s->bi, change = 1;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(s->n, &middle, n, &spring));
  PetscCall(PetscArrayzero(spring, n));
  PetscCall(PetscArrayzero(d, n));
  SumToNodes(s, s->a, s->ai);
  PetscCall(PetscArraycpy(middle, s->b, s->n));
  AddGradient(s, k / 2, s->ai, middle);
  Divergence(s, middle, s->ci);
  for (PetscInt p = 0; p < s->n; p++) spring[(PetscInt)floor(s->x[p])] += k * k / 4;
  for (int sweep = 0; sweep < 10000 && change > 0; sweep++) {
    PetscReal most = 0;

    change = 0;
    for (PetscInt i = 0; i < n; i++) {
      const PetscReal left = spring[(i + n - 1) % n], right = spring[i], before = d[i];

      if (!(s->mass[i] > 0)) continue;
      d[i] = (left * d[(i + n - 1) % n] + right * d[(i + 1) % n] - k * s->mass[i] * s->ci[i]) /
             (s->mass[i] + left + right);
      change = PetscMax(change, fabs(d[i] - before));
      most   = PetscMax(most, fabs(d[i]));
    }
    if (change <= 1e-15 * most) change = 0;
  }
  AddValue(s, 1, d, s->a);
  for (PetscInt i = 0; i < n; i++) s->ai[i] += d[i] / 2;
  AddGradient(s, k, s->ai, s->b);
  PetscCall(PetscFree2(middle, spring));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PlainStep(const char formulation[], PetscReal k, const Plain *s)
{
  PetscFunctionBegin;
  if (!strcmp(formulation, "gas1")) {
    SumToNodes(s, s->a, s->ai);
    SumToNodes(s, s->b, s->bi);
    AddGradient(s, k, s->bi, s->a);
    AddGradient(s, k, s->ai, s->b);
  } else if (!strcmp(formulation, "gas2")) {
    SumToNodes(s, s->b, s->bi);
    AddGradient(s, k, s->bi, s->a);
    SumToNodes(s, s->a, s->ai);
    AddGradient(s, k, s->ai, s->b);
  } else if (!strcmp(formulation, "verlet")) {
    VerletStep(k, s);
  } else if (!strcmp(formulation, "rk")) {
    PetscCall(RungeKuttaStep(k, s));
  } else if (!strcmp(formulation, "implicit")) {
    PetscCall(MidpointStep(k, s));
  } else if (strcmp(formulation, "elastic")) {
    MomentumStep(formulation, k, s);
  } else {
    SumToNodes(s, s->a, s->ai);
    SumToNodes(s, s->b, s->bi);
    for (PetscInt i = 0; i < s->cells; i++)
      s->ci[i] = k * (s->ai[(i + 1) % s->cells] - 2 * s->ai[i] + s->ai[(i + s->cells - 1) % s->cells]);
    for (PetscInt i = 0; i < s->cells; i++) s->bi[i] += s->ci[i];
    AddValue(s, 1, s->ci, s->b);
    AddValue(s, k, s->bi, s->a);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes x = rest + n delta in extended precision, so that particles meet nodes where the fractions say they do. */
static void PlainDrift(const MpmScene *scene, PetscInt64 n, const Plain *s)
{
  const long double moved = (long double)scene->step.drift[0].num * n / scene->step.drift[0].den;

  for (PetscInt p = 0; p < s->n; p++) {
    const long double x = fmodl(s->rest[p] + moved, s->cells), turned = x < 0 ? x + s->cells : x;

    s->x[p] = roundl(turned) - turned < 1e-15L && roundl(turned) > turned ? fmod(roundl(turned), s->cells) : turned;
  }
}

static PetscErrorCode Agrees(const char formulation[], const char rest[])
{
  char       options[512];
  MpmScene  *scene;
  MpmMarch  *march;
  Plain      plain;
  PetscReal *a, *b;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -initial random %s", formulation, rest));
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  PetscCall(PlainCreate(march, &plain));
  for (PetscInt64 step = 0; step < check_request.steps; step++) {
    PetscCall(MpmMarchStep(march));
    PetscCall(PlainStep(formulation, scene->step.courant, &plain));
    PlainDrift(scene, step + 1, &plain);
  }
  PetscCall(GatherField(march, scene->scheme.table->fields[0], &a));
  PetscCall(GatherField(march, scene->scheme.table->fields[1], &b));
  CHECK(LargestDifference(plain.n, a, plain.a) <= 1e-11 * LargestNumber(plain.n, a), "%s: %g", options,
        LargestDifference(plain.n, a, plain.a));
  CHECK(LargestDifference(plain.n, b, plain.b) <= 1e-11 * LargestNumber(plain.n, b), "%s: %g", options,
        LargestDifference(plain.n, b, plain.b));
  PetscCall(PetscFree(a));
  PetscCall(PetscFree(b));
  PetscCall(PetscFree(plain.a));
  PetscCall(PetscFree(plain.b));
  PetscCall(PetscFree6(plain.x, plain.rest, plain.ai, plain.bi, plain.ci, plain.mass));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const rests[] = {
      "-cells 12 -steps 7",
      "-cells 12 -steps 7 -ppc 3 -offset 0 -courant 0.9",
      "-cells 13 -steps 9 -jitter 1 -seed 5",
      "-cells 40 -steps 60 -drift 1/4 -courant 0.1",              /* particles meet nodes exactly */
      "-cells 40 -steps 60 -drift -1/7 -courant 0.1 -jitter 0.8", /* particles drift to the left */
      "-cells 64 -steps 90 -drift 0.83 -courant 0.05 -ppc 1",     /* particles migrate every few steps */
      "-cells 18 -steps 12 -drift 7.3 -courant 0.05",             /* particles migrate in every step */
      "-cells 3000 -steps 5 -ppc 3 -jitter 0.9",                  /* several blocks, and passes one after another */
      "-cells 3000 -steps 40 -drift 0.7 -courant 0.05",
      "-cells 3000 -steps 40 -drift -13.1 -courant 0.05 -jitter 0.5",
      "-cells 9 -steps 20 -drift 1/3 -courant 0.1 -ppc 5", /* there is no room for more than one layer of ghosts */
  };
  PetscBool turn = PETSC_FALSE;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(rests); r++) {
      PetscCall(CheckHasTurn(f + (PetscInt)r, &turn));
      if (turn) PetscCall(Agrees(MpmFormulations[f]->name, rests[r]));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
