/* From settings to the neighbourhoods that a task is to look at. */
#include "scene/settings.h"
#include <string.h>

#define ALL MPM_NEIGHBOURHOODS /* the word after those of the kinds */
#define MANY_LAYOUTS 100       /* of an ensemble, when the option layouts is not given */
#define SOME_LAYOUTS 20        /* of neighbourhoods random and disordered, whose limits are sought too */

const char *const MpmNeighbourhoodNames[] = {"bulk",       "edge",  "corner", "lone", "random",
                                             "disordered", "worst", "all",    NULL};

/* All leaves out a corner in one dimension, where it is an edge, and the worst, whose search takes long. */
static void Take(PetscInt word, const MpmScene *scene, MpmRequest *request)
{
  if (word != ALL) {
    request->neighbourhood[word] = PETSC_TRUE;
    return;
  }
  for (int kind = 0; kind < MPM_NEIGHBOURHOODS; kind++)
    if ((scene->layout.dim > 1 || kind != MPM_AT_CORNER) && kind != MPM_AT_WORST)
      request->neighbourhood[kind] = PETSC_TRUE;
}

/*
   Whether a scene in physical units leaves open where its particles end. One with walls, gaps or jitter says itself
   where they are.
*/
static PetscBool FillsSpace(const MpmScene *scene)
{
  return MpmSceneIsPhysical(scene) && MpmLayoutIsUniform(&scene->layout) ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Whether the default answer of critical has a table of steps by layout: for lattices at rest with a scheme of the
   program, whose searches are quick.
*/
static PetscBool HasTable(const MpmScene *scene)
{
  const MpmScheme *scheme = &scene->scheme;
  const MpmLayout *layout = &scene->layout;

  return MpmLayoutIsUniform(layout) && layout->counts.n == 1 && layout->cluster[1] - layout->cluster[0] >= 1 &&
                 !MpmSceneDrifts(scene) && !MpmTableSolves(scheme->table) && !scheme->formulation->written &&
                 !MpmSpaceIsDamped(&scheme->space) && !MpmSpaceIsPrestressed(&scheme->space)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/*
   What is asked of where nothing was given. With a table of steps only what is quick, since it names the others: edges
   take long with rk, and random layouts where growth is not known to stay.
*/
static PetscInt Default(const MpmScene *scene, PetscBool all, PetscBool table, PetscInt word[])
{
  static const PetscInt quick[] = {MPM_IN_BULK, MPM_ALONE, MPM_AT_EDGE, MPM_DISORDERED};
  const MpmScheme      *scheme  = &scene->scheme;
  const PetscBool       stays = scheme->formulation->leftmost && scheme->transfer->leftmost ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt        n     = scene->layout.dim == 3 || scheme->formulation->quiet ? 2 : stays ? 4 : 3;

  word[0] = all ? ALL : MPM_IN_BULK;
  if (!all || !table || (scene->layout.dim == 1 && n == 4)) return 1;
  for (PetscInt i = 0; i < n; i++) word[i] = quick[i];
  return n;
}

PetscErrorCode MpmSettingsReadNeighbourhoods(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  const PetscBool critical = !strcmp(request->task, "critical") ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool reads    = critical || !strcmp(request->task, "spectrum") ? PETSC_TRUE : PETSC_FALSE;
  PetscInt        word[MPM_NEIGHBOURHOODS + 1], n = 0;

  PetscFunctionBegin;
  if (reads && MpmSettingsGiven(settings, "neighbourhood"))
    PetscCall(MpmSettingsWords(settings, "neighbourhood", MPM_NEIGHBOURHOODS + 1, &n, word));
  MpmSettingsRefuseIf(n && request->survey, settings, "neighbourhood",
                      "a survey is of the bulk; allowed: without survey");
  MpmSettingsRefuseIf(n && critical && request->at_mach, settings, "neighbourhood",
                      "at a Mach number the search is of the bulk; allowed: drift");
  request->table =
      critical && !n && !request->survey && !request->at_mach && HasTable(scene) ? PETSC_TRUE : PETSC_FALSE;
  if (!n)
    n = Default(scene, critical && !request->survey && !request->at_mach && FillsSpace(scene), request->table, word);
  for (PetscInt i = 0; i < n; i++) Take(word[i], scene, request);
  for (int kind = 0; kind < MPM_NEIGHBOURHOODS; kind++)
    MpmSettingsRefuseIf(scene->layout.given && request->neighbourhood[kind] != (kind == MPM_IN_BULK), settings,
                        "neighbourhood", "the layout of a file has its own surfaces; allowed: bulk, or layout uniform");
  for (int kind = 0; kind < MPM_NEIGHBOURHOODS; kind++)
    MpmSettingsRefuseIf(scene->layout.colliders && request->neighbourhood[kind] != (kind == MPM_IN_BULK), settings,
                        "neighbourhood", "colliders stand in the grid of the scene; allowed: bulk");
  if (!request->neighbourhood[MPM_IN_BULK])
    PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_COMMAND_LINE,
                                   "csv,output,powers,pseudospectrum,modes,measure,nodal,write_matrix",
                                   "it is of the bulk; allowed: with neighbourhood bulk"));
  if (reads && !request->neighbourhood[MPM_AT_RANDOM])
    PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_COMMAND_LINE, "voids", "allowed: with neighbourhood random"));
  if (reads && !request->neighbourhood[MPM_AT_RANDOM] && !request->neighbourhood[MPM_DISORDERED] &&
      !request->neighbourhood[MPM_AT_WORST])
    PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_COMMAND_LINE, "layouts",
                                   "allowed: with neighbourhood random, disordered or worst"));
  if (critical && !request->neighbourhood[MPM_AT_WORST] && !scene->layout.given)
    PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_COMMAND_LINE, "write_layout",
                                   "allowed: with neighbourhood worst, or with layout FILE or random"));
  if (!MpmSettingsGiven(settings, "layouts"))
    request->layouts = strcmp(request->task, "ensemble") ? SOME_LAYOUTS : MANY_LAYOUTS;
  PetscFunctionReturn(PETSC_SUCCESS);
}
