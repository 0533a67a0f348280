/*
   Request: what a task is asked to do with a scene. It has the number of steps, the files, the tolerance, what is
   measured, and what must come out.
*/
#pragma once
#include "base/progress.h"
#include <mpmstab/scene.h>
#include <mpmstab/verdict.h>
#include <string.h>

/*S
   MpmExpect - what a scene says must come out; the has_* say which of these it says. Ranges are lo, hi.
S*/
typedef struct {
  PetscBool     has_verdict, has_kind, has_growth, has_spectrum, has_error, has_energy, has_critical, has_share;
  MpmVerdict    verdict;
  MpmGrowthKind kind;
  PetscReal     growth[2], spectrum[2], error[2], energy[2], critical[2], share[2];
} MpmExpect;

/*S
   MpmAxis - one axis of a map: points numbers at equal distances from one to another. They are exact fractions where
   these have short terms. The angle of the drift is in degrees, from x to y.
S*/
typedef enum {
  MPM_AXIS_COURANT,
  MPM_AXIS_DRIFT,
  MPM_AXIS_OFFSET,
  MPM_AXIS_PPC,
  MPM_AXIS_POISSON,
  MPM_AXIS_DRIFT_ANGLE
} MpmAxisKind;
extern const char *const MpmAxisNames[];

typedef struct {
  MpmAxisKind kind;
  MpmFraction from, to;
  PetscInt    points;
} MpmAxis;

#define MPM_MAX_DIVISORS 16

/*S
   MpmRequest - what a task is asked to do with its scene. Tasks read what concerns them.

   task              - its name
   steps             - of a run; it writes output_every and checkpoint_every so many steps, and at the last one
   tolerance         - growth per step above 1 + tolerance is unstable
   weights, source_term, ringing - what a run measures besides (see march/transfer_diagnostics.h)
   phases            - at which symbol and map take the symbol, in each direction
   modes             - eigenvectors that spectrum writes
   measure           - whether spectrum also marches random data
   powers, pseudospectrum - steps, and points along a side, that spectrum takes; 0: it does without
   survey            - whether critical goes through all schemes
   layouts           - how many random layouts an ensemble has
   damping, ndivisors, divisors - whether symbol also finds how waves are damped, and by what it divides the time step
   axes              - of a map
   output ... restart - names of files, "" for none; xmf describes the output of a run, mode_file holds its initial data
                       when initial is eigenmode
S*/
typedef struct {
  const char     *task;
  PetscInt64      steps, output_every, checkpoint_every;
  PetscReal       tolerance;
  PetscBool       weights, source_term, ringing, measure, survey, damping;
  PetscInt        phases[MPM_MAX_DIM], modes, layouts, powers, pseudospectrum;
  PetscInt        ndivisors, divisors[MPM_MAX_DIVISORS];
  MpmProgressWish progress;
  MpmAxis         axes[2];
  MpmExpect       expect;
  char            output[PETSC_MAX_PATH_LEN], xmf[PETSC_MAX_PATH_LEN], json[PETSC_MAX_PATH_LEN];
  char            csv[PETSC_MAX_PATH_LEN], mode_file[PETSC_MAX_PATH_LEN], checkpoint[PETSC_MAX_PATH_LEN];
  char            restart[PETSC_MAX_PATH_LEN];
} MpmRequest;

/* Not collective. Whether the request is for a map that goes over this. */
static inline PetscBool MpmRequestVaries(const MpmRequest *request, MpmAxisKind kind)
{
  return !strcmp(request->task, "map") && (request->axes[0].kind == kind || request->axes[1].kind == kind)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/*
   MpmSceneCreate - reads a scene and what a task is to do with it: a YAML file (NULL: none), then the command line in
   PETSc's database of options.

   Collective on PETSC_COMM_WORLD. Refuses bad input with one message (see errors.h). request NULL: not wanted.
   Destroy the scene with MpmSceneDestroy; a request holds nothing that needs it.
*/
PetscErrorCode MpmSceneCreate(const char task[], const char path[], MpmScene **scene, MpmRequest *request);
