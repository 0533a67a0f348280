/* The words of options, and the texts of values that a scene keeps as something else. */
#include "scene/field_words.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "scene/request.h"

/* ---- words ---- */

const char *MpmFormulationWord(PetscInt i)
{
  return MpmFormulations[i] ? MpmFormulations[i]->name : NULL;
}

const char *MpmBasisWord(PetscInt i)
{
  return MpmBases[i] ? MpmBases[i]->name : NULL;
}

const char *MpmInitialWord(PetscInt i)
{
  return MpmInitialNames[i];
}

const char *MpmPolarisationWord(PetscInt i)
{
  return MpmPolarisationNames[i];
}

const char *MpmVerdictWord(PetscInt i)
{
  return MpmVerdictNames[i];
}

const char *MpmGrowthWord(PetscInt i)
{
  return MpmGrowthKindNames[i];
}

const char *MpmTransferWord(PetscInt i)
{
  return MpmTransfers[i] ? MpmTransfers[i]->name : NULL;
}

const char *MpmRkOnWord(PetscInt i)
{
  return MpmRkOnNames[i];
}

const char *MpmLayoutWord(PetscInt i)
{
  return i == 0 ? "uniform" : NULL;
}

const char *MpmBalanceWord(PetscInt i)
{
  return MpmBalanceNames[i];
}

const char *MpmMoveWord(PetscInt i)
{
  return MpmMoveNames[i];
}

const char *MpmShapeWord(PetscInt i)
{
  return MpmShapeNames[i];
}

const char *MpmTangentWord(PetscInt i)
{
  return MpmTangentNames[i];
}

const char *MpmKinematicsWord(PetscInt i)
{
  return MpmKinematicsNames[i];
}

const char *MpmMaterialWord(PetscInt i)
{
  const MpmLaw *law = i < MPM_MATERIAL_KINDS ? NULL : MpmLaws[i - MPM_MATERIAL_KINDS + 1];

  if (i < MPM_MATERIAL_KINDS) return MpmMaterialNames[i];
  return law ? law->name : NULL;
}

const char *MpmEndWord(PetscInt i)
{
  return MpmEndNames[i];
}

const char *MpmGradientWord(PetscInt i)
{
  return MpmGradientNames[i];
}

const char *MpmFilterTimeWord(PetscInt i)
{
  return MpmFilterTimeNames[i];
}

const char *MpmNeighbourhoodWord(PetscInt i)
{
  return MpmNeighbourhoodNames[i];
}

const char *MpmSplineEndsWord(PetscInt i)
{
  return MpmSplineEndNames[i];
}

const char *MpmProbeWord(PetscInt i)
{
  return MpmProbeNames[i];
}

const char *MpmAxisWord(PetscInt i)
{
  return MpmAxisNames[i];
}

/* ---- values that are kept as something else ---- */

const char *MpmMoveOf(const MpmScene *scene)
{
  return MpmMoveNames[scene->scheme.space.move];
}

const char *MpmKinematicsOf(const MpmScene *scene)
{
  return MpmKinematicsNames[scene->scheme.space.finite ? 1 : 0];
}

const char *MpmShapeOf(const MpmScene *scene)
{
  return scene->layout.shape ? scene->layout.shape : MpmShapeNames[0];
}

const char *MpmFormulationOf(const MpmScene *scene)
{
  return scene->scheme.formulation->name;
}

const char *MpmSchemeHashOf(const MpmScene *scene)
{
  return scene->scheme_hash;
}

const char *MpmParametersOf(const MpmScene *scene)
{
  return scene->parameters;
}

const char *MpmBasisOf(const MpmScene *scene)
{
  return scene->scheme.basis->name;
}

const char *MpmTransferOf(const MpmScene *scene)
{
  return scene->scheme.transfer->name;
}

const char *MpmRkOf(const MpmScene *scene)
{
  return MpmRkWord(scene->scheme.numbers.rk);
}

const char *MpmRkOnOf(const MpmScene *scene)
{
  const MpmScheme *scheme = &scene->scheme;

  return MpmRkOnNames[MpmRkIsOnNodes(&scheme->numbers, scheme->transfer) ? MPM_RK_NODES : MPM_RK_PARTICLES];
}

const char *MpmGradientOf(const MpmScene *scene)
{
  return MpmGradientNames[scene->scheme.space.gradient];
}

const char *MpmFilterTimeOf(const MpmScene *scene)
{
  return MpmFilterTimeNames[scene->scheme.space.filter];
}

const char *MpmSplineEndsOf(const MpmScene *scene)
{
  return MpmSplineEndNames[scene->scheme.basis->spline_ends];
}

const char *MpmLayoutOf(const MpmScene *scene)
{
  return scene->layout.name;
}

const char *MpmBalanceOf(const MpmScene *scene)
{
  return MpmBalanceNames[scene->layout.balance];
}

const char *MpmMaterialOf(const MpmScene *scene)
{
  return scene->law == &MpmLawLinear ? MpmMaterialNames[scene->layout.material.kind] : scene->law->name;
}

const char *MpmBoundaryOf(const MpmScene *scene)
{
  return scene->boundary;
}

const char *MpmPolarisationOf(const MpmScene *scene)
{
  return MpmPolarisationNames[scene->polarisation];
}

const char *MpmInitialOf(const MpmScene *scene)
{
  return MpmInitialNames[scene->initial];
}
