/* The waves of a scene, one by one: their matrices and amplification factors. */
#pragma once
#include "check.h"
#include "linalg/small_eigen.h"
#include "symbol/bloch.h"
#include <math.h>

/* A scene, and what makes amplification factors of any phase of it. */
typedef struct {
  MpmScene     *scene;
  MpmBloch      bloch;
  MpmSmallEigen eigen;
} Wave;

static inline PetscErrorCode WaveCreate(const char options[], Wave *w)
{
  PetscFunctionBegin;
  PetscCall(CheckScene(options, &w->scene));
  PetscCall(MpmBlochCreate(&w->scene->layout, &w->scene->scheme, w->scene->step.drift, &w->bloch));
  PetscCall(MpmSmallEigenCreate(w->bloch.size, &w->eigen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode WaveDestroy(Wave *w)
{
  PetscFunctionBegin;
  PetscCall(MpmSmallEigenDestroy(&w->eigen));
  PetscCall(MpmBlochDestroy(&w->bloch));
  PetscCall(MpmSceneDestroy(&w->scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode FactorsAt(Wave *w, PetscReal courant, const PetscReal beta[], PetscBool vectors)
{
  PetscInt exponent;

  PetscFunctionBegin;
  PetscCall(MpmBlochMatrices(&w->bloch, 1, &courant, beta, PETSC_FALSE, w->eigen.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&w->eigen, vectors));
  for (PetscInt i = 0; i < w->eigen.n; i++) w->eigen.value[i] *= scalbn(1, (int)exponent);
  PetscFunctionReturn(PETSC_SUCCESS);
}
