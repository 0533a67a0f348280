/*
   sand: Hencky's elastic solid that bears no tension, and shear up to a part of the pressure (Drucker and Prager 1952):

     d + k tr <= 0,   d = norm(dev e), tr = tr e,   k = a (3 lambda + 2 mu) / (2 mu),   a = sqrt(2/3) 2 sin f / (3 - sin f)

   with the angle of friction f. A trial value beyond goes back along the radius at the same volume, e' = tr (1/3 - k n)
   with n = dev e / d; with tr >= 0 it goes to the tip of the cone, e' = 0. The volume that sand gains there is q: it
   takes it back before it resists pressure, so that in all of this e stands for e + q / 3, and q' is 0 unless at the
   tip, tr.

   G. Klar, T. Gast, A. Pradhana, C. Fu, C. Schroeder, C. Jiang, J. Teran, Drucker-Prager elastoplasticity for sand
   animation (2016), section 6; the volume is that of A. Pradhana Tampubolon et al., Multi-species simulation of porous
   sand and water mixtures (2017), section 4.3.4. With dim 1 and 2 the strain out of the line or plane flows, too.
*/
#include "scheme/material/plastic.h"
#include <math.h>

/* What the cone depends on: d, tr and n; returns d + k tr. */
static PetscReal Cone(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q, PetscReal n[3], PetscReal *d,
                      PetscReal *tr, PetscReal *k)
{
  const PetscReal sine = sin(m->plastic[MPM_FRICTION_ANGLE] * M_PI / 180);

  *k  = sqrt(2. / 3) * 2 * sine / (3 - sine) * (3 * m->lambda + 2 * m->mu) / (2 * m->mu);
  *tr = e[0] + e[1] + e[2] + q;
  *d  = MpmDeviator(e, n);
  for (PetscInt a = 0; a < 3; a++) n[a] = *d > 0 ? n[a] / *d : 0;
  return *d + *k * *tr;
}

static PetscReal Yield(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q)
{
  PetscReal       n[3], d, tr, k;
  const PetscReal cone = Cone(m, e, q, n, &d, &tr, &k);

  if (tr >= 0) return sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
  return q > 0 ? PetscMax(q, cone) : cone;
}

static void Back(const MpmMaterialNumbers *m, PetscReal e[3], PetscReal *q, PetscReal slope[4][4])
{
  PetscReal       n[3], d, tr, k;
  const PetscReal cone = Cone(m, e, *q, n, &d, &tr, &k);
  const PetscBool tip = tr >= 0 ? PETSC_TRUE : PETSC_FALSE, slides = cone > -MPM_ON_SURFACE ? PETSC_TRUE : PETSC_FALSE;

  for (PetscInt a = 0; a < 3; a++) {
    const PetscReal along = tip ? 0 : slides ? 1. / 3 - k * n[a] : 1. / 3; /* de'/dtr */

    e[a] = along * tr + (tip || slides ? 0 : d * n[a]);
    for (PetscInt b = 0; b < 4 && slope; b++) {
      const PetscReal turn = tip || b == 3 ? 0 : (a == b ? 1 : 0) - 1. / 3;

      slope[a][b] = along + (slides && turn != 0 ? -k * tr / d * (turn - n[a] * n[b]) : turn);
    }
  }
  for (PetscInt b = 0; b < 4 && slope; b++) slope[3][b] = tip ? 1 : 0;
  *q = tip ? tr : 0;
}

static const MpmPlastic plastic = {.internal = "volume_gain",
                                   .outside  = PETSC_TRUE,
                                   .yield    = Yield,
                                   .back     = Back,
                                   .stress   = MpmHenckyStress,
                                   .energy   = MpmHenckyEnergy};

const MpmLaw MpmLawSand = {.name = "sand",
                           MPM_PLASTIC_FUNCTIONS,
                           .plastic = &plastic,
                           .number  = {[MPM_FRICTION_ANGLE] = {PETSC_TRUE, 35, 0.01, 89}}};
