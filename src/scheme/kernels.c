/* Kernels on arrays, for particles and for nodes. The maps between the two are in scheme/basis. */
#include "scheme/kernels.h"

#define LONGEST 4 /* particles in a run: bases have loops up to this length */

/* Finds the runs of equal length; none (begin = end = n) if their lengths differ or are more than LONGEST. */
static void FindRuns(PetscInt n, const PetscInt first[], MpmBlock *b)
{
  PetscInt unlike = 0, begin = 0, length = 0;

  b->begin = b->end = n;
  b->length         = 0;
  while (begin < n && begin <= LONGEST && first[begin] == first[0]) begin++;
  while (begin + length < n && length <= LONGEST && first[begin + length] == first[begin]) length++;
  if (begin > LONGEST || length == 0 || length > LONGEST) return;
  for (PetscInt p = begin; p < n - length; p++) unlike |= first[p + length] - first[p] - 1;
  if (unlike) return;
  if (begin == length && first[begin] == first[0] + 1) begin = 0; /* the first run is complete too */
  b->begin  = begin;
  b->end    = n - (n - begin) % length;
  b->length = length;
}

void MpmBlockPlace(const MpmBasis *basis, PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscReal half_width,
                   const PetscInt wall[2], MpmBlock *b)
{
  b->n          = n;
  b->xi         = xi;
  b->half_width = half_width;
  b->wall[0]    = wall[0];
  b->wall[1]    = wall[1];
  basis->first_nodes(n, cell, xi, b->first);
  FindRuns(n, b->first, b);
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

void MpmNodeLaplacian(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] = a * ((f[i + 1] - f[i]) - (f[i] - f[i - 1]));
}

void MpmNodeAddLaplacian(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] += a * ((f[i + 1] - f[i]) - (f[i] - f[i - 1]));
}

void MpmNodeAdd(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] += a * f[i];
}

void MpmNodeCopy(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] = a * f[i];
}
