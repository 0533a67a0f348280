/* The list of formulations, and what every reader of their tables shares. */
#include <mpmstab/formulation.h>
#include "quadratic.h"
#include <math.h>
#include <string.h>

extern const MpmFormulation MpmGas1, MpmGas2, MpmElastic;

const MpmFormulation *const MpmFormulations[] = {&MpmGas1, &MpmGas2, &MpmElastic, NULL};

const MpmFormulation *MpmFormulationFind(const char name[])
{
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    if (!strcmp(MpmFormulations[f]->name, name)) return MpmFormulations[f];
  return NULL;
}

static PetscInt CountNames(const char *const names[])
{
  PetscInt n = 0;
  while (names[n]) n++;
  return n;
}

PetscInt MpmFormulationParticleFields(const MpmFormulation *formulation)
{
  return CountNames(formulation->particle_fields);
}

PetscInt MpmFormulationNodeFields(const MpmFormulation *formulation)
{
  return CountNames(formulation->node_fields);
}

MpmOpTraits MpmOpTraitsOf(MpmOpKind kind)
{
  static const MpmOpTraits traits[] = {
      [MPM_P2G] = {MPM_ON_NODES, MPM_ON_PARTICLES, 0},  [MPM_G2P] = {MPM_ON_PARTICLES, MPM_ON_NODES, 0},
      [MPM_GRAD] = {MPM_ON_PARTICLES, MPM_ON_NODES, 0}, [MPM_LAP] = {MPM_ON_NODES, MPM_ON_NODES, 1},
      [MPM_ADD] = {MPM_ON_NODES, MPM_ON_NODES, 0},      [MPM_DRIFT] = {MPM_NOWHERE, MPM_NOWHERE, 0},
  };
  return traits[kind];
}

PetscReal MpmCoefficientValue(MpmCoefficient coefficient, PetscReal courant)
{
  return coefficient == MPM_COURANT ? courant : 1;
}

PetscReal MpmQuadraticRadius(double complex trace, double complex det)
{
  const double complex root = csqrt(trace * trace / 4 - det);
  return fmax(cabs(trace / 2 + root), cabs(trace / 2 - root));
}
