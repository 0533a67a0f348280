/*
   The pseudospectrum at the points of a square, and the Kreiss constant

     K = sup over abs(z) > 1 of (abs(z) - 1) / sigma(z)

   K is bounded from below by the largest value on circles outside the unit circle, at evenly spaced angles and at those
   of the eigenvalues near the circle. Then the best point is refined. A is real, so sigma(conj z) = sigma(z).
*/
#include "symbol/predict.h"
#include <mpmstab/critical.h>
#include "base/farm.h"
#include "analysis/pseudospectrum.h"
#include "analysis/search.h"
#include <math.h>

#define HALF_WIDTH 1.3 /* of the square; a spectrum that needs more gets WIDER times its own */
#define WIDER 1.1
#define ANGLES 48       /* evenly spaced in [0, pi] */
#define CIRCLES 5       /* log10 of their distance goes from 0 down to that of MPM_KREISS_NEAREST */
#define OUTER 3         /* the outer circles, which evenly spaced angles can resolve */
#define NEAR_CIRCLE 0.1 /* eigenvalues this near to the unit circle give angles */
#define APART 1e-3      /* least difference of two such angles */
#define ROUNDS 3        /* rounds of golden section in angle and distance */
#define BEYOND 1e-9     /* relative difference by which one quotient counts as larger than another */

PetscErrorCode MpmPseudospectrumCheck(const char what[], PetscInt64 order)
{
  PetscFunctionBegin;
  MpmCheckInput(order <= MPM_RESOLVENT_ORDER,
                "%s: the pseudospectrum of %" PetscInt64_FMT
                " unknowns; allowed: at most %d, so fewer cells ('-powers' has no such limit)",
                what, order, MPM_RESOLVENT_ORDER);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Points z: first those of the upper half of the square, then those outside the circle. */
typedef struct {
  MpmResolvent   *resolvent;
  PetscInt        n, square;
  double complex *z;
  PetscReal      *sigma;
} Points;

static double complex Outside(PetscReal log10_distance, PetscReal angle)
{
  return (1 + pow(10, log10_distance)) * cexp(I * angle);
}

static PetscReal Circle(PetscInt c)
{
  return c * log10(MPM_KREISS_NEAREST) / (CIRCLES - 1);
}

/* Lists the angles in [0, pi] of the eigenvalues near the circle, each once. */
static PetscErrorCode Angles(const MpmResolvent *r, PetscInt *n, PetscReal angle[])
{
  PetscInt found = 0;

  PetscFunctionBegin;
  *n = 0;
  for (PetscInt i = 0; i < r->n; i++)
    if (cabs(r->eigenvalue[i]) >= 1 - NEAR_CIRCLE) angle[found++] = fabs(carg(r->eigenvalue[i]));
  PetscCall(PetscSortReal(found, angle));
  for (PetscInt i = 0; i < found; i++)
    if (!*n || angle[i] >= angle[*n - 1] + APART) angle[(*n)++] = angle[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PointsCreate(const MpmPseudospectrum *s, const MpmResolvent *r, Points *p)
{
  const PetscInt half = (s->points + 1) / 2;
  PetscInt       eigen;
  PetscReal     *angle;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(r->n, &angle));
  PetscCall(Angles(r, &eigen, angle));
  p->square = half * s->points;
  p->n      = p->square + (isinf(s->kreiss) ? 0 : OUTER * ANGLES + CIRCLES * eigen);
  PetscCall(PetscMalloc1(p->n, &p->z));
  PetscCall(PetscCalloc1(p->n, &p->sigma));
  for (PetscInt i = 0; i < p->square; i++) p->z[i] = s->re[i % s->points] + I * s->re[i / s->points];
  for (PetscInt i = p->square, c = 0; i < p->n; c++) {
    for (PetscInt a = 0; a < ANGLES && c < OUTER; a++) p->z[i++] = Outside(Circle(c), PETSC_PI * a / (ANGLES - 1));
    for (PetscInt a = 0; a < eigen; a++) p->z[i++] = Outside(Circle(c), angle[a]);
  }
  PetscCall(PetscFree(angle));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Sigma(void *context, PetscInt i)
{
  Points *p = context;

  PetscFunctionBegin;
  PetscCall(MpmResolventSigma(p->resolvent, p->z[i], &p->sigma[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  MpmResolvent *resolvent;
  PetscReal     place[2]; /* log10 of the distance from the circle, and the angle */
  int           free;     /* index of the coordinate that is searched along */
} Search;

static PetscErrorCode MinusQuotient(void *context, PetscReal x, PetscReal *value)
{
  Search        *s = context;
  double complex z;
  PetscReal      sigma;

  PetscFunctionBegin;
  s->place[s->free] = x;
  z                 = Outside(s->place[0], s->place[1]);
  PetscCall(MpmResolventSigma(s->resolvent, z, &sigma));
  *value = -(cabs(z) - 1) / sigma;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refines the best point by golden section, in angle and distance in turn. The brackets shrink from round to round. */
static PetscErrorCode Refine(MpmResolvent *r, MpmPseudospectrum *s)
{
  const PetscReal nearest  = log10(MPM_KREISS_NEAREST);
  PetscReal       place[2] = {log10(cabs(s->kreiss_at) - 1), carg(s->kreiss_at)}, x, value;
  Search          search   = {.resolvent = r};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 2 * ROUNDS; i++) {
    const int       d     = (int)(1 - i % 2);
    const PetscReal width = (d ? PetscMin(PETSC_PI / ANGLES, 2 * pow(10, place[0])) : -Circle(1)) / (1 + i / 2);

    search = (Search){.resolvent = r, .place = {place[0], place[1]}, .free = d};
    PetscCall(MpmSearchLeast(MinusQuotient, &search, MPM_SEARCH_GOLDEN,
                             d ? place[d] - width : PetscMax(place[d] - width, nearest), place[d] + width, &x, &value));
    if (!(-value > s->kreiss * (1 + BEYOND))) continue; /* rounding alone has moved it */
    place[d]     = x;
    s->kreiss    = -value;
    s->kreiss_at = Outside(place[0], place[1]);
  }
  if (place[0] > nearest + 0.5) PetscFunctionReturn(PETSC_SUCCESS);
  search = (Search){.resolvent = r, .place = {0, place[1]}};
  PetscCall(MinusQuotient(&search, place[0] + 1, &value));
  s->edge_power = PetscMax(0, log10(s->kreiss / -value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Kreiss(MpmResolvent *r, const Points *p, MpmPseudospectrum *s)
{
  PetscReal found[4];

  PetscFunctionBegin;
  if (isinf(s->kreiss)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < p->n; i++) {
    const PetscReal distance = cabs(p->z[i]) - 1;

    if (distance < MPM_KREISS_NEAREST * (1 - 1e-9) || !(distance / p->sigma[i] > s->kreiss * (1 + BEYOND))) continue;
    s->kreiss    = distance / p->sigma[i];
    s->kreiss_at = p->z[i];
  }
  if (MpmRankOf(PETSC_COMM_WORLD) == 0 && s->kreiss > 1) PetscCall(Refine(r, s));
  found[0] = s->kreiss;
  found[1] = creal(s->kreiss_at);
  found[2] = fabs(cimag(s->kreiss_at)) > BEYOND ? fabs(cimag(s->kreiss_at)) : 0;
  found[3] = s->edge_power;
  PetscCallMPI(MPI_Bcast(found, 4, MPIU_REAL, 0, PETSC_COMM_WORLD));
  s->kreiss     = found[0];
  s->kreiss_at  = found[1] + I * found[2];
  s->edge_power = found[3];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPseudospectrumCreate(Mat A, PetscInt points, PetscReal tolerance, MpmPseudospectrum **pseudospectrum)
{
  const PetscReal    begin = MPI_Wtime();
  MpmPseudospectrum *s;
  MpmResolvent       r;
  Points             p;
  PetscReal          half;

  PetscFunctionBegin;
  PetscCall(PetscNew(pseudospectrum));
  s         = *pseudospectrum;
  s->points = points;
  PetscCall(MpmResolventCreate(A, &r));
  s->order = r.n;
  for (PetscInt i = 0; i < r.n; i++) s->radius = PetscMax(s->radius, cabs(r.eigenvalue[i]));
  s->kreiss    = s->radius > 1 + tolerance ? INFINITY : 1;
  s->kreiss_at = NAN;
  half         = PetscMax(HALF_WIDTH, WIDER * s->radius);
  PetscCall(PetscMalloc2(points, &s->re, points * points, &s->sigma));
  for (PetscInt j = 0; j < points; j++) s->re[j] = half * (2.0 * j - (points - 1)) / (points - 1);
  PetscCall(PointsCreate(s, &r, &p));
  p.resolvent = &r;
  PetscCall(MpmFarm("point of the pseudospectrum", p.n, Sigma, &p));
  PetscCall(MpmFarmSumReals(p.n, p.sigma));
  for (PetscInt i = 0; i < points; i++)
    for (PetscInt j = 0; j < points; j++) s->sigma[i * points + j] = p.sigma[PetscMin(i, points - 1 - i) * points + j];
  PetscCall(Kreiss(&r, &p, s));
  PetscCall(PetscFree(p.z));
  PetscCall(PetscFree(p.sigma));
  PetscCall(MpmResolventDestroy(&r));
  s->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPseudospectrumDestroy(MpmPseudospectrum **pseudospectrum)
{
  PetscFunctionBegin;
  if (!*pseudospectrum) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree2((*pseudospectrum)->re, (*pseudospectrum)->sigma));
  PetscCall(PetscFree(*pseudospectrum));
  PetscFunctionReturn(PETSC_SUCCESS);
}
