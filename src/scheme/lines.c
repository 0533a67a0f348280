/* Rows of nodes to one line, and back. The numbers of rows and of lines are constants in each loop, but for wide bases. */
#include "scheme/lines.h"

MpmOpKind MpmLineKind(const MpmBasis *basis, MpmOpKind kind)
{
  for (PetscInt k = 0; k < (PetscInt)kind; k++)
    if (basis->weights[k] == basis->weights[kind]) return (MpmOpKind)k;
  return kind;
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
