/*
   tait, gas and polytropic: the stress is a pressure, which a power of the volume gives. gas has n = 1.

     tau = T I,   T = -J p = (b J - J^(1 - n)) / n,   b = 0 for gas and polytropic, and 1 for the others
     psi = integral of -p from 1 to J = b (J - 1) / n - (J^(1 - n) - 1) / (n (1 - n))

   herschel_bulkley: the pressure of tait, and the viscous stress

     2 eta(r) dev D,   D = sym L,   r = sqrt(2 dev D : dev D),   eta = min(viscosity, (yield + K r^m) / r),   K the consistency

   so that its dissipation eta r^2 is never negative. The largest viscosity takes the place of the rigid state below the
   yield stress. Where D is within a line or plane, dev D has a part out of it.

   W. H. Herschel and R. Bulkley (1926); with a largest viscosity, as OpenFOAM's model of this name has it (nu0),
   I. A. Frigaard and C. Nouar, On the usage of viscosity regularisation methods (2005).
*/
#include "scheme/material/laws.h"
#include <math.h>

static PetscReal Exponent(const MpmMaterialNumbers *m)
{
  return m->law == &MpmLawGas ? 1 : m->exponent;
}

static PetscReal Base(const MpmMaterialNumbers *m)
{
  return m->law == &MpmLawTait || m->law == &MpmLawHerschelBulkley ? 1 : 0;
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

/* dev D of particle p, and out of the line or plane -outside; returns the rate r. */
static PetscReal Rate(PetscInt dim, PetscInt p, const PetscReal *const L[], PetscReal dev[6], PetscReal *outside)
{
  PetscReal trace = 0, square;

  for (PetscInt a = 0; a < dim; a++) trace += L[a * dim + a][p];
  FOR_PAIRS (dim, a, b) dev[Pair(dim, a, b)] = (L[a * dim + b][p] + L[b * dim + a][p]) / 2 - (a == b ? trace / 3 : 0);
  *outside = trace / 3;
  square   = Contract(dim, dev, dev) + (3 - dim) * *outside * *outside;
  return sqrt(2 * square);
}

/* eta, and its slope by the rate: 0 at the largest viscosity. */
static PetscReal Viscosity(const MpmMaterialNumbers *m, PetscReal unit, PetscReal rate, PetscReal *slope)
{
  const PetscReal yield = m->plastic[MPM_YIELD] / unit, index = m->plastic[MPM_FLOW_INDEX];
  const PetscReal more = m->plastic[MPM_CONSISTENCY] * pow(rate, index);

  *slope = 0;
  if (!(yield + more < m->viscosity * rate)) return m->viscosity;
  *slope = ((index - 1) * more - yield) / (rate * rate);
  return (yield + more) / rate;
}

static void Shear(const MpmMaterialNumbers *m, PetscReal unit, PetscInt dim, PetscInt n, const PetscReal *const L[],
                  PetscReal *const tau[])
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal       dev[6], outside, slope;
    const PetscReal eta = Viscosity(m, unit, Rate(dim, p, L, dev, &outside), &slope);

    for (PetscInt c = 0; c < SYMMETRIC(dim); c++) tau[c][p] += unit * 2 * eta * dev[c];
  }
}

/* d(2 eta dev D) = 2 eta dev dD + 2 eta' dr dev D, r dr = 2 dev D : dev dD */
static void ShearAlong(const MpmMaterialNumbers *m, PetscReal unit, PetscInt dim, PetscInt n,
                       const PetscReal *const L[], const PetscReal *const dL[], PetscReal *const dtau[])
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal       dev[6], along[6], outside[2], slope;
    const PetscReal rate = Rate(dim, p, L, dev, &outside[0]), eta = Viscosity(m, unit, rate, &slope);
    PetscReal       change;

    (void)Rate(dim, p, dL, along, &outside[1]);
    change = Contract(dim, dev, along) + (3 - dim) * outside[0] * outside[1];
    change = slope == 0 ? 0 : slope * 2 * change / rate;
    for (PetscInt c = 0; c < SYMMETRIC(dim); c++) dtau[c][p] = unit * 2 * (eta * along[c] + change * dev[c]);
  }
}

const MpmLaw MpmLawTait = {.name = "tait", .exponent = 7, LAW_FUNCTIONS};

const MpmLaw MpmLawGas = {.name = "gas", LAW_FUNCTIONS};

const MpmLaw MpmLawPolytropic = {.name = "polytropic", .exponent = 1.4, LAW_FUNCTIONS};

const MpmLaw MpmLawHerschelBulkley = {.name            = "herschel_bulkley",
                                      .exponent        = 7,
                                      .viscous         = Shear,
                                      .viscous_tangent = ShearAlong,
                                      .number          = {[MPM_YIELD]       = {PETSC_TRUE, 0, 0, 1e3},
                                                          [MPM_CONSISTENCY] = {PETSC_TRUE, 0, 0, 1e6},
                                                          [MPM_FLOW_INDEX]  = {PETSC_TRUE, 1, 0.01, 10}},
                                      LAW_FUNCTIONS};
