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

const MpmBasis *MpmBasisFind(const char name[])
{
  for (PetscInt b = 0; MpmBases[b]; b++)
    if (!strcmp(MpmBases[b]->name, name)) return MpmBases[b];
  return NULL;
}
