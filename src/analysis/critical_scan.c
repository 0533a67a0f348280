/*
   A search for a limit that takes nothing for granted: growth may stop again as the Courant number rises. It looks at a row
   of Courant numbers, takes the widest range without growth among them, and bisects its ends and those of the windows of
   growth below it.
*/
#include <mpmstab/critical.h>
#include <math.h>

#define RATIO 1.25  /* of Courant numbers, one over the other, */
#define LINEAR 32   /* and so many at equal distances up to the limit */
#define LEAST 1e-24 /* where all grow they are halved down to this */
#define MOST 192    /* Courant numbers that are looked at in all, before ends are bisected */
#define NARROW 1e-4 /* relative precision of the ends of a window */
#define FADES 0.03  /* growth below a limit, over the tolerance, that shows that there is no threshold */

/* Courant numbers that were looked at, from small to large. */
typedef struct {
  MpmCriticalGrowth growth;
  void             *context;
  PetscReal         tolerance, courant[MOST], found[MOST];
  PetscInt          n;
} Scan;

static PetscErrorCode Look(Scan *s, PetscReal courant)
{
  PetscReal growth;
  PetscInt  i = s->n++;

  PetscFunctionBegin;
  PetscCall(s->growth(s->context, courant, &growth));
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
  return s->found[i] <= 1 + s->tolerance ? PETSC_FALSE : PETSC_TRUE;
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

/* Bisects between a Courant number without growth and one with it, whichever is larger. */
static PetscErrorCode Bisect(Scan *s, PetscReal precision, PetscReal *stable, PetscReal *unstable)
{
  PetscFunctionBegin;
  while (fabs(*unstable - *stable) > precision * PetscMax(*stable, *unstable)) {
    const PetscReal middle = (*stable + *unstable) / 2;
    PetscReal       growth;

    PetscCall(s->growth(s->context, middle, &growth));
    *(growth <= 1 + s->tolerance ? stable : unstable) = middle;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The lower end of the window of growth that begins with place i. Below the first place it is looked for by halving. */
static PetscErrorCode Begin(Scan *s, PetscInt i, PetscReal *from)
{
  PetscReal stable = i > 0 ? s->courant[i - 1] : s->courant[0] / 2, growth = 1;

  PetscFunctionBegin;
  *from = s->courant[i];
  for (; i == 0 && stable > LEAST; stable /= 2) {
    PetscCall(s->growth(s->context, stable, &growth));
    if (growth <= 1 + s->tolerance) break;
    *from = stable;
  }
  if (growth <= 1 + s->tolerance)
    PetscCall(Bisect(s, NARROW, &stable, from));
  else
    *from = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The window of growth that begins with place i, below a limit. i moves on to the first place behind it. */
static PetscErrorCode Enclose(Scan *s, PetscInt *i, MpmCriticalWindow *w)
{
  PetscReal stable;

  PetscFunctionBegin;
  *w = (MpmCriticalWindow){.growth = 0};
  PetscCall(Begin(s, *i, &w->from));
  for (; Grows(s, *i); ++*i) {
    if (s->found[*i] <= w->growth) continue;
    w->growth = s->found[*i];
    w->at     = s->courant[*i];
  }
  w->to  = s->courant[*i - 1];
  stable = s->courant[*i];
  PetscCall(Bisect(s, NARROW, &stable, &w->to));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Windows of growth below place 'end'. Those for which there is no room are joined to the last one. */
static PetscErrorCode FindWindows(Scan *s, PetscInt end, MpmCriticalWindows *all)
{
  MpmCriticalWindow one;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < end; i++) {
    if (!Grows(s, i)) continue;
    PetscCall(Enclose(s, &i, &one));
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

/*
   Whether growth just fades to the tolerance below a limit: whether there is some in the middle of the range without. Then
   the limit is 0, and no windows are below it.
*/
static PetscErrorCode FindThreshold(Scan *s, PetscReal from, MpmCritical *c)
{
  const PetscReal middle = PetscMax(from + c->unstable_at, c->unstable_at) / 2;
  PetscReal       at[2];

  PetscFunctionBegin;
  PetscCall(s->growth(s->context, c->unstable_at, &at[0]));
  PetscCall(s->growth(s->context, middle, &at[1]));
  c->threshold = at[1] - 1 <= FADES * s->tolerance ? PETSC_TRUE : PETSC_FALSE;
  if (c->threshold) PetscFunctionReturn(PETSC_SUCCESS);
  c->windows.n = 0;
  c->fading    = log((at[0] - 1) / (at[1] - 1)) / log(c->unstable_at / middle);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalScan(MpmCriticalGrowth growth, void *context, PetscReal tolerance, PetscReal also,
                               PetscReal precision, MpmCritical *c)
{
  Scan      s = {.growth = growth, .context = context, .tolerance = tolerance};
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
  PetscCall(Bisect(&s, precision, &c->stable_at, &c->unstable_at));
  PetscCall(FindThreshold(&s, first > 0 ? s.courant[first] : 0, c));
  PetscFunctionReturn(PETSC_SUCCESS);
}
