/* The task spectrum: mpmstab spectrum [SCENE.yaml | -matrix FILE | -program COMMAND | -plugin FILE] [-option value]... */
#include "task/expect.h"
#include "probe/certificates.h"
#include "analysis/spectrum.h"
#include "io/matrix_file.h"
#include "io/spectrum_files.h"
#include "linalg/eigen.h"
#include "report/results.h"
#include "task/task.h"
#include <mpmstab/errors.h>
#include <math.h>

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
  MpmSpectrumReport(result, scene, request, s, NULL);
  MpmResultSay(
      result, "tangent: of the step after step %" PetscInt64_FMT "{tangent.at_step}, as if the state stayed as it is; ",
      request->at_step);
  if (isfinite(mismatch))
    MpmResultSay(result, "its step differs from the march's by %.1e{tangent.step_mismatch}\n", mismatch);
  else
    MpmPrint("the run ends in this step, because a particle fails\n");
  PetscCall(MpmResultEnd(request, s->wall_s, &result));
  if (request->write_matrix[0]) PetscCall(Write(request->write_matrix, s->op));
  PetscCall(MpmExpectFinding(&request->expect, &s->finding, missed));
  PetscCall(MpmSpectrumDestroy(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskSpectrum(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmSpectrum      *bulk = NULL;
  MpmCertificates   certificates;
  MpmNeighbourhood  place = {.kind = MPM_IN_BULK};
  MpmNeighbourhoods around, *all = MpmNeighbourhoodsWanted(request) ? &around : NULL;
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
  MpmSpectrumReport(result, scene, request, bulk, all);
  PetscCall(MpmResultEnd(request, MPI_Wtime() - started, &result));
  if (bulk && request->write_matrix[0]) PetscCall(Write(request->write_matrix, bulk->op));
  PetscCall(MpmExpectFinding(&request->expect, all ? &all->finding : &bulk->finding, missed));
  if (bulk) PetscCall(MpmSpectrumDestroy(&bulk));
  PetscFunctionReturn(PETSC_SUCCESS);
}
