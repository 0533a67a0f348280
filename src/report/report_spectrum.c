/* Prints the table of the task spectrum. */
#include "report/report_certificates.h"
#include "report/results.h"
#include <math.h>

static PetscErrorCode PrintSymbol(const MpmSpectrum *s)
{
  char text[256], beta[96], phases[64];

  PetscFunctionBegin;
  if (!s->symbol) {
    PetscCall(PetscSNPrintf(text, sizeof text, "none: %s", MpmSymbolWhyNot(&s->scene->layout)));
    PetscCall(MpmReportGrowth("symbol", NAN, text));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmReportVector(s->symbol->dim, s->symbol->beta_at_max, 4, sizeof beta, beta));
  PetscCall(MpmReportCounts(s->symbol->dim, s->symbol->phases, sizeof phases, phases));
  PetscCall(PetscSNPrintf(text, sizeof text, "at beta = %s of %s phases", beta, phases));
  PetscCall(MpmReportGrowth("symbol", s->symbol->growth, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintSpectrum(const MpmSpectrum *s)
{
  char text[256];

  PetscFunctionBegin;
  if (s->eigen->n)
    PetscCall(PetscSNPrintf(text, sizeof text, "%" PetscInt_FMT " of %" PetscInt_FMT " eigenvalues, residual %.1e",
                            s->eigen->n, s->op->order, s->max_residual));
  else
    PetscCall(PetscStrncpy(text,
                           isfinite(s->eigen->norm) ? "no eigenvalue converged"
                                                    : "the operator's numbers leave the range of doubles",
                           sizeof text));
  PetscCall(MpmReportGrowth("spectrum", s->growth, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintMeasured(const MpmSpectrum *s)
{
  const MpmGrowth *growth = s->run ? &s->run->growth : NULL;
  char             text[256];

  PetscFunctionBegin;
  if (growth && growth->measured)
    PetscCall(PetscSNPrintf(text, sizeof text, "%s, from random data, steps %" PetscInt64_FMT " to %" PetscInt64_FMT,
                            MpmGrowthKindNames[growth->kind], growth->from, growth->to));
  else
    PetscCall(PetscStrncpy(text,
                           growth                ? "nothing left to measure"
                           : s->request->measure ? "not run: that would take too long here; try 'mpmstab run'"
                                                 : "not asked for",
                           sizeof text));
  PetscCall(MpmReportGrowth("measured", growth && growth->measured ? growth->per_step : NAN, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says what wave the leading mode is. */
static PetscErrorCode PrintLeading(const MpmModes *modes)
{
  char beta[96];

  PetscFunctionBegin;
  if (!modes->n || isnan(modes->beta[0])) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmReportVector(modes->dim, modes->beta, 4, sizeof beta, beta));
  MpmPrint("first mode listed: beta = %s", beta);
  if (!isnan(modes->p_share[0])) MpmPrint(", P share %.3g", modes->p_share[0]);
  MpmPrint(", share that no node sees %.2g\n", modes->null_share[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintOperator(const MpmSpectrum *s)
{
  PetscFunctionBegin;
  MpmPrint("\noperator: order %" PetscInt_FMT, s->op->order);
  if (isnan(s->op->nonzeros))
    MpmPrint(", known by its products");
  else
    MpmPrint(", %.4g nonzeros%s", s->op->nonzeros, s->op->assembled ? "" : " in its maps");
  MpmPrint(", of %" PetscInt_FMT " step%s", s->op->period, s->op->period == 1 ? "" : "s");
  if (!s->scene)
    MpmPrint("%s\n", s->op->unit ? "; its unknowns are scaled, so that rows and columns have about the same size" : "");
  else if (isfinite(s->step_mismatch))
    MpmPrint("; it differs from the march by %.1e\n", s->step_mismatch);
  else
    MpmPrint("; not compared: the march leaves the range of doubles\n");
  if (s->eigen->small)
    MpmPrint("nodes' own operator: order %" PetscInt_FMT
             ", whose eigenvalues these are, and those that particles keep by "
             "themselves; it agrees with the particles' to %.1e\n",
             s->eigen->small->order, s->nodal->mismatch);
  if (isfinite(s->eigen->norm)) MpmPrint("solver: %s\n", s->eigen->solver);
  if (s->symbol && s->eigen->n && isfinite(s->symbol_mismatch))
    MpmPrint("eigenvalues: within %.1e of the symbol's set%s\n", s->symbol_mismatch / PetscMax(1, s->radius),
             s->radius > 1 ? ", relative to the largest" : "");
  PetscCall(PrintLeading(&s->leading));
  if (s->at_one != MPM_UNCOUNTED) {
    MpmPrint("eigenvalues at 1: %" PetscInt_FMT, s->at_one);
    if (s->nullity != MPM_UNCOUNTED)
      MpmPrint(", of them %" PetscInt_FMT " for what no node sees (for each field particles - rank of its map)",
               s->nullity);
    MpmPrint("\n");
  }
  if (s->scene) PetscCall(MpmReportComparison(&s->predictor, &s->comparison));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintCost(const MpmSpectrum *s)
{
  PetscFunctionBegin;
  MpmPrint("time: %.3g s to %s, %.3g s to solve, %.3g s in all\n", s->op->assemble_s, s->scene ? "assemble" : "balance",
           s->eigen->solve_s, s->wall_s);
  MpmPrint("memory: %.4g MB for the task, %.4g bytes an unknown", 1e-6 * s->memory, s->memory / s->op->order);
  if (!isnan(s->op->bytes)) MpmPrint(", of them %.3g for A", s->op->bytes / s->op->order);
  MpmPrint("\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintBulk(const MpmSpectrum *s)
{
  PetscFunctionBegin;
  MpmPrint("\ngrowth per step\n");
  if (s->scene) PetscCall(MpmReportPredictions(&s->predictor, &s->predictions));
  if (s->scene) PetscCall(PrintSymbol(s));
  PetscCall(PrintSpectrum(s));
  if (s->scene) PetscCall(PrintMeasured(s));
  PetscCall(PrintOperator(s));
  PetscCall(MpmTransientPrint(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSpectrumPrint(const MpmScene *scene, const MpmRequest *request, const MpmSpectrum *s,
                                const MpmNeighbourhoods *all)
{
  PetscMPIInt ranks;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  if (scene)
    PetscCall(MpmReportScene(scene, request, ranks));
  else if (!MpmRequestProbes(request)) /* whose heading is printed before it is probed */
    PetscCall(MpmReportFile(request, "the matrix", ranks));
  if (s && s->certificates) PetscCall(MpmReportCertificates(s->certificates));
  if (s) PetscCall(PrintBulk(s));
  if (all)
    PetscCall(MpmNeighbourhoodsPrint(scene, request, PETSC_FALSE, all));
  else
    PetscCall(MpmReportFinding(&s->finding, s->condition));
  if (s) PetscCall(PrintCost(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}
