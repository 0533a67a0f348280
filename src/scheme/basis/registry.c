/* The list of bases. */
#include <mpmstab/basis.h>
#include <string.h>

extern const MpmBasis MpmLinear, MpmGimp, MpmQuadratic, MpmCubic;
extern const MpmBasis MpmQuadraticModified, MpmQuadraticOpen, MpmCubicModified, MpmCubicOpen;

const MpmBasis *const MpmBases[] = {&MpmLinear, &MpmGimp, &MpmQuadratic, &MpmCubic, NULL};

/* These share the name of a basis in the list. */
static const MpmBasis *const altered[] = {&MpmQuadraticModified, &MpmQuadraticOpen, &MpmCubicModified, &MpmCubicOpen,
                                          NULL};

const char *const MpmSplineEndNames[] = {"mirror", "modified", "open", NULL};

const MpmBasis *MpmBasisWithEnds(const MpmBasis *basis, MpmSplineEnds ends)
{
  if (ends == basis->spline_ends) return basis;
  for (PetscInt b = 0; altered[b]; b++)
    if (!strcmp(altered[b]->name, basis->name) && altered[b]->spline_ends == ends) return altered[b];
  return NULL;
}

PetscErrorCode MpmBasisCheck(const MpmBasis *basis)
{
  PetscFunctionBegin;
  PetscCheck(basis->nodes <= MPM_MOST_NODES && basis->reach_left + basis->reach_right <= MPM_MOST_NODES,
             PETSC_COMM_SELF, PETSC_ERR_ARG_OUTOFRANGE,
             "basis %s has weights at %" PetscInt_FMT " nodes a direction, of %" PetscInt_FMT
             " in its reach; allowed: MPM_MOST_NODES = %d, and one more in its reach",
             basis->name, basis->nodes, basis->reach_left + 1 + basis->reach_right, MPM_MOST_NODES);
  for (PetscInt i = 0; i < 16; i++) {
    const PetscReal xi   = i / 16.0;
    const PetscInt  cell = 0;
    PetscInt        first;

    basis->first_nodes(1, &cell, &xi, &first);
    PetscCheck(first >= -basis->reach_left && first + basis->nodes - 1 <= basis->reach_right, PETSC_COMM_SELF,
               PETSC_ERR_ARG_OUTOFRANGE,
               "basis %s has weights at nodes %" PetscInt_FMT " to %" PetscInt_FMT
               " of a cell, beyond its reach -%" PetscInt_FMT " to %" PetscInt_FMT,
               basis->name, first, first + basis->nodes - 1, basis->reach_left, basis->reach_right);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmBasis *MpmBasisFind(const char name[])
{
  for (PetscInt b = 0; MpmBases[b]; b++)
    if (!strcmp(MpmBases[b]->name, name)) return MpmBases[b];
  return NULL;
}
