/*
   Where the layout is uniform, eigenvectors of the operator are Bloch modes. They need no factorisation: the symbol
   says which are leading, and a product with the operator says whether they are eigenvectors of it.
*/
#include "analysis/bloch_modes.h"
#include "linalg/small_eigen.h"
#include "scene/layout.h"
#include "symbol/bloch.h"
#include "symbol/source.h"
#include <mpmstab/errors.h>
#include <math.h>

#define MODES (MPM_BLOCH_VECTORS / 2)

/* The cell of a particle of a scene, and its site in it. */
static void AtOfLayout(const void *of, PetscInt64 id, PetscInt64 cell[], PetscInt *site)
{
  const MpmLayout *layout = of;

  MpmLayoutSites(layout, id, cell);
  *site = 0;
  for (PetscInt a = layout->dim - 1; a >= 0; a--) {
    *site = *site * layout->ppc[a] + (PetscInt)(cell[a] % layout->ppc[a]);
    cell[a] /= layout->ppc[a];
  }
}

/* Fills a state, real and imaginary part, with a Bloch mode. q: the numbers of the cell at the origin. */
static PetscErrorCode Fill(const MpmBlochCells *c, PetscInt dim, const PetscReal beta[], const double complex q[],
                           Vec mode[2])
{
  PetscInt   begin, end;
  PetscReal *x[2];

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(mode[0], &begin, &end));
  for (int part = 0; part < 2; part++) PetscCall(VecGetArrayWrite(mode[part], &x[part]));
  for (PetscInt64 id = begin / c->fields; id < end / c->fields; id++) {
    PetscInt64 cell[MPM_MAX_DIM];
    PetscInt   j;
    PetscReal  angle = 0;

    c->at(c->of, id, cell, &j);
    for (PetscInt a = 0; a < dim; a++) angle += beta[a] * (PetscReal)cell[a];
    for (PetscInt f = 0; f < c->fields; f++) {
      const double complex value = cexp(I * angle) * q[c->fields * j + f];

      x[0][c->fields * id + f - begin] = creal(value);
      x[1][c->fields * id + f - begin] = cimag(value);
    }
  }
  for (int part = 0; part < 2; part++) PetscCall(VecRestoreArrayWrite(mode[part], &x[part]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The eigenvector of a phase's matrix for a factor; the same on every rank. bloch: NULL where the cells have a source. */
static PetscErrorCode Vector(MPI_Comm comm, MpmBloch *bloch, const MpmBlochCells *cells, const MpmSymbol *s,
                             const MpmSymbolFactor *c, const PetscReal beta[], MpmSmallEigen *small, PetscInt *nearest)
{
  PetscMPIInt count;
  PetscInt    exponent;

  PetscFunctionBegin;
  if (bloch)
    PetscCall(MpmBlochMatrices(bloch, 1, &s->step.courant, beta, PETSC_FALSE, small->matrix, &exponent));
  else
    PetscCall(MpmSourceMatrix(&cells->source, beta, small->matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(small, PETSC_TRUE));
  PetscCall(PetscMPIIntCast(2 * (PetscInt64)s->size * s->size, &count));
  PetscCallMPI(MPI_Bcast(small->right, count, MPI_DOUBLE, 0, comm));
  PetscCallMPI(MPI_Bcast(small->value, (PetscMPIInt)(2 * s->size), MPI_DOUBLE, 0, comm));
  *nearest = 0;
  for (PetscInt j = 1; j < s->size; j++) {
    const double complex sought = (c->re + I * c->im) * scalbn(1, -(int)exponent);

    if (cabs(small->value[j] - sought) < cabs(small->value[*nearest] - sought)) *nearest = j;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochModesCreate(const MpmOperator *op, const MpmSymbol *s, const MpmBlochCells *cells, PetscInt *n,
                                   Vec **vectors)
{
  const MPI_Comm  comm   = PetscObjectComm((PetscObject)op->A);
  MpmBlochCells   layout = {.fields = op->fields, .of = op->layout, .at = AtOfLayout};
  MpmSymbolFactor best[MODES];
  MpmBloch        bloch;
  MpmSmallEigen   small;
  Vec             x;

  PetscFunctionBegin;
  PetscCall(MpmSymbolLeading(comm, s, 0, MODES, best));
  *n = 0;
  while (*n < 2 * MODES && best[*n / 2].size >= 0) *n += 2;
  PetscCall(MatCreateVecs(op->A, &x, NULL));
  PetscCall(VecDuplicateVecs(x, MPM_BLOCH_VECTORS, vectors));
  PetscCall(VecDestroy(&x));
  if (!cells) PetscCall(MpmBlochCreate(op->layout, op->scheme, s->step.drift, &bloch));
  PetscCall(MpmSmallEigenCreate(s->size, &small));
  for (PetscInt m = 0; m < *n / 2; m++) {
    PetscReal beta[MPM_MAX_DIM];
    PetscInt  j = 0;

    MpmSymbolBeta(s, (PetscInt)best[m].phase, beta);
    PetscCall(Vector(comm, cells ? NULL : &bloch, cells, s, &best[m], beta, &small, &j));
    PetscCall(Fill(cells ? cells : &layout, s->dim, beta, small.right + j * s->size, *vectors + 2 * m));
    for (int part = 0; part < 2 && cells && op->unit; part++)
      PetscCall(VecPointwiseMult((*vectors)[2 * m + part], (*vectors)[2 * m + part], op->unit));
  }
  PetscCall(MpmSmallEigenDestroy(&small));
  if (!cells) PetscCall(MpmBlochDestroy(&bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}
