/*
   Certificates: what shows that the operator of a code that was probed is the operator of its step. Each is a number
   that would be 0 for an ideal code, and a bound up to which it holds.
*/
#pragma once
#include "probe/probed.h"
#include <mpmstab/verdict.h>

/*E
   MpmCertificate - what is looked at.

     MPM_CERTIFY_REPEAT      - the response to the first perturbation, which is small, once more after all others, and
                               after other states; the difference is an error of the operator. It shows a switch that
                               stays on, memory that the state does not have, such as a list of cells that is not made
                               anew, and sums in changing order
     MPM_CERTIFY_COMPOSED    - steps in one request against requests of one step each, over the size of the
                               perturbation. It shows what a code keeps only within a request, and steps that change
                               with their number
     MPM_CERTIFY_SIZES       - the operator is probed with two sizes of perturbations; the norm of the difference shows
                               rounding and curvature
     MPM_CERTIFY_ADDITIVITY  - the response to a sum of two perturbations, less the two responses; and how much a
                               response depends on its size. It shows switches in the step
     MPM_CERTIFY_ONE_SIDED   - how much the mean of the responses forward and backward differs from 0, beyond what
                               curvature makes. It shows that the base state is on a switch, such as a wall's
     MPM_CERTIFY_EQUILIBRIUM - how far the base state moves in an application
     MPM_CERTIFY_REACH       - the response at the edge of the cells, or where no probed unknown should be felt
     MPM_CERTIFY_COLUMNS     - the response to a random perturbation of everything, less what the probed operator gives
     MPM_CERTIFY_SCALES      - by so many powers of 2 the scales of fields change that were found, when they are looked
                               for once more; infinite if they were not found
E*/
typedef enum {
  MPM_CERTIFY_REPEAT,
  MPM_CERTIFY_COMPOSED,
  MPM_CERTIFY_SIZES,
  MPM_CERTIFY_ADDITIVITY,
  MPM_CERTIFY_ONE_SIDED,
  MPM_CERTIFY_EQUILIBRIUM,
  MPM_CERTIFY_REACH,
  MPM_CERTIFY_COLUMNS,
  MPM_CERTIFY_SCALES,
  MPM_CERTIFICATES
} MpmCertificate;

/* Not collective. Their names, what fails when they do not hold, and what the number is. */
extern const char *const MpmCertificateNames[], *const MpmCertificateFaults[], *const MpmCertificateTexts[];

/*S
   MpmFieldScale - what a change of order 1 of a field is. from: declared, cell_width, found, or guessed where the
   search has not succeeded.
S*/
typedef struct {
  char      name[MPM_STEPPER_NAME], from[16];
  PetscReal scale;
} MpmFieldScale;

/*S
   MpmCertificates - value[c] and bound[c] of each certificate; a value that was not taken is NaN. tolerance: the error
   of the operator that does not matter. most[c]: the unknown that shows it most, or MPM_NONE. cells: in so many cells
   may be felt what is felt too far away. single: the code computes in single precision; noise: what two responses
   differ by because answers have an error that does not get smaller with perturbations, as that of rounding or of a
   solver's tolerance. kinked: particles at which one side fails. field: the scales that errors are relative to, nfields
   of them; none are known of a file without.
S*/
typedef struct MpmCertificates_ {
  PetscReal     value[MPM_CERTIFICATES], bound[MPM_CERTIFICATES], tolerance;
  PetscInt64    most[MPM_CERTIFICATES], cells, kinked;
  PetscBool     single;
  PetscReal     noise;
  PetscInt      nfields;
  MpmFieldScale field[MPM_STEPPER_FIELDS];
} MpmCertificates;

#define MPM_AT_REST 1e-9          /* a change of the base state per application, in scales, that is rounding */
#define MPM_TOLERANCE_SINGLE 1e-5 /* of a verdict: what single precision can tell */

/* Not collective. Sets the bounds; no certificate is taken. */
void MpmCertificatesBegin(PetscBool single, PetscReal tolerance, MpmCertificates *certificates);

/* Not collective. Whether any certificate was taken, and whether one was taken and does not hold. */
PetscBool MpmCertificatesTaken(const MpmCertificates *certificates);
PetscBool MpmCertificateFails(const MpmCertificates *certificates, MpmCertificate which);

/*
   Not collective. The first that does not hold, or MPM_CERTIFICATES. MpmCertificatesCure: the reason, from all of them,
   and what can be done; NULL if all hold. MpmCertificateCure: what would make one hold. MpmCertificatesSwitch: whether
   the base state is on a switch, of a code that repeats itself.
*/
MpmCertificate MpmCertificatesFault(const MpmCertificates *certificates);
PetscBool      MpmCertificatesSwitch(const MpmCertificates *certificates);
const char    *MpmCertificatesCure(const MpmCertificates *certificates);
const char    *MpmCertificateCure(const MpmCertificates *certificates, MpmCertificate which);

/*
   MpmCertifyStep - takes those that need no operator: two steps, additivity, one side, equilibrium, scales. The others
   are NaN.
   MpmCertifyOperator - adds two sizes and columns, of operators that were probed with the two sizes of probe. one: NULL
   where no columns are known, of a shell.
   MpmCertifyRepeat - adds repeat, when all others are taken.
   MpmCertifyColumns - the number of columns alone, NaN where no cell is inside, and the unknown that shows it most.

   What is set apart does not count, because no eigenvalue that is judged feels its error: apart[c] says whether number
   c of a particle is; kept and other are without it, one is with it.

   Collective. tolerance: the error of the operator that does not matter.
*/
PetscErrorCode MpmCertifyStep(MpmProbe *probe, PetscReal tolerance, const PetscBool apart[],
                              MpmCertificates *certificates);
PetscErrorCode MpmCertifyOperator(MpmProbe *probe, const MpmProbeLattice *lattice, const MpmProbed *one,
                                  const MpmProbed *kept, const MpmProbed *other, const PetscBool apart[],
                                  MpmCertificates *certificates);
PetscErrorCode MpmCertifyColumns(MpmProbe *probe, const MpmProbeLattice *lattice, const MpmProbed *one,
                                 const PetscBool apart[], PetscReal *differ, PetscInt64 *most);
PetscErrorCode MpmCertifyRepeat(MpmProbe *probe, const PetscBool apart[], MpmCertificates *certificates);

/*
   MpmCertificatesJudge - the verdict of a finding, given its growth. It is unstable only if growth - 1 is larger than
   the tolerance and what the errors of the operator (two sizes and repeat) can make of an eigenvalue, with both sizes
   of perturbations. A certificate that fails makes it undecided, unless growth is beyond what its fault can make.

   Not collective. other: growth with the other size, NULL where it is not known. condition: of the eigenvalue. period:
   the steps that the operator covers.
*/
PetscErrorCode MpmCertificatesJudge(const MpmCertificates *certificates, const PetscReal *other, PetscReal condition,
                                    PetscInt period, MpmFinding *finding);
