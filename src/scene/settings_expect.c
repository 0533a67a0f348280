/* What a scene says must come out. */
#include <mpmstab/scene.h>

PetscErrorCode MpmSettingsExpect(const MpmSettings *settings, const MpmScene *scene, MpmExpect *expect)
{
  PetscInt i;

  PetscFunctionBegin;
  expect->has_verdict  = MpmSettingsGiven(settings, "expect");
  expect->has_kind     = MpmSettingsGiven(settings, "expect_kind");
  expect->has_growth   = MpmSettingsGiven(settings, "expect_growth");
  expect->has_spectrum = MpmSettingsGiven(settings, "expect_spectrum");
  expect->has_error    = MpmSettingsGiven(settings, "expect_error");
  expect->has_energy   = MpmSettingsGiven(settings, "expect_energy");
  expect->has_critical = MpmSettingsGiven(settings, "expect_critical");
  expect->has_share    = MpmSettingsGiven(settings, "expect_share");
  if (expect->has_verdict) {
    PetscCall(MpmSettingsWord(settings, "expect", &i));
    expect->verdict = (MpmVerdict)i;
  }
  if (expect->has_kind) {
    PetscCall(MpmSettingsWord(settings, "expect_kind", &i));
    expect->kind = (MpmGrowthKind)i;
  }
  if (expect->has_growth) PetscCall(MpmSettingsRange(settings, "expect_growth", expect->growth));
  if (expect->has_spectrum) PetscCall(MpmSettingsRange(settings, "expect_spectrum", expect->spectrum));
  if (expect->has_critical) PetscCall(MpmSettingsRange(settings, "expect_critical", expect->critical));
  if (expect->has_share) PetscCall(MpmSettingsRange(settings, "expect_share", expect->share));
  if (expect->has_energy) PetscCall(MpmSettingsRange(settings, "expect_energy", expect->energy));
  if (expect->has_error && !MpmSceneHasExact(scene)) {
    if (!MpmSettingsOverruled(settings, "expect_error", "initial"))
      PetscCall(
          MpmSettingsRefuse(settings, "expect_error",
                            "there is no exact solution; allowed: with initial mode, pulse or step in a full domain"));
    expect->has_error = PETSC_FALSE;
  }
  if (expect->has_error) PetscCall(MpmSettingsRange(settings, "expect_error", expect->error));
  PetscFunctionReturn(PETSC_SUCCESS);
}
