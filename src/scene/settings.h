/*
   Settings: what the user said, as text, with where it was said. The command line overrides what PETSc finds elsewhere
   (MpmSettingsPlace), this overrides the scene file, and the scene file overrides the defaults. Readers for each kind
   of value refuse what is not allowed, with one message that names the option, its value and what is allowed.
*/
#pragma once
#include "base/text.h"
#include "scene/fields.h"
#include "scheme/language.h"
#include <mpmstab/errors.h>

/* Outside: PETSC_OPTIONS, or a file in which PETSc looks for options. */
typedef enum { MPM_FROM_DEFAULT, MPM_FROM_SCENE, MPM_FROM_OUTSIDE, MPM_FROM_COMMAND_LINE } MpmOrigin;

#define MPM_MOST_SAID 64 /* names that are no options */
#define MPM_MOST_SETTINGS (MPM_MAX_OPTIONS + MPM_MOST_SAID)

/*
   What was said of each option, and behind the options of n other names: parameters of the scheme or of a code, and map_
   with such a name. inside, outside: the schemes that are written in the scene and in the file that the option scheme
   names. scheme: the one of them that counts; NULL: none. has_options: the command line has been read. files: those that
   keys inside options name, which have been read, a line each.
*/
typedef struct {
  char     *text[MPM_MOST_SETTINGS]; /* NULL: not given and no default */
  MpmOrigin source[MPM_MOST_SETTINGS];
  int       line[MPM_MOST_SETTINGS]; /* in the scene, from 1 */
  PetscInt  n;
  char     *name[MPM_MOST_SAID], scene[PETSC_MAX_PATH_LEN];

  MpmWritten *inside, *outside, *scheme;
  PetscBool   has_options;
  MpmText    *files;
} MpmSettings;

/* Not collective. The defaults, over which the other readers write. */
PetscErrorCode MpmSettingsCreate(MpmSettings **settings);
PetscErrorCode MpmSettingsDestroy(MpmSettings **settings);

/*
   Collective. Reads the keys of a scene, from a YAML file or from YAML text that messages call by a name, and the
   options in PETSc's database. Each refuses keys that are unknown and what is given twice.
*/
PetscErrorCode MpmSettingsReadScene(MpmSettings *settings, const char path[]);
PetscErrorCode MpmSettingsReadText(MpmSettings *settings, const char name[], const char yaml[]);
PetscErrorCode MpmSettingsReadCommandLine(MpmSettings *settings);

/*
   Collective. Takes away what is said of another option where an option of this source says it in another way. Refuses
   what the same source says in both.
*/
PetscErrorCode MpmSettingsDisplace(MpmSettings *settings, PetscInt option, PetscInt other, MpmOrigin source);

/*
   MpmSettingsSet - sets the text of an option or of another name, and takes away those of its rivals. line: in the scene,
   from 1. MpmSettingsReadOption - does so where PETSc's database has the option, and from that source;
   MPM_FROM_DEFAULT: from any.

   Collective.
*/
PetscErrorCode MpmSettingsSet(MpmSettings *settings, const char name[], const char text[], MpmOrigin source, int line);
PetscErrorCode MpmSettingsReadOption(MpmSettings *settings, const char name[], MpmOrigin source);

/* Collective. Refuses words, misspelled options and those the task does not read, before anything runs. */
PetscErrorCode MpmSettingsCheckCommandLine(const char task[], int argc, char **argv, int first);

/*
   Collective. Sets the numbers that the formulation is given. filters: the transfer has a filter, or makes something
   else of the nodes, for which stages on particles have no place; such stages are refused then.
*/
PetscErrorCode MpmSettingsFormulationNumbers(const MpmSettings *settings, const MpmFormulation *formulation,
                                             PetscBool filters, MpmSchemeNumbers *numbers);

/*
   MpmSettingsReadScheme    - reads the scheme of a file, and what the command line says of the scheme's parameters. It
                              refuses keys and names that are neither options nor parameters.
   MpmSettingsHasParameter  - whether name is a parameter of the scheme that scene and command line name, or map_ and
                              one. near: the parameter that a misspelt name may mean, empty where there is none

   Collective.
*/
PetscErrorCode MpmSettingsReadScheme(MpmSettings *settings);
PetscErrorCode MpmSettingsHasParameter(const char scene[], const char name[], PetscBool *has, size_t room, char near[]);

#define MPM_PLACE_TEXT 512

/*
   MpmSettingsPlace - says where an option of PETSc's database comes from: ", from PETSC_OPTIONS", ", from .petscrc" or
   another file of options; "" for the command line, or the program itself. value: NULL or "" for none.
   MpmSettingsPlaceFile - gives the names of the files of options, the one that overrules the others first; the command
   line may name one. there: whether there is an i-th name. There need be no such file.

   Collective on PETSC_COMM_WORLD: MpmSettingsPlace. Not collective: MpmSettingsPlaceFile.
*/
PetscErrorCode MpmSettingsPlace(const char name[], const char value[], char place[MPM_PLACE_TEXT]);
PetscErrorCode MpmSettingsPlaceFile(int i, size_t room, char file[], PetscBool *there);

/*
   Not collective. What others call an option, or a word that is a value of an option, as it is called here; or NULL.
   Case does not matter but for E, K and G.
*/
const char *MpmOptionCalledHere(const char name[]);
const char *MpmWordCalledHere(const char option[], const char word[]);

/* Not collective. Whether PETSc or SLEPc takes an option of this name, as far as is known beforehand. */
PetscBool MpmSettingsIsLibrary(const char name[]);

/*
   MpmSettingsCheckOutside - prints a line for each place other than command line and scene that gives options, such as
   'from PETSC_OPTIONS: -courant 0.3', also those that the task does not read.

   Collective. Refuses options that do not exist, with their place, before anything runs. scene: its file, or NULL.
*/
PetscErrorCode MpmSettingsCheckOutside(const char task[], const char scene[]);

/* Collective. Refuses options that nothing has read; call when the task is done. */
PetscErrorCode MpmSettingsCheckUnused(void);

/*
   Collective. Ends with a message that names the option, its value, where it stands, and why it cannot be: a format of
   printf and its arguments. MpmSettingsRefuseIf - does so if a condition holds.
*/
PetscErrorCode MpmSettingsRefuse(const MpmSettings *settings, const char name[], const char why[], ...)
    __attribute__((format(printf, 3, 4)));
#define MpmSettingsRefuseIf(condition, ...)                                                                            \
  do {                                                                                                                 \
    if (condition) PetscCall(MpmSettingsRefuse(__VA_ARGS__));                                                          \
  } while (0)

/*
   Not collective. Whether an option was given, and has not lost its sense because a stronger source has given one of
   others, whose names have commas between them.
*/
PetscBool MpmSettingsStands(const MpmSettings *settings, const char key[], const char by[]);

/*
   Collective. Refuses those of some options, with commas between their names, that stand beside others (by), or, where by
   is NULL, that a source gave which is as strong as least. Rules are lines of what is refused, when, and why: GIVEN and
   STANDS, in functions that have settings.
*/
PetscErrorCode MpmSettingsRefuseEach(const MpmSettings *settings, const char options[], const char by[],
                                     MpmOrigin least, const char why[]);
#define GIVEN(options, least, when, why)                                                                               \
  do {                                                                                                                 \
    if (when) PetscCall(MpmSettingsRefuseEach(settings, options, NULL, least, why));                                   \
  } while (0)
#define STANDS(options, by, when, why)                                                                                 \
  do {                                                                                                                 \
    if (when) PetscCall(MpmSettingsRefuseEach(settings, options, by, MPM_FROM_SCENE, why));                            \
  } while (0)

/*
   Not collective. Whether a step has one stage, without IMPLICIT, so that a particle flows from the state of the step
   before.
*/
PetscBool MpmFormulationHasOneStage(const MpmFormulation *f);

/* Not collective. Frees the colliders of a layout. */
PetscErrorCode MpmSettingsForgetColliders(const MpmColliders **colliders);

/*
   Collective. Typed values, checked against the option's range or words. The option must have a value
   (MpmSettingsGiven, or a default). Read: values of a kind, at places stride bytes apart; of MPM_AS_ENDS two words, or
   one for both. Span: two fractions, the first below the second. List: whole numbers with commas between them, at most
   room. Reals: the same of real numbers. Words: the same of words, as their indices.

   With dim: the values of so many directions, which are one for all or one for each with commas between them. The Ends
   of several directions have a hyphen between the two words of one: periodic,fixed-free.
*/
PetscErrorCode MpmSettingsRead(const MpmSettings *settings, const char name[], MpmValueKind kind, PetscInt dim,
                               size_t stride, void *values);
#define MpmSettingsIntegers(settings, name, dim, value)                                                                \
  MpmSettingsRead(settings, name, MPM_AS_LONG, dim, sizeof(PetscInt64), value)
#define MpmSettingsFractions(settings, name, dim, value)                                                               \
  MpmSettingsRead(settings, name, MPM_AS_FRACTION, dim, sizeof(MpmFraction), value)
#define MpmSettingsReal(settings, name, value) MpmSettingsRead(settings, name, MPM_AS_REAL, 1, 0, value)
#define MpmSettingsSwitch(settings, name, value) MpmSettingsRead(settings, name, MPM_AS_SWITCH, 1, 0, value)
PetscErrorCode MpmSettingsWord(const MpmSettings *settings, const char name[], PetscInt *index);
PetscErrorCode MpmSettingsSpan(const MpmSettings *settings, const char name[], MpmFraction span[2]);
PetscErrorCode MpmSettingsList(const MpmSettings *settings, const char name[], PetscInt room, PetscInt *n,
                               PetscInt list[]);
PetscErrorCode MpmSettingsReals(const MpmSettings *settings, const char name[], PetscInt room, PetscInt *n,
                                PetscReal list[]);
PetscErrorCode MpmSettingsWords(const MpmSettings *settings, const char name[], PetscInt room, PetscInt *n,
                                PetscInt index[]);

/* Not collective. Whether a text is two finite numbers or fractions lo,hi with lo < hi, and these. */
PetscBool MpmSettingsParseSpan(const char text[], MpmFraction span[2]);

/*
   Not collective. Whether an option, or another name, has a value, who gave it, and the value as text; its place in
   settings, MPM_NOT_AN_OPTION: nothing was said of it.
*/
PetscInt    MpmSettingsIndex(const MpmSettings *settings, const char name[]);
PetscBool   MpmSettingsGiven(const MpmSettings *settings, const char name[]);
MpmOrigin   MpmSettingsSource(const MpmSettings *settings, const char name[]);
const char *MpmSettingsText(const MpmSettings *settings, const char name[]);

/* Not collective. Whether the word stands there that an option allows in the place of a number. */
PetscBool MpmSettingsIsAlso(const MpmSettings *settings, const char name[]);

/*
   MpmSettingsFarthest - of the options that were given the one whose number is farthest from 1; it is to blame when a
   product of them is out of the range of doubles.

   Not collective. Of several that are as far the first in the list; the first of all when none was given. A number that
   is 0 is not to blame.
*/
const char *MpmSettingsFarthest(const MpmSettings *settings, PetscInt n, const char *const names[]);

/* Not collective. Whether a key of the scene file has lost its sense because the command line changed another. */
PetscBool MpmSettingsOverruled(const MpmSettings *settings, const char key[], const char by[]);

/*
   Collective. Reads the options that were given into the fields of a scene or a request that keep them as they stand.
   Some have a value for each of *dim directions. Of a scene dim is itself a field, which is read before these.
*/
PetscErrorCode MpmSettingsReadFields(const MpmSettings *settings, MpmOwner owner, const PetscInt *dim, void *object);

/*
   Collective. Reads mach for each direction, 0 where it is not given. Refuses a drift M k without a short period, and
   names the nearest Courant number that has one.
*/
PetscErrorCode MpmSettingsReadMach(const MpmSettings *settings, PetscInt dim, MpmMach *mach);
PetscErrorCode MpmSettingsCheckPeriod(const MpmSettings *settings, const MpmScene *scene, const MpmMach *mach);

/* Collective. As MpmSceneFromText; messages call the text by the name. */
PetscErrorCode MpmSceneFromNamedText(const char name[], const char yaml[], MpmScene **scene);

/* Collective. Checks and keeps the names of a request's files. */
PetscErrorCode MpmSettingsReadFiles(const MpmSettings *settings, MpmRequest *request);

/*
   MpmSettingsCheckTrust - refuses a scene that is merely read and would act: it names a program or a plugin, or files
   that are not below the current folder or not of its own kind. The option trust_scene, which must stand on the command
   line, lets it.

   Collective. Call it before anything that a scene names is used.
*/
PetscErrorCode MpmSettingsCheckTrust(const MpmSettings *settings);

/* Collective. Reads what a task is to do with a scene, and with a matrix in its place. */
PetscErrorCode MpmSettingsReadRequest(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request);
PetscErrorCode MpmSettingsReadMatrixRequest(MpmSettings *settings, MpmRequest *request);

/*
   MpmSettingsNameMatrix - whether a file with a matrix, or with the blocks of a lattice, takes the place of a scene.

   Collective. Refuses options of a scene beside it, options of a matrix without one, and tasks that need a scene.
*/
PetscErrorCode MpmSettingsNameMatrix(const MpmSettings *settings, const char task[], PetscBool *named);

/*
   Collective. Reads which program or plugin takes the place of a scene, and how it is probed.
*/
PetscErrorCode MpmSettingsReadProgram(const MpmSettings *settings, MpmRequest *request);

/* Not collective. Whether the files of a map have something of this name already, so that no axis may have it. */
PetscBool MpmSettingsIsOfMap(const char name[]);

/*
   Readers of parts of a scene, in the order in which scene.c calls them: each needs what those before it have read, and
   refuses what does not exist or does not go together.

   Given       - particles of the file that the option layout names, and Poisson's ratio where it alone has one
   WaveSpeed   - wave speed, whether the scene is in physical units, and the Poisson's ratio of bulk and shear modulus
   Kinematics  - finite deformation or not, and the gravity there
   Law         - the material and the stretch that a run starts from or a linear scheme is about, or its prestress; the
                 wave speed in that state
   Grid        - cells, particles in them, time step and drift
   Colliders, Bodies, Shape - rigid bodies; bodies of particles; the shape that particles fill
   PlaceGiven  - puts the particles of a file into the grid, and refuses those outside and options of sites
   Pace        - whether a run chooses its steps, and how large a part of the largest stable one they are
   CheckFinite - what else finite deformation asks for, with Solution: whether the initial data have an exact one, with
                 its body force and densities. Prestress: what a prestress asks for, whose particles must stay where
                 they are
   Damping     - damping and viscosity, from the units of the scene to those of a step
   Initial     - initial data, for which the table must be made; random ones in place of those that nobody asked for and
                 that have no exact solution

   Collective. The first rank reads a file; all refuse together.
*/
typedef PetscErrorCode MpmSceneReader(const MpmSettings *settings, MpmScene *scene);
MpmSceneReader         MpmSettingsReadGiven, MpmSettingsReadWaveSpeed, MpmSettingsReadKinematics, MpmSettingsReadLaw,
    MpmSettingsReadGrid, MpmSettingsReadColliders, MpmSettingsReadBodies, MpmSettingsReadShape, MpmSettingsPlaceGiven,
    MpmSettingsReadPace, MpmSettingsCheckFinite, MpmSettingsReadSolution, MpmSettingsReadPrestress,
    MpmSettingsReadDamping, MpmSettingsReadInitial;

/*
   Collective. Refuses an option that the scene's formulation cannot do. The message says what the formulation has none
   of, and names those that have.
*/
PetscErrorCode MpmSettingsRequire(const MpmSettings *settings, const MpmScene *scene, const char option[],
                                  PetscBool (*can)(const MpmFormulation *), const char what[]);

/* Not collective. Whether a formulation has MOVE_PROJECTED, without which there is no second P2G. */
PetscBool MpmFormulationIsProjected(const MpmFormulation *formulation);
