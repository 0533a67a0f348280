/* A code beside a scheme of our own: a scene with the code's cells, and where the two operators differ. */
#pragma once
#include "probe/match.h"
#include "probe/program.h"

#define MPM_COMPARE_SAME 4 /* schemes that are listed */

/*S
   MpmCompareProgram - the comparison of a prepared code with the scene that option compare names.

   scene    - the scene, with what the code says of its cells where the option leaves it open
   own, theirs - both operators; fields of own are those of the scheme
   match    - what goes with what, and what differs
   growth   - of the scene, over all waves; code: of the code
   bound    - differences up to it are none: what single or double precision and the perturbations can tell
   same     - the two are the same step
   same_as  - where they are not: schemes of ours with the scene's cells that are the code's step, nsame of them
S*/
typedef struct {
  MpmScene    *scene;
  MpmBlocks    blocks;
  MpmMatchSide own, theirs;
  MpmMatch    *match;
  PetscReal    growth, code, bound;
  PetscBool    same;
  PetscInt     nsame;
  char         same_as[MPM_COMPARE_SAME][96];
} MpmCompareProgram;

/*
   MpmCompareProgramBegin - makes the scene and its operator, before the code is probed.

   Collective. The program must be prepared. Errors: PETSC_ERR_USER_INPUT where the code's cells are not alike, the
   option is no scene, or the scene has other cells or another drift than the code.

   MpmCompareProgramFind - compares. blocks: those of the code, without what is set apart. growth: of the code over all
   waves, or NaN if it is to be found.

   Collective.
*/
PetscErrorCode MpmCompareProgramBegin(const MpmProgram *program, MpmCompareProgram *compare);
PetscErrorCode MpmCompareProgramFind(const MpmProgram *program, const MpmBlocks *blocks, PetscReal growth,
                                     MpmCompareProgram *compare);
PetscErrorCode MpmCompareProgramDestroy(MpmCompareProgram *compare);
