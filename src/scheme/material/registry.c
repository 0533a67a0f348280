/* The list of the laws, and what they have in common. */
#include "scheme/material/laws.h"
#include "scheme/material/plastic.h"
#include "scheme/material/several.h"
#include <math.h>

const MpmLaw *const MpmLaws[] = {&MpmLawLinear,          &MpmLawNeo,   &MpmLawSvk,  &MpmLawTait, &MpmLawGas,
                                 &MpmLawPolytropic,      &MpmLawMises, &MpmLawSnow, &MpmLawSand, &MpmLawClay,
                                 &MpmLawHerschelBulkley, NULL};

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

void MpmMaterialReturn(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, PetscReal *const F[])
{
  if (material->several)
    MpmSeveralReturn(material, dim, n, F);
  else
    MpmPlasticReturn(material, dim, n, F);
}

PetscInt MpmMaterialReturnTangent(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, MpmBranch branch,
                                  const PetscReal *const F[], const PetscReal *const dF[], PetscReal *const after[])
{
  return material->several ? MpmSeveralReturnTangent(material, dim, n, branch, F, dF, after)
                           : MpmPlasticReturnTangent(material, dim, n, branch, F, dF, after);
}

PetscInt MpmMaterialComponents(const MpmMaterialNumbers *material, PetscInt dim)
{
  const MpmMaterials *all = material->several;

  return all ? dim * dim + all->ninternal + (all->outside && dim < 3) + 1 : MpmLawComponents(material->law, dim);
}

const char *MpmMaterialInternal(const MpmMaterialNumbers *material, PetscInt dim, PetscInt i, PetscReal *start)
{
  const MpmMaterials *all = material->several;
  const MpmLaw       *law = !all ? material->law : i < all->ninternal ? all->internal[i] : NULL;
  const PetscBool     own = law && law->plastic->internal && (all || i == 0) ? PETSC_TRUE : PETSC_FALSE;

  *start = own ? law->plastic->start : 0;
  if (all && i == MpmMaterialComponents(material, dim) - dim * dim - 1) return "material";
  return own ? law->plastic->internal : "e_out";
}

PetscBool MpmMaterialFlows(const MpmMaterialNumbers *material)
{
  const MpmMaterials *all = material->several;

  for (PetscInt i = 0; all && i < all->n; i++)
    if (all->of[i].law->plastic) return PETSC_TRUE;
  return material->law->plastic ? PETSC_TRUE : PETSC_FALSE;
}

/*
   The largest eigenvalue of a symmetric tensor. With dim 3: O. K. Smith, Eigenvalues of a symmetric 3 x 3 matrix
   (1961).
*/
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
  if (material->several) return MpmSeveralModulus(material, dim, F);
  if (material->law->plastic) return MpmPlasticModulus(material, dim, F);
  return dim == 1 ? ModulusOf(1, material, F) : dim == 2 ? ModulusOf(2, material, F) : ModulusOf(3, material, F);
}
