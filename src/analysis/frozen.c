/* The spectrum of a frozen tangent. */
#include "analysis/frozen.h"
#include "base/text.h"
#include "operator/tangent.h"
#include "scene/layout.h"

/* The spectrum of a tangent, which it destroys. */
static PetscErrorCode Solve(const MpmRequest *request, PetscReal started, Mat *tangent, MpmSpectrum **spectrum)
{
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(MpmTangentAssemble(*tangent, &matrix));
  PetscCall(MatDestroy(tangent));
  PetscCall(MpmSpectrumOfMatrix("the tangent", matrix, 1, NULL, request, started, spectrum));
  PetscCall(MatDestroy(&matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where particles stand on the yield surface: the spectrum of the branch that grows more, and what is said of both. */
static PetscErrorCode OfBranches(MpmTangentSpace *space, PetscReal courant, const MpmTangentState *state,
                                 const MpmRequest *request, PetscReal started, MpmSpectrum **spectrum)
{
  static const MpmBranch branch[2] = {MPM_BRANCH_LOADING, MPM_BRANCH_UNLOADING};
  MpmSpectrum           *of[2];
  char                   text[256];
  PetscInt               larger;
  Mat                    tangent;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 2; i++) {
    space->branch = branch[i];
    PetscCall(MpmTangentOf(space, courant, state, &tangent, NULL));
    PetscCall(Solve(request, started, &tangent, &of[i]));
  }
  larger = of[1]->finding.growth > of[0]->finding.growth ? 1 : 0;
  PetscCall(PetscSNPrintf(text, sizeof text,
                          "; %" PetscInt64_FMT " particles stand on the yield surface: growth %.9g loading, %.9g "
                          "unloading, and %s counts",
                          space->on_surface, of[0]->finding.growth, of[1]->finding.growth,
                          MpmBranchNames[branch[larger]]));
  *spectrum = of[larger];
  PetscCall(MpmSpectrumDestroy(&of[1 - larger]));
  MpmTextJoin((*spectrum)->finding.evidence, text, sizeof(*spectrum)->finding.evidence);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFrozenSpectrum(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                 MpmSpectrum **spectrum, PetscReal *mismatch)
{
  MpmMarch       *march;
  MpmTangentSpace space;
  MpmTangentState state;
  MpmFinding     *finding;
  Mat             tangent;

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
  PetscCall(MpmTangentMismatch(&space, march, &tangent, mismatch));
  if (space.on_surface > 0) {
    PetscCall(MatDestroy(&tangent));
    PetscCall(OfBranches(&space, march->courant, &state, request, started, spectrum));
  } else
    PetscCall(Solve(request, started, &tangent, spectrum));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmTangentStateDestroy(&space, &state));
  PetscCall(MpmTangentSpaceDestroy(&space));
  finding = &(*spectrum)->finding;
  if (!(*mismatch <= MPM_MISMATCH)) {
    finding->verdict = MPM_UNDECIDED;
    MpmTextJoin(finding->evidence, ", but the tangent's step is not the march's", sizeof finding->evidence);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
