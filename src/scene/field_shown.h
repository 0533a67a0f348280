/* When a record shows a field of a scene: for the table of fields. */
#pragma once
#include "scene/fields.h"

/* Not collective. Whether a record of a scene shows the field, or the fields, that the function is named after. */
PetscBool MpmRecordHasScheme(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasParameters(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasOrder(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasRatio(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasAffineRatio(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasShare(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasTheta(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasRk(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasFilterTime(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasDim(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasGradient(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasBalance(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasRanks(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasSplineEnds(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasPoisson(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasDensity(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasUnits(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasSpeed(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasOneStep(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasSafety(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasDrift(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasTimeStep(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasPolarisation(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasOffset(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasJitter(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasSeed(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasCounts(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasCluster(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasMaterial(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasMaterialName(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasPrestress(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasMove(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasKinematics(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasShape(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasGravity(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasStretch(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasLameRatio(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasExponent(const MpmScene *scene, MpmRecord record);
PetscBool MpmRecordHasInclusion(const MpmScene *scene, MpmRecord record);

/* Not collective. How many components a stress has. */
PetscInt MpmStressNumbers(const MpmScene *scene);
