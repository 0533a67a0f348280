/*
   The task spectrum: eigenvalues of an operator, a verdict, and how norms grow. Of a scene it makes operator, symbol
   and march from the same table, and compares them; a matrix that was given has only its operator.
*/
#include "scene/layout.h"
#include "base/progress.h"
#include "base/text.h"
#include "linalg/eigen.h"
#include "linalg/singular.h"
#include "operator/nodal.h"
#include "analysis/lone.h"
#include "analysis/spectrum.h"
#include <math.h>
#include <sys/resource.h>

#define BESIDE 1e-10       /* relative distance of a shift from an eigenvalue */
#define AT_ONE 1e-6        /* rounding splits a defective pair at 1 by about 1e-8 */
#define AGREE 1e-6         /* largest mismatch of spectrum and symbol */
#define LEADING 4          /* modes of the report */
#define MEASURE_WORK 2e8   /* most particle-steps of the measured run */
#define MEASURE_STEPS 4000 /* steps of a run that does not grow */
#define MEASURE_FEWEST 100
#define MEASURE_MOST 1e5 /* particle-steps of one rank; more ranks take longer for a step of few particles */
#define MEASURE_EFOLDS 60
#define LONG_ORDER 2000 /* all eigenvalues of this order take about LONG_S seconds */
#define LONG_S 10.0

/*
   Finds the distance of each listed eigenvalue from the nearest amplification factor of the symbol, and keeps the
   largest.
*/
static PetscErrorCode Mismatch(MPI_Comm comm, MpmSpectrum *s)
{
  const PetscInt n = s->symbol->size * s->symbol->all;
  PetscReal     *factors, largest = 0;

  PetscFunctionBegin;
  PetscCall(MpmSymbolGatherFactors(comm, s->symbol, s->op->exponent, &factors));
  for (PetscInt j = 0; j < s->eigen->n; j++) {
    PetscReal nearest = PETSC_MAX_REAL;

    for (PetscInt i = 0; i < n; i++) {
      const PetscReal re = factors[2 * i] - s->eigen->re[j], im = factors[2 * i + 1] - s->eigen->im[j];

      nearest = PetscMin(nearest, re * re + im * im);
    }
    largest = PetscMax(largest, sqrt(nearest));
  }
  PetscCall(PetscFree(factors));
  if (s->eigen->n) s->symbol_mismatch = scalbn(largest, (int)s->op->exponent);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CountOnes(MpmSpectrum *s)
{
  PetscFunctionBegin;
  if (!s->eigen->complete || s->op->exponent) PetscFunctionReturn(PETSC_SUCCESS); /* rounding hides a 1 */
  s->at_one = 0;
  for (PetscInt j = 0; j < s->eigen->n; j++)
    if (hypot(scalbn(s->eigen->re[j], (int)s->op->exponent) - 1, scalbn(s->eigen->im[j], (int)s->op->exponent)) <=
        AT_ONE)
      s->at_one++;
  if (!s->scene || MpmSceneDrifts(s->scene) || !MpmFormulationKeepsUnseen(s->scene->scheme.formulation))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmModesNullity(s->op, &s->nullity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Looks for the symbol's leading modes in the operator. No matrix is factored. */
static PetscErrorCode SolveBloch(MpmSpectrum *s)
{
  PetscInt n;
  Vec     *vectors;

  PetscFunctionBegin;
  PetscCall(MpmBlochModesCreate(s->op, s->symbol, s->cells, &n, &vectors));
  PetscCall(MpmEigenRitz(s->op->balanced, n, vectors, &s->eigen));
  PetscCall(VecDestroyVecs(MPM_BLOCH_VECTORS, &vectors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The method that the operator allows. On a layout with a symbol all eigenvalues are those of its small blocks, and
   some of a large operator suffice. Else all of the nodes' operator are taken where its order n (0: there is none)
   allows it, and of a larger one the leftmost, where these decide. assembled: the particles' operator is a matrix,
   which has room for eigenvalues near a target. scene: NULL for a matrix that was given.
*/
static MpmEigenMethod MethodOf(const MpmScene *scene, PetscInt order, PetscInt n, PetscBool symbol, PetscBool assembled)
{
  const MpmEigenMethod method =
      MpmEigenChoose(n && !symbol ? n : order, symbol && assembled ? PETSC_TRUE : PETSC_FALSE);

  return method == MPM_EIGEN_LARGEST && n && !symbol && scene &&
                 MpmLeftmostDecides(&scene->layout, &scene->scheme, &scene->step)
             ? MPM_EIGEN_LEFTMOST
             : method;
}

/*
   Solves for eigenvalues of the nodes' operator, and where these are not enough for those of the particles'. What
   Krylov's method does not find in the smaller operator it does not find in the larger one.
*/
static PetscErrorCode SolveMatrix(MpmSpectrum *s, MpmEigenMethod method)
{
  PetscFunctionBegin;
  if (s->nodal) {
    PetscCall(MpmEigenSolveReduced(s->op->balanced, s->nodal, NULL, method, s->target, &s->eigen));
    if (method == MPM_EIGEN_LEFTMOST || (s->eigen->n && (method != MPM_EIGEN_DENSE || s->eigen->complete)))
      PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(MpmEigenDestroy(&s->eigen));
    PetscCall(MpmReducedDestroy(&s->nodal));
    method = MethodOf(s->scene, s->op->order, 0, s->symbol ? PETSC_TRUE : PETSC_FALSE, s->op->assembled);
  }
  PetscCall(MpmEigenSolve(s->op->balanced, NULL, method, s->target, &s->eigen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Solves with the method that the operator allows. Options that ask for a solver are followed. */
static PetscErrorCode SolveBest(MpmSpectrum *s)
{
  const PetscBool assembled = s->op->assembled, symbol = s->symbol ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal begin = MPI_Wtime();
  PetscBool       asked, bloch;
  PetscInt        n = 0;
  MpmEigenMethod  method;
  MpmProgress     progress;
  char            note[128];

  PetscFunctionBegin;
  PetscCall(MpmEigenAsked(&asked));
  bloch = symbol && !asked && (s->cells || MpmEigenChoose(s->op->order, symbol) == MPM_EIGEN_TARGET) ? PETSC_TRUE
                                                                                                     : PETSC_FALSE;
  if (s->request->nodal && s->scene && !bloch) PetscCall(MpmNodalMatrixOf(s->op, &s->nodal));
  if (s->nodal) PetscCall(MatGetSize(s->nodal->M, &n, NULL));
  method = assembled || s->scene ? MethodOf(s->scene, s->op->order, n, symbol, assembled) : MPM_EIGEN_LARGEST;
  if (!n) n = s->op->order;
  PetscCall(PetscSNPrintf(note, sizeof note, "solving: %s eigenvalues of order %" PetscInt_FMT,
                          method == MPM_EIGEN_DENSE ? "all" : "leading", n));
  if (method == MPM_EIGEN_DENSE && n > LONG_ORDER)
    PetscCall(PetscSNPrintf(note, sizeof note,
                            "all eigenvalues of order %" PetscInt_FMT ", about %.0f s (less by fewer cells)", n,
                            LONG_S * PetscPowReal((PetscReal)n / LONG_ORDER, 3)));
  PetscCall(MpmProgressBegin("", &progress));
  PetscCall(MpmProgressNote(&progress, note));
  if (bloch)
    PetscCall(SolveBloch(s));
  else
    PetscCall(SolveMatrix(s, method));
  s->eigen->solve_s = MPI_Wtime() - begin; /* with the nodes' operator, which the solution needs */
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Solve(MPI_Comm comm, MpmSpectrum *s)
{
  PetscFunctionBegin;
  if (s->symbol) PetscCall(MpmSymbolTarget(comm, s->symbol, s->op->exponent, s->target));
  for (int part = 0; part < 2; part++) s->target[part] *= 1 + BESIDE;
  PetscCall(SolveBest(s));
  for (PetscInt j = 0; j < s->eigen->n; j++) {
    if (!(hypot(s->eigen->re[j], s->eigen->im[j]) <= s->radius)) s->radius = hypot(s->eigen->re[j], s->eigen->im[j]);
    if (!(s->eigen->residual[j] <= s->max_residual)) s->max_residual = s->eigen->residual[j];
  }
  s->growth = MpmGrowthPerStep(s->radius, s->op->exponent, s->op->period);
  s->radius = scalbn(s->radius, (int)s->op->exponent);
  PetscCall(CountOnes(s));
  if (s->symbol) PetscCall(Mismatch(comm, s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal OperatorError(const MpmSpectrum *s)
{
  return MpmOperatorErrorOf(s->eigen->norm, s->step_mismatch, s->eigen->n ? s->eigen->residual[0] : 0);
}

/*
   Finds the condition number of the eigenvalue. On a uniform layout it is that of the symbol's block, in which +beta
   and -beta do not coincide. Otherwise it comes from a left vector, if the operator has transposed products.
*/
static PetscErrorCode Sensitivity(MpmSpectrum *s)
{
  MpmFinding *f = &s->finding;
  PetscBool   transposes;

  PetscFunctionBegin;
  f->uncertainty = 0;
  if (!(f->growth > 1 + f->tolerance) || isinf(f->growth)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatHasOperation(s->op->A, MATOP_MULT_TRANSPOSE, &transposes));
  if (s->symbol)
    s->condition = s->symbol->condition;
  else if (transposes)
    PetscCall(MpmEigenCondition(s->eigen, 0, &s->condition));
  if (s->symbol) f->uncertainty = s->symbol->uncertainty;
  if (s->eigen->n)
    f->uncertainty =
        PetscMax(f->uncertainty, MpmUncertaintyOf(f->growth,
                                                  (isnan(s->condition) ? 1 : s->condition) * OperatorError(s) /
                                                      hypot(s->eigen->re[0], s->eigen->im[0]),
                                                  s->op->period));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Whether growth could only be hidden at -1, and no eigenvalue is there. Rounding splits pairs at 1, but where the
   leftmost eigenvalues decide this is no growth. error: by which rounding may move a defective eigenvalue.
*/
static PetscBool HidesNoGrowth(const MpmSpectrum *s, PetscReal error)
{
  PetscReal least = INFINITY;

  if (!s->scene || !(s->eigen->complete || s->eigen->leftmost) ||
      !MpmLeftmostDecides(&s->scene->layout, &s->scene->scheme, &s->scene->step))
    return PETSC_FALSE;
  for (PetscInt j = 0; j < s->eigen->n; j++) least = PetscMin(least, s->eigen->re[j]);
  return least > error - 1 ? PETSC_TRUE : PETSC_FALSE;
}

/* Returns whether an eigenvalue was found where the symbol predicts one, and not just the eigenvalue 1 beside it. */
static PetscBool FoundTarget(const MpmSpectrum *s)
{
  const PetscReal away = hypot(s->target[0] - scalbn(1, -(int)s->op->exponent), s->target[1]);

  for (PetscInt j = 0; j < s->eigen->n; j++)
    if (hypot(s->eigen->re[j] - s->target[0], fabs(s->eigen->im[j]) - s->target[1]) <= AGREE * away) return PETSC_TRUE;
  return PETSC_FALSE;
}

/*
   Judges stability. All eigenvalues, or those of largest magnitude, decide by themselves. Eigenvalues near a target
   confirm the symbol, whose amplification factors are the whole spectrum. An eigenvalue above 1 + tolerance means
   unstable in any case. An operator that differs from the march cannot show stability; this happens for a period whose
   modes grow and decay beyond double precision.
*/
static PetscErrorCode Judge(MpmSpectrum *s)
{
  MpmFinding     *f      = &s->finding;
  const PetscBool agrees = s->symbol && s->symbol_mismatch <= AGREE * PetscMax(1, s->radius) && FoundTarget(s);
  const char     *evidence;
  char            seed[64];

  PetscFunctionBegin;
  f->tolerance = s->request->tolerance;
  f->growth    = s->growth;
  if (s->eigen->complete) {
    evidence = "all eigenvalues";
  } else if (s->eigen->nilpotent) {
    evidence = "the matrix is strictly triangular in some order of its unknowns, so that all eigenvalues are 0";
  } else if (!s->symbol && s->eigen->largest) {
    evidence = "eigenvalues of largest magnitude (no proof that none is larger)";
  } else if (!s->symbol && s->eigen->leftmost && s->growth >= 1) {
    evidence = "the leftmost eigenvalues; at rest this scheme grows by real ones below -1 alone";
  } else if (agrees && s->eigen->converged) {
    f->growth = s->symbol->growth;
    evidence  = "the symbol, confirmed by those of the operator's eigenvalues that were sought";
  } else {
    if (!(s->growth > 1 + f->tolerance)) f->growth = NAN;
    evidence = !isfinite(s->eigen->norm) ? "none, the operator's numbers leave the range of doubles"
               : s->eigen->n             ? "some eigenvalues, not enough for more"
                                         : "none, the solver did not converge (up to order 4096 all are found)";
  }
  PetscCall(PetscStrncpy(f->evidence, evidence, sizeof f->evidence));
  if (s->scene && s->scene->layout.jitter != 0 && s->eigen->n) {
    PetscCall(
        PetscSNPrintf(seed, sizeof seed, ", of this random layout (seed %" PetscInt64_FMT ")", s->scene->layout.seed));
    MpmTextJoin(f->evidence, seed, sizeof f->evidence);
  }
  PetscCall(Sensitivity(s));
  f->defective_error = s->symbol ? s->symbol->defective_error : 0;
  if (f->growth == s->growth)
    f->defective_error =
        PetscMax(f->defective_error, MpmDefectiveErrorOf(OperatorError(s), s->op->exponent, s->op->period));
  if (HidesNoGrowth(s, f->defective_error)) f->defective_error = 0;
  if (s->scene && !(s->step_mismatch <= MPM_MISMATCH)) f->defective_error = INFINITY;
  if (s->symbol && s->eigen->complete &&
      fabs(s->growth - s->symbol->growth) > f->tolerance * s->growth + f->uncertainty) { /* one is wrong */
    f->uncertainty = f->defective_error = INFINITY;
    MpmTextJoin(f->evidence, ", but the symbol says otherwise", sizeof f->evidence);
  }
  f->verdict = MpmVerdictOf(f);
  if (s->symbol && MpmPredictDisagrees(&s->comparison, s->symbol->growth))
    PetscCall(MpmFindingDispute(f, "the corrected closed form says otherwise"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Measures growth of random data, which excite every mode. It takes as many steps as show the growth, and no run when
   that is too much work.
*/
static PetscErrorCode Measure(MpmSpectrum *s)
{
  const PetscReal room  = MEASURE_WORK / (PetscReal)s->scene->layout.particles;
  PetscReal       steps = MEASURE_STEPS;

  PetscFunctionBegin;
  if (s->finding.growth > 1 + s->request->tolerance) steps = PetscMax(steps, MEASURE_EFOLDS / log(s->finding.growth));
  steps = PetscMin(PetscMin(steps, room), MEASURE_MOST / s->ranks);
  if (!s->request->measure || steps < MEASURE_FEWEST) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmRunRandom(s->scene, (PetscInt64)steps, s->request->tolerance, &s->run));
  if (s->finding.verdict == MPM_STABLE && s->run->verdict == MPM_UNSTABLE) { /* operator or march is wrong */
    s->finding.verdict = MPM_UNDECIDED;
    MpmTextJoin(s->finding.evidence, ", but the march grows", sizeof s->finding.evidence);
  }
  if (!isfinite(s->eigen->norm) && s->run->lost) {
    s->finding.verdict = MPM_UNSTABLE;
    MpmTextJoin(s->finding.evidence, "; one step of the march does too", sizeof s->finding.evidence);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Norms of powers, by the nodes' operator where there is one. A search among modes of the symbol has made none. */
static PetscErrorCode Powers(MpmSpectrum *s, PetscReal growth)
{
  MpmReduced *nodal = NULL;

  PetscFunctionBegin;
  if (!s->nodal && s->scene && s->request->nodal) PetscCall(MpmNodalMatrixOf(s->op, &nodal));
  PetscCall(MpmTransientCreate(s->op, s->nodal ? s->nodal : nodal, s->request->powers, growth, &s->transient));
  PetscCall(MpmReducedDestroy(&nodal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes norms of powers. Where the verdict counts the growth as 1, they are compared with 1. */
static PetscErrorCode Transient(MpmSpectrum *s)
{
  const PetscReal tolerance = s->finding.tolerance;
  const PetscReal growth    = fabs(s->finding.growth - 1) <= tolerance ? 1 : s->finding.growth;
  PetscReal       norm;
  Mat             weighed, A;

  PetscFunctionBegin;
  if (!isfinite(s->eigen->norm)) PetscFunctionReturn(PETSC_SUCCESS);
  if (s->request->powers) PetscCall(Powers(s, growth));
  if (!s->request->pseudospectrum) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmOperatorWeigh(s->op, s->op->A, &weighed));
  PetscCall(MatDuplicate(weighed, MAT_COPY_VALUES, &A));
  PetscCall(MatScale(A, scalbn(1, (int)s->op->exponent)));
  PetscCall(MatNorm(A, NORM_INFINITY, &norm));
  if (isfinite(norm))
    PetscCall(MpmPseudospectrumCreate(A, s->request->pseudospectrum, pow(1 + tolerance, s->op->period) - 1,
                                      &s->pseudospectrum));
  PetscCall(MatDestroy(&A));
  PetscCall(MatDestroy(&weighed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sums the largest resident size of this program over its ranks. */
static PetscErrorCode PeakMemory(MPI_Comm comm, PetscReal *bytes)
{
  struct rusage usage;

  PetscFunctionBegin;
  PetscCheck(!getrusage(RUSAGE_SELF, &usage), PETSC_COMM_SELF, PETSC_ERR_SYS, "getrusage failed");
  *bytes = 1024.0 * (PetscReal)usage.ru_maxrss;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bytes, 1, MPIU_REAL, MPI_SUM, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WhyNotNodal(const MpmScene *scene, const MpmRequest *request, const char **why)
{
  PetscInt64    unknowns;
  MpmNodalPlan *plan;

  PetscFunctionBegin;
  PetscCall(MpmNodalPlanCreate(scene->scheme.table, why, &plan));
  PetscCall(MpmNodalPlanDestroy(&plan));
  if (MpmSceneDrifts(scene))
    *why = "particles move";
  else if (!strcmp(request->task, "critical") && !MpmSymbolWhyNot(&scene->layout))
    *why = "the limit of a uniform layout is that of its symbol";
  if (*why) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmNodalMatrixUnknowns(&scene->layout, &scene->scheme, &scene->step, &unknowns));
  if (!unknowns) *why = "the nodes have as many unknowns as the particles";
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalChoiceCheck(const MpmScene *scene, const MpmRequest *request)
{
  const char *why;

  PetscFunctionBegin;
  if (!request->nodal_asked) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(WhyNotNodal(scene, request, &why));
  MpmCheckInput(!why, "-nodal %s: nothing reads it in this scene: %s; allowed: without it",
                request->nodal ? "true" : "false", why);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses options of the solvers, and too many unknowns, before the work. SLEPc reads its options when it solves. */
static PetscErrorCode TryOptions(const char what[], const MpmScene *scene, PetscInt64 order, PetscInt64 nodal,
                                 const MpmRequest *request)
{
  const PetscBool symbol = scene && !MpmSymbolWhyNot(&scene->layout) ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(MpmEigenTryOptions(
      MethodOf(scene, (PetscInt)PetscMin(order, PETSC_MAX_INT), (PetscInt)nodal, symbol, PETSC_TRUE)));
  if (request->pseudospectrum) PetscCall(MpmPseudospectrumCheck(what, order));
  if (request->powers) PetscCall(MpmSingularTryOptions());
  PetscCall(MpmEigenRefuseUnread());
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Begin(const MpmRequest *request, MpmSpectrum **spectrum)
{
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(PetscNew(spectrum));
  s             = *spectrum;
  s->request    = request;
  s->comparison = (MpmComparison){.published = NAN, .published_beta = NAN, .corrected = NAN};
  s->radius = s->growth = s->max_residual = s->step_mismatch = s->symbol_mismatch = s->condition = NAN;
  s->at_one = s->nullity = MPM_UNCOUNTED;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &s->ranks));
  PetscCall(PeakMemory(PETSC_COMM_WORLD, &s->before));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Makes what a scene has and an operator alone has not: symbol, closed forms, and the march that it is checked against.
*/
static PetscErrorCode Compare(MPI_Comm comm, MpmSpectrum *s)
{
  const MpmScene *scene = s->scene;

  PetscFunctionBegin;
  PetscCall(MpmPredict(scene, &s->predictions));
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, MpmSceneDrifts(scene), NULL, &s->predictor));
  if (!MpmSymbolWhyNot(&scene->layout)) {
    MpmSymbolWish wish = {.keep = PETSC_TRUE, .tolerance = s->request->tolerance};

    for (PetscInt a = 0; a < scene->layout.dim; a++) wish.phases[a] = scene->layout.grid[a].cells;
    PetscCall(MpmSymbolCreate(comm, &scene->layout, &scene->scheme, &scene->step, &wish, &s->symbol));
    PetscCall(MpmPredictCompare(comm, &s->predictor, s->symbol, &s->comparison));
  }
  PetscCall(MpmOperatorMismatch(s->op, &s->step_mismatch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Asks what can be asked of an operator. */
static PetscErrorCode Finish(MPI_Comm comm, PetscReal started, MpmSpectrum *s)
{
  PetscFunctionBegin;
  PetscCall(Solve(comm, s));
  PetscCall(Judge(s));
  if (s->scene) PetscCall(Measure(s));
  PetscCall(Transient(s));
  if (s->scene && s->scene->layout.dim > 1) PetscCall(MpmModesCreate(s->op, s->eigen, LEADING, &s->leading));
  PetscCall(PeakMemory(comm, &s->memory));
  s->memory -= s->before;
  s->wall_s = MPI_Wtime() - started;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSpectrumCreate(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                 MpmSpectrum **spectrum)
{
  const MPI_Comm   comm  = PETSC_COMM_WORLD;
  const PetscInt64 order = scene->scheme.table->nstate * scene->layout.particles;
  PetscInt64       nodal = 0;
  char             size[MPM_SIZE_TEXT];
  MpmSpectrum     *s;

  PetscFunctionBegin;
  PetscCall(MpmNodalChoiceCheck(scene, request));
  MpmLayoutSizeText(&scene->layout, sizeof size, size);
  if (request->nodal) PetscCall(MpmNodalMatrixUnknowns(&scene->layout, &scene->scheme, &scene->step, &nodal));
  PetscCall(TryOptions(size, scene, order, nodal, request));
  PetscCall(Begin(request, spectrum));
  s        = *spectrum;
  s->scene = scene;
  PetscCall(MpmOperatorCreate(comm, &scene->layout, &scene->scheme, &scene->step, &s->op));
  PetscCall(Compare(comm, s));
  PetscCall(Finish(comm, started, s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The symbol of a lattice at the phases of its waves. */
static PetscErrorCode TakeCells(const MpmBlochCells *cells, MpmSpectrum *s)
{
  MpmSymbolWish wish = {.keep = PETSC_TRUE, .tolerance = s->request->tolerance};

  PetscFunctionBegin;
  s->cells = cells;
  PetscCall(PetscArraycpy(wish.phases, cells->cells, MPM_MAX_DIM));
  PetscCall(MpmSymbolFromSource(PETSC_COMM_WORLD, &cells->source, &wish, &s->symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSpectrumOfMatrix(const char what[], Mat A, PetscInt period, const MpmBlochCells *cells,
                                   const MpmRequest *request, PetscReal started, MpmSpectrum **spectrum)
{
  PetscInt order;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &order, NULL));
  PetscCall(TryOptions(what, NULL, order, 0, request));
  MpmCheckInput(!request->powers || request->powers >= period,
                "-powers %" PetscInt_FMT ": %s covers %" PetscInt_FMT " steps, and its powers whole multiples of them; "
                "allowed: at least %" PetscInt_FMT,
                request->powers, what, period, period);
  PetscCall(Begin(request, spectrum));
  PetscCall(MpmOperatorFromMatrix(A, period, &(*spectrum)->op));
  if (cells) PetscCall(TakeCells(cells, *spectrum));
  PetscCall(Finish(PETSC_COMM_WORLD, started, *spectrum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the tangent of one step of a nonlinear run ---- */

/* The spectrum of a tangent, which it destroys. */
static PetscErrorCode SolveTangent(const MpmRequest *request, PetscReal started, Mat *tangent, MpmSpectrum **spectrum)
{
  Mat matrix;

  PetscFunctionBegin;
  PetscCall(MpmTangentAssemble(*tangent, &matrix));
  PetscCall(MatDestroy(tangent));
  PetscCall(MpmSpectrumOfMatrix("the tangent", matrix, 1, NULL, request, started, spectrum));
  PetscCall(MatDestroy(&matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where particles stand on the yield surface: the spectrum of the branch that grows more, and what is said of both. */
static PetscErrorCode OfBranches(MpmTangentSpace *space, PetscReal courant, const MpmTangentState *state,
                                 const MpmRequest *request, PetscReal started, MpmSpectrum **spectrum)
{
  static const MpmBranch branch[2] = {MPM_BRANCH_LOADING, MPM_BRANCH_UNLOADING};
  MpmSpectrum           *of[2];
  char                   text[256];
  PetscInt               larger;
  Mat                    tangent;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 2; i++) {
    space->branch = branch[i];
    PetscCall(MpmTangentOf(space, courant, state, &tangent, NULL));
    PetscCall(SolveTangent(request, started, &tangent, &of[i]));
  }
  larger = of[1]->finding.growth > of[0]->finding.growth ? 1 : 0;
  PetscCall(PetscSNPrintf(text, sizeof text,
                          "; %" PetscInt64_FMT " particles stand on the yield surface: growth %.9g loading, %.9g "
                          "unloading, and %s counts",
                          space->on_surface, of[0]->finding.growth, of[1]->finding.growth,
                          MpmBranchNames[branch[larger]]));
  *spectrum = of[larger];
  PetscCall(MpmSpectrumDestroy(&of[1 - larger]));
  MpmTextJoin((*spectrum)->finding.evidence, text, sizeof(*spectrum)->finding.evidence);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFrozenSpectrum(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                 MpmSpectrum **spectrum, PetscReal *mismatch)
{
  MpmMarch       *march;
  MpmTangentSpace space;
  MpmTangentState state;
  MpmFinding     *finding;
  Mat             tangent;

  PetscFunctionBegin;
  PetscCall(MpmLayoutCheckMemory(PETSC_COMM_WORLD, &scene->layout, MpmMarchBytes(scene, PETSC_FALSE), "the march"));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  while (march->step < request->at_step && !march->failure[0]) PetscCall(MpmMarchStep(march));
  MpmCheckInput(!march->failure[0], "-at_step %" PetscInt64_FMT ": the run ends before it, %s", request->at_step,
                march->failure);
  PetscCall(MpmTangentSpaceCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &space));
  PetscCall(MpmTangentStateCreate(&space, &state));
  PetscCall(MpmTangentStateOf(&space, march, &state));
  PetscCall(MpmTangentCheck(&space, &state));
  PetscCall(MpmTangentMismatch(&space, march, &tangent, mismatch));
  if (space.on_surface > 0) {
    PetscCall(MatDestroy(&tangent));
    PetscCall(OfBranches(&space, march->courant, &state, request, started, spectrum));
  } else
    PetscCall(SolveTangent(request, started, &tangent, spectrum));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmTangentStateDestroy(&space, &state));
  PetscCall(MpmTangentSpaceDestroy(&space));
  finding = &(*spectrum)->finding;
  if (!(*mismatch <= MPM_MISMATCH)) {
    finding->verdict = MPM_UNDECIDED;
    MpmTextJoin(finding->evidence, ", but the tangent's step is not the march's", sizeof finding->evidence);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSpectrumDestroy(MpmSpectrum **spectrum)
{
  MpmSpectrum *s = *spectrum;

  PetscFunctionBegin;
  if (s->scene) PetscCall(MpmPredictorDestroy(&s->predictor));
  if (s->run) PetscCall(MpmRunDestroy(&s->run));
  PetscCall(MpmTransientDestroy(&s->transient));
  PetscCall(MpmPseudospectrumDestroy(&s->pseudospectrum));
  PetscCall(MpmModesDestroy(&s->leading));
  PetscCall(MpmEigenDestroy(&s->eigen));
  PetscCall(MpmReducedDestroy(&s->nodal));
  PetscCall(MpmOperatorDestroy(&s->op));
  if (s->symbol) PetscCall(MpmSymbolDestroy(&s->symbol));
  PetscCall(PetscFree(*spectrum));
  PetscFunctionReturn(PETSC_SUCCESS);
}
