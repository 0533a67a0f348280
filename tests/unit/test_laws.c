/*
   Materials at finite strain, on random stretches in one to three dimensions, in arrays longer than a block: the stress
   is the derivative of the energy and turns with the material, the tangent is the derivative of the stress, small
   strains have Lame's moduli, and one dimension has the formulas of theory. A viscous stress has its tangent, below the yield
   stress and beyond, and never gives energy. Of laws that flow this is the elastic part;
   test_plastic has the flow.
*/
#include "check.h"
#include <mpmstab/material.h>

#define STATES 130
#define STEP 0x1p-8 /* of differences of sixth order */

typedef struct {
  PetscReal f[MPM_MOST_STRETCH][STATES];
} Tensors;

static PetscReal Random(void)
{
  static PetscInt64 state = 1;

  state = (PetscInt64)(((unsigned long long)state * 6364136223846793005ull + 1442695040888963407ull) >> 1);
  return (PetscReal)(state % 1000003) / 1000003 - 0.5;
}

/* A turn by a random angle about each pair of axes. */
static void Turn(PetscInt dim, PetscReal Q[9])
{
  for (PetscInt c = 0; c < dim * dim; c++) Q[c] = c % (dim + 1) == 0;
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = a + 1; b < dim; b++) {
      const PetscReal angle = 6 * Random(), cosine = cos(angle), sine = sin(angle);

      for (PetscInt r = 0; r < dim; r++) {
        const PetscReal x = Q[r * dim + a], y = Q[r * dim + b];

        Q[r * dim + a] = cosine * x + sine * y;
        Q[r * dim + b] = cosine * y - sine * x;
      }
    }
}

/* out = X Y, or X Y^T */
static void Product(PetscInt dim, const PetscReal X[], const PetscReal Y[], PetscBool transposed, PetscReal out[])
{
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++) {
      out[a * dim + b] = 0;
      for (PetscInt c = 0; c < dim; c++) out[a * dim + b] += X[a * dim + c] * Y[transposed ? b * dim + c : c * dim + b];
    }
}

static PetscInt Symmetric(PetscInt dim, PetscInt a, PetscInt b)
{
  const PetscInt i = PetscMin(a, b), j = PetscMax(a, b);

  return i * dim - i * (i - 1) / 2 + j - i;
}

/* The full tensor of state p from its d (d + 1) / 2 components. */
static void Full(PetscInt dim, const Tensors *s, PetscInt p, PetscReal out[])
{
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++) out[a * dim + b] = s->f[Symmetric(dim, a, b)][p];
}

static void Get(PetscInt dim, const Tensors *t, PetscInt p, PetscReal out[])
{
  for (PetscInt c = 0; c < dim * dim; c++) out[c] = t->f[c][p];
}

static void Put(PetscInt dim, const PetscReal in[], PetscInt p, Tensors *t)
{
  for (PetscInt c = 0; c < dim * dim; c++) t->f[c][p] = in[c];
}

static void Pointers(const Tensors *t, const PetscReal *at[MPM_MOST_STRETCH])
{
  for (PetscInt c = 0; c < MPM_MOST_STRETCH; c++) at[c] = t->f[c];
}

/* Internal variables near where they begin, which do not change along dF. */
static void FillInternal(const MpmLaw *law, PetscInt dim, PetscReal size, Tensors *F, Tensors *dF)
{
  for (PetscInt c = dim * dim; c < MpmLawComponents(law, dim); c++)
    for (PetscInt p = 0; p < STATES; p++) {
      (void)MpmMaterialInternal(&(MpmMaterialNumbers){.law = law}, dim, c - dim * dim, &F->f[c][p]);
      F->f[c][p] += size * Random();
      if (dF) dF->f[c][p] = 0;
    }
}

static void Stress(const MpmMaterialNumbers *m, PetscInt dim, const Tensors *F, Tensors *tau)
{
  const PetscReal *f[MPM_MOST_STRETCH];
  PetscReal       *t[9];

  Pointers(F, f);
  for (PetscInt c = 0; c < 9; c++) t[c] = tau->f[c];
  MpmMaterialStress(m, dim, STATES, f, t);
}

static void Tangent(const MpmMaterialNumbers *m, PetscInt dim, const Tensors *F, const Tensors *dF, Tensors *dtau)
{
  const PetscReal *f[MPM_MOST_STRETCH], *df[MPM_MOST_STRETCH];
  PetscReal       *t[9];

  Pointers(F, f);
  Pointers(dF, df);
  for (PetscInt c = 0; c < 9; c++) t[c] = dtau->f[c];
  MpmMaterialTangent(m, dim, STATES, f, df, t);
}

static void Energy(const MpmMaterialNumbers *m, PetscInt dim, const Tensors *F, PetscReal psi[])
{
  const PetscReal *f[MPM_MOST_STRETCH];

  Pointers(F, f);
  MpmMaterialEnergy(m, dim, STATES, f, psi);
}

/* F = Q stretch R with principal stretches between 0.6 and 1.6; n is the direction of the largest, where it is along Q. */
static void Draw(PetscInt dim, Tensors *F, Tensors *dF, Tensors *turn)
{
  for (PetscInt p = 0; p < STATES; p++) {
    PetscReal Q[9], R[9], S[9], f[9], largest[3];

    Turn(dim, Q);
    Turn(dim, R);
    for (PetscInt a = 0; a < dim; a++) largest[a] = 1.1 + Random();
    for (PetscInt a = 1; a < dim; a++)
      if (largest[a] > largest[0]) {
        const PetscReal swap = largest[0];

        largest[0] = largest[a];
        largest[a] = swap;
      }
    for (PetscInt c = 0; c < dim * dim; c++) S[c] = Q[c] * largest[c % dim];
    Product(dim, S, R, PETSC_TRUE, f);
    Put(dim, f, p, F);
    Put(dim, Q, p, turn);
    for (PetscInt c = 0; c < dim * dim; c++) dF->f[c][p] = Random();
  }
}

static void Along(const Tensors *F, const Tensors *dF, PetscReal step, Tensors *out)
{
  for (PetscInt c = 0; c < MPM_MOST_STRETCH; c++)
    for (PetscInt p = 0; p < STATES; p++) out->f[c][p] = F->f[c][p] + step * dF->f[c][p];
}

static const PetscReal differences[3] = {45. / 60, -9. / 60, 1. / 60};

static void CheckDerivatives(const MpmMaterialNumbers *m, PetscInt dim, const Tensors *F, const Tensors *dF)
{
  static Tensors tau, dtau, moved, expected, at[2];
  PetscReal      work[STATES] = {0}, psi[2][STATES];

  memset(&expected, 0, sizeof expected);
  Stress(m, dim, F, &tau);
  Tangent(m, dim, F, dF, &dtau);
  for (int k = 0; k < 3; k++) {
    for (int side = 0; side < 2; side++) {
      Along(F, dF, (side ? -1 : 1) * (k + 1) * STEP, &moved);
      Stress(m, dim, &moved, &at[side]);
      Energy(m, dim, &moved, psi[side]);
    }
    for (PetscInt p = 0; p < STATES; p++) {
      work[p] += differences[k] * (psi[0][p] - psi[1][p]) / STEP;
      for (PetscInt c = 0; c < dim * (dim + 1) / 2; c++)
        expected.f[c][p] += differences[k] * (at[0].f[c][p] - at[1].f[c][p]) / STEP;
    }
  }
  for (PetscInt p = 0; p < STATES; p++) {
    PetscReal f[9], inverse[9], df[9], l[9], t[9], power = 0, J = 0;

    for (PetscInt c = 0; c < dim * (dim + 1) / 2; c++)
      CHECK_NEAR(dtau.f[c][p], expected.f[c][p], 1e-9 * (1 + fabs(dtau.f[c][p])));
    Get(dim, F, p, f); /* tau : (dF F^-1), with the inverse by cofactors */
    Get(dim, dF, p, df);
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = 0; b < dim; b++) {
        const PetscInt a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;

        inverse[b * dim + a] = dim == 1   ? 1
                               : dim == 2 ? (a == b ? 1 : -1) * f[(1 - a) * 2 + 1 - b]
                                          : f[a1 * 3 + b1] * f[a2 * 3 + b2] - f[a1 * 3 + b2] * f[a2 * 3 + b1];
      }
    for (PetscInt c = 0; c < dim; c++) J += f[c] * inverse[c * dim];
    Product(dim, df, inverse, PETSC_FALSE, l);
    Full(dim, &tau, p, t);
    for (PetscInt c = 0; c < dim * dim; c++) power += t[c] * l[c] / J;
    CHECK_NEAR(power, work[p], 1e-9 * (1 + fabs(power)));
  }
}

/* tau(Q F) = Q tau Q^T, tau(F Q) = tau. */
static void CheckTurned(const MpmMaterialNumbers *m, PetscInt dim, const Tensors *F, const Tensors *turn)
{
  static Tensors tau, left, right, of_left, of_right;

  Stress(m, dim, F, &tau);
  left = right = *F;
  for (PetscInt p = 0; p < STATES; p++) {
    PetscReal f[9], q[9], product[9] = {0};

    Get(dim, F, p, f);
    Get(dim, turn, p, q);
    Product(dim, q, f, PETSC_FALSE, product);
    Put(dim, product, p, &left);
    Product(dim, f, q, PETSC_FALSE, product);
    Put(dim, product, p, &right);
  }
  Stress(m, dim, &left, &of_left);
  Stress(m, dim, &right, &of_right);
  for (PetscInt p = 0; p < STATES; p++) {
    PetscReal q[9], t[9], qt[9], expected[9], found[9], same[9];

    Get(dim, turn, p, q);
    Full(dim, &tau, p, t);
    Product(dim, q, t, PETSC_FALSE, qt);
    Product(dim, qt, q, PETSC_TRUE, expected);
    Full(dim, &of_left, p, found);
    Full(dim, &of_right, p, same);
    for (PetscInt c = 0; c < dim * dim; c++) {
      CHECK_NEAR(found[c], expected[c], 1e-14 * (100 + fabs(expected[c])));
      CHECK_NEAR(same[c], t[c], 1e-14 * (100 + fabs(t[c])));
    }
  }
}

/* With l = n n^T, n a principal direction, the force is n . (dtau - tau l^T) n: rho0 c^2 of the wave along n. */
static void Moduli(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const Tensors *F, const Tensors *turn,
                   PetscReal modulus[])
{
  static Tensors dF, tau, dtau;

  memset(&dF, 0, sizeof dF);
  for (PetscInt p = 0; p < STATES; p++) {
    PetscReal f[9], q[9], l[9], df[9];

    Get(dim, F, p, f);
    Get(dim, turn, p, q);
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = 0; b < dim; b++) l[a * dim + b] = q[a * dim + n] * q[b * dim + n];
    Product(dim, l, f, PETSC_FALSE, df);
    Put(dim, df, p, &dF);
  }
  Stress(m, dim, F, &tau);
  Tangent(m, dim, F, &dF, &dtau);
  for (PetscInt p = 0; p < STATES; p++) {
    PetscReal q[9], t[9], dt[9];

    Get(dim, turn, p, q);
    Full(dim, &tau, p, t);
    Full(dim, &dtau, p, dt);
    modulus[p] = 0;
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = 0; b < dim; b++)
        modulus[p] += q[a * dim + n] * (dt[a * dim + b] - t[a * dim + b]) * q[b * dim + n];
  }
}

/* The modulus is the largest of all principal directions; that of the largest stretch comes first. */
static void CheckModulus(const MpmMaterialNumbers *m, PetscInt dim, const Tensors *F, const Tensors *turn)
{
  PetscReal along[3][STATES];

  for (PetscInt n = 0; n < dim; n++) Moduli(m, dim, n, F, turn, along[n]);
  for (PetscInt p = 0; p < STATES; p++) {
    PetscReal f[MPM_MOST_STRETCH], expected = along[0][p], found;

    for (PetscInt n = 1; n < dim; n++) expected = PetscMax(expected, along[n][p]);
    for (PetscInt c = 0; c < MPM_MOST_STRETCH; c++) f[c] = F->f[c][p];
    found = MpmMaterialModulus(m, dim, f);
    CHECK(fabs(found - expected) <= 1e-11 * (1 + fabs(expected)), "%s, dim %d: modulus %g, not %g", m->law->name,
          (int)dim, found, expected);
  }
}

/* At F = I: Hooke's law, no energy, and half the work of small strains, to which the next order is of their size. */
static void CheckSmall(const MpmMaterialNumbers *m, PetscInt dim, const Tensors *dF)
{
  const PetscReal small = 1e-6;
  const PetscBool solid = m->law->solid;
  const PetscReal mu = solid ? m->mu : 0, lambda = solid ? m->lambda : 1;
  static Tensors  identity, moved, dtau;
  PetscReal       psi[STATES], zero[STATES];

  for (PetscInt c = 0; c < 9; c++)
    for (PetscInt p = 0; p < STATES; p++) identity.f[c][p] = c % (dim + 1) == 0;
  FillInternal(m->law, dim, 0, &identity, NULL);
  Along(&identity, dF, small, &moved);
  Tangent(m, dim, &identity, dF, &dtau);
  Energy(m, dim, &moved, psi);
  Energy(m, dim, &identity, zero);
  for (PetscInt p = 0; p < STATES; p++) {
    PetscReal trace = 0, work = 0;

    for (PetscInt a = 0; a < dim; a++) trace += dF->f[a * dim + a][p];
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = 0; b < dim; b++) {
        const PetscReal e    = (dF->f[a * dim + b][p] + dF->f[b * dim + a][p]) / 2;
        const PetscReal hook = 2 * mu * e + (a == b ? lambda * trace : 0);

        work += hook * e / 2;
        CHECK_NEAR(dtau.f[Symmetric(dim, a, b)][p], hook, 1e-14);
      }
    CHECK_NEAR(psi[p] / (small * small), work, 1e-4);
    CHECK_NEAR(zero[p], 0, 0);
  }
}

/* The nominal stress with dim 1 in the units of the header; NAN of laws that have no formula here. */
static PetscReal Nominal(const MpmMaterialNumbers *m, PetscReal F)
{
  if (m->law == &MpmLawNeo) return m->mu * (F - 1 / F) + m->lambda * log(F) / F;
  if (m->law == &MpmLawSvk) return F * (F * F - 1) / 2;
  if (m->law == &MpmLawTait) return -(pow(F, -m->exponent) - 1) / m->exponent;
  if (m->law == &MpmLawGas) return -1 / F;
  if (m->law == &MpmLawPolytropic) return -pow(F, -m->exponent) / m->exponent;
  return m->law == &MpmLawLinear ? F - 1 : NAN;
}

static void CheckLine(const MpmMaterialNumbers *m)
{
  for (PetscReal F = 0.4; F < 3; F += 0.1) {
    const PetscReal *at[1] = {&F};
    PetscReal        tau, *to[1] = {&tau};

    MpmMaterialStress(m, 1, 1, at, to);
    if (!isnan(Nominal(m, F))) CHECK_NEAR(tau, F * Nominal(m, F), 1e-14 * (1 + fabs(tau)));
  }
}

static PetscReal Viscous(const MpmMaterialNumbers *m, PetscReal unit, PetscInt dim, const Tensors *L, Tensors *tau)
{
  const PetscReal *l[MPM_MOST_STRETCH], *f[MPM_MOST_STRETCH], *of[3] = {NULL, NULL, NULL};
  static Tensors   identity;
  PetscReal       *t[9];

  memset(tau, 0, sizeof *tau);
  for (PetscInt c = 0; c < 9; c++)
    for (PetscInt p = 0; p < STATES; p++) identity.f[c][p] = c % (dim + 1) == 0;
  Pointers(L, l);
  Pointers(&identity, f);
  for (PetscInt c = 0; c < 9; c++) t[c] = tau->f[c];
  return MpmMaterialViscous(m, unit, dim, STATES, l, f, of, t);
}

/*
   A rate r in simple shear has the stress min(viscosity r, yield + K r^m). On random rates, of which some are beyond the yield stress and
   some are not, the tangent is that of differences, and tau : D is not below 0.
*/
static void CheckHerschelBulkley(PetscInt dim, PetscReal index)
{
  MpmMaterialNumbers m    = MpmMaterialOfRatio(&MpmLawHerschelBulkley, 0, 7);
  const PetscReal    unit = 1.7, step = 1e-4, yield = 0.3, K = 0.2;
  static Tensors     L, dL, tau, dtau, expected, at, moved;
  const PetscReal   *l[MPM_MOST_STRETCH], *dl[MPM_MOST_STRETCH];
  PetscReal         *t[9];
  PetscInt           branch[2] = {0, 0};

  m.plastic[MPM_YIELD]       = yield;
  m.plastic[MPM_CONSISTENCY] = K;
  m.plastic[MPM_FLOW_INDEX]  = index;
  m.viscosity                = 0.7;
  memset(&L, 0, sizeof L);
  for (PetscInt p = 0; p < STATES; p++) L.f[1][p] = 0.02 * p;
  (void)Viscous(&m, unit, dim, &L, &tau);
  for (PetscInt p = 0; p < STATES && dim > 1; p++)
    CHECK_NEAR(tau.f[1][p], PetscMin(unit * 0.7 * L.f[1][p], yield + unit * K * pow(L.f[1][p], index)), 1e-14);
  for (PetscInt c = 0; c < 9; c++)
    for (PetscInt p = 0; p < STATES; p++) {
      L.f[c][p]  = (p % 2 ? 2 : 0.2) * Random();
      dL.f[c][p] = Random();
    }
  memset(&expected, 0, sizeof expected);
  for (int k = 0; k < 3; k++)
    for (int side = 0; side < 2; side++) {
      Along(&L, &dL, (side ? -1 : 1) * (k + 1) * step, &moved);
      (void)Viscous(&m, unit, dim, &moved, &at);
      Along(&expected, &at, (side ? -1 : 1) * differences[k] / step, &expected);
    }
  Pointers(&L, l);
  Pointers(&dL, dl);
  for (PetscInt c = 0; c < 9; c++) t[c] = dtau.f[c];
  m.law->viscous_tangent(&m, unit, dim, STATES, l, dl, t);
  (void)Viscous(&m, unit, dim, &L, &tau);
  for (PetscInt p = 0; p < STATES; p++) {
    PetscReal power = 0, square = 0, trace = 0, rate;

    for (PetscInt a = 0; a < dim; a++) trace += L.f[a * dim + a][p];
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = 0; b < dim; b++) {
        const PetscReal D = (L.f[a * dim + b][p] + L.f[b * dim + a][p]) / 2;

        power += tau.f[Symmetric(dim, a, b)][p] * D;
        square += PetscSqr(D - (a == b ? trace / 3 : 0));
      }
    rate = sqrt(2 * (square + (3 - dim) * trace * trace / 9));
    CHECK_NEAR(power, PetscMin(unit * 0.7 * rate, yield + unit * K * pow(rate, index)) * rate, 1e-13);
    if (fabs(unit * 0.7 * rate - yield - unit * K * pow(rate, index)) < 0.01)
      continue; /* a stencil may meet the kink */
    branch[unit * 0.7 * rate > yield + unit * K * pow(rate, index)]++;
    for (PetscInt c = 0; c < dim * (dim + 1) / 2; c++)
      CHECK_NEAR(dtau.f[c][p], expected.f[c][p], 1e-9 * (1 + fabs(dtau.f[c][p])));
  }
  CHECK(branch[0] > 20 && branch[1] > 20, "dim %d: %d below the yield stress, %d beyond", (int)dim, (int)branch[0],
        (int)branch[1]);
}

/* The artificial viscosity is 0 where the volume grows, and its viscosity is the slope of its pressure where it shrinks. */
static void CheckArtificial(PetscInt dim)
{
  MpmMaterialNumbers m = MpmMaterialOfRatio(&MpmLawTait, 0, 7);
  static Tensors     L, tau;

  m.artificial[0] = 0.2;
  m.artificial[1] = 2;
  for (int side = -1; side <= 1; side += 2) {
    PetscReal found;

    for (PetscInt c = 0; c < 9; c++)
      for (PetscInt p = 0; p < STATES; p++) L.f[c][p] = c == 0 ? side * 0.01 * p : c % (dim + 1) ? Random() : 0;
    found = Viscous(&m, 1.5, dim, &L, &tau);
    for (PetscInt c = 0; c < dim * (dim + 1) / 2; c++)
      for (PetscInt p = 0; p < STATES; p++) {
        const PetscReal D = 0.01 * p, q = 1.5 * (0.2 * D / sqrt(1.5) + 2 * D * D);
        const PetscBool diagonal = c == 0 || (dim == 2 && c == 2) || (dim == 3 && (c == 3 || c == 5));

        CHECK_NEAR(tau.f[c][p], side < 0 && diagonal ? -q : 0, 1e-14);
      }
    CHECK_NEAR(found, side < 0 ? 0.2 / sqrt(1.5) + 4 * 0.01 * (STATES - 1) : 0, 1e-14);
  }
}

/* A material of each law in the list, and one with other numbers. */
static PetscErrorCode Test(int argc, char **argv)
{
  static Tensors F, dF, turn;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (const MpmLaw *const *law = MpmLaws; *law; law++) {
    for (int other = 0; other < 2; other++) {
      const MpmMaterialNumbers m = MpmMaterialOfRatio(*law, other ? 0 : 1.5, other ? 1 : (*law)->exponent);

      for (PetscInt dim = 1; dim <= 3; dim++) {
        Draw(dim, &F, &dF, &turn);
        FillInternal(*law, dim, 0.1, &F, &dF);
        CheckDerivatives(&m, dim, &F, &dF);
        CheckTurned(&m, dim, &F, &turn);
        CheckModulus(&m, dim, &F, &turn);
        if ((*law)->solid || *law == &MpmLawTait) CheckSmall(&m, dim, &dF);
      }
      if (!(*law)->plastic) CheckLine(&m);
    }
  }
  for (PetscInt dim = 1; dim <= 3; dim++) {
    CheckHerschelBulkley(dim, 0.5);
    CheckHerschelBulkley(dim, 1.6);
    CheckArtificial(dim);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
