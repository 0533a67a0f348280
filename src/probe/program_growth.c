/* From a prepared program to a verdict: its operator is probed with both sizes of perturbations. */
#include "probe/program_growth.h"
#include "analysis/waves.h"
#include "linalg/dense.h"
#include <math.h>

/* Without all eigenvalues those of a shell or a lattice near the spectrum's first mode are found on the space of that mode. */
static PetscErrorCode SolveOther(const MpmProgram *p, const MpmSpectrum *s, Mat B, MpmEigen **eigen)
{
  const PetscReal target[2] = {0, 0};
  Vec             x[2];

  PetscFunctionBegin;
  if (!p->shell && !MpmProgramLattice(p)) {
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
  if (s->finding.verdict == MPM_STABLE && !s->eigen->complete && !s->symbol)
    PetscCall(MpmFindingDispute(&s->finding, "only all eigenvalues could show that none is larger"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramJudgeParticles(MpmProgram *p, PetscReal started, MpmFinding *f, MpmCarriers *carriers)
{
  MpmSpectrum *spectrum;
  Mat          A, B;

  PetscFunctionBegin;
  PetscCall(MpmProgramMatrix(p, &A, &B));
  PetscCall(
      MpmSpectrumOfMatrix(p->stepper->name, A, p->probe.steps, MpmProgramLattice(p), p->request, started, &spectrum));
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

static PetscErrorCode GrowthOfMatrix(MpmProgram *p, PetscReal *growth)
{
  const PetscReal target[2] = {0, 0};
  PetscReal       value[2];
  PetscInt        order;
  MpmEigen       *eigen;
  Mat             A;

  PetscFunctionBegin;
  PetscCall(MpmProgramMatrix(p, &A, NULL));
  PetscCall(MatGetSize(A, &order, NULL));
  if (order <= MPM_DENSE_MANY) {
    PetscCall(MpmDenseLargest(A, value));
  } else {
    PetscCall(MpmEigenSolve(A, NULL, MpmEigenChoose(order, PETSC_FALSE), target, &eigen));
    value[0] = eigen->n ? eigen->re[0] : NAN;
    value[1] = eigen->n ? eigen->im[0] : NAN;
    PetscCall(MpmEigenDestroy(&eigen));
  }
  *growth = MpmGrowthPerStep(hypot(value[0], value[1]), 0, p->probe.steps);
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramGrowth(MpmProgram *p, PetscReal *growth)
{
  PetscInt        phases[MPM_MAX_DIM];
  PetscReal       beta[MPM_MAX_DIM];
  MpmBlocks       blocks;
  MpmSource       source;
  MpmSourceGrowth at;

  PetscFunctionBegin;
  if (p->kind != MPM_PROBE_BLOCH) {
    PetscCall(GrowthOfMatrix(p, growth));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmProgramBlocks(p, &blocks, NULL));
  PetscCall(MpmBlocksSource(&blocks, p->stepper->name, &source));
  PetscCall(MpmRequestPhases(p->request, p->stepper->dim, phases));
  PetscCall(MpmWorstPhase(PETSC_COMM_WORLD, &source, phases, beta, &at));
  *growth = at.growth;
  PetscCall(MpmBlocksFree(&blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}
