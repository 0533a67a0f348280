/* The report of the task spectrum. */
#include "report/report_program.h"
#include "report/results.h"
#include <math.h>

static void Symbol(json_t *result, const MpmSpectrum *s)
{
  char text[256];

  if (!s->symbol) {
    (void)snprintf(text, sizeof text, "none: %s", MpmSymbolWhyNot(&s->scene->layout));
    MpmReportGrowth(result, "predicted.symbol", "symbol", NAN, text);
    return;
  }
  (void)snprintf(text, sizeof text, "at beta = %s of %s phases",
                 MpmVectorText(s->symbol->dim, s->symbol->beta_at_max, 4, MPM_VECTOR_ROOM),
                 MpmCountsText(s->symbol->dim, s->symbol->phases, MPM_VECTOR_ROOM));
  MpmReportGrowth(result, "predicted.symbol", "symbol", s->symbol->growth, text);
  MpmResultSymbol(result, s->symbol);
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
  MpmReportGrowth(NULL, NULL, "spectrum", s->growth, text);
}

static void Measured(json_t *result, const MpmSpectrum *s)
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
  if (growth && growth->measured)
    MpmResultKeep(MpmResultIn(result, "run"), "%" PetscInt64_FMT "{steps} %g{growth_measured} %s{growth_kind}",
                  s->run->steps, growth->per_step, MpmGrowthKindNames[growth->kind]);
  MpmReportGrowth(NULL, NULL, "measured", growth && growth->measured ? growth->per_step : NAN, text);
}

/* The first listed eigenvalues with their modes; says what wave the leading one is. */
static void Leading(json_t *result, const MpmSpectrum *s)
{
  const MpmModes *modes = &s->leading;

  for (PetscInt j = 0; j < modes->n; j++) {
    const PetscReal *beta = &modes->beta[modes->dim * j];
    json_t          *mode = MpmResultNext(result, "modes");

    MpmResultKeep(mode, "%g{re} %g{im} %g{p_share} %g{null_share}", scalbn(s->eigen->re[j], (int)s->op->exponent),
                  scalbn(s->eigen->im[j], (int)s->op->exponent), modes->p_share[j], modes->null_share[j]);
    MpmResultNumbers(mode, "beta", modes->dim && !isnan(beta[0]) ? modes->dim : 0, beta);
  }
  if (!modes->n || isnan(modes->beta[0])) return;
  MpmPrint("first mode listed: beta = %s", MpmVectorText(modes->dim, modes->beta, 4, MPM_VECTOR_ROOM));
  if (!isnan(modes->p_share[0])) MpmPrint(", P share %.3g", modes->p_share[0]);
  MpmPrint(", share that no node sees %.2g\n", modes->null_share[0]);
}

static void Operator(json_t *result, const MpmSpectrum *s)
{
  json_t *found = MpmResultIn(result, "spectrum");

  MpmResultSay(found, "\noperator: order %" PetscInt_FMT "{unknowns}", s->op->order);
  if (isnan(s->op->nonzeros))
    MpmPrint(", known by its products");
  else
    MpmPrint(", %.4g nonzeros%s", s->op->nonzeros, s->op->assembled ? "" : " in its maps");
  if (!isnan(s->op->nonzeros)) MpmResultPut(found, "nonzeros", json_integer((json_int_t)s->op->nonzeros));
  MpmResultSay(found, ", of %" PetscInt_FMT "{period_steps} step%s", s->op->period, s->op->period == 1 ? "" : "s");
  if (!s->scene)
    MpmPrint("%s\n", s->op->unit ? "; its unknowns are scaled, so that rows and columns have about the same size" : "");
  else if (isfinite(s->step_mismatch))
    MpmPrint("; it differs from the march by %.1e\n", s->step_mismatch);
  else
    MpmPrint("; not compared: the march leaves the range of doubles\n");
  if (s->eigen->small)
    MpmResultSay(found,
                 "nodes' own operator: order %" PetscInt_FMT "{nodal_unknowns}, whose eigenvalues these are, and those "
                 "that particles keep by themselves; it agrees with the particles' to %.1e{nodal_mismatch}\n",
                 s->eigen->small->order, s->nodal->mismatch);
  if (isfinite(s->eigen->norm)) MpmPrint("solver: %s\n", s->eigen->solver);
  if (s->symbol && s->eigen->n && isfinite(s->symbol_mismatch))
    MpmPrint("eigenvalues: within %.1e of the symbol's set%s\n", s->symbol_mismatch / PetscMax(1, s->radius),
             s->radius > 1 ? ", relative to the largest" : "");
  Leading(result, s);
  if (s->at_one != MPM_UNCOUNTED) {
    MpmResultSay(found, "eigenvalues at 1: %" PetscInt_FMT "{at_one}", s->at_one);
    if (s->nullity != MPM_UNCOUNTED)
      MpmResultSay(found,
                   ", of them %" PetscInt_FMT "{unseen} for what no node sees (for each field particles - rank of its "
                   "map)",
                   s->nullity);
    MpmPrint("\n");
  } else if (s->nullity != MPM_UNCOUNTED)
    MpmResultKeep(found, "%" PetscInt_FMT "{unseen}", s->nullity);
  MpmResultKeep(found, "%s{solver} %d{converged?} %" PetscInt_FMT "{listed}", s->eigen->solver, s->eigen->converged,
                s->eigen->n);
  MpmResultKeep(found, "%g{spectral_radius} %g{growth} %g{max_residual} %g{condition}", s->radius, s->growth,
                s->max_residual, s->condition);
  MpmResultKeep(found, "%g{step_mismatch} %g{symbol_mismatch}", s->step_mismatch, s->symbol_mismatch);
  if (s->scene) MpmReportComparison(result, &s->predictor, &s->comparison);
}

static void Cost(json_t *found, const MpmSpectrum *s)
{
  MpmResultKeep(found, s->scene ? "%g{assemble_s}" : "%g", s->op->assemble_s);
  MpmResultSay(found, "time: %.3g s to %s, %.3g{solve_s} s to solve, %.3g s in all\n", s->op->assemble_s,
               s->scene ? "assemble" : "balance", s->eigen->solve_s, s->wall_s);
  MpmPrint("memory: %.4g MB for the task, %.4g bytes an unknown", 1e-6 * s->memory, s->memory / s->op->order);
  MpmResultKeep(found, "%g{memory_bytes}", s->memory);
  if (!isnan(s->op->bytes)) MpmPrint(", of them %.3g for A", s->op->bytes / s->op->order);
  MpmPrint("\n");
}

static void Bulk(json_t *result, const MpmSpectrum *s)
{
  MpmPrint("\ngrowth per step\n");
  if (s->scene) MpmReportPredictions(result, &s->predictor, &s->predictions);
  if (s->scene) Symbol(result, s);
  PrintSpectrum(s);
  if (s->scene) Measured(result, s);
  Operator(result, s);
  MpmTransientReport(result, s);
}

void MpmSpectrumReport(json_t *result, const MpmScene *scene, const MpmRequest *request, const MpmSpectrum *s,
                       const MpmNeighbourhoods *all)
{
  MpmResultFinding(result, all ? &all->finding : &s->finding);
  if (s && s->certificates) MpmReportCertificates(result, s->certificates);
  if (s) Bulk(result, s);
  if (all)
    MpmNeighbourhoodsReport(MpmResultIn(result, "spectrum"), scene, request, PETSC_FALSE, all);
  else
    MpmReportFinding(result, &s->finding, s->condition);
  if (s) Cost(MpmResultIn(result, "spectrum"), s);
}
