/*
   PETSc keeps the options of all places in one database. Here each place is read once more, and the one that has the
   option with the database's value is the one that counts.
*/
#include "scene/settings_place.h"
#include "base/launch.h"
#include <stdlib.h>
#include <string.h>

/* Where on the command line an option is; 0: nowhere. */
static PetscErrorCode FindOnCommandLine(const char name[], int *at, char ***argv)
{
  int argc;

  PetscFunctionBegin;
  PetscCall(PetscGetArgs(&argc, argv));
  for (*at = argc - 1; *at > 0; --*at)
    if ((*argv)[*at][0] == '-' && !strcmp((*argv)[*at] + 1, name)) break;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Has(PetscOptions options, const char name[], const char value[], PetscBool *has)
{
  char        key[256];
  const char *text;

  PetscFunctionBegin;
  (void)snprintf(key, sizeof key, "-%s", name);
  PetscCall(PetscOptionsFindPair(options, NULL, key, &text, has));
  if (*has && strcmp(text ? text : "", value ? value : "")) *has = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the variable PETSC_OPTIONS (file NULL), or a file, gives the option this value. */
static PetscErrorCode Gives(const char file[], const char name[], const char value[], PetscBool *gives)
{
  const char  *variable = getenv("PETSC_OPTIONS");
  PetscOptions options;

  PetscFunctionBegin;
  PetscCall(PetscOptionsCreate(&options));
  if (file)
    PetscCall(PetscOptionsInsertFile(PETSC_COMM_WORLD, options, file, PETSC_FALSE));
  else if (variable)
    PetscCall(PetscOptionsInsertString(options, variable));
  PetscCall(Has(options, name, value, gives));
  PetscCall(PetscOptionsDestroy(&options));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsPlaceFile(int i, size_t room, char file[], PetscBool *there)
{
  char **argv;
  int    skipped, at;

  PetscFunctionBegin;
  *there = PETSC_FALSE;
  PetscCall(FindOnCommandLine("options_file", &at, &argv));
  if (at && i == 0 && argv[at + 1]) {
    (void)snprintf(file, room, "%s", argv[at + 1]);
    *there = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(FindOnCommandLine("skip_petscrc", &skipped, &argv));
  if (!skipped) *there = MpmLaunchOptionFile(at ? i - 1 : i, room, file) ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsPlace(const char name[], const char value[], char place[MPM_PLACE_TEXT])
{
  char      file[MPM_PLACE_TEXT - 16], **argv;
  PetscBool is, there = PETSC_TRUE;
  int       at;

  PetscFunctionBegin;
  place[0] = '\0';
  PetscCall(FindOnCommandLine(name, &at, &argv));
  if (at) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Gives(NULL, name, value, &is));
  if (is) (void)snprintf(place, MPM_PLACE_TEXT, "%s", ", from PETSC_OPTIONS");
  for (int i = 0; !is && there; i++) {
    PetscCall(MpmSettingsPlaceFile(i, sizeof file, file, &there));
    if (there) PetscCall(Gives(file, name, value, &is));
    if (is) (void)snprintf(place, MPM_PLACE_TEXT, ", from %s", file);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
