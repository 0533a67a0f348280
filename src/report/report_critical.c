/* The largest stable Courant number: prints it in words, and writes it as JSON and as CSV. */
#include "report/results.h"
#include "base/textfile.h"
#include "report/report.h"
#include <math.h>

static PetscErrorCode PrintLimit(const MpmScene *s, PetscReal tolerance, const MpmCritical *c)
{
  const char *name =
      MpmSceneDrifts(s) ? "largest Courant number with growth within tolerance" : "critical Courant number";

  PetscFunctionBegin;
  if (c->disputed)
    MpmPrint("%s: undecided, the search finds %.10g, but the closed form says otherwise\n", name, c->stable_at);
  else if (isnan(c->courant))
    MpmPrint("%s: undecided, tolerance %.6g is less than the growth of up to %.1g per step that rounding makes here\n",
             name, tolerance, c->rounding);
  else if (isinf(c->courant))
    MpmPrint("%s: none up to %.6g is unstable\n", name, MPM_CRITICAL_TO);
  else if (c->courant == 0 && c->stable_at == 0)
    MpmPrint("%s: 0, growth is beyond tolerance even at %.6g\n", name, c->unstable_at);
  else if (c->courant == 0)
    MpmPrint("%s: 0, the scheme grows at every one\n", name);
  else if (isinf(c->stable_at))
    MpmPrint("%s: %.6g; any growth beyond it is within tolerance\n", name, c->courant);
  else if (c->courant < c->stable_at)
    MpmPrint("%s: %.6g; growth beyond it is within tolerance up to %.6g\n", name, c->courant, c->stable_at);
  else
    MpmPrint("%s: %.6g%s\n", name, c->courant,
             MpmSceneDrifts(s) || !MpmSceneIsPeriodic(s) ? "" : ", for particles at rest (-drift for those that move)");
  if (c->stable_at > 0 && isfinite(c->unstable_at))
    MpmPrint("  bracket      growth within 1 + %.6g at %.10g, beyond at %.10g\n", tolerance, c->stable_at,
             c->unstable_at);
  if (MpmSceneDrifts(s))
    MpmPrint("  particles move by %.6g cells per step at every Courant number that is looked at\n",
             s->step.drift[0].value);
  if (MpmSceneDrifts(s))
    MpmPrint(c->followed
                 ? "  under drift growth comes in windows of Courant number; this is where the first one opens\n"
                 : "  under drift growth comes in windows of Courant number; one narrower than the steps of the "
                   "search may be missed\n");
  if (isfinite(c->doubtful))
    MpmPrint("  near %.6g amplification factors could not be told apart: a window there may be missed\n", c->doubtful);
  if (!isnan(c->closed) && isfinite(c->closed))
    MpmPrint("  closed form  %.10g: %s\n", c->closed, s->scheme.formulation->limit_text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintReason(PetscReal tolerance, const MpmCritical *c)
{
  PetscFunctionBegin;
  if (isinf(c->unstable_at)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!isnan(c->fading) && !isnan(c->courant))
    MpmPrint("  no threshold: growth fades like the Courant number to the power %.2g, tolerance %.6g sets the limit\n",
             c->fading, tolerance);
  MpmPrint("  limited by   ");
  if (isnan(c->beta))
    MpmPrint("a mode whose trace on the nodes has no phase");
  else if (c->beta > 0)
    MpmPrint("%s of %.4g cells, beta = %.6g", c->assembled ? "a mode with waves" : "waves", 2 * PETSC_PI / c->beta,
             c->beta);
  else
    MpmPrint("the mode with beta = 0");
  if (!isnan(c->null_share)) MpmPrint("; share that no node sees %.2g", c->null_share);
  MpmPrint("\n");
  if (c->closed > 0 && isfinite(c->closed))
    MpmPrint("  there        alpha = %.6g (P2G G2P), kappa = %.6g (-DIV GRAD), mu = %.4g%+.4gi (P2G GRAD), f = %.4g "
             "(transfer)\n",
             c->cell.alpha, c->cell.kappa, creal(c->cell.mu), cimag(c->cell.mu), c->cell.filter);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prints growth and verdict at the scene's own Courant number. */
static PetscErrorCode PrintAsked(const MpmScene *s, PetscReal tolerance, const MpmCritical *c)
{
  PetscFunctionBegin;
  MpmPrint("\nat Courant number %.6g: growth ", s->step.courant);
  if (isinf(c->asked.growth))
    MpmPrint("beyond the range of doubles");
  else
    MpmPrint("%.9g per step", c->asked.growth);
  if (isfinite(c->asked.growth) && !isnan(c->moving)) {
    MpmPrint("; if particles drift by 1/%d cell per step: ", MPM_CRITICAL_DRIFT);
    if (isinf(c->moving))
      MpmPrint("beyond that range");
    else
      MpmPrint("%.9g%s", c->moving, c->moving > 1 + tolerance && c->asked.growth <= 1 + tolerance ? ", it rings" : "");
  }
  MpmPrint("\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalPrint(const MpmScene *s, const MpmRequest *request, const MpmCritical *c)
{
  PetscMPIInt ranks;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  PetscCall(MpmReportScene(s, request, ranks));
  MpmPrint("\n");
  PetscCall(PrintLimit(s, request->tolerance, c));
  PetscCall(PrintReason(request->tolerance, c));
  PetscCall(PrintAsked(s, request->tolerance, c));
  PetscCall(MpmReportFinding(&c->asked, NAN));
  if (c->assembled)
    MpmPrint("searched: all eigenvalues of %" PetscInt_FMT " unknowns at %" PetscInt64_FMT " Courant numbers\n",
             c->order, c->evaluations);
  else
    MpmPrint("searched: all phases, %" PetscInt64_FMT " amplification matrices of order %" PetscInt_FMT "\n",
             c->evaluations, c->order);
  MpmPrint("time: %.3g s\n", c->seconds);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalWriteJson(const char path[], const MpmScene *s, const MpmCritical *c, PetscReal wall_s)
{
  PetscMPIInt ranks;
  json_t     *object, *critical = json_object();

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  PetscCall(MpmJsonScene(s, "critical", ranks, wall_s, &object));
  MpmJsonSetFinding(object, &c->asked);
  MpmJsonSet(critical, "critical_courant", c->courant);
  MpmJsonSet(critical, "limited_by_beta", c->beta);
  MpmJsonSet(critical, "stable_at", c->stable_at);
  MpmJsonSet(critical, "unstable_at", c->unstable_at);
  MpmJsonSet(critical, "closed_form", c->closed);
  MpmJsonSet(critical, "fading", c->fading);
  MpmJsonSet(critical, "growth_when_drifting", c->moving);
  json_object_set_new(critical, "threshold", json_boolean(c->threshold));
  json_object_set_new(critical, "evaluations", json_integer(c->evaluations));
  MpmJsonSet(critical, "seconds", c->seconds);
  json_object_set_new(object, "critical", critical);
  PetscCall(MpmJsonWrite(path, object));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CsvOpen(const char path[], MpmTextFile *csv)
{
  PetscFunctionBegin;
  PetscCall(MpmTextFileOpen(path, csv));
  if (csv->stream)
    fprintf(csv->stream, "formulation,basis,transfer,ppc,offset,jitter,drift,boundary_left,boundary_right,"
                         "critical_courant,closed_form,limited_by_beta\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void CsvRow(MpmTextFile *csv, const MpmScene *scene, const MpmScheme *scheme, const MpmCritical *c)
{
  const MpmLayout *l = &scene->layout;

  if (!csv->stream) return;
  fprintf(csv->stream, "%s,%s,%s,%" PetscInt_FMT ",%.17g,%.17g,%.17g,%s,%s", scheme->formulation->name,
          scheme->basis->name, scheme->transfer->name, l->ppc[0], l->offset[0].value, l->jitter,
          scene->step.drift[0].value, MpmEndNames[l->grid[0].ends[0]], MpmEndNames[l->grid[0].ends[1]]);
  MpmTextFileCell(csv, c->courant);
  MpmTextFileCell(csv, c->closed);
  MpmTextFileCell(csv, c->beta);
  fprintf(csv->stream, "\n");
}

PetscErrorCode MpmCriticalWriteCsv(const char path[], const MpmScene *scene, const MpmCritical *critical)
{
  MpmTextFile csv;

  PetscFunctionBegin;
  PetscCall(CsvOpen(path, &csv));
  CsvRow(&csv, scene, &scene->scheme, critical);
  PetscCall(MpmTextFileClose(&csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A table of limits with a row for each formulation and transfer. Each number is printed as soon as it is found. */
typedef struct {
  const MpmScene   *scene;
  const MpmRequest *request;
  MpmTextFile       csv;
  PetscBool         undecided;
} Survey;

static PetscErrorCode PrintCell(void *context, const MpmScheme *scheme, const MpmCritical *c)
{
  Survey *survey = (Survey *)context;

  PetscFunctionBegin;
  if (scheme->basis == MpmBases[0]) MpmPrint("\n%-8s %-10s", scheme->formulation->name, scheme->transfer->name);
  if (isnan(c->courant)) {
    MpmPrint("  %9s", "?");
    survey->undecided = PETSC_TRUE;
  } else if (isinf(c->courant))
    MpmPrint("  %9s", "none");
  else if (c->courant == 0)
    MpmPrint("  %9s", "0");
  else if (c->courant < 1e-3)
    MpmPrint("  %9.1e", c->courant);
  else
    MpmPrint("  %9.4f", c->courant);
  fflush(stdout);
  if (survey->request->csv[0]) CsvRow(&survey->csv, survey->scene, scheme, c);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalPrintSurvey(const MpmScene *scene, const MpmRequest *request)
{
  const MpmCriticalCase of     = MpmCriticalCaseOf(scene, request->tolerance);
  Survey                survey = {.scene = scene, .request = request};

  PetscFunctionBegin;
  if (request->csv[0]) PetscCall(CsvOpen(request->csv, &survey.csv));
  MpmPrint("largest %s Courant number c dt / h: ppc %" PetscInt_FMT
           ", offset %.6g, drift %.6g, xpic_order %" PetscInt_FMT ", blend_ratio %.6g\nscheme   transfer  ",
           MpmSceneDrifts(scene) ? "bounded (growth within tolerance)" : "stable", scene->layout.ppc[0],
           scene->layout.offset[0].value, scene->step.drift[0].value, scene->scheme.numbers.order,
           scene->scheme.numbers.ratio);
  for (PetscInt b = 0; MpmBases[b]; b++) MpmPrint("  %9s", MpmBases[b]->name);
  PetscCall(MpmCriticalSurvey(&of, PrintCell, &survey));
  MpmPrint("\n0: grows at every Courant number; none: no limit up to %.6g%s\n", MPM_CRITICAL_TO,
           survey.undecided ? "; ?: undecided, 'mpmstab critical' with that scheme says why" : "");
  if (request->csv[0]) PetscCall(MpmTextFileClose(&survey.csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}
