/* From a prepared program to a verdict: its operator is probed with both sizes of perturbations. */
#include "analysis/program_growth.h"
#include "analysis/worst_phase.h"
#include <math.h>

PetscErrorCode MpmProgramJudgeParticles(MpmProgram *p, PetscReal started, MpmFinding *f, MpmCarriers *carriers)
{
  const PetscReal target[2] = {0, 0};
  MpmEigen       *eigen;
  MpmSpectrum    *spectrum;
  PetscReal       other;
  Mat             A, B;

  PetscFunctionBegin;
  PetscCall(MpmProgramMatrix(p, &A, &B));
  PetscCall(MpmSpectrumOfMatrix(p->stepper->name, A, p->probe.steps, p->request, started, &spectrum));
  PetscCall(MpmEigenSolve(B, NULL, spectrum->eigen->complete ? MPM_EIGEN_DENSE : MPM_EIGEN_LARGEST, target, &eigen));
  other = eigen->n ? MpmGrowthPerStep(hypot(eigen->re[0], eigen->im[0]), 0, p->probe.steps) : NAN;
  *f    = spectrum->finding;
  PetscCall(MpmProgramJudge(p, other, isnan(spectrum->condition) ? 1 : spectrum->condition, f));
  PetscCall(MpmCarriersFind(p, spectrum, carriers));
  PetscCall(MpmEigenDestroy(&eigen));
  PetscCall(MpmSpectrumDestroy(&spectrum));
  PetscCall(MatDestroy(&A));
  PetscCall(MatDestroy(&B));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramJudgeWaves(MpmProgram *p, const PetscInt phases[], PetscReal beta[], MpmFinding *f)
{
  MpmBlocks       one, two;
  MpmSource       source;
  MpmSourceGrowth at, other;

  PetscFunctionBegin;
  PetscCall(MpmProgramBlocks(p, &one, &two));
  PetscCall(MpmBlocksSource(&one, p->stepper->name, &source));
  PetscCall(MpmWorstPhase(PETSC_COMM_WORLD, &source, phases, beta, &at));
  PetscCall(MpmBlocksSource(&two, p->stepper->name, &source));
  PetscCall(MpmSourceGrowthAt(&source, beta, &other));
  *f = (MpmFinding){.growth = at.growth, .tolerance = p->tolerance};
  PetscCall(PetscStrncpy(f->evidence, "the symbol of the interior, sought over all waves", sizeof f->evidence));
  PetscCall(MpmProgramJudge(p, other.growth, at.condition, f));
  PetscCall(MpmBlocksFree(&one));
  PetscCall(MpmBlocksFree(&two));
  PetscFunctionReturn(PETSC_SUCCESS);
}
