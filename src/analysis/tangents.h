/* The tangent along a nonlinear run: how small perturbations of its state grow. */
#pragma once
#include "operator/tangent.h"
#include "scene/request.h"
#include <slepcbv.h>

/*S
   MpmTangentWindow - what small perturbations can do in some steps.

   step  - the number of the last step
   steps - the number of steps: those of a whole window, or a part of it from its beginning
   norm  - the largest growth of any perturbation over these steps: the largest singular value of the product of the
           tangents. NaN where the solver did not converge.
   waves - c t / h of these steps: how many cells waves travel in them, with the largest speed of any particle
S*/
typedef struct {
  PetscInt64 step;
  PetscInt   steps;
  PetscReal  norm, waves;
} MpmTangentWindow;

/*S
   MpmTangents - perturbations that go with a run.

   Perturbations are measured in x / h, v / c and F / F0, where c is the wave speed that the Courant number has and F0
   the stretch at the start: their norm is the square root of the sum of the squares over all particles.

   window, exponents - the steps of a window, and the number of perturbations that are followed
   steps      - the number of steps that they have been followed
   log_growth - log_growth[i]: the sum of the logarithms of the growth of perturbation i in each step, where what lies
                in the directions of those before it is taken away (QR)
   nwindows, at - the windows and their parts: of 5 steps from the beginning of a window, 10, 20 and so on
   warned     - how many of them had a warning, and first, last: the last steps of the first and the last of these
   largest    - the one with the largest excess, and excess: its norm / (1 + waves)
   room       - the least MpmTangentRoom of all steps
   on_surface - the sum of MpmTangentSpace's of all steps
   bytes      - of the tangents of a window, on all ranks together
S*/
typedef struct {
  MpmTangentSpace   space;
  MpmTangentState   state;
  PetscInt          window, exponents, nheld, next, nwindows, most, warned;
  PetscInt64        steps, first, last, on_surface;
  PetscReal        *log_growth, warn_above, waves, excess, room, bytes;
  MpmTangentWindow  largest;
  Mat              *held;
  Vec               scale, unscale;
  BV                perturbation;
  MpmTangentWindow *at;
} MpmTangents;

/*
   MpmTangentsCreate - begins to follow perturbations of a march's present state.

   Collective on PETSC_COMM_WORLD, with SLEPc initialized. Of the request it reads tangent, window, exponents and
   warn_above. The march must have a scene of finite kinematics.
*/
PetscErrorCode MpmTangentsCreate(const MpmMarch *march, const MpmRequest *request, MpmTangents **tangents);

/*
   MpmTangentsStep - takes the perturbations through the step that the march takes next. At the end of a window, and of
   its parts, it finds the largest growth, and prints a warning where this is more than warn_above (1 + waves).

   Collective.
*/
PetscErrorCode MpmTangentsStep(MpmTangents *tangents, const MpmMarch *march);
PetscErrorCode MpmTangentsDestroy(MpmTangents **tangents);
