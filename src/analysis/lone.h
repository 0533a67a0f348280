/* What is known of every layout. */
#pragma once
#include <mpmstab/scene.h>

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
