/* Neighbourhood: what is found of a lone particle, of a lattice with surfaces and of random layouts. */
#pragma once
#include "scene/request.h"
#include <mpmstab/critical.h>
#include <math.h>

#define MPM_QUANTILES 3 /* 5, 50 and 95 % */

/*S
   MpmNeighbourhood - what was found of one neighbourhood. Growth is per step.

   kind     - which one
   courant  - the largest stable Courant number, over all places of the surface and of the particles: 0 where it falls
              to 0, or there is growth at every one; infinite where there is no limit; NaN: undecided, or not asked for
   growth   - the largest at the case's own Courant number; infinite where it has no bound; NaN: undecided
   verdict  - on growth
   place    - where the first particle stands in its cell at the limit: the one next to the surfaces, and in a direction
              without one the first of its cell; NaN: no such place, or it is the same everywhere
   beta     - the phases of the wave that limits; NaN in directions without one
   wave     - of the bulk, as in MpmCritical
   approached - the limit is approached as particles go to that place, and not attained there
   inside   - of an edge or a corner: the wave that grows first is one of the lattice deep inside or, of a corner, of one
              of its edges, so that the surfaces make nothing worse
   places, depth - where inside: the number of spots of the grid on which lattices with all surfaces were searched, and
              the number of cells behind a surface at which the worst of them were compared
   closed   - the limit is that of a closed form
   why_not  - says why courant is undecided; else NULL
   layouts, unstable, undecided - of random layouts: their number, and those that grow and whose growth is not known, at
              the case's own Courant number
   cells    - of the box of random layouts, in each direction
   worst_seed - the seed of the layout with the least limit, or with the largest growth where no limit was asked for
   quantile - of layouts with particles anywhere: in the order of their limits that of layout number MpmRankOfQuantile;
              NaN: not known or not asked for
   evaluations, seconds - how often a limit or growth was computed, on all ranks, and the time
   fades    - of random layouts: growth fades with the Courant number, so that courant is 0
   windows  - of growth below courant, in the bulk and of random layouts; see MpmCritical
S*/
typedef struct {
  MpmNeighbourhoodKind kind;
  PetscReal            courant, growth, place[MPM_MAX_DIM], beta[MPM_MAX_DIM], quantile[MPM_QUANTILES], seconds;
  MpmVerdict           verdict;
  MpmWaveType          wave;
  PetscBool            approached, closed, inside, fades;
  const char          *why_not;
  PetscInt             layouts, cells, unstable, undecided, places, depth;
  PetscInt64           worst_seed, evaluations;
  MpmCriticalWindows   windows;
} MpmNeighbourhood;

/* Not collective. A neighbourhood of which nothing is known. */
static inline MpmNeighbourhood MpmNeighbourhoodOf(MpmNeighbourhoodKind kind)
{
  MpmNeighbourhood one = {.kind = kind, .courant = NAN, .growth = NAN, .verdict = MPM_UNDECIDED};

  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) one.place[a] = one.beta[a] = NAN;
  for (PetscInt q = 0; q < MPM_QUANTILES; q++) one.quantile[q] = NAN;
  return one;
}

/* ---- a lone particle (lone.c) ---- */

/*
   MpmLoneFind - the closed form of a lone particle at rest, over all places in its cell. Where there is one closed,
   courant, growth at a Courant number, place and approached are set. Not collective.

   The nodes around it have one velocity v, or v + C r with an affine part, where r is the vector from the particle.
   Its stress s gives them a = -k sum_b g_b s_ab / phi, whose G2P is 0. GRAD gives L_ab = C_ab - k H_b s_ab, and with an
   affine part C' = C - k s / D. So the stress is

     usl, no affine part      s' = s - k^2 STRESS H s                 k^2 lambda <= 2
     affine part, g = phi r / D    C' = C - k s / D, s' = s + k STRESS C'  k^2 lambda <= 4

   with lambda the largest eigenvalue of STRESS H, which is chi H where H is the same in all directions. Schemes that
   take the gradient of P2G of the particle's velocity see none without an affine part, and have no limit. In the words
   of the closed forms of waves kappa is lambda, the filter 1, and alpha 0, with an affine part 1. docs/theory.md,
   section 4.

   On hats a particle exactly on a node has a gradient at the next node, which it gives no mass. That node's share of
   force and gradient is lost, and schemes without a limit elsewhere have one there: no closed form is given for them.

   There is none for other schemes: with an affine part and another gradient, with a sharpened nodal field, and without
   a stress.
*/
PetscErrorCode MpmLoneFind(const MpmLayout *layout, const MpmScheme *scheme, PetscReal courant, MpmNeighbourhood *one);

/* ---- lattices with surfaces (patch.c) ---- */

/*
   MpmPatchFind - the limit of a lattice of particles that ends at free surfaces (MPM_AT_EDGE, in one direction;
   MPM_AT_CORNER, in two, in one dimension as an edge), or of a single particle (MPM_ALONE): the least over all places
   in the grid and all phases along it. The lattice is the case's: so many particles in a cell as its fullest cells have,
   evenly spaced, at rest. Its grid, offset, jitter and drift have no effect.

   Collective on PETSC_COMM_WORLD. The result does not depend on the number of ranks.

   Places next to a face of a cell are looked at from both sides. Places exactly on a face are looked at on a grid of
   the phases and of the other directions. In more than one dimension (a lone particle: in three) the limit is undecided
   where modes do not leave the unit circle at -1, unless some places have the limit 0. It is undecided too where it
   goes on changing with the depth of the lattice, as where surfaces reflect waves with a gain, and where the far end of
   the lattice has a mode of its own that is as bad.

   Errors: refuses (PETSC_ERR_USER_INPUT) a table with SOLVE.
*/
PetscErrorCode MpmPatchFind(const MpmCriticalCase *of, MpmNeighbourhoodKind kind, MpmNeighbourhood *one);

/* ---- random layouts in a small box (random_layouts.c) ---- */

/*S
   MpmRandomLayouts - what is asked of n layouts.

   n, seed - the number of layouts; layout i is hashed from seed + i
   cells   - of the box, in each direction; 0: 24 in one dimension, 6 in two, 3 in three
   voids   - the share of sites without a particle
   scatter - every second layout has its particles anywhere in the box, as layout random has them
   moves   - so many times a particle of each layout is moved, or taken away, where this makes its limit smaller
   write   - file for the places of the worst layout after this, a line for each particle; NULL or empty: none
   limits  - whether limits are sought
S*/
typedef struct {
  PetscInt    n, cells, moves;
  PetscInt64  seed;
  PetscReal   voids;
  const char *write;
  PetscBool   scatter, limits;
} MpmRandomLayouts;

/* Not collective. Of n layouts the one that a quantile is of: a share of 5, 50 or 95 % is up to it, counted from 1. */
PetscInt MpmRankOfQuantile(PetscInt quantile, PetscInt n);

/*
   MpmRandomLayoutsFind - growth and limits of layouts in a small periodic box.

   Collective on PETSC_COMM_WORLD. Each layout is solved by one rank alone (see farm.h), so that nothing depends on the
   number of ranks.

   A layout has the sites of the case's particles in each cell, jittered by the case's jitter, or where that is 0 by a
   whole distance of particles, which puts each anywhere in its share of the cell. A site has no particle where
   MpmLayoutIsVoid says so. Particles are at rest and alike, and there are no walls.

   The eigenvalues are those of the nodal operator (operator/nodal.h). Where a layout that has become unstable stays so
   (MpmLeftmostDecides, MpmGrowthStays) the limit of each between 1e-6 and 64 is found, by one factorisation where the
   operator is linear in a power of the Courant number. Else all layouts are looked at together (MpmSearchScan).

   Errors: PETSC_ERR_SUP for a table whose nodal operator needs more than maps between particles and nodes and LAP.
*/
PetscErrorCode MpmRandomLayoutsFind(const MpmCriticalCase *of, const MpmRandomLayouts *asked, MpmNeighbourhood *one);
