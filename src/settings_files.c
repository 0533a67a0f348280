/* Names of files, refused before any work is done when they cannot be written or would overwrite one another. */
#include <mpmstab/output.h>
#include <mpmstab/scene.h>
#include <string.h>

#define LONGEST 1024 /* characters, so that a message of PETSc's length can name it and the remedy */

static PetscErrorCode ReadPath(const MpmSettings *settings, const char name[], char path[])
{
  const char *text;

  PetscFunctionBegin;
  PetscCall(MpmSettingsPath(settings, name, &text));
  if (!text) PetscFunctionReturn(PETSC_SUCCESS);
  if (strlen(text) >= LONGEST) PetscCall(MpmSettingsRefuse(settings, name, "allowed: a shorter name"));
  PetscCall(PetscStrncpy(path, text, LONGEST));
  PetscCall(MpmFileCheck(name, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* XDMF names its datasets as FILE:PATH inside XML. */
static PetscErrorCode NameXmf(const MpmSettings *settings, MpmScene *scene)
{
  size_t length = strlen(scene->output);

  PetscFunctionBegin;
  if (strpbrk(scene->output, "<>&\":"))
    PetscCall(MpmSettingsRefuse(settings, "output", "allowed: a name without < > & : and quotes"));
  if (length > 3 && !strcmp(scene->output + length - 3, ".h5")) length -= 3;
  PetscCall(PetscSNPrintf(scene->xmf, sizeof scene->xmf, "%.*s.xmf", (int)length, scene->output));
  PetscCall(MpmFileCheck("output", scene->xmf));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsFiles(const MpmSettings *settings, MpmScene *scene)
{
  const char *const names[] = {"output", "output", "json", "csv"};
  const char *const paths[] = {scene->output, scene->xmf, scene->json, scene->csv};

  PetscFunctionBegin;
  PetscCall(ReadPath(settings, "output", scene->output));
  PetscCall(ReadPath(settings, "json", scene->json));
  PetscCall(ReadPath(settings, "csv", scene->csv));
  if (scene->output[0] && !strcmp(scene->task, "run")) PetscCall(NameXmf(settings, scene));
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < i; j++)
      MpmCheckInput(!paths[i][0] || strcmp(paths[i], paths[j]),
                    "%s and %s would both write %s; allowed: different files", names[j], names[i], paths[i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
