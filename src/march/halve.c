/* Takes a step in parts, where it cannot be taken as a whole. */
#include "march/halve.h"
#include "base/text.h"

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

PetscErrorCode MpmHalveStep(MpmMarch *march, PetscErrorCode (*take)(MpmMarch *march, PetscBool sample),
                            PetscBool sample)
{
  const PetscReal whole = march->courant;
  MpmHalve       *h     = march->halve;
  PetscInt        level = 0;

  PetscFunctionBegin;
  for (PetscInt64 done = 0, parts = 1; done < parts;) {
    PetscCall(Keep(march));
    PetscCall(take(march, sample));
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
