/*
   Settings: what the user said, as text, with where it was said. The command line overrides the scene, the
   scene overrides the defaults. Typed readers refuse what is not allowed with one message that names option,
   value and what is allowed.
*/
#pragma once
#include "base/suggest.h"
#include <mpmstab/errors.h>
#include <mpmstab/fraction.h>

typedef enum {
  MPM_WORD,
  MPM_INTEGER,
  MPM_REAL,
  MPM_FRACTION,
  MPM_SWITCH,
  MPM_PATH,
  MPM_RANGE,
  MPM_SPAN,
  MPM_ENDS,
  MPM_LIST
} MpmOptionKind;

/*S
   MpmOption - one option: a scene key and the command-line option of the same name.

   lo and hi bound numbers (lo itself is out when lo_open); word(i) lists the words allowed; rival names an
   option that says the same thing in another way, so that both given is an error; tasks names those that read it (NULL:
   all), so that the others refuse it on the command line.
S*/
typedef struct {
  const char   *name;
  MpmOptionKind kind;
  const char   *fallback, *help;
  PetscReal     lo, hi;
  PetscBool     lo_open;
  const char *(*word)(PetscInt i);
  const char *rival, *tasks;
} MpmOption;

/* Not collective. All options, ended by one without a name. */
extern const MpmOption MpmOptions[];

#define MPM_MAX_OPTIONS 96

typedef enum { MPM_FROM_DEFAULT, MPM_FROM_SCENE, MPM_FROM_COMMAND_LINE } MpmSource;

typedef struct {
  char     *text[MPM_MAX_OPTIONS]; /* NULL: not given and no default */
  MpmSource source[MPM_MAX_OPTIONS];
  int       line[MPM_MAX_OPTIONS]; /* in the scene, from 1 */
  char      scene[PETSC_MAX_PATH_LEN];
} MpmSettings;

/* Collective. Reads the scene (NULL: none), then the command line; refuses unknown and doubly given options. */
PetscErrorCode MpmSettingsCreate(const char scene[], MpmSettings **settings);
PetscErrorCode MpmSettingsDestroy(MpmSettings **settings);

/* Not collective. Index of an option in MpmOptions, or MPM_NOT_AN_OPTION. */
#define MPM_NOT_AN_OPTION -1
PetscInt MpmOptionIndex(const char name[]);

/* Collective. Refuses words, misspelled options and those the task does not read, before anything runs. */
PetscErrorCode MpmSettingsCheckCommandLine(const char task[], int argc, char **argv, int first);

/* Collective. Refuses options that nothing has read; call when the task is done. */
PetscErrorCode MpmSettingsCheckUnused(void);

/* Collective. Reads a YAML scene's keys into the settings. */
PetscErrorCode MpmSettingsReadScene(MpmSettings *settings, const char path[]);
PetscErrorCode MpmSettingsSet(MpmSettings *settings, PetscInt option, const char text[], MpmSource source, int line);

/* Collective. Ends with a message that names the option, its value, where it stands, and why it cannot be. */
PetscErrorCode MpmSettingsRefuse(const MpmSettings *settings, const char name[], const char why[]);

/*
   Collective. Typed values, checked against the option's range or words. The option must have a value
   (MpmSettingsGiven, or a default). Span: two fractions, the first below the second. Ends: two words, or one for both.
   List: whole numbers with commas between them, at most room.
*/
PetscErrorCode MpmSettingsInteger(const MpmSettings *settings, const char name[], PetscInt64 *value);
PetscErrorCode MpmSettingsReal(const MpmSettings *settings, const char name[], PetscReal *value);
PetscErrorCode MpmSettingsFraction(const MpmSettings *settings, const char name[], MpmFraction *value);
PetscErrorCode MpmSettingsSwitch(const MpmSettings *settings, const char name[], PetscBool *value);
PetscErrorCode MpmSettingsWord(const MpmSettings *settings, const char name[], PetscInt *index);
PetscErrorCode MpmSettingsRange(const MpmSettings *settings, const char name[], PetscReal range[2]);
PetscErrorCode MpmSettingsSpan(const MpmSettings *settings, const char name[], MpmFraction span[2]);
PetscErrorCode MpmSettingsEnds(const MpmSettings *settings, const char name[], PetscInt index[2]);
PetscErrorCode MpmSettingsList(const MpmSettings *settings, const char name[], PetscInt room, PetscInt *n,
                               PetscInt list[]);
PetscErrorCode MpmSettingsPath(const MpmSettings *settings, const char name[], const char **path);

/* Not collective. Whether an option has a value, and who gave it. */
PetscBool MpmSettingsGiven(const MpmSettings *settings, const char name[]);
MpmSource MpmSettingsSource(const MpmSettings *settings, const char name[]);

/* Not collective. Whether a key of the scene has lost its sense because the command line changed another. */
PetscBool MpmSettingsOverruled(const MpmSettings *settings, const char key[], const char by[]);
