/* When a record shows a field. JSON leaves out what is the default. */
#include "scene/field_shown.h"
#include <string.h>

static PetscBool TransferReads(const MpmScene *scene, const char option[])
{
  return scene->scheme.transfer->option && !strcmp(scene->scheme.transfer->option, option) ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasScheme(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->written ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasParameters(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->parameters[0] ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasOrder(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return TransferReads(scene, "xpic_order");
}

PetscBool MpmRecordHasRatio(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return TransferReads(scene, "blend_ratio");
}

PetscBool MpmRecordHasAffineRatio(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return TransferReads(scene, "aflip_ratio");
}

PetscBool MpmRecordHasShare(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return MpmFormulationReads(scene->scheme.formulation, "share");
}

PetscBool MpmRecordHasTheta(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return MpmFormulationReads(scene->scheme.formulation, "theta");
}

PetscBool MpmRecordHasRk(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return MpmFormulationReads(scene->scheme.formulation, "rk");
}

PetscBool MpmRecordHasFilterTime(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return MpmSceneChoosesFilter(scene);
}

/* Files that were written before there was more than one dimension have none of these three. */
PetscBool MpmRecordHasDim(const MpmScene *scene, MpmRecord record)
{
  return record == MPM_IN_FILE || record == MPM_IN_JSON || scene->layout.dim > 1 ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasGradient(const MpmScene *scene, MpmRecord record)
{
  return record == MPM_IN_FILE || record == MPM_IN_JSON || scene->scheme.space.gradient != MPM_GRADIENT_BASIS
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* A checkpoint holds what each rank had, and is read so where the ranks have the same cells. */
PetscBool MpmRecordHasBalance(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->layout.balance != MPM_BALANCE_AUTO ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasRanks(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->layout.ranks[0] ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasSplineEnds(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return MpmBasisIsAltered(scene->scheme.basis);
}

PetscBool MpmRecordHasPoisson(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return MpmSceneHasPoisson(scene);
}

PetscBool MpmRecordHasDensity(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->density > 0 ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasUnits(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return MpmSceneIsPhysical(scene);
}

PetscBool MpmRecordHasSpeed(const MpmScene *scene, MpmRecord record)
{
  return record != MPM_IN_JSON || MpmSceneIsPhysical(scene) ? PETSC_TRUE : PETSC_FALSE;
}

/* With courant auto step and drift differ from step to step. */
PetscBool MpmRecordHasOneStep(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->safety > 0 ? PETSC_FALSE : PETSC_TRUE;
}

PetscBool MpmRecordHasSafety(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->safety > 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* A checkpoint compares the drift also then, because it says how fast particles start. */
PetscBool MpmRecordHasDrift(const MpmScene *scene, MpmRecord record)
{
  return record == MPM_IN_CHECKPOINT || scene->safety == 0 ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasTimeStep(const MpmScene *scene, MpmRecord record)
{
  if (scene->safety > 0) return PETSC_FALSE;
  return record != MPM_IN_JSON || (MpmSceneIsPhysical(scene) && MpmSceneHasStep(scene)) ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasPolarisation(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return MpmSceneHasPoisson(scene) && scene->initial == MPM_INITIAL_MODE ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasOffset(const MpmScene *scene, MpmRecord record)
{
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    if (scene->layout.offset[a].value != 0.5) return PETSC_TRUE;
  return record != MPM_IN_JSON ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasJitter(const MpmScene *scene, MpmRecord record)
{
  return record != MPM_IN_JSON || scene->layout.jitter != 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* The seed decides where particles are, and for a run also what random data it starts from. */
PetscBool MpmRecordHasSeed(const MpmScene *scene, MpmRecord record)
{
  if (record == MPM_IN_FILE || scene->layout.jitter != 0) return PETSC_TRUE;
  return record == MPM_IN_CHECKPOINT && scene->initial == MPM_INITIAL_RANDOM ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasCounts(const MpmScene *scene, MpmRecord record)
{
  return record != MPM_IN_JSON || scene->layout.counts.n > 1 ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasCluster(const MpmScene *scene, MpmRecord record)
{
  return record != MPM_IN_JSON || scene->layout.cluster[1] - scene->layout.cluster[0] < 1 ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasMaterial(const MpmScene *scene, MpmRecord record)
{
  return record != MPM_IN_JSON || scene->layout.material.kind != MPM_MATERIAL_UNIFORM ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasMaterialName(const MpmScene *scene, MpmRecord record)
{
  return scene->law != &MpmLawLinear || MpmRecordHasMaterial(scene, record) ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasPrestress(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return MpmSpaceIsPrestressed(&scene->scheme.space);
}

PetscBool MpmRecordHasMove(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->scheme.space.displaced || scene->scheme.space.finite ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasKinematics(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->scheme.space.finite;
}

PetscBool MpmRecordHasShape(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->layout.shape ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasGravity(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    if (scene->gravity[a] != 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscBool MpmRecordHasStretch(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->law != &MpmLawLinear || scene->scheme.space.finite ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasLameRatio(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->law == &MpmLawNeo || (scene->scheme.space.finite && scene->law->solid) ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasExponent(const MpmScene *scene, MpmRecord record)
{
  (void)record;
  return scene->law->exponent > 0 ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmRecordHasInclusion(const MpmScene *scene, MpmRecord record)
{
  if (record == MPM_IN_FILE || record == MPM_IN_MODE_FILE) return PETSC_TRUE;
  return scene->layout.material.kind == MPM_MATERIAL_TWO ? PETSC_TRUE : PETSC_FALSE;
}

PetscInt MpmStressNumbers(const MpmScene *scene)
{
  return scene->layout.dim * (scene->layout.dim + 1) / 2;
}
