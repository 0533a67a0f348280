/* Certificates and scales of an operator that was probed, by mpmstab or by the hook. */
#include "report/report_certificates.h"
#include <math.h>
#include <string.h>

void MpmReportCertificates(const MpmCertificates *of)
{
  MpmPrint("\ncertificates\n");
  for (MpmCertificate c = 0; c < MPM_CERTIFICATES; c++) {
    if (isnan(of->value[c])) continue;
    MpmPrint("  %-12s%-9.2g %-9s %s\n", MpmCertificateNames[c], (double)of->value[c],
             MpmCertificateFails(of, c) ? "FAILS" : "holds", MpmCertificateTexts[c]);
    if (MpmCertificateFails(of, c)) MpmPrint("  %-12s%s\n", "", MpmCertificateFaults[c]);
  }
  if (of->nfields) MpmPrint("  relative to the fields' scales:");
  for (PetscInt f = 0; f < of->nfields; f++)
    MpmPrint("%s %s %.6g (%s)", f ? "," : "", of->field[f].name, (double)of->field[f].scale,
             strcmp(of->field[f].from, "cell_width") ? of->field[f].from : "the width of a cell");
  if (of->nfields) MpmPrint("\n");
}

json_t *MpmJsonScales(const MpmCertificates *of)
{
  json_t *scales = json_array();

  for (PetscInt f = 0; f < of->nfields; f++)
    json_array_append_new(scales, json_pack("{s:s, s:f, s:s}", "field", of->field[f].name, "scale", of->field[f].scale,
                                            "from", of->field[f].from));
  return scales;
}

json_t *MpmJsonCertificates(const MpmCertificates *of)
{
  json_t *certificates = json_object();

  for (MpmCertificate c = 0; c < MPM_CERTIFICATES; c++) {
    if (isnan(of->value[c])) continue;
    json_object_set_new(certificates, MpmCertificateNames[c],
                        json_pack("{s:o, s:f, s:b}", "value",
                                  isfinite(of->value[c]) ? json_real(of->value[c]) : json_null(), "bound", of->bound[c],
                                  "holds", !MpmCertificateFails(of, c)));
  }
  return certificates;
}
