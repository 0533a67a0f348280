/* The list of the laws, and what they have in common. */
#include "scheme/material/laws.h"
#include "scheme/material/plastic.h"
#include <math.h>

const MpmLaw *const MpmLaws[] = {&MpmLawLinear, &MpmLawNeo,  &MpmLawSvk,  &MpmLawTait, &MpmLawGas, &MpmLawPolytropic,
                                 &MpmLawMises,  &MpmLawSnow, &MpmLawSand, &MpmLawClay, NULL};

void MpmMaterialStress(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, const PetscReal *const F[],
                       PetscReal *const tau[])
{
  material->law->stress(material, dim, n, F, tau);
}

void MpmMaterialTangent(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, const PetscReal *const F[],
                        const PetscReal *const dF[], PetscReal *const dtau[])
{
  material->law->tangent(material, dim, n, F, dF, dtau);
}

void MpmMaterialEnergy(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, const PetscReal *const F[],
                       PetscReal psi[])
{
  material->law->energy(material, dim, n, F, psi);
}

/* The largest eigenvalue of a symmetric tensor. With dim 3: O. K. Smith, Eigenvalues of a symmetric 3 x 3 matrix (1961). */
INLINE PetscReal LargestEigenvalue(PetscInt dim, const PetscReal s[])
{
  const PetscReal mean = Trace(dim, s) / dim;
  PetscReal       off[6], size, cosine;

  if (dim == 1) return s[0];
  Shifted(dim, 1, s, -mean, off);
  if (dim == 2) return mean + sqrt(off[0] * off[0] + off[1] * off[1]);
  size = sqrt(Contract(dim, off, off) / 6);
  if (size == 0) return mean;
  Shifted(dim, 1 / size, off, 0, off);
  cosine = off[0] * (off[3] * off[5] - off[4] * off[4]) - off[1] * (off[1] * off[5] - off[4] * off[2]) +
           off[2] * (off[1] * off[4] - off[3] * off[2]);
  return mean + 2 * size * cos(acos(PetscMin(1, PetscMax(-1, cosine / 2))) / 3);
}

INLINE PetscReal ModulusOf(const PetscInt dim, const MpmMaterialNumbers *material, const PetscReal F[])
{
  PetscReal B[6];

  LeftProduct(dim, F, B);
  return material->law->modulus(material, dim, LargestEigenvalue(dim, B), Trace(dim, B), Volume(dim, F));
}

PetscReal MpmMaterialModulus(const MpmMaterialNumbers *material, PetscInt dim, const PetscReal F[])
{
  if (material->law->plastic) return MpmPlasticModulus(material, dim, F);
  return dim == 1 ? ModulusOf(1, material, F) : dim == 2 ? ModulusOf(2, material, F) : ModulusOf(3, material, F);
}
