/* Kernels on arrays, for particles and for nodes. The weights of maps between the two are in scheme/basis. */
#include "scheme/kernels.h"

void MpmBlockPlace(const MpmBasis *basis, PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscReal half_width,
                   const PetscInt wall[2], MpmBlock *b)
{
  b->n          = n;
  b->xi         = xi;
  b->half_width = half_width;
  b->wall[0]    = wall[0];
  b->wall[1]    = wall[1];
  basis->first_nodes(n, cell, xi, b->first);
}

#define INLINE static inline __attribute__((always_inline))

INLINE void Gather(const PetscInt nodes, const MpmBlock *b, PetscInt stride, const PetscReal *restrict weight,
                   PetscReal a, PetscReal *restrict particle, const PetscReal *restrict node)
{
  for (PetscInt p = 0; p < b->n; p++) {
    const PetscReal *at  = node + b->first[p];
    PetscReal        sum = 0;

    for (PetscInt d = 0; d < nodes; d++) sum += weight[d * stride + p] * at[d];
    particle[p] += a * sum;
  }
}

/*
   Sums stay in registers while particles have the same nodes, and move on when the nodes do: a sum in memory would wait
   for the one before it to be stored.
*/
INLINE void Spread(const PetscInt nodes, const MpmBlock *b, PetscInt stride, const PetscReal *restrict weight,
                   PetscReal a, const PetscReal *restrict particle, PetscReal *restrict node)
{
  PetscReal  sum[MPM_MOST_NODES] = {0};
  PetscReal *at                  = node + b->first[0];

  for (PetscInt p = 0; p < b->n; p++) {
    const PetscReal  given = a * particle[p];
    PetscReal *const next  = node + b->first[p];

    if (next == at + 1) {
      at[0] += sum[0];
      for (PetscInt d = 0; d < nodes - 1; d++) sum[d] = sum[d + 1];
      sum[nodes - 1] = 0;
    } else if (next != at) {
      for (PetscInt d = 0; d < nodes; d++) {
        at[d] += sum[d];
        sum[d] = 0;
      }
    }
    at = next;
    for (PetscInt d = 0; d < nodes; d++) sum[d] += weight[d * stride + p] * given;
  }
  for (PetscInt d = 0; d < nodes; d++) at[d] += sum[d];
}

/* Calls a map with the number of nodes as a constant where they are few. */
#define OF_NODES(Map)                                                                                                  \
  do {                                                                                                                 \
    if (nodes == 2)                                                                                                    \
      Map(2, b, stride, weight, a, particle, node);                                                                    \
    else if (nodes == 3)                                                                                               \
      Map(3, b, stride, weight, a, particle, node);                                                                    \
    else if (nodes == 4)                                                                                               \
      Map(4, b, stride, weight, a, particle, node);                                                                    \
    else                                                                                                               \
      Map(nodes, b, stride, weight, a, particle, node);                                                                \
  } while (0)

void MpmWeightsGather(const MpmBlock *b, PetscInt nodes, PetscInt stride, const PetscReal *restrict weight, PetscReal a,
                      PetscReal *restrict particle, const PetscReal *restrict node)
{
  OF_NODES(Gather);
}

void MpmWeightsSpread(const MpmBlock *b, PetscInt nodes, PetscInt stride, const PetscReal *restrict weight, PetscReal a,
                      const PetscReal *restrict particle, PetscReal *restrict node)
{
  OF_NODES(Spread);
}

void MpmScale(PetscInt n, PetscReal a, PetscReal *restrict particle)
{
  if (a == 0)
    for (PetscInt p = 0; p < n; p++) particle[p] = 0; /* NaN and infinity too */
  else
    for (PetscInt p = 0; p < n; p++) particle[p] *= a;
}

void MpmPlaceBlock(PetscInt n, const PetscInt *restrict cell0, const PetscReal *restrict xi0, PetscInt whole,
                   PetscReal part, PetscInt *restrict cell, PetscReal *restrict xi)
{
  for (PetscInt p = 0; p < n; p++) {
    const PetscReal place = xi0[p] + part;
    const PetscInt  next  = place >= 1 - 0x1p-52;

    cell[p] = cell0[p] + whole + next;
    xi[p]   = next ? PetscMax(place - 1, 0) : place;
  }
}

/* Several sums run side by side, because each addition of one sum must wait for the one before it. */
PetscReal MpmSumSquares(PetscInt n, const PetscReal *restrict q)
{
  enum { SIDE = 32 };
  PetscReal part[SIDE] = {0};
  PetscInt  p;

  for (p = 0; p + SIDE <= n; p += SIDE)
    for (int i = 0; i < SIDE; i++) part[i] += q[p + i] * q[p + i];
  for (int i = 0; i < n - p; i++) part[i] += q[p + i] * q[p + i];
  for (int half = SIDE / 2; half > 0; half /= 2)
    for (int i = 0; i < half; i++) part[i] += part[i + half];
  return part[0];
}

void MpmNodeAdd(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] += a * f[i];
}

void MpmNodeCopy(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] = a * f[i];
}
