/* All eigenvalues of a small complex matrix. LAPACK's zgeev is asked for vectors and for what QR steps leave open. */
#include "linalg/lapack_names.h"
#include "linalg/small_eigen.h"
#include "linalg/small_qr.h"
#include <math.h>

#define ZGEEV MPM_LAPACK(zgeev, ZGEEV)

extern void ZGEEV(const char *jobvl, const char *jobvr, const PetscBLASInt *n, double complex *a,
                  const PetscBLASInt *lda, double complex *w, double complex *vl, const PetscBLASInt *ldvl,
                  double complex *vr, const PetscBLASInt *ldvr, double complex *work, const PetscBLASInt *lwork,
                  double *rwork, PetscBLASInt *info);

static PetscErrorCode Call(MpmSmallEigen *s, PetscBool vectors, PetscBLASInt lwork, double complex work[])
{
  const char  *job = vectors ? "V" : "N";
  PetscBLASInt n, info;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(s->n, &n));
  ZGEEV(job, job, &n, s->matrix, &n, s->value, s->left, &n, s->right, &n, work, &lwork, s->rwork, &info);
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "zgeev failed: %d", (int)info);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSmallEigenCreate(PetscInt n, MpmSmallEigen *s)
{
  double complex size;

  PetscFunctionBegin;
  *s = (MpmSmallEigen){.n = n};
  PetscCall(PetscMalloc5(n * n, &s->matrix, n, &s->value, n * n, &s->right, n * n, &s->left, 2 * n, &s->rwork));
  PetscCall(Call(s, PETSC_TRUE, -1, &size)); /* asks for the size of the work space */
  s->lwork = (PetscInt)creal(size);
  PetscCall(PetscMalloc1(s->lwork, &s->work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSmallEigenDestroy(MpmSmallEigen *s)
{
  PetscFunctionBegin;
  PetscCall(PetscFree5(s->matrix, s->value, s->right, s->left, s->rwork));
  PetscCall(PetscFree(s->work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSmallEigenLapack(MpmSmallEigen *s)
{
  PetscFunctionBegin;
  PetscCall(Call(s, PETSC_FALSE, (PetscBLASInt)s->lwork, s->work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSmallEigenSolve(MpmSmallEigen *s, PetscBool vectors)
{
  PetscBool ok;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->n * s->n; i++) {
    if (isfinite(creal(s->matrix[i])) && isfinite(cimag(s->matrix[i]))) continue;
    for (PetscInt j = 0; j < s->n; j++) s->value[j] = INFINITY;
    PetscCall(PetscArrayzero(s->right, s->n * s->n));
    PetscCall(PetscArrayzero(s->left, s->n * s->n));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!vectors && s->n <= MPM_SMALL_QR_MOST) {
    PetscCall(PetscArraycpy(s->left, s->matrix, s->n * s->n));
    MpmSmallQr(s->n, s->matrix, s->value, &ok);
    if (ok) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(PetscArraycpy(s->matrix, s->left, s->n * s->n));
  }
  PetscCall(Call(s, vectors, (PetscBLASInt)s->lwork, s->work));
  PetscFunctionReturn(PETSC_SUCCESS);
}
