/*
   svk: Saint Venant and Kirchhoff, linear in Green's strain E = (F^T F - I) / 2.

     psi = lambda / 2 (tr E)^2 + mu E : E
     tau = F S F^T,  S = lambda tr E I + 2 mu E      dtau = dF S F^T + F S dF^T + F dS F^T

   It softens under compression: with dim 1 it has no stiffness at F = 1 / sqrt(3).
*/
#include "scheme/material/laws.h"

/* E = (H + H^T + H^T H) / 2 with H = F - I. */
INLINE void Green(PetscInt dim, const PetscReal F[], PetscReal E[])
{
  PetscReal H[9];

  EACH (c, dim * dim) H[c] = F[c] - (c % (dim + 1) == 0 ? 1 : 0);
  FOR_PAIRS (dim, a, b) {
    PetscReal sum = H[a * dim + b] + H[b * dim + a];

    EACH (c, dim) sum += H[c * dim + a] * H[c * dim + b];
    E[Pair(dim, a, b)] = sum / 2;
  }
}

/* out_ab += sum_cd X_ac S_cd Y_bd, and with Y unlike X also with the two exchanged. */
INLINE void AddPushed(PetscInt dim, const PetscReal X[], const PetscReal S[], const PetscReal Y[], PetscReal out[])
{
  PetscReal XS[9];

  EACH (a, dim)
    EACH (d, dim) {
      XS[a * dim + d] = 0;
      EACH (c, dim) XS[a * dim + d] += X[a * dim + c] * Of(dim, S, c, d);
    }
  FOR_PAIRS (dim, a, b)
    EACH (d, dim)
      out[Pair(dim, a, b)] += XS[a * dim + d] * Y[b * dim + d] + (X == Y ? 0 : XS[b * dim + d] * Y[a * dim + d]);
}

INLINE void SvkStress(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal unused, PetscReal tau[])
{
  PetscReal E[6], S[6];

  (void)unused;
  Green(dim, F, E);
  Shifted(dim, 2 * m->mu, E, m->lambda * Trace(dim, E), S);
  EACH (c, dim * (dim + 1) / 2) tau[c] = 0;
  AddPushed(dim, F, S, F, tau);
}

INLINE void SvkTangent(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal unused,
                       const PetscReal dF[], PetscReal dtau[])
{
  PetscReal E[6], dE[6], S[6], dS[6];

  (void)unused;
  Green(dim, F, E);
  FOR_PAIRS (dim, a, b) {
    dE[Pair(dim, a, b)] = 0;
    EACH (c, dim) dE[Pair(dim, a, b)] += (dF[c * dim + a] * F[c * dim + b] + F[c * dim + a] * dF[c * dim + b]) / 2;
  }
  Shifted(dim, 2 * m->mu, E, m->lambda * Trace(dim, E), S);
  Shifted(dim, 2 * m->mu, dE, m->lambda * Trace(dim, dE), dS);
  EACH (c, dim * (dim + 1) / 2) dtau[c] = 0;
  AddPushed(dim, F, dS, F, dtau);
  AddPushed(dim, dF, S, F, dtau);
}

INLINE PetscReal SvkEnergy(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal unused)
{
  PetscReal E[6];

  (void)unused;
  Green(dim, F, E);
  return m->lambda / 2 * Trace(dim, E) * Trace(dim, E) + m->mu * Contract(dim, E, E);
}

LAW_OF_PARTICLES(SvkStress, NULL, SvkTangent, NULL, SvkEnergy, NULL)

/* With s the square of a principal stretch this is s times a function that rises with s, so the largest s counts. */
static PetscReal Modulus(const MpmMaterialNumbers *m, PetscInt dim, PetscReal largest, PetscReal trace, PetscReal J)
{
  (void)J;
  return largest * (m->lambda * (trace - dim) / 2 + m->mu * (largest - 1) + (m->lambda + 2 * m->mu) * largest);
}

/* c_abcd is that at rest times F_a F_b F_c F_d / J. */
static void Stretched(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal *lambda, PetscReal *mu,
                      PetscReal q[])
{
  for (PetscInt a = 0; a < dim; a++) q[a] = F[a] * F[a];
  *lambda = m->lambda;
  *mu     = m->mu;
}

const MpmLaw MpmLawSvk = {.name = "svk", .solid = PETSC_TRUE, LAW_FUNCTIONS, .stretched = Stretched};
