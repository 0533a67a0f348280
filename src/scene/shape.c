/*
   Particles that fill a shape instead of a box. Those of a line along the first direction that follow one another are a
   span, so that number and site of a particle are found by bisection, and a layout of n particles needs room for the
   spans of its lines alone.

   discs: two, in three dimensions balls, of radius 1/5 of the domain's length, around the places at 1/5 and 4/5 of the
   domain in each direction. Sulsky, Chen and Schreyer 1994, section 5.2, let such discs collide.
   ring: between the radii 3/4 and 5/4 in units of length, around the middle.
*/
#include "scene/layout.h"
#include "scene/settings.h"
#include <math.h>

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
  if (shape == BOX) PetscFunctionReturn(PETSC_SUCCESS);
  if (!scene->scheme.space.finite || l->dim == 1) {
    PetscCall(
        MpmSettingsRefuseUnless(settings, "shape", "kinematics,dim", "allowed: with kinematics finite and dim 2 or 3"));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
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

PetscInt64 MpmLayoutBoxOf(const MpmLayout *layout, PetscInt64 id)
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
