/* Prints the table of the task spectrum. */
#include "report/report_certificates.h"
#include "report/results.h"
#include <math.h>

static void PrintSymbol(const MpmSpectrum *s)
{
  char text[256];

  if (!s->symbol) {
    (void)snprintf(text, sizeof text, "none: %s", MpmSymbolWhyNot(&s->scene->layout));
    MpmReportGrowth("symbol", NAN, text);
    return;
  }
  (void)snprintf(text, sizeof text, "at beta = %s of %s phases",
                 MpmVectorText(s->symbol->dim, s->symbol->beta_at_max, 4, MPM_VECTOR_ROOM),
                 MpmCountsText(s->symbol->dim, s->symbol->phases, MPM_VECTOR_ROOM));
  MpmReportGrowth("symbol", s->symbol->growth, text);
}

static void PrintSpectrum(const MpmSpectrum *s)
{
  char text[256];

  if (s->eigen->n)
    (void)snprintf(text, sizeof text, "%" PetscInt_FMT " of %" PetscInt_FMT " eigenvalues, residual %.1e", s->eigen->n,
                   s->op->order, s->max_residual);
  else
    (void)snprintf(text, sizeof text, "%s",
                   isfinite(s->eigen->norm) ? "no eigenvalue converged"
                                            : "the operator's numbers leave the range of doubles");
  MpmReportGrowth("spectrum", s->growth, text);
}

static void PrintMeasured(const MpmSpectrum *s)
{
  const MpmGrowth *growth = s->run ? &s->run->growth : NULL;
  char             text[256];

  if (growth && growth->measured)
    (void)snprintf(text, sizeof text, "%s, from random data, steps %" PetscInt64_FMT " to %" PetscInt64_FMT,
                   MpmGrowthKindNames[growth->kind], growth->from, growth->to);
  else
    (void)snprintf(text, sizeof text, "%s",
                   growth                ? "nothing left to measure"
                   : s->request->measure ? "not run: that would take too long here; try 'mpmstab run'"
                                         : "not asked for");
  MpmReportGrowth("measured", growth && growth->measured ? growth->per_step : NAN, text);
}

/* Says what wave the leading mode is. */
static void PrintLeading(const MpmModes *modes)
{
  if (!modes->n || isnan(modes->beta[0])) return;
  MpmPrint("first mode listed: beta = %s", MpmVectorText(modes->dim, modes->beta, 4, MPM_VECTOR_ROOM));
  if (!isnan(modes->p_share[0])) MpmPrint(", P share %.3g", modes->p_share[0]);
  MpmPrint(", share that no node sees %.2g\n", modes->null_share[0]);
}

static void PrintOperator(const MpmSpectrum *s)
{
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
  PrintLeading(&s->leading);
  if (s->at_one != MPM_UNCOUNTED) {
    MpmPrint("eigenvalues at 1: %" PetscInt_FMT, s->at_one);
    if (s->nullity != MPM_UNCOUNTED)
      MpmPrint(", of them %" PetscInt_FMT " for what no node sees (for each field particles - rank of its map)",
               s->nullity);
    MpmPrint("\n");
  }
  if (s->scene) MpmReportComparison(&s->predictor, &s->comparison);
}

static void PrintCost(const MpmSpectrum *s)
{
  MpmPrint("time: %.3g s to %s, %.3g s to solve, %.3g s in all\n", s->op->assemble_s, s->scene ? "assemble" : "balance",
           s->eigen->solve_s, s->wall_s);
  MpmPrint("memory: %.4g MB for the task, %.4g bytes an unknown", 1e-6 * s->memory, s->memory / s->op->order);
  if (!isnan(s->op->bytes)) MpmPrint(", of them %.3g for A", s->op->bytes / s->op->order);
  MpmPrint("\n");
}

static void PrintBulk(const MpmSpectrum *s)
{
  MpmPrint("\ngrowth per step\n");
  if (s->scene) MpmReportPredictions(&s->predictor, &s->predictions);
  if (s->scene) PrintSymbol(s);
  PrintSpectrum(s);
  if (s->scene) PrintMeasured(s);
  PrintOperator(s);
  MpmTransientPrint(s);
}

PetscErrorCode MpmSpectrumPrint(const MpmScene *scene, const MpmRequest *request, const MpmSpectrum *s,
                                const MpmNeighbourhoods *all)
{

  PetscFunctionBegin;
  if (scene)
    PetscCall(MpmReportScene(scene, request));
  else if (!MpmRequestProbes(request)) /* whose heading is printed before it is probed */
    MpmReportFile(request, "the matrix");
  if (s && s->certificates) MpmReportCertificates(s->certificates);
  if (s) PrintBulk(s);
  if (all)
    MpmNeighbourhoodsPrint(scene, request, PETSC_FALSE, all);
  else
    MpmReportFinding(&s->finding, s->condition);
  if (s) PrintCost(s);
  PetscFunctionReturn(PETSC_SUCCESS);
}
