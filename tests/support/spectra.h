/* The spectrum of a scene, as tests ask for it. */
#pragma once
#include "analysis/spectrum.h"
#include "check.h"

/* Makes a scene and its spectrum, without a march. */
static inline PetscErrorCode SpectrumOf(const char options[], MpmScene **scene, MpmSpectrum **spectrum)
{
  PetscFunctionBegin;
  PetscCall(CheckScene(options, scene));
  check_request.measure = PETSC_FALSE;
  PetscCall(MpmSpectrumCreate(*scene, &check_request, 0, spectrum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode SpectrumClose(MpmScene **scene, MpmSpectrum **spectrum)
{
  PetscFunctionBegin;
  PetscCall(MpmSpectrumDestroy(spectrum));
  PetscCall(MpmSceneDestroy(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
