/* The particles of a layout as CSV that -layout reads, with their bounds and the mode that grows first. */
#include "base/textfile.h"
#include "report/results.h"
#include "scene/layout.h"
#include "scene/material.h"
#include <math.h>

PetscErrorCode MpmCriticalWriteLayout(const char path[], const MpmScene *scene, const MpmCritical *c)
{
  static const char *const property[MPM_PROPERTIES] = {[MPM_VOLUME]    = "volume",
                                                       [MPM_MASS]      = "mass",
                                                       [MPM_STIFFNESS] = "young",
                                                       [MPM_LAMBDA]    = "poisson",
                                                       [MPM_MOBILITY]  = "fixed"};
  const MpmLayout         *l                        = &scene->layout;
  PetscReal                x[MPM_MAX_DIM], unit[MPM_PROPERTIES];
  MpmTextFile              csv;

  PetscFunctionBegin;
  MpmMaterialUnits(scene, unit);
  PetscCall(MpmTextFileOpen(path, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "%.*s", (int)(2 * l->dim - 1), "x,y,z");
    for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
      if (l->varies[w] && property[w]) fprintf(csv.stream, ",%s", property[w]);
    fprintf(csv.stream, ",lone,particle");
    for (PetscInt a = 0; a < l->dim; a++) fprintf(csv.stream, ",mode_%c", "xyz"[a]);
  }
  for (PetscInt64 id = 0; csv.stream && id < l->particles; id++) {
    MpmLayoutRest(l, id, x);
    for (PetscInt a = 0; a < l->dim; a++)
      fprintf(csv.stream, "%s%.17g", a ? "," : "\n", PetscMin(x[a] * scene->cell_width, scene->length[a]));
    for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
      if (l->varies[w] && property[w]) fprintf(csv.stream, ",%.17g", MpmMaterialColumn(scene, unit, w, id));
    for (PetscInt row = 0; row < 2 + l->dim; row++) MpmTextFileCell(&csv, c->each[row * l->particles + id]);
  }
  if (csv.stream) fprintf(csv.stream, "\n");
  PetscCall(MpmTextFileClose(&csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}
