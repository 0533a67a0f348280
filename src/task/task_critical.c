/* The task critical: mpmstab critical [SCENE.yaml | -program COMMAND | -plugin FILE] [-option value]... */
#include "linalg/eigen.h"
#include "report/report_program.h"
#include "report/results.h"
#include "task/task.h"

static PetscErrorCode One(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmCriticalCase   of     = MpmCriticalCaseOf(scene, request->tolerance);
  const PetscBool   wanted = MpmNeighbourhoodsWanted(request);
  MpmNeighbourhood  place  = {.kind = MPM_IN_BULK};
  MpmNeighbourhoods around, *all  = wanted ? &around : NULL;
  MpmCritical       found, *bulk  = request->neighbourhood[MPM_IN_BULK] ? &found : NULL;
  MpmStepTable      steps, *table = NULL;

  PetscFunctionBegin;
  of.all_particles = !request->nodal;
  of.sweeps        = request->step_bound_sweeps;
  of.chance        = request->step_bound_chance;
  of.each          = scene->layout.given && request->write_layout[0];
  if (bulk) {
    PetscCall(MpmCriticalFind(&of, PETSC_FALSE, bulk));
    place = MpmNeighbourhoodOfCritical(bulk);
  }
  if (all) PetscCall(MpmNeighbourhoodsFind(scene, request, &place, PETSC_TRUE, all));
  if (request->table && bulk->courant > 0) { /* one that grows at every step has no table */
    table = &steps;
    PetscCall(MpmStepTableFind(scene, request, &place, all, table));
  }
  if (request->csv[0] && bulk) PetscCall(MpmCriticalWriteCsv(request->csv, scene, bulk, table));
  if (of.each) PetscCall(MpmCriticalWriteLayout(request->write_layout, scene, bulk));
  PetscCall(MpmCriticalReport(scene, request, bulk, all, table, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&request->expect, all ? all->finding.verdict : bulk->asked.verdict,
                             all ? all->courant : bulk->courant, missed));
  if (of.each) PetscCall(PetscFree(bulk->each));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The Mach number is kept, so that the drift changes with the Courant number. */
static PetscErrorCode AtMach(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  const MpmCriticalCase of = MpmCriticalCaseOf(scene, request->tolerance);
  MpmCriticalMach       found;

  PetscFunctionBegin;
  PetscCall(MpmCriticalMachCreate(&of, &request->mach, &found));
  if (request->csv[0]) PetscCall(MpmCriticalMachWriteCsv(scene, request, &found));
  PetscCall(MpmCriticalMachReport(scene, request, &found, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&request->expect, found.asked.verdict,
                             found.stable ? found.points[found.stable - 1].courant : NAN, missed));
  PetscCall(MpmCriticalMachDestroy(&found));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The time step of a code that is probed. */
static PetscErrorCode OfProgram(const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmProgram         program;
  MpmCriticalProgram critical;

  PetscFunctionBegin;
  MpmCheckInput(!request->csv[0], "-csv %s: a code that is probed has no row of a scheme; allowed: -json FILE",
                request->csv);
  PetscCall(MpmProgramOpen(request, &program));
  PetscCall(MpmCriticalProgramBegin(&program, &critical));
  MpmReportProgram(&program);
  MpmReportCriticalPlan(&critical);
  PetscCall(MpmCriticalProgramFind(&program, started, &critical));
  PetscCall(MpmCriticalProgramReport(&program, &critical, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&request->expect, critical.finding.verdict, critical.critical, missed));
  PetscCall(MpmCriticalProgramDestroy(&critical));
  PetscCall(MpmProgramClose(&program));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskCritical(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  PetscFunctionBegin;
  *missed = 0;
  if (!scene) {
    PetscCall(OfProgram(request, started, missed));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmNodalChoiceCheck(scene, request));
  if (MpmSymbolWhyNot(&scene->layout)) PetscCall(MpmEigenTryOptions(MPM_EIGEN_DENSE));
  PetscCall(MpmEigenRefuseUnread());
  if (request->survey)
    PetscCall(MpmCriticalPrintSurvey(scene, request));
  else if (request->at_mach)
    PetscCall(AtMach(scene, request, started, missed));
  else
    PetscCall(One(scene, request, started, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}
