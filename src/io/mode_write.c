/* Writes eigenvectors of an operator to a file, from which a run can take its initial data. */
#include "io/mode_file.h"
#include "scene/layout.h"
#include <mpmstab/verdict.h>
#include <math.h>

static void WriteEigenvalue(const MpmOperator *op, const MpmEigen *eigen, PetscInt j, MpmDataFile *file)
{
  const PetscReal re = scalbn(eigen->re[j], (int)op->exponent), im = scalbn(eigen->im[j], (int)op->exponent);
  const PetscReal growth = MpmGrowthPerStep(hypot(eigen->re[j], eigen->im[j]), op->exponent, op->period);
  char            group[64];

  (void)snprintf(group, sizeof group, "/modes/%04" PetscInt_FMT, j + 1);
  MpmHdf5WriteReal(&file->hdf5, group, "re", re);
  MpmHdf5WriteReal(&file->hdf5, group, "im", im);
  MpmHdf5WriteReal(&file->hdf5, group, "growth", growth);
}

/* Writes the particles' starting places, over which a mode's values can be plotted: a row of dim numbers for each. */
static PetscErrorCode WriteCoordinates(const MpmLayout *layout, PetscReal cell_width, MpmDataFile *file)
{
  const PetscInt    dim  = layout->dim;
  const PetscMPIInt rank = MpmRankOf(file->hdf5.comm);
  PetscReal        *x;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(rank ? 0 : dim * layout->particles, &x));
  for (PetscInt64 id = 0; id < layout->particles && rank == 0; id++) {
    MpmLayoutRest(layout, id, &x[dim * id]);
    for (PetscInt a = 0; a < dim; a++) x[dim * id + a] *= cell_width;
  }
  PetscCall(MpmDataFileArray(file, "/modes", "coordinates", (PetscInt)layout->particles, dim, x));
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes one field of the real or the imaginary part of an eigenvector. */
static PetscErrorCode WriteField(const char name[], Vec field, MpmDataFile *file)
{
  const PetscReal *values;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(field, &n));
  PetscCall(VecGetArrayRead(field, &values));
  PetscCall(MpmHdf5Write(&file->hdf5, name, H5T_NATIVE_DOUBLE, n, 1, values));
  PetscCall(VecRestoreArrayRead(field, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* fields: the names of the parts of a vector; NULL: it is a whole, in the order of its rows. */
static PetscErrorCode WriteModes(const MpmOperator *op, const char *const fields[], const MpmEigen *eigen,
                                 PetscInt count, MpmDataFile *file)
{
  static const char *const parts[] = {"re", "im"};
  Vec                      x[2], field = NULL;
  char                     name[128];

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(eigen->A, &x[0], &x[1]));
  if (fields) PetscCall(MatCreateVecs(op->p2g, &field, NULL));
  for (PetscInt j = 0; j < PetscMin(count, eigen->n); j++) {
    PetscCall(MpmEigenVector(eigen, j, x[0], x[1]));
    PetscCall(MpmOperatorToState(op, x[0], x[1]));
    for (PetscInt f = 0; f < (fields ? op->fields : 1); f++) {
      for (int part = 0; part < 2; part++) {
        if (fields) PetscCall(VecSetBlockSize(x[part], op->fields));
        if (fields) PetscCall(VecStrideGather(x[part], f, field, INSERT_VALUES));
        (void)snprintf(name, sizeof name, "/modes/%04" PetscInt_FMT "/%s_%s", j + 1, fields ? fields[f] : "vector",
                       parts[part]);
        PetscCall(WriteField(name, fields ? field : x[part], file));
      }
    }
    WriteEigenvalue(op, eigen, j, file);
  }
  PetscCall(VecDestroy(&x[0]));
  PetscCall(VecDestroy(&x[1]));
  PetscCall(VecDestroy(&field));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModesWrite(const MpmOperator *op, PetscReal cell_width, const MpmEigen *eigen, PetscInt count,
                             MpmDataFile *file)
{
  PetscFunctionBegin;
  if (PetscMin(count, eigen->n) > 0) PetscCall(WriteCoordinates(op->layout, cell_width, file));
  PetscCall(WriteModes(op, op->scheme->table->fields, eigen, count, file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmVectorsWrite(const MpmOperator *op, const MpmEigen *eigen, PetscInt count, MpmDataFile *file)
{
  return WriteModes(op, NULL, eigen, count, file);
}
