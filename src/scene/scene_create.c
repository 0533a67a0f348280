/* From a YAML file and the command line to a scene, and to what a task is to do with it. */
#include "scene/settings.h"
#include <mpmstab/errors.h>
#include <string.h>

/* Who asks for a limit means that of a scheme. The default's would be taken for an answer. */
static PetscErrorCode AskFormulation(const MpmSettings *settings, const MpmRequest *request)
{
  PetscFunctionBegin;
  if (strcmp(request->task, "critical") || settings->scene[0] || request->survey ||
      MpmSettingsSource(settings, "formulation") != MPM_FROM_DEFAULT || MpmSettingsGiven(settings, "scheme"))
    PetscFunctionReturn(PETSC_SUCCESS);
  MpmRefuse("critical: of which scheme? allowed: with a formulation, as in 'mpmstab critical usl' or 'mpmstab critical "
            "musl -basis quadratic'; 'mpmstab list formulations' shows them, -survey compares them");
}

static PetscErrorCode ReadBoth(MpmSettings *settings, MpmScene **scene, MpmRequest *request)
{
  PetscBool matrix;

  PetscFunctionBegin;
  PetscCall(MpmSettingsCheckTrust(settings));
  PetscCall(MpmSettingsNameMatrix(settings, request->task, &matrix));
  if (matrix) {
    PetscCall(MpmSceneDestroy(scene));
    PetscCall(MpmSettingsReadScheme(settings));
    PetscCall(MpmSettingsReadMatrixRequest(settings, request));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmSettingsReadProblem(settings, *scene));
  PetscCall(MpmSettingsReadRequest(settings, *scene, request));
  PetscCall(AskFormulation(settings, request));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A refusal frees what there is, since a program such as the fuzzer reads one scene after another. */
PetscErrorCode MpmSceneCreate(const char task[], const char path[], MpmScene **scene, MpmRequest *request)
{
  MpmSettings   *settings = NULL;
  MpmRequest     unwanted;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  if (!request) request = &unwanted;
  *request = (MpmRequest){.task = task};
  PetscCall(PetscNew(scene));
  (*scene)->law = &MpmLawLinear;
  ierr          = MpmSettingsCreate(&settings);
  if (!ierr && path) ierr = MpmSettingsReadScene(settings, path);
  if (!ierr) ierr = MpmSettingsReadCommandLine(settings);
  if (!ierr) ierr = ReadBoth(settings, scene, request);
  PetscCall(MpmSettingsDestroy(&settings));
  if (ierr) PetscCall(MpmSceneDestroy(scene));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}
