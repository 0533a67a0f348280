/* Verdicts on operators that were probed: what certificates leave of a finding. */
#pragma once
#include "probe/certificates.h"
#include <mpmstab/verdict.h>

/*
   MpmCertifiedVerdict - the verdict of a finding, from its growth and tolerance. It is unstable only if growth - 1 is larger
   than the tolerance and what the errors of the operator (two sizes and repeat) can make of an eigenvalue.
   MpmCertifiedDispute - makes it undecided if a certificate fails, unless growth is beyond what its fault can make.

   Not collective. condition: of the eigenvalue. period: the steps that the operator covers.
*/
PetscErrorCode MpmCertifiedVerdict(const MpmCertificates *certificates, PetscReal condition, PetscInt period,
                                   MpmFinding *finding);
PetscErrorCode MpmCertifiedDispute(const MpmCertificates *certificates, PetscReal condition, MpmFinding *finding);
