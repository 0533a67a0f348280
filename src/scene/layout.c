/*
   Particles that fill a shape instead of a box. Those of a line along the first direction that follow one another are a
   span, so that number and site of a particle are found by bisection, and a layout of n particles needs room for the
   spans of its lines alone.

   discs: two, in three dimensions balls, of radius 1/5 of the domain's length, around the places at 1/5 and 4/5 of the
   domain in each direction. Sulsky, Chen and Schreyer 1994, section 5.2, let such discs collide.
   ring: between the radii 3/4 and 5/4 in units of length, around the middle.
*/
#include "base/memory.h"
#include "base/text.h"
#include "scene/layout.h"
#include "scene/settings.h"
#include "scheme/kernels.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>

const char *const MpmShapeNames[] = {"box", "discs", "ring", NULL};

typedef enum { BOX, DISCS, RING } Shape;

/* The distance of x from the place at a share of the domain. */
static PetscReal Distance(const MpmScene *scene, PetscReal share, const PetscReal x[])
{
  PetscReal squares = 0;

  for (PetscInt a = 0; a < scene->layout.dim; a++) squares += PetscSqr(x[a] - share * scene->length[a]);
  return sqrt(squares);
}

static PetscBool IsInside(const MpmScene *scene, Shape shape, const PetscReal x[])
{
  const PetscReal radius = scene->length[0] / 5, middle = Distance(scene, 0.5, x);

  if (shape == RING) return middle > 0.75 && middle < 1.25 ? PETSC_TRUE : PETSC_FALSE;
  return Distance(scene, 0.2, x) < radius || Distance(scene, 0.8, x) < radius ? PETSC_TRUE : PETSC_FALSE;
}

/* Finds the spans of all lines; without an array it only counts them and their particles. */
static PetscInt64 FindSpans(const MpmScene *scene, Shape shape, MpmSpan spans[], PetscInt64 *particles)
{
  const MpmLayout *l     = &scene->layout;
  const PetscInt64 lines = l->row[1] * (l->dim > 2 ? l->row[2] : 1);
  PetscInt64       n = 0, total = 0;

  for (PetscInt64 line = 0; line < lines; line++) {
    PetscBool before = PETSC_FALSE;

    for (PetscInt64 i = 0; i < l->row[0]; i++) {
      const PetscInt64 site[MPM_MAX_DIM] = {i, line % l->row[1], line / l->row[1]};
      PetscReal        x[MPM_MAX_DIM];
      PetscBool        inside;

      for (PetscInt a = 0; a < l->dim; a++) x[a] = (l->first[a] + site[a] + 0.5) / l->ppc[a] * scene->cell_width;
      inside = IsInside(scene, shape, x);
      if (inside && !before && spans) spans[n] = (MpmSpan){.box = line * l->row[0] + i, .id = total};
      n += inside && !before;
      total += inside;
      before = inside;
    }
  }
  *particles = total;
  return n;
}

PetscErrorCode MpmSettingsReadShape(const MpmSettings *settings, MpmScene *scene)
{
  MpmLayout *l = &scene->layout;
  PetscInt   shape;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "shape", &shape));
  if (shape == BOX || !scene->scheme.space.finite || l->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  l->nspans = FindSpans(scene, (Shape)shape, NULL, &l->particles);
  MpmSettingsRefuseIf(!l->particles, settings, "shape",
                      "no particle is inside; allowed: more cells, or a larger domain");
  PetscCall(PetscMalloc1(l->nspans, &l->spans));
  l->shape = MpmShapeNames[shape];
  (void)FindSpans(scene, (Shape)shape, l->spans, &l->particles);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The last span whose value at an offset of the struct is at most a number; -1: none. */
#define BISECT(member, number)                                                                                         \
  PetscInt64 lo = -1, hi = layout->nspans;                                                                             \
  while (hi - lo > 1) {                                                                                                \
    const PetscInt64 middle = (lo + hi) / 2;                                                                           \
    if (layout->spans[middle].member <= (number))                                                                      \
      lo = middle;                                                                                                     \
    else                                                                                                               \
      hi = middle;                                                                                                     \
  }

/* The number of particle id in the box of sites that particles take; the same where particles fill the box. */
static PetscInt64 BoxOf(const MpmLayout *layout, PetscInt64 id)
{
  if (!layout->spans) return id;
  BISECT(id, id)
  return layout->spans[lo].box + id - layout->spans[lo].id;
}

PetscInt64 MpmLayoutIdAt(const MpmLayout *layout, PetscInt64 box)
{
  PetscInt64 end;

  if (!layout->spans) return box;
  BISECT(box, box)
  if (lo < 0) return -1;
  end = lo + 1 < layout->nspans ? layout->spans[lo + 1].id : layout->particles;
  return box - layout->spans[lo].box < end - layout->spans[lo].id ? layout->spans[lo].id + box - layout->spans[lo].box
                                                                  : -1;
}

/*
   In each direction, particle j of the ppc particles in cell n starts at

     x = (n + (j + offset + jitter (r - 1/2)) / ppc) h

   where r is a hash of the number of the particle's site. With a cluster, its place in the cell is scaled into the
   cluster.
*/

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

const char *const MpmBalanceNames[] = {"auto", "cells", "particles", NULL};
const char *const MpmMarchNames[]   = {"fast", "plain", NULL};

PetscInt64 MpmLayoutSitesBefore(const MpmLayout *layout, PetscInt cell)
{
  const MpmCounts *c = &layout->counts;

  return cell / c->n * c->before[c->n] + c->before[cell % c->n];
}

PetscInt64 MpmLayoutParticlesBefore(const MpmLayout *layout, PetscInt a, PetscInt cell)
{
  const PetscInt64 sites = layout->dim == 1 ? MpmLayoutSitesBefore(layout, cell) : (PetscInt64)cell * layout->ppc[a];

  if (layout->given) return layout->given->before[a][cell];
  return PetscClipInterval(sites - layout->first[a], 0, layout->row[a]);
}

PetscInt MpmLayoutSitesIn(const MpmLayout *layout, PetscInt cell)
{
  return layout->counts.of[cell % layout->counts.n];
}

void MpmLayoutSites(const MpmLayout *layout, PetscInt64 id, PetscInt64 site[])
{
  id = BoxOf(layout, id);
  for (PetscInt a = 0; a < layout->dim - 1; a++) {
    site[a] = layout->first[a] + id % layout->row[a];
    id /= layout->row[a];
  }
  site[layout->dim - 1] = layout->first[layout->dim - 1] + id;
}

/*
   The number of a site. The random numbers of a particle are hashed from it, and do not depend on which sites are
   taken.
*/
static PetscInt64 Number(const MpmLayout *layout, const PetscInt64 site[])
{
  PetscInt64 number = 0;

  if (layout->dim == 1) return site[0];
  for (PetscInt a = layout->dim - 1; a >= 0; a--) number = number * layout->grid[a].cells * layout->ppc[a] + site[a];
  return number;
}

PetscInt64 MpmLayoutSeed(const MpmLayout *layout, PetscInt axis)
{
  return axis == 0 ? layout->seed : (PetscInt64)(0x1p52 * MpmHash(layout->seed + 1, -MPM_MAX_FIELDS - 2 - axis));
}

PetscBool MpmLayoutIsVoid(const MpmLayout *layout, PetscInt64 id, PetscReal share)
{
  PetscInt64 site[MPM_MAX_DIM];

  MpmLayoutSites(layout, id, site);
  return MpmHash(MpmLayoutSeed(layout, MPM_MAX_DIM), Number(layout, site)) < share ? PETSC_TRUE : PETSC_FALSE;
}

/* The resting place of particle j of the count in cell n of a direction. number: of the site. */
static void PlaceAlong(const MpmLayout *layout, PetscInt axis, PetscInt n, PetscInt j, PetscInt count,
                       PetscInt64 number, PetscInt *cell, PetscReal *xi)
{
  const MpmFraction *offset = &layout->offset[axis];
  const PetscReal   *part   = layout->cluster;
  PetscReal          place; /* in cells from the left end of cell n */
  PetscInt           shift;

  if (layout->jitter == 0 && offset->den && offset->den <= 1000000000)
    /* rounded once, so that a position that should meet a node meets it exactly */
    place = (PetscReal)(j * offset->den + offset->num) / (PetscReal)(count * offset->den);
  else {
    const PetscReal displacement = layout->jitter * (MpmHash(MpmLayoutSeed(layout, axis), number) - 0.5);
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
  if (*cell == layout->grid[axis].cells &&
      layout->grid[axis].ends[0] != MPM_PERIODIC) { /* the node at the right end belongs to the cell at its left */
    *cell = layout->grid[axis].cells - 1;
    *xi   = nextafter(1, 0);
  }
}

void MpmLayoutPlace(const MpmLayout *layout, PetscInt64 id, PetscInt cell[], PetscReal xi[])
{
  PetscInt64 site[MPM_MAX_DIM], number;
  PetscInt   n, j, count;

  if (layout->given) {
    MpmGivenPlace(layout, id, cell, xi);
    return;
  }
  MpmLayoutSites(layout, id, site);
  number = Number(layout, site);
  if (layout->dim == 1) { /* where cells may have different numbers of sites */
    MpmLayoutSite(layout, site[0], &n, &j, &count);
    PlaceAlong(layout, 0, n, j, count, number, cell, xi);
    return;
  }
  for (PetscInt a = 0; a < layout->dim; a++) {
    count = layout->ppc[a];
    PlaceAlong(layout, a, (PetscInt)(site[a] / count), (PetscInt)(site[a] % count), count, number, &cell[a], &xi[a]);
  }
}

/* Jitter may cross the end of a periodic domain. */
void MpmLayoutRest(const MpmLayout *layout, PetscInt64 id, PetscReal x[])
{
  PetscInt cell[MPM_MAX_DIM];

  MpmLayoutPlace(layout, id, cell, x);
  for (PetscInt a = 0; a < layout->dim; a++) x[a] += (cell[a] + layout->grid[a].cells) % layout->grid[a].cells;
}

void MpmLayoutPlaceAt(const MpmLayout *layout, const MpmFraction drift[], PetscInt64 id, PetscInt64 step,
                      PetscInt cell[], PetscReal xi[])
{
  PetscInt  home[MPM_MAX_DIM];
  PetscReal rest[MPM_MAX_DIM];

  MpmLayoutPlace(layout, id, home, rest);
  for (PetscInt a = 0; a < layout->dim; a++) {
    PetscInt64 whole;
    PetscReal  part;

    MpmFractionMultiple(&drift[a], step, &whole, &part);
    MpmPlaceBlock(1, &home[a], &rest[a], 0, part, &cell[a], &xi[a]);
  }
}

PetscErrorCode MpmStepPeriod(const MpmStep *step, PetscInt *period)
{
  PetscInt64 common = 1;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) {
    const MpmFraction *drift = &step->drift[a];
    PetscInt64         least = common; /* common multiple */

    if (drift->value == 0) continue;
    MpmCheckInput(drift->den > 0 && drift->den <= MPM_LONGEST_PERIOD,
                  "drift %.17g: particles are not back in their places within %d steps; allowed: -drift as a fraction "
                  "such as 1/8 with a denominator of at most %d ('mpmstab run' takes any drift)",
                  drift->value, MPM_LONGEST_PERIOD, MPM_LONGEST_PERIOD);
    while (least % drift->den) least += common;
    common = least;
    MpmCheckInput(common <= MPM_LONGEST_PERIOD,
                  "drift: particles are back in their places after %" PetscInt64_FMT
                  " steps, the least common multiple of the denominators; allowed: at most %d",
                  common, MPM_LONGEST_PERIOD);
  }
  *period = (PetscInt)common;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool MpmLayoutIsUniform(const MpmLayout *layout)
{
  for (PetscInt property = 0; property < MPM_PROPERTIES; property++)
    if (layout->varies[property]) return PETSC_FALSE;
  if (layout->colliders) return PETSC_FALSE;
  return layout->jitter == 0 && MpmLayoutIsPeriodic(layout) && MpmLayoutIsFull(layout) ? PETSC_TRUE : PETSC_FALSE;
}

void MpmLayoutSetPpc(MpmLayout *layout, PetscInt ppc)
{
  layout->counts.of[0]     = ppc;
  layout->counts.before[1] = ppc;
  layout->sites            = 1;
  for (PetscInt a = 0; a < layout->dim; a++) {
    layout->ppc[a]        = ppc;
    layout->half_width[a] = 0.5 / ppc;
    layout->first[a]      = 0;
    layout->row[a]        = (PetscInt64)layout->grid[a].cells * ppc;
    layout->sites *= layout->row[a];
  }
  layout->particles = layout->sites;
}

MpmProperty MpmLayoutWeight(const MpmLayout *layout, MpmOpKind kind, PetscInt side)
{
  const MpmProperty of_kind = MpmOpTraitsOf(kind).weight;
  const MpmProperty weight  = of_kind == MPM_STIFFNESS ? (MpmProperty)(of_kind + side) : of_kind;

  return layout->varies[weight] ? weight : MPM_NO_PROPERTY;
}

void MpmLayoutSizeText(const MpmLayout *layout, size_t room, char text[])
{
  size_t n = 0;

  for (PetscInt a = 0; a < layout->dim && n < room; a++)
    n += (size_t)snprintf(text + n, room - n, "%s%" PetscInt_FMT, a ? "," : "cells ", layout->grid[a].cells);
  for (PetscInt a = 0; a < layout->dim && !layout->given && n < room; a++)
    n += (size_t)snprintf(text + n, room - n, "%s%" PetscInt_FMT, a ? "," : " with ppc ", layout->ppc[a]);
  if (layout->given && n < room) (void)snprintf(text + n, room - n, " with layout %s", layout->given->path);
}

PetscErrorCode MpmLayoutCheckMemory(MPI_Comm comm, const MpmLayout *layout, PetscReal bytes, const char what[])
{
  char size[MPM_SIZE_TEXT];

  PetscFunctionBegin;
  MpmLayoutSizeText(layout, sizeof size, size);
  PetscCall(MpmMemoryCheck(comm, size, bytes, what));
  PetscFunctionReturn(PETSC_SUCCESS);
}
