/* Writes the symbol's curves as HDF5 and CSV. */
#include "base/textfile.h"
#include "io/symbol_files.h"

/* Writes a curve over 0 .. half at all phases; growth is even in beta. */
static PetscErrorCode WriteEven(const MpmSymbol *s, const char name[], PetscReal half[], PetscBool have,
                                MpmDataFile *file)
{
  PetscReal *all;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(s->phases, &all));
  for (PetscInt m = 0; m < s->phases && have; m++) all[m] = half[m <= s->half ? m : s->phases - m];
  PetscCall(MpmDataFileArray(file, "/symbol", name, s->phases, 1, all));
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteFormulas(const MpmSymbol *s, const MpmPredictor *p, MpmDataFile *file)
{
  PetscReal *published, *corrected, *beta;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(s->phases, &beta, s->half + 1, &published, s->half + 1, &corrected));
  for (PetscInt m = 0; m < s->phases; m++) beta[m] = MpmSymbolPhase(m, s->phases);
  for (PetscInt m = 0; m <= s->half; m++) {
    published[m] = MpmPredictorPublished(p, s->step.courant, beta[m]);
    corrected[m] = MpmPredictorCorrected(p, s->step.courant, beta[m]);
  }
  PetscCall(MpmDataFileArray(file, "/symbol", "beta", s->phases, 1, beta));
  PetscCall(WriteEven(s, "published", published, PETSC_TRUE, file));
  PetscCall(WriteEven(s, "corrected", corrected, PETSC_TRUE, file));
  PetscCall(PetscFree3(beta, published, corrected));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolWrite(const MpmSymbol *s, const MpmPredictor *p, MpmDataFile *file)
{
  const MPI_Comm comm = file->hdf5.comm;
  PetscMPIInt    rank;
  PetscReal     *growth, *factors;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(WriteFormulas(s, p, file));
  PetscCall(MpmSymbolGather(comm, s, s->per_phase, &growth));
  PetscCall(WriteEven(s, "growth", growth, rank ? PETSC_FALSE : PETSC_TRUE, file));
  PetscCall(PetscFree(growth));
  if (!s->factors) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSymbolGatherFactors(comm, s, 0, &factors));
  PetscCall(MpmDataFileArray(file, "/symbol", "factors", s->phases, 2 * s->size, factors));
  PetscCall(PetscFree(factors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolWriteCsv(const MpmSymbol *s, const MpmPredictor *p, const char path[])
{
  PetscReal  *growth, *seen = NULL;
  MpmTextFile csv;

  PetscFunctionBegin;
  PetscCall(MpmSymbolGather(PETSC_COMM_WORLD, s, s->per_phase, &growth));
  if (s->without_null) PetscCall(MpmSymbolGather(PETSC_COMM_WORLD, s, s->without_null, &seen));
  PetscCall(MpmTextFileOpen(path, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "beta,growth%s,published,corrected\n", seen ? ",growth_seen" : "");
    for (PetscInt m = 0; m <= s->half; m++) {
      const PetscReal beta = MpmSymbolPhase(m, s->phases);

      fprintf(csv.stream, "%.17g", beta);
      MpmTextFileCell(&csv, growth[m]);
      if (seen) MpmTextFileCell(&csv, seen[m]);
      MpmTextFileCell(&csv, MpmPredictorPublished(p, s->step.courant, beta));
      MpmTextFileCell(&csv, MpmPredictorCorrected(p, s->step.courant, beta));
      fprintf(csv.stream, "\n");
    }
  }
  PetscCall(MpmTextFileClose(&csv));
  PetscCall(PetscFree(growth));
  PetscCall(PetscFree(seen));
  PetscFunctionReturn(PETSC_SUCCESS);
}
