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

/*
   Makes a scene from a file, or from text that messages call by a name, and with a request from the command line, too. A
   refusal frees what there is, since a program such as the fuzzer reads one scene after another.
*/
static PetscErrorCode Make(const char path[], const char name[], const char yaml[], MpmRequest *request,
                           MpmScene **scene)
{
  MpmSettings   *settings = NULL;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(PetscNew(scene));
  (*scene)->law = &MpmLawLinear;
  ierr          = MpmSettingsCreate(&settings);
  if (!ierr && path) ierr = MpmSettingsReadScene(settings, path);
  if (!ierr && yaml) ierr = MpmSettingsReadText(settings, name, yaml);
  if (!ierr && request) ierr = MpmSettingsReadCommandLine(settings);
  if (!ierr) ierr = request ? ReadBoth(settings, scene, request) : MpmSettingsReadProblem(settings, *scene);
  PetscCall(MpmSettingsDestroy(&settings));
  if (ierr) PetscCall(MpmSceneDestroy(scene));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneCreate(const char task[], const char path[], MpmScene **scene, MpmRequest *request)
{
  MpmRequest unwanted;

  PetscFunctionBegin;
  if (!request) request = &unwanted;
  *request = (MpmRequest){.task = task};
  PetscCall(Make(path, NULL, NULL, request, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneFromNamedText(const char name[], const char yaml[], MpmScene **scene)
{
  return Make(NULL, name, yaml, NULL, scene);
}

PetscErrorCode MpmSceneFromText(const char yaml[], MpmScene **scene)
{
  return Make(NULL, "text", yaml, NULL, scene);
}

PetscErrorCode MpmSceneFromFile(const char path[], MpmScene **scene)
{
  return Make(path, NULL, NULL, NULL, scene);
}
