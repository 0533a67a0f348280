/*
   Particles that differ in mass, volume and stiffness. The march is compared with plain loops of the hat's maps, a bar
   of the second material alone with one of the first, and a wave at an interface with its reflection coefficient.
*/
#include "gather.h"

typedef struct {
  PetscInt   n, cells;
  PetscInt  *cell;
  PetscReal *xi, *m, *V, *E, *v, *s;
} Bar;

/* Computes g_i = sum_p S_ip w_p q_p, or with slope h dS_ip/dx for S_ip, on a ring of cells. */
static void Sum(const Bar *b, const PetscReal w[], const PetscReal q[], PetscBool slope, PetscReal g[])
{
  for (PetscInt i = 0; i < b->cells; i++) g[i] = 0;
  for (PetscInt p = 0; p < b->n; p++) {
    const PetscInt  i = b->cell[p], right = (i + 1) % b->cells;
    const PetscReal a = w[p] * (q ? q[p] : 1);

    g[i] += slope ? -a : (1 - b->xi[p]) * a;
    g[right] += slope ? a : b->xi[p] * a;
  }
}

/* A step of usl: v_i = P2G v; a_i = -k DIV s; v_p += G2P a_i; v_i += a_i; s_p += k E_p GRAD v_i. */
static void Step(const Bar *b, PetscReal k)
{
  PetscReal m[64], v[64], a[64];

  Sum(b, b->m, NULL, PETSC_FALSE, m);
  Sum(b, b->m, b->v, PETSC_FALSE, v);
  Sum(b, b->V, b->s, PETSC_TRUE, a);
  for (PetscInt i = 0; i < b->cells; i++) {
    a[i] = m[i] > 0 ? -k * a[i] / m[i] : 0;
    v[i] = (m[i] > 0 ? v[i] / m[i] : 0) + a[i];
  }
  for (PetscInt p = 0; p < b->n; p++) {
    const PetscInt i = b->cell[p], right = (i + 1) % b->cells;

    b->v[p] += (1 - b->xi[p]) * a[i] + b->xi[p] * a[right];
    b->s[p] += k * b->E[p] * (v[right] - v[i]);
  }
}

/* 12 cells of 1, 4, 0 and 2 particles; cells 3 to 9 are 5 times as dense and 300 times as stiff. */
static PetscErrorCode PlainLoop(void)
{
  const PetscInt count[4] = {1, 4, 0, 2}, cells = 12, n = 21, steps = 40;
  PetscInt       cell[21], p = 0;
  PetscReal      xi[21], m[21], V[21], E[21], *v, *s, *end;
  Bar            bar = {n, cells, cell, xi, m, V, E, NULL, NULL};
  MpmScene      *scene;
  MpmMarch      *march;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < cells; c++) {
    for (PetscInt j = 0; j < count[c % 4]; j++, p++) {
      const PetscBool second = c + (j + 0.25) / count[c % 4] >= 3 && c + (j + 0.25) / count[c % 4] < 9;

      cell[p] = c;
      xi[p]   = (j + 0.25) / count[c % 4];
      V[p]    = 4.0 / count[c % 4];
      m[p]    = second ? 5 * V[p] : V[p];
      E[p]    = second ? 300 : 1;
    }
  }
  PetscCall(CheckScene("-formulation usl -cells 12 -counts 1,4,0,2 -offset 1/4 -material two -density_ratio 5 "
                       "-stiffness_ratio 300 -inclusion 3,9 -courant 0.03 -initial random -steps 40",
                       &scene));
  CHECK(scene->layout.particles == n, "%d particles", (int)scene->layout.particles);
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  PetscCall(GatherField(march, "v", &v));
  PetscCall(GatherField(march, "s", &s));
  bar.v = v;
  bar.s = s;
  for (PetscInt step = 0; step < steps; step++) {
    Step(&bar, scene->step.courant);
    PetscCall(MpmMarchStep(march));
  }
  PetscCall(GatherField(march, "v", &end));
  CHECK_NEAR(LargestDifference(n, end, v), 0, 1e-13 * LargestNumber(n, v));
  PetscCall(PetscFree(end));
  PetscCall(GatherField(march, "s", &end));
  CHECK_NEAR(LargestDifference(n, end, s), 0, 1e-13 * LargestNumber(n, s));
  CHECK(LargestNumber(n, s) < 1e3, "the bar is not stable: %g", LargestNumber(n, s));
  PetscCall(PetscFree(end));
  PetscCall(PetscFree(s));
  PetscCall(PetscFree(v));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the velocities at the last step, and the energy as MpmMarchNorms has it a step later. */
static PetscErrorCode Velocities(const char options[], PetscInt64 *n, PetscReal **v, PetscReal *energy)
{
  MpmScene *scene;
  MpmMarch *march;
  MpmNorms  norms;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MarchScene(PETSC_COMM_WORLD, scene, &march));
  PetscCall(GatherField(march, "v", v));
  *n = scene->layout.particles;
  PetscCall(MpmMarchStep(march));
  PetscCall(MpmMarchNorms(march, &norms));
  *energy = scalbn(norms.energy, 2 * (int)march->exponent);
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   With density 4 and stiffness 9 everywhere, waves are 3/2 times as fast and have 4 times the energy. With initial mode
   and elastic v, s is 0 at first.
*/
static PetscErrorCode AllSecond(void)
{
  const char *schemes[] = {"usl -transfer xpic", "usf -transfer apic -basis quadratic", "musl -basis cubic",
                           "usavg -transfer nullspace"};
  char        options[512];
  PetscReal  *first, *second, energy[2];
  PetscInt64  n;

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(schemes); i++) {
    const char *rest = "-cells 16 -boundary fixed,free -jitter 0.5 -steps 20 -initial mode";

    PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s %s -courant 0.3", schemes[i], rest));
    PetscCall(Velocities(options, &n, &first, &energy[0]));
    PetscCall(PetscSNPrintf(options, sizeof options,
                            "-formulation %s %s -courant 0.2 -material two -inclusion 0,16 -density_ratio 4 "
                            "-stiffness_ratio 9",
                            schemes[i], rest));
    PetscCall(Velocities(options, &n, &second, &energy[1]));
    CHECK_NEAR(LargestDifference(n, first, second), 0, 1e-11);
    CHECK_NEAR(energy[1], 4 * energy[0], 1e-10 * energy[1]);
    CHECK(LargestNumber(n, first) > 0.1, "%s: nothing moves", schemes[i]);
    PetscCall(PetscFree(first));
    PetscCall(PetscFree(second));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Gauss(PetscReal X)
{
  return exp(-0.5 * PetscSqr((X - 0.25) / 0.05));
}

/*
   A wave from the first material meets one 4 times as dense at L/2. The impedances are 1 and 2, so (1 - 2) / (1 + 2) of
   its velocity is reflected, and 2 / (1 + 2) goes on at half the speed. Returns the l2 error at time 0.4 L / c.
*/
static PetscErrorCode InterfaceError(PetscInt cells, PetscReal *error)
{
  char       options[256];
  PetscReal *v, sum = 0, t = 0.4, energy;
  PetscInt64 n;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options,
                          "-formulation usl -basis quadratic -ppc 2 -cells %" PetscInt_FMT
                          " -initial pulse -courant 0.25 -time 0.4 -material two -density_ratio 4",
                          cells));
  PetscCall(Velocities(options, &n, &v, &energy));
  for (PetscInt64 p = 0; p < n; p++) {
    const PetscReal X     = (p + 0.5) / n;
    const PetscReal exact = X < 0.5 ? Gauss(X - t) - Gauss(1 - X - t) / 3 : 2.0 / 3 * Gauss(0.5 + 2 * (X - 0.5) - t);

    sum += PetscSqr(v[p] - exact) / n;
  }
  *error = sqrt(sum);
  PetscCall(PetscFree(v));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscReal coarse, middle, fine;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(PlainLoop());
  PetscCall(AllSecond());
  PetscCall(InterfaceError(160, &coarse));
  PetscCall(InterfaceError(320, &middle));
  PetscCall(InterfaceError(640, &fine));
  CHECK(coarse / middle > 1.9 && middle / fine > 1.9 && fine < 5e-3, "interface: %g %g %g", coarse, middle, fine);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
