/* The words of options, and the texts of values that a scene keeps as something else: for the table of fields. */
#pragma once
#include <mpmstab/scene.h>

/* Not collective. Word i of an option, or NULL after its last one. */
const char *MpmFormulationWord(PetscInt i);
const char *MpmBasisWord(PetscInt i);
const char *MpmInitialWord(PetscInt i);
const char *MpmPolarisationWord(PetscInt i);
const char *MpmVerdictWord(PetscInt i);
const char *MpmGrowthWord(PetscInt i);
const char *MpmTransferWord(PetscInt i);
const char *MpmRkOnWord(PetscInt i);
const char *MpmLayoutWord(PetscInt i);
const char *MpmBalanceWord(PetscInt i);
const char *MpmMoveWord(PetscInt i);
const char *MpmShapeWord(PetscInt i);
const char *MpmTangentWord(PetscInt i);
const char *MpmKinematicsWord(PetscInt i);
const char *MpmMaterialWord(PetscInt i);
const char *MpmEndWord(PetscInt i);
const char *MpmGradientWord(PetscInt i);
const char *MpmFilterTimeWord(PetscInt i);
const char *MpmNeighbourhoodWord(PetscInt i);
const char *MpmSplineEndsWord(PetscInt i);
const char *MpmProbeWord(PetscInt i);
const char *MpmAxisWord(PetscInt i);

/* Not collective. The value of a field of a scene as text. */
const char *MpmMoveOf(const MpmScene *scene);
const char *MpmKinematicsOf(const MpmScene *scene);
const char *MpmShapeOf(const MpmScene *scene);
const char *MpmFormulationOf(const MpmScene *scene);
const char *MpmSchemeHashOf(const MpmScene *scene);
const char *MpmParametersOf(const MpmScene *scene);
const char *MpmBasisOf(const MpmScene *scene);
const char *MpmTransferOf(const MpmScene *scene);
const char *MpmRkOf(const MpmScene *scene);
const char *MpmRkOnOf(const MpmScene *scene);
const char *MpmGradientOf(const MpmScene *scene);
const char *MpmFilterTimeOf(const MpmScene *scene);
const char *MpmSplineEndsOf(const MpmScene *scene);
const char *MpmLayoutOf(const MpmScene *scene);
const char *MpmBalanceOf(const MpmScene *scene);
const char *MpmMaterialOf(const MpmScene *scene);
const char *MpmBoundaryOf(const MpmScene *scene);
const char *MpmPolarisationOf(const MpmScene *scene);
const char *MpmInitialOf(const MpmScene *scene);
