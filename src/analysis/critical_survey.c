/* Finds the limits of all schemes at one layout, one after another. */
#include "base/progress.h"
#include <mpmstab/critical.h>
#include <mpmstab/errors.h>
#include <mpmstab/symbol.h>

static PetscInt CountSchemes(void)
{
  PetscInt n = 0;

  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++)
      for (PetscInt b = 0; MpmBases[b]; b++) n += MpmSchemeCombines(MpmFormulations[f], MpmTransfers[t]);
  return n;
}

PetscErrorCode MpmCriticalSurvey(const MpmCriticalCase *of, MpmCriticalRow row, void *context)
{
  const PetscInt  n      = CountSchemes();
  MpmScheme       scheme = *of->scheme;
  MpmCriticalCase each   = *of;
  MpmCritical     critical;
  MpmProgress     progress;
  PetscInt        done = 0;

  PetscFunctionBegin;
  MpmCheckInput(!MpmSymbolWhyNot(of->layout),
                "survey: %s; allowed: the same particles in every cell, and boundary periodic",
                MpmSymbolWhyNot(of->layout));
  each.scheme = &scheme;
  PetscCall(MpmProgressBegin("scheme", &progress));
  for (PetscInt f = 0; MpmFormulations[f]; f++) {
    for (PetscInt t = 0; MpmTransfers[t]; t++) {
      if (!MpmSchemeCombines(MpmFormulations[f], MpmTransfers[t])) continue;
      for (PetscInt b = 0; MpmBases[b]; b++) {
        scheme.formulation = MpmFormulations[f];
        scheme.transfer    = MpmTransfers[t];
        scheme.basis       = MpmBases[b];
        PetscCall(MpmTableCreate(scheme.formulation, scheme.transfer, &scheme.numbers, &scheme.space, &scheme.table));
        PetscCall(MpmCriticalFind(&each, PETSC_TRUE, &critical));
        PetscCall(row(context, &scheme, &critical));
        PetscCall(MpmTableDestroy(&scheme.table));
        PetscCall(MpmProgressUpdate(&progress, ++done, n));
      }
    }
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}
