/* What shows that an operator that was probed is the operator of a step. */
#pragma once
#include "probe/certificates.h"
#include "report/report.h"

/* Collective. Prints the certificates that were taken, what fails where one does not hold, and the scales of fields. */
void MpmReportCertificates(const MpmCertificates *certificates);

/* Not collective. A new object with each certificate that was taken: value, bound, and whether it holds. */
json_t *MpmJsonCertificates(const MpmCertificates *certificates);

/* Not collective. A new list of the fields: name, scale, and from where it is known. */
json_t *MpmJsonScales(const MpmCertificates *certificates);
