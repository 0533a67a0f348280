/*
   Flow along principal axes. B = F F^T = U diag(s^2) U^T, e = ln s; a law gives the principal stresses T(e, q), and e',
   q' after the flow. Then

     tau = U diag(T) U^T        F' = G F,  G = U diag(r) U^T,  r = exp(e' - e)

   Their differentials, with A = U^T (dF F^-1) U, so that de_a = A_aa and the axes turn by
   W_ab = (A_ab s_b^2 + A_ba s_a^2) / (s_b^2 - s_a^2):

     (U^T dtau U)_ab = W_ab (T_b - T_a)         (U^T dG U)_ab = W_ab (r_b - r_a)       dF' = (dG + G dF F^-1) F

   for a other than b, and dT_a and dr_a for a = b. Where two stretches are alike, the quotient of differences has the
   limit of an isotropic function. J. C. Simo, Numerical analysis and simulation of plasticity (1998), section 47;
   Jacobi's method of the eigenvalues of B - I keeps the digits of small strains.
*/
#include "scheme/material/plastic.h"
#include "scheme/material/laws.h"
#include "scheme/material/logarithm.h"
#include <math.h>

#define NONE 1e-140 /* instead of 0, so that nothing is divided by it */
#define SWEEPS 4    /* of Jacobi's method, whose error is squared in each sweep, and cubed at last */
#define ALIKE 1e-5  /* a difference of strains below which the limit takes the place of the quotient */

const char *const MpmBranchNames[] = {"own", "loading", "unloading", NULL};

const char *const MpmPlasticNames[] = {
    "yield",         "hardening",      "saturation",  "saturation_rate", "compression_limit",
    "stretch_limit", "friction_angle", "consistency", "flow_index",      NULL};

/* Principal strains and axes of a block of particles; column c of U is an axis. */
typedef struct {
  PetscReal e[3][MPM_LAW_BLOCK], U[9][MPM_LAW_BLOCK];
} Principal;

/*
   Turns the plane of i and j such that s_ij is 0, for each particle of a block. A loop for each plane: a processor then
   takes up roots and divisions of several particles before the first are done.
*/
INLINE void Rotate(const PetscInt dim, const PetscInt i, const PetscInt j, PetscInt count,
                   PetscReal s[6][MPM_LAW_BLOCK], PetscReal U[9][MPM_LAW_BLOCK])
{
  const PetscInt ii = Pair(dim, i, i), jj = Pair(dim, j, j), ij = Pair(dim, i, j), r = 3 - i - j;
  const PetscInt ri = r < i ? Pair(dim, r, i) : Pair(dim, i, r), rj = r < j ? Pair(dim, r, j) : Pair(dim, j, r);

  EACH_PARTICLE
  {
    const PetscReal gap = s[jj][p] - s[ii][p], off = 2 * s[ij][p], far = fabs(gap) + sqrt(gap * gap + off * off) + NONE;
    const PetscReal inverse = 1 / sqrt(far * far + off * off), cosine = far * inverse;
    const PetscReal sine = gap < 0 ? -off * inverse : off * inverse, change = (gap < 0 ? -off : off) / far * off / 2;

    s[ii][p] -= change;
    s[jj][p] += change;
    s[ij][p] = 0;
    if (dim == 3) {
      const PetscReal at_i = s[ri][p], at_j = s[rj][p];

      s[ri][p] = cosine * at_i - sine * at_j;
      s[rj][p] = sine * at_i + cosine * at_j;
    }
    EACH (a, dim) {
      const PetscReal at_i = U[a * dim + i][p], at_j = U[a * dim + j][p];

      U[a * dim + i][p] = cosine * at_i - sine * at_j;
      U[a * dim + j][p] = sine * at_i + cosine * at_j;
    }
  }
}

/* The eigenvalues of B - I, in e, and their axes. */
INLINE void Axes(const PetscInt dim, PetscInt count, const PetscReal *const F[], Principal *at)
{
  PetscReal s[6][MPM_LAW_BLOCK];

  EACH_PARTICLE
  {
    PetscReal H[9];

    EACH (c, TENSOR(dim)) {
      at->U[c][p] = c % (dim + 1) == 0 ? 1 : 0;
      H[c]        = F[c][p] - (c % (dim + 1) == 0 ? 1 : 0);
    }
    FOR_PAIRS (dim, a, b) {
      PetscReal sum = H[a * dim + b] + H[b * dim + a];

      EACH (c, dim) sum += H[a * dim + c] * H[b * dim + c];
      s[Pair(dim, a, b)][p] = sum;
    }
  }
  for (PetscInt sweep = 0; dim > 1 && sweep < (dim == 2 ? 1 : SWEEPS); sweep++) {
    Rotate(dim, 0, 1, count, s, at->U);
    if (dim == 2) continue;
    Rotate(dim, 0, 2, count, s, at->U);
    Rotate(dim, 1, 2, count, s, at->U);
  }
  EACH (a, dim)
    for (PetscInt p = 0; p < count; p++) at->e[a][p] = s[Pair(dim, a, a)][p];
}

/*
   The principal strains and axes of a block. Outside of the line or plane there is an internal variable, or no strain.
*/
INLINE void PrincipalOf(const PetscInt dim, const MpmLaw *law, PetscInt count, const PetscReal *const F[],
                        Principal *at)
{
  const PetscReal *outside = law->plastic->outside && dim < 3 ? F[MpmLawComponents(law, dim) - 1] : NULL;

  Axes(dim, count, F, at);
  EACH (a, dim) {
    LogarithmOfOnePlus(count, at->e[a]);
    for (PetscInt p = 0; p < count; p++) at->e[a][p] /= 2;
  }
  for (PetscInt a = dim; a < 3; a++)
    for (PetscInt p = 0; p < count; p++) at->e[a][p] = outside ? outside[p] : 0;
}

/* U diag(v) U^T of each particle of a block, as a symmetric tensor. */
INLINE void Compose(const PetscInt dim, PetscInt count, const Principal *at, PetscReal v[3][MPM_LAW_BLOCK],
                    PetscReal *const to[])
{
  EACH_PARTICLE
  {
    FOR_PAIRS (dim, a, b) {
      PetscReal sum = 0;

      EACH (c, dim) sum += at->U[a * dim + c][p] * v[c][p] * at->U[b * dim + c][p];
      to[Pair(dim, a, b)][p] = sum;
    }
  }
}

/* The arrays from a particle on. */
static void From(PetscInt n, const PetscReal *const arrays[], PetscInt begin, const PetscReal *from[])
{
  for (PetscInt c = 0; c < n; c++) from[c] = arrays[c] + begin;
}

INLINE void StressOf(const PetscInt dim, const MpmMaterialNumbers *m, PetscInt n, const PetscReal *const F[],
                     PetscReal *const tau[])
{
  const MpmLaw *law = m->law;

  FOR_BLOCKS
  {
    const PetscReal *from[MPM_MOST_STRETCH];
    PetscReal       *to[6], T[3][MPM_LAW_BLOCK];
    Principal        at;

    From(MpmLawComponents(law, dim), F, begin, from);
    PrincipalOf(dim, law, count, from, &at);
    EACH (c, SYMMETRIC(dim)) to[c] = tau[c] + begin;
    for (PetscInt p = 0; p < count; p++) {
      PetscReal e[3] = {at.e[0][p], at.e[1][p], at.e[2][p]}, t[3];

      law->plastic->stress(m, e, law->plastic->internal ? from[TENSOR(dim)][p] : 0, t, NULL);
      for (PetscInt a = 0; a < 3; a++) T[a][p] = t[a];
    }
    Compose(dim, count, &at, T, to);
  }
}

void MpmPlasticStress(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                      PetscReal *const tau[])
{
  EACH_DIM(StressOf, m, n, F, tau)
}

/* Takes a block's strains back to the yield surface: r is then exp(e' - e). Returns whether a particle has flowed. */
static PetscBool Flow(const MpmMaterialNumbers *m, const PetscInt dim, PetscInt count, const Principal *at,
                      PetscReal *const F[], PetscReal r[3][MPM_LAW_BLOCK], PetscBool flows[])
{
  const MpmPlastic *law     = m->law->plastic;
  PetscReal        *outside = law->outside && dim < 3 ? F[MpmLawComponents(m->law, dim) - 1] : NULL;
  PetscBool         any     = PETSC_FALSE;

  for (PetscInt p = 0; p < count; p++) {
    PetscReal e[3] = {at->e[0][p], at->e[1][p], at->e[2][p]}, q = law->internal ? F[TENSOR(dim)][p] : 0;

    for (PetscInt a = 0; a < dim; a++) r[a][p] = 1;
    flows[p] = law->yield(m, e, q) > 0 ? PETSC_TRUE : PETSC_FALSE;
    if (!flows[p]) continue;
    any = PETSC_TRUE;
    law->back(m, e, &q, NULL);
    if (isnan(q)) flows[p] = PETSC_FALSE;
    for (PetscInt a = 0; a < dim; a++) r[a][p] = exp(e[a] - at->e[a][p]);
    if (law->internal) F[TENSOR(dim)][p] = q;
    if (outside) outside[p] = e[2];
  }
  return any;
}

INLINE void ReturnOf(const PetscInt dim, const MpmMaterialNumbers *m, PetscInt n, PetscReal *const F[])
{
  FOR_BLOCKS
  {
    const PetscReal *from[MPM_MOST_STRETCH];
    PetscReal       *at_F[MPM_MOST_STRETCH], r[3][MPM_LAW_BLOCK], G[6][MPM_LAW_BLOCK], *to[6];
    PetscBool        flows[MPM_LAW_BLOCK];
    Principal        at;

    From(MpmLawComponents(m->law, dim), (const PetscReal *const *)F, begin, from);
    for (PetscInt c = 0; c < MpmLawComponents(m->law, dim); c++) at_F[c] = F[c] + begin;
    PrincipalOf(dim, m->law, count, from, &at);
    if (!Flow(m, dim, count, &at, at_F, r, flows)) continue;
    EACH (c, SYMMETRIC(dim)) to[c] = G[c];
    Compose(dim, count, &at, r, to);
    EACH_PARTICLE
    {
      PetscReal g[6], f[9];

      EACH (c, SYMMETRIC(dim)) g[c] = G[c][p];
      LOAD(f, at_F)
      EACH (a, dim)
        EACH (b, dim) {
          PetscReal sum = 0;

          EACH (c, dim) sum += Of(dim, g, a, c) * f[c * dim + b];
          at_F[a * dim + b][p] = flows[p] ? sum : f[a * dim + b];
        }
    }
  }
}

void MpmPlasticReturn(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, PetscReal *const F[])
{
  EACH_DIM(ReturnOf, m, n, F)
}

void MpmPlasticEnergy(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                      PetscReal psi[])
{
  FOR_BLOCKS
  {
    const PetscReal *from[MPM_MOST_STRETCH];
    Principal        at;

    From(MpmLawComponents(m->law, dim), F, begin, from);
    EACH_DIM(PrincipalOf, m->law, count, from, &at)
    for (PetscInt p = 0; p < count; p++)
      psi[begin + p] = m->law->plastic->energy(m, (PetscReal[]){at.e[0][p], at.e[1][p], at.e[2][p]},
                                               m->law->plastic->internal ? from[TENSOR(dim)][p] : 0);
  }
}

/* ---- one particle and its differential ---- */

/* e and q, the squares of the stretches, the axes; A = U^T (dF F^-1) U, and de and dq. */
typedef struct {
  PetscReal e[3], q, square[3], U[9], A[9], de[4];
} Point;

/* U^T X U, or U X U^T */
static void Turn(PetscInt dim, const PetscReal U[], const PetscReal X[], PetscBool back, PetscReal out[])
{
  for (PetscInt ab = 0; ab < dim * dim; ab++) {
    out[ab] = 0;
    for (PetscInt cd = 0; cd < dim * dim; cd++) {
      const PetscInt a = ab / dim, b = ab % dim, c = cd / dim, d = cd % dim;

      out[ab] += back ? U[a * dim + c] * X[cd] * U[b * dim + d] : U[c * dim + a] * X[cd] * U[d * dim + b];
    }
  }
}

/* The principal values and axes of particle p, and without dF nothing else. */
static void PointOf(const MpmLaw *law, PetscInt dim, PetscInt p, const PetscReal *const F[],
                    const PetscReal *const dF[], Point *point)
{
  const PetscInt   last = MpmLawComponents(law, dim) - 1;
  const PetscReal *from[MPM_MOST_STRETCH];
  PetscReal        f[9], L[9];
  Principal        at;

  From(last + 1, F, p, from);
  EACH_DIM(PrincipalOf, law, 1, from, &at)
  *point = (Point){.q = law->plastic->internal ? F[TENSOR(dim)][p] : 0};
  for (PetscInt a = 0; a < 3; a++) {
    point->e[a]      = at.e[a][0];
    point->square[a] = exp(2 * at.e[a][0]);
  }
  for (PetscInt c = 0; c < TENSOR(dim); c++) {
    point->U[c] = at.U[c][0];
    f[c]        = F[c][p];
  }
  if (!dF) return;
  for (PetscInt ab = 0; ab < TENSOR(dim); ab++) {
    L[ab] = 0;
    for (PetscInt c = 0; c < dim; c++)
      L[ab] += dF[ab / dim * dim + c][p] * Cofactor(dim, f, ab % dim, c) / Volume(dim, f);
  }
  Turn(dim, point->U, L, PETSC_FALSE, point->A);
  for (PetscInt a = 0; a < dim; a++) point->de[a] = point->A[a * dim + a];
  for (PetscInt a = dim; a < 3; a++) point->de[a] = law->plastic->outside ? dF[last][p] : 0;
  point->de[3] = law->plastic->internal ? dF[TENSOR(dim)][p] : 0;
}

static PetscReal Dot(const PetscReal slope[4], const PetscReal de[4])
{
  return slope[0] * de[0] + slope[1] * de[1] + slope[2] * de[2] + slope[3] * de[3];
}

/*
   W_ab (v_b - v_a) of values v along the axes, for a other than b. apart: the derivative of v_b - v_a where e_b - e_a
   grows, where both are alike.
*/
static PetscReal Shear(const Point *point, PetscInt dim, PetscInt a, PetscInt b, PetscReal difference, PetscReal apart)
{
  const PetscReal sheared = point->A[a * dim + b] * point->square[b] + point->A[b * dim + a] * point->square[a];

  if (fabs(point->e[b] - point->e[a]) < ALIKE) return sheared * apart / (point->square[a] + point->square[b]);
  return sheared * difference / (point->square[b] - point->square[a]);
}

/* Half the sum of the slopes of v_b - v_a by e_b and by - e_a: the same where both strains are alike. */
static PetscReal Apart(PetscReal (*slope)[4], PetscInt a, PetscInt b)
{
  return (slope[b][b] - slope[b][a] - slope[a][b] + slope[a][a]) / 2;
}

void MpmPlasticTangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                       const PetscReal *const dF[], PetscReal *const dtau[])
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal T[3], slope[3][4], X[9], out[9];
    Point     point;

    PointOf(m->law, dim, p, F, dF, &point);
    m->law->plastic->stress(m, point.e, point.q, T, slope);
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = 0; b < dim; b++)
        X[a * dim + b] = a == b ? Dot(slope[a], point.de) : Shear(&point, dim, a, b, T[b] - T[a], Apart(slope, a, b));
    Turn(dim, point.U, X, PETSC_TRUE, out);
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = a; b < dim; b++) dtau[Pair(dim, a, b)][p] = out[a * dim + b];
  }
}

/* The differential at a particle that flows. */
static void ReturnAlong(const MpmMaterialNumbers *m, PetscInt dim, PetscInt p, const Point *point,
                        const PetscReal *const F[], PetscReal *const after[])
{
  PetscReal slope[4][4], e[3] = {point->e[0], point->e[1], point->e[2]}, q = point->q, r[3], X[9], out[9];

  m->law->plastic->back(m, e, &q, slope);
  for (PetscInt a = 0; a < 3; a++) r[a] = exp(e[a] - point->e[a]);
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++)
      X[a * dim + b] = r[a] * point->A[a * dim + b] +
                       (a == b ? r[a] * (Dot(slope[a], point->de) - point->de[a])
                               : Shear(point, dim, a, b, r[b] - r[a], (r[a] + r[b]) / 2 * (Apart(slope, a, b) - 1)));
  Turn(dim, point->U, X, PETSC_TRUE, out);
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++) {
      PetscReal sum = 0;

      for (PetscInt c = 0; c < dim; c++) sum += out[a * dim + c] * F[c * dim + b][p];
      after[a * dim + b][p] = sum;
    }
  if (m->law->plastic->outside && dim < 3) after[MpmLawComponents(m->law, dim) - 1][p] = Dot(slope[2], point->de);
  if (m->law->plastic->internal) after[TENSOR(dim)][p] = Dot(slope[3], point->de);
}

PetscInt MpmPlasticReturnTangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, MpmBranch branch,
                                 const PetscReal *const F[], const PetscReal *const dF[], PetscReal *const after[])
{
  PetscInt on_surface = 0;

  for (PetscInt p = 0; p < n; p++) {
    PetscReal yield;
    PetscBool flows;
    Point     point;

    PointOf(m->law, dim, p, F, dF, &point);
    yield = m->law->plastic->yield(m, point.e, point.q);
    flows = yield > 0 ? PETSC_TRUE : PETSC_FALSE;
    if (fabs(yield) <= MPM_ON_SURFACE) {
      on_surface++;
      flows = branch == MPM_BRANCH_LOADING ? PETSC_TRUE : PETSC_FALSE; /* not rounding, which differs between ranks */
    }
    if (flows)
      ReturnAlong(m, dim, p, &point, F, after);
    else
      for (PetscInt c = 0; c < MpmLawComponents(m->law, dim); c++) after[c][p] = dF[c][p];
  }
  return on_surface;
}

/* The largest of the axes: without more flow, since that is the faster wave. */
PetscReal MpmPlasticModulus(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[])
{
  const PetscReal *from[MPM_MOST_STRETCH];
  PetscReal        T[3], slope[3][4], largest = -INFINITY;
  Point            point;

  for (PetscInt c = 0; c < MpmLawComponents(m->law, dim); c++) from[c] = &F[c];
  PointOf(m->law, dim, 0, from, NULL, &point);
  m->law->plastic->stress(m, point.e, point.q, T, slope);
  for (PetscInt a = 0; a < dim; a++) largest = PetscMax(largest, slope[a][a] - T[a]);
  return largest;
}

void MpmHenckyStress(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q, PetscReal T[3],
                     PetscReal slope[3][4])
{
  (void)q;
  for (PetscInt a = 0; a < 3; a++) {
    T[a] = m->lambda * (e[0] + e[1] + e[2]) + 2 * m->mu * e[a];
    for (PetscInt b = 0; b < 4 && slope; b++) slope[a][b] = b == 3 ? 0 : m->lambda + (a == b ? 2 * m->mu : 0);
  }
}

PetscReal MpmHenckyEnergy(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q)
{
  (void)q;
  return m->mu * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + m->lambda / 2 * PetscSqr(e[0] + e[1] + e[2]);
}
