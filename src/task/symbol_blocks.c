/*
   The task symbol for blocks from a file, or of a code that is probed: growth at equally spaced phases, and between
   them where it is largest.
*/
#include "io/datafile.h"
#include "io/matrix_file.h"
#include "task/task.h"
#include "analysis/waves.h"
#include "probe/motion.h"
#include "report/report_program.h"
#include <mpmstab/errors.h>
#include <math.h>

#define GAINS 1e-12 /* relative; growth between phases that is larger by less is rounding */

/*S
   Answer - the symbol of blocks, the phase of largest growth at its phases or between them, and the verdict. program,
   and other, which are the blocks with another size of perturbations: only of a code that is probed. compare: only if
   asked for. certificates: of a file. motion: of a program that is set to the places of a drift; n is 0 where it is
   not.
S*/
typedef struct {
  MpmProgram        program;
  MpmBlocks         blocks, other;
  MpmCertificates   certificates;
  MpmSymbol        *symbol;
  PetscReal         beta[MPM_MAX_DIM];
  MpmSourceGrowth   worst;
  PetscReal         worst_uncertainty;
  MpmCompareProgram compare;
  MpmMotion         motion;
  MpmFinding        finding;
} Answer;

/* The blocks, or the product of those of a period, with either size of perturbations. */
static PetscErrorCode SourceOf(const MpmRequest *request, const Answer *a, PetscBool other, MpmBlocksSteps *steps,
                               MpmSource *source)
{
  const char *name = MpmRequestSource(request);

  PetscFunctionBegin;
  if (a->motion.n)
    PetscCall(MpmMotionSource(&a->motion, other, name, steps, source));
  else
    PetscCall(MpmBlocksSource(other ? &a->other : &a->blocks, name, source));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the phase of the symbol where the search between its phases has found no larger growth. */
static PetscErrorCode Compare(Answer *a)
{
  const MpmSymbol *s = a->symbol;

  PetscFunctionBegin;
  a->worst_uncertainty = MpmUncertaintyOf(a->worst.growth, a->worst.relative, a->symbol->period);
  if (a->worst.growth > s->growth * (1 + GAINS)) PetscFunctionReturn(PETSC_SUCCESS);
  a->worst.growth      = s->growth;
  a->worst.condition   = s->condition;
  a->worst_uncertainty = s->uncertainty;
  PetscCall(PetscArraycpy(a->beta, s->beta_at_max, a->blocks.dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Judge(const MpmRequest *request, Answer *a)
{
  MpmFinding *f = &a->finding;

  PetscFunctionBegin;
  *f = (MpmFinding){.tolerance       = request->tolerance,
                    .growth          = a->worst.growth,
                    .uncertainty     = a->worst_uncertainty,
                    .defective_error = a->symbol->defective_error};
  (void)snprintf(f->evidence, sizeof f->evidence,
                 "the symbol at %s phases, and a search between them from where growth is largest",
                 MpmCountsText(a->blocks.dim, a->symbol->phases, MPM_VECTOR_ROOM));
  f->verdict = MpmVerdictOf(f);
  if (MpmRequestProbes(request)) {
    MpmSource       source;
    MpmBlocksSteps  steps;
    MpmSourceGrowth other;

    PetscCall(SourceOf(request, a, PETSC_TRUE, &steps, &source));
    PetscCall(MpmSourceGrowthAt(&source, a->beta, &other));
    PetscCall(MpmProgramJudge(&a->program, other.growth, a->worst.condition, f));
  } else if (MpmCertificatesTaken(&a->certificates))
    PetscCall(MpmCertificatesJudge(&a->certificates, NULL, a->worst.condition, a->blocks.period, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Blocks from the file, or by probing. */
static PetscErrorCode GetBlocks(const MpmRequest *request, Answer *a)
{
  MpmProbed one, other;

  PetscFunctionBegin;
  if (!MpmRequestProbes(request)) {
    PetscCall(MpmBlocksRead(PETSC_COMM_WORLD, request->matrix_blocks, request->matrix_steps, request->tolerance,
                            &a->certificates, &a->blocks));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmProgramOpen(request, &a->program));
  PetscCall(MpmProgramPrepare(&a->program));
  if (request->compare[0]) PetscCall(MpmCompareProgramBegin(&a->program, &a->compare));
  if (request->program_drift[0].den) {
    PetscCall(MpmMotionBegin(&a->program, &a->motion));
    MpmReportProgram(&a->program);
    MpmPrint("  all this at each of %" PetscInt_FMT " places of the drift\n", a->motion.n);
    PetscCall(MpmMotionFind(&a->program, &a->motion));
    a->blocks = a->motion.blocks[0][0];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  MpmReportProgram(&a->program);
  PetscCall(MpmProgramOperator(&a->program, &one, &other));
  a->blocks = one.blocks;
  a->other  = other.blocks;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Compute(const MpmRequest *request, Answer *a)
{
  const MPI_Comm comm = PETSC_COMM_WORLD;
  MpmSymbolWish  wish = {.keep = request->output[0] ? PETSC_TRUE : PETSC_FALSE, .tolerance = request->tolerance};
  MpmBlocksSteps steps;
  MpmSource      source;

  PetscFunctionBegin;
  PetscCall(GetBlocks(request, a));
  PetscCall(SourceOf(request, a, PETSC_FALSE, &steps, &source));
  PetscCall(MpmRequestPhases(request, source.dim, wish.phases));
  PetscCall(MpmSymbolFromSource(comm, &source, &wish, &a->symbol));
  PetscCall(MpmWorstPhase(comm, &source, a->symbol->phases, a->beta, &a->worst));
  PetscCall(Compare(a));
  PetscCall(Judge(request, a));
  if (request->compare[0]) PetscCall(MpmCompareProgramFind(&a->program, &a->blocks, a->worst.growth, &a->compare));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Report(const MpmRequest *request, Answer *a, PetscReal wall_s)
{
  const PetscBool  probed = MpmRequestProbes(request);
  const MpmBlocks *b      = &a->blocks;
  char             text[256];
  json_t          *result;
  MpmKinks         kinks;

  PetscFunctionBegin;
  PetscCall(MpmResultOfFile(request, probed ? NULL : "the blocks", &result));
  if (probed)
    MpmReportProbed(result, &a->program);
  else if (MpmCertificatesTaken(&a->certificates))
    MpmReportCertificates(result, &a->certificates);
  if (a->motion.n) MpmReportMotion(MpmResultIn(result, "motion"), b->dim, &a->motion);
  MpmResultSay(MpmResultIn(result, "lattice"),
               "%" PetscInt_FMT "{blocks} blocks of %" PetscInt_FMT "{unknowns} unknowns a cell, %" PetscInt_FMT
               "{dim} direction%s, of %" PetscInt_FMT "{period_steps} step%s\n\ngrowth per step\n",
               b->n, b->size, b->dim, b->dim == 1 ? "" : "s", a->symbol->period, a->symbol->period == 1 ? "" : "s");
  if (b->cell_width > 0) MpmResultKeep(result, "%g{lattice.cell_width}", b->cell_width);
  (void)snprintf(text, sizeof text, "at beta = %s of %s phases",
                 MpmVectorText(b->dim, a->symbol->beta_at_max, 6, MPM_VECTOR_ROOM),
                 MpmCountsText(b->dim, a->symbol->phases, MPM_VECTOR_ROOM));
  MpmReportGrowth(NULL, NULL, "symbol", a->symbol->growth, text);
  MpmResultSymbol(result, a->symbol);
  (void)snprintf(text, sizeof text, "at beta = %s, the largest of a search between these phases",
                 MpmVectorText(b->dim, a->beta, 6, MPM_VECTOR_ROOM));
  MpmReportGrowth(NULL, NULL, "all waves", a->worst.growth, text);
  MpmResultKeep(MpmResultIn(result, "refined"), "%g{growth} %g{condition}", a->worst.growth, a->worst.condition);
  MpmResultVector(result, "refined.beta_at_max", b->dim, a->beta);
  if (request->compare[0]) MpmReportCompare(MpmResultIn(result, "comparison"), &a->program, &a->compare);
  MpmPrint("\n");
  PetscCall(MpmReportFinding(result, NULL, NULL, &a->finding, a->worst.condition));
  if (probed && !a->motion.n && MpmCertificatesSwitch(&a->program.certificates)) {
    PetscCall(MpmKinksFind(&a->program, &kinks));
    MpmReportKinks(result, &kinks);
  }
  MpmPrint("time: %.3g s\n", a->symbol->seconds);
  PetscCall(MpmResultEnd(request, wall_s, &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteFiles(const MpmRequest *request, const Answer *a)
{
  MpmDataFile file;

  PetscFunctionBegin;
  if (request->csv[0]) PetscCall(MpmSymbolWriteCsv(a->symbol, NULL, request->csv));
  if (request->write_blocks[0]) PetscCall(MpmBlocksWrite(request->write_blocks, &a->blocks));
  if (!request->output[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmDataFileOpen(PETSC_COMM_WORLD, NULL, request, &file));
  PetscCall(MpmSymbolWrite(a->symbol, NULL, &file));
  PetscCall(MpmDataFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolOfBlocks(const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  Answer answer = {.symbol = NULL};

  PetscFunctionBegin;
  PetscCall(Compute(request, &answer));
  PetscCall(WriteFiles(request, &answer));
  PetscCall(Report(request, &answer, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&request->expect, answer.finding.verdict, answer.finding.growth, missed));
  PetscCall(MpmSymbolDestroy(&answer.symbol));
  if (answer.motion.n)
    PetscCall(MpmMotionDestroy(&answer.motion));
  else
    PetscCall(MpmBlocksFree(&answer.blocks));
  if (MpmRequestProbes(request)) {
    PetscCall(MpmBlocksFree(&answer.other));
    if (request->compare[0]) PetscCall(MpmCompareProgramDestroy(&answer.compare));
    PetscCall(MpmProgramClose(&answer.program));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
