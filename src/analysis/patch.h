/* Patch: the limit of a lattice of particles that ends at free surfaces, at rest. */
#pragma once
#include <mpmstab/critical.h>

/*E
   MpmPatchKind - where a lattice of particles ends.

   MPM_PATCH_EDGE   - a half-space: there is a free surface in one direction
   MPM_PATCH_CORNER - a quarter-space: there are free surfaces in two directions; in one dimension as EDGE
   MPM_PATCH_LONE   - a single particle
E*/
typedef enum { MPM_PATCH_EDGE, MPM_PATCH_CORNER, MPM_PATCH_LONE } MpmPatchKind;

/*S
   MpmPatchLimit - the limit of a patch: the least over all places of the patch in the grid and all phases along it.

   courant     - the largest Courant number up to which no patch of the kind grows. 0: in the limit of some places, or
                 at every Courant number, there is growth. Infinite: nothing that grows was found. NaN: undecided.
   place       - where the first particle of the worst patch stands in its cell, in each direction: the one next to the
                 surfaces. In a direction without a surface it is the first of its cell.
   beta        - the phases of the wave that grows first; NaN in directions with a surface
   approached  - the limit is approached as particles go to place, and not attained there
   inside      - the wave that grows first is one of the lattice deep inside or, of a corner, of one of its edges: the
                 surfaces make nothing worse
   places, depth - shown by these: the number of spots of the grid on which lattices with all surfaces were searched,
                 and the number of cells behind a surface at which the worst of them were compared
   growth      - the largest growth per step at the case's own Courant number
   evaluations - the number of times that a limit or growth was computed
   seconds     - the time that the search took
S*/
typedef struct {
  PetscReal  courant, place[MPM_MAX_DIM], beta[MPM_MAX_DIM];
  PetscBool  approached, inside;
  PetscInt   places, depth;
  PetscReal  growth;
  PetscInt64 evaluations;
  PetscReal  seconds;
} MpmPatchLimit;

/*
   MpmPatchFind - the limit of a patch of a case's lattice: so many particles in a cell as its fullest cells have,
   evenly spaced, at rest. Its grid, offset, jitter and drift have no effect.

   Collective on PETSC_COMM_WORLD. The result does not depend on the number of ranks.

   Places next to a face of a cell are looked at from both sides. Places exactly on a face are looked at on a grid of
   the phases and of the other directions. In more than one dimension (a lone particle: in three) the limit is undecided
   where modes do not leave the unit circle at -1, unless some places have the limit 0. It is undecided too where it
   goes on changing with the depth of the lattice, as where surfaces reflect waves with a gain, and where the far end of
   the lattice has a mode of its own that is as bad.

   Errors: refuses (PETSC_ERR_USER_INPUT) a table with SOLVE.
*/
PetscErrorCode MpmPatchFind(const MpmCriticalCase *of, MpmPatchKind kind, MpmPatchLimit *limit);
