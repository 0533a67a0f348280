/* Says how large a matrix the nodes see of a scheme at rest, which is why its factors are what they are. */
#include "operator/nodal.h"
#include "base/text.h"
#include "report/report.h"
#include <string.h>

/* The images by their maps and fields, in one dimension. */
static PetscErrorCode NameImages(const MpmTable *table, const MpmNodalPlan *plan, MpmText *text)
{
  PetscFunctionBegin;
  PetscCall(MpmTextAdd(text, "%s", ""));
  for (PetscInt g = 0; g < plan->nimages && table->dim == 1; g++)
    for (PetscInt i = 0; i < plan->image[g].n; i++) {
      const MpmOp *term = &plan->image[g].term[i];

      PetscCall(MpmTextAdd(text, "%s%s %s",
                           i   ? " + "
                           : g ? ", "
                               : ": ",
                           MpmOpTraitsOf(term->kind).weight == MPM_MASS ? "P2G" : "DIV", table->fields[term->src]));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportNodal(const MpmTable *table, const char before[])
{
  MpmNodalPlan *plan;
  MpmText       images = {NULL, 0};
  const char   *why;

  PetscFunctionBegin;
  PetscCall(MpmNodalPlanCreate(table, &why, &plan));
  if (why) MpmPrint("%sthe nodes have no matrix of their own: %s\n", before, why);
  if (!plan) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(NameImages(table, plan, &images));
  MpmPrint("%sat rest the nodes see a %" PetscInt_FMT " x %" PetscInt_FMT " matrix at each phase%s\n", before,
           plan->nimages, plan->nimages, images.text);
  MpmTextFree(&images);
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}
