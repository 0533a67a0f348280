/* Searches in one variable: first growth, scan, threshold, golden section. */
#include "analysis/search.h"
#include <math.h>

#define LEAST 1e-24 /* Courant number; a second material may be that much stiffer and lighter */
#define FADES 0.03  /* growth in the middle below a limit, over the tolerance, that shows that there is no threshold */
#define ABOVE 1.01  /* so far above a limit growth that fades is at most */
#define STEEP 2     /* times the tolerance, and growth beyond a threshold is larger, whatever rounding does below */
#define GOLDEN 0.6180339887498949

#define RATIO 1.25  /* of the Courant numbers of a scan, one over the other, */
#define LINEAR 32   /* and so many at equal distances up to the limit */
#define MOST 192    /* Courant numbers that are looked at in all, before ends are bisected */
#define NARROW 1e-4 /* relative precision of the ends of a window */

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

/*
   Halves an unstable Courant number until it is stable, where no stable one is known, and bisects. bracket[0] stays 0 when
   none is stable.
*/
static PetscErrorCode Enclose(const Sought *s, PetscReal precision, PetscReal bracket[2])
{
  PetscReal g;

  PetscFunctionBegin;
  for (PetscReal k = bracket[1] / 2; bracket[0] == 0 && k >= LEAST; k /= 2) {
    PetscCall(s->growth(s->context, k, &g));
    bracket[g <= 1 + s->tolerance ? 0 : 1] = k;
  }
  if (bracket[0] > 0) PetscCall(Bisect(s, precision, &bracket[0], &bracket[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSearchFirst(MpmSearchGrowth growth, void *context, PetscReal tolerance, const MpmSearchSteps *steps,
                              PetscReal precision, PetscReal bracket[2])
{
  const Sought s = {growth, context, tolerance};
  PetscReal    g, k = steps->from;

  PetscFunctionBegin;
  bracket[0] = 0;
  for (;; k = PetscMin(PetscMin(k * steps->ratio, k + steps->width), steps->to)) {
    PetscCall(growth(context, k, &g));
    if (!(g <= 1 + tolerance)) break;
    bracket[0] = k;
    if (k < steps->to) continue;
    bracket[1] = INFINITY;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  bracket[1] = k;
  PetscCall(Enclose(&s, precision, bracket));
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

PetscReal MpmSearchPhase(PetscReal m)
{
  return PETSC_PI / 2 * (1 - cos(PETSC_PI * PetscMin(PetscMax(m, 0), MPM_CRITICAL_PHASES) / MPM_CRITICAL_PHASES));
}

PetscReal MpmSearchBeside(PetscReal beta, PetscReal d)
{
  return MpmSearchPhase(acos(1 - 2 * beta / PETSC_PI) / PETSC_PI * MPM_CRITICAL_PHASES + d);
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
  PetscReal stable, bracket[2] = {*i > 0 ? s->courant[*i - 1] : 0, s->courant[*i]};

  PetscFunctionBegin;
  PetscCall(Enclose(&s->sought, NARROW, bracket));
  *w = (MpmCriticalWindow){.from = bracket[0] > 0 ? bracket[1] : 0};
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
