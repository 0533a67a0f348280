/* Scene: everything a task needs to know, checked and immutable. */
#pragma once
#include <mpmstab/basis.h>
#include <mpmstab/formulation.h>
#include <mpmstab/settings.h>
#include <mpmstab/verdict.h>

/*S
   MpmExpect - what a scene says must come out; has_* says which of them it says.
S*/
typedef struct {
  PetscBool     has_verdict, has_kind, has_growth, has_spectrum, has_error, has_energy;
  MpmVerdict    verdict;
  MpmGrowthKind kind;
  PetscReal     growth[2], spectrum[2], error[2], energy[2];
} MpmExpect;

/*S
   MpmScene - one problem. Units: length and time are the user's, everything else follows THEORY.md, section 1:
   courant k = c dt / h, drift delta = U0 dt / h in cells per step, offset and jitter in particle spacings.
S*/
typedef struct {
  const MpmFormulation *formulation;
  const MpmBasis       *basis;
  const char           *task, *transfer, *boundary, *layout;
  PetscInt              dim, cells, ppc, mode;
  PetscInt64            particles, seed, steps, output_every;
  PetscReal             length, cell_width, wave_speed, courant, dt, jitter, amplitude, tolerance;
  MpmFraction           offset, drift;
  MpmInitial            initial;
  PetscBool             stagger, has_progress, progress, measure;
  PetscInt              phases, modes;
  char                  output[PETSC_MAX_PATH_LEN], xmf[PETSC_MAX_PATH_LEN]; /* "": none */
  char                  json[PETSC_MAX_PATH_LEN], csv[PETSC_MAX_PATH_LEN], mode_file[PETSC_MAX_PATH_LEN];
  MpmExpect             expect;
} MpmScene;

/*
   MpmSceneCreate - reads and checks a scene for a task: file (NULL: none), then command line.

   Collective on PETSC_COMM_WORLD. Refuses bad input with one message (see errors.h).
*/
PetscErrorCode MpmSceneCreate(const char task[], const char path[], MpmScene **scene);
PetscErrorCode MpmSceneDestroy(MpmScene **scene);

/* Collective. The files a scene writes: each can be written, and no two are the same. Called by MpmSceneCreate. */
PetscErrorCode MpmSettingsFiles(const MpmSettings *settings, MpmScene *scene);

/* Not collective. Whether particles move against the grid. */
static inline PetscBool MpmSceneDrifts(const MpmScene *scene)
{
  return scene->drift.value != 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. The exact solution of the scene, for an amplitude of the caller's choice. */
MpmProfile MpmSceneProfile(const MpmScene *scene, PetscReal amplitude);

/*
   Not collective. The power of two that the state is divided by at the start, so that its largest field is of
   order 1 whatever the scene's units are. Values and errors take it back.
*/
PetscInt MpmSceneExponent(const MpmScene *scene);
