/* Searches: first growth, scan, threshold and golden section in one variable, and steps downhill in several. */
#include "analysis/search.h"
#include <math.h>

#define LEAST 1e-24 /* Courant number; a second material may be that much stiffer and lighter */
#define FADES 0.03  /* growth in the middle below a limit, over the tolerance, that shows that there is no threshold */
#define ABOVE 1.01  /* so far above a limit growth that fades is at most */
#define STEEP 2     /* times the tolerance, and growth beyond a threshold is larger, whatever rounding does below */
#define GOLDEN 0.6180339887498949
#define LEVEL 1e-13 /* relative; less than this is rounding, not a way down */
#define STRAIGHT 9  /* steps in one direction at a time */
#define ROUNDS 200  /* values that are rounding would go down without an end */

#define RATIO 1.25  /* of the Courant numbers of a scan, one over the other, */
#define LINEAR 32   /* and so many at equal distances up to the limit */
#define MOST 192    /* Courant numbers that are looked at in all, before ends are bisected */
#define NARROW 1e-4 /* relative precision of the ends of a window */

#define BEYOND 0.03 /* of the distance to the crossing that is expected, by which it is passed */
#define PATIENCE 2  /* evaluations in which the bracket should become half as wide */

/* Growth as a function of the Courant number, and what counts as growth. */
typedef struct {
  MpmSearchGrowth growth;
  void           *context;
  PetscReal       tolerance;
} Sought;

/* Bisects between a Courant number without growth and one with it, whichever is larger. */
static PetscErrorCode Bisect(const Sought *s, PetscReal precision, PetscReal *stable, PetscReal *unstable)
{
  PetscReal g;

  PetscFunctionBegin;
  while (fabs(*unstable - *stable) > precision * PetscMax(*stable, *unstable)) {
    const PetscReal middle = (*stable + *unstable) / 2;

    PetscCall(s->growth(s->context, middle, &g));
    *(g <= 1 + s->tolerance ? stable : unstable) = middle;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the first growth, from few evaluations ---- */

/* A stable value lo and the unstable ones above it, the nearest first; n of them are known, with growth - 1. */
typedef struct {
  PetscReal lo, at[3], excess[3];
  PetscInt  n;
} Bracket;

static void AddUnstable(Bracket *b, PetscReal at, PetscReal growth)
{
  for (PetscInt i = 2; i > 0; i--) {
    b->at[i]     = b->at[i - 1];
    b->excess[i] = b->excess[i - 1];
  }
  b->at[0]     = at;
  b->excess[0] = growth - 1;
  b->n         = PetscMin(b->n + 1, 3);
}

/*
   Just above its first value growth - 1 is proportional to the distance (an eigenvalue that leaves the unit circle) or
   to its square root (two eigenvalues that meet on it). So (g - 1)^2 / g or g - 1 is smooth.
*/
static PetscReal Law(PetscBool root, PetscReal excess)
{
  return root ? excess * excess / (1 + excess) : excess;
}

/* Where a polynomial of the law through unstable values, from one of them on, comes to an excess (Neville's scheme). */
static PetscReal Cross(const Bracket *b, PetscInt from, PetscBool root, PetscReal excess)
{
  const PetscInt  n  = b->n - from;
  const PetscReal at = Law(root, excess);
  PetscReal       x[3], law[3];

  for (PetscInt i = 0; i < n; i++) {
    x[i]   = b->at[from + i];
    law[i] = Law(root, b->excess[from + i]);
  }
  for (PetscInt k = 1; k < n; k++)
    for (PetscInt i = 0; i + k < n; i++)
      x[i] = ((at - law[i + k]) * x[i] - (at - law[i]) * x[i + 1]) / (law[i] - law[i + k]);
  return x[0];
}

/*
   The first growth that is expected; NaN: too little is known. Of the laws the one that would have foreseen the last
   value.
*/
static PetscReal Expect(const Bracket *b, PetscReal tolerance)
{
  PetscReal miss[2] = {1, 0};

  if (b->n < 2) return NAN;
  for (int root = 0; root < 2 && b->n > 2; root++)
    miss[root] = PetscAbsReal(Cross(b, 1, (PetscBool)root, b->excess[0]) - b->at[0]);
  return Cross(b, 0, miss[1] < miss[0] ? PETSC_TRUE : PETSC_FALSE, tolerance);
}

/*
   The next value to look at: beyond the expected one by little, and, when that is next to it, below it. When the
   bracket has not become narrow for some values, the one after them is below the expected one, and the others are in
   the middle.
*/
static PetscReal Next(const Bracket *b, PetscReal tolerance, PetscReal precision, PetscInt without)
{
  const PetscReal hi = b->at[0], close = precision * hi, x = Expect(b, tolerance);

  if (!(x > b->lo && x < hi) || without > PATIENCE) return (b->lo + hi) / 2;
  if (without == PATIENCE) return PetscMax(x - 2 * (hi - x), (b->lo + x) / 2);
  if (hi - x > close / 2) return PetscMin(x + PetscMax(BEYOND * (hi - x), close / 4), (x + hi) / 2);
  return PetscMax(x - close / 4, (b->lo + x) / 2);
}

static PetscErrorCode Narrow(const Sought *s, PetscReal precision, Bracket *b)
{
  PetscReal width   = b->at[0] - b->lo;
  PetscInt  without = 0;

  PetscFunctionBegin;
  while (b->at[0] - b->lo > precision * b->at[0]) {
    const PetscReal at = Next(b, s->tolerance, precision, without);
    PetscReal       g;

    PetscCall(s->growth(s->context, at, &g));
    if (g <= 1 + s->tolerance)
      b->lo = at;
    else
      AddUnstable(b, at, g);
    without = b->at[0] - b->lo > width / 2 ? without + 1 : 0;
    if (!without) width = b->at[0] - b->lo;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Halves an unstable value until it is stable, where no stable one is known. lo stays 0 when none is stable. */
static PetscErrorCode Enclose(const Sought *s, PetscReal least, PetscReal precision, Bracket *b)
{
  PetscReal g;

  PetscFunctionBegin;
  for (PetscReal k = b->at[0] / 2; b->lo == 0 && k >= least; k /= 2) {
    PetscCall(s->growth(s->context, k, &g));
    if (g <= 1 + s->tolerance)
      b->lo = k;
    else
      AddUnstable(b, k, g);
  }
  if (b->lo > 0) PetscCall(Narrow(s, precision, b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSearchFirst(MpmSearchGrowth growth, void *context, PetscReal tolerance, const MpmSearchSteps *steps,
                              PetscReal precision, PetscReal bracket[2])
{
  const Sought s = {growth, context, tolerance};
  Bracket      b = {.lo = 0};
  PetscReal    g, k = steps->from;

  PetscFunctionBegin;
  bracket[1] = INFINITY;
  for (;; k = PetscMin(PetscMin(k * steps->ratio, k + steps->width), steps->to)) {
    PetscCall(growth(context, k, &g));
    if (!(g <= 1 + tolerance)) break;
    bracket[0] = b.lo = k;
    if (k >= steps->to) PetscFunctionReturn(PETSC_SUCCESS);
  }
  AddUnstable(&b, k, g);
  PetscCall(Enclose(&s, PetscMax(steps->least, LEAST), precision, &b));
  bracket[0] = b.lo;
  bracket[1] = b.at[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSearchThreshold(MpmSearchGrowth growth, void *context, PetscReal tolerance, PetscReal from,
                                  MpmCritical *c)
{
  const PetscReal middle = PetscMax(from + c->unstable_at, c->unstable_at) / 2;
  PetscReal       at[3];

  PetscFunctionBegin;
  if (c->stable_at == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(growth(context, c->unstable_at, &at[0]));
  PetscCall(growth(context, middle, &at[1]));
  c->threshold = at[1] - 1 <= FADES * tolerance ? PETSC_TRUE : PETSC_FALSE;
  if (c->threshold) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(growth(context, ABOVE * c->unstable_at, &at[2]));
  c->threshold = at[2] - 1 > STEEP * tolerance ? PETSC_TRUE : PETSC_FALSE;
  if (c->threshold) PetscFunctionReturn(PETSC_SUCCESS);
  c->windows.n = 0;
  c->fading    = log((at[0] - 1) / (at[1] - 1)) / log(c->unstable_at / middle);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSearchLeast(MpmSearchFunction f, void *context, PetscInt steps, PetscReal lo, PetscReal hi,
                              PetscReal *x, PetscReal *value)
{
  PetscReal a = hi - GOLDEN * (hi - lo), b = lo + GOLDEN * (hi - lo), at_a, at_b;

  PetscFunctionBegin;
  PetscCall(f(context, a, &at_a));
  PetscCall(f(context, b, &at_b));
  for (PetscInt i = 0; i < steps; i++) {
    if (at_a <= at_b) {
      hi   = b;
      b    = a;
      at_b = at_a;
      a    = hi - GOLDEN * (hi - lo);
      PetscCall(f(context, a, &at_a));
    } else {
      lo   = a;
      a    = b;
      at_a = at_b;
      b    = lo + GOLDEN * (hi - lo);
      PetscCall(f(context, b, &at_b));
    }
  }
  *x     = at_a <= at_b ? a : b;
  *value = PetscMin(at_a, at_b);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes steps by which the value goes down, as far as it does. down: whether it has. */
static PetscErrorCode Try(const MpmSearchDescent *d, const PetscReal by[], PetscReal u[], PetscReal *value,
                          PetscBool *down)
{
  PetscFunctionBegin;
  for (PetscInt times = 0; times < STRAIGHT; times++) {
    PetscReal next[MPM_SEARCH_VARIABLES], there;

    for (PetscInt v = 0; v < d->n; v++) next[v] = u[v] + by[v];
    PetscCall(d->f(d->context, next, &there));
    if (!(there < (isfinite(*value) ? *value - LEVEL * fabs(*value) : *value))) break;
    PetscCall(PetscArraycpy(u, next, d->n));
    *value = there;
    *down  = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSearchDescend(const MpmSearchDescent *d, PetscReal step, PetscReal u[], PetscReal *value)
{
  PetscInt directions = 1;

  PetscFunctionBegin;
  for (PetscInt v = 0; v < d->n; v++) directions *= 3;
  for (PetscInt rounds = 0; step > d->finest && rounds < ROUNDS; rounds++) {
    PetscBool down = PETSC_FALSE;

    for (PetscInt m = 0; m < directions; m++) {
      PetscReal by[MPM_SEARCH_VARIABLES];
      PetscInt  rest = m, moved = 0;

      for (PetscInt v = 0; v < d->n; v++, rest /= 3) {
        by[v] = step * (PetscReal)(rest % 3 - 1);
        moved += rest % 3 != 1;
      }
      if (moved > 0 && moved <= d->together) PetscCall(Try(d, by, u, value, &down));
    }
    if (!down) step /= 2;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmSearchPhase(PetscReal m)
{
  return PETSC_PI / 2 * (1 - cos(PETSC_PI * PetscMin(PetscMax(m, 0), MPM_CRITICAL_PHASES) / MPM_CRITICAL_PHASES));
}

/* ---- where growth may stop again ---- */

/* Courant numbers that were looked at, from small to large. */
typedef struct {
  Sought    sought;
  PetscReal courant[MOST], found[MOST];
  PetscInt  n;
} Scan;

static PetscErrorCode Look(Scan *s, PetscReal courant)
{
  PetscReal growth;
  PetscInt  i = s->n++;

  PetscFunctionBegin;
  PetscCall(s->sought.growth(s->sought.context, courant, &growth));
  for (; i > 0 && s->courant[i - 1] > courant; i--) {
    s->courant[i] = s->courant[i - 1];
    s->found[i]   = s->found[i - 1];
  }
  s->courant[i] = courant;
  s->found[i]   = growth;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool Grows(const Scan *s, PetscInt i)
{
  return s->found[i] <= 1 + s->sought.tolerance ? PETSC_FALSE : PETSC_TRUE;
}

/* The first and the last Courant number of the widest range without growth; last is MPM_NONE where all grow. */
static void Widest(const Scan *s, PetscInt *first, PetscInt *last)
{
  PetscReal widest = -1;

  *first = *last = MPM_NONE;
  for (PetscInt i = 0, begin = 0; i < s->n; i++) {
    if (Grows(s, i))
      begin = i + 1;
    else if (s->courant[i] - s->courant[begin] > widest) {
      widest = s->courant[i] - s->courant[begin];
      *first = begin;
      *last  = i;
    }
  }
}

/* The window of growth that begins with place i, below a limit. i moves on to the first place behind it. */
static PetscErrorCode FindWindow(Scan *s, PetscInt *i, MpmCriticalWindow *w)
{
  Bracket   b = {.lo = *i > 0 ? s->courant[*i - 1] : 0};
  PetscReal stable;

  PetscFunctionBegin;
  AddUnstable(&b, s->courant[*i], s->found[*i]);
  PetscCall(Enclose(&s->sought, LEAST, NARROW, &b));
  *w = (MpmCriticalWindow){.from = b.lo > 0 ? b.at[0] : 0};
  for (; Grows(s, *i); ++*i) {
    if (s->found[*i] <= w->growth) continue;
    w->growth = s->found[*i];
    w->at     = s->courant[*i];
  }
  w->to  = s->courant[*i - 1];
  stable = s->courant[*i];
  PetscCall(Bisect(&s->sought, NARROW, &stable, &w->to));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Windows of growth below place 'end'. Those for which there is no room are joined to the last one. */
static PetscErrorCode FindWindows(Scan *s, PetscInt end, MpmCriticalWindows *all)
{
  MpmCriticalWindow one;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < end; i++) {
    if (!Grows(s, i)) continue;
    PetscCall(FindWindow(s, &i, &one));
    if (all->n == MPM_CRITICAL_WINDOWS) {
      MpmCriticalWindow *last = &all->window[all->n - 1];

      last->to = one.to;
      if (one.growth > last->growth) {
        last->growth = one.growth;
        last->at     = one.at;
      }
    } else
      all->window[all->n++] = one;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSearchScan(MpmSearchGrowth growth, void *context, PetscReal tolerance, PetscReal also,
                             PetscReal precision, MpmCritical *c)
{
  Scan      s = {.sought = {growth, context, tolerance}};
  PetscInt  first, last;
  PetscReal to;

  PetscFunctionBegin;
  for (PetscReal k = MPM_CRITICAL_FROM; k < MPM_CRITICAL_TO; k *= RATIO) PetscCall(Look(&s, k));
  PetscCall(Look(&s, MPM_CRITICAL_TO));
  if (also > 0 && isfinite(also)) PetscCall(Look(&s, also));
  Widest(&s, &first, &last);
  while (last == MPM_NONE && s.courant[0] > LEAST) {
    PetscCall(Look(&s, s.courant[0] / 2));
    Widest(&s, &first, &last);
  }
  to = s.courant[last == MPM_NONE ? 0 : PetscMin(last + 1, s.n - 1)];
  for (PetscInt i = 0; i < LINEAR; i++) PetscCall(Look(&s, to * (i + 0.5) / LINEAR));
  Widest(&s, &first, &last);
  c->windows     = (MpmCriticalWindows){.looked = s.n};
  c->stable_at   = last == MPM_NONE ? 0 : s.courant[last];
  c->unstable_at = last == MPM_NONE ? s.courant[0] : last + 1 < s.n ? s.courant[last + 1] : INFINITY;
  if (last == MPM_NONE) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FindWindows(&s, first, &c->windows));
  if (isinf(c->unstable_at)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Bisect(&s.sought, precision, &c->stable_at, &c->unstable_at));
  PetscCall(MpmSearchThreshold(growth, context, tolerance, first > 0 ? s.courant[first] : 0, c));
  PetscFunctionReturn(PETSC_SUCCESS);
}
