/*
   The weights of a map are products over the directions. Along the axis that the operation acts along they are those of
   its kind, along the others phi. So the derivative of a weight with respect to the place x_c of the particle is the
   same product, with the factor of direction c replaced by its derivative:

     weight     phi    phi'    phi r          phi r / D        r = x_i - x_p, D = sum_i phi r^2
     derivative phi'   phi''   phi' r - phi   (phi r / D)'
*/
#include "program/placed_maps.h"

/* The factor of a weight along one direction. */
typedef enum { VALUE, SLOPE, CURVE, MOMENT, MOMENT_SLOPE, FIT, FIT_SLOPE, NOTHING } Factor;

struct MpmPlacedMap_ {
  Factor   factor[MPM_MAX_DIM];
  PetscInt parity;
  Mat      matrix;
};

static Factor FactorOf(MpmOpKind kind)
{
  switch (kind) {
  case MPM_P2G:
  case MPM_G2P:
    return VALUE;
  case MPM_P2G_AFFINE:
    return MOMENT;
  case MPM_DIV:
  case MPM_GRAD:
  case MPM_G2P_SLOPE:
    return SLOPE;
  default:
    return FIT;
  }
}

/* The derivative of a factor. Hats have the same slope all over a cell, and fit fields with it. */
static Factor Derivative(const MpmBasis *basis, Factor factor)
{
  const PetscBool curved = basis->weights[MPM_CURVE] ? PETSC_TRUE : PETSC_FALSE;

  switch (factor) {
  case VALUE:
    return SLOPE;
  case SLOPE:
    return curved ? CURVE : NOTHING;
  case MOMENT:
    return MOMENT_SLOPE;
  default:
    return curved ? FIT_SLOPE : NOTHING;
  }
}

/* The factor along a direction at the nodes that MpmMapRow has. */
static void Row(const MpmBasis *basis, Factor factor, PetscReal xi, PetscReal half_width, const PetscInt wall[2],
                PetscReal row[])
{
  static const MpmOpKind kinds[] = {[VALUE] = MPM_G2P,         [SLOPE] = MPM_G2P_SLOPE, [CURVE] = MPM_CURVE,
                                    [MOMENT] = MPM_P2G_AFFINE, [FIT] = MPM_G2P_AFFINE,  [FIT_SLOPE] = MPM_CURVE_MLS};
  PetscReal              slope[MPM_MAX_REACH];

  if (factor != MOMENT_SLOPE) {
    MpmMapRow(basis, kinds[factor], xi, half_width, wall, row);
    return;
  }
  MpmMapRow(basis, MPM_G2P, xi, half_width, wall, row);
  MpmMapRow(basis, MPM_G2P_SLOPE, xi, half_width, wall, slope);
  for (PetscInt d = 0; d < MpmMapReach(basis); d++) row[d] = slope[d] * (d - basis->reach_left - xi) - row[d];
}

/* The weights of a particle other than 0, and their nodes. Returns how many there are. */
static PetscInt Weights(const MpmPlacedMaps *maps, const Factor factor[], const MpmParity parity[], PetscInt p,
                        PetscInt column[], PetscReal weight[])
{
  const MpmLayout *layout = maps->sizes->layout;
  PetscReal        row[MPM_MAX_DIM][MPM_MAX_REACH];
  PetscInt         cell[MPM_MAX_DIM], n, kept = 0;

  for (PetscInt a = 0; a < layout->dim; a++) {
    PetscInt wall[2];

    cell[a] = maps->places->cell[a][p];
    MpmDirectionWalls(&layout->grid[a], cell[a], wall);
    Row(maps->sizes->scheme->basis, factor[a], maps->places->xi[a][p], layout->half_width[a], wall, row[a]);
  }
  n = MpmNodeWeights(maps->sizes, row, parity, PETSC_FALSE, cell, column, weight);
  for (PetscInt i = 0; i < n; i++) {
    if (weight[i] == 0) continue;
    column[kept]   = column[i];
    weight[kept++] = weight[i];
  }
  return kept;
}

static PetscErrorCode Make(const MpmPlacedMaps *maps, const Factor factor[], const MpmParity parity[], Mat *matrix)
{
  const PetscInt most = MpmNodeWeightsMost(maps->sizes);
  PetscInt      *column;
  PetscReal     *weight;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(most, &column, most, &weight));
  PetscCall(MpmNodeWeightsMatrix(maps->sizes, matrix));
  for (PetscInt p = 0; p < maps->sizes->particles; p++) {
    const PetscInt row = maps->sizes->begin + p, n = Weights(maps, factor, parity, p, column, weight);

    PetscCall(MatSetValues(*matrix, 1, &row, n, column, weight, ADD_VALUES));
  }
  PetscCall(PetscFree2(column, weight));
  PetscCall(MatAssemblyBegin(*matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPlacedMapsGet(MpmPlacedMaps *maps, MpmOpKind kind, PetscInt axis, PetscInt along,
                                const MpmParity parity[], Mat *map)
{
  const PetscInt dim                 = maps->sizes->layout->dim;
  Factor         factor[MPM_MAX_DIM] = {VALUE};
  PetscInt class                     = MpmParityClass(maps->sizes->layout, parity), m;

  PetscFunctionBegin;
  *map         = NULL;
  factor[axis] = FactorOf(kind);
  if (along != MPM_NONE) factor[along] = Derivative(maps->sizes->scheme->basis, factor[along]);
  for (PetscInt a = 0; a < dim; a++)
    if (factor[a] == NOTHING) PetscFunctionReturn(PETSC_SUCCESS);
  for (m = 0; m < maps->n; m++) {
    PetscInt same = maps->map[m].parity == class;

    for (PetscInt a = 0; a < dim; a++) same &= maps->map[m].factor[a] == factor[a];
    if (same) break;
  }
  if (m == maps->n) {
    if (maps->n == maps->room) {
      maps->room = PetscMax(16, 2 * maps->room);
      PetscCall(PetscRealloc(sizeof(*maps->map) * (size_t)maps->room, &maps->map));
    }
    maps->map[m] = (MpmPlacedMap){.parity = class};
    PetscCall(PetscArraycpy(maps->map[m].factor, factor, dim));
    PetscCall(Make(maps, factor, parity, &maps->map[m].matrix));
    maps->n++;
  }
  *map = maps->map[m].matrix;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPlacedMapsDestroy(MpmPlacedMaps *maps)
{
  PetscFunctionBegin;
  for (PetscInt m = 0; m < maps->n; m++) PetscCall(MatDestroy(&maps->map[m].matrix));
  PetscCall(PetscFree(maps->map));
  maps->n = maps->room = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
