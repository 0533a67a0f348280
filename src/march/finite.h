/*
   Operations of finite deformation in a pass, and what goes wrong in them. A particle whose det F is not positive, that
   goes a cell or further in a step, or that leaves the domain ends the run in the step in which it does.
*/
#pragma once
#include "march/march_private.h"

/*E
   MpmFailureKind - what is wrong with a particle.
E*/
typedef enum { MPM_NO_FAILURE, MPM_INVERTED, MPM_TOO_FAST, MPM_NOT_RETURNED } MpmFailureKind;

/*S
   MpmWatch_ - what passes find out about the places of this rank's particles.

   range     - the least and the largest cell of each direction, after the last ADVANCE
   kind      - what is wrong with a particle, the first of those that failed
   particle  - its number on this rank
   way       - how far it would go, in cells
   viscosity - the largest artificial viscosity in the step (MpmMaterialViscous)
S*/
struct MpmWatch_ {
  PetscInt       range[MPM_MAX_DIM][2];
  MpmFailureKind kind;
  PetscInt       particle;
  PetscReal      way[MPM_MAX_DIM], viscosity;
};

/*S
   MpmFiniteBlock - the n particles from begin on, which go through an operation together. a: its number. to, from and
   stretch: the arrays of the fields that it writes and reads, which begin with these particles, and so do id, cell and
   xi. step: that of the places. mass, volume, stiffness: of the particles, or NULL where all are alike.
S*/
typedef struct {
  PetscInt          begin, n;
  PetscInt64        step;
  PetscReal         a;
  PetscReal        *to[MPM_MOST_STRETCH], *from[MPM_MOST_STRETCH], *stretch[MPM_MOST_STRETCH];
  PetscReal        *xi[MPM_MAX_DIM];
  PetscInt         *cell[MPM_MAX_DIM];
  const PetscInt64 *id;
  const PetscReal  *mass, *volume, *stiffness;
} MpmFiniteBlock;

/*S
   MpmSolving_ - the nonlinear system whose pass is run. stress: what STRESS_AHEAD does on a block of particles.
   product: the pass is a product with its tangent, in which body forces are 0.
S*/
struct MpmSolving_ {
  void (*stress)(void *system, const MpmFiniteBlock *block);
  void     *system;
  PetscBool product;
};

/*
   Not collective. The numbers of fields that an operation writes and reads; 0 of ADVANCE's places. stretch: of F
   besides. stretches: MpmTableStretches, or without the internal variables, which are in no map.
*/
typedef struct {
  PetscInt to, from, stretch;
} MpmFiniteWidth;
MpmFiniteWidth MpmFiniteWidthOf(MpmOpKind kind, PetscInt dim, PetscInt stretches);

/*
   Not collective. The gravity of the march's scene, and its body force on particle id, at its place at rest and at the
   time of a step and a part of the next one, in units of c^2 / h.
*/
void MpmFiniteLoad(const MpmMarch *march, PetscInt64 id, PetscInt64 step, PetscReal part, PetscReal load[]);

/* Not collective. Forgets ranges and failures, before a step. */
void MpmFiniteForget(MpmMarch *march);

/*
   MpmFiniteAgree - finds out on all ranks whether a particle has failed, and how far particles are beyond the cells of
   their ranks.

   Collective. After a failure march->failure says what has happened.
*/
PetscErrorCode MpmFiniteAgree(MpmMarch *march, PetscInt *beyond);

/*
   MpmFiniteFill - sets the particles to the scene's initial data: the uniform stretch, the drift as a velocity, and the
   velocity of a mode. noise: random numbers in [-noise, noise), hashed from seed and id, are added to x / h, v / c, to
   F relative to F0, and to an affine part.

   Collective. Errors: refuses (PETSC_ERR_USER_INPUT) a noise that moves a particle by a cell or more, or out of the
   domain.
*/
PetscErrorCode MpmFiniteFill(MpmMarch *march, PetscReal noise);

/*
   MpmFiniteEnergy - the energy of all particles, kinetic and stored, with that of an affine part: sum m D |C|^2 / 2.

   Collective. psi: room for a number of each particle of this rank. energy: in units of that of a particle, rho0 c^2.
*/
PetscErrorCode MpmFiniteEnergy(const MpmMarch *march, PetscReal psi[], PetscReal *energy);

/*
   MpmFiniteNorms - norms of the state.

   Collective. state is the root of the mean square, over particles, of what is left of x / h, v / c and F / F0 when the
   uniform motion that the scene starts from is taken out, and then the mean of x and v. grid is that of the nodal
   velocity and its increment, without the mean. energy is kinetic energy, strain energy and that in the gravity and in
   colliders that push, over the density at rest.
*/
PetscErrorCode MpmFiniteNorms(const MpmMarch *march, MpmNorms *norms);
