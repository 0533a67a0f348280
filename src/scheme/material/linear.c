/*
   linear: linear in the stretch V = sqrt(F F^T), so that with dim 1 the nominal stress is F - 1.

     psi = mu tr (V - I)^2 + lambda / 2 (tr V - dim)^2        tau = 2 mu (B - V) + lambda (tr V - dim) V

   It turns with the material, as a material must, and C : (F - I) does not. A. Stomakhin, R. Howes, C. Schroeder,
   J. Teran, Energetically consistent invertible elasticity (2012), equation 1.

   V with dim 2 is (B + J I) / tr V with (tr V)^2 = tr B + 2 J. With dim 3 let i1 and i2 be the invariants of V, and II
   the second one of B. Then i2 = (i1^2 - tr B) / 2, and i1 is the largest root of

     i2^2 - II - 2 J i1 = 0

   where Newton's method comes down to it from sqrt(3 tr B). Cayley and Hamilton give V = (i1 B + J I) (B + i2 I)^-1.
*/
#include "scheme/material/laws.h"
#include <math.h>

#define NEWTON_STEPS 16 /* enough where the largest stretch is 1000 times the least */

/* What V with dim 3 comes from; inverse is (B + i2 I)^-1. */
typedef struct {
  PetscReal J, i1, i2, trace, inverse[6];
} Polar;

/* The inverse of a symmetric tensor with dim 3. */
INLINE void Inverse(const PetscReal s[], PetscReal inverse[])
{
  const PetscReal c[6] = {s[3] * s[5] - s[4] * s[4], s[2] * s[4] - s[1] * s[5], s[1] * s[4] - s[2] * s[3],
                          s[0] * s[5] - s[2] * s[2], s[1] * s[2] - s[0] * s[4], s[0] * s[3] - s[1] * s[1]};
  const PetscReal det  = s[0] * c[0] + s[1] * c[1] + s[2] * c[2];

  EACH (k, 6) inverse[k] = c[k] / det;
}

/* The symmetric product X Y of tensors that commute. */
INLINE void Commuting(PetscInt dim, const PetscReal X[], const PetscReal Y[], PetscReal out[])
{
  FOR_PAIRS (dim, a, b) {
    out[Pair(dim, a, b)] = 0;
    EACH (c, dim) out[Pair(dim, a, b)] += Of(dim, X, a, c) * Of(dim, Y, c, b);
  }
}

INLINE void StretchOf(PetscInt dim, const PetscReal F[], const PetscReal B[], Polar *polar, PetscReal V[])
{
  PetscReal shifted[6];

  polar->J     = Volume(dim, F);
  polar->trace = Trace(dim, B);
  if (dim == 1) {
    V[0] = F[0];
  } else if (dim == 2) {
    polar->i1 = sqrt(polar->trace + 2 * polar->J);
    Shifted(dim, 1 / polar->i1, B, polar->J / polar->i1, V);
  } else {
    const PetscReal second = (polar->trace * polar->trace - Contract(dim, B, B)) / 2;
    PetscReal       i1     = sqrt(3 * polar->trace);

    EACH (k, NEWTON_STEPS) {
      const PetscReal i2 = (i1 * i1 - polar->trace) / 2;

      i1 -= (i2 * i2 - second - 2 * polar->J * i1) / (2 * (i1 * i2 - polar->J));
    }
    polar->i1 = i1;
    polar->i2 = (i1 * i1 - polar->trace) / 2;
    Shifted(dim, 1, B, polar->i2, shifted);
    Inverse(shifted, polar->inverse);
    Shifted(dim, i1, B, polar->J, shifted);
    Commuting(dim, shifted, polar->inverse, V);
  }
}

/* With dim 3: from V (B + i2 I) = i1 B + J I and the equation of i1. */
INLINE void StretchDifferential(PetscInt dim, const PetscReal F[], const PetscReal dF[], const PetscReal B[],
                                const PetscReal dB[], const Polar *polar, const PetscReal V[], PetscReal dV[])
{
  const PetscReal dJ = VolumeDifferential(dim, F, dF), dtrace = Trace(dim, dB);

  if (dim == 1) {
    dV[0] = dF[0];
  } else if (dim == 2) {
    const PetscReal di1 = (dtrace + 2 * dJ) / (2 * polar->i1);

    FOR_PAIRS (dim, a, b)
      dV[Pair(dim, a, b)] = (dB[Pair(dim, a, b)] + (a == b ? dJ : 0) - di1 * V[Pair(dim, a, b)]) / polar->i1;
  } else {
    const PetscReal dsecond = polar->trace * dtrace - Contract(dim, B, dB);
    const PetscReal di1 =
        (polar->i2 * dtrace + dsecond + 2 * polar->i1 * dJ) / (2 * (polar->i1 * polar->i2 - polar->J));
    const PetscReal di2 = polar->i1 * di1 - dtrace / 2;
    PetscReal       right[9];

    EACH (a, dim)
      EACH (b, dim) {
        right[a * dim + b] =
            di1 * Of(dim, B, a, b) + polar->i1 * Of(dim, dB, a, b) + (a == b ? dJ : 0) - di2 * Of(dim, V, a, b);
        EACH (c, dim) right[a * dim + b] -= Of(dim, V, a, c) * Of(dim, dB, c, b);
      }
    FOR_PAIRS (dim, a, b) {
      dV[Pair(dim, a, b)] = 0;
      EACH (c, dim) dV[Pair(dim, a, b)] += right[a * dim + c] * Of(dim, polar->inverse, c, b);
    }
  }
}

INLINE void LinearStress(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal unused,
                         PetscReal tau[])
{
  PetscReal B[6], V[6], pressure;
  Polar     polar;

  (void)unused;
  LeftProduct(dim, F, B);
  StretchOf(dim, F, B, &polar, V);
  pressure = m->lambda * (Trace(dim, V) - dim);
  FOR_PAIRS (dim, a, b) {
    const PetscInt c = Pair(dim, a, b);

    tau[c] = 2 * m->mu * (B[c] - V[c]) + pressure * V[c];
  }
}

INLINE void LinearTangent(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal unused,
                          const PetscReal dF[], PetscReal dtau[])
{
  PetscReal B[6], dB[6], V[6], dV[6], pressure, dpressure;
  Polar     polar;

  (void)unused;
  LeftProduct(dim, F, B);
  LeftDifferential(dim, F, dF, dB);
  StretchOf(dim, F, B, &polar, V);
  StretchDifferential(dim, F, dF, B, dB, &polar, V, dV);
  pressure  = m->lambda * (Trace(dim, V) - dim);
  dpressure = m->lambda * Trace(dim, dV);
  FOR_PAIRS (dim, a, b) {
    const PetscInt c = Pair(dim, a, b);

    dtau[c] = 2 * m->mu * (dB[c] - dV[c]) + pressure * dV[c] + dpressure * V[c];
  }
}

INLINE PetscReal LinearEnergy(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal unused)
{
  PetscReal B[6], V[6];
  Polar     polar;

  (void)unused;
  LeftProduct(dim, F, B);
  StretchOf(dim, F, B, &polar, V);
  Shifted(dim, 1, V, -1, V);
  return m->mu * Contract(dim, V, V) + m->lambda / 2 * Trace(dim, V) * Trace(dim, V);
}

LAW_OF_PARTICLES(LinearStress, NULL, LinearTangent, NULL, LinearEnergy, NULL)

static PetscReal Modulus(const MpmMaterialNumbers *m, PetscInt dim, PetscReal largest, PetscReal trace, PetscReal J)
{
  (void)dim;
  (void)trace;
  (void)J;
  return largest * (m->lambda + 2 * m->mu);
}

const MpmLaw MpmLawLinear = {.name = "linear", .solid = PETSC_TRUE, LAW_FUNCTIONS};
