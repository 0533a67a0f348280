/* Writes eigenvalues, modes, the symbol's curves and transient growth as HDF5, and eigenvalues as CSV. */
#include "base/textfile.h"
#include "io/mode_file.h"
#include "io/spectrum_files.h"
#include "io/symbol_files.h"
#include <math.h>

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
