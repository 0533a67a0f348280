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

INLINE PetscReal NeoEnergy(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal logarithm)
{
  return m->mu * (LeftTraceChange(dim, F) / 2 - logarithm) + m->lambda / 2 * logarithm * logarithm;
}

LAW_OF_PARTICLES(NeoStress, Pressure, NeoTangent, NULL, NeoEnergy, Logarithm)

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

const MpmLaw MpmLawNeo = {.name = "neo", .solid = PETSC_TRUE, LAW_FUNCTIONS, .stretched = Stretched};
