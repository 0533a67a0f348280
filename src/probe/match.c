/* Which numbers of two operators go with one another, by which factors, and where the operators differ. */
#include "probe/match.h"
#include "base/hash.h"
#include "base/text.h"
#include "linalg/small_eigen.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define PHASES 8      /* at which amplification factors are compared */
#define NOTHING 1e-12 /* a sum of squares below this, of the largest, couples nothing */
#define AS_GOOD 1e-9  /* of two ways that differ by as much, the one with more names in common is taken */

/*
   Both operators on the blocks of all distances that either has: A[((b n + u) n + v], n = sites x width; u = site x
   width + number. Those of the other side stand in its own order.
*/
typedef struct {
  const MpmMatchSide *side[2];
  PetscInt            nd, *d, n, width, sites;
  PetscReal          *A[2];
} Pair;

/* One way: the other's number for each, factors, what differs, and the fields with the same name. */
typedef struct {
  PetscInt  number[MPM_MATCH_WIDTH], named;
  PetscReal factor[MPM_MATCH_WIDTH], differ;
} Way;

/* ---- the two operators ---- */

/* The blocks of a side at the distances that either has, with its sites in order. */
static PetscErrorCode Place(Pair *p, int s)
{
  const MpmMatchSide *side     = p->side[s];
  const MpmBlocks     both[]   = {*p->side[0]->blocks, *p->side[1]->blocks};
  const PetscReal     weight[] = {s == 0, s == 1};
  const PetscInt      w = p->width, n = p->n;
  MpmBlocks           all;

  PetscFunctionBegin;
  PetscCall(MpmBlocksCombine(2, both, weight, &all));
  PetscCall(PetscMalloc1((size_t)all.n * n * n, &p->A[s]));
  for (PetscInt b = 0; b < all.n; b++)
    for (PetscInt u = 0; u < n; u++)
      for (PetscInt v = 0; v < n; v++)
        p->A[s][((size_t)b * n + u) * n + v] =
            all.A[((size_t)b * n + side->site[u / w] * w + u % w) * n + side->site[v / w] * w + v % w];
  p->nd = all.n;
  if (!p->d) PetscCall(PetscMalloc1(all.n * all.dim, &p->d));
  PetscCall(PetscArraycpy(p->d, all.d, all.n * all.dim));
  PetscCall(MpmBlocksFree(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- factors ---- */

/* Sums over blocks and sites of A_ij^2, A_ij B_ij and B_ij^2. */
static void Sums(const Pair *p, const PetscInt number[], PetscInt i, PetscInt j, PetscReal sums[3])
{
  const PetscInt n = p->n, w = p->width;

  sums[0] = sums[1] = sums[2] = 0;
  for (PetscInt b = 0; b < p->nd; b++)
    for (PetscInt k = 0; k < p->sites; k++)
      for (PetscInt l = 0; l < p->sites; l++) {
        const PetscReal one   = p->A[0][((size_t)b * n + k * w + i) * n + l * w + j];
        const PetscReal other = p->A[1][((size_t)b * n + k * w + number[i]) * n + l * w + number[j]];

        sums[0] += one * one;
        sums[1] += one * other;
        sums[2] += other * other;
      }
}

/* The factor e_i / e_j that entries i, j ask for, and how well they agree on it: the cosine of their angle. */
static PetscReal Agreement(const PetscReal sums[3], PetscReal *ratio)
{
  if (!(sums[0] > NOTHING) || !(sums[2] > 0)) return 0;
  *ratio = copysign(sqrt(sums[2] / sums[0]), sums[1]);
  return PetscAbsReal(sums[1]) / sqrt(sums[0] * sums[2]);
}

/* Grows a tree over the numbers from the first one, each time by the pair that agrees best (Prim 1957). */
static void FindFactors(const Pair *p, Way *way)
{
  PetscReal agree[MPM_MATCH_WIDTH][MPM_MATCH_WIDTH], ratio[MPM_MATCH_WIDTH][MPM_MATCH_WIDTH] = {{0}};
  PetscBool in[MPM_MATCH_WIDTH] = {PETSC_TRUE};

  for (PetscInt i = 0; i < p->width; i++) {
    way->factor[i] = 1;
    for (PetscInt j = 0; j < p->width; j++) {
      PetscReal sums[3];

      Sums(p, way->number, i, j, sums);
      agree[i][j] = Agreement(sums, &ratio[i][j]);
    }
  }
  for (PetscInt step = 1; step < p->width; step++) {
    PetscInt  next = MPM_NONE;
    PetscReal best = 0, factor = 1;

    for (PetscInt i = 0; i < p->width; i++)
      for (PetscInt j = 0; j < p->width; j++) {
        if (in[i] == in[j] || agree[i][j] <= best * (1 + AS_GOOD)) continue;
        best   = agree[i][j];
        next   = in[i] ? j : i;
        factor = in[i] ? way->factor[i] / ratio[i][j] : way->factor[j] * ratio[i][j];
      }
    if (next == MPM_NONE) break;
    in[next]          = PETSC_TRUE;
    way->factor[next] = factor;
  }
}

/* The other's entry in the units of the first. */
static PetscReal Other(const Pair *p, const Way *way, PetscInt b, PetscInt u, PetscInt v)
{
  const PetscInt w = p->width, i = u % w, j = v % w;
  const size_t   row = (size_t)b * p->n + u - i + way->number[i];

  return p->A[1][row * p->n + v - j + way->number[j]] * way->factor[j] / way->factor[i];
}

static void Differ(const Pair *p, Way *way)
{
  FindFactors(p, way);
  way->differ = 0;
  for (PetscInt b = 0; b < p->nd; b++)
    for (PetscInt u = 0; u < p->n; u++)
      for (PetscInt v = 0; v < p->n; v++) {
        const PetscReal one = p->A[0][((size_t)b * p->n + u) * p->n + v];

        way->differ = PetscMax(way->differ, PetscAbsReal(Other(p, way, b, u, v) - one));
      }
}

/* ---- ways ---- */

/* The other's place of component c of a field, in one of the orders of its kind. */
static PetscInt Component(const MpmMatchField *f, PetscInt dim, PetscBool second, PetscInt c)
{
  PetscInt before = 0;

  if (!second || f->size == 1) return c;
  if (f->kind == MPM_MATCH_MATRIX) return c % dim * dim + c / dim;
  if (f->kind != MPM_MATCH_TENSOR) return c;
  for (PetscInt a = 0; a < dim; a++) /* row by row: row a begins with its diagonal */
    for (PetscInt b = a; b < dim; b++) {
      if (before++ != c) continue;
      return a == b ? a : dim + c - a - 1;
    }
  return c;
}

static void Try(const Pair *p, const PetscInt partner[], PetscInt dim, Way *best)
{
  const MpmMatchSide *one = p->side[0], *other = p->side[1];

  for (int orders = 0; orders < 4; orders++) {
    Way way = {.named = 0};

    for (PetscInt f = 0; f < one->nfields; f++) {
      const MpmMatchField *field  = &one->fields[f];
      const PetscBool      second = orders >> (field->kind == MPM_MATCH_MATRIX ? 1 : 0) & 1 ? PETSC_TRUE : PETSC_FALSE;

      for (PetscInt c = 0; c < field->size; c++)
        way.number[field->first + c] = other->fields[partner[f]].first + Component(field, dim, second, c);
      way.named += !strcasecmp(field->name, other->fields[partner[f]].name);
    }
    Differ(p, &way);
    if (way.differ < best->differ - AS_GOOD || (way.differ < best->differ + AS_GOOD && way.named > best->named))
      *best = way;
  }
}

/* Goes through all ways in which fields from f on have partners of their size. */
static void TryFields(const Pair *p, PetscInt f, PetscInt partner[], PetscInt dim, Way *best)
{
  const MpmMatchSide *one = p->side[0], *other = p->side[1];

  if (f == one->nfields) {
    Try(p, partner, dim, best);
    return;
  }
  for (PetscInt g = 0; g < other->nfields; g++) {
    PetscBool taken = PETSC_FALSE;

    for (PetscInt e = 0; e < f; e++)
      if (partner[e] == g) taken = PETSC_TRUE;
    if (taken || other->fields[g].size != one->fields[f].size) continue;
    partner[f] = g;
    TryFields(p, f + 1, partner, dim, best);
  }
}

/* ---- what differs ---- */

static int BySize(const void *one, const void *other)
{
  const MpmDifference *p = one, *q = other;

  return p->differ != q->differ ? (p->differ > q->differ ? -1 : 1) : 0;
}

static PetscInt FieldOf(const MpmMatchSide *s, PetscInt number)
{
  PetscInt f = 0;

  while (f + 1 < s->nfields && s->fields[f + 1].first <= number) f++;
  return f;
}

static void ListDifferences(const Pair *p, const Way *way, PetscReal bound, MpmMatch *m)
{
  const MpmMatchSide *one = p->side[0];

  for (PetscInt b = 0; b < p->nd; b++)
    for (PetscInt to = 0; to < one->nfields; to++)
      for (PetscInt from = 0; from < one->nfields; from++) {
        MpmDifference most = {.to = to, .from = from, .differ = 0};

        for (PetscInt u = 0; u < p->n; u++)
          for (PetscInt v = 0; v < p->n; v++) {
            const PetscReal value = p->A[0][((size_t)b * p->n + u) * p->n + v], other = Other(p, way, b, u, v);

            if (FieldOf(one, u % p->width) != to || FieldOf(one, v % p->width) != from) continue;
            if (!(PetscAbsReal(other - value) > most.differ)) continue;
            most.one    = value;
            most.other  = other;
            most.differ = PetscAbsReal(other - value);
          }
        for (PetscInt a = 0; a < one->blocks->dim; a++) most.d[a] = p->d[b * one->blocks->dim + a];
        if (most.differ > bound && m->n < MPM_DIFFERENCES) m->differences[m->n++] = most;
      }
  qsort(m->differences, (size_t)m->n, sizeof *m->differences, BySize);
}

/* ---- amplification factors, which need no partners ---- */

/* The largest distance of those that are fewer from the nearest of the others, each of which is taken once. */
static PetscErrorCode CompareAt(const MpmSource source[2], const PetscReal beta[], MpmMatch *m)
{
  const int     few = source[0].size <= source[1].size ? 0 : 1;
  MpmSmallEigen eigen[2];
  PetscBool    *taken;
  PetscInt      exponent;

  PetscFunctionBegin;
  for (int s = 0; s < 2; s++) {
    PetscCall(MpmSmallEigenCreate(source[s].size, &eigen[s]));
    PetscCall(MpmSourceMatrix(&source[s], beta, eigen[s].matrix, &exponent));
    PetscCall(MpmSmallEigenSolve(&eigen[s], PETSC_FALSE));
  }
  PetscCall(PetscCalloc1(eigen[1 - few].n, &taken));
  for (PetscInt i = 0; i < eigen[few].n; i++) {
    PetscReal nearest = INFINITY;
    PetscInt  at      = 0;

    for (PetscInt j = 0; j < eigen[1 - few].n; j++) {
      const PetscReal distance = cabs(eigen[few].value[i] - eigen[1 - few].value[j]);

      if (taken[j] || distance >= nearest) continue;
      nearest = distance;
      at      = j;
    }
    taken[at]  = PETSC_TRUE;
    m->factors = PetscMax(m->factors, nearest);
  }
  for (PetscInt j = 0; j < eigen[1 - few].n; j++)
    if (!taken[j]) m->most = PetscMax(m->most, cabs(eigen[1 - few].value[j]));
  m->more[1 - few] = eigen[1 - few].n - eigen[few].n;
  PetscCall(PetscFree(taken));
  for (int s = 0; s < 2; s++) PetscCall(MpmSmallEigenDestroy(&eigen[s]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CompareFactors(const MpmMatchSide *one, const MpmMatchSide *other, MpmMatch *m)
{
  MpmSource source[2];

  PetscFunctionBegin;
  PetscCall(MpmBlocksSource(one->blocks, "one", &source[0]));
  PetscCall(MpmBlocksSource(other->blocks, "other", &source[1]));
  for (PetscInt i = 0; i < PHASES; i++) {
    PetscReal beta[MPM_MAX_DIM];

    for (PetscInt a = 0; a < MPM_MAX_DIM; a++) beta[a] = 2 * PETSC_PI * MpmHash(81, i * MPM_MAX_DIM + a);
    PetscCall(CompareAt(source, beta, m));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which numbers each side keeps, as v 2, s 3. */
static void ListFields(const MpmMatchSide *one, const MpmMatchSide *other, MpmMatch *m)
{
  const MpmMatchSide *const sides[] = {one, other};
  char                      text[32];

  for (int s = 0; s < 2; s++) {
    MpmTextJoin(m->why_not, s ? "; yours keeps" : "ours keeps", sizeof m->why_not);
    for (PetscInt f = 0; f < sides[s]->nfields; f++) {
      MpmTextJoin(m->why_not, f ? ", " : " ", sizeof m->why_not);
      MpmTextJoin(m->why_not, sides[s]->fields[f].name, sizeof m->why_not);
      (void)snprintf(text, sizeof text, " (%" PetscInt_FMT ")", sides[s]->fields[f].size);
      MpmTextJoin(m->why_not, text, sizeof m->why_not);
    }
  }
}

PetscErrorCode MpmMatchFind(const MpmMatchSide *one, const MpmMatchSide *other, PetscReal bound, MpmMatch *m)
{
  Pair     p    = {.side = {one, other}, .n = one->sites * one->width, .width = one->width, .sites = one->sites};
  Way      best = {.differ = INFINITY};
  PetscInt partner[MPM_MATCH_WIDTH];

  PetscFunctionBegin;
  *m = (MpmMatch){.fits = PETSC_FALSE};
  PetscCall(CompareFactors(one, other, m));
  if (one->width == other->width && one->width <= MPM_MATCH_WIDTH && one->nfields == other->nfields) {
    for (int s = 0; s < 2; s++) PetscCall(Place(&p, s));
    TryFields(&p, 0, partner, one->blocks->dim, &best);
    m->fits = isfinite(best.differ) ? PETSC_TRUE : PETSC_FALSE;
  }
  if (m->fits) {
    m->differ = best.differ;
    PetscCall(PetscArraycpy(m->number, best.number, p.width));
    PetscCall(PetscArraycpy(m->factor, best.factor, p.width));
    ListDifferences(&p, &best, bound, m);
  } else
    ListFields(one, other, m);
  for (int s = 0; s < 2; s++) PetscCall(PetscFree(p.A[s]));
  PetscCall(PetscFree(p.d));
  PetscFunctionReturn(PETSC_SUCCESS);
}
