/* Stretches particles, and moves them. */
#include "scheme/deform.h"
#include "scheme/material/tensors.h"
#include <math.h>

INLINE PetscReal Determinant(const int dim, const PetscReal f[])
{
  if (dim == 1) return f[0];
  if (dim == 2) return f[0] * f[3] - f[1] * f[2];
  return f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) + f[2] * (f[3] * f[7] - f[4] * f[6]);
}

PetscReal MpmDeterminant(PetscInt dim, const PetscReal F[])
{
  return dim == 1 ? Determinant(1, F) : dim == 2 ? Determinant(2, F) : Determinant(3, F);
}

/* Returns the number of particles whose determinant is not positive and finite, in an integer as wide as the numbers. */
INLINE PetscInt64 Stretch(const int dim, PetscInt n, const PetscReal twice, PetscReal *const F[],
                          const PetscReal *const L[])
{
  PetscReal       *f[9];
  const PetscReal *l[9];
  PetscInt64       bad = 0;

  EACH (c, dim * dim) {
    f[c] = F[c];
    l[c] = L[c];
  }
  INDEPENDENT for (PetscInt p = 0; p < n; p++)
  {
    PetscReal old[9], some[9], now[9], det; /* now = old + L some, some = old + twice L old */

    EACH (c, dim * dim) now[c] = some[c] = old[c] = f[c][p];
    if (twice != 0) {
      EACH (a, dim)
        EACH (b, dim)
          EACH (c, dim) some[dim * a + b] += twice * l[dim * a + c][p] * old[dim * c + b];
    }
    EACH (a, dim)
      EACH (b, dim)
        EACH (c, dim) now[dim * a + b] += l[dim * a + c][p] * some[dim * c + b];
    EACH (c, dim * dim) f[c][p] = now[c];
    det = Determinant(dim, now);
    bad += det > 0 && det <= PETSC_MAX_REAL ? 0 : 1;
  }
  return bad;
}

INLINE PetscInt64 StretchIn(PetscInt dim, PetscInt n, const PetscReal twice, PetscReal *const F[],
                            const PetscReal *const L[])
{
  return dim == 1 ? Stretch(1, n, twice, F, L) : dim == 2 ? Stretch(2, n, twice, F, L) : Stretch(3, n, twice, F, L);
}

PetscInt MpmStretch(PetscInt dim, PetscInt n, PetscReal twice, PetscReal *const F[], const PetscReal *const L[])
{
  const PetscInt64 bad = twice == 0 ? StretchIn(dim, n, 0, F, L) : StretchIn(dim, n, twice, F, L);

  for (PetscInt p = 0; p < n && bad; p++) {
    PetscReal f[9], det;

    for (PetscInt c = 0; c < dim * dim; c++) f[c] = F[c][p];
    det = MpmDeterminant(dim, f);
    if (!(det > 0 && det <= PETSC_MAX_REAL)) return p;
  }
  return n;
}

/*
   A particle at the right end of the direction belongs to the cell at its left, as MpmLayoutPlace has it. Returns whether
   it is between the ends.
*/
static PetscBool IsInside(PetscInt cells, PetscInt first, PetscInt *cell, PetscReal *xi)
{
  if (*cell + first == cells && *xi == 0) {
    --*cell;
    *xi = nextafter(1, 0);
  }
  return *cell + first >= 0 && *cell + first < cells ? PETSC_TRUE : PETSC_FALSE;
}

PetscInt MpmAdvance(const MpmDirection *direction, PetscInt first, PetscInt   n, const PetscReal *restrict way,
                    PetscInt *restrict cell, PetscReal *restrict xi, PetscInt range[2])
{
  PetscInt lo = range[0], hi = range[1], far = 0, bad = n;

#pragma omp simd reduction(min : lo) reduction(max : hi) reduction(+ : far)
  for (PetscInt p = 0; p < n; p++) {
    const PetscBool stays = !(fabs(way[p]) < 1);
    const PetscReal place = xi[p] + (stays ? 0 : way[p]), down = floor(place), rest = place - down;
    const PetscInt  carry = rest >= 1; /* just left of a node, and rounded onto it */

    xi[p] = carry ? 0 : rest;
    cell[p] += (PetscInt)down + carry;
    far += stays;
    lo = PetscMin(lo, cell[p]);
    hi = PetscMax(hi, cell[p]);
  }
  range[0] = lo;
  range[1] = hi;
  for (PetscInt p = n - 1; p >= 0 && far; p--)
    if (!(fabs(way[p]) < 1)) bad = p;
  if (direction->ends[0] == MPM_PERIODIC || (lo + first >= 0 && hi + first < direction->cells)) return bad;
  for (PetscInt p = n - 1; p >= 0; p--)
    if (!IsInside(direction->cells, first, &cell[p], &xi[p])) bad = p;
  return bad;
}
