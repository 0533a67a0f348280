/* Says how large a matrix the nodes see of a scheme at rest, which is why its factors are what they are. */
#include "operator/nodal.h"
#include "report/report.h"
#include <string.h>

/* The images by their maps and fields, in one dimension. */
static PetscErrorCode NameImages(const MpmTable *table, const MpmNodalPlan *plan, size_t room, char text[])
{
  PetscFunctionBegin;
  text[0] = 0;
  for (PetscInt g = 0; g < plan->nimages && table->dim == 1; g++)
    for (PetscInt i = 0; i < plan->image[g].n; i++) {
      const MpmNodalTerm *term = &plan->image[g].term[i];

      PetscCall(PetscStrlcat(text, i ? " + " : g ? ", " : ": ", room));
      PetscCall(PetscStrlcat(text, MpmOpTraitsOf(term->kind).weight == MPM_MASS ? "P2G " : "DIV ", room));
      PetscCall(PetscStrlcat(text, table->fields[term->src], room));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportNodal(const MpmTable *table, const char before[])
{
  MpmNodalPlan *plan;
  char          images[512];

  PetscFunctionBegin;
  if (MpmNodalWhyNot(table)) {
    MpmPrint("%sthe nodes have no matrix of their own: %s\n", before, MpmNodalWhyNot(table));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!MpmNodalHasRoom(table)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmNodalPlanCreate(table, &plan));
  PetscCall(NameImages(table, plan, sizeof images, images));
  MpmPrint("%sat rest the nodes see a %" PetscInt_FMT " x %" PetscInt_FMT " matrix at each phase%s\n", before,
           plan->nimages, plan->nimages, images);
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}
