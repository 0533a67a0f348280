/* The spectrum of a frozen tangent. */
#include "analysis/frozen.h"
#include "base/text.h"
#include "operator/tangent_march.h"
#include "scene/layout.h"

PetscErrorCode MpmFrozenSpectrum(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                 MpmSpectrum **spectrum, PetscReal *mismatch)
{
  MpmMarch       *march;
  MpmTangentSpace space;
  MpmTangentState state;
  MpmFinding     *finding;
  Mat             tangent, matrix;

  PetscFunctionBegin;
  PetscCall(MpmLayoutCheckMemory(PETSC_COMM_WORLD, &scene->layout, MpmMarchBytes(scene, PETSC_FALSE), "the march"));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  while (march->step < request->at_step && !march->failure[0]) PetscCall(MpmMarchStep(march, PETSC_FALSE));
  MpmCheckInput(!march->failure[0], "-at_step %" PetscInt64_FMT ": the run ends before it, %s", request->at_step,
                march->failure);
  PetscCall(MpmTangentSpaceCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &space));
  PetscCall(MpmTangentStateCreate(&space, &state));
  PetscCall(MpmTangentStateOf(&space, march, &state));
  PetscCall(MpmTangentCheck(&space, &state));
  PetscCall(MpmTangentStateDestroy(&space, &state));
  PetscCall(MpmTangentMismatch(&space, march, &tangent, mismatch));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmTangentAssemble(tangent, &matrix));
  PetscCall(MatDestroy(&tangent));
  PetscCall(MpmTangentSpaceDestroy(&space));
  PetscCall(MpmSpectrumOfMatrix("the tangent", matrix, 1, NULL, request, started, spectrum));
  PetscCall(MatDestroy(&matrix));
  finding = &(*spectrum)->finding;
  if (!(*mismatch <= MPM_MISMATCH)) {
    finding->verdict = MPM_UNDECIDED;
    MpmTextJoin(finding->evidence, ", but the tangent's step is not the march's", sizeof finding->evidence);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
