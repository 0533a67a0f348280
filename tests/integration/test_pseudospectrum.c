/*
   Pseudospectra: sigma(z) of operators is compared with dense singular values, and that of a normal and a nilpotent
   matrix, with their Kreiss constants, with closed forms. For what lies between the norms of scenes see
   test_transient.c.
*/
#include "singular.h"
#include "linalg/dense.h"
#include <mpmstab/operator.h>
#include "analysis/transient.h"

/* Writes z - A as a real matrix of twice the order, [x -y; y x] for x + iy; it has each singular value twice. */
static PetscErrorCode CheckSigma(const char what[], MpmResolvent *r, const PetscReal a[], double complex z)
{
  const PetscInt n = r->n;
  PetscReal     *twice, sigma, ends[2];

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(4 * n * n, &twice));
  for (PetscInt i = 0; i < n * n; i++)
    twice[i % n + 2 * n * (i / n)] = twice[n + i % n + 2 * n * (n + i / n)] = (i % n == i / n ? creal(z) : 0) - a[i];
  for (PetscInt i = 0; i < n; i++) {
    twice[n + i + 2 * n * i]   = cimag(z);
    twice[i + 2 * n * (n + i)] = -cimag(z);
  }
  PetscCall(DenseSingular(2 * n, twice, ends));
  PetscCall(MpmResolventSigma(r, z, &sigma));
  CHECK(fabs(sigma - ends[0]) <= 1e-9 * ends[0] + 1e-14 * ends[1], "%s: sigma(%g + %gi) = %.12g, LAPACK %.12g", what,
        creal(z), cimag(z), sigma, ends[0]);
  PetscCall(PetscFree(twice));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckResolvent(const char options[])
{
  static const double complex z[] = {1.2, 1 + 0.001 * I, 0.3 - 0.4 * I, 1.0001, -1.3 + 1.3 * I, I, 40, 0.999};
  MpmScene                   *scene;
  MpmOperator                *op;
  MpmResolvent                r;
  PetscReal                  *a;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmResolventCreate(op->A, &r));
  PetscCall(PetscMalloc1(op->order * op->order, &a));
  PetscCall(MpmDenseCopy(op->A, a));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(z); i++) PetscCall(CheckSigma(options, &r, a, z[i]));
  PetscCall(PetscFree(a));
  PetscCall(MpmResolventDestroy(&r));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes a matrix with value at (i, i + 1) and last at (n - 1, 0). */
static PetscErrorCode Shift(PetscInt n, PetscReal value, PetscReal last, Mat *A)
{
  PetscInt begin, end;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, PETSC_DECIDE, PETSC_DECIDE, n, n, 1, NULL, 1, NULL, A));
  PetscCall(MatGetOwnershipRange(*A, &begin, &end));
  for (PetscInt i = begin; i < end; i++)
    PetscCall(MatSetValue(*A, i, (i + 1) % n, i == n - 1 ? last : value, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A shift around a ring is normal, so sigma(z) is the distance to the nearest root of unity, and K = 1. */
static PetscErrorCode CheckNormal(void)
{
  MpmScene          *scene;
  MpmPseudospectrum *p;
  Mat                A;

  PetscFunctionBegin;
  PetscCall(CheckScene("", &scene));
  PetscCall(Shift(12, 1, 1, &A));
  PetscCall(MpmPseudospectrumCreate(A, 7, 1e-6, &p));
  CHECK(p->kreiss == 1 && isnan(creal(p->kreiss_at)) && p->order == 12, "Kreiss constant %.12g of a normal matrix",
        p->kreiss);
  CHECK_NEAR(p->radius, 1, 1e-14);
  CHECK_NEAR(p->re[6], 1.3, 1e-14);
  for (PetscInt i = 0; i < 49; i++) {
    PetscReal nearest = PETSC_MAX_REAL;

    for (PetscInt k = 0; k < 12; k++)
      nearest = PetscMin(nearest, cabs(p->re[i % 7] + I * p->re[i / 7] - cexp(2 * PETSC_PI * I * k / 12)));
    CHECK_NEAR(p->sigma[i], nearest, 1e-12);
  }
  PetscCall(MpmPseudospectrumDestroy(&p));
  PetscCall(MatDestroy(&A));
  PetscCall(Shift(4, 1, 16, &A)); /* its eigenvalues 2 i^k are outside the circle and within the square */
  PetscCall(MpmPseudospectrumCreate(A, 3, 1e-6, &p));
  CHECK(isinf(p->kreiss) && p->re[2] > 2, "Kreiss constant %g, square to %g", p->kreiss, p->re[2]);
  PetscCall(MpmPseudospectrumDestroy(&p));
  PetscCall(MatDestroy(&A));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks A = [0 c; 0 0], with r = abs(z):

     norm((z - A)^-1) = (c + sqrt(c^2 + 4 r^2)) / (2 r^2)

   K is the largest of that times r - 1.
*/
static PetscErrorCode CheckNilpotent(PetscReal c)
{
  PetscReal          kreiss = 1; /* the limit as r goes to infinity */
  MpmScene          *scene;
  MpmPseudospectrum *p;
  Mat                A;

  PetscFunctionBegin;
  PetscCall(CheckScene("", &scene));
  PetscCall(Shift(2, c, 0, &A));
  PetscCall(MpmPseudospectrumCreate(A, 3, 1e-6, &p));
  for (PetscReal r = 1; r < 8; r += 1e-4) kreiss = PetscMax(kreiss, (r - 1) * (c + hypot(c, 2 * r)) / (2 * r * r));
  CHECK_NEAR(p->kreiss, kreiss, 1e-7 * kreiss);
  CHECK_NEAR(p->sigma[2], 2 * 2 * 1.69 / (c + sqrt(c * c + 8 * 1.69)), 1e-12); /* at 1.3 - 1.3i */
  CHECK(p->edge_power == 0, "edge %g", p->edge_power);
  PetscCall(MpmPseudospectrumDestroy(&p));
  PetscCall(MatDestroy(&A));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckResolvent("-cells 8"));
  PetscCall(CheckResolvent("-formulation elastic -jitter 0.7 -cells 9"));
  PetscCall(CheckResolvent("-formulation musl -drift 1/4 -cells 10"));
  PetscCall(CheckNormal());
  PetscCall(CheckNilpotent(0.5));
  PetscCall(CheckNilpotent(30));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
