/*
   Amplification factors along a line, here called eigenvalues: l_i(x) are those at x, in any order.

   With the derivatives at both ends of a step h, the difference

     abs(l_j(x + h) - l_i(x) - h (l_i' + l_j') / 2)

   is of order h^3 when j is the continuation of i. This is how eigenvalues are matched. For two that come near each
   other the functions

     S = (l1 + l2) / 2,   Q = (l1 - l2)^2 / 4,   with l = S +- sqrt(Q)

   are smooth. On the unit circle Q / S^2 is negative. Where it becomes positive a window of growth is open, in which
   abs is at most 1 + sqrt(Q / S^2).
*/
#include "analysis/follow.h"
#include "analysis/search.h"
#include <mpmstab/verdict.h>
#include <math.h>

#define TURN 0.3      /* largest distance that an eigenvalue moves in a step */
#define RATIO 0.5     /* largest step over its place */
#define BESIDE 1e-2   /* distance at which derivatives are taken, over the step, */
#define CLOSER 1e-4   /* and at a meeting, over the distance between the two places of its model */
#define COINCIDE 3e-8 /* eigenvalues nearer than this share a derivative: rounding splits a defective one so far */
#define NOISE 1e-6    /* rounding of the derivatives may move an eigenvalue so far from its prediction */
#define INSIDE 0.3    /* eigenvalues of smaller abs are ignored until they have grown to it */
#define HARMLESS 0.7  /* abs of eigenvalues that need not be told apart */
#define MATCHED 0.1   /* largest distance from a prediction, over the distance that the fastest one moves */
#define NEAR 0.5      /* two that come nearer than this, over the distance that they move past each other, may meet */
#define FIRST 0.1     /* first step over the first place */
#define LEAST 1e-5    /* least step over its place */
#define NARROW 1e-10  /* least distance of two places of a model, over the place */
#define LEAST_GROWING 1e-3 /* least step over its place towards growth; bisection takes it from there */
#define PRECISION 1e-10    /* relative width of a bracket */
#define RISE 0.1           /* of the tolerance: the least rise between two places that is looked at */
#define CLOSE 1e-4         /* distance from the tolerance that such a rise must reach */
#define MOST_LOOKS 300     /* places at one meeting */
#define SAFE 2             /* factor on the error of a model */
#define CIRCLE 8           /* factor on that: distance from the circle of the model of two eigenvalues on it */
#define STRAIGHT 3         /* divisions that go at once to a piece fine enough */
#define ENOUGH 1e-2        /* error of Q over the square of the tolerance */
#define GRID 16
#define GOLDEN_STEPS 24
#define SAMPLES 3 /* the two ends of a step, and one place between */

struct MpmSample_ {
  PetscReal       x, largest; /* largest: logarithm of the largest abs */
  double complex *value, *slope;
};

/* The square of the absolute value, and the absolute value of numbers that are far from the ends of the range. */
static inline PetscReal Square(double complex z)
{
  return creal(z) * creal(z) + cimag(z) * cimag(z);
}

static inline PetscReal Abs(double complex z)
{
  return sqrt(Square(z));
}

PetscErrorCode MpmFollowCreate(PetscInt n, PetscInt period, PetscReal tolerance, MpmFactorsAt at, void *context,
                               MpmFollow *f)
{
  PetscFunctionBegin;
  *f = (MpmFollow){.n         = n,
                   .period    = period,
                   .tolerance = tolerance,
                   .most      = period * log1p(tolerance),
                   .doubtful  = INFINITY,
                   .allowed   = INT64_MAX,
                   .at        = at,
                   .context   = context};
  PetscCall(PetscMalloc4(SAMPLES, &f->samples, n, &f->beside, n, &f->match, n, &f->cost));
  for (int s = 0; s < SAMPLES; s++) PetscCall(PetscMalloc2(n, &f->samples[s].value, n, &f->samples[s].slope));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFollowDestroy(MpmFollow *f)
{
  PetscFunctionBegin;
  if (!f->samples) PetscFunctionReturn(PETSC_SUCCESS);
  for (int s = 0; s < SAMPLES; s++) PetscCall(PetscFree2(f->samples[s].value, f->samples[s].slope));
  PetscCall(PetscFree4(f->samples, f->beside, f->match, f->cost));
  PetscCall(PetscFree(f->meetings));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal LogLargest(PetscInt n, const double complex value[])
{
  PetscReal largest = 0;

  for (PetscInt i = 0; i < n; i++) largest = fmax(largest, cabs(value[i]));
  return log(largest);
}

/* largest: the logarithm of the largest abs. */
static PetscErrorCode GrowthAt(MpmFollow *f, PetscReal x, PetscReal *largest)
{
  PetscFunctionBegin;
  PetscCall(f->at(f->context, x, f->beside));
  f->evaluations++;
  *largest = LogLargest(f->n, f->beside);
  f->peak  = fmax(f->peak, *largest / f->period);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFollowGrowth(void *context, PetscReal x, PetscReal *growth)
{
  MpmFollow *f = (MpmFollow *)context;
  PetscReal  largest;

  PetscFunctionBegin;
  PetscCall(GrowthAt(f, x, &largest));
  *growth = exp(largest / f->period);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Narrows a bracket, at whose ends growth is known. */
static PetscErrorCode Narrow(MpmFollow *f, PetscReal bracket[2])
{
  const MpmSearchSteps steps = {
      .from = bracket[0], .to = bracket[1], .ratio = INFINITY, .width = bracket[1] - bracket[0]};

  PetscFunctionBegin;
  PetscCall(MpmSearchFirst(MpmFollowGrowth, f, f->tolerance, &steps, PRECISION, bracket));
  bracket[1] = fmin(bracket[1], steps.to);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Eigenvalues that coincide have no derivatives of their own. They get the mean of their derivatives, which exists. */
static void MoveTogether(const MpmFollow *f, MpmSample *s)
{
  for (PetscInt i = 0; i < f->n; i++) {
    double complex sum   = 0;
    PetscInt       count = 0;

    for (PetscInt j = 0; j < f->n; j++) {
      if (Abs(s->value[j] - s->value[i]) > COINCIDE) continue;
      sum += s->slope[j];
      count++;
    }
    f->beside[i] = sum / count;
  }
  for (PetscInt i = 0; i < f->n; i++) s->slope[i] = f->beside[i];
}

/* Computes the eigenvalues at x, and their derivatives from those at x + d. */
static PetscErrorCode Look(MpmFollow *f, PetscReal x, PetscReal d, MpmSample *s)
{
  PetscFunctionBegin;
  s->x = x;
  PetscCall(f->at(f->context, x, s->value));
  s->largest = LogLargest(f->n, s->value);
  f->peak    = fmax(f->peak, s->largest / f->period);
  PetscCall(f->at(f->context, x + d, f->beside));
  f->evaluations += 2;
  for (PetscInt i = 0; i < f->n; i++) {
    PetscInt nearest = i;

    for (PetscInt j = i + 1; j < f->n; j++)
      if (Abs(f->beside[j] - s->value[i]) < Abs(f->beside[nearest] - s->value[i])) nearest = j;
    s->slope[i]        = (f->beside[nearest] - s->value[i]) / d;
    f->beside[nearest] = f->beside[i];
  }
  if (s->largest < INFINITY) MoveTogether(f, s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool Counts(const MpmSample *s, PetscInt i)
{
  return Abs(s->value[i]) >= INSIDE ? PETSC_TRUE : PETSC_FALSE;
}

static PetscReal Fastest(const MpmFollow *f, const MpmSample *s)
{
  PetscReal speed = 0;

  for (PetscInt i = 0; i < f->n; i++)
    if (Counts(s, i)) speed = fmax(speed, Abs(s->slope[i]));
  return speed;
}

/* Two eigenvalues at a place: S = (l1 + l2) / 2 and Q = (l1 - l2)^2 / 4, with derivatives. */
typedef struct {
  PetscReal      x;
  double complex S, dS, Q, dQ;
} Pair;

static Pair PairOf(const MpmSample *s, PetscInt i, PetscInt j)
{
  const double complex d = s->value[i] - s->value[j];

  return (Pair){s->x, (s->value[i] + s->value[j]) / 2, (s->slope[i] + s->slope[j]) / 2, d * d / 4,
                d * (s->slope[i] - s->slope[j]) / 2};
}

/*
   Of the eigenvalues that are not where they were predicted, finds the one nearest to i. Returns -1 when there is none.
*/
static PetscInt Partner(const MpmFollow *f, const MpmSample *a, PetscInt i, PetscReal allowed)
{
  PetscInt nearest = -1;

  for (PetscInt j = 0; j < f->n; j++)
    if (j != i && f->cost[j] > allowed &&
        (nearest < 0 || Abs(a->value[j] - a->value[i]) < Abs(a->value[nearest] - a->value[i])))
      nearest = j;
  return nearest;
}

/* Returns whether S and Q of a pair are where they were predicted. */
static PetscBool MatchPair(const MpmSample *a, const MpmSample *b, PetscInt i, PetscInt j, PetscReal allowed)
{
  const Pair      p = PairOf(a, i, j), q = PairOf(b, i, j);
  const PetscReal h = b->x - a->x;

  return Abs(q.S - p.S - h / 2 * (p.dS + q.dS)) <= allowed &&
                 Abs(q.Q - p.Q - h / 2 * (p.dQ + q.dQ)) <= MATCHED * (Abs(p.Q) + Abs(q.Q)) + allowed * allowed
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/*
   Brings the eigenvalues at b into the order of those at a, nearest to their predictions. Returns whether all are where
   they were predicted: each by itself, or two together that meet in between. Then match[i] is the other one of the two,
   and otherwise -1.
*/
static PetscBool Match(MpmFollow *f, const MpmSample *a, MpmSample *b)
{
  const PetscReal h       = b->x - a->x;
  const PetscReal allowed = fmax(MATCHED * fmin(h * fmax(Fastest(f, a), Fastest(f, b)), TURN), NOISE);

  for (PetscInt i = 0; i < f->n; i++) f->cost[i] = 0;
  if (!(b->largest < INFINITY)) return PETSC_FALSE;
  for (PetscInt i = 0; i < f->n; i++) {
    const double complex middle = a->value[i] + h / 2 * a->slope[i];
    double complex       kept;
    PetscInt             best  = i;
    PetscReal            least = INFINITY;

    for (PetscInt j = i; j < f->n; j++) {
      const PetscReal cost = Abs(b->value[j] - h / 2 * b->slope[j] - middle);

      if (cost >= least) continue;
      best  = j;
      least = cost;
    }
    kept           = b->value[i];
    b->value[i]    = b->value[best];
    b->value[best] = kept;
    kept           = b->slope[i];
    b->slope[i]    = b->slope[best];
    b->slope[best] = kept;
    f->cost[i]     = Counts(a, i) || Counts(b, i) ? least : 0;
  }
  for (PetscInt i = 0; i < f->n; i++) {
    f->match[i] = f->cost[i] > allowed ? Partner(f, a, i, allowed) : -1;
    if (f->cost[i] > allowed && (f->match[i] < 0 || !MatchPair(a, b, i, f->match[i], allowed))) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Evaluates at x Hermite's cubic through values and derivatives at a and b. */
static double complex Cubic(PetscReal a, PetscReal b, double complex fa, double complex da, double complex fb,
                            double complex db, PetscReal x)
{
  const PetscReal h = b - a, t = (x - a) / h, r = 1 - t;

  return r * r * ((1 + 2 * t) * fa + t * h * da) + t * t * ((1 + 2 * r) * fb - r * h * db);
}

/* Evaluates the model of S and Q at x; returns the real part of Q / S^2. */
static PetscReal ModelAt(const Pair m[2], PetscReal x, double complex *S, double complex *Q)
{
  *S = Cubic(m[0].x, m[1].x, m[0].S, m[0].dS, m[1].S, m[1].dS, x);
  *Q = Cubic(m[0].x, m[1].x, m[0].Q, m[0].dQ, m[1].Q, m[1].dQ, x);
  return creal(*Q / (*S * *S));
}

typedef PetscReal (*OfModel)(const Pair m[2], PetscReal x);

/* Largest where the factors meet. */
static PetscReal RatioAt(const Pair m[2], PetscReal x)
{
  double complex S, Q;

  return ModelAt(m, x, &S, &Q);
}

/* The logarithm of the larger abs. */
static PetscReal LogAbsAt(const Pair m[2], PetscReal x)
{
  double complex S, Q, root;

  ModelAt(m, x, &S, &Q);
  root = csqrt(Q);
  return log(fmax(Square(S + root), Square(S - root))) / 2;
}

/* A function of a model, for a search of its largest value. */
typedef struct {
  OfModel     of;
  const Pair *m;
} Modelled;

static PetscErrorCode Minus(void *context, PetscReal x, PetscReal *value)
{
  const Modelled *f = (const Modelled *)context;

  PetscFunctionBegin;
  *value = -f->of(f->m, x);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The place in [lo, hi] where a function of the model is largest. */
static PetscErrorCode Largest(OfModel of, const Pair m[2], PetscReal lo, PetscReal hi, PetscReal *x)
{
  const PetscReal step = (hi - lo) / GRID;
  Modelled        f    = {of, m};
  PetscReal       at = lo, best = -INFINITY, value;

  PetscFunctionBegin;
  for (int i = 0; i <= GRID; i++) {
    value = of(m, lo + i * step);
    if (value <= best) continue;
    best = value;
    at   = lo + i * step;
  }
  PetscCall(MpmSearchLeast(Minus, &f, GOLDEN_STEPS, fmax(lo, at - step), fmin(hi, at + step), x, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the pair that is most like the model's at a place. error: the difference of its Q from the model's. */
static Pair Find(const MpmFollow *f, const MpmSample *s, double complex S, double complex Q, PetscReal *error)
{
  PetscReal least = INFINITY;
  Pair      found = {.x = s->x};

  for (PetscInt i = 0; i < f->n; i++) {
    for (PetscInt j = 0; j < i; j++) {
      const double complex sum = (s->value[i] + s->value[j]) / 2, half = (s->value[i] - s->value[j]) / 2;
      const PetscReal      off = Abs(sum - S) + sqrt(Abs(half * half - Q));

      if (off >= least) continue;
      least  = off;
      found  = PairOf(s, i, j);
      *error = Abs(half * half - Q);
    }
  }
  return found;
}

static PetscErrorCode Note(MpmFollow *f, PetscReal x, PetscReal peak, PetscReal angle)
{
  PetscFunctionBegin;
  f->peak = fmax(f->peak, peak / f->period);
  if (!(peak >= MPM_MEETING_FLOOR * f->most)) PetscFunctionReturn(PETSC_SUCCESS);
  if (f->nmeetings == f->room) {
    f->room = PetscMax(64, 2 * f->room);
    PetscCall(PetscRealloc(sizeof(*f->meetings) * (size_t)f->room, &f->meetings));
  }
  f->meetings[f->nmeetings++] = (MpmMeeting){x, peak / f->period, angle};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The largest logarithm of abs that a pair can have at x when its Q is off by an error. On the unit circle Q / S^2 is
   real, and nothing grows while it stays negative; elsewhere abs changes with the root of Q.
*/
static PetscReal Bound(const MpmFollow *f, const Pair end[2], PetscReal x, PetscReal error)
{
  double complex S, Q, ratio;
  PetscReal      off, abs;

  ModelAt(end, x, &S, &Q);
  ratio = Q / (S * S);
  abs   = LogAbsAt(end, x);
  off   = SAFE * error / creal(conj(S) * S);
  if (creal(ratio) < -off && fabs(cimag(ratio)) <= CIRCLE * off && fabs(abs) <= fmax(CIRCLE * off, f->most))
    return -INFINITY;
  return abs + (Abs(ratio) > off ? off / (2 * sqrt(Abs(ratio))) : sqrt(2 * off));
}

/*
   The growth of a pair whose model is good enough; factors that are damped grow most beside the place where they meet.
*/
static PetscErrorCode Settle(MpmFollow *f, const Pair end[2], PetscReal x, PetscReal angle)
{
  PetscReal beside, largest;

  PetscFunctionBegin;
  PetscCall(Largest(LogAbsAt, end, end[0].x, end[1].x, &beside));
  if (LogAbsAt(end, beside) > LogAbsAt(end, x)) x = beside;
  if (LogAbsAt(end, x) > f->most / 2) {
    PetscCall(GrowthAt(f, x, &largest));
    if (largest > f->most) f->hit = fmin(f->hit, x);
  }
  PetscCall(Note(f, x, LogAbsAt(end, x), angle));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The pair between two places. Hermite's cubic of Q is off by at most fourth (w / 2)^4, w the distance of the places,
   where its error at x is fourth (x - a)^2 (x - b)^2. What this cannot hide is settled: no window, or one of known
   growth. Else the place where they meet divides the interval; one at its end is told apart by a small piece.
*/
static PetscErrorCode MeetWithin(MpmFollow *f, const Pair end[2], PetscReal fourth, PetscInt depth, PetscInt *looks)
{
  const PetscReal w     = end[1].x - end[0].x;
  const PetscReal error = fourth * w * w * w * w / 16, fine = ENOUGH * f->most * f->most;
  PetscReal       x, peak, piece, off = 0;
  double complex  S, Q;
  Pair            half[2];

  PetscFunctionBegin;
  PetscCall(Largest(RatioAt, end, end[0].x, end[1].x, &x)); /* where the pair meets */
  peak = LogAbsAt(end, x);
  if (isfinite(fourth)) {
    PetscReal beside;

    PetscCall(Largest(LogAbsAt, end, end[0].x, end[1].x, &beside));
    if (Bound(f, end, x, error) < MPM_MEETING_FLOOR * f->most &&
        Bound(f, end, beside, error) < MPM_MEETING_FLOOR * f->most)
      PetscFunctionReturn(PETSC_SUCCESS);
    if (LogAbsAt(end, beside) > fmax(peak, 0)) x = beside;
  }
  ModelAt(end, x, &S, &Q);
  if (error <= fine || w < NARROW * x || *looks >= MOST_LOOKS) {
    if (error > fine && w >= NARROW * x && peak > f->most) f->doubtful = fmin(f->doubtful, x);
    PetscCall(Settle(f, end, x, carg(S)));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  piece = isfinite(fourth) ? pow(8 * fine / fourth, 0.25) : 0;
  piece = fmin(w / 2, depth > STRAIGHT ? fmax(piece, w / 8) : fmax(piece, w / 64));
  x     = fmin(fmax(x, end[0].x + piece), end[1].x - piece);
  ModelAt(end, x, &S, &Q);
  PetscCall(Look(f, x, CLOSER * w, &f->samples[2]));
  ++*looks;
  if (f->samples[2].largest > f->most) {
    f->hit = fmin(f->hit, x);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  half[1] = half[0] = Find(f, &f->samples[2], S, Q, &off);
  off /= (x - end[0].x) * (x - end[0].x) * (x - end[1].x) * (x - end[1].x);
  for (int side = 0; side < 2; side++) {
    half[side] = end[side];
    PetscCall(MeetWithin(f, half, isfinite(fourth) ? fmax(off, fourth / 16) : off, depth + 1, looks));
    if (isfinite(f->hit)) break;
    half[0] = half[1];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds how large two eigenvalues become that come near each other between a and b. */
static PetscErrorCode Meet(MpmFollow *f, const MpmSample *a, const MpmSample *b, PetscInt i, PetscInt j)
{
  const Pair      end[2] = {PairOf(a, i, j), PairOf(b, i, j)};
  const PetscReal way    = (b->x - a->x) * fmax(Fastest(f, a), Fastest(f, b));
  PetscReal       x;
  PetscInt        looks = 0;

  PetscFunctionBegin;
  PetscCall(Largest(RatioAt, end, a->x, b->x, &x));
  if (LogAbsAt(end, x) < -MATCHED * way) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MeetWithin(f, end, INFINITY, 0, &looks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Returns whether two eigenvalues approach each other after a and separate before b, so near that they may meet. */
static PetscBool MayMeet(const MpmSample *a, const MpmSample *b, PetscInt i, PetscInt j)
{
  const double complex da = a->value[i] - a->value[j], db = b->value[i] - b->value[j];
  const double complex sa = a->slope[i] - a->slope[j], sb = b->slope[i] - b->slope[j];
  PetscReal            least = INFINITY;

  if ((Abs(da) <= COINCIDE) != (Abs(db) <= COINCIDE)) return PETSC_TRUE;
  if (Abs(da) <= COINCIDE) return PETSC_FALSE;
  if (creal(conj(da) * db) > 0 && (creal(conj(da) * sa) >= 0 || creal(conj(db) * sb) <= 0)) return PETSC_FALSE;
  for (int t = 0; t <= GRID; t++)
    least = fmin(least, Abs(Cubic(a->x, b->x, da, sa, db, sb, a->x + (b->x - a->x) * t / GRID)));
  return least <= NEAR * fmax(Abs(db - da), (b->x - a->x) * fmax(Abs(sa), Abs(sb))) ? PETSC_TRUE : PETSC_FALSE;
}

/* Looks at an eigenvalue whose abs has a maximum between a and b, by Hermite's cubic of its logarithm. */
static PetscErrorCode Rise(MpmFollow *f, const MpmSample *a, const MpmSample *b, PetscInt i)
{
  const PetscReal at[2]    = {log(Abs(a->value[i])), log(Abs(b->value[i]))};
  const PetscReal slope[2] = {creal(a->slope[i] / a->value[i]), creal(b->slope[i] / b->value[i])};
  PetscReal       best = -INFINITY, x = 0, largest;

  PetscFunctionBegin;
  if (!(slope[0] > 0 && slope[1] < 0)) PetscFunctionReturn(PETSC_SUCCESS);
  for (int t = 1; t < GRID; t++) {
    const PetscReal place = a->x + (b->x - a->x) * t / GRID;
    const PetscReal value = creal(Cubic(a->x, b->x, at[0], slope[0], at[1], slope[1], place));

    if (value <= best) continue;
    best = value;
    x    = place;
  }
  if (best < f->most - CLOSE || best < fmax(at[0], at[1]) + RISE * f->most) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GrowthAt(f, x, &largest));
  if (largest > f->most) f->hit = fmin(f->hit, x);
  PetscCall(Note(f, x, largest, carg(a->value[i])));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Looks for growth between two places whose eigenvalues are in the same order. */
static PetscErrorCode LookBetween(MpmFollow *f, const MpmSample *a, const MpmSample *b)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < f->n; i++) {
    if (!Counts(a, i) && !Counts(b, i)) continue;
    PetscCall(Rise(f, a, b, i));
    for (PetscInt j = 0; j < i; j++)
      if ((Counts(a, j) || Counts(b, j)) && (f->match[i] == j || f->match[j] == i || MayMeet(a, b, i, j)))
        PetscCall(Meet(f, a, b, i, j));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Returns whether one of the eigenvalues that are not where they were predicted is so large that it might grow. */
static PetscBool IsDoubtful(const MpmFollow *f, const MpmSample *a)
{
  for (PetscInt i = 0; i < f->n; i++)
    if (f->cost[i] > NOISE && Abs(a->value[i]) > HARMLESS) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Goes from a to the next place, as far as eigenvalues can be told apart. */
static PetscErrorCode Step(MpmFollow *f, const MpmSample *a, PetscReal h, PetscReal least, MpmSample *b,
                           PetscBool *matched)
{
  PetscFunctionBegin;
  for (*matched = PETSC_FALSE;; h /= 2) {
    PetscCall(Look(f, a->x + h, BESIDE * h, b));
    *matched = Match(f, a, b);
    if (*matched || (b->largest > f->most && h < LEAST_GROWING * a->x)) PetscFunctionReturn(PETSC_SUCCESS);
    if (h >= least) continue;
    if (IsDoubtful(f, a)) f->doubtful = fmin(f->doubtful, a->x);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
}

PetscErrorCode MpmFollowLine(MpmFollow *f, PetscReal from, PetscReal to, PetscReal bracket[2])
{
  MpmSample *a = &f->samples[0], *b = &f->samples[1];
  PetscReal  h = FIRST * from, least = LEAST;

  PetscFunctionBegin;
  f->nmeetings = 0;
  f->peak      = -INFINITY;
  f->hit       = INFINITY;
  bracket[0]   = 0;
  bracket[1]   = from;
  PetscCall(Look(f, from, BESIDE * LEAST * from, a));
  if (!(a->largest <= f->most)) PetscFunctionReturn(PETSC_SUCCESS);
  bracket[1] = INFINITY;
  while (to - a->x > LEAST * to) {
    MpmSample *kept = a;
    PetscBool  matched;

    h = fmin(fmin(2 * h, RATIO * a->x), fmin(TURN / Fastest(f, a), to - a->x));
    PetscCall(Step(f, a, h, least * a->x, b, &matched));
    least = matched ? LEAST : 2 * least; /* longer least steps where eigenvalues cannot be told apart */
    if (matched) PetscCall(LookBetween(f, a, b));
    if (!(b->largest <= f->most)) f->hit = fmin(f->hit, b->x);
    bracket[0] = a->x;
    bracket[1] = f->hit;
    if (f->evaluations > f->allowed && isinf(f->hit)) PetscFunctionReturn(PETSC_SUCCESS);
    if (isfinite(f->hit)) {
      PetscCall(Narrow(f, bracket));
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    h = b->x - a->x;
    a = b;
    b = kept;
  }
  bracket[0] = to;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFollowFirst(MpmFollow *f, PetscReal start, PetscReal from, PetscReal to, PetscReal bracket[2])
{
  const MpmSearchSteps steps = {.from = start, .to = start, .ratio = 2, .width = start};

  PetscFunctionBegin;
  PetscCall(MpmFollowLine(f, from, to, bracket));
  if (bracket[0] == 0 && from > start) PetscCall(MpmFollowLine(f, start, from, bracket));
  if (bracket[0] == 0) PetscCall(MpmSearchFirst(MpmFollowGrowth, f, f->tolerance, &steps, PRECISION, bracket));
  PetscFunctionReturn(PETSC_SUCCESS);
}
