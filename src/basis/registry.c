/* The list of bases. */
#include <mpmstab/basis.h>
#include <string.h>

extern const MpmBasis MpmLinear;

const MpmBasis *const MpmBases[] = {&MpmLinear, NULL};

const MpmBasis *MpmBasisFind(const char name[])
{
  for (PetscInt b = 0; MpmBases[b]; b++)
    if (!strcmp(MpmBases[b]->name, name)) return MpmBases[b];
  return NULL;
}
