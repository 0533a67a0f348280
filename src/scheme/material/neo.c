/*
   neo: compressible neo-Hookean.

     psi = mu / 2 (tr B - dim) - mu ln J + lambda / 2 (ln J)^2
     tau = mu (B - I) + lambda ln J I                            dtau = mu dB + lambda dJ / J I

   J. Bonet and R. D. Wood, Nonlinear Continuum Mechanics for Finite Element Analysis, 2nd ed. (2008), section 6.4.3.
*/
#include "scheme/material/laws.h"
#include "scheme/material/logarithm.h"
#include <math.h>

static void Logarithm(const MpmMaterialNumbers *m, PetscInt n, PetscReal g[])
{
  (void)m;
  LogarithmOfOnePlus(n, g);
}

static void Pressure(const MpmMaterialNumbers *m, PetscInt n, PetscReal g[])
{
  LogarithmOfOnePlus(n, g);
  for (PetscInt p = 0; p < n; p++) g[p] *= m->lambda;
}

INLINE void NeoStress(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal pressure,
                      PetscReal tau[])
{
  PetscReal B[6];

  LeftProduct(dim, F, B);
  Shifted(dim, m->mu, B, pressure - m->mu, tau);
}

INLINE void NeoTangent(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal unused,
                       const PetscReal dF[], PetscReal dtau[])
{
  PetscReal dB[6];

  (void)unused;
  LeftDifferential(dim, F, dF, dB);
  Shifted(dim, m->mu, dB, m->lambda * VolumeDifferential(dim, F, dF) / Volume(dim, F), dtau);
}

/* tr B - dim = 2 tr H + H : H with H = F - I. */
INLINE PetscReal NeoEnergy(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal logarithm)
{
  PetscReal trace = 0, squares = 0;

  EACH (c, dim * dim) {
    const PetscReal h = F[c] - (c % (dim + 1) == 0 ? 1 : 0);

    if (c % (dim + 1) == 0) trace += h;
    squares += h * h;
  }
  return m->mu * (trace + squares / 2 - logarithm) + m->lambda / 2 * logarithm * logarithm;
}

static void Stress(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                   PetscReal *const tau[])
{
  EACH_DIM(StressLoop, NeoStress, Pressure, m, n, F, tau)
}

static void Tangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                    const PetscReal *const dF[], PetscReal *const dtau[])
{
  EACH_DIM(TangentLoop, NeoTangent, NULL, m, n, F, dF, dtau)
}

static void Energy(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[], PetscReal psi[])
{
  EACH_DIM(EnergyLoop, NeoEnergy, Logarithm, m, n, F, psi)
}

static PetscReal Modulus(const MpmMaterialNumbers *m, PetscInt dim, PetscReal largest, PetscReal trace, PetscReal J)
{
  (void)dim;
  (void)trace;
  return m->mu * (largest + 1) + m->lambda * (1 - log(J));
}

/* c_abcd is isotropic, with lambda / J and (mu - lambda ln J) / J. */
static void Stretched(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal *lambda, PetscReal *mu,
                      PetscReal q[])
{
  PetscReal J = 1;

  for (PetscInt a = 0; a < dim; a++) {
    J *= F[a];
    q[a] = 1;
  }
  *lambda = m->lambda;
  *mu     = m->mu - m->lambda * log(J);
}

const MpmLaw MpmLawNeo = {.name      = "neo",
                          .solid     = PETSC_TRUE,
                          .stress    = Stress,
                          .tangent   = Tangent,
                          .energy    = Energy,
                          .modulus   = Modulus,
                          .stretched = Stretched};
