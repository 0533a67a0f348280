/*
   The symbol of a table on a uniform layout: which layouts have one, and the table, applied to one Bloch mode, as a
   source of amplification matrices.
*/
#include "scene/layout.h"
#include "symbol/bloch_growth.h"
#include "symbol/blocks.h"
#include "symbol/source.h"
#include <mpmstab/errors.h>

#define MOST_SIZE 1536 /* the largest order of a matrix with all fields that a scheme may have */

/*
   The most particles in a cell: with fields for a vector, a stress and an affine part, its block is as large as
   allowed.
*/
static PetscInt MostPpc(PetscInt dim)
{
  return MOST_SIZE / (dim + dim * (dim + 1) / 2 + dim * dim);
}

const char *MpmSymbolWhyNot(const MpmLayout *layout)
{
  if (!MpmLayoutIsPeriodic(layout)) return "at walls Fourier modes mix";
  if (layout->colliders) return "at colliders Fourier modes mix";
  if (!MpmLayoutIsUniform(layout)) return "cells differ, so Fourier modes mix";
  if (MpmLayoutPpc(layout) > MostPpc(layout->dim)) return "with so many particles per cell its blocks are too large";
  return NULL;
}

/* The first end that is not periodic, for a message. */
static const MpmEnd *WallsOf(const MpmLayout *layout)
{
  PetscInt a = 0;

  while (a < layout->dim - 1 && layout->grid[a].ends[0] == MPM_PERIODIC) a++;
  return layout->grid[a].ends;
}

PetscErrorCode MpmSymbolCheck(const MpmLayout *layout)
{
  char ppc[MPM_MAX_DIM * 16];

  PetscFunctionBegin;
  MpmCheckInput(MpmLayoutIsPeriodic(layout),
                "boundary %s,%s: the symbol needs a domain without ends; allowed: periodic ('mpmstab spectrum' takes "
                "any)",
                MpmEndNames[WallsOf(layout)[0]], MpmEndNames[WallsOf(layout)[1]]);
  MpmCheckInput(layout->counts.n == 1 && layout->material.kind == MPM_MATERIAL_UNIFORM,
                "%s: the symbol needs the same particles in every cell; allowed: without it ('mpmstab spectrum' takes "
                "any layout)",
                layout->counts.n > 1 ? "counts" : "material");
  MpmCheckInput(
      !layout->given,
      "layout %s: the symbol needs the same particles in every cell; allowed: layout uniform ('mpmstab spectrum' "
      "and 'mpmstab critical' take any layout)",
      layout->given->path);
  MpmCheckInput(
      !layout->colliders,
      "colliders: at colliders Fourier modes mix; allowed: without ('mpmstab spectrum' and 'mpmstab critical' "
      "take them)");
  MpmCheckInput(MpmLayoutIsFull(layout),
                "fill: the symbol needs the same particles in every cell; allowed: without fill ('mpmstab spectrum' "
                "takes any layout)");
  MpmCheckInput(MpmLayoutIsUniform(layout),
                "jitter %g: the symbol needs the same particles in every cell; allowed: jitter 0 ('mpmstab spectrum' "
                "takes any layout)",
                layout->jitter);
  PetscCall(MpmPhasesText(layout->dim, layout->ppc, sizeof ppc, ppc));
  MpmCheckInput(!MpmSymbolWhyNot(layout),
                "ppc %s: the symbol's blocks would be too large; allowed: at most %" PetscInt_FMT "%s", ppc,
                MostPpc(layout->dim), layout->dim > 1 ? " in a cell, over all directions" : "");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A case for each of n Courant numbers. */
typedef struct {
  MpmBloch         bloch;
  MpmSmallEigen    eigen;
  PetscInt         n;
  const PetscReal *courant;
} TableMatrix;

static PetscErrorCode Matrices(void *context, PetscInt n, const PetscInt which[], const PetscReal beta[],
                               PetscBool noisy, double complex G[], PetscInt exponent[])
{
  TableMatrix *t = context;
  PetscReal    courant[MPM_BLOCH_LANES];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) courant[i] = t->courant[which[i]];
  PetscCall(MpmBlochMatrices(&t->bloch, n, courant, beta, noisy, G, exponent));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Growths(void *context, const PetscReal beta[], PetscReal growth[], PetscReal without_null[])
{
  TableMatrix *t = context;

  PetscFunctionBegin;
  PetscCall(MpmBlochGrowths(&t->bloch, &t->eigen, t->n, t->courant, beta, growth, without_null));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Over a period of several steps modes may grow by many digits on the way, so that rounding has to be followed. */
static PetscErrorCode Describe(TableMatrix *t, const MpmStep *step, MpmSource *source)
{
  const MpmBloch  *b      = &t->bloch;
  const MpmLayout *layout = b->layout;

  PetscFunctionBegin;
  *source = (MpmSource){.dim       = layout->dim,
                        .size      = b->size,
                        .period    = b->period,
                        .cases     = t->n,
                        .together  = PetscMin(b->most, t->n),
                        .matrices  = Matrices,
                        .growths   = b->turn < b->period || b->nodal || b->taken ? Growths : NULL,
                        .context   = t,
                        .has_noise = b->period > 1 ? PETSC_TRUE : PETSC_FALSE,
                        .null_all  = MPM_NONE};
  MpmPhasesSymmetries(layout, &b->scheme->space, step->drift, source->reflects, source->alike);
  if (layout->dim == 1) source->reflects[0] = PETSC_FALSE; /* that is beta and -beta, known besides */
  MpmBlochCountNull(b, &source->null_rest, &source->null_all, &source->null_factor);
  MpmLayoutSizeText(layout, sizeof source->name, source->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolsCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                PetscInt n, const PetscReal courant[], const MpmSymbolWish *wish, MpmSymbol *symbols[])
{
  TableMatrix table = {.n = n, .courant = courant};
  MpmSource   source;

  PetscFunctionBegin;
  PetscCall(MpmSymbolCheck(layout));
  PetscCall(MpmBlochCreate(layout, scheme, step->drift, &table.bloch));
  PetscCall(MpmSmallEigenCreate(table.bloch.turn_size, &table.eigen));
  PetscCall(Describe(&table, step, &source));
  PetscCall(MpmSymbolFromSource(comm, &source, wish, symbols));
  for (PetscInt i = 0; i < n; i++) {
    symbols[i]->layout       = layout;
    symbols[i]->scheme       = scheme;
    symbols[i]->step         = *step;
    symbols[i]->step.courant = courant[i];
  }
  PetscCall(MpmSmallEigenDestroy(&table.eigen));
  PetscCall(MpmBlochDestroy(&table.bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                               const MpmSymbolWish *wish, MpmSymbol **symbol)
{
  PetscFunctionBegin;
  PetscCall(MpmSymbolsCreate(comm, layout, scheme, step, 1, &step->courant, wish, symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableBlocks(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                              const char option[], MpmBlocks *blocks)
{
  TableMatrix table = {.n = 1, .courant = &step->courant};
  MpmSource   source;

  PetscFunctionBegin;
  PetscCall(MpmSymbolCheck(layout));
  PetscCall(MpmBlochCreate(layout, scheme, step->drift, &table.bloch));
  PetscCall(Describe(&table, step, &source));
  PetscCall(MpmBlocksFromSource(comm, &source, option, blocks));
  PetscCall(MpmBlochDestroy(&table.bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}
