/* Why the option nodal has no sense in a scene. */
#include "analysis/nodal_choice.h"
#include "operator/nodal.h"
#include <mpmstab/errors.h>
#include <mpmstab/symbol.h>
#include <string.h>

static PetscErrorCode WhyNot(const MpmScene *scene, const MpmRequest *request, const char **why)
{
  PetscInt64    unknowns;
  MpmNodalPlan *plan;

  PetscFunctionBegin;
  PetscCall(MpmNodalPlanCreate(scene->scheme.table, why, &plan));
  PetscCall(MpmNodalPlanDestroy(&plan));
  if (MpmSceneDrifts(scene))
    *why = "particles move";
  else if (!strcmp(request->task, "critical") && !MpmSymbolWhyNot(&scene->layout))
    *why = "the limit of a uniform layout is that of its symbol";
  if (*why) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmNodalMatrixUnknowns(&scene->layout, &scene->scheme, &scene->step, &unknowns));
  if (!unknowns) *why = "the nodes have as many unknowns as the particles";
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalChoiceCheck(const MpmScene *scene, const MpmRequest *request)
{
  const char *why;

  PetscFunctionBegin;
  if (!request->nodal_asked) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(WhyNot(scene, request, &why));
  MpmCheckInput(!why, "-nodal %s: nothing reads it in this scene: %s; allowed: without it",
                request->nodal ? "true" : "false", why);
  PetscFunctionReturn(PETSC_SUCCESS);
}
