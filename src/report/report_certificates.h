/* What shows that an operator that was probed is the operator of a step. */
#pragma once
#include "probe/certificates.h"
#include "report/report.h"

/* Collective. The certificates that were taken, what fails where one does not hold, and the scales of fields. */
void MpmReportCertificates(json_t *result, const MpmCertificates *certificates);
