/* The symbol of a whole scene, as tests ask for it. */
#pragma once
#include <mpmstab/scene.h>
#include <mpmstab/symbol.h>

/* The symbol at so many phases in each direction, with the tolerance 1e-6; keep says whether the amplification factors are kept. */
static inline PetscErrorCode CheckSymbol(MPI_Comm comm, const MpmScene *scene, PetscInt phases, PetscBool keep,
                                         MpmSymbol **symbol)
{
  const MpmSymbolWish wish = {.phases = {phases, phases, phases}, .keep = keep, .tolerance = 1e-6};

  PetscFunctionBegin;
  PetscCall(MpmSymbolCreate(comm, &scene->layout, &scene->scheme, &scene->step, &wish, symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}
