/*
   Damping, of every formulation with every transfer and basis: at rest the physical mode decays as the closed form says,
   whether it travels or is overdamped, and in the plane waves along x are damped as in one dimension, under drift too.
*/
#include "analysis/damping.h"
#include "check.h"
#include "symbol/predict.h"
#include <slepcsys.h>

#define PHASES 12
#define DIVISORS 3

static const MpmRequest request = {.phases = {PHASES}, .ndivisors = DIVISORS, .divisors = {1, 4, 16}};

static PetscBool Exists(const MpmFormulation *f, const MpmTransfer *t)
{
  return f->wave && !t->same_as && !(t->affine && f->affine == MPM_NONE) ? PETSC_TRUE : PETSC_FALSE;
}

/* Compares the growth per step with the closed form, at each time step and wave. */
static PetscErrorCode ClosedForm(const char options[], const MpmScene *scene, const MpmDamping *d, PetscInt *compared)
{
  MpmPredictor predictor;

  PetscFunctionBegin;
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, PETSC_FALSE, NULL, &predictor));
  for (PetscInt i = 0; i < DIVISORS * d->nwaves && !predictor.why_not && !predictor.why_not_corrected; i++) {
    const PetscReal k = d->courant[i / d->nwaves], beta = 2 * PETSC_PI / d->wavelength[i % d->nwaves];
    const PetscReal growth = exp(-d->decay[i] * k), corrected = MpmPredictorCorrected(&predictor, k, &beta);

    CHECK(fabs(growth - corrected) <= 1e-7, "%s, k %g, %g cells: %.9g, closed form %.9g, match %g", options, k,
          d->wavelength[i % d->nwaves], growth, corrected, d->match[i]);
    (*compared)++;
  }
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Leaves out waves of 3 cells: two of their modes may be about as near, and the stress across the wave, which the plane
   has besides, may decide between them.
*/
static PetscErrorCode Compare(const char options[], const MpmDamping *a, const MpmDamping *b)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < DIVISORS * a->nwaves; i++) {
    if (a->wavelength[i % a->nwaves] < 4) continue;
    CHECK(fabs(a->decay[i] - b->decay[i]) <= 1e-7, "%s, wave %d: decay %.9g, in the plane %.9g", options, (int)i,
          a->decay[i], b->decay[i]);
    CHECK(fabs(a->frequency[i] - b->frequency[i]) <= 1e-7, "%s, wave %d: frequency error %.9g, in the plane %.9g",
          options, (int)i, a->frequency[i], b->frequency[i]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode One(const MpmFormulation *f, const MpmTransfer *t, const MpmBasis *b, PetscInt *compared)
{
  static const char *const rests[] = {"-ppc 2 -courant 0.5", "-ppc 1 -offset 0.3 -courant 0.4",
                                      "-ppc 1 -courant 0.4 -drift 1/4"};
  char                     options[256], plane[512];

  PetscFunctionBegin;
  for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(rests); r++) {
    MpmScene   *scene, *flat;
    MpmDamping *damping, *same;

    PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -transfer %s -basis %s %s", f->name, t->name,
                            b->name, rests[r]));
    PetscCall(
        PetscSNPrintf(plane, sizeof plane, "-dim 2 -cells 12,2 %s%s", options, strstr(options, "drift") ? ",0" : ""));
    PetscCall(CheckScene(options, &scene));
    PetscCall(MpmDampingCreate(scene, &request, &damping));
    if (!MpmSceneDrifts(scene)) PetscCall(ClosedForm(options, scene, damping, compared));
    if (r) {
      PetscCall(CheckScene(plane, &flat));
      PetscCall(MpmDampingCreate(flat, &request, &same));
      PetscCall(Compare(options, damping, same));
      PetscCall(MpmDampingDestroy(&same));
      PetscCall(MpmSceneDestroy(&flat));
    }
    PetscCall(MpmDampingDestroy(&damping));
    PetscCall(MpmSceneDestroy(&scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscInt          compared = 0;
  const PetscMPIInt size     = MpmRanksOf(PETSC_COMM_WORLD);
  PetscBool         turn     = PETSC_FALSE;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++)
      for (PetscInt b = 0; MpmBases[b] && Exists(MpmFormulations[f], MpmTransfers[t]); b++) {
        PetscCall(CheckHasTurn(f + t + b, &turn));
        if (turn) PetscCall(One(MpmFormulations[f], MpmTransfers[t], MpmBases[b], &compared));
      }
  CHECK(compared > (size == 1 ? 3500 : 3000 / size), "only %d waves", (int)compared);
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
