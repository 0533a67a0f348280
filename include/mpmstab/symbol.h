/*
   Symbol: the third reader. On a uniform layout Fourier modes do not mix; the table over one mode gives a small
   matrix.
*/
#pragma once
#include <mpmstab/scene.h>

/*S
   MpmSymbol - amplification factors over the phases beta = 2 pi m / phases, of one step, or under drift of a period.

   A rank computes the phases [first, first + count) of 0 <= m <= phases / 2; those above have the conjugate factors.
   growth is the largest abs(factor)^(1/period) over all phases, condition the condition number of the factor it belongs
   to, an eigenvalue of a matrix divided by 2^exponent, uncertainty how far rounding may have moved growth, blur
   how far it may have split a defective pair at 1 (see verdict.h; 0 where growth is beyond ten times the tolerance, so
   that it does not matter), beta_at_max its phase: the least of those that
   share the maximum to rounding.

   per_phase[i] is the growth at phase first + i. At rest seen[i] is the same without what no node sees, which rests at
   1: of all factors but those nearest to 1 (or to what the transfer leaves of it), ppc - 1 for each field; NULL for
   transfers without such a factor. With factors kept, factors[2 (size i + j)] is the real part of factor j of phase
   first + i, the next number its imaginary part, both divided by 2^exponents[i].

   Source: THEORY.md, section 3; Berzins, Kirby and Gritton 2013 for the method.
*/
typedef struct {
  const MpmScene *scene;
  PetscInt        phases, half, first, count, size, period, exponent;
  PetscReal       growth, beta_at_max, condition, uncertainty, blur, seconds;
  PetscReal      *per_phase, *seen, *factors;
  PetscInt       *exponents;
} MpmSymbol;

/* Not collective. Why a scene has no symbol, or NULL when it has one. */
const char *MpmSymbolWhyNot(const MpmScene *scene);

/* Collective. Refuses a scene that has no symbol. */
PetscErrorCode MpmSymbolCheck(const MpmScene *scene);

/*
   MpmSymbolCreate - the symbol of a scene; keep asks for the factors, not only the growth. tolerance is that on growth
   per step, which decides whether blur matters.

   Collective. Refuses layouts that are not uniform and drifts without a short period.
*/
PetscErrorCode MpmSymbolCreate(MPI_Comm comm, const MpmScene *scene, PetscInt phases, PetscReal tolerance,
                               PetscBool keep, MpmSymbol **symbol);
PetscErrorCode MpmSymbolDestroy(MpmSymbol **symbol);

/* Not collective. Phase m of n. */
static inline PetscReal MpmSymbolPhase(PetscInt m, PetscInt n)
{
  return 2 * PETSC_PI * m / n;
}

/*
   MpmSymbolTarget - the factor (times 2^exponent; im >= 0) to look for in an assembled operator: of those away from 1,
   where the null space sits, one of largest abs, and of several such the one farthest from 1.

   Collective. Needs the factors kept.
*/
PetscErrorCode MpmSymbolTarget(MPI_Comm comm, const MpmSymbol *symbol, PetscInt exponent, PetscReal target[2]);

/*
   Collective. MpmSymbolGather gives rank 0 a curve (per_phase or seen) at the phases 0..half; MpmSymbolGatherFactors
   gives every rank the factors of all phases 0..phases-1, divided by 2^exponent: 2 x size x phases numbers. Free with
   PetscFree.
*/
PetscErrorCode MpmSymbolGather(MPI_Comm comm, const MpmSymbol *symbol, const PetscReal curve[], PetscReal **all);
PetscErrorCode MpmSymbolGatherFactors(MPI_Comm comm, const MpmSymbol *symbol, PetscInt exponent, PetscReal **factors);
