/*
   Writes the operator A of a scene in PETSc's binary format, so that other solvers can be measured: FILE [-option
   value]...
*/
#include "scene/request.h"
#include <mpmstab/errors.h>
#include <mpmstab/operator.h>
#include <mpmstab/scene.h>

static PetscErrorCode Write(const char path[])
{
  MpmScene    *scene;
  MpmOperator *op;
  PetscViewer  file;

  PetscFunctionBegin;
  PetscCall(MpmErrorsInstall());
  PetscCall(MpmSceneCreate("spectrum", NULL, &scene, NULL));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCheck(op->exponent == 0, PETSC_COMM_WORLD, PETSC_ERR_ARG_OUTOFRANGE, "the operator is A times 2^%d",
             (int)op->exponent);
  PetscCall(PetscViewerBinaryOpen(PETSC_COMM_WORLD, path, FILE_MODE_WRITE, &file));
  PetscCall(PetscViewerBinarySetSkipInfo(file, PETSC_TRUE));
  PetscCall(MatView(op->A, file));
  PetscCall(PetscViewerDestroy(&file));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  if (argc < 2 || PetscInitialize(&argc, &argv, NULL, NULL)) return 2;
  if (Write(argv[1])) MPI_Abort(PETSC_COMM_WORLD, 1);
  return PetscFinalize() ? 1 : 0;
}
