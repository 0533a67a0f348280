/*
   Symbol: amplification factors of Fourier modes. On a uniform layout Fourier modes do not mix. A table applied to one
   mode gives a small matrix, and its eigenvalues are the amplification factors.
*/
#pragma once
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>

/*S
   MpmSymbolWish - what a caller wants of a symbol.

   phases    - the number of phases in [0, 2 pi), in each direction
   keep      - the amplification factors are kept, not only the growth
   tolerance - growth per step up to 1 + tolerance counts as none; only defective_error depends on it
S*/
typedef struct {
  PetscInt  phases[MPM_MAX_DIM];
  PetscBool keep;
  PetscReal tolerance;
} MpmSymbolWish;

/*S
   MpmSymbol - amplification factors of one step, or under drift of one period, over the phases
   beta_a = 2 pi m_a / phases_a, with one m_a for each direction. A phase has the number m_0 + phases_0 (m_1 + ...).

   Phases that a symmetry of the scheme and its layout takes to one another have the same amplification factors, or
   conjugate ones. They are one class, of which only the phase with the least number is computed. In one dimension these
   are the phases up to pi.

   layout, scheme, step - as given to MpmSymbolCreate. layout and scheme are NULL where the matrices come from
                          elsewhere.
   wish         - what was asked for
   dim          - the number of directions
   phases, all  - the number of phases in each direction, and their product
   reflects     - reflects[a]: beta_a and -beta_a have the same amplification factors, because particles are centred in
                  their cells (offset 1/2) and do not move in this direction
   alike        - alike[a]: the first direction that may be exchanged with direction a, because ppc, offset, drift and
                  phases are the same
   classes      - the number of classes; beta and -beta always share one
   list         - list[i]: the phase of class i that is computed; NULL in one dimension, where it is i
   first, count - this rank computes the classes of first <= i < first + count
   size         - the order of the matrix of a phase: fields x particles in a cell
   period       - the number of steps in a period (MpmStepPeriod)
   growth       - per step: the largest abs(amplification factor)^(1 / period) over all phases
   beta_at_max  - the phase of growth; of several phases with the same growth, but for rounding, that of least number
   condition    - the condition number of the amplification factor that growth belongs to. It is an eigenvalue of the
                  matrix of that phase divided by 2^exponent.
   uncertainty  - an estimate of the error of growth by rounding
   defective_error - the error of a defective eigenvalue at 1: the growth per step that rounding may make of a defective
                  pair at 1 (see verdict.h). It is 0 where growth - 1 is more than ten times the tolerance and the error
                  does not matter.
   seconds      - the time that the computation took
   per_phase    - per_phase[i]: the growth of class first + i
   without_null - without_null[i]: the growth of class first + i without the null space of P2G, which is particle data
                  that no node feels. Left out are the amplification factors nearest to 1, or nearest to the transfer's
                  filter symbol at alpha = 0 where a filter acts on the field. Of a field they are all but so many as
                  nodes have numbers of it: 1 for a number, dim for a vector with its affine part, and dim for a stress,
                  whose forces are a vector. NULL where a period has more than one step, and for transfers without
                  filter symbol.
   factors      - NULL unless kept. factors[2 (size i + j)] and the next number are the real and the imaginary part of
                  amplification factor j of class first + i, divided by 2^exponents[i].
   exponents    - see factors

   Source: docs/theory.md, section 3; Berzins, Kirby and Gritton 2013 for the method.
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  MpmStep          step;
  MpmSymbolWish    wish;
  PetscInt         dim, phases[MPM_MAX_DIM], alike[MPM_MAX_DIM];
  PetscBool        reflects[MPM_MAX_DIM];
  PetscInt         all, classes, *list, first, count, size, period, exponent;
  PetscReal        growth, beta_at_max[MPM_MAX_DIM], condition, uncertainty, defective_error, seconds;
  PetscReal       *per_phase, *without_null, *factors;
  PetscInt        *exponents;
} MpmSymbol;

/* Not collective. Says why a layout has no symbol; NULL when it has one. */
const char *MpmSymbolWhyNot(const MpmLayout *layout);

/* Collective. Refuses (PETSC_ERR_USER_INPUT) a layout that has no symbol. */
PetscErrorCode MpmSymbolCheck(const MpmLayout *layout);

/*
   MpmSymbolCreate - computes the symbol of a scheme on a layout, with the Courant number and the drift of step.

   MpmSymbolsCreate - the symbols at n Courant numbers in the place of step's. Each is the same as by MpmSymbolCreate.
   What does not depend on the Courant number is computed once.

   Collective. layout and scheme must outlive the symbols, each of which is destroyed with MpmSymbolDestroy.

   Errors: refuses (PETSC_ERR_USER_INPUT) layouts that are not uniform, drifts without a short period (MpmStepPeriod),
   and so many phases that their output does not fit.
*/
PetscErrorCode MpmSymbolCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                               const MpmSymbolWish *wish, MpmSymbol **symbol);
PetscErrorCode MpmSymbolsCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                PetscInt n, const PetscReal courant[], const MpmSymbolWish *wish, MpmSymbol *symbols[]);
PetscErrorCode MpmSymbolDestroy(MpmSymbol **symbol);

/* Not collective. Phase m of n equally spaced ones: 2 pi m / n. */
static inline PetscReal MpmSymbolPhase(PetscInt m, PetscInt n)
{
  return 2 * PETSC_PI * m / n;
}

/*
   Not collective.

   MpmSymbolBeta         - the phase of a number, in each direction
   MpmSymbolPhaseOfClass - the number of the phase of a class that is computed
   MpmSymbolClass        - the class of the phase of a number; conjugate: its amplification factors are the conjugates
                           of those of the phase that is computed
*/
void     MpmSymbolBeta(const MpmSymbol *symbol, PetscInt phase, PetscReal beta[]);
PetscInt MpmSymbolPhaseOfClass(const MpmSymbol *symbol, PetscInt i);
PetscInt MpmSymbolClass(const MpmSymbol *symbol, PetscInt phase, PetscBool *conjugate);

/*
   MpmSymbolTarget - the amplification factor to look for in an assembled operator. Of those farther from 1 than 0.05,
   away from the null space of P2G, it is the one of largest abs; of several such, or if there is none, it is the one
   farthest from 1.

   Collective. The symbol must have kept its amplification factors.

   Output Parameter: target - real part and imaginary part >= 0, divided by 2^exponent
*/
PetscErrorCode MpmSymbolTarget(MPI_Comm comm, const MpmSymbol *symbol, PetscInt exponent, PetscReal target[2]);

/*
   MpmSymbolGather - brings a curve, per_phase or without_null, to rank 0: a number for each class.
   MpmSymbolGatherFactors - brings the amplification factors of all phases to every rank, divided by 2^exponent:
   2 x size x all numbers. The symbol must have kept them.

   Collective. The arrays are freed with PetscFree.
*/
PetscErrorCode MpmSymbolGather(MPI_Comm comm, const MpmSymbol *symbol, const PetscReal curve[], PetscReal **all);
PetscErrorCode MpmSymbolGatherFactors(MPI_Comm comm, const MpmSymbol *symbol, PetscInt exponent, PetscReal **factors);
