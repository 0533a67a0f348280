/*
   Materials that flow: the consistent tangent against central differences, loading and unloading; no flow gains energy, on
   random paths; the state after a flow is on the yield surface, and one that does not flow stays as it is to the last bit;
   exact paths of uniaxial strain, which are the same with dim 1, 2 and 3.
*/
#include "check.h"
#include <mpmstab/material.h>

#define STEP 1e-4 /* of differences of sixth order */
#define STATES 400

static const PetscReal differences[3] = {45. / 60, -9. / 60, 1. / 60};

typedef struct {
  PetscReal f[MPM_MOST_STRETCH];
} State;

static PetscReal Random(void)
{
  static PetscInt64 state = 1;

  state = (PetscInt64)(((unsigned long long)state * 6364136223846793005ull + 1442695040888963407ull) >> 1);
  return (PetscReal)(state % 1000003) / 1000003 - 0.5;
}

static State AtRest(const MpmLaw *law, PetscInt dim)
{
  State s;

  for (PetscInt c = 0; c < dim * dim; c++) s.f[c] = c % (dim + 1) == 0;
  for (PetscInt c = dim * dim; c < MpmLawComponents(law, dim); c++)
    (void)MpmMaterialInternal(&(MpmMaterialNumbers){.law = law}, dim, c - dim * dim, &s.f[c]);
  return s;
}

static void Pointers(const State *s, const PetscReal *at[MPM_MOST_STRETCH])
{
  for (PetscInt c = 0; c < MPM_MOST_STRETCH; c++) at[c] = &s->f[c];
}

static State Returned(const MpmMaterialNumbers *m, PetscInt dim, State s)
{
  PetscReal *at[MPM_MOST_STRETCH];

  for (PetscInt c = 0; c < MPM_MOST_STRETCH; c++) at[c] = &s.f[c];
  MpmMaterialReturn(m, dim, 1, at);
  return s;
}

static State Tangent(const MpmMaterialNumbers *m, PetscInt dim, MpmBranch branch, const State *s, const State *d,
                     PetscInt *on_surface)
{
  const PetscReal *at[MPM_MOST_STRETCH], *along[MPM_MOST_STRETCH];
  PetscReal       *to[MPM_MOST_STRETCH];
  State            after = {{0}};

  Pointers(s, at);
  Pointers(d, along);
  for (PetscInt c = 0; c < MPM_MOST_STRETCH; c++) to[c] = &after.f[c];
  *on_surface = MpmMaterialReturnTangent(m, dim, 1, branch, at, along, to);
  return after;
}

static PetscReal Energy(const MpmMaterialNumbers *m, PetscInt dim, const State *s)
{
  const PetscReal *at[MPM_MOST_STRETCH];
  PetscReal        psi;

  Pointers(s, at);
  MpmMaterialEnergy(m, dim, 1, at, &psi);
  return psi;
}

static State Plus(const State *s, PetscReal a, const State *d)
{
  State sum;

  for (PetscInt c = 0; c < MPM_MOST_STRETCH; c++) sum.f[c] = s->f[c] + a * d->f[c];
  return sum;
}

static PetscReal Largest(const State *s, PetscInt n)
{
  PetscReal largest = 0;

  for (PetscInt c = 0; c < n; c++) largest = PetscMax(largest, fabs(s->f[c]));
  return largest;
}

static PetscBool Same(const State *a, const State *b, PetscInt n)
{
  for (PetscInt c = 0; c < n; c++)
    if (a->f[c] != b->f[c]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Random trial values, some within the yield surface and some beyond. Where a stencil meets a kink the tangent jumps. */
static void CheckTangent(const MpmMaterialNumbers *m, PetscInt dim, PetscReal size)
{
  const PetscInt n          = MpmLawComponents(m->law, dim);
  PetscInt       checked[2] = {0, 0}, kinks = 0, on_surface;

  for (PetscInt i = 0; i < STATES; i++) {
    State s = AtRest(m->law, dim), d = {{0}}, expected = {{0}}, found, ends[2], after;

    for (PetscInt c = 0; c < n; c++) {
      s.f[c] += size * Random() * (i % 4 ? 1 : 0.01);
      d.f[c] = Random();
    }
    if (i % 8 == 5) /* two principal stretches that are alike */
      for (PetscInt c = 0; c < dim * dim; c++) s.f[c] = c % (dim + 1) ? 0 : s.f[0];
    s.f[dim * dim] = i % 3 ? fabs(s.f[dim * dim]) : m->law->plastic->start; /* no law has it below 0 */
    if (i % 3 == 0) d.f[dim * dim] = 0;
    found = Tangent(m, dim, MPM_BRANCH_OWN, &s, &d, &on_surface);
    for (int k = 0; k < 3; k++)
      for (int side = 0; side < 2; side++) {
        ends[side] = Plus(&s, (side ? -1 : 1) * (k + 1) * STEP, &d);
        after      = Returned(m, dim, ends[side]);
        expected   = Plus(&expected, (side ? -1 : 1) * differences[k] / STEP, &after);
        ends[side] = Tangent(m, dim, MPM_BRANCH_OWN, &ends[side], &d, &on_surface);
      }
    after = Plus(&ends[0], -1, &ends[1]);
    if (Largest(&after, n) > 0.02 * (1 + Largest(&found, n))) {
      kinks++;
      continue;
    }
    after = Returned(m, dim, s);
    checked[Same(&after, &s, n)]++;
    for (PetscInt c = 0; c < n; c++) CHECK_NEAR(found.f[c], expected.f[c], 2e-8 * (1 + fabs(found.f[c])));
  }
  CHECK(checked[0] > STATES / 3 && (checked[1] > STATES / 50 || m->law == &MpmLawSand) && kinks < STATES / 4,
        "%s, dim %d: %d flow, %d do not, %d are at a kink", m->law->name, (int)dim, (int)checked[0], (int)checked[1],
        (int)kinks);
}

/* A state that has flowed stands on the surface. There the branches are those of a little more, and of a little less. */
static void CheckBranches(const MpmMaterialNumbers *m, PetscInt dim)
{
  const PetscInt n = MpmLawComponents(m->law, dim);
  State          s = AtRest(m->law, dim), d = {{0}}, loading, unloading, other;
  PetscInt       on_surface;

  s.f[0] = 0.9;
  other  = Returned(m, dim, s);
  if (Same(&other, &s, n)) s.f[0] = 1.1; /* sand of much friction */
  s         = Returned(m, dim, s);
  d.f[0]    = -1;
  loading   = Tangent(m, dim, MPM_BRANCH_LOADING, &s, &d, &on_surface);
  unloading = Tangent(m, dim, MPM_BRANCH_UNLOADING, &s, &d, &on_surface);
  CHECK(on_surface == 1, "%s, dim %d: %d on the surface", m->law->name, (int)dim, (int)on_surface);
  CHECK(Same(&unloading, &d, n), "%s, dim %d: unloading flows", m->law->name, (int)dim);
  other = Plus(&s, 1e-7, &d);
  other = Tangent(m, dim, MPM_BRANCH_UNLOADING, &other, &d, &on_surface);
  CHECK(on_surface == 0, "%s, dim %d: a state beyond is on the surface", m->law->name, (int)dim);
  for (PetscInt c = 0; c < n; c++) CHECK_NEAR(loading.f[c], other.f[c], 1e-4 * (1 + fabs(other.f[c])));
}

/* Snow gains energy where its moduli grow much in a flow, or where a bound holds against the stress (snow.c). */
static PetscBool Gains(const MpmMaterialNumbers *m, const State *s, PetscInt dim)
{
  if (m->law != &MpmLawSnow) return PETSC_FALSE;
  return m->lambda > 0 || m->plastic[MPM_HARDENING] * s->f[dim * dim] * m->plastic[MPM_COMPRESSION_LIMIT] > 0.5
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* Random paths of small steps: each flow takes elastic energy, and ends on the surface. */
static void CheckPaths(const MpmMaterialNumbers *m, PetscInt dim)
{
  const PetscInt n     = MpmLawComponents(m->law, dim);
  PetscInt       flows = 0;

  for (PetscInt path = 0; path < 20; path++) {
    State s = AtRest(m->law, dim);

    for (PetscInt i = 0; i < 100; i++) {
      State     trial = s, again;
      PetscReal lost, change;

      for (PetscInt a = 0; a < dim; a++)
        for (PetscInt b = 0; b < dim; b++) {
          const PetscReal L = 0.02 * (Random() + 0.3 * sin(0.1 * i + path + a - 2 * b));

          for (PetscInt c = 0; c < dim; c++) trial.f[a * dim + c] += L * s.f[b * dim + c];
        }
      s    = Returned(m, dim, trial);
      lost = Energy(m, dim, &trial) - Energy(m, dim, &s);
      CHECK(lost >= -1e-15 || Gains(m, &trial, dim), "%s, dim %d: a flow gains %g", m->law->name, (int)dim, -lost);
      again  = Returned(m, dim, s);
      again  = Plus(&again, -1, &s);
      change = Largest(&again, n);
      CHECK(change < 1e-12, "%s, dim %d: a state that has flowed flows by %g", m->law->name, (int)dim, change);
      flows += !Same(&s, &trial, n);
    }
  }
  CHECK(flows > 200, "%s, dim %d: %d steps flow", m->law->name, (int)dim, (int)flows);
}

/* tau_xx after uniaxial strain to ln F = e in n steps, from a state. */
static PetscReal Pull(const MpmMaterialNumbers *m, PetscInt dim, PetscReal e, PetscInt n, State *s)
{
  const PetscReal *at[MPM_MOST_STRETCH];
  PetscReal        tau[6], *to[6];

  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt c = 0; c < dim; c++) s->f[c] *= exp(e / n);
    *s = Returned(m, dim, *s);
  }
  Pointers(s, at);
  for (PetscInt c = 0; c < 6; c++) to[c] = &tau[c];
  MpmMaterialStress(m, dim, 1, at, to);
  return tau[0];
}

/*
   Metal in uniaxial strain yields at 2 mu e = Y. After that the lateral flow is minus half the axial one, q, so that
   tau_xx - tau_yy = 2 mu (e - 3/2 q) = Y(q) and tau_xx = K e + 2/3 Y(q). Back, it is elastic.
*/
static void CheckMises(PetscInt dim)
{
  MpmMaterialNumbers m = MpmMaterialOfRatio(&MpmLawMises, 1.5, 0);
  const PetscReal    K = m.lambda + 2 * m.mu / 3, e = -0.04;
  PetscReal          q, Y;
  State              s = AtRest(m.law, dim);

  m.plastic[MPM_HARDENING] = 0.05;
  CHECK_NEAR(Pull(&m, dim, 0.99 * m.plastic[MPM_YIELD] / (2 * m.mu), 3, &s), 0.99 * m.plastic[MPM_YIELD] / (2 * m.mu),
             1e-15); /* lambda + 2 mu is 1 */
  s = AtRest(m.law, dim);
  q = (2 * m.mu * fabs(e) - m.plastic[MPM_YIELD]) / (0.05 + 3 * m.mu);
  Y = m.plastic[MPM_YIELD] + 0.05 * q;
  CHECK_NEAR(Pull(&m, dim, e, 7, &s), -(K * fabs(e) + 2 * Y / 3), 1e-14);
  CHECK_NEAR(s.f[dim * dim], q, 1e-14);
  CHECK_NEAR(Pull(&m, dim, 1e-3, 2, &s), -(K * fabs(e) + 2 * Y / 3) + 1e-3, 1e-14);
  m.plastic[MPM_HARDENING]       = 0;
  m.plastic[MPM_SATURATION]      = 0.01;
  m.plastic[MPM_SATURATION_RATE] = 40;
  s                              = AtRest(m.law, dim);
  Y                              = Pull(&m, dim, -e, 400, &s);
  q                              = s.f[dim * dim];
  CHECK_NEAR(Y, K * -e + 2. / 3 * (m.plastic[MPM_YIELD] + 0.01 * (1 - exp(-40 * q))), 1e-12);
  CHECK_NEAR(2 * m.mu * (-e - 1.5 * q), m.plastic[MPM_YIELD] + 0.01 * (1 - exp(-40 * q)), 1e-12);
}

/* Snow in uniaxial strain is at a bound, and what is beyond is the plastic volume. */
static void CheckSnow(PetscInt dim)
{
  const MpmMaterialNumbers m = MpmMaterialOfRatio(&MpmLawSnow, 1.5, 0);

  for (int side = 0; side < 2; side++) {
    const PetscReal s0 = side ? 1 + m.plastic[MPM_STRETCH_LIMIT] : 1 - m.plastic[MPM_COMPRESSION_LIMIT];
    const PetscReal J = side ? 1.1 : 0.9, grown = exp(m.plastic[MPM_HARDENING] * (1 - J / s0));
    State           s = AtRest(m.law, dim);

    CHECK_NEAR(Pull(&m, dim, log(J), 11, &s), grown * (s0 - 1) * s0, 1e-14);
    CHECK_NEAR(s.f[dim * dim], J / s0, 1e-14);
    CHECK_NEAR(s.f[0], s0, 1e-14);
    if (dim == 1) CHECK_NEAR(MpmMaterialModulus(&m, dim, s.f), grown * ((2 * s0 - 1) * s0 - (s0 - 1) * s0), 1e-12);
  }
}

/*
   Sand in uniaxial strain e < 0 slides where d = sqrt(2/3) |e| is more than k |e|: e' = e (1/3 + 2 k / sqrt(6)) along x. Pulled
   it bears nothing, and is to be pressed together by as much before it does again.
*/
static void CheckSand(PetscInt dim)
{
  MpmMaterialNumbers m = MpmMaterialOfRatio(&MpmLawSand, 1.5, 0);
  const PetscReal    e = -0.02, sine = sin(M_PI / 12);
  const PetscReal    k = sqrt(2. / 3) * 2 * sine / (3 - sine) * (3 * m.lambda + 2 * m.mu) / (2 * m.mu);
  State              s = AtRest(m.law, dim);

  CHECK_NEAR(Pull(&m, dim, e, 5, &s), e, 1e-14); /* with 35 degrees it is elastic */
  m.plastic[MPM_FRICTION_ANGLE] = 15;
  s                             = AtRest(m.law, dim);
  CHECK_NEAR(Pull(&m, dim, e, 5, &s), e * (m.lambda + 2 * m.mu * (1. / 3 + 2 * k / sqrt(6))), 1e-14);
  CHECK_NEAR(Pull(&m, dim, -2 * e, 9, &s), 0, 1e-14);
  CHECK_NEAR(s.f[dim * dim], -e, 1e-14);
  CHECK_NEAR(Pull(&m, dim, e / 2, 3, &s), 0, 1e-14);
  CHECK_NEAR(Pull(&m, dim, 3 * e / 2, 1, &s), e * (m.lambda + 2 * m.mu * (1. / 3 + 2 * k / sqrt(6))), 1e-14);
  CHECK_NEAR(s.f[dim * dim], 0, 0);
}

/* The pressure and Q = sqrt(3/2) norm(dev tau) of a state with dim 3 whose axes are those of the grid. */
static void Invariants(const MpmMaterialNumbers *m, const State *s, PetscReal *p, PetscReal *Q)
{
  const PetscReal *at[MPM_MOST_STRETCH];
  PetscReal        tau[6], *to[6];

  Pointers(s, at);
  for (PetscInt c = 0; c < 6; c++) to[c] = &tau[c];
  MpmMaterialStress(m, 3, 1, at, to);
  *p = -(tau[0] + tau[3] + tau[5]) / 3;
  *Q = sqrt(1.5 * (PetscSqr(tau[0] + *p) + PetscSqr(tau[3] + *p) + PetscSqr(tau[5] + *p)));
}

/*
   Clay that is compressed for the first time stays on its line, p = yield exp(hardening q), whatever the steps. Then it is
   sheared at constant volume, and comes to the critical state Q = M p, p = c / 2.
*/
static void CheckClay(void)
{
  const MpmMaterialNumbers m = MpmMaterialOfRatio(&MpmLawClay, 1.5, 0);
  const PetscReal          K = m.lambda + 2 * m.mu / 3, sine = sin(m.plastic[MPM_FRICTION_ANGLE] * M_PI / 180);
  State                    s = AtRest(m.law, 3);
  PetscReal                p, Q;

  for (PetscInt i = 0; i < 5; i++) {
    for (PetscInt a = 0; a < 3; a++) s.f[4 * a] *= exp(-0.1 / 3 / 5);
    s = Returned(&m, 3, s);
  }
  Invariants(&m, &s, &p, &Q);
  CHECK_NEAR(p, m.plastic[MPM_YIELD] * exp(m.plastic[MPM_HARDENING] * s.f[9]), 1e-14);
  CHECK_NEAR(p / K + s.f[9], 0.1, 1e-14);
  CHECK_NEAR(Q, 0, 1e-14);
  for (PetscInt i = 0; i < 300; i++) {
    for (PetscInt a = 0; a < 3; a++) s.f[4 * a] *= exp(a ? -0.005 : 0.01);
    s = Returned(&m, 3, s);
  }
  Invariants(&m, &s, &p, &Q);
  CHECK_NEAR(p, m.plastic[MPM_YIELD] * exp(m.plastic[MPM_HARDENING] * s.f[9]) / 2, 1e-10);
  CHECK_NEAR(Q / p, 6 * sine / (3 - sine), 1e-10);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt dim = 1; dim <= 3; dim++) {
    for (const MpmLaw *const *law = MpmLaws; *law; law++) {
      if (!(*law)->plastic) continue;
      for (int harder = 0; harder < 2; harder++) {
        MpmMaterialNumbers m = MpmMaterialOfRatio(*law, harder ? 1.5 : 0, 0);

        for (PetscInt i = 0; i < MPM_PLASTIC_NUMBERS && harder; i++)
          m.plastic[i] = m.plastic[i] > 0 ? 1.5 * m.plastic[i] : 0.01;
        CheckTangent(&m, dim, 0.4);
        CheckBranches(&m, dim);
        CheckPaths(&m, dim);
      }
    }
    CheckMises(dim);
    CheckSnow(dim);
    CheckSand(dim);
  }
  CheckClay();
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
