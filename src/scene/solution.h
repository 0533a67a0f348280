/* Exact solutions at finite strain, which the option initial names. Lengths and times are in the units of the scene. */
#pragma once
#include "scene/settings.h"

/*S
   MpmSolutionState - where a particle is, its velocity, and its deformation gradient since the start, row by row.
S*/
typedef struct {
  PetscReal place[MPM_MAX_DIM], velocity[MPM_MAX_DIM], stretch[MPM_MAX_DIM * MPM_MAX_DIM];
} MpmSolutionState;

/*S
   MpmSolution - an exact solution.

   initial   - the initial data that it belongs to
   law       - the material that it is of, where any is FALSE; of any solid where it is TRUE
   least, most - the numbers of dimensions that it exists in
   equations - as text
   density   - of a gas: errors are those of the density, and not of F, and places are not known
   exact     - the state at time t of the particle that rests at X at time 0 and is at x now. Solutions of solids know
               it by X, those of gases by x.
   force     - the body force that the solution needs, or NULL
   sizes     - what errors are relative to: of places, velocities, and F or density
   end       - until when it holds
   check     - refuses scenes that it is not of, and sets what else it needs

   Not collective: exact, force, sizes and end. Collective: check.
S*/
typedef struct {
  MpmInitial    initial;
  const MpmLaw *law;
  PetscBool     any;
  PetscInt      least, most;
  const char   *equations;
  PetscBool     density;
  void (*exact)(const MpmScene *scene, const PetscReal X[], const PetscReal x[], PetscReal t, MpmSolutionState *state);
  MpmBodyForce force;
  void (*sizes)(const MpmScene *scene, PetscReal size[3]);
  PetscReal (*end)(const MpmScene *scene);
  PetscErrorCode (*check)(const MpmSettings *settings, MpmScene *scene);
} MpmSolution;

/* Not collective. The exact solution of a scene at finite strain, or NULL. */
const MpmSolution *MpmSolutionOf(const MpmScene *scene);

/*
   MpmSolutionRegister - the exact value of state register r in the units of a march at finite strain. With stagger the
   field that lags has its value of half a time step before. Of an affine part it is the velocity's gradient, which
   differences find.

   Not collective. X and x are as in MpmSolution.
*/
PetscReal MpmSolutionRegister(const MpmScene *scene, PetscInt r, const PetscReal X[], const PetscReal x[], PetscReal t);

/*S
   MpmRiemann - the shock tube of a gas at constant temperature, of density 1 on the left and ratio < 1 on the right of
   the middle. Speeds are in units of the speed of sound.

   density, velocity - between the rarefaction and the shock
   shock             - the speed of the shock
S*/
typedef struct {
  PetscReal ratio, density, velocity, shock;
} MpmRiemann;

/* Not collective. Finds the state between the waves. */
MpmRiemann MpmRiemannSolve(PetscReal ratio);
