/* The task map: mpmstab map [SCENE.yaml | -program COMMAND | -plugin FILE] [-option value]... */
#include "probe/program_map.h"
#include "task/expect.h"
#include "report/results.h"
#include "task/task.h"

PetscErrorCode MpmTaskMap(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmExpect        expect = request->expect;
  MpmProgram       program;
  MpmStabilityMap *map;

  PetscFunctionBegin;
  expect.has[MPM_EXPECT_SPECTRUM] = PETSC_FALSE; /* it is about one point */
  if (scene)
    PetscCall(MpmStabilityMapCreate(scene, request, &map));
  else {
    PetscCall(MpmProgramOpen(request, &program));
    PetscCall(MpmStabilityMapOfProgram(&program, &map));
  }
  if (request->csv[0]) PetscCall(MpmStabilityMapWriteCsv(map));
  if (request->output[0]) PetscCall(MpmStabilityMapWriteOutput(map));
  PetscCall(MpmStabilityMapReport(map, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&expect, &map->finding, missed));
  PetscCall(MpmStabilityMapDestroy(&map));
  if (!scene) PetscCall(MpmProgramClose(&program));
  PetscFunctionReturn(PETSC_SUCCESS);
}
