/* The operator as a polynomial in the Courant number is the assembled operator, at any Courant number. */
#include "check.h"
#include "base/hash.h"
#include "linalg/dense.h"
#include "operator/polynomial.h"
#include <mpmstab/operator.h>

#define ROUNDING 1e-12 /* of the largest number of either matrix */

/* At a random Courant number beside 0, beside the one that the operator is scaled with, and far beyond it. */
static PetscErrorCode Agrees(const char options[])
{
  MpmScene     *scene;
  MpmPolynomial polynomial;
  PetscReal    *found, *expected;
  PetscInt      n, exponent;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmPolynomialCreate(&scene->layout, &scene->scheme, &scene->step, &polynomial));
  n = polynomial.order;
  PetscCall(PetscMalloc2(n * n, &found, n * n, &expected));
  for (int i = -1; i <= 1; i++) {
    MpmStep      step = scene->step;
    MpmOperator *op;
    PetscReal    largest = 0, off = 0;

    step.courant = polynomial.scale * pow(1000, i) * (1 + MpmHash(i, n));
    PetscCall(MpmPolynomialMatrix(&polynomial, step.courant, found, &exponent));
    PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &step, &op));
    PetscCall(MpmDenseCopy(op->balanced, expected));
    for (PetscInt e = 0; e < n * n; e++) {
      const PetscReal value = scalbn(expected[e], (int)(op->exponent - exponent));

      largest = PetscMax(largest, fabs(value));
      off     = PetscMax(off, fabs(found[e] - value));
    }
    CHECK(largest > 0 && off <= ROUNDING * largest, "%s: courant %.9g: off by %.3g of %.3g", options, step.courant, off,
          largest);
    PetscCall(MpmOperatorDestroy(&op));
  }
  PetscCall(PetscFree2(found, expected));
  PetscCall(MpmPolynomialDestroy(&polynomial));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  char options[256];

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt f = 0; MpmFormulations[f]; f++) {
    if (MpmFormulationHas(MpmFormulations[f], MPM_IMPLICIT)) continue; /* its step is no polynomial in k */
    for (PetscInt t = 0; MpmTransfers[t]; t++) {
      if (MpmTransfers[t]->affine && MpmFormulations[f]->affine == MPM_NONE) continue;
      PetscCall(PetscSNPrintf(options, sizeof options,
                              "-formulation %s -transfer %s -basis quadratic -cells 6 -ppc 2 -jitter 0.5 -drift 2/5",
                              MpmFormulations[f]->name, MpmTransfers[t]->name));
      PetscCall(Agrees(options));
    }
    PetscCall(
        PetscSNPrintf(options, sizeof options, "-formulation %s -cells 6 -boundary fixed", MpmFormulations[f]->name));
    PetscCall(Agrees(options));
  }
  PetscCall(Agrees("-formulation usavg -transfer xpic -xpic_order 20 -basis gimp -material graded -stiffness_ratio 1e6 "
                   "-drift 19/22 -cells 5 -ppc 1"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
