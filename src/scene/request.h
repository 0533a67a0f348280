/*
   Request: what a task is asked to do with a scene. It has the number of steps, the files, the tolerance, what is
   measured, and what must come out.
*/
#pragma once
#include "base/progress.h"
#include "scene/mach.h"
#include <mpmstab/scene.h>
#include <mpmstab/verdict.h>
#include <string.h>

/*S
   MpmExpect - what a scene says must come out; has_verdict, has_kind and has say which of these it says. Ranges of
   numbers are lo, hi, in the order of MpmExpectOptions.
S*/
typedef enum {
  MPM_EXPECT_GROWTH,
  MPM_EXPECT_SPECTRUM,
  MPM_EXPECT_ERROR,
  MPM_EXPECT_ENERGY,
  MPM_EXPECT_CRITICAL,
  MPM_EXPECT_SHARE,
  MPM_EXPECTED
} MpmExpected;
extern const char *const MpmExpectOptions[MPM_EXPECTED];

typedef struct {
  PetscBool     has_verdict, has_kind, has[MPM_EXPECTED];
  MpmVerdict    verdict;
  MpmGrowthKind kind;
  PetscReal     range[MPM_EXPECTED][2];
} MpmExpect;

/*S
   MpmAxis - one axis of a map: points numbers at equal distances from one to another. They are exact fractions where
   these have short terms. The angle of the drift is in degrees, from x to y. A parameter is one
   of the scheme's, by its number; other kinds have MPM_NONE there. name: as map_axes has it.
S*/
typedef enum {
  MPM_AXIS_COURANT,
  MPM_AXIS_DRIFT,
  MPM_AXIS_OFFSET,
  MPM_AXIS_PPC,
  MPM_AXIS_POISSON,
  MPM_AXIS_DRIFT_ANGLE,
  MPM_AXIS_MACH,
  MPM_AXIS_PARAMETER
} MpmAxisKind;
extern const char *const MpmAxisNames[];

typedef struct {
  MpmAxisKind kind;
  MpmFraction from, to;
  PetscInt    points, parameter;
  char        name[32];
} MpmAxis;

/*E
   MpmProbeKind - how a program or plugin is probed (see probe/probe.h). MPM_PROBE_ANY: it was not said.
E*/
typedef enum { MPM_PROBE_BLOCH, MPM_PROBE_COLOURED, MPM_PROBE_MATRIX_FREE, MPM_PROBE_ANY } MpmProbeKind;
extern const char *const MpmProbeNames[];

/*E
   MpmTangentKind - the perturbation that goes with a run: none, random numbers, or a velocity like the mode of the
                    scene.
E*/
typedef enum { MPM_TANGENT_NONE, MPM_TANGENT_RANDOM, MPM_TANGENT_MODE } MpmTangentKind;
extern const char *const MpmTangentNames[];

/*E
   MpmNeighbourhoodKind - MPM_IN_BULK: the scene as it is. MPM_AT_EDGE: a half-space of its lattice; MPM_AT_CORNER: a
   quarter-space. Their free surfaces go through the grid. MPM_ALONE: one particle. MPM_AT_RANDOM: layouts with voids.
   MPM_DISORDERED: random layouts of as many particles as the lattice has.
   MPM_AT_WORST: the layout of the least limit that a search over places and numbers of particles finds.
E*/
typedef enum {
  MPM_IN_BULK,
  MPM_AT_EDGE,
  MPM_AT_CORNER,
  MPM_ALONE,
  MPM_AT_RANDOM,
  MPM_DISORDERED,
  MPM_AT_WORST,
  MPM_NEIGHBOURHOODS
} MpmNeighbourhoodKind;

/* The words of the option. The last one, all, stands after those of the kinds. */
extern const char *const MpmNeighbourhoodNames[];

#define MPM_MATRIX_MOST_STEPS 1000000 /* that a matrix from a file covers */
#define MPM_MAX_DIVISORS 16

/*S
   MpmRequest - what a task is asked to do with its scene. Tasks read what concerns them.
S*/
typedef struct {
  const char *task; /* its name */

  /* of a run: it writes output_every and checkpoint_every so many steps, and at the last one; with an output_interval
     above 0 it writes output after this time. end: of a run that chooses its steps, the time at which it ends; 0: it ends
     after its steps */
  PetscInt64 steps, output_every, checkpoint_every;
  PetscReal  output_interval, end;
  PetscBool  weights, source_term, ringing; /* what it measures besides (march/transfer_diagnostics.h) */
  /* the perturbations beside it (analysis/tangents.h) */
  MpmTangentKind tangent;
  PetscInt       window, exponents;
  PetscReal      warn_above;
  PetscInt64     at_step; /* at kinematics finite, the step of the run whose tangent spectrum takes */

  PetscReal tolerance;         /* growth per step above 1 + tolerance is unstable */
  PetscReal step_bound_chance; /* of the certificate (mpmstab/step_bound.h) */
  PetscInt  step_bound_sweeps; /* beyond bound 'particle' */

  /* of a symbol: phases in each direction, and how many numbers of them were given; whether also the largest growth
     over all phases is sought, and how waves are damped, at the time step over each of the divisors */
  PetscInt  phases[MPM_MAX_DIM], given_phases, ndivisors, divisors[MPM_MAX_DIVISORS];
  PetscBool refine, damping;
  MpmAxis   axes[2]; /* of a map */

  /* of a spectrum: eigenvectors that it writes; steps of powers, and points along a side of the pseudospectrum, 0: it
     does without; whether it also marches random data; whether eigenvalues are sought of the nodes' operator, where there
     is one, and whether that was given */
  PetscInt  modes, powers, pseudospectrum;
  PetscBool measure, nodal, nodal_asked;

  /* of critical: whether it goes through all schemes, prints symbols at the limit, and adds a table of the largest steps
     by layout, since none was asked for, or why it does not */
  PetscBool   survey, verbose, table;
  const char *no_table;
  PetscBool   neighbourhood[MPM_NEIGHBOURHOODS]; /* those that critical and spectrum look at */
  PetscReal   voids;                             /* the share of sites without a particle in neighbourhood random */
  PetscInt    layouts; /* how many random layouts an ensemble, or neighbourhood random or disordered, has */
  /* whether mach was given and particles move, and what was given: critical keeps it while the Courant number changes,
     and so does a map over the Courant number */
  PetscBool at_mach;
  MpmMach   mach;

  /* of a matrix or blocks: steps that they cover, 0 if that is not said */
  PetscInt matrix_steps;
  /* of a code: how it is probed, and seconds in which it must answer; steps that are probed together, 0 if that is not
     said; steps that growth is measured over; cells a step that its particles are set along, or with program_mach Mach
     numbers, whose first den is 0 where nothing was said */
  MpmProbeKind probe;
  PetscReal    program_timeout;
  PetscInt     program_period, program_run;
  MpmFraction  program_drift[MPM_MAX_DIM];
  PetscBool    program_mach;

  MpmProgressWish progress;
  MpmExpect       expect;

  /* what takes the place of a scene: a file with a matrix, or with the blocks of a lattice; the command of a code, or its
     library */
  char matrix[PETSC_MAX_PATH_LEN], matrix_blocks[PETSC_MAX_PATH_LEN], program[PETSC_MAX_PATH_LEN];
  char plugin[PETSC_MAX_PATH_LEN];
  /* of a code: parameters that are set; what is added to fields; keys of the scene whose particles it is given; the
     parameter that is the time step; steps after which it is probed; keys of a scene that it is compared with */
  char program_set[PETSC_MAX_PATH_LEN], program_base[PETSC_MAX_PATH_LEN], program_scene[PETSC_MAX_PATH_LEN];
  char program_dt[PETSC_MAX_PATH_LEN], at[PETSC_MAX_PATH_LEN], compare[PETSC_MAX_PATH_LEN];
  /* names of files, "" for none; xmf describes the output of a run, and mode_file has the data that a run starts from
     with initial eigenmode */
  char output[PETSC_MAX_PATH_LEN], xmf[PETSC_MAX_PATH_LEN], json[PETSC_MAX_PATH_LEN], csv[PETSC_MAX_PATH_LEN];
  char mode_file[PETSC_MAX_PATH_LEN], checkpoint[PETSC_MAX_PATH_LEN], restart[PETSC_MAX_PATH_LEN];
  char write_matrix[PETSC_MAX_PATH_LEN], write_blocks[PETSC_MAX_PATH_LEN], write_layout[PETSC_MAX_PATH_LEN];
} MpmRequest;

/* Not collective. The file, command or library that takes the place of a scene. */
static inline const char *MpmRequestSource(const MpmRequest *request)
{
  const char *const names[] = {request->matrix, request->matrix_blocks, request->program, request->plugin};
  int               i       = 0;

  while (i < 3 && !names[i][0]) i++;
  return names[i];
}

/* Not collective. Whether a code that is probed takes the place of a scene. */
static inline PetscBool MpmRequestProbes(const MpmRequest *request)
{
  return request->program[0] || request->plugin[0] ? PETSC_TRUE : PETSC_FALSE;
}

/*
   MpmRequestPhases - the phases in each direction of the symbol of blocks: those that were given, one number for all
   directions or one for each, or else as many as suit the dimension.

   Collective. Errors: refuses another number of them.
*/
PetscErrorCode MpmRequestPhases(const MpmRequest *request, PetscInt dim, PetscInt phases[]);

/* Not collective. Whether the request is for a map that goes over this. */
static inline PetscBool MpmRequestVaries(const MpmRequest *request, MpmAxisKind kind)
{
  return !strcmp(request->task, "map") && (request->axes[0].kind == kind || request->axes[1].kind == kind)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* Not collective. Whether the request is for a map that keeps a Mach number at each point: its drift then is M k. */
static inline PetscBool MpmRequestKeepsMach(const MpmRequest *request)
{
  if (MpmRequestVaries(request, MPM_AXIS_MACH)) return PETSC_TRUE;
  return request->at_mach && MpmRequestVaries(request, MPM_AXIS_COURANT) && !MpmRequestVaries(request, MPM_AXIS_DRIFT)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/*
   MpmSceneCreate - reads a scene and what a task is to do with it: a YAML file (NULL: none), then the command line in
   PETSc's database of options.

   Collective on PETSC_COMM_WORLD. Refuses bad input with one message (see errors.h). request NULL: not wanted. Destroy
   the scene with MpmSceneDestroy; a request holds nothing that needs it. *scene is NULL where the options name a
   matrix, or blocks of a lattice, in its place; request then has their file.
*/
PetscErrorCode MpmSceneCreate(const char task[], const char path[], MpmScene **scene, MpmRequest *request);
