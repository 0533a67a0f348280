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
      [MPM_P2G]   = {.dst = MPM_ON_NODES, .src = MPM_ON_PARTICLES},
      [MPM_G2P]   = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_NODES, .accumulates = PETSC_TRUE},
      [MPM_GRAD]  = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_NODES, .accumulates = PETSC_TRUE},
      [MPM_LAP]   = {.dst = MPM_ON_NODES, .src = MPM_ON_NODES, .halo = 1, .stencil = {1, -2, 1}},
      [MPM_ADD]   = {.dst = MPM_ON_NODES, .src = MPM_ON_NODES, .accumulates = PETSC_TRUE, .stencil = {0, 1, 0}},
      [MPM_DRIFT] = {.dst = MPM_NOWHERE, .src = MPM_NOWHERE},
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
