/* The limits of all schemes at one layout, one after another. */
#include "report/results.h"
#include "report/report.h"
#include <math.h>

/* A scene for each scheme that there is; bases vary fastest. */
static PetscErrorCode MakeScenes(const MpmScene *scene, PetscInt *n, MpmScene **scenes)
{
  PetscInt room = 0;

  PetscFunctionBegin;
  *n = 0;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++)
      for (PetscInt b = 0; MpmBases[b]; b++) room++;
  PetscCall(PetscMalloc1(room, scenes));
  for (PetscInt f = 0; MpmFormulations[f]; f++) {
    for (PetscInt t = 0; MpmTransfers[t]; t++) {
      if (MpmTransfers[t]->affine && MpmFormulations[f]->affine == MPM_NONE) continue;
      for (PetscInt b = 0; MpmBases[b]; b++) {
        MpmScene *s = &(*scenes)[(*n)++];

        *s             = *scene;
        s->formulation = MpmFormulations[f];
        s->transfer    = MpmTransfers[t];
        s->basis       = MpmBases[b];
        PetscCall(MpmTableCreate(s->formulation, s->transfer, &s->numbers, s->ends, &s->table));
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintCell(PetscReal courant)
{
  PetscFunctionBegin;
  if (isinf(courant))
    MpmPrint("  %9s", "none");
  else if (courant == 0)
    MpmPrint("  %9s", "0");
  else if (courant < 1e-3)
    MpmPrint("  %9.1e", courant);
  else
    MpmPrint("  %9.4f", courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintRow(const MpmScene *s)
{
  PetscFunctionBegin;
  MpmPrint("%-8s %-10s", s->formulation->name, s->transfer->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalSurvey(const MpmScene *scene, const MpmRequest *request)
{
  PetscInt         n;
  MpmScene        *scenes;
  const MpmScene **each;
  MpmCritical     *critical;

  PetscFunctionBegin;
  MpmCheckInput(!MpmSymbolWhyNot(scene), "survey: %s; allowed: the same particles in every cell, and boundary periodic",
                MpmSymbolWhyNot(scene));
  PetscCall(MakeScenes(scene, &n, &scenes));
  PetscCall(PetscMalloc2(n, &critical, n, &each));
  MpmPrint("largest %s Courant number c dt / h: ppc %" PetscInt_FMT
           ", offset %.6g, drift %.6g, xpic_order %" PetscInt_FMT ", blend_ratio %.6g\nscheme   transfer  ",
           MpmSceneDrifts(scene) ? "bounded (growth within tolerance)" : "stable", scene->ppc, scene->offset.value,
           scene->drift.value, scene->numbers.order, scene->numbers.ratio);
  for (PetscInt b = 0; MpmBases[b]; b++) MpmPrint("  %9s", MpmBases[b]->name);
  for (PetscInt i = 0; i < n; i++) {
    each[i] = &scenes[i];
    if (scenes[i].basis == MpmBases[0]) {
      MpmPrint("\n");
      PetscCall(PrintRow(&scenes[i]));
    }
    PetscCall(MpmCriticalFind(&scenes[i], request->tolerance, PETSC_TRUE, &critical[i]));
    PetscCall(PrintCell(critical[i].courant));
  }
  MpmPrint("\n0: grows at every Courant number; none: no limit up to %.6g\n", MPM_CRITICAL_TO);
  if (request->csv[0]) PetscCall(MpmCriticalWriteCsv(request->csv, scene, n, each, critical));
  for (PetscInt i = 0; i < n; i++) PetscCall(MpmTableDestroy(&scenes[i].table));
  PetscCall(PetscFree2(critical, each));
  PetscCall(PetscFree(scenes));
  PetscFunctionReturn(PETSC_SUCCESS);
}
