/* Certificates of an operator that was probed, by mpmstab or by the hook. */
#include "report/report_certificates.h"
#include <math.h>

PetscErrorCode MpmReportCertificates(const MpmCertificates *of)
{
  PetscFunctionBegin;
  MpmPrint("\ncertificates\n");
  for (MpmCertificate c = 0; c < MPM_CERTIFICATES; c++) {
    if (isnan(of->value[c])) continue;
    MpmPrint("  %-12s%-9.2g %-9s %s\n", MpmCertificateNames[c], (double)of->value[c],
             MpmCertificateFails(of, c) ? "FAILS" : "holds", MpmCertificateTexts[c]);
    if (MpmCertificateFails(of, c)) MpmPrint("  %-12s%s\n", "", MpmCertificateFaults[c]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

json_t *MpmJsonCertificates(const MpmCertificates *of)
{
  json_t *certificates = json_object();

  for (MpmCertificate c = 0; c < MPM_CERTIFICATES; c++) {
    if (isnan(of->value[c])) continue;
    json_object_set_new(certificates, MpmCertificateNames[c],
                        json_pack("{s:f, s:f, s:b}", "value", of->value[c], "bound", of->bound[c], "holds",
                                  !MpmCertificateFails(of, c)));
  }
  return certificates;
}
