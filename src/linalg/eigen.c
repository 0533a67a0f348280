/*
   The eigenvalue problem A x = lambda x for SLEPc: this file chooses the solver, keeps those results that are
   eigenpairs, and sorts them.
*/
#include "linalg/eigen.h"
#include "linalg/eigen_parts.h"
#include "base/errors_private.h"
#include <math.h>

#define DENSE_ORDER 4096
#define LARGEST 2 /* eigenvalues sought of largest magnitude, or of least real part */
#define LEFTMOST_TOLERANCE 1e-8
#define BASIS 64 /* vectors of the Krylov space; fewer do not separate neighbours on the spectrum's edge */
#define RESTARTS 200
#define PENCIL_TOLERANCE 1e-11
#define PENCIL_REAL 1e-9 /* an eigenvalue with a smaller share of imaginary part is real but for rounding */
#define WORK 8e7         /* order x restarts: about five minutes */
#define LEFT_BESIDE 1e-7 /* relative distance of the shift for a left vector from its eigenvalue */
#define ACCEPTED 1e-7    /* largest residual of a listed pair */
#define LEFT_FOUND 1e-6  /* largest distance, over norm(A), between the eigenvalues of A and of A transposed */

MpmEigenMethod MpmEigenChoose(PetscInt order, PetscBool has_symbol)
{
  if (order <= DENSE_ORDER) return MPM_EIGEN_DENSE;
  return has_symbol ? MPM_EIGEN_TARGET : MPM_EIGEN_LARGEST;
}

static PetscErrorCode SetMethod(EPS eps, MpmEigenMethod method, PetscInt order)
{
  PetscErrorCode error;
  MpmText        given = {NULL, 0};

  PetscFunctionBegin;
  PetscCall(EPSSetProblemType(eps, EPS_NHEP));
  if (method == MPM_EIGEN_TARGET) {
    PetscCall(MpmEigenTargetSet(eps, RESTARTS));
  } else if (method == MPM_EIGEN_DENSE) {
    PetscCall(EPSSetType(eps, EPSLAPACK));
    PetscCall(EPSSetDimensions(eps, order, PETSC_DETERMINE, PETSC_DETERMINE));
  } else {
    PetscCall(EPSSetType(eps, EPSKRYLOVSCHUR));
    PetscCall(EPSSetWhichEigenpairs(eps, method == MPM_EIGEN_LEFTMOST ? EPS_SMALLEST_REAL : EPS_LARGEST_MAGNITUDE));
    PetscCall(EPSSetDimensions(eps, LARGEST, PetscMin(BASIS, order), PETSC_DETERMINE));
    PetscCall(EPSSetTolerances(eps, method == MPM_EIGEN_LEFTMOST ? LEFTMOST_TOLERANCE : 1e-10,
                               (PetscInt)PetscMin(RESTARTS, PetscMax(20, WORK / order))));
  }
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  error = EPSSetFromOptions(eps);
  PetscCall(PetscPopErrorHandler());
  if (error) {
    PetscCall(MpmErrorsGivenOptions(&given));
    error = MpmRefusal("-eps_*, -st_*: SLEPc refuses one of them, given: %s; allowed: see its manual pages",
                       given.text ? given.text : "none");
    MpmTextFree(&given);
    PetscCall(error);
  }
  if (method == MPM_EIGEN_TARGET) PetscCall(MpmEigenTargetBasis(eps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSolver(Mat T, const char prefix[], MpmEigenMethod method, EPS *eps)
{
  PetscInt order;

  PetscFunctionBegin;
  PetscCall(MatGetSize(T, &order, NULL));
  PetscCall(EPSCreate(PetscObjectComm((PetscObject)T), eps));
  PetscCall(EPSSetOperators(*eps, T, NULL));
  PetscCall(EPSSetOptionsPrefix(*eps, prefix));
  PetscCall(SetMethod(*eps, method, order));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenTryOptions(MpmEigenMethod method)
{
  Mat identity;
  EPS eps;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, 2, 2, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, &identity));
  PetscCall(MatAssemblyBegin(identity, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(identity, MAT_FINAL_ASSEMBLY));
  PetscCall(MatShift(identity, 1)); /* the smallest matrix that every rank has rows of */
  PetscCall(CreateSolver(identity, NULL, method, &eps));
  PetscCall(EPSDestroy(&eps));
  PetscCall(MatDestroy(&identity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is read only while a solver solves, or by solvers inside it. */
static PetscBool IsReadLater(const char name[])
{
  static const char *const parts[] = {"_view", "_monitor", "_reason", "_error", "mat_", "ksp_", "pc_", "sub_"};

  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(parts); i++)
    if (strstr(name, parts[i])) return PETSC_TRUE;
  return PETSC_FALSE;
}

static const char *const families[] = {"eps_", "st_", "bv_", "ds_", "svd_"};

PetscErrorCode MpmEigenAsked(PetscBool *asked)
{
  char *given;

  PetscFunctionBegin;
  *asked = PETSC_FALSE;
  PetscCall(PetscOptionsGetAll(NULL, &given));
  for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(families); f++) {
    char name[16];

    PetscCall(PetscSNPrintf(name, sizeof name, "-%s", families[f]));
    if (strstr(given, name)) *asked = PETSC_TRUE;
  }
  PetscCall(PetscFree(given));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenRefuseUnread(void)
{
  PetscInt n;
  char   **names, **values;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &n, &names, &values));
  for (PetscInt i = 0; i < n; i++)
    for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(families); f++)
      MpmCheckInput(strncmp(names[i], families[f], strlen(families[f])) || IsReadLater(names[i]),
                    "unknown option -%.200s; no solver of this task reads it; allowed: see SLEPc's manual pages",
                    names[i]);
  PetscCall(PetscOptionsLeftRestore(NULL, &n, &names, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes which LU is used, such as " (LU: mumps)", or nothing where there is none. */
static PetscErrorCode DescribeFactors(ST st, size_t room, char factors[])
{
  KSP           ksp;
  PC            pc;
  MatSolverType lu;
  PetscBool     is_lu;

  PetscFunctionBegin;
  PetscCall(STGetKSP(st, &ksp));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCLU, &is_lu));
  PetscCall(PCFactorGetMatSolverType(pc, &lu));
  factors[0] = '\0';
  if (is_lu && lu) PetscCall(PetscSNPrintf(factors, room, " (LU: %s)", lu));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Describes in one line what the solver did. */
static PetscErrorCode Describe(MpmEigen *e, MpmEigenMethod method, const PetscReal target[2], PetscInt found)
{
  EPSType type;
  STType  transform;
  ST      st;
  char    near[64] = "", factors[32];

  PetscFunctionBegin;
  PetscCall(EPSGetType(e->eps, &type));
  PetscCall(EPSGetST(e->eps, &st));
  PetscCall(STGetType(st, &transform));
  PetscCall(DescribeFactors(st, sizeof factors, factors));
  if (method == MPM_EIGEN_TARGET)
    PetscCall(
        PetscSNPrintf(near, sizeof near, " near %.9g %s %.9gi", target[0], target[1] < 0 ? "-" : "+", fabs(target[1])));
  if (!strcmp(transform, STSHIFT)) {
    transform  = NULL;
    factors[0] = '\0';
  }
  PetscCall(PetscSNPrintf(e->solver, sizeof e->solver, "%s%s%s%s%s, %" PetscInt_FMT " found%s", type,
                          transform ? " with " : "", transform ? transform : "", factors, near, found,
                          e->failed ? ", the solver failed" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The residual of x = x[0] + i x[1] as MpmEigen has it. r is work space. */
static PetscErrorCode Residual(const MpmEigen *e, PetscReal re, PetscReal im, Vec x[2], Vec r, PetscReal *residual)
{
  PetscReal norm[2], rest[2];

  PetscFunctionBegin;
  for (int part = 0; part < 2; part++) {
    PetscCall(VecNorm(x[part], NORM_2, &norm[part]));
    PetscCall(MatMult(e->A, x[part], r));
    PetscCall(VecAXPBYPCZ(r, -re, part ? -im : im, 1, x[part], x[1 - part]));
    PetscCall(VecNorm(r, NORM_2, &rest[part]));
  }
  *residual = hypot(rest[0], rest[1]) / ((e->norm > 0 ? e->norm : 1) * hypot(norm[0], norm[1])); /* 0: A is zero */
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenVector(const MpmEigen *e, PetscInt j, Vec re, Vec im)
{
  PetscReal norm[2];

  PetscFunctionBegin;
  if (e->nilpotent) {
    PetscCall(VecZeroEntries(re));
    PetscCall(VecZeroEntries(im));
    PetscCall(VecSetValue(re, e->unit, 1, INSERT_VALUES));
    PetscCall(VecAssemblyBegin(re));
    PetscCall(VecAssemblyEnd(re));
  } else if (e->vector) {
    PetscCall(e->vector(e, j, re, im));
  } else if (e->ritz) {
    PetscInt n;

    PetscCall(BVGetActiveColumns(e->ritz, NULL, &n));
    PetscCall(BVMultVec(e->ritz, 1, 0, re, e->coefficients + 2 * n * e->place[j]));
    PetscCall(BVMultVec(e->ritz, 1, 0, im, e->coefficients + 2 * n * e->place[j] + n));
  } else if (e->dense_re) {
    PetscCall(MpmEigenDenseVector(e->dense, e->dense_im, e->place[j], re, im));
  } else
    PetscCall(EPSGetEigenpair(e->eps, e->place[j], NULL, NULL, re, im));
  PetscCall(VecNorm(re, NORM_2, &norm[0]));
  PetscCall(VecNorm(im, NORM_2, &norm[1]));
  PetscCall(VecScale(re, 1 / hypot(norm[0], norm[1])));
  PetscCall(VecScale(im, 1 / hypot(norm[0], norm[1])));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Sort(MpmEigen *e)
{
  PetscReal *key, *old;
  PetscInt  *order;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(e->n, &key, e->n, &order, 3 * e->n, &old));
  for (PetscInt j = 0; j < e->n; j++) {
    const PetscReal size = hypot(e->re[j], e->im[j]), angle = fabs(atan2(e->im[j], e->re[j]));

    order[j]          = j;
    key[j]            = -size + 1e-9 * size * angle - (e->im[j] > 0 ? 1e-12 * size : 0);
    old[j]            = e->re[j];
    old[e->n + j]     = e->im[j];
    old[2 * e->n + j] = e->residual[j];
  }
  PetscCall(PetscSortRealWithArrayInt(e->n, key, order));
  for (PetscInt j = 0; j < e->n; j++) {
    e->re[j]       = old[order[j]];
    e->im[j]       = old[e->n + order[j]];
    e->residual[j] = old[2 * e->n + order[j]];
  }
  for (PetscInt j = 0; j < e->n; j++) order[j] = e->place[order[j]];
  PetscCall(PetscArraycpy(e->place, order, e->n));
  PetscCall(PetscFree3(key, order, old));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenListBegin(MpmEigen *e, PetscInt room)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc4(room, &e->re, room, &e->im, room, &e->residual, room, &e->place));
  PetscCall(MatCreateVecs(e->A, &e->work[0], &e->work[1]));
  PetscCall(VecDuplicate(e->work[0], &e->work[2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenTry(MpmEigen *e, PetscInt place, PetscReal re, PetscReal im, PetscReal rest, PetscBool *listed)
{
  PetscFunctionBegin;
  e->place[e->n] = place;
  if (isnan(rest)) {
    PetscCall(MpmEigenVector(e, e->n, e->work[0], e->work[1]));
    PetscCall(Residual(e, re, im, e->work, e->work[2], &rest));
  }
  *listed = rest <= ACCEPTED ? PETSC_TRUE : PETSC_FALSE;
  if (!*listed) PetscFunctionReturn(PETSC_SUCCESS);
  e->re[e->n]         = re;
  e->im[e->n]         = im;
  e->residual[e->n++] = rest;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenListEnd(MpmEigen *e)
{
  PetscFunctionBegin;
  for (int i = 0; i < 3; i++) PetscCall(VecDestroy(&e->work[i]));
  PetscCall(Sort(e));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps those candidates that are eigenpairs. */
static PetscErrorCode List(MpmEigen *e, PetscInt candidates, const PetscReal re[], const PetscReal im[])
{
  PetscBool listed;

  PetscFunctionBegin;
  PetscCall(MpmEigenListBegin(e, candidates));
  for (PetscInt i = 0; i < candidates; i++) PetscCall(MpmEigenTry(e, i, re[i], im[i], NAN, &listed));
  PetscCall(MpmEigenListEnd(e));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists those that Rayleigh-Ritz finds on the space of given vectors and their images. */
static PetscErrorCode ListRitz(MpmEigen *e, PetscInt given, Vec vectors[])
{
  PetscReal *re, *im;
  PetscInt   n;

  PetscFunctionBegin;
  PetscCall(MpmRitzExtract(e->A, given, vectors, &e->ritz, &n, &re, &im, &e->coefficients));
  PetscCall(List(e, n, re, im));
  PetscCall(PetscFree2(re, im));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The eigenvectors of T, real and imaginary parts, span with their images a space that A maps to itself. */
static PetscErrorCode CollectTarget(MpmEigen *e)
{
  PetscInt pairs;
  Vec      x, *vectors;

  PetscFunctionBegin;
  PetscCall(EPSGetConverged(e->eps, &pairs));
  PetscCall(MatCreateVecs(e->A, &x, NULL));
  PetscCall(VecDuplicateVecs(x, PetscMax(1, 2 * pairs), &vectors));
  for (PetscInt i = 0; i < pairs; i++)
    PetscCall(EPSGetEigenpair(e->eps, i, NULL, NULL, vectors[2 * i], vectors[2 * i + 1]));
  PetscCall(ListRitz(e, 2 * pairs, vectors));
  PetscCall(VecDestroyVecs(PetscMax(1, 2 * pairs), &vectors));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Collect(MpmEigen *e, MpmEigenMethod method, PetscInt found)
{
  PetscReal *re, *im;

  PetscFunctionBegin;
  if (method == MPM_EIGEN_TARGET) {
    PetscCall(CollectTarget(e));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (e->dense_re) { /* not e->dense, which is NULL on a rank without rows */
    PetscCall(List(e, found, e->dense_re, e->dense_im));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscMalloc2(found, &re, found, &im));
  for (PetscInt i = 0; i < found; i++) PetscCall(EPSGetEigenvalue(e->eps, i, &re[i], &im[i]));
  PetscCall(List(e, found, re, im));
  PetscCall(PetscFree2(re, im));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SolveDense(MpmEigen *e, PetscInt *found)
{
  PetscFunctionBegin;
  *found    = 0;
  e->failed = PETSC_TRUE;
  if (!isfinite(e->norm)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc2(e->order, &e->dense_re, e->order, &e->dense_im));
  PetscCall(MpmEigenDenseSolve(e->A, e->dense_re, e->dense_im, &e->dense, &e->failed));
  *found = e->failed ? 0 : e->order;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Solves. A factorization that breaks down leaves the verdict open; it does not end the task. */
static PetscErrorCode SolveOrFail(MpmEigen *e, PetscInt *found)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  error = isfinite(e->norm) ? EPSSolve(e->eps) : PETSC_ERR_FP;
  PetscCall(PetscPopErrorHandler());
  e->failed = error ? PETSC_TRUE : PETSC_FALSE;
  *found    = 0;
  if (!error) PetscCall(EPSGetConverged(e->eps, found));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds whether the solver, with its options, looked for these eigenvalues of the matrix itself. */
static PetscErrorCode Sought(EPS eps, EPSWhich those, PetscBool *sought)
{
  EPSWhich    which;
  ST          st;
  PetscScalar shift;
  PetscBool   plain;

  PetscFunctionBegin;
  PetscCall(EPSGetWhichEigenpairs(eps, &which));
  PetscCall(EPSGetST(eps, &st));
  PetscCall(PetscObjectTypeCompare((PetscObject)st, STSHIFT, &plain));
  PetscCall(STGetShift(st, &shift));
  *sought = which == those && plain && shift == 0 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenNorm(Mat A, PetscReal *norm)
{
  PetscBool virtual;
  Mat of = A;

  PetscFunctionBegin;
  PetscCall(PetscObjectTypeCompare((PetscObject)A, MATTRANSPOSEVIRTUAL, &virtual));
  if (virtual) PetscCall(MatTransposeGetMat(A, &of));
  PetscCall(MatNorm(of, NORM_INFINITY, norm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lists the one eigenvalue of a matrix that is strictly triangular in some order of its unknowns. */
static PetscErrorCode ListNilpotent(MpmEigen *e)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc4(1, &e->re, 1, &e->im, 1, &e->residual, 1, &e->place));
  e->n         = 1;
  e->complete  = e->order == 1 ? PETSC_TRUE : PETSC_FALSE;
  e->converged = e->largest = e->leftmost = PETSC_TRUE;
  PetscCall(PetscStrncpy(e->solver, "none: strictly triangular in some order of its unknowns", sizeof e->solver));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenSolve(Mat A, const char prefix[], MpmEigenMethod method, const PetscReal target[2],
                             MpmEigen **eigen)
{
  const PetscReal begin = MPI_Wtime();
  Mat             T     = A;
  PetscInt        found, wanted;
  PetscBool       all, dense = PETSC_FALSE;
  MpmEigen       *e;

  PetscFunctionBegin;
  PetscCall(PetscNew(eigen));
  e    = *eigen;
  e->A = A;
  PetscCall(MatGetSize(A, &e->order, NULL));
  PetscCall(MpmEigenNorm(A, &e->norm));
  if (method == MPM_EIGEN_TARGET) PetscCall(MpmRitzMatrix(A, target, &T));
  PetscCall(CreateSolver(T, prefix, method, &e->eps));
  if (method == MPM_EIGEN_LARGEST) PetscCall(MpmNilpotentFind(A, &e->unit));
  e->nilpotent = method == MPM_EIGEN_LARGEST && e->unit >= 0 ? PETSC_TRUE : PETSC_FALSE;
  if (e->nilpotent) {
    PetscCall(ListNilpotent(e));
    e->solve_s = MPI_Wtime() - begin;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (method == MPM_EIGEN_DENSE) PetscCall(MpmEigenDenseIsPlain(e->eps, &dense));
  PetscCall(dense ? SolveDense(e, &found) : SolveOrFail(e, &found));
  PetscCall(EPSGetDimensions(e->eps, &wanted, NULL, NULL));
  e->converged = !e->failed && found >= PetscMin(wanted, e->order) ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(Describe(e, method, target, found));
  PetscCall(Collect(e, method, found));
  all = e->converged && T == A && e->n == found ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(Sought(e->eps, EPS_LARGEST_MAGNITUDE, &e->largest));
  PetscCall(Sought(e->eps, EPS_SMALLEST_REAL, &e->leftmost));
  if (!all) e->largest = e->leftmost = PETSC_FALSE;
  e->complete = e->n == e->order ? PETSC_TRUE : PETSC_FALSE;
  if (T != A) PetscCall(MatDestroy(&T));
  e->solve_s = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenRitz(Mat A, PetscInt given, Vec vectors[], MpmEigen **eigen)
{
  const PetscReal begin = MPI_Wtime();
  MpmEigen       *e;

  PetscFunctionBegin;
  PetscCall(PetscNew(eigen));
  e    = *eigen;
  e->A = A;
  PetscCall(MatGetSize(A, &e->order, NULL));
  PetscCall(MatNorm(A, NORM_INFINITY, &e->norm));
  e->failed = isfinite(e->norm) ? PETSC_FALSE : PETSC_TRUE;
  PetscCall(ListRitz(e, e->failed ? 0 : given, vectors));
  e->converged = e->n > 0 ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(PetscSNPrintf(e->solver, sizeof e->solver,
                          "Rayleigh-Ritz on %" PetscInt_FMT " vectors and their images, %" PetscInt_FMT " found", given,
                          e->n));
  e->solve_s = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenDestroy(MpmEigen **eigen)
{
  PetscFunctionBegin;
  if (!*eigen) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree4((*eigen)->re, (*eigen)->im, (*eigen)->residual, (*eigen)->place));
  PetscCall(PetscFree((*eigen)->coefficients));
  PetscCall(PetscFree2((*eigen)->dense_re, (*eigen)->dense_im));
  PetscCall(PetscFree((*eigen)->dense));
  PetscCall(MpmEigenDestroy(&(*eigen)->small));
  PetscCall(BVDestroy(&(*eigen)->ritz));
  PetscCall(EPSDestroy(&(*eigen)->eps));
  PetscCall(PetscFree(*eigen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Seeks an eigenvector of the matrix transposed next to a listed eigenvalue, y = y[0] + i y[1]. found: whether there is
   one. The left vector of a smaller matrix is lifted by Z^T.
*/
static PetscErrorCode LeftVector(const MpmEigen *e, PetscInt j, Vec y[2], PetscBool *found)
{
  const PetscReal target[2] = {e->re[j] * (1 + LEFT_BESIDE), e->im[j] * (1 + LEFT_BESIDE)};
  const Mat       A         = e->reduced ? e->reduced->M : e->A;
  PetscReal       nearest   = PETSC_MAX_REAL;
  PetscInt        match     = 0;
  PetscBool       shell;
  Mat             transposed;
  MpmEigen       *left;
  Vec             z[2];

  PetscFunctionBegin;
  PetscCall(PetscObjectTypeCompare((PetscObject)A, MATSHELL, &shell));
  PetscCall(shell ? MatCreateTranspose(A, &transposed) : MatTranspose(A, MAT_INITIAL_MATRIX, &transposed));
  PetscCall(MpmEigenSolve(transposed, "left_", shell ? MPM_EIGEN_LARGEST : MPM_EIGEN_TARGET, target, &left));
  for (PetscInt i = 0; i < left->n; i++) {
    const PetscReal distance = hypot(left->re[i] - e->re[j], left->im[i] + e->im[j]); /* A^T y = conj(lambda) y */

    if (distance < nearest) match = i;
    nearest = PetscMin(nearest, distance);
  }
  *found = nearest <= LEFT_FOUND * e->norm ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(MatCreateVecs(A, &z[0], &z[1]));
  if (*found) PetscCall(MpmEigenVector(left, match, z[0], z[1]));
  for (int part = 0; part < 2; part++) {
    if (e->reduced)
      PetscCall(MatMultTranspose(e->reduced->Z, z[part], y[part]));
    else
      PetscCall(VecCopy(z[part], y[part]));
    PetscCall(VecDestroy(&z[part]));
  }
  PetscCall(MpmEigenDestroy(&left));
  PetscCall(MatDestroy(&transposed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenCondition(const MpmEigen *e, PetscInt j, PetscReal *condition)
{
  PetscReal dot[4], norm[2];
  PetscBool found = PETSC_FALSE;
  Vec       x[2], y[2];

  PetscFunctionBegin;
  *condition = INFINITY;
  if (e->place[j] < 0) PetscFunctionReturn(PETSC_SUCCESS); /* a number that A keeps may be defective */
  PetscCall(MatCreateVecs(e->A, &x[0], &x[1]));
  PetscCall(MatCreateVecs(e->A, &y[0], &y[1]));
  PetscCall(LeftVector(e, j, y, &found));
  if (found) {
    PetscCall(MpmEigenVector(e, j, x[0], x[1]));
    for (int part = 0; part < 2; part++) PetscCall(VecNorm(y[part], NORM_2, &norm[part]));
    for (int a = 0; a < 2; a++)
      for (int b = 0; b < 2; b++) PetscCall(VecDot(x[a], y[b], &dot[2 * a + b]));
    *condition = hypot(norm[0], norm[1]) / hypot(dot[0] + dot[3], dot[2] - dot[1]);
  }
  for (int part = 0; part < 2; part++) {
    PetscCall(VecDestroy(&x[part]));
    PetscCall(VecDestroy(&y[part]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPencilLeastKrylov(Mat C0, Mat C1, PetscReal *x)
{
  EPS       eps;
  ST        st;
  KSP       ksp;
  PC        pc;
  PetscInt  order, found;
  PetscReal re, im;

  PetscFunctionBegin;
  *x = NAN;
  PetscCall(MatShift(C0, 1));
  PetscCall(MatGetSize(C0, &order, NULL));
  PetscCall(EPSCreate(PetscObjectComm((PetscObject)C0), &eps));
  PetscCall(EPSSetOperators(eps, C1, C0));
  PetscCall(EPSSetProblemType(eps, EPS_GNHEP));
  PetscCall(EPSSetWhichEigenpairs(eps, EPS_SMALLEST_REAL));
  PetscCall(EPSSetDimensions(eps, 1, PetscMin(BASIS, order), PETSC_DETERMINE));
  PetscCall(EPSSetTolerances(eps, PENCIL_TOLERANCE, RESTARTS));
  PetscCall(EPSGetST(eps, &st));
  PetscCall(STGetKSP(st, &ksp));
  PetscCall(KSPSetType(ksp, KSPGMRES));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCNONE));
  PetscCall(KSPSetTolerances(ksp, PENCIL_TOLERANCE / 100, PETSC_DEFAULT, PETSC_DEFAULT, RESTARTS));
  PetscCall(EPSSolve(eps));
  PetscCall(EPSGetConverged(eps, &found));
  if (found) {
    PetscCall(EPSGetEigenvalue(eps, 0, &re, &im));
    *x = re >= 0 ? INFINITY : fabs(im) <= PENCIL_REAL * fabs(re) ? -1 / re : NAN;
  }
  PetscCall(EPSDestroy(&eps));
  PetscFunctionReturn(PETSC_SUCCESS);
}
