/* The initial data of a scene: which wave it starts from, and whether that wave exists between its ends. */
#include "scene/solution.h"
#include <string.h>

/* asked: the initial data that the settings name. Where there is no such solution scene->initial has others. */
static PetscErrorCode ReadStagger(const MpmSettings *settings, MpmInitial asked, MpmScene *scene)
{
  PetscFunctionBegin;
  if (scene->stagger && scene->scheme.formulation->staggered == MPM_NONE) {
    scene->stagger = PETSC_FALSE;
    PetscCall(
        MpmSettingsRefuseUnless(settings, "stagger", "formulation",
                                "no field of this formulation lags half a step; allowed: with those where one does"));
  }
  if (scene->stagger && scene->initial != MPM_INITIAL_MODE && scene->initial != MPM_INITIAL_PULSE &&
      !MpmSolutionOf(scene)) {
    scene->stagger = PETSC_FALSE;
    PetscCall(MpmSettingsRefuseUnless(settings, "stagger", asked != scene->initial ? "boundary,initial" : "initial",
                                      "these data have no half step; allowed: with initial mode or pulse, or an exact "
                                      "solution at finite strain"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In one dimension, and of an eigenvector, a number; else the waves in each direction, where one number is along x. */
static PetscErrorCode ReadMode(const MpmSettings *settings, MpmScene *scene)
{
  static const char positive[] = "allowed: a whole number from 1 to 2147483646";
  const MpmLayout  *l          = &scene->layout;
  const char       *text = MpmSettingsText(settings, "mode"), *end = text + strspn(text, "+0123456789");
  const PetscBool   list   = strchr(text, ',') ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool   number = l->dim == 1 || scene->initial == MPM_INITIAL_EIGENMODE ? PETSC_TRUE : PETSC_FALSE;
  PetscInt64        mode[MPM_MAX_DIM] = {0};
  PetscBool         fits = PETSC_TRUE, none = PETSC_TRUE;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(number && *end, settings, "mode", positive);
  if (number || !list)
    PetscCall(MpmSettingsIntegers(settings, "mode", 1, mode));
  else
    PetscCall(MpmSettingsIntegers(settings, "mode", l->dim, mode));
  MpmSettingsRefuseIf(number && mode[0] < 1, settings, "mode", positive);
  for (PetscInt a = 0; a < l->dim; a++) {
    const PetscBool  ends = l->grid[a].ends[0] != MPM_PERIODIC ? PETSC_TRUE : PETSC_FALSE;
    const PetscInt64 most = PetscMax(1, ends ? l->grid[a].cells : l->grid[a].cells / 2);

    scene->mode[a] = (PetscInt)mode[a];
    if (mode[a] > most || mode[a] < (ends ? 0 : -most)) fits = PETSC_FALSE;
    if (mode[a]) none = PETSC_FALSE;
  }
  if (none && scene->initial != MPM_INITIAL_MODE) scene->mode[0] = 1; /* a scene's mode that is not read any more */
  if (scene->initial != MPM_INITIAL_MODE || (fits && !none)) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(l->dim > 1, settings, "mode",
                      "allowed: one whole number for each direction, not all 0; from -cells / 2 to cells / 2 "
                      "in a periodic direction, from 0 to cells between ends");
  PetscCall(MpmSettingsRefuse(settings, "mode",
                              MpmSceneIsPeriodic(scene) ? "allowed: a whole number from 1 to cells / 2"
                                                        : "allowed: a whole number from 1 to cells"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadPolarisation(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  if (MpmSettingsSource(settings, "polarisation") == MPM_FROM_DEFAULT) PetscFunctionReturn(PETSC_SUCCESS);
  if (!MpmSceneHasPoisson(scene)) {
    scene->polarisation = MPM_P_WAVE;
    PetscCall(MpmSettingsRefuseUnless(
        settings, "polarisation", "dim,formulation",
        "allowed: only with dim 2 or 3, and a formulation with a stress (usl, usf, musl, usavg)"));
  }
  if (scene->initial != MPM_INITIAL_MODE) {
    scene->polarisation = MPM_P_WAVE;
    PetscCall(MpmSettingsRefuseUnless(settings, "polarisation", "initial", "allowed: only with initial mode"));
  }
  if (scene->polarisation == MPM_S_WAVE && MpmSpaceIsFluid(&scene->scheme.space)) {
    scene->polarisation = MPM_P_WAVE;
    PetscCall(MpmSettingsRefuseUnless(settings, "polarisation", "poisson",
                                      "a fluid has no S waves; allowed: p, or poisson below 0.5"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Data that were asked for and do not exist are refused. Otherwise runs start from random data: also when a scene asks
   for them, and the command line has another value of the option by.
*/
static PetscErrorCode FallBack(const MpmSettings *settings, MpmScene *scene, const char by[], const char why[])
{
  static const char *const options[] = {"initial", "mode", "polarisation"};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(options); i++)
    PetscCall(MpmSettingsRefuseUnless(settings, options[i], by, why));
  scene->initial = MPM_INITIAL_RANDOM;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses data without an exact solution to start from. */
static PetscErrorCode CheckExact(const MpmSettings *settings, MpmScene *scene)
{
  const PetscBool mode = scene->initial == MPM_INITIAL_MODE ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (!MpmInitialHasExact(scene->initial)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!scene->scheme.formulation->wave)
    PetscCall(FallBack(settings, scene, "formulation",
                       "the formulation has no exact solution to start from; allowed: random or eigenmode"));
  else if (scene->layout.dim > 1 && MpmSpaceIsPrestressed(&scene->scheme.space))
    PetscCall(FallBack(settings, scene, scene->law == &MpmLawLinear ? "prestress" : "material",
                       "waves about a prestressed state have no exact solution here; allowed: with dim 1, or random or "
                       "eigenmode"));
  else if (mode && !MpmSceneProfile(scene, 1).nwaves)
    PetscCall(FallBack(settings, scene, "boundary",
                       "no such wave stands between these ends; allowed: another mode, boundary periodic or symmetry, "
                       "or initial random"));
  else if (!mode && scene->layout.dim > 1)
    PetscCall(FallBack(settings, scene, "dim",
                       "its exact solution is of one dimension; allowed: with dim 1, or mode, random or eigenmode"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadInitial(const MpmSettings *settings, MpmScene *scene)
{
  const MpmInitial asked = scene->initial;

  PetscFunctionBegin;
  if (!scene->scheme.space.finite && scene->initial >= MPM_INITIAL_MANUFACTURED)
    PetscCall(FallBack(settings, scene, "kinematics",
                       "allowed: with kinematics finite; or mode, random, pulse, eigenmode and step"));
  PetscCall(ReadMode(settings, scene));
  PetscCall(ReadPolarisation(settings, scene));
  PetscCall(CheckExact(settings, scene));
  MpmSettingsRefuseIf(scene->initial == MPM_INITIAL_STEP &&
                          (!MpmEndIsFixed(scene->layout.grid[0].ends[0]) || scene->layout.grid[0].ends[1] != MPM_FREE),
                      settings, "initial", "a load needs an end to act on; allowed: with boundary fixed,free");
  if (asked != MPM_INITIAL_MODE && asked != MPM_INITIAL_EIGENMODE)
    PetscCall(MpmSettingsRefuseUnless(settings, "mode", "initial", "allowed: only with initial mode or eigenmode"));
  PetscCall(ReadStagger(settings, asked, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
