/* Rows of nodes to one line, and back. The numbers of rows and of lines are constants in each loop, but for wide bases. */
#include "scheme/lines.h"

PetscInt MpmLineWeights(const MpmBasis *basis, MpmOpKind kind, PetscReal xi, PetscReal half_width,
                        const PetscInt wall[2], PetscReal weight[])
{
  const PetscInt cell = 0;
  MpmBlock       block;

  block.n          = 1;
  block.xi         = &xi;
  block.half_width = half_width;
  block.wall[0]    = wall[0];
  block.wall[1]    = wall[1];
  basis->first_nodes(1, &cell, &xi, block.first);
  basis->weights[kind](&block, 1, weight);
  return block.first[0];
}

MpmOpKind MpmLineFirstAlike(const MpmBasis *basis, MpmOpKind kind)
{
  for (PetscInt k = 0; k < (PetscInt)kind; k++)
    if (basis->kernel[k] == basis->kernel[kind]) return (MpmOpKind)k;
  return kind;
}

MpmOpKind MpmLineKind(const MpmBasis *basis, MpmOpKind kind)
{
  static const MpmOpKind to_nodes[MPM_OP_KINDS] = {
      [MPM_P2G] = MPM_P2G,          [MPM_P2G_AFFINE] = MPM_P2G_AFFINE, [MPM_DIV] = MPM_DIV,
      [MPM_DIV_MLS] = MPM_DIV_MLS,  [MPM_CURVE] = MPM_CURVE,           [MPM_CURVE_MLS] = MPM_CURVE_MLS,
      [MPM_G2P] = MPM_P2G,          [MPM_G2P_AFFINE] = MPM_DIV_MLS,    [MPM_GRAD] = MPM_DIV,
      [MPM_GRAD_MLS] = MPM_DIV_MLS, [MPM_G2P_SLOPE] = MPM_DIV};

  return MpmLineFirstAlike(basis, to_nodes[kind]);
}

#define INLINE static inline __attribute__((always_inline))

INLINE void Gather(const PetscInt rows, const PetscInt *restrict offset, const PetscReal *restrict weight, PetscInt n,
                   const PetscReal *restrict node, PetscReal *restrict line)
{
  for (PetscInt i = 0; i < n; i++) {
    PetscReal sum = 0;

    for (PetscInt r = 0; r < rows; r++) sum += weight[r] * node[offset[r] + i];
    line[i] = sum;
  }
}

void MpmLinesGather(PetscInt rows, const PetscInt *restrict offset, const PetscReal *restrict weight, PetscInt n,
                    const PetscReal *restrict node, PetscReal *restrict line)
{
  if (rows == 2)
    Gather(2, offset, weight, n, node, line);
  else if (rows == 3)
    Gather(3, offset, weight, n, node, line);
  else if (rows == 4)
    Gather(4, offset, weight, n, node, line);
  else if (rows == 9)
    Gather(9, offset, weight, n, node, line);
  else if (rows == 16)
    Gather(16, offset, weight, n, node, line);
  else
    Gather(rows, offset, weight, n, node, line);
}

/* Rows do not overlap, but the compiler cannot know it; so it does one after the other. */
INLINE void Spread(PetscInt rows, const PetscInt *restrict offset, const PetscInt lines,
                   const PetscReal weight[][MPM_MOST_ROWS], const PetscReal *const line[], PetscInt n,
                   PetscReal *restrict node)
{
  const PetscReal *restrict l0 = line[0], *restrict l1 = lines > 1 ? line[1] : NULL,
                            *restrict l2 = lines > 2 ? line[2] : NULL;

  for (PetscInt r = 0; r < rows; r++) {
    const PetscReal w0 = weight[0][r], w1 = lines > 1 ? weight[1][r] : 0, w2 = lines > 2 ? weight[2][r] : 0;
    PetscReal *restrict row = node + offset[r];

    for (PetscInt i = 0; i < n; i++) row[i] += w0 * l0[i] + (lines > 1 ? w1 * l1[i] : 0) + (lines > 2 ? w2 * l2[i] : 0);
  }
}

void MpmLinesSpread(PetscInt rows, const PetscInt *restrict offset, PetscInt lines,
                    const PetscReal weight[][MPM_MOST_ROWS], const PetscReal *const line[], PetscInt n,
                    PetscReal *restrict node)
{
  if (lines == 1) Spread(rows, offset, 1, weight, line, n, node);
  if (lines == 2) Spread(rows, offset, 2, weight, line, n, node);
  if (lines == 3) Spread(rows, offset, 3, weight, line, n, node);
}
