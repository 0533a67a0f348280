/* What shows that an operator that was probed is the operator of a step. */
#pragma once
#include "operator/certificates.h"
#include "report/report.h"

/* Collective. Prints the certificates that were taken, and what fails where one does not hold. */
PetscErrorCode MpmReportCertificates(const MpmCertificates *certificates);

/* Not collective. A new object with each certificate that was taken: value, bound, and whether it holds. */
json_t *MpmJsonCertificates(const MpmCertificates *certificates);
