/* From settings to the neighbourhoods that a task is to look at. */
#include "scene/settings.h"
#include <string.h>

#define ALL MPM_NEIGHBOURHOODS /* the word after those of the kinds */
#define MANY_LAYOUTS 100       /* of an ensemble, when the option layouts is not given */
#define SOME_LAYOUTS 20        /* of neighbourhood random, whose limits are sought too */

const char *const MpmNeighbourhoodNames[] = {"bulk", "edge", "corner", "lone", "random", "all", NULL};

/* In one dimension a corner is an edge, so that all leaves it out. */
static void Take(PetscInt word, const MpmScene *scene, MpmRequest *request)
{
  if (word != ALL) {
    request->neighbourhood[word] = PETSC_TRUE;
    return;
  }
  for (int kind = 0; kind < MPM_NEIGHBOURHOODS; kind++)
    if (scene->layout.dim > 1 || kind != MPM_AT_CORNER) request->neighbourhood[kind] = PETSC_TRUE;
}

/*
   Whether a scene in physical units leaves open where its particles end. One with walls, gaps or jitter says itself
   where they are.
*/
static PetscBool FillsSpace(const MpmScene *scene)
{
  return MpmSceneIsPhysical(scene) && MpmLayoutIsUniform(&scene->layout) ? PETSC_TRUE : PETSC_FALSE;
}

/* Refuses what only neighbourhood random reads, of the tasks that have one. */
static PetscErrorCode CheckRandom(const MpmSettings *settings, const MpmRequest *request)
{
  static const char *const random[] = {"voids", "layouts"};

  PetscFunctionBegin;
  if (strcmp(request->task, "critical") && strcmp(request->task, "spectrum")) PetscFunctionReturn(PETSC_SUCCESS);
  if (request->neighbourhood[MPM_AT_RANDOM]) PetscFunctionReturn(PETSC_SUCCESS);
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(random); i++)
    if (MpmSettingsSource(settings, random[i]) == MPM_FROM_COMMAND_LINE)
      PetscCall(MpmSettingsRefuse(settings, random[i], "allowed: with neighbourhood random"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses what is of the bulk where the bulk is not looked at. */
static PetscErrorCode CheckBulk(const MpmSettings *settings, const MpmRequest *request)
{
  static const char *const bulk[] = {"csv",   "output",  "powers", "pseudospectrum",
                                     "modes", "measure", "nodal",  "write_matrix"};

  PetscFunctionBegin;
  if (request->neighbourhood[MPM_IN_BULK]) PetscFunctionReturn(PETSC_SUCCESS);
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(bulk); i++)
    if (MpmSettingsSource(settings, bulk[i]) == MPM_FROM_COMMAND_LINE)
      PetscCall(MpmSettingsRefuse(settings, bulk[i], "it is of the bulk; allowed: with neighbourhood bulk"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadNeighbourhoods(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  const PetscBool critical = !strcmp(request->task, "critical") ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool reads    = critical || !strcmp(request->task, "spectrum") ? PETSC_TRUE : PETSC_FALSE;
  PetscInt        word[MPM_NEIGHBOURHOODS + 1], n = 0;

  PetscFunctionBegin;
  if (reads && MpmSettingsGiven(settings, "neighbourhood"))
    PetscCall(MpmSettingsWords(settings, "neighbourhood", MPM_NEIGHBOURHOODS + 1, &n, word));
  if (n && request->survey)
    PetscCall(MpmSettingsRefuse(settings, "neighbourhood", "a survey is of the bulk; allowed: without survey"));
  if (n && critical && request->at_mach)
    PetscCall(
        MpmSettingsRefuse(settings, "neighbourhood", "at a Mach number the search is of the bulk; allowed: drift"));
  if (!n) word[n++] = critical && !request->survey && !request->at_mach && FillsSpace(scene) ? ALL : MPM_IN_BULK;
  for (PetscInt i = 0; i < n; i++) Take(word[i], scene, request);
  PetscCall(CheckBulk(settings, request));
  PetscCall(CheckRandom(settings, request));
  if (!MpmSettingsGiven(settings, "layouts"))
    request->layouts = strcmp(request->task, "ensemble") ? SOME_LAYOUTS : MANY_LAYOUTS;
  PetscFunctionReturn(PETSC_SUCCESS);
}
