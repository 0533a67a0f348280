/*
   Computes the eigenvalues of a source's matrix at each phase, and the largest of all. Phases are spread over the
   ranks, and the functions at the end of this file gather the results.
*/
#include "base/memory.h"
#include "base/progress.h"
#include "linalg/small_eigen.h"
#include "symbol/source.h"
#include <mpmstab/errors.h>
#include <mpmstab/symbol.h>
#include <mpmstab/verdict.h>
#include <math.h>

#define SHARES_MAXIMUM 1e-12 /* relative: growths that differ by less are taken for equal */
#define NEAR 10              /* in tolerances: up to this growth - 1 the error of a defective eigenvalue is computed */

/*
   plain, noisy - memory for the matrices of several cases, and for those with noise where the source knows how rounding
                  goes through a period; else NULL
   exponent, other - theirs
   growth, without_null - of a phase in all cases
   which        - numbers of cases
*/
typedef struct {
  const MpmSource *source;
  MpmSmallEigen    eigen;
  double complex  *plain, *noisy;
  PetscReal       *growth, *without_null;
  PetscInt        *exponent, *other, *which;
} Reader;

static PetscErrorCode ReaderCreate(const MpmSource *source, Reader *r)
{
  const PetscInt numbers = source->together * source->size * source->size, cases = source->cases;

  PetscFunctionBegin;
  *r = (Reader){.source = source};
  PetscCall(MpmSmallEigenCreate(source->size, &r->eigen));
  PetscCall(PetscMalloc1(numbers, &r->plain));
  if (source->has_noise) PetscCall(PetscMalloc1(numbers, &r->noisy));
  PetscCall(PetscMalloc5(cases, &r->growth, cases, &r->without_null, source->together, &r->exponent, source->together,
                         &r->other, cases, &r->which));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReaderDestroy(Reader *r)
{
  PetscFunctionBegin;
  PetscCall(MpmSmallEigenDestroy(&r->eigen));
  PetscCall(PetscFree(r->plain));
  PetscCall(PetscFree(r->noisy));
  PetscCall(PetscFree5(r->growth, r->without_null, r->exponent, r->other, r->which));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSourceMatrix(const MpmSource *source, const PetscReal beta[], double complex G[], PetscInt *exponent)
{
  const PetscInt first = 0;

  PetscFunctionBegin;
  PetscCall(source->matrices(source->context, 1, &first, beta, PETSC_FALSE, G, exponent));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Computes the matrices of a phase in up to as many cases as the source takes together; noisy: also those with noise,
   for Rounding.
*/
static PetscErrorCode Matrices(Reader *r, PetscInt n, const PetscInt which[], const PetscReal beta[], PetscBool noisy)
{
  const MpmSource *s = r->source;

  PetscFunctionBegin;
  PetscCall(s->matrices(s->context, n, which, beta, PETSC_FALSE, r->plain, r->exponent));
  if (noisy && r->noisy) PetscCall(s->matrices(s->context, n, which, beta, PETSC_TRUE, r->noisy, r->other));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts one of the matrices where the solver takes it. */
static PetscErrorCode Take(Reader *r, PetscInt k)
{
  const PetscInt n = r->eigen.n * r->eigen.n;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(r->eigen.matrix, r->plain + k * n, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Square(double complex z)
{
  return creal(z) * creal(z) + cimag(z) * cimag(z);
}

/*
   An estimate of the rounding error of one of the matrices, in the Frobenius norm. Over a period of several steps,
   modes may grow by many digits on the way and shrink again. So there the error is the difference to a matrix whose
   steps are disturbed by rounding (see source.h).
*/
static PetscReal Rounding(const Reader *r, PetscInt k)
{
  const PetscInt        n = r->eigen.n * r->eigen.n, exponent = r->exponent[k];
  const double complex *plain  = r->plain + k * n;
  PetscReal             sum[2] = {0, 0};

  for (PetscInt i = 0; i < n; i++) sum[0] += Square(plain[i]);
  if (r->noisy) {
    const PetscReal scale = scalbn(1, (int)(r->other[k] - exponent));

    for (PetscInt i = 0; i < n; i++) sum[1] += Square(r->noisy[k * n + i] * scale - plain[i]);
  }
  return PetscMax(sqrt(sum[1]), MPM_ROUNDING * sqrt(sum[0]));
}

/* Computes a phase's amplification factors, divided by 2^exponent, and which is the largest. Overwrites the matrix. */
static PetscErrorCode Factors(Reader *r, PetscBool vectors, PetscInt *largest)
{
  PetscFunctionBegin;
  PetscCall(MpmSmallEigenSolve(&r->eigen, vectors));
  *largest = 0;
  for (PetscInt i = 1; i < r->eigen.n; i++)
    if (Square(r->eigen.value[i]) > Square(r->eigen.value[*largest])) *largest = i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the count amplification factors nearest to a number to the end of the n. */
static void Drop(double complex value[], PetscInt n, PetscInt count, PetscReal number)
{
  for (PetscInt i = n - 1; i >= n - count; i--) { /* the nearest of those that are left goes to place i */
    for (PetscInt j = 0; j < i; j++) {
      if (cabs(value[j] - number) < cabs(value[i] - number)) {
        const double complex kept = value[i];

        value[i] = value[j];
        value[j] = kept;
      }
    }
  }
}

/* The largest abs of the amplification factors without the null space of P2G. */
static PetscReal LargestWithoutNull(Reader *r, PetscInt exponent)
{
  const MpmSource *source = r->source;
  const PetscInt   rest = source->null_rest, all = source->null_all;
  double complex  *value   = r->eigen.value;
  const PetscReal  one     = scalbn(1, -(int)exponent);
  PetscReal        largest = 0;

  Drop(value, r->eigen.n, rest, one);
  Drop(value, r->eigen.n - rest, all - rest, one * source->null_factor);
  for (PetscInt i = 0; i < r->eigen.n - all; i++) largest = PetscMax(largest, cabs(value[i]));
  return largest / one;
}

/* The phase that is computed for the i-th class of this rank. */
static void BetaOf(const MpmSymbol *s, PetscInt i, PetscReal beta[])
{
  MpmSymbolBeta(s, MpmSymbolPhaseOfClass(s, s->first + i), beta);
}

/*
   The amplification factors of a phase of this rank, where they are kept, and growth unless the source has given it.
   Whether they are kept changes no digit of growth.
*/
static PetscErrorCode VisitMatrix(Reader *r, PetscInt i, PetscInt exponent, MpmSymbol *s)
{
  PetscInt largest;

  PetscFunctionBegin;
  PetscCall(Factors(r, PETSC_FALSE, &largest));
  if (s->factors) {
    s->exponents[i] = exponent;
    for (PetscInt j = 0; j < s->size; j++) {
      s->factors[2 * (s->size * i + j)]     = creal(r->eigen.value[j]);
      s->factors[2 * (s->size * i + j) + 1] = cimag(r->eigen.value[j]);
    }
  }
  if (r->source->growths) PetscFunctionReturn(PETSC_SUCCESS);
  s->per_phase[i] = MpmGrowthPerStep(cabs(r->eigen.value[largest]), exponent, s->period);
  if (s->without_null) s->without_null[i] = LargestWithoutNull(r, exponent);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A phase of this rank in all cases. */
static PetscErrorCode VisitPhase(Reader *r, PetscInt i, const PetscReal beta[], MpmSymbol *s[])
{
  const MpmSource *source = r->source;

  PetscFunctionBegin;
  if (source->growths) {
    PetscCall(source->growths(source->context, beta, r->growth, r->without_null));
    for (PetscInt c = 0; c < source->cases; c++) {
      s[c]->per_phase[i] = r->growth[c];
      if (s[c]->without_null) s[c]->without_null[i] = r->without_null[c];
    }
    if (!s[0]->factors) PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt c = 0; c < source->cases; c++) r->which[c] = c;
  for (PetscInt first = 0, n; first < source->cases; first += n) {
    n = PetscMin(source->together, source->cases - first);
    PetscCall(Matrices(r, n, r->which + first, beta, PETSC_FALSE));
    for (PetscInt k = 0; k < n; k++) {
      PetscCall(Take(r, k));
      PetscCall(VisitMatrix(r, i, r->exponent[k], s[first + k]));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode VisitPhases(Reader *r, MpmSymbol *s[])
{
  MpmProgress progress;

  PetscFunctionBegin;
  PetscCall(MpmProgressBegin("phase", &progress));
  for (PetscInt i = 0; i < s[0]->count; i++) {
    PetscReal beta[MPM_MAX_DIM];

    PetscCall(MpmProgressUpdate(&progress, i, s[0]->count));
    BetaOf(s[0], i, beta);
    PetscCall(VisitPhase(r, i, beta, s));
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Computes the error of a defective eigenvalue. It matters only where growth is about within the tolerance, and is left
   out elsewhere, because it takes as long as the amplification factors.
*/
static PetscErrorCode FindDefectiveError(MPI_Comm comm, Reader *r, MpmSymbol *s[])
{
  PetscInt some = 0;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < r->source->cases; c++)
    if (s[c]->growth <= 1 + NEAR * s[c]->wish.tolerance) r->which[some++] = c;
  for (PetscInt i = 0; i < s[0]->count && some; i++) {
    PetscReal beta[MPM_MAX_DIM];

    BetaOf(s[0], i, beta);
    for (PetscInt first = 0, n; first < some; first += n) {
      n = PetscMin(r->source->together, some - first);
      PetscCall(Matrices(r, n, r->which + first, beta, PETSC_TRUE));
      for (PetscInt k = 0; k < n; k++) {
        MpmSymbol *at = s[r->which[first + k]];

        at->defective_error =
            PetscMax(at->defective_error, MpmDefectiveErrorOf(Rounding(r, k), r->exponent[k], at->period));
      }
    }
  }
  for (PetscInt k = 0; k < some; k++)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &s[r->which[k]]->defective_error, 1, MPIU_REAL, MPI_MAX, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Finds the growth of one phase in a case, the condition number of its amplification factor, and from it the error that
   rounding makes. r->exponent[0] is the exponent of the matrix.
*/
static PetscErrorCode LookAt(Reader *r, PetscInt which, const PetscReal beta[], MpmSourceGrowth *at)
{
  PetscInt       largest;
  double complex overlap = 0, leading;

  PetscFunctionBegin;
  PetscCall(Matrices(r, 1, &which, beta, PETSC_TRUE));
  PetscCall(Take(r, 0));
  PetscCall(Factors(r, PETSC_TRUE, &largest));
  leading = r->eigen.value[largest];
  for (PetscInt i = 0; i < r->eigen.n; i++)
    overlap += conj(r->eigen.left[r->eigen.n * largest + i]) * r->eigen.right[r->eigen.n * largest + i];
  at->growth    = MpmGrowthPerStep(cabs(leading), r->exponent[0], r->source->period);
  at->condition = 1 / cabs(overlap);
  at->relative  = at->condition * Rounding(r, 0) / cabs(leading);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Finds the largest growth of a case, the first phase that has it, and the condition number of its amplification
   factor.
*/
static PetscErrorCode FindLargest(MPI_Comm comm, Reader *r, PetscInt which, MpmSymbol *s)
{
  PetscInt class = s->classes;
  MpmSourceGrowth at;

  PetscFunctionBegin;
  s->growth = 0;
  for (PetscInt i = 0; i < s->count; i++) s->growth = PetscMax(s->growth, s->per_phase[i]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &s->growth, 1, MPIU_REAL, MPI_MAX, comm));
  for (PetscInt i = s->count - 1; i >= 0; i--)
    if (s->per_phase[i] >= s->growth * (1 - SHARES_MAXIMUM)) class = s->first + i;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &class, 1, MPIU_INT, MPI_MIN, comm));
  MpmSymbolBeta(s, MpmSymbolPhaseOfClass(s, class), s->beta_at_max);
  PetscCall(LookAt(r, which, s->beta_at_max, &at));
  s->exponent    = r->exponent[0];
  s->condition   = at.condition;
  s->uncertainty = MpmUncertaintyOf(s->growth, at.relative, s->period);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the number of phases. Refuses output that does not fit: curves and factors all pass through the first rank. */
static PetscErrorCode CountPhases(MPI_Comm comm, const MpmSource *source, MpmSymbol *s)
{
  const PetscInt dim = s->dim;
  PetscReal      all = 1, numbers, bytes;
  char           text[MPM_MAX_DIM * 16];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim; a++) {
    s->phases[a] = s->wish.phases[a];
    all *= s->phases[a];
  }
  PetscCall(MpmPhasesText(dim, s->phases, sizeof text, text));
  numbers = (s->wish.keep ? 2.0 * s->size : 1) * all;
  bytes   = numbers * sizeof(PetscReal) + (dim > 1 ? all * sizeof(PetscInt) : 0);
  MpmCheckInput(numbers <= PETSC_MAX_INT,
                "phases %s: the output would hold %.3g numbers; allowed: at most %d, so fewer phases", text, numbers,
                PETSC_MAX_INT);
  PetscCall(MpmMemoryCheck(comm, source->name, bytes, "the symbol"));
  s->all = (PetscInt)all;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The symbol of a case, with room for its curves. */
static PetscErrorCode Create(MPI_Comm comm, const MpmSource *source, const MpmSymbolWish *wish, MpmSymbol **symbol)
{
  PetscMPIInt rank, size;
  MpmSymbol  *s;
  PetscInt    room;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscNew(symbol));
  s         = *symbol;
  s->wish   = *wish;
  s->dim    = source->dim;
  s->size   = source->size;
  s->period = source->period;
  PetscCall(CountPhases(comm, source, s));
  MpmPhasesFind(source, s);
  PetscCall(MpmPhasesList(s));
  s->first = (PetscInt)((PetscInt64)s->classes * rank / size);
  s->count = (PetscInt)((PetscInt64)s->classes * (rank + 1) / size) - s->first;
  room     = PetscMax(1, s->count); /* not 0 for a rank without phases: NULL would say that there is no such curve */
  PetscCall(PetscMalloc1(room, &s->per_phase));
  if (source->null_all != MPM_NONE) PetscCall(PetscMalloc1(room, &s->without_null));
  if (wish->keep) PetscCall(PetscMalloc2(2 * s->size * room, &s->factors, room, &s->exponents));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolFromSource(MPI_Comm comm, const MpmSource *source, const MpmSymbolWish *wish,
                                   MpmSymbol *symbols[])
{
  const PetscReal begin = MPI_Wtime();
  Reader          reader;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < source->cases; c++) PetscCall(Create(comm, source, wish, &symbols[c]));
  PetscCall(ReaderCreate(source, &reader));
  PetscCall(VisitPhases(&reader, symbols));
  for (PetscInt c = 0; c < source->cases; c++) PetscCall(FindLargest(comm, &reader, c, symbols[c]));
  PetscCall(FindDefectiveError(comm, &reader, symbols));
  PetscCall(ReaderDestroy(&reader));
  for (PetscInt c = 0; c < source->cases; c++) symbols[c]->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSourceGrowthAt(const MpmSource *source, const PetscReal beta[], MpmSourceGrowth *at)
{
  Reader reader;

  PetscFunctionBegin;
  PetscCall(ReaderCreate(source, &reader));
  PetscCall(LookAt(&reader, 0, beta, at));
  PetscCall(ReaderDestroy(&reader));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolDestroy(MpmSymbol **symbol)
{
  PetscFunctionBegin;
  if (!*symbol) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*symbol)->list));
  PetscCall(PetscFree((*symbol)->per_phase));
  PetscCall(PetscFree((*symbol)->without_null));
  if ((*symbol)->factors) PetscCall(PetscFree2((*symbol)->factors, (*symbol)->exponents));
  PetscCall(PetscFree(*symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define AWAY 0.05      /* distance from 1 */
#define EQUAL_ABS 1e-9 /* relative: abs that differ by less are taken for equal */

/* The counts and displacements of the ranks' parts for a gather, of width numbers a phase. */
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
  PetscCall(PetscMalloc1(rank ? 0 : s->classes, all));
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
  PetscCall(PetscMalloc1((size_t)width * s->all, factors));
  PetscCall(PetscMalloc1((size_t)width * s->count, &scaled));
  for (PetscInt i = 0; i < s->count; i++)
    for (PetscInt j = 0; j < width; j++)
      scaled[width * i + j] = scalbn(s->factors[width * i + j], (int)(s->exponents[i] - exponent));
  PetscCall(Parts(comm, s, width, &counts, &begins));
  PetscCallMPI(
      MPI_Allgatherv(scaled, (PetscMPIInt)(width * s->count), MPIU_REAL, *factors, counts, begins, MPIU_REAL, comm));
  /*
     a phase has no smaller number than its class, so that from the last one on a phase takes the place of a class read
  */
  for (PetscInt phase = s->all - 1; phase >= 0; phase--) {
    PetscBool      conjugate;
    const PetscInt i = MpmSymbolClass(s, phase, &conjugate);

    for (PetscInt j = 0; j < width; j++)
      (*factors)[width * phase + j] = (*factors)[width * i + j] * (conjugate && j % 2 ? -1 : 1);
  }
  PetscCall(PetscFree2(counts, begins));
  PetscCall(PetscFree(scaled));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsBetter(const MpmSymbolFactor *a, const MpmSymbolFactor *b)
{
  const PetscBool away = a->distance > AWAY ? PETSC_TRUE : PETSC_FALSE;

  if (b->size < 0 || a->size < 0) return a->size > b->size ? PETSC_TRUE : PETSC_FALSE;
  if (away != (b->distance > AWAY ? PETSC_TRUE : PETSC_FALSE)) return away;
  if (away && fabs(a->size - b->size) > EQUAL_ABS * b->size) return a->size > b->size ? PETSC_TRUE : PETSC_FALSE;
  return a->distance > b->distance * (1 + EQUAL_ABS) ? PETSC_TRUE : PETSC_FALSE;
}

/* Inserts a factor in a list that is sorted, best first. */
static void Insert(MpmSymbolFactor c, PetscInt n, MpmSymbolFactor best[])
{
  for (PetscInt i = 0; i < n; i++) {
    if (IsBetter(&c, &best[i])) {
      const MpmSymbolFactor kept = best[i];

      best[i] = c;
      c       = kept;
    }
  }
}

/* The best factor of a class. */
static MpmSymbolFactor BestOf(const MpmSymbol *s, PetscInt i, PetscInt exponent)
{
  MpmSymbolFactor best = {.size = -1};

  for (PetscInt j = 0; j < s->size; j++) {
    const PetscReal *factor = s->factors + 2 * (s->size * i + j);
    MpmSymbolFactor  c      = {.re    = scalbn(factor[0], (int)(s->exponents[i] - exponent)),
                               .im    = scalbn(factor[1], (int)(s->exponents[i] - exponent)),
                               .phase = (PetscReal)MpmSymbolPhaseOfClass(s, s->first + i)};

    c.size     = hypot(c.re, c.im);
    c.distance = hypot(c.re - scalbn(1, -(int)exponent), c.im);
    if (IsBetter(&c, &best)) best = c;
  }
  return best;
}

PetscErrorCode MpmSymbolLeading(MPI_Comm comm, const MpmSymbol *s, PetscInt exponent, PetscInt n,
                                MpmSymbolFactor best[])
{
  const PetscMPIInt count = (PetscMPIInt)(n * (PetscInt)(sizeof(*best) / sizeof(PetscReal)));
  PetscMPIInt       ranks;
  MpmSymbolFactor  *all;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) best[i] = (MpmSymbolFactor){.size = -1};
  for (PetscInt i = 0; i < s->count; i++) Insert(BestOf(s, i, exponent), n, best);
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(PetscMalloc1(ranks * n, &all));
  PetscCallMPI(MPI_Allgather(best, count, MPIU_REAL, all, count, MPIU_REAL, comm));
  for (PetscInt i = 0; i < n; i++) best[i] = (MpmSymbolFactor){.size = -1};
  for (PetscInt i = 0; i < ranks * n; i++) Insert(all[i], n, best);
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolTarget(MPI_Comm comm, const MpmSymbol *s, PetscInt exponent, PetscReal target[2])
{
  MpmSymbolFactor best;

  PetscFunctionBegin;
  PetscCall(MpmSymbolLeading(comm, s, exponent, 1, &best));
  target[0] = best.re;
  target[1] = fabs(best.im);
  PetscFunctionReturn(PETSC_SUCCESS);
}
