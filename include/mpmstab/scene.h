/*
   Scene: one problem, its physics and its numerics. It is checked when it is made and never changed afterwards. A
   task's own settings (how many steps, which files, what must come out) are no part of it.
*/
#pragma once
#include <mpmstab/errors.h>
#include <mpmstab/layout.h>
#include <mpmstab/material.h>
#include <mpmstab/scheme.h>

/* The words of the option kinematics: small or finite deformation. */
extern const char *const MpmKinematicsNames[];

typedef struct MpmScene_ MpmScene;

/*
   MpmBodyForce - a force per mass, in length / time^2, on the particle that rests at X at time t. X and force have a
   number for each direction.

   Not collective.
*/
typedef void (*MpmBodyForce)(const MpmScene *scene, const PetscReal X[], PetscReal t, PetscReal force[]);

/*E
   MpmStepBound - the bounds of a step that a run chooses (mpmstab/step_bound.h); the words of the option step_bound
E*/
typedef enum { MPM_STEP_LANCZOS, MPM_STEP_PARTICLE, MPM_STEP_LONE } MpmStepBound;
extern const char *const MpmStepBoundNames[];

/*S
   MpmScene_ - one problem. Length and time are in units of the user's choice; everything else follows from them
   (docs/theory.md, section 1).

   layout, scheme, step - the arguments of march, operator and symbol; they are in units of cells and steps
   boundary             - the conditions at the ends, as text
   length, cell_width   - of the domain in each direction, and of a cell, in units of length
   wave_speed, dt       - c in length / time, and the time step
   density              - of the material; 0: not given, and nothing depends on it
   physical             - the user gave units: density, a modulus, sound_speed, cell_width or dt
   has_step             - the user gave a time step or a Courant number; else they are those of the default
   safety               - 0: all steps are alike. Else a run chooses each step, and takes this part of the largest
                          stable one; step and dt are then those of the default Courant number.
   step_bound, watched  - the bound of the largest stable step that such a run takes; watched: with a number for
                          courant, the steps of a run are compared with it
   initial, mode, amplitude - the initial data, the number of waves of their Fourier mode in each direction, and their
                          size. With initial data eigenmode mode[0] is the number of the eigenvector.
   polarisation         - which way the material moves in a mode
   stagger              - the field that is updated first starts half a step early
   written, own         - a scheme as text, and the formulation that was made of it; NULL where a formulation is named
   law, stretch         - the material, and the stretch F0 in each direction that the scheme is linear about. They give
                          the prestress (MpmSpace) and the wave speed in the stretched state.
   lame_ratio, exponent - lambda / mu of neo, and the exponent of tait and polytropic
   plastic              - the numbers of the material, in the units that the user gave
   gravity, body_force - at finite deformation, forces per mass: uniform, in length / time^2; and one that depends on
                          place and time, or NULL
   colliders, bodies      - the rigid bodies of the layout, and those of its particles, as text; "" without any
   grid_damping, viscosity, shear_viscosity, bulk_viscosity - alpha per time, and the viscosities, in the units that the
                          user gave: those of the scene where it is physical, else c / h and rho c h
   artificial           - C1 and C2 of the artificial viscosity
   scheme_hash, parameters - what tells the written scheme from others, and the values of its parameters; "" without one
S*/
struct MpmScene_ {
  MpmLayout       layout;
  MpmScheme       scheme;
  MpmStep         step;
  char            boundary[128];
  PetscInt        mode[MPM_MAX_DIM];
  PetscReal       length[MPM_MAX_DIM], cell_width, wave_speed, dt, safety, density, amplitude;
  MpmInitial      initial;
  MpmStepBound    step_bound;
  PetscBool       stagger, physical, has_step, watched;
  MpmPolarisation polarisation;
  MpmWritten     *written;
  MpmFormulation *own;
  char            scheme_hash[17], parameters[512], colliders[512], bodies[512];
  const MpmLaw   *law;
  PetscReal       stretch[MPM_MAX_DIM], lame_ratio, exponent, plastic[MPM_PLASTIC_NUMBERS];
  PetscReal       gravity[MPM_MAX_DIM], grid_damping, viscosity, shear_viscosity, bulk_viscosity, artificial[2];
  MpmBodyForce    body_force;
};

/*
   MpmSceneFromText - makes a scene from YAML text: the keys that 'mpmstab list options' prints, one 'key: value' a line
   or all in braces, such as "{formulation: usl, cells: 16, ppc: 2}".

   Collective on PETSC_COMM_WORLD: every rank gives the same text.

   The key scheme may hold a scheme as text instead of the name of a formulation (docs/theory.md, section 3).

   Keys that are not given have their defaults. The command line is not read. Keys that belong to a task (steps, output,
   tolerance) must exist, and their values are not looked at.

   Errors: PETSC_ERR_USER_INPUT, with a message that names the key, its value and what is allowed; *scene is then NULL.
*/
PetscErrorCode MpmSceneFromText(const char yaml[], MpmScene **scene);

/*
   MpmSceneFromFile - makes a scene from a YAML file, as MpmSceneFromText does from a text.

   Collective on PETSC_COMM_WORLD. The first rank reads the file.
*/
PetscErrorCode MpmSceneFromFile(const char path[], MpmScene **scene);

/* Not collective. Frees a scene and sets the pointer to NULL. */
PetscErrorCode MpmSceneDestroy(MpmScene **scene);

/*
   MpmSceneIsPhysical - whether the scene is in physical units: density, a modulus, sound_speed, cell_width or dt is
   given. Reports then have times and speeds in these units beside Courant numbers and drifts.

   Not collective.
*/
static inline PetscBool MpmSceneIsPhysical(const MpmScene *scene)
{
  return scene->physical;
}

/*
   MpmSceneHasStep - whether the scene's own time step is one to answer for. That of a scene in physical units is not,
   when neither dt nor courant is given: the default Courant number says nothing of the user's time step.

   Not collective.
*/
static inline PetscBool MpmSceneHasStep(const MpmScene *scene)
{
  return !scene->physical || scene->has_step ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. The time step k h / c of a Courant number k, in the scene's unit of time. */
static inline PetscReal MpmSceneTimeStep(const MpmScene *scene, PetscReal courant)
{
  return courant * scene->cell_width / scene->wave_speed;
}

/* Not collective. Whether particles move relative to the grid. */
static inline PetscBool MpmSceneDrifts(const MpmScene *scene)
{
  return MpmStepDrifts(&scene->step);
}

/* Not collective. Whether a step of a run changes the places of particles: by the drift, or at finite deformation. */
static inline PetscBool MpmSceneMoves(const MpmScene *scene)
{
  return MpmSceneDrifts(scene) || scene->scheme.space.finite ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. Whether the domain has no ends. */
static inline PetscBool MpmSceneIsPeriodic(const MpmScene *scene)
{
  return MpmLayoutIsPeriodic(&scene->layout);
}

/* Not collective. Whether there is a particle at every site, and a site in every cell. */
static inline PetscBool MpmSceneIsFull(const MpmScene *scene)
{
  return MpmLayoutIsFull(&scene->layout);
}

/*
   Not collective. Whether Poisson's ratio counts: the formulation has a stress, and there is more than one dimension.
*/
PetscBool MpmSceneHasPoisson(const MpmScene *scene);

/*
   Not collective. Whether pic_filter counts: the formulation has both places for a filter, and the transfer has a
   filter.
*/
PetscBool MpmSceneChoosesFilter(const MpmScene *scene);

/*
   MpmSceneHasExact - whether the exact solution of the scene's continuous problem is known.

   Not collective. It is known from initial data mode, pulse and step, for particles that are all alike, in a domain
   that is filled from end to end, or in one dimension for a bar from the left end to a free end inside the domain.
*/
PetscBool MpmSceneHasExact(const MpmScene *scene);

/*
   MpmSceneErrorFields - returns the number of the fields that have an error against the exact solution, and their
   names: the particle fields, and at finite strain also the places, x, y and z. Of a gas the density, rho, takes the
   place of places and F.

   Not collective. The scene must have an exact solution. name has room for MPM_MOST_ERRORS.
*/
#define MPM_MOST_ERRORS (MPM_MAX_FIELDS + MPM_MAX_DIM)
PetscInt MpmSceneErrorFields(const MpmScene *scene, const char *name[]);

/* Not collective. The equations that an exact solution of the scene satisfies, as text. */
const char *MpmSceneEquations(const MpmScene *scene);

/*
   MpmSceneProfile - the exact solution of the scene, for an amplitude of the caller's choice.

   Not collective. A mode is a plane wave in a periodic domain. Between ends it is a standing wave. There is none, and
   nwaves is 0, where the ends of several directions do not go together:

     a scalar (elastic)   there is one between any ends
     gas, P waves         between ends of symmetry; along one direction also between fixed and free ends of that one
     S waves              the same, and no ends in a direction that the material moves in but the wave does not go
*/
MpmProfile MpmSceneProfile(const MpmScene *scene, PetscReal amplitude);

/*
   MpmSceneExact - the exact value of state register r at (X, t). With stagger the field that lags has its value of half
   a time step before.

   Not collective. The scene must have an exact solution, and profile be one of its profiles.
*/
PetscReal MpmSceneExact(const MpmScene *scene, const MpmProfile *profile, PetscInt r, const PetscReal X[], PetscReal t);

/* Not collective. The numbers of particles in the cells of the pattern, as text with commas between them. */
#define MPM_COUNTS_TEXT (8 * MPM_MAX_COUNTS)
void MpmSceneCountsText(const MpmScene *scene, size_t room, char text[]);

/*
   MpmSceneExponent - the exponent of the power of two by which a run divides the state at its start, so that its
   largest field is of order 1 in any units.

   Not collective. Values and errors that are printed are multiplied by that power again.
*/
PetscInt MpmSceneExponent(const MpmScene *scene);
