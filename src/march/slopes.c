/* The slopes of a particle's weights: products over the directions of phi and of its slope. */
#include "march/slopes.h"
#include "scheme/maps.h"

/* The weights of a particle along a direction: phi (0) and its slope (1), the places of its nodes and each component's sign. */
typedef struct {
  PetscInt  place[MPM_MAX_REACH], number[MPM_MAX_REACH]; /* in a local array; in the grid */
  PetscReal weight[2][MPM_MAX_REACH], sign[MPM_MAX_DIM][MPM_MAX_REACH];
  PetscBool twice; /* a node may be there twice */
} Along;

PetscInt MpmSlopesMost(const MpmSlopes *s)
{
  PetscInt n = 1;

  for (PetscInt a = 0; a < s->layout->dim; a++) n *= MpmMapReach(s->basis);
  return n;
}

static PetscBool IsFixed(const MpmDirection *direction, PetscInt node, MpmParity parity)
{
  return (node == 0 && (MpmEndImposes(direction->ends[0], parity) || direction->ends[0] == MPM_FIXED_REACTION)) ||
                 (node == direction->nodes - 1 &&
                  (MpmEndImposes(direction->ends[1], parity) || direction->ends[1] == MPM_FIXED_REACTION))
             ? PETSC_TRUE
             : PETSC_FALSE;
}

static void RowAlong(const MpmSlopes *s, PetscInt a, PetscInt cell, PetscReal xi, Along *along)
{
  const MpmGridAxis  *axis = &s->grid->axis[a];
  const MpmDirection *grid = &s->layout->grid[a];
  PetscInt            wall[2];

  MpmDirectionWalls(grid, axis->first + cell, wall);
  MpmMapRow(s->basis, MPM_P2G, xi, s->layout->half_width[a], wall, along->weight[0]);
  MpmMapRow(s->basis, s->kind, xi, s->layout->half_width[a], wall, along->weight[1]);
  along->twice = axis->periodic && axis->cells < MpmMapReach(s->basis) ? PETSC_TRUE : PETSC_FALSE;
  for (PetscInt d = 0; d < MpmMapReach(s->basis); d++) {
    const PetscInt node = cell - s->basis->reach_left + d;
    PetscReal      sign;

    along->number[d] = MpmDirectionImage(grid, axis->first + node, MPM_EVEN, &sign);
    along->place[d]  = (axis->periodic ? node : along->number[d] - axis->first) * axis->stride;
    if (!axis->periodic && along->number[d] != axis->first + node) along->twice = PETSC_TRUE;
    for (PetscInt c = 0; c < s->layout->dim; c++) {
      along->sign[c][d] = 1;
      if (axis->periodic) continue;
      (void)MpmDirectionImage(grid, axis->first + node, s->parity[c][a], &along->sign[c][d]);
      if (IsFixed(grid, along->number[d], s->parity[c][a])) along->sign[c][d] = 0;
    }
  }
}

/* Adds up what a node has twice. number: of the nodes in the grid. */
static PetscInt Merge(PetscInt components, PetscInt n, const PetscInt number[], PetscInt node[], PetscReal shape[],
                      PetscReal slope[])
{
  PetscInt kept = 0, of[MPM_MAX_REACH * MPM_MAX_REACH * MPM_MAX_REACH];

  for (PetscInt i = 0; i < n; i++) {
    PetscInt j = 0;

    while (j < kept && number[of[j]] != number[i]) j++;
    if (j == kept) {
      of[kept++] = i;
      node[j]    = node[i];
      shape[j]   = shape[i];
      for (PetscInt c = 0; c < components; c++) slope[j * components + c] = slope[i * components + c];
      continue;
    }
    shape[j] += shape[i];
    for (PetscInt c = 0; c < components; c++) slope[j * components + c] += slope[i * components + c];
  }
  return kept;
}

PetscInt MpmSlopesAt(const MpmSlopes *s, PetscBool merge, const PetscInt cell[], const PetscReal xi[], PetscInt node[],
                     PetscReal shape[], PetscReal slope[])
{
  const PetscInt dim = s->layout->dim, reach = MpmMapReach(s->basis), n = MpmSlopesMost(s);
  PetscInt       number[MPM_MAX_REACH * MPM_MAX_REACH * MPM_MAX_REACH];
  Along          along[MPM_MAX_DIM];
  PetscBool      twice = PETSC_FALSE;

  for (PetscInt a = 0; a < dim; a++) {
    RowAlong(s, a, cell[a], xi[a], &along[a]);
    if (along[a].twice) twice = merge;
  }
  for (PetscInt i = 0; i < n; i++) {
    PetscReal value[MPM_MAX_DIM] = {1, 1, 1}, sign[MPM_MAX_DIM] = {1, 1, 1};
    PetscInt  stride = 1;

    node[i] = number[i] = 0;
    shape[i]            = 1;
    for (PetscInt a = 0, rest = i; a < dim; a++, rest /= reach) {
      const PetscInt d = rest % reach;

      node[i] += along[a].place[d];
      number[i] += stride * along[a].number[d];
      stride *= s->layout->grid[a].nodes;
      shape[i] *= along[a].weight[0][d];
      for (PetscInt b = 0; b < dim; b++) {
        value[b] *= along[a].weight[a == b][d];
        sign[b] *= along[a].sign[b][d];
      }
    }
    for (PetscInt c = 0; c < dim; c++)
      for (PetscInt b = 0; b < dim; b++) slope[(i * dim + c) * dim + b] = sign[c] * value[b];
  }
  return twice ? Merge(dim * dim, n, number, node, shape, slope) : n;
}
