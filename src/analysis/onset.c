/* The onset of growth, from few evaluations. */
#include "analysis/onset.h"
#include <math.h>

#define CLOSE 1e-6  /* relative: the search ends */
#define BEYOND 0.03 /* of the distance to the onset that is expected, by which it is passed */
#define PATIENCE 2  /* evaluations in which the bracket should become half as wide */

/*S
   Bracket - a stable value and the unstable ones above it, the nearest first; n of them are known.
S*/
typedef struct {
  PetscReal lo, at[3], excess[3];
  PetscInt  n;
} Bracket;

static void AddUnstable(Bracket *b, PetscReal at, PetscReal excess)
{
  for (PetscInt i = 2; i > 0; i--) {
    b->at[i]     = b->at[i - 1];
    b->excess[i] = b->excess[i - 1];
  }
  b->at[0]     = at;
  b->excess[0] = excess;
  b->n         = PetscMin(b->n + 1, 3);
}

/* Smooth where growth - 1 is like the root of the distance: (g - 1)^2 / g, or where it is like the distance itself. */
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

/* The onset that is expected; NaN if too little is known. Of the two laws the one that would have foreseen the last value. */
static PetscReal Expect(const Bracket *b, PetscReal tolerance)
{
  PetscReal miss[2] = {1, 0};

  if (b->n < 2) return NAN;
  for (int root = 0; root < 2 && b->n > 2; root++)
    miss[root] = PetscAbsReal(Cross(b, 1, (PetscBool)root, b->excess[0]) - b->at[0]);
  return Cross(b, 0, miss[1] < miss[0] ? PETSC_TRUE : PETSC_FALSE, tolerance);
}

/*
   The next value to look at: beyond the expected onset by little, and, when that is next to it, below it. When the bracket
   has not become narrow for some values, the one after them is below the expected onset, and the others are in the middle.
*/
static PetscReal Next(const Bracket *b, PetscReal tolerance, PetscInt without)
{
  const PetscReal hi = b->at[0], close = CLOSE * hi, x = Expect(b, tolerance);

  if (!(x > b->lo && x < hi) || without > PATIENCE) return (b->lo + hi) / 2;
  if (without == PATIENCE) return PetscMax(x - 2 * (hi - x), (b->lo + x) / 2);
  if (hi - x > close / 2) return PetscMin(x + PetscMax(BEYOND * (hi - x), close / 4), (x + hi) / 2);
  return PetscMax(x - close / 4, (b->lo + x) / 2);
}

static PetscErrorCode Narrow(const MpmOnset *o, Bracket *b, PetscReal *limit)
{
  PetscReal width   = b->at[0] - b->lo;
  PetscInt  without = 0;

  PetscFunctionBegin;
  while (b->at[0] - b->lo > CLOSE * b->at[0]) {
    const PetscReal at = Next(b, o->tolerance, without);
    PetscReal       excess;

    PetscCall(o->excess(o->context, at, &excess));
    if (excess <= o->tolerance)
      b->lo = at;
    else
      AddUnstable(b, at, excess);
    without = b->at[0] - b->lo > width / 2 ? without + 1 : 0;
    if (!without) width = b->at[0] - b->lo;
  }
  *limit = b->lo;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Doubles or halves from the start until a stable and an unstable value are next to one another. */
static PetscErrorCode Enclose(const MpmOnset *o, Bracket *b, PetscBool *stable, PetscBool *found)
{
  PetscReal at = o->start, excess, before;

  PetscFunctionBegin;
  PetscCall(o->excess(o->context, at, &excess));
  *stable = excess <= o->tolerance ? PETSC_TRUE : PETSC_FALSE;
  *found  = PETSC_FALSE;
  if (!*stable) AddUnstable(b, at, excess);
  while (!*found && at < o->start * o->farthest && at > o->start / o->farthest) {
    before = at;
    at *= *stable ? 2 : 0.5;
    PetscCall(o->excess(o->context, at, &excess));
    *found = (excess <= o->tolerance) != *stable ? PETSC_TRUE : PETSC_FALSE;
    if (!(excess <= o->tolerance)) AddUnstable(b, at, excess);
    b->lo = *stable ? before : at;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOnsetFind(const MpmOnset *o, PetscReal *limit)
{
  Bracket   b      = {.n = 0};
  PetscReal below  = 0;
  PetscBool stable = PETSC_FALSE, found = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(Enclose(o, &b, &stable, &found));
  *limit = stable ? INFINITY : 0;
  if (!found) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Narrow(o, &b, limit));
  for (PetscInt i = 1; i <= o->below; i++) {
    const PetscReal tried = *limit * (PetscReal)i / (PetscReal)(o->below + 1);
    PetscReal       excess;

    PetscCall(o->excess(o->context, tried, &excess));
    if (!(excess <= o->tolerance)) {
      b = (Bracket){.lo = below};
      AddUnstable(&b, tried, excess);
      PetscCall(Narrow(o, &b, limit));
      break;
    }
    below = tried;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
