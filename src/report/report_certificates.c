/* Certificates and scales of an operator that was probed, by mpmstab or by the hook. */
#include "report/report_program.h"
#include <math.h>
#include <string.h>

void MpmReportCertificates(json_t *result, const MpmCertificates *of)
{
  json_t *certificates = MpmResultIn(result, "certificates");

  (void)MpmResultList(result, "scales");
  MpmPrint("\ncertificates\n");
  for (MpmCertificate c = 0; c < MPM_CERTIFICATES; c++) {
    json_t *its;

    if (isnan(of->value[c])) continue;
    its = MpmResultIn(certificates, MpmCertificateNames[c]);
    MpmResultSay(its, "  %-12s%-9.2g{value!} %-9s %s\n", MpmCertificateNames[c], (double)of->value[c],
                 MpmCertificateFails(of, c) ? "FAILS" : "holds", MpmCertificateTexts[c]);
    MpmResultKeep(its, "%g{bound} %d{holds?}", of->bound[c], !MpmCertificateFails(of, c));
    if (MpmCertificateFails(of, c)) MpmPrint("  %-12s%s\n", "", MpmCertificateFaults[c]);
    if (MpmCertificateFails(of, c)) MpmResultKeep(its, "%s{cure}", MpmCertificateCure(of, c));
  }
  if (MpmCertificatesCure(of))
    MpmResultSay(result, "  what can be done: %s{what_can_be_done}\n", MpmCertificatesCure(of));
  for (MpmCertificate c = MpmCertificatesFault(of); c < MPM_CERTIFICATES; c++)
    if (MpmCertificateFails(of, c) && strcmp(MpmCertificateCure(of, c), MpmCertificatesCure(of)))
      MpmPrint("  for %s to hold: %s\n", MpmCertificateNames[c], MpmCertificateCure(of, c));
  if (of->nfields) MpmPrint("  relative to the fields' scales:");
  for (PetscInt f = 0; f < of->nfields; f++) {
    const MpmFieldScale *field = &of->field[f];
    json_t              *scale = MpmResultNext(result, "scales");

    MpmResultSay(scale, "%s %s{field} %.6g{scale} (%s)", f ? "," : "", field->name, (double)field->scale,
                 strcmp(field->from, "cell_width") ? field->from : "the width of a cell");
    MpmResultKeep(scale, "%s{from}", field->from);
  }
  if (of->nfields) MpmPrint("\n");
}
