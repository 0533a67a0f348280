/* Zoom: the least value of a function of the phases of one, two or three directions. */
#pragma once
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>

#define MPM_ZOOM_STARTS 24 /* the most places from which a search goes on */

/* Computes a function of the phases beta[0], beta[1] ... */
typedef PetscErrorCode (*MpmZoomFunction)(void *context, const PetscReal beta[], PetscReal *value);

/*S
   MpmZoom - how the least value is sought.

   dim     - the number of directions
   points  - the number of phases in (0, pi] in each direction with which the search begins; they lie closer near 0 and
             pi
   starts  - the search goes on from so many of the least values on this grid, at most MPM_ZOOM_STARTS, that no
             neighbour is below,
   within  - if they are not more than this factor times the least one
   finest  - the search from a start ends with a step of this size
   least   - phases that are all smaller than this are left out: a wave that is longer has the limit of long waves, and
             rounding makes it worse
   mirror  - mirror[a]: the function is the same at -beta[a]
   alike   - and it does not change when directions with the same number alike[a] are exchanged
   comm    - the ranks that share the work. On PETSC_COMM_SELF each does all of it.
S*/
typedef struct {
  PetscInt  dim, points, starts;
  PetscReal within, finest, least;
  PetscBool mirror[MPM_MAX_DIM];
  PetscInt  alike[MPM_MAX_DIM];
  MPI_Comm  comm;
} MpmZoom;

/*
   MpmZoomLeast - finds the least value of a function that is the same at beta and -beta, and periodic in each phase
   with 2 pi. It need not be smooth: the limit of all modes of a phase has a ridge where those of two modes cross.

   Collective on zoom->comm; f is not.

   Input Parameters: f, context - the function
   Output Parameters:
+  beta  - its phases, in (-pi, pi]
-  value - infinite where the function is infinite or NaN everywhere; beta is then NaN

   From each start the search goes down by steps in all directions and on all diagonals (MpmSearchDescend). The result
   does not depend on the number of ranks.
*/
PetscErrorCode MpmZoomLeast(const MpmZoom *zoom, MpmZoomFunction f, void *context, PetscReal beta[], PetscReal *value);

/*
   Not collective. Of beta and -beta, whose waves are conjugate, that of which the first phase other than 0 and pi is
   positive, in (-pi, pi]; -pi but for rounding is pi.
*/
void MpmZoomFold(PetscInt dim, PetscReal beta[]);

/* Not collective. The same from one start alone: the phases in beta and the value there. step: the first step. */
PetscErrorCode MpmZoomFrom(const MpmZoom *zoom, MpmZoomFunction f, void *context, PetscReal step, PetscReal beta[],
                           PetscReal *value);

/* Not collective. The dimension and the symmetries of a scheme on a layout, with a drift; the rest is 0. */
MpmZoom MpmZoomOf(const MpmLayout *layout, const MpmSpace *space, const MpmFraction drift[]);
