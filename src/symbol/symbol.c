/* Phase after phase: amplification matrix, its eigenvalues, the largest of all; phases are spread over the ranks. */
#include "symbol/bloch.h"
#include "linalg/small_eigen.h"
#include <mpmstab/errors.h>
#include "scene/layout.h"
#include "base/progress.h"
#include <mpmstab/symbol.h>
#include <mpmstab/verdict.h>
#include <math.h>

#define MOST_PPC 512
#define SAME 1e-12 /* growths that differ by less share the maximum */
#define NEAR 10    /* tolerances within which what rounding may hide is looked for */

/* noisy: room for a second matrix, where a period asks for it. */
typedef struct {
  MpmBloch        bloch;
  MpmSmallEigen   eigen;
  double complex *noisy;
} Reader;

static PetscReal Square(double complex z)
{
  return creal(z) * creal(z) + cimag(z) * cimag(z);
}

/*
   How far rounding may have moved the matrix of a phase, in the Frobenius norm. Over a period it is seen by
   disturbing the steps: modes may grow by many digits on the way and die again.
*/
static PetscErrorCode Rounding(Reader *r, const MpmSymbol *s, PetscReal beta, PetscInt exponent, PetscReal *error)
{
  const PetscInt n      = r->eigen.n * r->eigen.n;
  PetscReal      sum[2] = {0, 0};
  PetscInt       other;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) sum[0] += Square(r->eigen.matrix[i]);
  if (r->noisy) {
    PetscCall(MpmBlochMatrix(&r->bloch, s->step.courant, beta, PETSC_TRUE, r->noisy, &other));
    for (PetscInt i = 0; i < n; i++)
      sum[1] += Square(r->noisy[i] * scalbn(1, (int)(other - exponent)) - r->eigen.matrix[i]);
  }
  *error = PetscMax(sqrt(sum[1]), MPM_ROUNDING * sqrt(sum[0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The factors of a phase and which is the largest; they are divided by 2^exponent, and the matrix is overwritten. */
static PetscErrorCode Factors(Reader *r, PetscBool vectors, PetscInt *largest)
{
  PetscFunctionBegin;
  PetscCall(MpmSmallEigenSolve(&r->eigen, vectors));
  *largest = 0;
  for (PetscInt i = 1; i < r->eigen.n; i++)
    if (Square(r->eigen.value[i]) > Square(r->eigen.value[*largest])) *largest = i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the count factors nearest to a number out of n. */
static void Drop(double complex value[], PetscInt n, PetscInt count, PetscReal number)
{
  for (PetscInt i = n - 1; i >= n - count; i--) { /* the nearest of those left comes to place i */
    for (PetscInt j = 0; j < i; j++) {
      if (cabs(value[j] - number) < cabs(value[i] - number)) {
        const double complex kept = value[i];

        value[i] = value[j];
        value[j] = kept;
      }
    }
  }
}

/*
   The largest abs without what no node sees, for each field ppc - 1 factors: that part rests, with the factor 1, or
   with what the transfer leaves of it.
*/
static PetscReal LargestSeen(Reader *r)
{
  const MpmScheme *scheme = r->bloch.scheme;
  const PetscInt   others = r->bloch.layout->ppc - 1, rest = scheme->table->unfiltered * others,
                 all      = scheme->table->nstate * others;
  double complex *value   = r->eigen.value;
  PetscReal       largest = 0;

  Drop(value, r->eigen.n, rest, 1);
  Drop(value, r->eigen.n - rest, all - rest, scheme->transfer->unseen(&scheme->numbers));
  for (PetscInt i = 0; i < r->eigen.n - all; i++) largest = PetscMax(largest, cabs(value[i]));
  return largest;
}

static PetscErrorCode VisitPhases(Reader *r, MpmSymbol *s)
{
  MpmProgress progress;

  PetscFunctionBegin;
  PetscCall(MpmProgressBegin("phase", &progress));
  for (PetscInt i = 0; i < s->count; i++) {
    const PetscReal beta = MpmSymbolPhase(s->first + i, s->phases);
    PetscInt        largest, exponent;

    PetscCall(MpmProgressUpdate(&progress, i, s->count));

    PetscCall(MpmBlochMatrix(&r->bloch, s->step.courant, beta, PETSC_FALSE, r->eigen.matrix, &exponent));
    PetscCall(Factors(r, PETSC_FALSE, &largest));
    s->per_phase[i] = MpmGrowthPerStep(cabs(r->eigen.value[largest]), exponent, s->period);
    if (s->seen) s->seen[i] = LargestSeen(r);
    if (!s->factors) continue;
    s->exponents[i] = exponent;
    for (PetscInt j = 0; j < s->size; j++) {
      s->factors[2 * (s->size * i + j)]     = creal(r->eigen.value[j]);
      s->factors[2 * (s->size * i + j) + 1] = cimag(r->eigen.value[j]);
    }
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   How far rounding may have split a defective pair. It decides where nothing grows beyond the tolerance, and is not
   looked for elsewhere: it costs as much as the factors.
*/
static PetscErrorCode FindDefectiveError(MPI_Comm comm, Reader *r, MpmSymbol *s)
{
  PetscFunctionBegin;
  if (!(s->growth <= 1 + NEAR * s->wish.tolerance)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < s->count; i++) {
    const PetscReal beta = MpmSymbolPhase(s->first + i, s->phases);
    PetscReal       error;
    PetscInt        exponent;

    PetscCall(MpmBlochMatrix(&r->bloch, s->step.courant, beta, PETSC_FALSE, r->eigen.matrix, &exponent));
    PetscCall(Rounding(r, s, beta, exponent, &error));
    s->defective_error = PetscMax(s->defective_error, MpmDefectiveErrorOf(error, exponent, s->period));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &s->defective_error, 1, MPIU_REAL, MPI_MAX, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest growth, the first phase that has it, and how sensitive that factor is. */
static PetscErrorCode FindLargest(MPI_Comm comm, Reader *r, MpmSymbol *s)
{
  PetscInt       m       = s->half + 1, largest;
  double complex overlap = 0, leading;
  PetscReal      error;

  PetscFunctionBegin;
  s->growth = 0;
  for (PetscInt i = 0; i < s->count; i++) s->growth = PetscMax(s->growth, s->per_phase[i]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &s->growth, 1, MPIU_REAL, MPI_MAX, comm));
  for (PetscInt i = s->count - 1; i >= 0; i--)
    if (s->per_phase[i] >= s->growth * (1 - SAME)) m = s->first + i;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &m, 1, MPIU_INT, MPI_MIN, comm));
  s->beta_at_max = MpmSymbolPhase(m, s->phases);
  PetscCall(MpmBlochMatrix(&r->bloch, s->step.courant, s->beta_at_max, PETSC_FALSE, r->eigen.matrix, &s->exponent));
  PetscCall(Rounding(r, s, s->beta_at_max, s->exponent, &error));
  PetscCall(Factors(r, PETSC_TRUE, &largest));
  leading = r->eigen.value[largest];
  for (PetscInt i = 0; i < s->size; i++)
    overlap += conj(r->eigen.left[s->size * largest + i]) * r->eigen.right[s->size * largest + i];
  s->condition   = 1 / cabs(overlap);
  s->uncertainty = MpmUncertaintyOf(s->growth, s->condition * error / cabs(leading), s->period);
  PetscFunctionReturn(PETSC_SUCCESS);
}

const char *MpmSymbolWhyNot(const MpmLayout *layout)
{
  if (!MpmLayoutIsPeriodic(layout)) return "at walls Fourier modes mix";
  if (!MpmLayoutIsUniform(layout)) return "cells differ, so Fourier modes mix";
  if (layout->ppc > MOST_PPC) return "with so many particles per cell its blocks are too large";
  return NULL;
}

/* Curves, and with them the factors that are written, each on its way through the first rank. */
static PetscErrorCode CheckSize(MPI_Comm comm, const MpmSymbol *s)
{
  const PetscReal numbers = (s->wish.keep ? 2.0 * s->size : 1) * s->phases;

  PetscFunctionBegin;
  MpmCheckInput(numbers <= PETSC_MAX_INT,
                "phases %" PetscInt_FMT ": the output would hold %.3g numbers; allowed: at most %d, so fewer phases",
                s->phases, numbers, PETSC_MAX_INT);
  PetscCall(MpmLayoutCheckMemory(comm, s->layout, numbers * sizeof(PetscReal), "the symbol"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolCheck(const MpmLayout *layout)
{
  PetscFunctionBegin;
  MpmCheckInput(MpmLayoutIsPeriodic(layout),
                "boundary %s,%s: the symbol needs a domain without ends; allowed: periodic ('mpmstab spectrum' takes "
                "any)",
                MpmEndNames[layout->grid.ends[0]], MpmEndNames[layout->grid.ends[1]]);
  MpmCheckInput(layout->counts.n == 1 && layout->material.kind == MPM_MATERIAL_UNIFORM,
                "%s: the symbol needs the same particles in every cell; allowed: without it ('mpmstab spectrum' takes "
                "any layout)",
                layout->counts.n > 1 ? "counts" : "material");
  MpmCheckInput(MpmLayoutIsFull(layout),
                "fill: the symbol needs the same particles in every cell; allowed: without fill ('mpmstab spectrum' "
                "takes any layout)");
  MpmCheckInput(MpmLayoutIsUniform(layout),
                "jitter %g: the symbol needs the same particles in every cell; allowed: jitter 0 ('mpmstab spectrum' "
                "takes any layout)",
                layout->jitter);
  MpmCheckInput(!MpmSymbolWhyNot(layout),
                "ppc %" PetscInt_FMT ": the symbol's blocks would be too large; allowed: at most %d", layout->ppc,
                MOST_PPC);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                               const MpmSymbolWish *wish, MpmSymbol **symbol)
{
  const PetscReal begin = MPI_Wtime();
  PetscMPIInt     rank, size;
  MpmSymbol      *s;
  Reader          reader = {.noisy = NULL};
  PetscInt        room;

  PetscFunctionBegin;
  PetscCall(MpmSymbolCheck(layout));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscNew(symbol));
  s         = *symbol;
  s->layout = layout;
  s->scheme = scheme;
  s->step   = *step;
  s->wish   = *wish;
  PetscCall(MpmStepPeriod(step, &s->period));
  s->phases = wish->phases;
  s->half   = wish->phases / 2;
  s->first  = (PetscInt)((PetscInt64)(s->half + 1) * rank / size);
  s->count  = (PetscInt)((PetscInt64)(s->half + 1) * (rank + 1) / size) - s->first;
  PetscCall(MpmBlochCreate(layout, scheme, &step->drift, &reader.bloch));
  s->size = reader.bloch.size;
  PetscCall(CheckSize(comm, s));
  PetscCall(MpmSmallEigenCreate(s->size, &reader.eigen));
  if (s->period > 1) PetscCall(PetscMalloc1(s->size * s->size, &reader.noisy));
  room = PetscMax(1, s->count); /* a rank without phases, of nothing, would not know what there is to gather */
  PetscCall(PetscMalloc1(room, &s->per_phase));
  if (s->period == 1 && scheme->transfer->unseen) PetscCall(PetscMalloc1(room, &s->seen));
  if (wish->keep) PetscCall(PetscMalloc2(2 * s->size * room, &s->factors, room, &s->exponents));
  PetscCall(VisitPhases(&reader, s));
  PetscCall(FindLargest(comm, &reader, s));
  PetscCall(FindDefectiveError(comm, &reader, s));
  PetscCall(MpmSmallEigenDestroy(&reader.eigen));
  PetscCall(PetscFree(reader.noisy));
  PetscCall(MpmBlochDestroy(&reader.bloch));
  s->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolDestroy(MpmSymbol **symbol)
{
  PetscFunctionBegin;
  if (!*symbol) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*symbol)->per_phase));
  PetscCall(PetscFree((*symbol)->seen));
  if ((*symbol)->factors) PetscCall(PetscFree2((*symbol)->factors, (*symbol)->exponents));
  PetscCall(PetscFree(*symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}
