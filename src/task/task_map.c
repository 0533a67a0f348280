/* The task map: mpmstab map [SCENE.yaml | -program COMMAND | -plugin FILE] [-option value]... */
#include "analysis/stability_map.h"
#include "base/progress.h"
#include "probe/program_growth.h"
#include "task/expect.h"
#include "report/results.h"
#include "task/task.h"
#include <mpmstab/errors.h>
#include <math.h>

/* ---- of a code: at each point two of its parameters are set, and its operator is probed and judged ---- */

static PetscErrorCode RefuseAxis(const MpmStepper *s, const char name[])
{
  MpmText        names = {NULL, 0};
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(MpmStepperParameterNames(s, &names));
  ierr = MpmRefusal("-map_axes %s: %s has no such parameter; allowed: %s", name, s->where, names.text);
  MpmTextFree(&names);
  PetscFunctionReturn(ierr);
}

static PetscErrorCode CheckAxes(const MpmStabilityMap *map)
{
  const MpmStepper *s = map->program->stepper;

  PetscFunctionBegin;
  for (int a = 0; a < 2; a++) {
    PetscBool found;
    PetscReal value;

    MpmStepperParameterOf(s, map->request->axes[a].name, &value, &found);
    if (!found) PetscCall(RefuseAxis(s, map->request->axes[a].name));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GoTo(MpmStabilityMap *m, PetscInt i)
{
  PetscFunctionBegin;
  PetscCall(MpmStepperSet(m->program->stepper, m->request->axes[0].name, m->at[0][i / m->points[1]]));
  PetscCall(MpmStepperSet(m->program->stepper, m->request->axes[1].name, m->at[1][i % m->points[1]]));
  PetscCall(MpmProgramPrepare(m->program));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Judge(MpmStabilityMap *m, PetscReal beta[], MpmFinding *f)
{
  MpmCarriers carriers;

  PetscFunctionBegin;
  if (m->waves)
    PetscCall(MpmProgramJudgeWaves(m->program, m->phases, beta, f));
  else
    PetscCall(MpmProgramJudgeParticles(m->program, MPI_Wtime(), f, &carriers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A growth that is not known is kept as NaN, and the point is undecided. */
static PetscErrorCode Solve(MpmStabilityMap *m)
{
  const PetscInt n = m->points[0] * m->points[1];
  MpmProgress    progress;

  PetscFunctionBegin;
  PetscCall(MpmProgressBegin("points", &progress));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal  beta[MPM_MAX_DIM] = {0};
    MpmFinding f;

    PetscCall(GoTo(m, i));
    PetscCall(Judge(m, beta, &f));
    m->growth[i]  = f.growth;
    m->verdict[i] = f.verdict;
    m->fault[i]   = (PetscInt)MpmCertificatesFault(&m->program->certificates);
    for (PetscInt a = 0; a < m->waves; a++) m->beta[a][i] = beta[a];
    PetscCall(MpmProgramForget(m->program));
    PetscCall(MpmProgressUpdate(&progress, i + 1, n));
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Explain(MpmStabilityMap *m)
{
  const PetscInt n = m->points[0] * m->points[1];
  MpmFinding    *f = &m->finding;

  f->tolerance = m->program->tolerance;
  if (m->waves)
    (void)snprintf(f->evidence, sizeof f->evidence,
                   "the symbol of the interior at each of %" PetscInt_FMT " points, sought over all waves", n);
  else
    (void)snprintf(f->evidence, sizeof f->evidence, "the operator of all particles at each of %" PetscInt_FMT " points",
                   n);
}

/*
   Probes a code at each point, where two of its parameters have the point's numbers. The program must have been opened and not be
   prepared; afterwards it is prepared for the point that grows fastest, and must outlive the map.
*/
static PetscErrorCode MapOfProgram(MpmProgram *p, MpmStabilityMap **map)
{
  const PetscReal  begin = MPI_Wtime();
  MpmStabilityMap *m;
  PetscInt         n;
  PetscReal        beta[MPM_MAX_DIM];
  MpmFinding       worst;

  PetscFunctionBegin;
  PetscCall(MpmStabilityMapBegin(p->request, map));
  m          = *map;
  m->program = p;
  n          = m->points[0] * m->points[1];
  PetscCall(CheckAxes(m));
  PetscCall(GoTo(m, 0));
  m->waves = p->kind == MPM_PROBE_BLOCH ? p->stepper->dim : 0;
  PetscCall(MpmProgramForget(p));
  MpmCheckInput(m->waves || !p->request->given_phases,
                "-phases: the operator of all particles is probed, which has no phases; allowed: with a code whose "
                "cells are alike");
  PetscCall(MpmRequestPhases(p->request, p->stepper->dim, m->phases));
  for (PetscInt a = 0; a < m->waves; a++) PetscCall(PetscCalloc1(n, &m->beta[a]));
  PetscCall(PetscMalloc1(n, &m->fault));
  PetscCall(Solve(m));
  PetscCall(MpmStabilityMapSum(m));
  Explain(m);
  PetscCall(GoTo(m, m->worst));
  PetscCall(Judge(m, beta, &worst));
  m->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
    PetscCall(MapOfProgram(&program, &map));
  }
  if (request->csv[0]) PetscCall(MpmStabilityMapWriteCsv(map));
  if (request->output[0]) PetscCall(MpmStabilityMapWriteOutput(map));
  PetscCall(MpmStabilityMapReport(map, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&expect, &map->finding, missed));
  PetscCall(MpmStabilityMapDestroy(&map));
  if (!scene) PetscCall(MpmProgramClose(&program));
  PetscFunctionReturn(PETSC_SUCCESS);
}
