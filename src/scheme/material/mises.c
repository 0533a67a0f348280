/*
   mises: metal. Hencky's elastic solid, tau = 2 mu e + lambda tr e, whose stress deviator is at most the yield stress:

     sqrt(3/2) norm(dev tau) <= Y(q),   Y = yield + hardening q + saturation (1 - exp(- saturation_rate q))

   q is the equivalent plastic strain. A trial value beyond goes back along the radius n = dev e / norm(dev e) by g with

     norm(dev tau) - 2 mu g = sqrt(2/3) Y(q + sqrt(2/3) g)

   which is convex in g, so that Newton's method comes to its root from below.

   J. C. Simo and T. J. R. Hughes, Computational Inelasticity (1998), boxes 3.1 and 3.2; in logarithmic strains
   Simo 1992. The hardening of saturation is Voce's (1948).
*/
#include "scheme/material/plastic.h"
#include <math.h>

#define NEWTON_STEPS 60
#define SMALL 1e-12 /* a change of g so small beside it is rounding */

/* Y(q), or its slope. */
static PetscReal YieldStress(const MpmMaterialNumbers *m, PetscReal q, PetscReal *slope)
{
  const PetscReal *k   = m->plastic,
                  rest = k[MPM_SATURATION] == 0 ? 0 : k[MPM_SATURATION] * exp(-k[MPM_SATURATION_RATE] * q);

  *slope = k[MPM_HARDENING] + k[MPM_SATURATION_RATE] * rest;
  return k[MPM_YIELD] + k[MPM_HARDENING] * q + k[MPM_SATURATION] - rest;
}

static PetscReal Yield(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q)
{
  PetscReal dev[3], slope;

  return 2 * m->mu * MpmDeviator(e, dev) - sqrt(2. / 3) * YieldStress(m, q, &slope);
}

static void Back(const MpmMaterialNumbers *m, PetscReal e[3], PetscReal *q, PetscReal slope[4][4])
{
  const PetscReal root = sqrt(2. / 3), start = *q;
  PetscReal       n[3], norm = MpmDeviator(e, n), g = 0, change = 1, hardening, by[4];

  for (PetscInt i = 0; i < NEWTON_STEPS && change > 1e-16 * norm; i++) {
    const PetscReal Y = YieldStress(m, start + root * g, &hardening);

    change = (2 * m->mu * (norm - g) - root * Y) / (2 * m->mu + 2 * hardening / 3);
    g += change;
  }
  *q = change <= 1e-16 * norm || fabs(change) <= SMALL * g ? start + root * g : NAN;
  for (PetscInt a = 0; a < 3; a++) {
    n[a] /= norm;
    e[a] -= g * n[a];
  }
  if (!slope) return;
  (void)YieldStress(m, *q, &hardening);
  for (PetscInt b = 0; b < 4; b++) /* dg */
    by[b] = (b < 3 ? 2 * m->mu * n[b] : -root * hardening) / (2 * m->mu + 2 * hardening / 3);
  for (PetscInt b = 0; b < 4; b++) {
    for (PetscInt a = 0; a < 3; a++)
      slope[a][b] =
          (a == b ? 1 : 0) - n[a] * by[b] - (b == 3 ? 0 : g / norm * ((a == b ? 1 : 0) - 1. / 3 - n[a] * n[b]));
    slope[3][b] = (b == 3 ? 1 : 0) + root * by[b];
  }
}

static const MpmPlastic plastic = {.internal = "plastic_strain",
                                   .outside  = PETSC_TRUE,
                                   .yield    = Yield,
                                   .back     = Back,
                                   .stress   = MpmHenckyStress,
                                   .energy   = MpmHenckyEnergy};

const MpmLaw MpmLawMises = {.name = "mises",
                            MPM_PLASTIC_FUNCTIONS,
                            .plastic = &plastic,
                            .number  = {[MPM_YIELD]           = {PETSC_TRUE, 0.005, 1e-9, 1e3},
                                        [MPM_HARDENING]       = {PETSC_TRUE, 0, 0, 1e3},
                                        [MPM_SATURATION]      = {PETSC_TRUE, 0, 0, 1e3},
                                        [MPM_SATURATION_RATE] = {PETSC_TRUE, 10, 0, 1e6}}};
