/*
   The part of a stress that depends on the velocity's gradient: that of the law, and the artificial viscosity, which
   spreads a shock over some cells and gives off the energy that a shock does:

     q = rho (C1 c h abs(div v) + C2 (h div v)^2)   where div v < 0, a pressure

   with the speed of sound c and density rho of now. As a Kirchhoff stress, J times the true one, rho is that at rest.

   J. von Neumann and R. D. Richtmyer, A method for the numerical calculation of hydrodynamic shocks (1950), the
   quadratic term; R. Landshoff (1955), the linear one. Uintah has C1 = 0.2 and C2 = 2 (artificial_viscosity_coeff1 and
   2), MPM3D 0.06 and 1.5.
*/
#include "scheme/material/laws.h"
#include <math.h>

static PetscReal OfParticle(const PetscReal property[], PetscInt p)
{
  return property ? property[p] : 1;
}

/* The viscosity C1 rho c + C2 rho abs(tr D) of particle p, whose tr D is below 0; *slope: that of small changes. */
static PetscReal Artificial(const MpmMaterialNumbers *m, PetscReal unit, PetscInt dim, PetscInt p, PetscReal trace,
                            const PetscReal *const F[], const PetscReal *const of[3], PetscReal *slope)
{
  const PetscReal density = OfParticle(of[0], p) / OfParticle(of[1], p);
  PetscReal       f[MPM_MOST_STRETCH], modulus = 0;

  for (PetscInt c = 0; c < MpmMaterialComponents(m, dim); c++) f[c] = F[c][p];
  if (m->artificial[0] > 0) modulus = PetscMax(MpmMaterialModulus(m, dim, f), 0) * OfParticle(of[2], p) / unit;
  *slope = m->artificial[0] * sqrt(modulus * density) - 2 * m->artificial[1] * density * trace;
  return *slope + m->artificial[1] * density * trace;
}

PetscReal MpmMaterialViscous(const MpmMaterialNumbers *m, PetscReal unit, PetscInt dim, PetscInt n,
                             const PetscReal *const L[], const PetscReal *const F[], const PetscReal *const of[3],
                             PetscReal *const tau[])
{
  PetscReal largest = 0;

  if (m->law->viscous) m->law->viscous(m, unit, dim, n, L, tau);
  for (PetscInt p = 0; p < n && (m->artificial[0] > 0 || m->artificial[1] > 0); p++) {
    PetscReal trace = 0, viscosity, slope;

    for (PetscInt a = 0; a < dim; a++) trace += L[a * dim + a][p];
    if (!(trace < 0)) continue;
    viscosity = Artificial(m, unit, dim, p, trace, F, of, &slope);
    largest   = PetscMax(largest, slope);
    for (PetscInt a = 0; a < dim; a++) tau[Pair(dim, a, a)][p] += unit * viscosity * trace;
  }
  return largest;
}
