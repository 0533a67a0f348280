/*
   What the hook says of a matrix in the comments of its Matrix Market file (include/mpmstab_probe.h): how far the matrix
   can be trusted, and where the particles are.

     % numbers: 3            of a particle; unknowns are particle by particle
     % cell_width: 0.0625
     % period: 1 0           of the grid in each direction; 0: none
     % size: 7.6e-06         of the perturbations, in the scales of the fields; in single precision also '% single: 1'
     % moved: 0              and the other certificates
     % scale: 1              of a number of a particle; one comment for each
     % field_scale: 1 found v     of a field, from where it is known, and its name; one comment for each
     % at: 0.015625          a particle's place; one comment for each
*/
#pragma once
#include "operator/certificates.h"

#define MPM_HOOKED_NUMBERS 1024 /* of a particle whose scales are kept */

/*S
   MpmHooked - certificates that are not said are NaN, other numbers 0. x: the places, dim numbers a particle.
S*/
typedef struct {
  PetscReal moved, repeat, one_sided, two_sizes, additivity, unsettled, size, single, numbers, cell_width,
      period[MPM_MAX_DIM];
  PetscInt      dim;
  PetscInt64    places, room, scales;
  PetscReal    *x, scale[MPM_HOOKED_NUMBERS];
  PetscInt      nfields;
  MpmFieldScale field[MPM_STEPPER_FIELDS];
} MpmHooked;

/* Not collective. Begin with nothing said; take a comment, without its '%'; free the places. */
void           MpmHookedBegin(MpmHooked *hooked);
PetscErrorCode MpmHookedTake(const char comment[], MpmHooked *hooked);
PetscErrorCode MpmHookedFree(MpmHooked *hooked);

/*
   MpmHookedCertificates - gives all ranks what the first one has read. tolerance: of the verdict; single precision has a
   larger one.

   Collective.
*/
PetscErrorCode MpmHookedCertificates(MPI_Comm comm, const MpmHooked *hooked, PetscReal tolerance,
                                     MpmCertificates *certificates);
