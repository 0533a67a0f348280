/* Takes steps in parts, or with the largest factor of their increments up to 1 with which the energy does not rise. */
#include "march/adapt.h"
#include "base/text.h"
#include "march/finite.h"

#define ROUNDING 1e-15 /* of the energy: so much is no rise */
#define ENOUGH 1e-14   /* so much less energy than before is near enough to it */
#define HALVINGS 30
#define BISECTIONS 40

/* ---- halving ---- */

/* Copies the state of n particles to memory, or back. */
static PetscErrorCode Copy(MpmMarch *march, PetscBool back)
{
  const PetscInt  n = march->particles->count, dim = march->grid->dim, nstate = march->scheme->table->nstate;
  const MpmHalve *h = march->halve;
  PetscReal      *q;
  PetscInt       *cell;

  PetscFunctionBegin;
  for (PetscInt r = 0; r < nstate + dim; r++) {
    const char *name = r < nstate ? march->scheme->table->fields[r] : MpmFieldXi[r - nstate];
    PetscReal  *kept = h->state + r * h->room;

    PetscCall(MpmParticlesGet(march->particles, name, &q));
    PetscCall(PetscArraycpy(back ? q : kept, back ? kept : q, n));
    PetscCall(MpmParticlesRestore(march->particles, name, &q));
  }
  for (PetscInt a = 0; a < dim; a++) {
    PetscInt *kept = h->cell + a * h->room;

    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell));
    PetscCall(PetscArraycpy(back ? cell : kept, back ? kept : cell, n));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Keep(MpmMarch *march)
{
  const PetscInt dim = march->grid->dim;
  MpmHalve      *h   = march->halve;

  PetscFunctionBegin;
  if (march->particles->count > h->room || !h->state) {
    h->room = march->particles->count + MpmParticlesRoom(march->particles) + 1;
    PetscCall(PetscFree2(h->state, h->cell));
    PetscCall(PetscMalloc2((march->scheme->table->nstate + dim) * h->room, &h->state, dim * h->room, &h->cell));
  }
  PetscCall(Copy(march, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The next parts have another Courant number, and nodes have the particles as they are. */
static PetscErrorCode Restart(MpmMarch *march, PetscReal courant)
{
  PetscFunctionBegin;
  march->particles->step = march->step;
  PetscCall(MpmMarchSetCourant(march, courant));
  PetscCall(march->engine->start(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Explain(MpmMarch *march, PetscInt64 parts)
{
  char more[192], of[64] = "";

  PetscFunctionBegin;
  if (parts > 1) (void)snprintf(of, sizeof of, ", in %" PetscInt64_FMT " parts of the step", parts);
  (void)snprintf(more, sizeof more,
                 "%s; allowed: a smaller step, more -halvings, or another -implicit_snes_linesearch_type or "
                 "-implicit_snes_max_it",
                 of);
  MpmTextJoin(march->failure, more, sizeof march->failure);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHalveStep(MpmMarch *march, PetscErrorCode (*take)(MpmMarch *march))
{
  const PetscReal whole = march->courant;
  MpmHalve       *h     = march->halve;
  PetscInt        level = 0;

  PetscFunctionBegin;
  for (PetscInt64 done = 0, parts = 1; done < parts;) {
    PetscCall(Keep(march));
    PetscCall(take(march));
    if (!march->failure[0]) {
      march->within = whole * (PetscReal)++done / (PetscReal)parts;
      if (done < parts) march->particles->step = march->step;
      continue;
    }
    if (level == h->most) break;
    level++;
    parts *= 2;
    done *= 2;
    h->finest         = PetscMax(h->finest, parts);
    march->failure[0] = '\0';
    PetscCall(Copy(march, PETSC_TRUE));
    PetscCall(Restart(march, whole / (PetscReal)parts));
  }
  march->within = 0;
  if (level) h->steps++;
  if (march->failure[0])
    PetscCall(Explain(march, (PetscInt64)1 << level));
  else if (level) {
    PetscCall(MpmMarchSetCourant(march, whole));
    PetscCall(march->engine->start(march));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHalveDestroy(MpmHalve **halve)
{
  PetscFunctionBegin;
  if (*halve) PetscCall(PetscFree2((*halve)->state, (*halve)->cell));
  PetscCall(PetscFree(*halve));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- relaxation ---- */

/* state += a change, or change = state - change, or change = state. */
typedef enum { ADDS, SUBTRACTS, KEEPS } Action;

static PetscErrorCode Each(const MpmMarch *march, Action action, PetscReal a)
{
  const PetscInt n = march->particles->count;
  PetscReal     *q, *change = march->relax->change;

  PetscFunctionBegin;
  for (PetscInt r = 0; r < march->scheme->table->nstate; r++, change += n) {
    PetscCall(MpmParticlesGet(march->particles, march->scheme->table->fields[r], &q));
    for (PetscInt p = 0; p < n; p++) {
      if (action == ADDS)
        q[p] += a * change[p];
      else
        change[p] = q[p] - (action == SUBTRACTS ? change[p] : 0);
    }
    PetscCall(MpmParticlesRestore(march->particles, march->scheme->table->fields[r], &q));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Energy(const MpmMarch *march, PetscReal *energy)
{
  const MpmRelax *relax = march->relax;

  PetscFunctionBegin;
  PetscCall(MpmFiniteEnergy(march, relax->change + march->scheme->table->nstate * march->particles->count, energy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRelaxBegin(MpmMarch *march)
{
  MpmRelax *relax = march->relax;

  PetscFunctionBegin;
  if (march->particles->count > relax->room) {
    relax->room = march->particles->count + MpmParticlesRoom(march->particles);
    PetscCall(PetscFree(relax->change));
    PetscCall(PetscMalloc1((march->scheme->table->nstate + 1) * relax->room, &relax->change));
  }
  PetscCall(Energy(march, &relax->energy));
  PetscCall(Each(march, KEEPS, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rise of the energy with a factor, relative to it. from: the factor of the state as it is. */
static PetscErrorCode Rise(const MpmMarch *march, PetscReal factor, PetscReal *from, PetscReal *rise)
{
  PetscReal energy;

  PetscFunctionBegin;
  PetscCall(Each(march, ADDS, factor - *from));
  *from = factor;
  PetscCall(Energy(march, &energy));
  *rise = energy / march->relax->energy - 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The energy falls from factor 0 on and has risen at 1. Over the factor it is nearly straight: a secant that brackets.
*/
static PetscErrorCode Find(const MpmMarch *march, PetscReal highest, PetscReal *factor)
{
  PetscReal lo = 1, hi = 1, high = highest, low = highest, at = 1, rise, share = 1;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < HALVINGS && !(low <= 0); i++) {
    if (i > 0) {
      hi   = lo;
      high = low;
    }
    lo /= 2;
    PetscCall(Rise(march, lo, &at, &low));
  }
  if (!(low <= 0)) lo = 0;
  for (PetscInt i = 0; i < BISECTIONS && lo > 0 && low < -ENOUGH; i++) {
    const PetscReal a = low / lo, b = share * high / hi;
    const PetscReal next = i % 4 == 3 ? (lo + hi) / 2 : lo - a * (hi - lo) / (b - a);

    if (!(next > lo && next < hi)) break;
    PetscCall(Rise(march, next, &at, &rise));
    share = rise <= 0 ? share / 2 : 1; /* the end that stays counts less and less */
    if (rise <= 0) {
      lo  = next;
      low = rise;
    } else {
      hi   = next;
      high = rise;
    }
  }
  PetscCall(Each(march, ADDS, lo - at));
  *factor = lo;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRelaxEnd(MpmMarch *march, PetscBool *scaled)
{
  MpmRelax *relax = march->relax;
  PetscReal energy, factor = 1;

  PetscFunctionBegin;
  *scaled = PETSC_FALSE;
  PetscCall(Energy(march, &energy));
  if (!(energy > relax->energy * (1 + ROUNDING))) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Each(march, SUBTRACTS, 0));
  PetscCall(Find(march, energy / relax->energy - 1, &factor));
  relax->least = PetscMin(relax->least, factor);
  relax->steps++;
  *scaled = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRelaxDestroy(MpmRelax **relax)
{
  PetscFunctionBegin;
  if (*relax) PetscCall(PetscFree((*relax)->change));
  PetscCall(PetscFree(*relax));
  PetscFunctionReturn(PETSC_SUCCESS);
}
