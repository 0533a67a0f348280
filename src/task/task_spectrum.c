/*
   The task spectrum: mpmstab spectrum [SCENE.yaml | -matrix FILE | -program COMMAND | -plugin FILE] [-option value]...
*/
#include "base/textfile.h"
#include "probe/certificates.h"
#include "analysis/spectrum.h"
#include "io/matrix_file.h"
#include "io/mode_file.h"
#include "linalg/eigen.h"
#include "report/report.h"
#include "report/report_program.h"
#include "report/results.h"
#include "task/task.h"
#include <mpmstab/errors.h>
#include <math.h>

#define GROWS 0.1 /* a larger fitted power counts as growth */

static void Powers(json_t *result, const MpmSpectrum *s)
{
  const MpmTransient *t      = s->transient;
  const PetscReal     growth = s->finding.growth, tolerance = s->finding.tolerance;

  for (PetscInt i = 0; i < t->n; i++)
    (void)json_array_append_new(MpmResultList(result, "steps"), json_integer(t->steps[i]));
  MpmResultNumbers(result, "norm", t->n, t->norm);
  MpmResultKeep(result, "%g{largest!} %" PetscInt_FMT "{at_step} %g{seconds}", t->largest, t->at_step, t->seconds);
  MpmPrint("transient: norm(A^n) for n up to %" PetscInt_FMT ", norm: %s\n", t->steps[t->n - 1],
           MpmOperatorNorm(s->op));
  if (isnan(t->largest))
    MpmPrint("  largest beyond the range of doubles, at n = %" PetscInt_FMT, t->at_step);
  else
    MpmPrint("  largest of the %" PetscInt_FMT " n looked at%s %.6g, at n = %" PetscInt_FMT, t->n - t->missing,
             t->missing ? " and known" : "", t->largest, t->at_step);
  if (fabs(growth - 1) > tolerance && isfinite(t->excess))
    MpmPrint("; of norm(A^n) / growth^n %.6g, at n = %" PetscInt_FMT, t->excess, t->excess_at);
  MpmPrint("\n");
  if (t->missing) MpmPrint("  not converged: %" PetscInt_FMT " of %" PetscInt_FMT " norms\n", t->missing, t->n);
  if (t->missing || s->finding.verdict == MPM_UNDECIDED || !isfinite(t->power) || !isfinite(growth)) return;
  if (fabs(growth - 1) > tolerance)
    MpmPrint("  late norms go like growth^n%s", t->power > GROWS ? " times a power of n" : "");
  else if (t->power > GROWS)
    MpmPrint("  growth is 1, but norms grow like a power of n: a defective eigenvalue, or nearly one");
  else
    MpmPrint("  growth is 1, and norms do not go on growing up to n = %" PetscInt_FMT, t->steps[t->n - 1]);
  MpmPrint(" (fitted: n^%.2f)\n", fabs(t->power) < 0.005 ? 0 : t->power);
}

/*
   Prints the Kreiss constant. Under drift it is that of the operator of a period, and does not cover the steps between.
*/
static void Kreiss(json_t *result, const MpmSpectrum *s)
{
  const MpmPseudospectrum *p     = s->pseudospectrum;
  const PetscBool          moves = s->op->period > 1 ? PETSC_TRUE : PETSC_FALSE;
  const char              *of = moves ? " of the operator of a period" : "", *when = moves ? " of whole periods" : "";
  const PetscReal          z[2] = {creal(p->kreiss_at), cimag(p->kreiss_at)};

  MpmResultKeep(result, "%" PetscInt_FMT "{points} %g{kreiss!} %g{kreiss_at!} %g{seconds}", p->points, p->kreiss, NAN,
                p->seconds);
  if (isfinite(p->kreiss) && !isnan(z[0])) MpmResultNumbers(result, "kreiss_at", 2, z);
  if (isinf(p->kreiss))
    MpmPrint("Kreiss constant%s: infinite, an eigenvalue is outside the unit circle\n", of);
  else if (isnan(creal(p->kreiss_at)))
    MpmPrint("Kreiss constant%s: 1 as far as was looked; then no norm(A^n)%s is beyond e N = %.4g\n", of, when,
             M_E * p->order);
  else {
    MpmPrint("Kreiss constant%s: at least %.6g, at z = %.6g + %.6gi;\n", of, p->kreiss, creal(p->kreiss_at),
             cimag(p->kreiss_at));
    if (p->edge_power > GROWS)
      MpmPrint(
          "  it still grows there, like distance^-%.2f, at %g from the unit circle: an eigenvalue on it is defective, "
          "or\n  several are nearer to one another; norm(A^n)%s reaches that for some n\n",
          p->edge_power, MPM_KREISS_NEAREST, when);
    else
      MpmPrint("  norm(A^n)%s reaches that for some n, and if it is K, none is beyond e N K = %.4g\n", when,
               M_E * p->order * p->kreiss);
  }
}

/* ---- the report ---- */

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
  MpmPrint(", share in the null space of P2G %.2g\n", modes->null_share[0]);
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
                   ", of them %" PetscInt_FMT "{unseen} of the null spaces of P2G and DIV (for each field: "
                   "particles - rank)",
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
  if (s->transient) Powers(MpmResultIn(result, "transient"), s);
  if (s->pseudospectrum) Kreiss(MpmResultIn(result, "pseudospectrum"), s);
  if ((s->request->powers && !s->transient) || (s->request->pseudospectrum && !s->pseudospectrum))
    MpmPrint("transient: none, the operator's numbers leave the range of doubles\n");
}

PetscErrorCode MpmSpectrumReport(json_t *result, const MpmScene *scene, const MpmRequest *request, const MpmSpectrum *s,
                                 const MpmNeighbourhoods *all)
{
  PetscFunctionBegin;
  MpmResultFinding(result, all ? &all->finding : &s->finding);
  if (s && s->certificates) MpmReportCertificates(result, s->certificates);
  if (s) Bulk(result, s);
  if (all)
    MpmNeighbourhoodsReport(MpmResultIn(result, "spectrum"), scene, request, PETSC_FALSE, PETSC_FALSE, all);
  else
    PetscCall(MpmReportFinding(result, scene, request, &s->finding, s->condition));
  if (s) Cost(MpmResultIn(result, "spectrum"), s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- files: eigenvalues, modes, the symbol's curves and transient growth ---- */

static PetscErrorCode WriteEigenvalues(const MpmSpectrum *s, const MpmModes *modes, MpmDataFile *file)
{
  const PetscInt n = s->eigen->n;
  PetscReal     *pairs;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(2 * n, &pairs));
  for (PetscInt j = 0; j < n; j++) {
    pairs[2 * j]     = scalbn(s->eigen->re[j], (int)s->op->exponent);
    pairs[2 * j + 1] = scalbn(s->eigen->im[j], (int)s->op->exponent);
  }
  PetscCall(MpmDataFileArray(file, "/spectrum", "eigenvalues", n, 2, pairs));
  PetscCall(MpmDataFileArray(file, "/spectrum", "residuals", n, 1, s->eigen->residual));
  if (modes->dim) PetscCall(MpmDataFileArray(file, "/spectrum", "beta", n, modes->dim, modes->beta));
  if (modes->dim > 1) PetscCall(MpmDataFileArray(file, "/spectrum", "p_share", n, 1, modes->p_share));
  if (modes->dim) PetscCall(MpmDataFileArray(file, "/spectrum", "null_share", n, 1, modes->null_share));
  PetscCall(PetscFree(pairs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteCsv(const MpmSpectrum *s, const MpmModes *modes)
{
  static const char *const names[]  = {"", ",beta,null_share", ",beta_x,beta_y,p_share,null_share",
                                       ",beta_x,beta_y,beta_z,p_share,null_share"};
  const int                exponent = (int)s->op->exponent;
  MpmTextFile              csv;

  PetscFunctionBegin;
  PetscCall(MpmTextFileOpen(s->request->csv, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "mode,re,im,abs,growth,residual%s\n", names[modes->dim]);
    for (PetscInt j = 0; j < s->eigen->n; j++) {
      const PetscReal size  = hypot(s->eigen->re[j], s->eigen->im[j]);
      const PetscReal row[] = {scalbn(s->eigen->re[j], exponent), scalbn(s->eigen->im[j], exponent),
                               scalbn(size, exponent), MpmGrowthPerStep(size, s->op->exponent, s->op->period),
                               s->eigen->residual[j]};

      fprintf(csv.stream, "%" PetscInt_FMT, j + 1);
      for (size_t c = 0; c < PETSC_STATIC_ARRAY_LENGTH(row); c++) MpmTextFileCell(&csv, row[c]);
      for (PetscInt a = 0; a < modes->dim; a++) MpmTextFileCell(&csv, modes->beta[modes->dim * j + a]);
      if (modes->dim > 1) MpmTextFileCell(&csv, modes->p_share[j]);
      if (modes->dim) MpmTextFileCell(&csv, modes->null_share[j]);
      fprintf(csv.stream, "\n");
    }
  }
  PetscCall(MpmTextFileClose(&csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteTransient(const MpmSpectrum *s, MpmDataFile *file)
{
  const MpmTransient      *t = s->transient;
  const MpmPseudospectrum *p = s->pseudospectrum;
  PetscReal               *steps;

  PetscFunctionBegin;
  if (t) {
    PetscCall(PetscMalloc1(t->n, &steps));
    for (PetscInt i = 0; i < t->n; i++) steps[i] = (PetscReal)t->steps[i];
    PetscCall(MpmDataFileArray(file, "/transient", "steps", t->n, 1, steps));
    PetscCall(MpmDataFileArray(file, "/transient", "norm", t->n, 1, t->norm));
    PetscCall(PetscFree(steps));
  }
  if (!p) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmDataFileArray(file, "/pseudospectrum", "re", p->points, 1, p->re));
  PetscCall(MpmDataFileArray(file, "/pseudospectrum", "im", p->points, 1, p->re));
  PetscCall(MpmDataFileArray(file, "/pseudospectrum", "sigma", p->points, p->points, p->sigma));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSpectrumWriteFiles(const MpmSpectrum *s)
{
  MpmModes    modes = {.n = 0}; /* a matrix that was given has no waves and no nodes */
  MpmDataFile file;

  PetscFunctionBegin;
  if (!s->request->output[0] && !s->request->csv[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (s->scene) PetscCall(MpmModesCreate(s->op, s->eigen, s->eigen->n, &modes));
  if (s->request->csv[0]) PetscCall(WriteCsv(s, &modes));
  if (s->request->output[0]) {
    PetscCall(MpmDataFileOpen(PetscObjectComm((PetscObject)s->op->A), s->scene, s->request, &file));
    PetscCall(WriteEigenvalues(s, &modes, &file));
    if (s->scene)
      PetscCall(MpmModesWrite(s->op, s->scene->cell_width, s->eigen, s->request->modes, &file));
    else
      PetscCall(MpmVectorsWrite(s->op, s->eigen, s->request->modes, &file));
    if (s->symbol) PetscCall(MpmSymbolWrite(s->symbol, &s->predictor, &file));
    PetscCall(WriteTransient(s, &file));
    PetscCall(MpmDataFileClose(&file));
  }
  if (s->scene) PetscCall(MpmModesDestroy(&modes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the task ---- */

/* The spectrum of the matrix in a file. */
static PetscErrorCode OfFile(const MpmRequest *request, PetscReal started, MpmCertificates *certificates,
                             MpmSpectrum **spectrum)
{
  PetscInt     steps = request->matrix_steps;
  MpmSpectrum *s;
  Mat          A;

  PetscFunctionBegin;
  PetscCall(MpmMatrixRead(PETSC_COMM_WORLD, request->matrix, request->tolerance, &steps, certificates, &A));
  PetscCall(MpmSpectrumOfMatrix(request->matrix, A, steps, NULL, request, started, spectrum));
  s = *spectrum;
  if (MpmCertificatesTaken(certificates)) {
    s->certificates = certificates;
    PetscCall(MpmCertificatesJudge(certificates, NULL, isnan(s->condition) ? 1 : s->condition, steps, &s->finding));
  }
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses to write an operator that will not be a matrix, before the work. */
static PetscErrorCode CheckWritten(const MpmScene *scene, const MpmRequest *request)
{
  PetscInt64 order;

  PetscFunctionBegin;
  if (!scene || !request->write_matrix[0] || scene->layout.dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  order = scene->scheme.table->nstate * scene->layout.particles;
  MpmCheckInput(
      order <= MPM_MATRIX_ORDER,
      "-write_matrix %s: an operator of %" PetscInt64_FMT
      " unknowns in more than one dimension is not assembled; allowed: up to %d ('symbol -write_blocks' has no "
      "such limit)",
      request->write_matrix, order, MPM_MATRIX_ORDER);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Write(const char path[], const MpmOperator *op)
{
  PetscBool kept;

  PetscFunctionBegin;
  PetscCall(MpmMatrixWrite(path, op->A, op->exponent, op->period, &kept));
  if (!kept)
    MpmPrint("%s has no place for its %" PetscInt_FMT " steps: read it with -matrix_steps %" PetscInt_FMT "\n", path,
             op->period, op->period);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The spectrum of the tangent of one step of a nonlinear run. */
static PetscErrorCode OfTangent(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmSpectrum *s;
  PetscReal    mismatch;
  json_t      *result;

  PetscFunctionBegin;
  PetscCall(MpmFrozenSpectrum(scene, request, started, &s, &mismatch));
  PetscCall(MpmSpectrumWriteFiles(s));
  PetscCall(MpmResultOfScene(scene, request, &result));
  PetscCall(MpmSpectrumReport(result, scene, request, s, NULL));
  MpmResultSay(
      result, "tangent: of the step after step %" PetscInt64_FMT "{tangent.at_step}, as if the state stayed as it is; ",
      request->at_step);
  if (isfinite(mismatch))
    MpmResultSay(result, "its step differs from the march's by %.1e{tangent.step_mismatch}\n", mismatch);
  else
    MpmPrint("the run ends in this step, because a particle fails\n");
  PetscCall(MpmResultEnd(request, s->wall_s, &result));
  if (request->write_matrix[0]) PetscCall(Write(request->write_matrix, s->op));
  PetscCall(MpmExpectFinding(&request->expect, s->finding.verdict, s->finding.growth, missed));
  PetscCall(MpmSpectrumDestroy(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskSpectrum(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmSpectrum      *bulk = NULL;
  MpmCertificates   certificates;
  MpmNeighbourhood  place = {.kind = MPM_IN_BULK};
  MpmNeighbourhoods around, *all = MpmNeighbourhoodsWanted(request) ? &around : NULL;
  const MpmFinding *found;
  json_t           *result;

  PetscFunctionBegin;
  if (MpmRequestProbes(request)) {
    PetscCall(MpmSpectrumOfProgram(request, started, missed));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (scene && scene->scheme.space.finite) {
    PetscCall(OfTangent(scene, request, started, missed));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(CheckWritten(scene, request));
  if (!scene)
    PetscCall(OfFile(request, started, &certificates, &bulk));
  else if (request->neighbourhood[MPM_IN_BULK])
    PetscCall(MpmSpectrumCreate(scene, request, started, &bulk));
  else
    PetscCall(MpmEigenRefuseUnread());
  if (bulk) place = MpmNeighbourhoodOfFinding(&bulk->finding);
  if (all) PetscCall(MpmNeighbourhoodsFind(scene, request, &place, PETSC_FALSE, all));
  if (bulk) PetscCall(MpmSpectrumWriteFiles(bulk));
  PetscCall(scene ? MpmResultOfScene(scene, request, &result) : MpmResultOfFile(request, "the matrix", &result));
  PetscCall(MpmSpectrumReport(result, scene, request, bulk, all));
  PetscCall(MpmResultEnd(request, MPI_Wtime() - started, &result));
  if (bulk && request->write_matrix[0]) PetscCall(Write(request->write_matrix, bulk->op));
  found = all ? &all->finding : &bulk->finding;
  PetscCall(MpmExpectFinding(&request->expect, found->verdict, found->growth, missed));
  if (bulk) PetscCall(MpmSpectrumDestroy(&bulk));
  PetscFunctionReturn(PETSC_SUCCESS);
}
