/* Finds the rows of a rank's particles. They stay as they are until particles migrate. */
#include "march/rows.h"

#define WHOLE 4 /* particles that a row may have more, so that it ends with its cell */

/* The number of particles from begin on that are on one line along x. */
static PetscInt OnLine(const MpmMarchArrays *a, PetscInt begin)
{
  PetscInt n = 1;

  for (; begin + n < a->march->particles->count; n++)
    for (PetscInt d = 1; d < a->march->layout->dim; d++)
      if (a->cell[d][begin + n] != a->cell[d][begin] || a->xi[d][begin + n] != a->xi[d][begin]) return n;
  return n;
}

/* The number of particles of a row from begin on: about `share` in whole cells, for which a line of nodes has room. */
static PetscInt Length(const MpmMarchArrays *a, PetscInt begin, PetscInt line, PetscInt share)
{
  const PetscInt most = PetscMin(line, MPM_BLOCK), *cell = a->cell[0] + begin;
  PetscInt       n = 1;

  for (; n < most && cell[n] >= cell[0] && cell[n] - cell[0] < MPM_BLOCK; n++)
    if (n >= share && cell[n] != cell[n - 1]) return n;
  return n;
}

/* Whether n particles from begin on rest at the same places along x as those from of on, but for whole cells. */
static PetscBool IsAlike(const MpmMarchArrays *a, PetscInt of, PetscInt begin, PetscInt n, PetscBool altered)
{
  const PetscInt  *cell = a->cell[0] + begin, *of_cell = a->cell[0] + of;
  const PetscReal *xi = a->xi[0] + begin, *of_xi = a->xi[0] + of;
  PetscInt         differ = altered && cell[0] != of_cell[0];

  for (PetscInt p = 0; p < n; p++) differ |= (cell[p] - cell[0] != of_cell[p] - of_cell[0]) | (xi[p] != of_xi[p]);
  return differ ? PETSC_FALSE : PETSC_TRUE;
}

/*
   The number of rows, which are stored unless row is NULL. The rows of a line are as long as one another, if whole cells
   permit, so that more of them are alike. Where each particle moves by itself no two rows stay alike.
*/
static PetscInt Visit(const MpmMarchArrays *a, PetscBool altered, MpmRow row[])
{
  PetscInt rows = 0, of = 0, before = 0, line = 0, share = 0;

  for (PetscInt begin = 0, n; begin < a->march->particles->count; begin += n, line -= n, rows++) {
    if (!line) {
      line  = OnLine(a, begin);
      share = (line - 1) / ((line - 1) / (MPM_BLOCK - WHOLE) + 1) + 1;
    }
    n = Length(a, begin, line, share);
    if (row)
      row[rows] =
          (MpmRow){.begin = begin,
                   .alike = n == before && !a->march->particles->own ? IsAlike(a, of, begin, n, altered) : PETSC_FALSE};
    of     = begin;
    before = n;
  }
  if (row) row[rows].begin = a->march->particles->count;
  return rows;
}

PetscErrorCode MpmRowsFind(MpmMarch *march)
{
  const PetscBool altered = MpmBasisIsAltered(march->scheme->basis);
  MpmMarchArrays  arrays  = {.march = march};

  PetscFunctionBegin;
  if (march->clouds) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmMarchGetArrays(march, march->particles->step, &arrays));
  march->nrows = Visit(&arrays, altered, NULL);
  PetscCall(PetscFree(march->row));
  PetscCall(PetscMalloc1(march->nrows + 1, &march->row));
  (void)Visit(&arrays, altered, march->row);
  PetscCall(MpmMarchRestoreArrays(march, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}
