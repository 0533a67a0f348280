/*
   norm(A^n) is the largest singular value of the product of n steps. The product is never formed; it is applied as

     x -> A(n-1) ... A(0) x,   y -> A(0)^T ... A(n-1)^T y

   by Lanczos bidiagonalization (linalg/singular.h). After some steps the product is divided by a power of two, so that
   growth over any number of steps stays in range. One vector is followed once to find these powers. Where a smaller
   matrix has the powers of A, its products take the place of those of A (linalg/reduced.h).
*/
#include "analysis/search.h"
#include "base/farm.h"
#include "base/power_of_two.h"
#include "linalg/singular.h"
#include "scene/layout.h"
#include <mpmstab/errors.h>
#include "base/progress.h"
#include "analysis/transient.h"
#include "linalg/reduced.h"
#include <math.h>

#define EVERY 16          /* norms are computed at all steps up to this one, and later at spaced ones */
#define SPACING 1.25      /* ratio of spaced steps */
#define RESCALE_AT 64     /* exponent of two at which the product is rescaled */
#define BASIS 32          /* vectors of the Krylov space */
#define TOLERANCE 1e-6    /* relative residual; the error is about its square over the gap */
#define OF_NONZERO 12     /* bytes of a nonzero */
#define NORMS_DIFFER 1e-9 /* norms whose logarithms differ by less count as equal */
#define LATE 4            /* the power is fitted from step last / LATE on */
#define FEWEST 4          /* norms needed for a fit */

/*
   The steps of a period, and the power of two that is taken out after each of the product's n steps. powers: those of a
   smaller matrix, where there is one.
*/
typedef struct {
  PetscInt         n, period, exponent, *shift;
  Mat             *step;
  Vec              work[2], weights;
  PetscReal        nonzeros;
  PetscBool        smaller;
  MpmReducedPowers powers;
} Product;

/* The product of n steps, or its transpose, which takes the steps from the last one on. */
static PetscErrorCode Apply(Mat matrix, PetscBool transpose, Vec x, Vec y)
{
  Product *p;
  Vec      in = x;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &p));
  if (p->smaller) {
    PetscCall(MpmReducedPowersMult(&p->powers, p->n, p->shift, transpose, x, y));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < p->n; i++) {
    const PetscInt k   = transpose ? p->n - 1 - i : i;
    Vec            out = i == p->n - 1 ? y : p->work[i % 2];

    PetscCall((transpose ? MatMultTranspose : MatMult)(p->step[k % p->period], in, out));
    if (p->shift[k]) PetscCall(VecScale(out, scalbn(1, -(int)p->shift[k])));
    in = out;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Multiply(Mat matrix, Vec x, Vec y)
{
  return Apply(matrix, PETSC_FALSE, x, y);
}

static PetscErrorCode MultiplyTranspose(Mat matrix, Vec x, Vec y)
{
  return Apply(matrix, PETSC_TRUE, x, y);
}

static PetscErrorCode ProductCreate(const MpmOperator *op, const MpmReduced *nodal, PetscInt last, Product *p)
{
  PetscFunctionBegin;
  *p = (Product){.period = PetscMin(op->parts, last), .smaller = nodal ? PETSC_TRUE : PETSC_FALSE};
  PetscCall(PetscMalloc2(p->period, &p->step, last, &p->shift));
  for (PetscInt k = 0; k < p->period; k++) {
    Mat     A;
    MatInfo info;

    PetscCall(MpmOperatorStep(op, k, &A, &p->exponent));
    PetscCall(MpmOperatorWeigh(op, A, &p->step[k]));
    PetscCall(MatDestroy(&A));
    PetscCall(MatGetInfo(p->step[k], MAT_GLOBAL_SUM, &info));
    p->nonzeros += info.nz_used;
    if (k == 0 && op->layout)
      PetscCall(MpmLayoutCheckMemory(PetscObjectComm((PetscObject)op->A), op->layout,
                                     OF_NONZERO * p->nonzeros * p->period, "powers, with all steps of the period,"));
  }
  PetscCall(MatCreateVecs(p->step[0], &p->work[0], &p->work[1]));
  if (nodal) {
    PetscCall(MpmOperatorWeights(op, &p->weights));
    PetscCall(MpmReducedPowersCreate(nodal, p->weights, &p->powers));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ProductDestroy(Product *p)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < p->period; k++) PetscCall(MatDestroy(&p->step[k]));
  PetscCall(PetscFree2(p->step, p->shift));
  PetscCall(VecDestroy(&p->work[0]));
  PetscCall(VecDestroy(&p->work[1]));
  if (p->smaller) PetscCall(MpmReducedPowersDestroy(&p->powers));
  PetscCall(VecDestroy(&p->weights));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Finds the powers of two that keep the image of one vector near its size. finite: whether doubles can hold the image.
*/
static PetscErrorCode FindShifts(Product *p, Vec start, PetscInt last, PetscBool *finite)
{
  Vec       in, out;
  PetscReal norm;

  PetscFunctionBegin;
  *finite = PETSC_TRUE;
  PetscCall(PetscArrayzero(p->shift, last));
  PetscCall(VecDuplicate(start, &in));
  PetscCall(VecDuplicate(start, &out));
  PetscCall(VecCopy(start, in));
  for (PetscInt k = 0; k < last && *finite; k++) {
    PetscCall(MatMult(p->step[k % p->period], in, out));
    PetscCall(VecNorm(out, NORM_2, &norm));
    *finite     = isfinite(norm) ? PETSC_TRUE : PETSC_FALSE;
    p->shift[k] = MpmPowerToTakeOut(norm, RESCALE_AT);
    if (p->shift[k]) PetscCall(VecScale(out, scalbn(1, -(int)p->shift[k])));
    PetscCall(VecSwap(in, out));
  }
  PetscCall(VecDestroy(&in));
  PetscCall(VecDestroy(&out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt Next(PetscInt step, PetscInt last)
{
  return PetscMin(step < EVERY ? step + 1 : (PetscInt)ceil(SPACING * step), last);
}

static PetscErrorCode Norms(const MpmOperator *op, Product *p, PetscInt last, MpmTransient *t)
{
  PetscInt    rows, exponent = 0, done = 0, work = 0;
  PetscBool   finite;
  MpmProgress progress;
  Mat         matrix;
  Vec         start;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(p->step[0], &start, NULL));
  PetscCall(MpmSingularStart(0, start));
  PetscCall(FindShifts(p, start, last, &finite));
  PetscCall(VecGetLocalSize(start, &rows));
  PetscCall(MatCreateShell(PetscObjectComm((PetscObject)start), rows, rows, op->order, op->order, p, &matrix));
  PetscCall(MatShellSetOperation(matrix, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(MatShellSetOperation(matrix, MATOP_MULT_TRANSPOSE, (void (*)(void))MultiplyTranspose));
  for (PetscInt i = 0; i < t->n; i++) work += t->steps[i];
  PetscCall(MpmProgressBegin("steps of powers", &progress));
  for (PetscInt i = 1; i < t->n; i++) {
    PetscReal sigma = NAN;

    for (; p->n < t->steps[i]; p->n++) exponent += p->shift[p->n] + p->exponent;
    if (finite) PetscCall(MpmSingularLargest(matrix, start, BASIS, TOLERANCE, &sigma));
    t->norm[i]     = scalbn(sigma, (int)exponent);
    t->log_norm[i] = log(sigma) + exponent * log(2);
    if (isinf(t->norm[i])) t->norm[i] = NAN;
    if (isnan(sigma)) t->missing++;
    PetscCall(MpmProgressUpdate(&progress, done += t->steps[i], work));
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscCall(MatDestroy(&matrix));
  PetscCall(VecDestroy(&start));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Finds the largest norm, also relative to growth^n, and fits a power of n to the late steps by least squares. It is
   fitted to the largest norm(A^n) / growth^n so far, since the norms themselves may swing.
*/
static void Judge(PetscReal growth, MpmTransient *t)
{
  const PetscReal log_growth = log(growth);
  PetscReal       largest = -INFINITY, excess = -INFINITY, points = 0, mean[2] = {0}, product = 0, square = 0;

  for (PetscInt i = 0; i < t->n; i++) {
    const PetscReal x = log(t->steps[i]), y = t->log_norm[i] - t->steps[i] * log_growth;

    if (t->log_norm[i] > largest + NORMS_DIFFER) { /* the first of several that are equal */
      largest    = t->log_norm[i];
      t->largest = t->norm[i];
      t->at_step = t->steps[i];
    }
    if (y > excess + NORMS_DIFFER) {
      excess       = y;
      t->excess_at = t->steps[i];
    }
    if (!isfinite(excess) || t->steps[i] < PetscMax(1, t->steps[t->n - 1] / LATE)) continue;
    points++;
    mean[0] += (x - mean[0]) / points;
    mean[1] += (excess - mean[1]) / points;
    product += x * excess;
    square += x * x;
  }
  t->excess = isfinite(log_growth) ? exp(excess) : NAN;
  t->power  = points >= FEWEST ? (product - points * mean[0] * mean[1]) / (square - points * mean[0] * mean[0]) : NAN;
}

PetscErrorCode MpmTransientCreate(const MpmOperator *op, const MpmReduced *nodal, PetscInt last, PetscReal growth,
                                  MpmTransient **transient)
{
  const PetscReal begin = MPI_Wtime();
  const PetscInt  each  = op->period / op->parts;
  Product         product;
  MpmTransient   *t;

  PetscFunctionBegin;
  PetscCall(PetscNew(transient));
  t    = *transient;
  t->n = 1;
  last /= each;
  for (PetscInt step = 0; step < last; step = Next(step, last)) t->n++;
  PetscCall(PetscMalloc3(t->n, &t->steps, t->n, &t->norm, t->n, &t->log_norm));
  t->steps[0]    = 0;
  t->norm[0]     = 1;
  t->log_norm[0] = 0;
  for (PetscInt i = 1; i < t->n; i++) t->steps[i] = Next(t->steps[i - 1], last);
  PetscCall(ProductCreate(op, nodal, last, &product));
  PetscCall(Norms(op, &product, last, t));
  PetscCall(ProductDestroy(&product));
  for (PetscInt i = 0; i < t->n; i++) t->steps[i] *= each;
  Judge(growth, t);
  t->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTransientDestroy(MpmTransient **transient)
{
  PetscFunctionBegin;
  if (!*transient) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3((*transient)->steps, (*transient)->norm, (*transient)->log_norm));
  PetscCall(PetscFree(*transient));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the pseudospectrum ---- */

/*
   The pseudospectrum at the points of a square, and the Kreiss constant

     K = sup over abs(z) > 1 of (abs(z) - 1) / sigma(z)

   K is bounded from below by the largest value on circles outside the unit circle, at evenly spaced angles and at those
   of the eigenvalues near the circle. Then the best point is refined. A is real, so sigma(conj z) = sigma(z).
*/
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
