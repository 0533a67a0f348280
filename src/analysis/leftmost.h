/* Where the leftmost eigenvalues decide on stability. */
#pragma once
#include <mpmstab/scene.h>

/*
   MpmLeftmostDecides - whether every eigenvalue of abs above 1 is real and below -1, so that a scheme is stable where the
   eigenvalue of least real part is not below -1.

   This is proved for momentum schemes at rest on any layout, with any masses and stiffnesses, in any dimension, between
   any ends but walls that react (docs/theory.md, section 5). DIV has to be the adjoint of GRAD: a node without mass beside a
   particle that hats put on another node would break that, so that layouts with holes must be jittered.

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
