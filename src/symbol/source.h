/*
   Source of a symbol: whatever has an amplification matrix G(beta) for each phase. A table applied to one Bloch mode is
   a source; so are the blocks A_d of a lattice, G(beta) = sum over d of A_d e^(-i beta.d).
*/
#pragma once
#include <mpmstab/symbol.h>
#include <complex.h>

/*
   Computes the amplification matrices of a phase in n cases of a source, in the order of which, one after another, each
   size x size by columns and divided by 2^exponent. With noisy, which only a source with has_noise is asked for, every
   number is moved by about its rounding after each step of the period.

   Not collective.
*/
typedef PetscErrorCode (*MpmSourceMatrices)(void *context, PetscInt n, const PetscInt which[], const PetscReal beta[],
                                            PetscBool noisy, double complex G[], PetscInt exponent[]);

/*
   Computes the growth per step of a phase in all cases, and that without the null space of P2G where the source knows
   of it, by a shorter way than the eigenvalues of its matrix. The two have the same growth.

   Not collective.
*/
typedef PetscErrorCode (*MpmSourceGrowths)(void *context, const PetscReal beta[], PetscReal growth[],
                                           PetscReal without_null[]);

/*S
   MpmSource - where the matrices of a symbol come from, or those of several symbols, one for each *case* of the source:
   a table has a case for each Courant number.

   dim, size    - the number of directions, and the order of a matrix
   period       - the number of steps that a matrix covers
   cases, together - the number of cases, and how many of them matrices takes at a time
   matrices, context - gives the matrices of a phase; those of beta and -beta are conjugates of each other
   growths      - NULL where there is no shorter way
   has_noise    - whether matrices knows how rounding goes through the steps of a period
   reflects, alike - the symmetries, as MpmSymbol has them; alike[a] is at most a
   null_rest, null_all, null_factor - the amplification factors of the null space of P2G, which is particle data that no
                  node feels: null_rest of them are 1, the others of null_all are null_factor. null_all is MPM_NONE
                  where this is not known.
   name         - of what determines the size, for messages
S*/
typedef struct {
  PetscInt          dim, size, period, cases, together;
  MpmSourceMatrices matrices;
  MpmSourceGrowths  growths;
  void             *context;
  PetscBool         has_noise, reflects[MPM_MAX_DIM];
  PetscInt          alike[MPM_MAX_DIM], null_rest, null_all;
  PetscReal         null_factor;
  char              name[1100];
} MpmSource;

/*
   MpmSymbolFromSource - computes the symbol of each case of a source. Their layout and scheme are NULL.

   Collective. The source is not needed after the call. Errors: refuses (PETSC_ERR_USER_INPUT) so many phases that their
   output does not fit.
*/
PetscErrorCode MpmSymbolFromSource(MPI_Comm comm, const MpmSource *source, const MpmSymbolWish *wish,
                                   MpmSymbol *symbols[]);

/*S
   MpmSourceGrowth - the growth of one phase per step, with the condition number of its amplification factor and an
   estimate of that factor's relative error by rounding.
S*/
typedef struct {
  PetscReal growth, condition, relative;
} MpmSourceGrowth;

/* Not collective. MpmSourceMatrix: the matrix of a phase in the first case. */
PetscErrorCode MpmSourceMatrix(const MpmSource *source, const PetscReal beta[], double complex G[], PetscInt *exponent);
PetscErrorCode MpmSourceGrowthAt(const MpmSource *source, const PetscReal beta[], MpmSourceGrowth *at);

/*S
   MpmSymbolFactor - an amplification factor and the number of its phase; size is its abs, -1 where there is none, and
   distance that from 1.
S*/
typedef struct {
  PetscReal re, im, size, distance, phase;
} MpmSymbolFactor;

/*
   MpmSymbolLeading - the n best factors of different classes in the order of MpmSymbolTarget, divided by 2^exponent.

   Collective. The symbol must have kept its amplification factors.
*/
PetscErrorCode MpmSymbolLeading(MPI_Comm comm, const MpmSymbol *symbol, PetscInt exponent, PetscInt n,
                                MpmSymbolFactor best[]);

/*
   ---- the phases of a symbol that have to be computed: one of each class that the symmetries of the layout make
   (phases.c) ----
*/

/*
   MpmPhasesFind - sets alike and reflects: the symmetries of the source that hold at these numbers of phases.
   MpmPhasesList - sets the classes and their phases. all must be set.

   Not collective.
*/
void           MpmPhasesFind(const MpmSource *source, MpmSymbol *symbol);
PetscErrorCode MpmPhasesList(MpmSymbol *symbol);

/*
   Not collective. The symmetries of a uniform layout: mirror[a] is true where it is its own mirror image in direction
   a, about the middle of a cell, and alike[a] is the first direction that may be exchanged with a.
*/
void MpmPhasesSymmetries(const MpmLayout *layout, const MpmSpace *space, const MpmFraction drift[], PetscBool mirror[],
                         PetscInt alike[]);

/* Not collective. The numbers of an option with one for each direction, for a message. */
PetscErrorCode MpmPhasesText(PetscInt dim, const PetscInt each[], size_t room, char text[]);
