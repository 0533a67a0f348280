/*
   A lone particle: the largest stable Courant number of one particle without neighbours, in closed form; and what is
   known of every layout.
*/
#pragma once
#include <mpmstab/scene.h>

/*S
   MpmLone - the limit of a lone particle at rest, over all places in its cell.

   known      - there is a closed form, and the others are set
   courant    - the largest stable Courant number: 0 where it falls to 0 as the particle comes to a place; infinite
                where there is no limit
   growth     - the largest growth per step at the Courant number given; infinite where it has no bound
   place      - where the limit is least, in each direction; NaN: it is the same everywhere
   approached - it is approached there, and not attained
S*/
typedef struct {
  PetscBool known, approached;
  PetscReal courant, growth, place[MPM_MAX_DIM];
} MpmLone;

/*
   MpmLoneFind - the closed form of a lone particle. Not collective.

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
PetscErrorCode MpmLoneFind(const MpmLayout *layout, const MpmScheme *scheme, PetscReal courant, MpmLone *lone);

/*
   MpmCriticalBound     - bound of MpmCritical, for particles at rest
   MpmCriticalLoneBound - the same of schemes with a step_bound, from a lone particle at its worst place; 0: none is
                          known
   MpmCriticalSpread    - the least and the largest second moment D of the weights of a direction, over the places in a
                          cell

   Not collective.
*/
PetscReal      MpmCriticalBound(const MpmLayout *layout, const MpmScheme *scheme);
PetscErrorCode MpmCriticalLoneBound(const MpmLayout *layout, const MpmScheme *scheme, PetscReal *bound);
void           MpmCriticalSpread(const MpmBasis *basis, PetscReal half_width, PetscReal ends[2]);

/*
   MpmLeftmostDecides - whether every eigenvalue of abs above 1 is real and below -1, so that a scheme is stable where
   the eigenvalue of least real part is not below -1.

   This is proved for momentum schemes at rest on any layout, with any masses and stiffnesses, in any dimension, between
   any ends but walls that react (docs/theory.md, section 5). DIV has to be the adjoint of GRAD: a node without mass
   beside a particle that hats put on another node would break that, so that layouts with holes must be jittered.

   Such an eigenvalue falls as the Courant number grows. So what has become unstable stays so.

   Not collective.
*/
PetscBool MpmLeftmostDecides(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step);

/*
   MpmGrowthStays - whether a layout that grows at a Courant number also grows at each larger one. So it is where the
   leftmost eigenvalues decide, and for verlet and rk with flip (docs/theory.md, section 5).

   Not collective.
*/
PetscBool MpmGrowthStays(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step);
