/*
   The task spectrum for a code that is probed: the operator of its base state, or those of the states to which it comes
   by itself. Files and expectations are about the state that grows most.
*/
#include "task/task.h"
#include "io/matrix_file.h"
#include "probe/program_growth.h"
#include "report/report_program.h"
#include "report/results.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <stdlib.h>

/*S
   States - the spectrum of the state that grows most so far, with its report; and, of all states, what JSON has.
S*/
typedef struct {
  MpmProgram   program;
  MpmSpectrum *most;
  json_t      *more, *all;
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
  json_t   *each;

  PetscFunctionBegin;
  better = !states->most || !(s->finding.growth <= states->most->finding.growth) ? PETSC_TRUE : PETSC_FALSE;
  each   = MpmResultNext(states->all, "states");
  MpmResultKeep(each, "%" PetscInt_FMT "{step} %s{verdict} %g{growth}", at, MpmVerdictNames[s->finding.verdict],
                s->finding.growth);
  (void)json_object_set(each, "probing", json_object_get(one, "probing"));
  (void)json_object_set(each, "carriers", json_object_get(one, "carriers"));
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

/* Where all particles were probed at once, the blocks of one cell are probed besides. */
static PetscErrorCode Compare(MpmProgram *p, MpmCompareProgram *compare, json_t *one)
{
  const MpmProbeKind kind = p->kind;
  MpmProbed          probed;

  PetscFunctionBegin;
  if (p->kind != MPM_PROBE_BLOCH) {
    PetscCall(MpmUnreadDestroy(&p->unread));
    p->kind = MPM_PROBE_BLOCH;
    PetscCall(MpmProgramOperator(p, &probed, NULL));
    p->kind   = kind;
    p->blocks = probed.blocks;
  }
  PetscCall(MpmCompareProgramFind(p, &p->blocks, NAN, compare));
  MpmReportCompare(MpmResultIn(one, "comparison"), p, compare);
  PetscCall(MpmCompareProgramDestroy(compare));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The operator of a period is a product, which fills. */
static PetscErrorCode BeginMotion(MpmProgram *p, MpmMotion *motion)
{
  const PetscInt64 order = p->stepper->particles * p->stepper->width;

  PetscFunctionBegin;
  MpmCheckInput(!p->shell && order <= MPM_MATRIX_ORDER,
                "-%s: the product of the steps of a period is a full matrix, and there are %" PetscInt64_FMT
                " unknowns; allowed: up to %d, or symbol, which has all waves of cells that are alike",
                p->request->program_mach ? "mach" : "drift", order, MPM_MATRIX_ORDER);
  PetscCall(MpmMotionBegin(p, motion));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Probes the base state as it is. */
static PetscErrorCode OfState(States *states, const MpmRequest *request, PetscInt at, PetscReal started)
{
  MpmProgram       *p = &states->program;
  MpmCompareProgram compare;
  MpmSpectrum      *s;
  MpmCarriers       carriers;
  MpmProbeKind      kind;
  MpmKinks          kinks;
  MpmMotion         motion = {.n = 0};
  json_t           *one    = json_object();
  Mat               A, B;

  PetscFunctionBegin;
  PetscCall(MpmProgramPrepare(p));
  PetscCall(CheckShell(p));
  if (request->compare[0]) PetscCall(MpmCompareProgramBegin(p, &compare));
  if (request->program_drift[0].den) PetscCall(BeginMotion(p, &motion));
  if (states->most)
    MpmPrint("\n");
  else
    MpmReportProgram(p);
  if (request->compare[0] && p->kind != MPM_PROBE_BLOCH)
    MpmPrint("  all cells are alike: symbol -compare does the same with %" PetscInt_FMT " calls\n",
             4 * p->lattice.sites * p->stepper->width);
  if (request->at[0]) MpmPrint("the state after %" PetscInt_FMT " steps\n", at);
  kind = p->kind;
  if (motion.n) {
    MpmPrint("  all this at each of %" PetscInt_FMT " places of the drift\n", motion.n);
    PetscCall(MpmMotionFind(p, &motion));
    PetscCall(MpmMotionMatrix(p, &motion, PETSC_FALSE, &A));
    PetscCall(MpmMotionMatrix(p, &motion, PETSC_TRUE, &B));
  } else
    PetscCall(MpmProgramMatrix(p, &A, &B));
  if (p->kind != kind) MpmPrint("  the cells look alike and are not: all particles were probed\n");
  PetscCall(CheckShell(p));
  MpmReportProbed(one, p);
  if (motion.n) MpmReportMotion(MpmResultIn(one, "motion"), p->stepper->dim, &motion);
  PetscCall(MpmSpectrumOfMatrix(p->stepper->name, A, p->probe.steps, MpmProgramLattice(p), request, started, &s));
  PetscCall(MpmProgramJudgeSpectrum(p, B, s));
  PetscCall(MpmCarriersFind(p, s, &carriers));
  PetscCall(MpmSpectrumReport(one, NULL, request, s, NULL));
  MpmReportCarriers(one, &carriers);
  MpmResultKeep(one, "%" PetscInt64_FMT "{probing.calls}", p->stepper->calls); /* with those that eigenvalues took */
  if (request->compare[0]) PetscCall(Compare(p, &compare, one));
  if (!motion.n && MpmCertificatesSwitch(&p->certificates)) {
    PetscCall(MpmKinksFind(p, &kinks));
    MpmReportKinks(one, &kinks);
  }
  if (motion.n) PetscCall(MpmMotionDestroy(&motion));
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

/* Growth by a run, without an operator. */
static PetscErrorCode Measure(const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmProgram    program;
  MpmProgramRun run;
  MpmFinding    finding;
  json_t       *result;

  PetscFunctionBegin;
  PetscCall(MpmProgramOpen(request, &program));
  PetscCall(MpmProgramPrepare(&program));
  PetscCall(MpmProgramRunFind(&program, request->program_run, &run, &finding));
  PetscCall(MpmResultOfFile(request, NULL, &result));
  MpmReportRun(result, &program, &run);
  PetscCall(MpmReportFinding(result, NULL, NULL, &finding, NAN));
  PetscCall(MpmResultEnd(request, MPI_Wtime() - started, &result));
  PetscCall(MpmExpectFinding(&request->expect, finding.verdict, finding.growth, missed));
  PetscCall(MpmProgramClose(&program));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSpectrumOfProgram(const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  States       states = {.all = json_object()};
  MpmSpectrum *s;
  json_t      *result;
  PetscBool    kept;

  PetscFunctionBegin;
  if (request->program_run) {
    PetscCall(Measure(request, started, missed));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmProgramOpen(request, &states.program));
  PetscCall(GoThrough(&states, request, started));
  s = states.most;
  PetscCall(MpmSpectrumWriteFiles(s));
  PetscCall(MpmResultOfFile(request, NULL, &result));
  (void)json_object_update(result, states.more);
  if (request->at[0]) (void)json_object_update(result, states.all);
  PetscCall(MpmResultEnd(request, s->wall_s, &result));
  if (request->write_matrix[0])
    PetscCall(MpmMatrixWrite(request->write_matrix, s->op->A, s->op->exponent, s->op->period, &kept));
  PetscCall(MpmExpectFinding(&request->expect, s->finding.verdict, s->finding.growth, missed));
  json_decref(states.all);
  json_decref(states.more);
  PetscCall(MpmSpectrumDestroy(&states.most));
  PetscCall(MpmProgramClose(&states.program));
  PetscFunctionReturn(PETSC_SUCCESS);
}
