/* Gathers what the user said: in the scene file, then where PETSc finds options, then on the command line. */
#include "scene/settings.h"
#include "scene/settings_place.h"
#include <string.h>

/* Takes away what a weaker source said in another way; the same source must not say it twice. */
PetscErrorCode MpmSettingsDisplace(MpmSettings *settings, PetscInt option, PetscInt other, MpmOrigin source)
{
  PetscFunctionBegin;
  MpmCheckInput(settings->source[other] != source, "%s and %s are both given %s%s; allowed: one of them",
                MpmOptions[PetscMin(option, other)].name, MpmOptions[PetscMax(option, other)].name,
                source == MPM_FROM_SCENE     ? "in "
                : source == MPM_FROM_OUTSIDE ? "outside command line and scene"
                                             : "on the command line",
                source == MPM_FROM_SCENE ? settings->scene : "");
  PetscCall(PetscFree(settings->text[other]));
  settings->source[other] = MPM_FROM_DEFAULT;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsSet(MpmSettings *settings, PetscInt option, const char text[], MpmOrigin source, int line)
{
  PetscFunctionBegin;
  for (const char *rival = MpmOptions[option].rival; rival && *rival; rival += strcspn(rival, ",")) {
    char name[64];

    if (*rival == ',') rival++;
    (void)snprintf(name, strcspn(rival, ",") + 1, "%s", rival);
    PetscCall(MpmSettingsDisplace(settings, option, MpmOptionIndex(name), source));
  }
  PetscCall(PetscFree(settings->text[option]));
  PetscCall(PetscStrallocpy(text, &settings->text[option]));
  settings->source[option] = source;
  settings->line[option]   = line;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the options in PETSc's database that have one source. */
static PetscErrorCode ReadFrom(MpmSettings *settings, MpmOrigin source)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    char        key[64], place[MPM_PLACE_TEXT];
    const char *text;
    PetscBool   given;

    (void)snprintf(key, sizeof key, "-%s", MpmOptions[i].name);
    PetscCall(PetscOptionsFindPair(NULL, NULL, key, &text, &given));
    if (!given) continue;
    PetscCall(MpmSettingsPlace(MpmOptions[i].name, text, place));
    if ((place[0] ? MPM_FROM_OUTSIDE : MPM_FROM_COMMAND_LINE) != source) continue;
    PetscCall(MpmSettingsSet(settings, i, text ? text : "", source, 0));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadCommandLine(MpmSettings *settings)
{
  PetscFunctionBegin;
  PetscCall(ReadFrom(settings, MPM_FROM_OUTSIDE));
  PetscCall(ReadFrom(settings, MPM_FROM_COMMAND_LINE));
  settings->has_options = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsCreate(MpmSettings **settings)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(settings));
  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    PetscCheck(i < MPM_MAX_OPTIONS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_OPTIONS");
    if (MpmOptions[i].fallback) PetscCall(PetscStrallocpy(MpmOptions[i].fallback, &(*settings)->text[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsDestroy(MpmSettings **settings)
{
  PetscFunctionBegin;
  if (*settings) {
    for (PetscInt i = 0; MpmOptions[i].name; i++) PetscCall(PetscFree((*settings)->text[i]));
    for (PetscInt i = 0; i < (*settings)->nparameters; i++) {
      PetscCall(PetscFree((*settings)->parameter[i].name));
      PetscCall(PetscFree((*settings)->parameter[i].text));
    }
    PetscCall(MpmWrittenDestroy(&(*settings)->inside));
    PetscCall(MpmWrittenDestroy(&(*settings)->outside));
  }
  PetscCall(PetscFree(*settings));
  PetscFunctionReturn(PETSC_SUCCESS);
}
