/*
   Stretches particles, moves them, and finds the stress ahead.

   The stress at a part a of a step, brought back to the start of the step. With the slopes L of a step, A = I + a L and
   J_A = det A,

     T = P(A F) F^T = tau(A F) A^-T = tau(A F) cof(A) / J_A

   P is the nominal stress of the particle, the derivative of the stored energy psi by F. So T : L is the rate at which
   psi(A F) grows with a, and the forces DIV T have a potential. The differential is

     dT = dtau(A F) A^-T - T dA^T A^-T,    d(A F) = dA F + A dF,    dA = a dL.
*/
#include "scheme/deform.h"
#include "scheme/material/tensors.h"
#include <math.h>

PetscReal MpmDeterminant(PetscInt dim, const PetscReal F[])
{
  return dim == 1 ? Volume(1, F) : dim == 2 ? Volume(2, F) : Volume(3, F);
}

/*
   Returns the number of particles whose determinant is not positive and finite, in an integer as wide as the numbers.
*/
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
    det = Volume(dim, now);
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
   A particle at the right end of the direction belongs to the cell at its left, as MpmLayoutPlace has it. Returns
   whether it is between the ends.
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

/* ---- the stress ahead ---- */

#define BLOCK 64

/* A block of n particles: A F, cof(A) / det(A), and room for the stress and for its differential. */
typedef struct {
  PetscInt         dim, n;
  PetscReal        F[9][BLOCK], inverse[9][BLOCK], tau[6][BLOCK], dF[9][BLOCK], dtau[6][BLOCK];
  const PetscReal *from[9], *along[9];
  PetscReal       *to[6], *dto[6];
} Ahead;

static void Multiply(PetscInt dim, const PetscReal A[], const PetscReal B[], PetscReal sum[])
{
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++)
      for (PetscInt c = 0; c < dim; c++) sum[dim * a + b] += A[dim * a + c] * B[dim * c + b];
}

static void Load(PetscInt n, PetscInt p, const PetscReal *const from[], PetscReal to[])
{
  for (PetscInt c = 0; c < n; c++) to[c] = from[c][p];
}

/* A = I + a L of a particle. */
static void StepOf(PetscInt dim, PetscReal a, PetscInt p, const PetscReal *const L[], PetscReal A[])
{
  for (PetscInt c = 0; c < dim * dim; c++) A[c] = a * L[c][p] + (c % (dim + 1) == 0);
}

/*
   Fills a block with particles from begin on, and their stress; returns the first whose det(A F) is not positive, which
   stays at F.
*/
static PetscInt Begin(const MpmMaterialNumbers *m, PetscInt dim, PetscInt begin, PetscInt n, PetscReal a,
                      const PetscReal *const L[], const PetscReal *const F[], Ahead *s)
{
  PetscInt bad = n;

  s->dim = dim;
  s->n   = n;
  for (PetscInt c = 0; c < dim * dim; c++) {
    s->from[c]  = s->F[c];
    s->along[c] = s->dF[c];
  }
  for (PetscInt c = 0; c < dim * (dim + 1) / 2; c++) {
    s->to[c]  = s->tau[c];
    s->dto[c] = s->dtau[c];
  }
  for (PetscInt p = n - 1; p >= 0; p--) {
    PetscReal A[9], old[9], now[9] = {0}, J, det;

    Load(dim * dim, begin + p, F, old);
    StepOf(dim, a, begin + p, L, A);
    Multiply(dim, A, old, now);
    J   = MpmDeterminant(dim, A);
    det = MpmDeterminant(dim, now);
    if (!(J > 0 && det > 0 && det <= PETSC_MAX_REAL)) {
      bad = p;
      J   = 1;
      for (PetscInt c = 0; c < dim * dim; c++) {
        now[c] = old[c];
        A[c]   = c % (dim + 1) == 0;
      }
    }
    for (PetscInt c = 0; c < dim * dim; c++) {
      s->F[c][p]       = now[c];
      s->inverse[c][p] = Cofactor(dim, A, c / dim, c % dim) / J;
    }
  }
  MpmMaterialStress(m, dim, n, s->from, s->to);
  return bad;
}

/* t A^-T of particle p, with a symmetric t. */
static void Pull(const Ahead *s, PetscInt p, const PetscReal t[], PetscReal sum[])
{
  const PetscInt dim = s->dim;

  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++)
      for (PetscInt c = 0; c < dim; c++) sum[dim * a + b] += Of(dim, t, a, c) * s->inverse[dim * c + b][p];
}

/* dA and A dF + dA F of a particle. */
static void Differ(const Ahead *s, PetscInt begin, PetscInt p, PetscReal a, const PetscReal *const L[],
                   const PetscReal *const F[], const PetscReal *const dL[], const PetscReal *const dF[], PetscReal dA[],
                   PetscReal dnow[])
{
  const PetscInt dim = s->dim;
  PetscReal      A[9], old[9], dold[9] = {0};

  Load(dim * dim, begin + p, F, old);
  StepOf(dim, a, begin + p, L, A);
  for (PetscInt c = 0; c < dim * dim; c++) {
    dA[c]   = dL ? a * dL[c][begin + p] : 0;
    dnow[c] = 0;
  }
  if (dF) Load(dim * dim, begin + p, dF, dold);
  Multiply(dim, A, dold, dnow);
  Multiply(dim, dA, old, dnow);
}

/* Sets out to T, or with differs to dT. Returns the first particle whose volume is not positive and finite, or n. */
static PetscInt Find(PetscBool differs, const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, PetscReal a,
                     const PetscReal *const L[], const PetscReal *const F[], const PetscReal *const dL[],
                     const PetscReal *const dF[], PetscReal *const out[])
{
  const PetscInt tensor = dim * dim, symmetric = dim * (dim + 1) / 2;
  PetscInt       bad = n;
  Ahead          s;

  for (PetscInt begin = 0; begin < n; begin += BLOCK) {
    const PetscInt count = PetscMin(n - begin, BLOCK), first = Begin(m, dim, begin, count, a, L, F, &s);
    PetscReal      dA[BLOCK][9];

    if (first < count) bad = PetscMin(bad, begin + first);
    for (PetscInt p = 0; p < count && differs; p++) {
      PetscReal dnow[9];

      Differ(&s, begin, p, a, L, F, dL, dF, dA[p], dnow);
      for (PetscInt c = 0; c < tensor; c++) s.dF[c][p] = dnow[c];
    }
    if (differs) MpmMaterialTangent(m, dim, count, s.from, s.along, s.dto);
    for (PetscInt p = 0; p < count; p++) {
      PetscReal tau[6], dtau[6], T[9] = {0}, turned[9] = {0}, sum[9] = {0};

      Load(symmetric, p, (const PetscReal *const *)s.to, tau);
      Pull(&s, p, tau, T);
      if (differs) Load(symmetric, p, (const PetscReal *const *)s.dto, dtau);
      if (differs) Pull(&s, p, dtau, sum);
      for (PetscInt i = 0; i < dim * tensor && differs; i++) /* T dA^T */
        turned[i / dim] += T[i / dim / dim * dim + i % dim] * dA[p][i / dim % dim * dim + i % dim];
      for (PetscInt c = 0; c < tensor; c++) {
        for (PetscInt d = 0; d < dim && differs; d++)
          sum[c] -= turned[c / dim * dim + d] * s.inverse[dim * d + c % dim][p];
        out[c][begin + p] = differs ? sum[c] : T[c];
      }
    }
  }
  return bad;
}

PetscInt MpmStressAhead(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, PetscReal a, const PetscReal *const L[],
                        const PetscReal *const F[], PetscReal *const T[])
{
  return Find(PETSC_FALSE, m, dim, n, a, L, F, NULL, NULL, T);
}

void MpmStressAheadTangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, PetscReal a,
                           const PetscReal *const L[], const PetscReal *const F[], const PetscReal *const dL[],
                           const PetscReal *const dF[], PetscReal *const dT[])
{
  (void)Find(PETSC_TRUE, m, dim, n, a, L, F, dL, dF, dT);
}
