/* The phases that the ranks have computed, brought together. */
#include <mpmstab/symbol.h>
#include <math.h>

#define AWAY 0.05 /* from 1 */
#define SAME 1e-9 /* abs that differ by less are the same */

/* Counts and displacements of the ranks' parts, width numbers a phase. */
static PetscErrorCode Parts(MPI_Comm comm, const MpmSymbol *s, PetscInt width, PetscMPIInt **counts,
                            PetscMPIInt **begins)
{
  PetscMPIInt size, mine;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMPIIntCast((PetscInt64)width * s->count, &mine));
  PetscCall(PetscMalloc2(size, counts, size, begins));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPI_INT, *counts, 1, MPI_INT, comm));
  (*begins)[0] = 0;
  for (PetscMPIInt r = 1; r < size; r++) (*begins)[r] = (*begins)[r - 1] + (*counts)[r - 1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolGather(MPI_Comm comm, const MpmSymbol *s, const PetscReal curve[], PetscReal **all)
{
  PetscMPIInt *counts, *begins, rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(PetscMalloc1(rank ? 0 : s->half + 1, all));
  PetscCall(Parts(comm, s, 1, &counts, &begins));
  PetscCallMPI(MPI_Gatherv(curve, (PetscMPIInt)s->count, MPIU_REAL, *all, counts, begins, MPIU_REAL, 0, comm));
  PetscCall(PetscFree2(counts, begins));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolGatherFactors(MPI_Comm comm, const MpmSymbol *s, PetscInt exponent, PetscReal **factors)
{
  const PetscInt width = 2 * s->size;
  PetscMPIInt   *counts, *begins;
  PetscReal     *scaled;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1((size_t)width * s->phases, factors));
  PetscCall(PetscMalloc1((size_t)width * s->count, &scaled));
  for (PetscInt i = 0; i < s->count; i++)
    for (PetscInt j = 0; j < width; j++)
      scaled[width * i + j] = scalbn(s->factors[width * i + j], (int)(s->exponents[i] - exponent));
  PetscCall(Parts(comm, s, width, &counts, &begins));
  PetscCallMPI(
      MPI_Allgatherv(scaled, (PetscMPIInt)(width * s->count), MPIU_REAL, *factors, counts, begins, MPIU_REAL, comm));
  /* the table is real: G(-beta) is the conjugate of G(beta) */
  for (PetscInt m = s->half + 1; m < s->phases; m++)
    for (PetscInt j = 0; j < width; j++)
      (*factors)[width * m + j] = (*factors)[width * (s->phases - m) + j] * (j % 2 ? -1 : 1);
  PetscCall(PetscFree2(counts, begins));
  PetscCall(PetscFree(scaled));
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  PetscReal re, im, size, distance;
} Candidate;

static PetscBool IsBetter(const Candidate *a, const Candidate *b)
{
  const PetscBool away = a->distance > AWAY ? PETSC_TRUE : PETSC_FALSE;

  if (away != (b->distance > AWAY ? PETSC_TRUE : PETSC_FALSE)) return away;
  if (away && fabs(a->size - b->size) > SAME * b->size) return a->size > b->size ? PETSC_TRUE : PETSC_FALSE;
  return a->distance > b->distance * (1 + SAME) ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmSymbolTarget(MPI_Comm comm, const MpmSymbol *s, PetscInt exponent, PetscReal target[2])
{
  Candidate   best = {.distance = -1}, *all;
  PetscMPIInt ranks;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->count; i++) {
    for (PetscInt j = 0; j < s->size; j++) {
      const PetscReal *factor = s->factors + 2 * (s->size * i + j);
      Candidate        c      = {.re = scalbn(factor[0], (int)(s->exponents[i] - exponent)),
                                 .im = fabs(scalbn(factor[1], (int)(s->exponents[i] - exponent)))};

      c.size     = hypot(c.re, c.im);
      c.distance = hypot(c.re - scalbn(1, -(int)exponent), c.im);
      if (IsBetter(&c, &best)) best = c;
    }
  }
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(PetscMalloc1(ranks, &all));
  PetscCallMPI(MPI_Allgather(&best, 4, MPIU_REAL, all, 4, MPIU_REAL, comm));
  best = all[0];
  for (PetscMPIInt r = 1; r < ranks; r++)
    if (IsBetter(&all[r], &best)) best = all[r];
  PetscCall(PetscFree(all));
  target[0] = best.re;
  target[1] = best.im;
  PetscFunctionReturn(PETSC_SUCCESS);
}
