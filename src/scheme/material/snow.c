/*
   snow: the corotated solid with principal stretches s between 1 - compression_limit and 1 + stretch_limit. What is
   beyond flows, and changes the volume for good: q = J_p is the volume of the plastic part, and moduli grow with exp(h
   (1 - q)), where h is the hardening.

     psi = exp(h (1 - q)) (mu sum (s_a - 1)^2 + lambda / 2 (J - 1)^2),   J the product of s
     T_a = exp(h (1 - q)) (2 mu (s_a - 1) s_a + lambda (J - 1) J)

   Out of the line or plane there is no strain, which is within the bounds.

   The law may gain energy. It flows by stretches, not by stresses: with lambda > 0 an axis at its bound of extension
   may be under pressure, because another one is compressed. And moduli that grow store - h dq psi, more than the work
   of the flow where h q psi is more than the stress. With lambda = 0 and h q compression_limit below 1/2 no flow gains.

   A. Stomakhin, C. Schroeder, L. Chai, J. Teran, A. Selle, A material point method for snow simulation (2013),
   equations 1 and 2 and section 7; the usual numbers are those of its table 2.
*/
#include "scheme/material/plastic.h"
#include <math.h>

static PetscReal Least(const MpmMaterialNumbers *m)
{
  return log1p(-m->plastic[MPM_COMPRESSION_LIMIT]);
}

static PetscReal Most(const MpmMaterialNumbers *m)
{
  return log1p(m->plastic[MPM_STRETCH_LIMIT]);
}

static PetscReal Yield(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q)
{
  const PetscReal lo = PetscMin(e[0], PetscMin(e[1], e[2])), hi = PetscMax(e[0], PetscMax(e[1], e[2]));

  (void)q;
  return PetscMax(hi - Most(m), Least(m) - lo);
}

static void Back(const MpmMaterialNumbers *m, PetscReal e[3], PetscReal *q, PetscReal slope[4][4])
{
  const PetscReal lo = Least(m), hi = Most(m), start = *q;
  PetscReal       flow = 0;
  PetscBool       stays[3];

  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal within = PetscMin(hi, PetscMax(lo, e[a]));

    stays[a] = e[a] > lo + MPM_ON_SURFACE && e[a] < hi - MPM_ON_SURFACE ? PETSC_TRUE : PETSC_FALSE;
    flow += e[a] - within;
    e[a] = within;
  }
  *q = start * exp(flow);
  for (PetscInt b = 0; b < 4 && slope; b++) {
    for (PetscInt a = 0; a < 3; a++) slope[a][b] = a == b && stays[a] ? 1 : 0;
    slope[3][b] = b == 3 ? *q / start : stays[b] ? 0 : *q;
  }
}

static void Stress(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q, PetscReal T[3],
                   PetscReal slope[3][4])
{
  const PetscReal grown = exp(m->plastic[MPM_HARDENING] * (1 - q)), J = exp(e[0] + e[1] + e[2]);

  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal s = e[a] == 0 ? 1 : exp(e[a]);

    T[a] = grown * (2 * m->mu * expm1(e[a]) * s + m->lambda * expm1(e[0] + e[1] + e[2]) * J);
    for (PetscInt b = 0; b < 4 && slope; b++)
      slope[a][b] = b == 3 ? -m->plastic[MPM_HARDENING] * T[a]
                           : grown * (m->lambda * (2 * J - 1) * J + (a == b ? 2 * m->mu * (2 * s - 1) * s : 0));
  }
}

static PetscReal Energy(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q)
{
  PetscReal squares = 0;

  for (PetscInt a = 0; a < 3; a++) squares += PetscSqr(expm1(e[a]));
  return exp(m->plastic[MPM_HARDENING] * (1 - q)) *
         (m->mu * squares + m->lambda / 2 * PetscSqr(expm1(e[0] + e[1] + e[2])));
}

static const MpmPlastic plastic = {
    .internal = "plastic_volume", .start = 1, .yield = Yield, .back = Back, .stress = Stress, .energy = Energy};

const MpmLaw MpmLawSnow = {.name = "snow",
                           MPM_PLASTIC_FUNCTIONS,
                           .plastic = &plastic,
                           .number  = {[MPM_HARDENING]         = {PETSC_TRUE, 10, 0, 100},
                                       [MPM_COMPRESSION_LIMIT] = {PETSC_TRUE, 2.5e-2, 1e-9, 0.9},
                                       [MPM_STRETCH_LIMIT]     = {PETSC_TRUE, 7.5e-3, 1e-9, 10}}};
