/* The list of bases. */
#include <mpmstab/basis.h>
#include <string.h>

extern const MpmBasis MpmLinear, MpmGimp, MpmQuadratic, MpmCubic;

const MpmBasis *const MpmBases[] = {&MpmLinear, &MpmGimp, &MpmQuadratic, &MpmCubic, NULL};

const MpmBasis *MpmBasisFind(const char name[])
{
  for (PetscInt b = 0; MpmBases[b]; b++)
    if (!strcmp(MpmBases[b]->name, name)) return MpmBases[b];
  return NULL;
}
