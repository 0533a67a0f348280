/*
   A code in uniform motion: its particles are set to each place of a period, a step is probed there, and the product of
   these operators is that of the period,

     G(beta) = G_T-1(beta) ... G_1(beta) G_0(beta).

   Blocks are those of the particles' own cells, which move with them. Places need no uniform velocity: of a step that
   does not depend on the frame it changes nothing.
*/
#pragma once
#include "probe/program.h"

#define MPM_MOTION_LONGEST 128 /* steps of a period */

/*S
   MpmMotion - a drift, in cells a step, and the operators of n steps of a period, with both sizes of perturbations;
   blocks: theirs, once more, as a symbol takes them. start: the base state.

   courant - of the long waves of the code, where it was asked for by a Mach number; else NaN
S*/
typedef struct {
  MpmFraction drift[MPM_MAX_DIM];
  PetscInt    n;
  PetscReal   courant, *start;
  MpmProbed   probed[2][MPM_MOTION_LONGEST];
  MpmBlocks   blocks[2][MPM_MOTION_LONGEST];
} MpmMotion;

/*
   MpmMotionBegin - takes the drift that a request names; a Mach number is one over the Courant number of the code's
   long waves, for which a cell is probed. MpmMotionFind - probes the steps of the period. certificates: of each place
   the one that holds least.

   Collective. The program must be prepared. Errors: PETSC_ERR_USER_INPUT where the code has no places, moves by
   itself, or a period is too long.

   MpmMotionGoTo - sets particles to their places after n steps, and looks at them there. MpmMotionReturn - sets them to
                   the start.
   MpmMotionJoin - what nothing reads at any place is set apart: one is another place's. The last two are not
                   collective.
*/
PetscErrorCode MpmMotionBegin(MpmProgram *program, MpmMotion *motion);
PetscErrorCode MpmMotionFind(MpmProgram *program, MpmMotion *motion);
PetscErrorCode MpmMotionDestroy(MpmMotion *motion);
PetscErrorCode MpmMotionGoTo(MpmProgram *program, const MpmMotion *motion, PetscInt n);
PetscErrorCode MpmMotionReturn(MpmProgram *program, const MpmMotion *motion);
void           MpmMotionJoin(const MpmUnread *one, MpmUnread *all);

/*
   MpmMotionSource - the operator of the period, with either size of perturbations, as a source of a symbol, which steps
                     must outlive. Not collective.
   MpmMotionMatrix - the same of all particles. MpmMotionJudgeWaves - as MpmProgramJudgeWaves, of the period: it finds
   and forgets its steps. Collective.
*/
PetscErrorCode MpmMotionSource(const MpmMotion *motion, PetscBool other, const char name[], MpmBlocksSteps *steps,
                               MpmSource *source);
PetscErrorCode MpmMotionMatrix(MpmProgram *program, const MpmMotion *motion, PetscBool other, Mat *product);
PetscErrorCode MpmMotionJudgeWaves(MpmProgram *program, MpmMotion *motion, const PetscInt phases[], PetscReal beta[],
                                   MpmFinding *finding);
