/* mpmstab map [SCENE.yaml] [-option value]... */
#include "task/expect.h"
#include "report/results.h"
#include "task/task.h"

static PetscErrorCode Run(const MpmScene *scene, PetscReal started, PetscInt *missed)
{
  MpmExpect        expect = scene->expect;
  MpmStabilityMap *map;

  PetscFunctionBegin;
  expect.has_spectrum = PETSC_FALSE; /* that is of one point */
  PetscCall(MpmStabilityMapCreate(scene, &map));
  PetscCall(MpmStabilityMapPrint(map));
  if (scene->csv[0]) PetscCall(MpmStabilityMapWriteCsv(map));
  if (scene->output[0]) PetscCall(MpmStabilityMapWriteOutput(map));
  if (scene->json[0]) PetscCall(MpmStabilityMapWriteJson(map, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&expect, &map->finding, missed));
  PetscCall(MpmStabilityMapDestroy(&map));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskMap(int argc, char **argv, PetscReal started, int *status)
{
  PetscFunctionBegin;
  PetscCall(MpmTaskOnScene("map", Run, argc, argv, started, status));
  PetscFunctionReturn(PETSC_SUCCESS);
}
