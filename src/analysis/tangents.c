/*
   The tangent of step n is made of the state before it, J(n). Perturbations go as

     d(n + 1) = J(n) d(n)

   and several of them are made orthogonal after each step (Benettin et al. 1980). The product of a window's tangents is
   never formed; Lanczos steps apply it and its transpose.
*/
#include "analysis/pace.h"
#include "analysis/tangents.h"
#include "linalg/singular.h"
#include "scene/layout.h"
#include <math.h>

#define BASIS 12       /* vectors of the Krylov space: the largest alone is sought, and roughly */
#define FIRST 5        /* steps of the shortest part of a window; the others are twice as long as those before them */
#define TOLERANCE 1e-3 /* relative residual of a norm; its error is about the square of this */

/* A velocity along x, as a wave with the numbers of waves of the scene's mode. */
static PetscErrorCode FillMode(const MpmMarch *march, const MpmTangentSpace *space, Vec d)
{
  const MpmScene *scene = march->scene;
  const MpmTable *table = scene->scheme.table;
  const PetscInt  dim   = scene->layout.dim;
  PetscInt        along = 0; /* the register of the velocity along x: written schemes may have F before it */
  PetscReal      *x;

  PetscFunctionBegin;
  while (table->field[along] == MPM_STRETCHED) along++;
  PetscCall(VecSet(d, 0));
  PetscCall(VecGetArray(d, &x));
  for (PetscInt p = 0; p < space->sizes.particles; p++) {
    PetscReal rest[MPM_MAX_DIM], phase = 0;

    MpmLayoutRest(&scene->layout, space->sizes.begin + p, rest);
    for (PetscInt a = 0; a < dim; a++) phase += scene->mode[a] * rest[a] / scene->layout.grid[a].cells;
    x[space->nstate * p + dim + along] = sin(2 * M_PI * phase);
  }
  PetscCall(VecRestoreArray(d, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The perturbations at the start: a wave where it is asked for, and random numbers. */
static PetscErrorCode Fill(const MpmMarch *march, const MpmRequest *request, MpmTangents *t)
{
  PetscFunctionBegin;
  PetscCall(BVCreate(PETSC_COMM_WORLD, &t->perturbation));
  PetscCall(BVSetSizesFromVec(t->perturbation, t->scale, t->exponents));
  PetscCall(BVSetType(t->perturbation, BVVECS));
  for (PetscInt i = 0; i < t->exponents; i++) {
    Vec       d;
    PetscReal norm;

    PetscCall(BVGetColumn(t->perturbation, i, &d));
    if (i == 0 && request->tangent == MPM_TANGENT_MODE)
      PetscCall(FillMode(march, &t->space, d));
    else
      PetscCall(MpmSingularStart(march->layout->seed + i, d));
    PetscCall(BVRestoreColumn(t->perturbation, i, &d));
    PetscCall(BVOrthogonalizeColumn(t->perturbation, i, NULL, &norm, NULL));
    MpmCheckInput(norm > 0, "-tangent mode: the wave is 0 at all particles; allowed: another mode, or tangent random");
    PetscCall(BVScaleColumn(t->perturbation, i, 1 / norm));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The numbers that make x / h, v / c and F / F0 of a state, and those that undo it. */
static PetscErrorCode Scale(const MpmScene *scene, MpmTangents *t)
{
  const MpmTable *table = scene->scheme.table;
  PetscReal      *x;

  PetscFunctionBegin;
  PetscCall(VecCreateMPI(PETSC_COMM_WORLD, t->space.nstate * t->space.sizes.particles, PETSC_DETERMINE, &t->scale));
  PetscCall(VecSet(t->scale, 1));
  PetscCall(VecGetArray(t->scale, &x));
  for (PetscInt p = 0; p < t->space.sizes.particles; p++)
    for (PetscInt c = 0; c < table->dim * table->dim; c++)
      x[t->space.nstate * p + table->dim + table->stretch + c] = 1 / scene->stretch[c % table->dim];
  PetscCall(VecRestoreArray(t->scale, &x));
  PetscCall(VecDuplicate(t->scale, &t->unscale));
  PetscCall(VecCopy(t->scale, t->unscale));
  PetscCall(VecReciprocal(t->unscale));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentsCreate(const MpmMarch *march, const MpmRequest *request, MpmTangents **tangents)
{
  MpmTangents *t;

  PetscFunctionBegin;
  PetscCall(PetscNew(tangents));
  t             = *tangents;
  t->window     = request->window;
  t->next       = FIRST;
  t->room       = INFINITY;
  t->exponents  = request->exponents;
  t->warn_above = request->warn_above;
  PetscCall(MpmTangentSpaceCreate(PETSC_COMM_WORLD, march->layout, march->scheme, &t->space));
  PetscCall(MpmTangentStateCreate(&t->space, &t->state));
  PetscCall(Scale(march->scene, t));
  PetscCall(PetscCalloc2(t->window, &t->held, t->exponents, &t->log_growth));
  PetscCall(Fill(march, request, t));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the perturbations through a step, and makes them orthogonal again. */
static PetscErrorCode Follow(MpmTangents *t, Mat tangent)
{
  Vec image;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(t->scale, &image));
  for (PetscInt i = 0; i < t->exponents; i++) {
    Vec       d;
    PetscReal norm;

    PetscCall(BVGetColumn(t->perturbation, i, &d));
    PetscCall(MatMult(tangent, d, image));
    PetscCall(VecCopy(image, d));
    PetscCall(BVRestoreColumn(t->perturbation, i, &d));
    PetscCall(BVOrthogonalizeColumn(t->perturbation, i, NULL, &norm, NULL));
    if (norm > 0) PetscCall(BVScaleColumn(t->perturbation, i, 1 / norm));
    t->log_growth[i] += log(norm);
  }
  PetscCall(VecDestroy(&image));
  t->steps++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Record(MpmTangents *t, const MpmTangentWindow *window)
{
  const PetscReal excess = window->norm / (1 + window->waves);

  PetscFunctionBegin;
  if (t->nwindows == t->most) {
    t->most = PetscMax(64, 2 * t->most);
    PetscCall(PetscRealloc(sizeof(*t->at) * (size_t)t->most, &t->at));
  }
  t->at[t->nwindows++] = *window;
  if (excess > t->excess) {
    t->excess  = excess;
    t->largest = *window;
  }
  if (!(excess > t->warn_above)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!t->warned++) t->first = window->step;
  t->last = window->step;
  MpmPrint("warning at step %" PetscInt64_FMT ": in the last %" PetscInt_FMT
           " steps a small perturbation can grow %.3g times, which is %.3g times 1 + c t / h\n",
           window->step, window->steps, window->norm, excess);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest growth over the tangents that are held. */
static PetscErrorCode Check(MpmTangents *t, PetscInt64 step)
{
  MpmTangentWindow window = {.step = step, .steps = t->nheld, .waves = t->waves};
  Mat              product;
  Vec              start;

  PetscFunctionBegin;
  PetscCall(MatCreateComposite(PETSC_COMM_WORLD, t->nheld, t->held, &product));
  PetscCall(MatCompositeSetType(product, MAT_COMPOSITE_MULTIPLICATIVE));
  PetscCall(VecDuplicate(t->scale, &start));
  PetscCall(MpmSingularStart(0, start));
  PetscCall(MpmSingularLargest(product, start, BASIS, TOLERANCE, &window.norm));
  PetscCall(VecDestroy(&start));
  PetscCall(MatDestroy(&product));
  PetscCall(Record(t, &window));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lets the tangents of a window go. */
static PetscErrorCode EndWindow(MpmTangents *t)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < t->nheld; i++) PetscCall(MatDestroy(&t->held[i]));
  t->nheld = 0;
  t->waves = 0;
  t->next  = FIRST;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentsStep(MpmTangents *t, const MpmMarch *march)
{
  PetscReal speed[2], room, *moduli = NULL;
  Mat       tangent;

  PetscFunctionBegin;
  PetscCall(MpmTangentStateOf(&t->space, march, &t->state));
  if (t->steps == 0) PetscCall(MpmTangentCheck(&t->space, &t->state));
  PetscCall(MpmTangentRoom(&t->space, &t->state, &room));
  t->room = PetscMin(t->room, room);
  PetscCall(MpmTangentOf(&t->space, march->courant, &t->state, &tangent, NULL));
  t->on_surface += t->space.on_surface;
  if (t->bytes == 0) {
    PetscCall(MpmTangentBytes(tangent, &t->bytes));
    t->bytes *= t->window;
    PetscCall(MpmLayoutCheckMemory(PETSC_COMM_WORLD, march->layout, t->bytes, "the tangents of a window"));
  }
  PetscCall(MatDiagonalScale(tangent, t->scale, t->unscale));
  PetscCall(MpmPaceSpeeds(march, &moduli, speed));
  PetscCall(PetscFree(moduli));
  t->waves += speed[0] * march->courant;
  PetscCall(Follow(t, tangent));
  t->held[t->nheld++] = tangent;
  if (t->nheld == t->window || t->nheld == t->next) {
    PetscCall(Check(t, march->step + 1));
    t->next *= 2;
  }
  if (t->nheld == t->window) PetscCall(EndWindow(t));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentsDestroy(MpmTangents **tangents)
{
  MpmTangents *t = *tangents;

  PetscFunctionBegin;
  if (!t) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(EndWindow(t));
  PetscCall(PetscFree2(t->held, t->log_growth));
  PetscCall(BVDestroy(&t->perturbation));
  PetscCall(VecDestroy(&t->scale));
  PetscCall(VecDestroy(&t->unscale));
  PetscCall(MpmTangentStateDestroy(&t->space, &t->state));
  PetscCall(MpmTangentSpaceDestroy(&t->space));
  PetscCall(PetscFree(t->at));
  PetscCall(PetscFree(*tangents));
  PetscFunctionReturn(PETSC_SUCCESS);
}
