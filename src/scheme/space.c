/* What a space says of the state that a scheme is linear about: its stress, its stiffness and its symmetries. */
#include <mpmstab/table.h>

PetscBool MpmSpaceIsPrestressed(const MpmSpace *space)
{
  for (PetscInt c = 0; c < MPM_MAX_STRESS; c++)
    if (space->prestress[c] != 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscReal MpmSpacePrestress(const MpmSpace *space, PetscInt a, PetscInt b)
{
  return space->prestress[MpmStressComponent(space->dim, a, b)];
}

PetscReal MpmSpaceTangent(const MpmSpace *space, PetscInt a, PetscInt b, PetscInt c, PetscInt d)
{
  const PetscReal *q       = space->squares;
  PetscReal        tangent = a == b && c == d ? space->lambda * q[a] * q[c] : 0;

  if (MpmSpaceIsFluid(space)) return a == b && c == d ? 1 + space->prestress[0] : 0;
  if (a == c && b == d) tangent += space->mu * q[a] * q[b];
  if (a == d && b == c) tangent += space->mu * q[a] * q[b];
  if (a == c) tangent += MpmSpacePrestress(space, d, b);
  if (b == c) tangent += MpmSpacePrestress(space, a, d);
  return tangent;
}

PetscBool MpmSpaceMirrors(const MpmSpace *space, PetscInt a)
{
  for (PetscInt b = 0; b < space->dim; b++)
    if (b != a && MpmSpacePrestress(space, a, b) != 0) return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscBool MpmSpaceAlike(const MpmSpace *space, PetscInt a, PetscInt b)
{
  if (!MpmSpaceIsPrestressed(space)) return PETSC_TRUE;
  for (PetscInt c = 0; c < space->dim; c++)
    if (!MpmSpaceMirrors(space, c)) return PETSC_FALSE;
  return MpmSpacePrestress(space, a, a) == MpmSpacePrestress(space, b, b) && space->squares[a] == space->squares[b]
             ? PETSC_TRUE
             : PETSC_FALSE;
}
