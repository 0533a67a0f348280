/* Scene: everything a task needs to know, checked and immutable. */
#pragma once
#include "base/progress.h"
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>
#include "scene/settings.h"
#include <mpmstab/verdict.h>

/*S
   MpmExpect - what a scene says must come out; has_* says which of them it says.
S*/
typedef struct {
  PetscBool     has_verdict, has_kind, has_growth, has_spectrum, has_error, has_energy, has_critical, has_share;
  MpmVerdict    verdict;
  MpmGrowthKind kind;
  PetscReal     growth[2], spectrum[2], error[2], energy[2], critical[2], share[2];
} MpmExpect;

/*S
   MpmAxis - what a map goes over along one of its axes: points equally spaced numbers, fractions where they have short
   terms.
S*/
typedef enum { MPM_AXIS_COURANT, MPM_AXIS_DRIFT, MPM_AXIS_OFFSET, MPM_AXIS_PPC } MpmAxisKind;
extern const char *const MpmAxisNames[];

typedef struct {
  MpmAxisKind kind;
  MpmFraction from, to;
  PetscInt    points;
} MpmAxis;

/*S
   MpmScene - one problem. Units: length and time are the user's, everything else follows THEORY.md, section 1.

   layout, scheme and step are what the readers of a table take: march, operator and symbol. cell_width h, wave_speed c
   and dt turn their numbers, which are in cells and steps, into the user's units.
S*/
typedef struct {
  MpmLayout       layout;
  MpmScheme       scheme;
  MpmStep         step;
  const char     *task;
  char            boundary[64];
  PetscInt        dim, mode;
  PetscInt64      steps, output_every, checkpoint_every;
  PetscReal       length, cell_width, wave_speed, dt, amplitude, tolerance;
  MpmInitial      initial;
  PetscBool       stagger, measure, survey, weights, source_term, ringing;
  MpmProgressWish progress;
  PetscInt        phases, modes, layouts, powers, pseudospectrum; /* powers, pseudospectrum 0: none */
  MpmAxis         axes[2];
  char            output[PETSC_MAX_PATH_LEN], xmf[PETSC_MAX_PATH_LEN]; /* "": none */
  char            json[PETSC_MAX_PATH_LEN], csv[PETSC_MAX_PATH_LEN], mode_file[PETSC_MAX_PATH_LEN];
  char            checkpoint[PETSC_MAX_PATH_LEN], restart[PETSC_MAX_PATH_LEN];
  MpmExpect       expect;
} MpmScene;

/*
   MpmSceneCreate - reads and checks a scene for a task: file (NULL: none), then command line.

   Collective on PETSC_COMM_WORLD. Refuses bad input with one message (see errors.h).
*/
PetscErrorCode MpmSceneCreate(const char task[], const char path[], MpmScene **scene);
PetscErrorCode MpmSceneDestroy(MpmScene **scene);

/*
   Collective. How particles are renewed, where they are, and what holds at the ends: refuses what does not exist, and
   makes the table. Called by MpmSceneCreate.
*/
PetscErrorCode MpmSettingsScheme(const MpmSettings *settings, MpmScene *scene);

/* Collective. Refuses an option, and says why, when the scene's formulation cannot; names those that can. */
PetscErrorCode MpmSettingsRequire(const MpmSettings *settings, const MpmScene *scene, const char option[],
                                  PetscBool (*can)(const MpmFormulation *), const char why[]);

/* Collective. How many particles there are in which cells, and where in them. Called by MpmSceneCreate. */
PetscErrorCode MpmSettingsLayout(const MpmSettings *settings, MpmScene *scene);

/* Collective. What must come out. Called by MpmSceneCreate, when initial data are known. */
PetscErrorCode MpmSettingsExpect(const MpmSettings *settings, const MpmScene *scene, MpmExpect *expect);

/* Collective. What a map goes over. Called by MpmSceneCreate for the task map. */
PetscErrorCode MpmSettingsAxes(const MpmSettings *settings, MpmScene *scene);

/* Collective. What particles are made of, once the table is there. Called by MpmSceneCreate. */
PetscErrorCode MpmSettingsMaterial(const MpmSettings *settings, MpmScene *scene);

/* Collective. The files a scene writes: each can be written, and no two are the same. Called by MpmSceneCreate. */
PetscErrorCode MpmSettingsFiles(const MpmSettings *settings, MpmScene *scene);

/* Not collective. Whether particles move against the grid. */
static inline PetscBool MpmSceneDrifts(const MpmScene *scene)
{
  return MpmStepDrifts(&scene->step);
}

/* Not collective. Whether the domain has no ends. */
static inline PetscBool MpmSceneIsPeriodic(const MpmScene *scene)
{
  return MpmLayoutIsPeriodic(&scene->layout);
}

/* Not collective. Whether every cell has its particles. */
static inline PetscBool MpmSceneIsFull(const MpmScene *scene)
{
  return MpmLayoutIsFull(&scene->layout);
}

/*
   Not collective. Whether the solution of the scene's continuous problem is known: from such initial data, in a domain
   filled from end to end, or a bar from the left end to a free one somewhere inside.
*/
PetscBool MpmSceneHasExact(const MpmScene *scene);

/* Not collective. The exact solution of the scene, for an amplitude of the caller's choice. */
MpmProfile MpmSceneProfile(const MpmScene *scene, PetscReal amplitude);

/* Not collective. The numbers of particles in the cells that repeat, with commas between them. */
#define MPM_COUNTS_TEXT (8 * MPM_MAX_COUNTS)
PetscErrorCode MpmSceneCountsText(const MpmScene *scene, size_t room, char text[]);

/*
   Not collective. The power of two that the state is divided by at the start, so that its largest field is of
   order 1 whatever the scene's units are. Values and errors take it back.
*/
PetscInt MpmSceneExponent(const MpmScene *scene);
