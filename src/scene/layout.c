/*
   Particle j of the ppc in cell n starts at x = (n + (j + offset + jitter (r - 1/2)) / ppc) h, r hashed from its number
   g, and its part of a cell squeezed into the cluster.
*/
#include "scheme/kernels.h"
#include "scene/layout.h"
#include <math.h>

void MpmLayoutSite(const MpmScene *scene, PetscInt64 g, PetscInt *cell, PetscInt *j, PetscInt *count)
{
  const MpmCounts *c    = &scene->counts;
  const PetscInt64 turn = g / c->before[c->n], rest = g % c->before[c->n];
  PetscInt         r = 0;

  while (rest >= c->before[r + 1]) r++;
  *cell  = (PetscInt)(turn * c->n + r);
  *j     = (PetscInt)(rest - c->before[r]);
  *count = c->of[r];
}

PetscInt64 MpmLayoutSitesBefore(const MpmScene *scene, PetscInt cell)
{
  const MpmCounts *c = &scene->counts;

  return cell / c->n * c->before[c->n] + c->before[cell % c->n];
}

PetscInt MpmLayoutSitesIn(const MpmScene *scene, PetscInt cell)
{
  return scene->counts.of[cell % scene->counts.n];
}

void MpmLayoutPlace(const MpmScene *scene, PetscInt64 id, PetscInt *cell, PetscReal *xi)
{
  const MpmFraction *offset = &scene->offset;
  const PetscReal   *part   = scene->cluster;
  PetscReal          place; /* in cells from the left end of cell n */
  PetscInt           n, j, count, shift;

  MpmLayoutSite(scene, scene->first + id, &n, &j, &count);
  if (scene->jitter == 0 && offset->den && offset->den <= 1000000000)
    /* rounded once, so that positions that meet a node meet it exactly */
    place = (PetscReal)(j * offset->den + offset->num) / (PetscReal)(count * offset->den);
  else {
    const PetscReal displacement = scene->jitter * (MpmHash(scene->seed, scene->first + id) - 0.5);
    place                        = (j + offset->value + displacement) / count;
  }
  if (part[1] - part[0] < 1) place = part[0] + (part[1] - part[0]) * place;
  shift = (PetscInt)floor(place);
  *xi   = place - shift;
  if (*xi >= 1) { /* a place just left of a node, rounded onto it */
    *xi = 0;
    shift++;
  }
  *cell = n + shift;
  if (*cell == scene->cells && !MpmSceneIsPeriodic(scene)) { /* on the right end's node, whose cell is at its left */
    *cell = scene->cells - 1;
    *xi   = nextafter(1, 0);
  }
}

void MpmLayoutPlaceAt(const MpmScene *scene, PetscInt64 id, PetscInt64 step, PetscInt *cell, PetscReal *xi)
{
  PetscInt   home;
  PetscInt64 whole;
  PetscReal  rest, part;

  MpmLayoutPlace(scene, id, &home, &rest);
  MpmFractionMultiple(&scene->drift, step, &whole, &part);
  MpmPlaceBlock(1, &home, &rest, 0, part, cell, xi);
}

PetscErrorCode MpmLayoutPeriod(const MpmScene *scene, PetscInt *period)
{
  PetscFunctionBegin;
  MpmCheckInput(scene->drift.den > 0 && scene->drift.den <= MPM_LONGEST_PERIOD,
                "drift %.17g: particles are not back in their places within %d steps; allowed: -drift as a fraction "
                "such as 1/8 with a denominator of at most %d ('mpmstab run' takes any drift)",
                scene->drift.value, MPM_LONGEST_PERIOD, MPM_LONGEST_PERIOD);
  *period = (PetscInt)scene->drift.den;
  PetscFunctionReturn(PETSC_SUCCESS);
}
