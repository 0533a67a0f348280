/*
   What the hook says of a matrix in the comments of its Matrix Market file (include/mpmstab_probe.h): how far the
   matrix can be trusted, and where the particles are.

     % steps: 8              that the matrix covers; anybody may write this one
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
#include "probe/certificates.h"

#define MPM_HOOKED_NUMBERS 1024 /* of a particle whose scales are kept */

/*S
   MpmHooked - value: of certificates, NaN of those that are not said; other numbers are then 0. x: the places,
   MPM_MAX_DIM numbers a particle, of which the file has place_dim. given: which comments were there.
S*/
typedef struct {
  PetscReal  value[MPM_CERTIFICATES], size, single, numbers, cell_width, period[MPM_MAX_DIM], steps;
  PetscInt   dim, place_dim;
  unsigned   given;
  PetscInt64 places, room, scales;
  PetscReal *x, scale[MPM_HOOKED_NUMBERS];

  PetscInt      nfields;
  MpmFieldScale field[MPM_STEPPER_FIELDS];
} MpmHooked;

/*
   Not collective. Begin with nothing said; take a comment, without its '%'; free the places. wrong: what is allowed in
   the place of a comment that has not the numbers it should have; NULL: nothing is wrong, or the comment is none of
   these.
*/
void           MpmHookedBegin(MpmHooked *hooked);
PetscErrorCode MpmHookedTake(const char comment[], MpmHooked *hooked, const char **wrong);
PetscErrorCode MpmHookedFree(MpmHooked *hooked);

/*
   MpmHookedCertificates - gives all ranks what the first one has read. tolerance: of the verdict; single precision has
   a larger one.

   Collective.
*/
PetscErrorCode MpmHookedCertificates(MPI_Comm comm, const MpmHooked *hooked, PetscReal tolerance,
                                     MpmCertificates *certificates);
