/* From a prepared program to a verdict: its operator is probed with both sizes of perturbations. */
#include "probe/program_growth.h"
#include "analysis/worst_phase.h"
#include <math.h>

/* The eigenvalues of a shell that are near the spectrum's first mode are found on the space of that mode. */
static PetscErrorCode SolveOther(const MpmProgram *p, const MpmSpectrum *s, Mat B, MpmEigen **eigen)
{
  const PetscReal target[2] = {0, 0};
  Vec             x[2];

  PetscFunctionBegin;
  if (!p->shell) {
    PetscCall(MpmEigenSolve(B, NULL, s->eigen->complete ? MPM_EIGEN_DENSE : MPM_EIGEN_LARGEST, target, eigen));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (int part = 0; part < 2; part++) PetscCall(MatCreateVecs(B, &x[part], NULL));
  if (s->eigen->n) PetscCall(MpmEigenVector(s->eigen, 0, x[0], x[1]));
  PetscCall(MpmEigenRitz(B, s->eigen->n ? 2 : 0, x, eigen));
  for (int part = 0; part < 2; part++) PetscCall(VecDestroy(&x[part]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramJudgeSpectrum(const MpmProgram *p, Mat B, MpmSpectrum *s)
{
  PetscReal growth;
  MpmEigen *eigen;

  PetscFunctionBegin;
  PetscCall(SolveOther(p, s, B, &eigen));
  growth = eigen->n ? MpmGrowthPerStep(hypot(eigen->re[0], eigen->im[0]), 0, p->probe.steps) : NAN;
  PetscCall(MpmEigenDestroy(&eigen));
  PetscCall(MpmProgramJudge(p, growth, isnan(s->condition) ? 1 : s->condition, &s->finding));
  if (s->finding.verdict == MPM_STABLE && !s->eigen->complete)
    PetscCall(MpmFindingDispute(&s->finding, "only all eigenvalues could show that none is larger"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramJudgeParticles(MpmProgram *p, PetscReal started, MpmFinding *f, MpmCarriers *carriers)
{
  MpmSpectrum *spectrum;
  Mat          A, B;

  PetscFunctionBegin;
  PetscCall(MpmProgramMatrix(p, &A, &B));
  PetscCall(MpmSpectrumOfMatrix(p->stepper->name, A, p->probe.steps, p->request, started, &spectrum));
  PetscCall(MpmProgramJudgeSpectrum(p, B, spectrum));
  *f = spectrum->finding;
  PetscCall(MpmCarriersFind(p, spectrum, carriers));
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
  (void)snprintf(f->evidence, sizeof f->evidence, "%s", "the symbol of the interior, sought over all waves");
  PetscCall(MpmProgramJudge(p, other.growth, at.condition, f));
  PetscCall(MpmBlocksFree(&one));
  PetscCall(MpmBlocksFree(&two));
  PetscFunctionReturn(PETSC_SUCCESS);
}
