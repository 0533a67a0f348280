/*
   Particle j of the ppc particles in cell n starts at

     x = (n + (j + offset + jitter (r - 1/2)) / ppc) h

   where r is a hash of the particle's number g. With a cluster, its place in the cell is scaled into the cluster.
*/
#include "base/memory.h"
#include "scheme/kernels.h"
#include "scene/layout.h"
#include <mpmstab/errors.h>
#include <math.h>

void MpmLayoutSite(const MpmLayout *layout, PetscInt64 g, PetscInt *cell, PetscInt *j, PetscInt *count)
{
  const MpmCounts *c    = &layout->counts;
  const PetscInt64 turn = g / c->before[c->n], rest = g % c->before[c->n];
  PetscInt         r = 0;

  while (rest >= c->before[r + 1]) r++;
  *cell  = (PetscInt)(turn * c->n + r);
  *j     = (PetscInt)(rest - c->before[r]);
  *count = c->of[r];
}

PetscInt64 MpmLayoutSitesBefore(const MpmLayout *layout, PetscInt cell)
{
  const MpmCounts *c = &layout->counts;

  return cell / c->n * c->before[c->n] + c->before[cell % c->n];
}

PetscInt MpmLayoutSitesIn(const MpmLayout *layout, PetscInt cell)
{
  return layout->counts.of[cell % layout->counts.n];
}

void MpmLayoutPlace(const MpmLayout *layout, PetscInt64 id, PetscInt *cell, PetscReal *xi)
{
  const MpmFraction *offset = &layout->offset;
  const PetscReal   *part   = layout->cluster;
  PetscReal          place; /* in cells from the left end of cell n */
  PetscInt           n, j, count, shift;

  MpmLayoutSite(layout, layout->first + id, &n, &j, &count);
  if (layout->jitter == 0 && offset->den && offset->den <= 1000000000)
    /* rounded once, so that a position that should meet a node meets it exactly */
    place = (PetscReal)(j * offset->den + offset->num) / (PetscReal)(count * offset->den);
  else {
    const PetscReal displacement = layout->jitter * (MpmHash(layout->seed, layout->first + id) - 0.5);
    place                        = (j + offset->value + displacement) / count;
  }
  if (part[1] - part[0] < 1) place = part[0] + (part[1] - part[0]) * place;
  shift = (PetscInt)floor(place);
  *xi   = place - shift;
  if (*xi >= 1) { /* just left of a node, and rounded onto it */
    *xi = 0;
    shift++;
  }
  *cell = n + shift;
  if (*cell == layout->grid.cells &&
      !MpmLayoutIsPeriodic(layout)) { /* the node at the right end belongs to the cell at its left */
    *cell = layout->grid.cells - 1;
    *xi   = nextafter(1, 0);
  }
}

void MpmLayoutPlaceAt(const MpmLayout *layout, const MpmFraction *drift, PetscInt64 id, PetscInt64 step, PetscInt *cell,
                      PetscReal *xi)
{
  PetscInt   home;
  PetscInt64 whole;
  PetscReal  rest, part;

  MpmLayoutPlace(layout, id, &home, &rest);
  MpmFractionMultiple(drift, step, &whole, &part);
  MpmPlaceBlock(1, &home, &rest, 0, part, cell, xi);
}

PetscErrorCode MpmStepPeriod(const MpmStep *step, PetscInt *period)
{
  PetscFunctionBegin;
  MpmCheckInput(step->drift.den > 0 && step->drift.den <= MPM_LONGEST_PERIOD,
                "drift %.17g: particles are not back in their places within %d steps; allowed: -drift as a fraction "
                "such as 1/8 with a denominator of at most %d ('mpmstab run' takes any drift)",
                step->drift.value, MPM_LONGEST_PERIOD, MPM_LONGEST_PERIOD);
  *period = (PetscInt)step->drift.den;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool MpmLayoutIsUniform(const MpmLayout *layout)
{
  for (PetscInt property = 0; property < MPM_PROPERTIES; property++)
    if (layout->varies[property]) return PETSC_FALSE;
  return layout->jitter == 0 && MpmLayoutIsPeriodic(layout) && MpmLayoutIsFull(layout) ? PETSC_TRUE : PETSC_FALSE;
}

void MpmLayoutSetPpc(MpmLayout *layout, PetscInt ppc)
{
  layout->ppc              = ppc;
  layout->half_width       = 0.5 / ppc;
  layout->counts.of[0]     = ppc;
  layout->counts.before[1] = ppc;
  layout->sites = layout->particles = (PetscInt64)layout->grid.cells * ppc;
}

MpmProperty MpmLayoutWeight(const MpmLayout *layout, MpmOpKind kind)
{
  const MpmProperty weight = MpmOpTraitsOf(kind).weight;

  return layout->varies[weight] ? weight : MPM_NO_PROPERTY;
}

PetscErrorCode MpmLayoutCheckMemory(MPI_Comm comm, const MpmLayout *layout, PetscReal bytes, const char what[])
{
  char size[64];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(size, sizeof size, "cells %" PetscInt_FMT " with ppc %" PetscInt_FMT, layout->grid.cells,
                          layout->ppc));
  PetscCall(MpmMemoryCheck(comm, size, bytes, what));
  PetscFunctionReturn(PETSC_SUCCESS);
}
