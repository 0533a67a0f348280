/*
   The task spectrum for a code that is probed: the operator of its base state, or those of the states to which it comes
   by itself. Files and expectations are about the state that grows most.
*/
#include "task/spectrum_program.h"
#include "io/matrix_file.h"
#include "io/spectrum_files.h"
#include "probe/program_growth.h"
#include "report/report_compare.h"
#include "report/report_program.h"
#include "report/results.h"
#include "task/expect.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <stdlib.h>

/*S
   States - the spectrum of the state that grows most so far, with what else JSON says of it and of all states.
S*/
typedef struct {
  MpmProgram   program;
  MpmSpectrum *most;
  json_t      *more, *list;
} States;

/* Refuses what needs a matrix, before the work. */
static PetscErrorCode CheckShell(const MpmProgram *p)
{
  const MpmRequest *request = p->request;
  const char       *name    = request->powers            ? "powers"
                              : request->pseudospectrum  ? "pseudospectrum"
                              : request->write_matrix[0] ? "write_matrix"
                                                         : NULL;

  PetscFunctionBegin;
  MpmCheckInput(!p->shell || !name,
                "-%s: it needs the matrix, and of %" PetscInt64_FMT
                " unknowns only products are asked for; allowed: up to %d unknowns, or coloured probing",
                name, p->stepper->particles * p->stepper->width, MPM_MATRIX_ORDER);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps a spectrum if it grows most. */
static PetscErrorCode Keep(States *states, MpmSpectrum *s, json_t *one, PetscInt at)
{
  PetscBool better;

  PetscFunctionBegin;
  better = !states->most || !(s->finding.growth <= states->most->finding.growth) ? PETSC_TRUE : PETSC_FALSE;
  json_array_append_new(states->list,
                        json_pack("{s:i, s:s, s:O}", "step", (int)at, "verdict", MpmVerdictNames[s->finding.verdict],
                                  "probing", json_object_get(one, "probing")));
  MpmJsonSet(json_array_get(states->list, json_array_size(states->list) - 1), "growth", s->finding.growth);
  json_object_set(json_array_get(states->list, json_array_size(states->list) - 1), "carriers",
                  json_object_get(one, "carriers"));
  if (better && states->most) {
    PetscCall(MpmSpectrumDestroy(&states->most));
    json_decref(states->more);
  }
  if (better) {
    states->most = s;
    states->more = one;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmSpectrumDestroy(&s));
  json_decref(one);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The blocks of one cell are probed besides: all particles at once do not show them. */
static PetscErrorCode Compare(MpmProgram *p, MpmCompareProgram *compare, json_t *one)
{
  MpmBlocks blocks;

  PetscFunctionBegin;
  PetscCall(MpmUnreadDestroy(&p->unread));
  PetscCall(MpmProgramBlocks(p, &blocks, NULL));
  PetscCall(MpmCompareProgramFind(p, &blocks, NAN, compare));
  MpmReportCompare(p, compare);
  json_object_set_new(one, "comparison", MpmJsonCompare(compare));
  PetscCall(MpmCompareProgramDestroy(compare));
  PetscCall(MpmBlocksFree(&blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Probes the base state as it is. */
static PetscErrorCode OfState(States *states, const MpmRequest *request, PetscInt at, PetscReal started)
{
  MpmProgram       *p = &states->program;
  MpmCompareProgram compare;
  MpmSpectrum      *s;
  MpmCarriers       carriers;
  json_t           *one;
  Mat               A, B;

  PetscFunctionBegin;
  PetscCall(MpmProgramPrepare(p));
  PetscCall(CheckShell(p));
  if (request->compare[0]) PetscCall(MpmCompareProgramBegin(p, &compare));
  if (states->most)
    MpmPrint("\n");
  else
    MpmReportProgram(p);
  if (request->at[0]) MpmPrint("the state after %" PetscInt_FMT " steps\n", at);
  PetscCall(MpmProgramMatrix(p, &A, &B));
  MpmReportCertificates(&p->certificates);
  MpmReportApart(p);
  PetscCall(MpmSpectrumOfMatrix(p->stepper->name, A, p->probe.steps, request, started, &s));
  PetscCall(MpmProgramJudgeSpectrum(p, B, s));
  PetscCall(MpmCarriersFind(p, s, &carriers));
  PetscCall(MpmSpectrumPrint(NULL, request, s, NULL));
  MpmReportCarriers(&carriers);
  one = json_object();
  json_object_set_new(one, "probing", MpmJsonProgram(p));
  json_object_set_new(one, "carriers", MpmJsonCarriers(&carriers));
  if (request->compare[0]) PetscCall(Compare(p, &compare, one));
  PetscCall(Keep(states, s, one, at));
  PetscCall(MatDestroy(&A));
  PetscCall(MatDestroy(&B));
  PetscCall(MpmProgramForget(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Goes through the steps that option at names, or the base state alone. */
static PetscErrorCode GoThrough(States *states, const MpmRequest *request, PetscReal started)
{
  const char *text = request->at[0] ? request->at : "0";
  PetscInt    done = 0;

  PetscFunctionBegin;
  while (*text) {
    char      *end;
    const long at = strtol(text, &end, 10);

    MpmCheckInput(end != text && (*end == ',' || !*end) && at >= done && at <= 1000000000,
                  "-at %s: allowed: whole numbers from 0, each at least the one before, with commas between them",
                  request->at);
    PetscCall(MpmProgramAdvance(&states->program, (PetscInt)at - done));
    done = (PetscInt)at;
    PetscCall(OfState(states, request, done, started));
    text = *end ? end + 1 : end;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSpectrumOfProgram(const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  States       states = {.list = json_array()};
  MpmSpectrum *s;
  PetscBool    kept;

  PetscFunctionBegin;
  PetscCall(MpmProgramOpen(request, &states.program));
  PetscCall(GoThrough(&states, request, started));
  s = states.most;
  if (request->at[0]) json_object_set(states.more, "states", states.list);
  PetscCall(MpmSpectrumWriteFiles(s));
  if (request->json[0]) PetscCall(MpmSpectrumWriteJson(NULL, request, s, NULL, s->wall_s, states.more));
  if (request->write_matrix[0])
    PetscCall(MpmMatrixWrite(request->write_matrix, s->op->A, s->op->exponent, s->op->period, &kept));
  PetscCall(MpmExpectFinding(&request->expect, &s->finding, missed));
  json_decref(states.list);
  json_decref(states.more);
  PetscCall(MpmSpectrumDestroy(&states.most));
  PetscCall(MpmProgramClose(&states.program));
  PetscFunctionReturn(PETSC_SUCCESS);
}
