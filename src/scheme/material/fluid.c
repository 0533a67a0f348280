/*
   tait, gas and polytropic: the stress is a pressure, which a power of the volume gives. gas has n = 1.

     tau = T I,   T = -J p = (b J - J^(1 - n)) / n,   b = 1 for tait and 0 for the others
     psi = integral of -p from 1 to J = b (J - 1) / n - (J^(1 - n) - 1) / (n (1 - n))
*/
#include "scheme/material/laws.h"
#include <math.h>

static PetscReal Exponent(const MpmMaterialNumbers *m)
{
  return m->law == &MpmLawGas ? 1 : m->exponent;
}

static PetscReal Base(const MpmMaterialNumbers *m)
{
  return m->law == &MpmLawTait ? 1 : 0;
}

static void Pressure(const MpmMaterialNumbers *m, PetscInt n, PetscReal g[])
{
  const PetscReal e = Exponent(m), b = Base(m);

  for (PetscInt p = 0; p < n; p++) g[p] = e == 1 ? b * (1 + g[p]) - 1 : (b * (1 + g[p]) - pow(1 + g[p], 1 - e)) / e;
}

/* dT / dJ */
static void Slope(const MpmMaterialNumbers *m, PetscInt n, PetscReal g[])
{
  const PetscReal e = Exponent(m), b = Base(m);

  for (PetscInt p = 0; p < n; p++) g[p] = e == 1 ? b : (b - (1 - e) * pow(1 + g[p], -e)) / e;
}

static void Work(const MpmMaterialNumbers *m, PetscInt n, PetscReal g[])
{
  const PetscReal e = Exponent(m), b = Base(m);

  for (PetscInt p = 0; p < n; p++) {
    const PetscReal logarithm = log1p(g[p]);

    g[p] = (b * g[p] - (e == 1 ? logarithm : expm1((1 - e) * logarithm) / (1 - e))) / e;
  }
}

INLINE void FluidStress(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal pressure,
                        PetscReal tau[])
{
  (void)m;
  (void)F;
  FOR_PAIRS (dim, a, b) tau[Pair(dim, a, b)] = a == b ? pressure : 0;
}

INLINE void FluidTangent(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal slope,
                         const PetscReal dF[], PetscReal dtau[])
{
  FluidStress(m, dim, F, slope * VolumeDifferential(dim, F, dF), dtau);
}

INLINE PetscReal FluidEnergy(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[], PetscReal work)
{
  (void)m;
  (void)dim;
  (void)F;
  return work;
}

LAW_OF_PARTICLES(FluidStress, Pressure, FluidTangent, Slope, FluidEnergy, Work)

/* J dT/dJ - T = -J^2 dp/dJ, whatever the direction. */
static PetscReal Modulus(const MpmMaterialNumbers *m, PetscInt dim, PetscReal largest, PetscReal trace, PetscReal J)
{
  (void)dim;
  (void)largest;
  (void)trace;
  return pow(J, 1 - Exponent(m));
}

const MpmLaw MpmLawTait = {.name = "tait", .exponent = 7, LAW_FUNCTIONS};

const MpmLaw MpmLawGas = {.name = "gas", LAW_FUNCTIONS};

const MpmLaw MpmLawPolytropic = {.name = "polytropic", .exponent = 1.4, LAW_FUNCTIONS};
