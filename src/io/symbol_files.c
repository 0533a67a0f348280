/* Writes the symbol's curves as HDF5 and CSV. */
#include "base/textfile.h"
#include "io/symbol_files.h"

/* Writes a curve over the classes at all phases. have: this rank has it. */
static PetscErrorCode WriteCurve(const MpmSymbol *s, const char name[], const PetscReal curve[], PetscBool have,
                                 MpmDataFile *file)
{
  PetscReal *all;
  PetscBool  conjugate;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(s->all, &all));
  for (PetscInt m = 0; m < s->all && have; m++) all[m] = curve[MpmSymbolClass(s, m, &conjugate)];
  PetscCall(MpmDataFileArray(file, "/symbol", name, s->all, 1, all));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WritePhases(const MpmSymbol *s, MpmDataFile *file)
{
  PetscReal *beta;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(s->dim * s->all, &beta));
  for (PetscInt m = 0; m < s->all; m++) MpmSymbolBeta(s, m, beta + s->dim * m);
  PetscCall(MpmDataFileArray(file, "/symbol", "beta", s->all, s->dim, beta));
  PetscCall(PetscFree(beta));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteFormulas(const MpmSymbol *s, const MpmPredictor *p, MpmDataFile *file)
{
  PetscReal *published, *corrected, beta[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(s->classes, &published, s->classes, &corrected));
  for (PetscInt i = 0; i < s->classes; i++) {
    MpmSymbolBeta(s, MpmSymbolPhaseOfClass(s, i), beta);
    published[i] = MpmPredictorPublished(p, s->step.courant, beta);
    corrected[i] = MpmPredictorCorrected(p, s->step.courant, beta);
  }
  PetscCall(WriteCurve(s, "published", published, PETSC_TRUE, file));
  PetscCall(WriteCurve(s, "corrected", corrected, PETSC_TRUE, file));
  PetscCall(PetscFree2(published, corrected));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes one growth of each class, which the ranks have computed. */
static PetscErrorCode WriteGrowth(const MpmSymbol *s, const char name[], const PetscReal per_phase[], MpmDataFile *file)
{
  PetscReal *growth;

  PetscFunctionBegin;
  PetscCall(MpmSymbolGather(file->hdf5.comm, s, per_phase, &growth));
  PetscCall(WriteCurve(s, name, growth, MpmRankOf(file->hdf5.comm) ? PETSC_FALSE : PETSC_TRUE, file));
  PetscCall(PetscFree(growth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolWrite(const MpmSymbol *s, const MpmPredictor *p, MpmDataFile *file)
{
  PetscReal *factors;

  PetscFunctionBegin;
  PetscCall(WritePhases(s, file));
  if (p) PetscCall(WriteFormulas(s, p, file));
  PetscCall(WriteGrowth(s, "growth", s->per_phase, file));
  if (s->without_null) PetscCall(WriteGrowth(s, "growth_seen", s->without_null, file));
  if (!s->factors) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSymbolGatherFactors(file->hdf5.comm, s, 0, &factors));
  PetscCall(MpmDataFileArray(file, "/symbol", "factors", s->all, 2 * s->size, factors));
  PetscCall(PetscFree(factors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolWriteCsv(const MpmSymbol *s, const MpmPredictor *p, const char path[])
{
  static const char *const names[MPM_MAX_DIM] = {"beta", "beta_x,beta_y", "beta_x,beta_y,beta_z"};
  PetscReal               *growth, *seen = NULL;
  MpmTextFile              csv;

  PetscFunctionBegin;
  PetscCall(MpmSymbolGather(PETSC_COMM_WORLD, s, s->per_phase, &growth));
  if (s->without_null) PetscCall(MpmSymbolGather(PETSC_COMM_WORLD, s, s->without_null, &seen));
  PetscCall(MpmTextFileOpen(path, &csv));
  if (csv.stream) {
    const PetscInt rows = s->dim == 1 ? s->classes : s->all;

    fprintf(csv.stream, "%s,growth%s%s\n", names[s->dim - 1], seen ? ",growth_seen" : "",
            p ? ",published,corrected" : "");
    for (PetscInt m = 0; m < rows; m++) {
      PetscReal      beta[MPM_MAX_DIM];
      PetscBool      conjugate;
      const PetscInt i = MpmSymbolClass(s, m, &conjugate);

      MpmSymbolBeta(s, m, beta);
      for (PetscInt a = 0; a < s->dim; a++) fprintf(csv.stream, "%s%.17g", a ? "," : "", beta[a]);
      MpmTextFileCell(&csv, growth[i]);
      if (seen) MpmTextFileCell(&csv, seen[i]);
      if (p) MpmTextFileCell(&csv, MpmPredictorPublished(p, s->step.courant, beta));
      if (p) MpmTextFileCell(&csv, MpmPredictorCorrected(p, s->step.courant, beta));
      fprintf(csv.stream, "\n");
    }
  }
  PetscCall(MpmTextFileClose(&csv));
  PetscCall(PetscFree(growth));
  PetscCall(PetscFree(seen));
  PetscFunctionReturn(PETSC_SUCCESS);
}
