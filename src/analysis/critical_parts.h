/* The parts of MpmCriticalFind. */
#pragma once
#include <mpmstab/critical.h>

/*
   MpmCriticalAtRest, MpmCriticalUnderDrift - find the limit through the symbol, at rest and under drift.

   Collective. unstable: infinite for a search over all phases. Otherwise it is a Courant number at which phase beta is
   known to grow, and the search covers only what can be reached from there.
*/
PetscErrorCode MpmCriticalAtRest(const MpmCriticalCase *of, PetscReal unstable, PetscReal beta, MpmCritical *critical);
PetscErrorCode MpmCriticalUnderDrift(const MpmCriticalCase *of, PetscReal unstable, PetscReal beta,
                                     MpmCritical *critical);

/*
   Collective. Finds the limit through all eigenvalues of the assembled operator, and growth at the case's Courant
   number.
*/
PetscErrorCode MpmCriticalAssembled(const MpmCriticalCase *of, MpmCritical *critical);

/* A search for the first window of growth by following eigenvalues, up to a Courant number; what came of it. */
typedef struct {
  PetscReal  to, bracket[2], doubtful;
  PetscInt64 evaluations;
  PetscBool  done;
} MpmCriticalWay;

/*
   MpmCriticalFollow - follows the eigenvalues of the assembled operator upwards in the Courant number to way->to.

   Collective on PETSC_COMM_WORLD; the first rank does the work. done: whether it got there or found growth, else the
   operator is too large for that, or there was too much to look at. bracket: as of MpmFollowLine, where done.
*/
PetscErrorCode MpmCriticalFollow(const MpmCriticalCase *of, MpmCriticalWay *way);

/*
   MpmCriticalGrowthAt - finds growth and verdict at the case's Courant number, over all phases. beta: the phase that
   grows most.

   Collective. It takes the symbol at twice MPM_CRITICAL_PHASES phases. Where nothing grows there, it follows the
   symbol's amplification factors from phase to phase. The verdict is undecided where some of them could not be told
   apart.
*/
PetscErrorCode MpmCriticalGrowthAt(const MpmCriticalCase *of, MpmFinding *finding, PetscReal *beta);

/*
   MpmCriticalGrowthOfPhase, MpmCriticalRounding - growth per step of one phase at a Courant number, and the growth that
   rounding may make of a defective pair there.

   Not collective.
*/
PetscErrorCode MpmCriticalGrowthOfPhase(const MpmCriticalCase *of, PetscReal courant, PetscReal beta,
                                        PetscReal *growth);
PetscErrorCode MpmCriticalRounding(const MpmCriticalCase *of, PetscReal courant, PetscReal beta, PetscReal *growth);
