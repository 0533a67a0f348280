/* What particles do in the modes that limit: P waves, S waves or both. */
#include "analysis/critical_parts.h"
#include "analysis/modes.h"
#include "scene/layout.h"
#include "symbol/bloch.h"
#include "linalg/small_eigen.h"
#include <math.h>

#define NEARLY 0.9 /* modes whose growth is at least this part of the largest count as equally fast */
#define STILL 1e-9 /* a mode whose nodal vector is smaller than this part of it does not move the nodes */

const char *const MpmWaveTypeNames[] = {"", "P", "S", "mixed", "MpmWaveType", "MPM_WAVE_", NULL};

/* What an operation sends of a mode to its node. */
static double complex Sent(const MpmBloch *b, const MpmOp *op, const double complex mode[])
{
  double complex sum = 0;

  for (PetscInt j = 0; j < b->ppc; j++) sum += conj(MpmBlochTie(b, op, j, NULL)) * mode[b->fields * j + op->src];
  return sum;
}

/* A component of a mode's nodal vector: P2G of the particles', with that of the affine part. */
static double complex NodalComponent(const MpmBloch *b, PetscInt particle, const double complex mode[])
{
  const MpmTable *table = b->scheme->table;
  const MpmOp    *first = MpmTableSeenBy(table, particle);
  double complex  sum   = Sent(b, first, mode);

  for (const MpmOp *op = first + 1; op < table->ops + table->nops && op->kind == MPM_P2G_AFFINE; op++)
    if (op->dst == first->dst) sum += Sent(b, op, mode);
  return sum;
}

/* The share along beta of a mode's nodal vector; NaN for a mode that does not move the nodes. */
static PetscReal ShareAlong(const MpmBloch *b, const double complex mode[], PetscInt vector, const PetscReal beta[])
{
  double complex along = 0;
  PetscReal      all = 0, length = 0, size = 0;

  for (PetscInt a = 0; a < b->layout->dim; a++) {
    const double complex node = NodalComponent(b, vector + a, mode);

    along += beta[a] * node;
    all += PetscSqr(cabs(node));
    length += PetscSqr(beta[a]);
  }
  for (PetscInt i = 0; i < b->size; i++) size += PetscSqr(cabs(mode[i]));
  return all > PetscSqr(STILL) * size ? PetscSqr(cabs(along)) / (all * length) : NAN;
}

PetscErrorCode MpmCriticalPolarise(const MpmCriticalCase *of, PetscReal courant, const PetscReal beta[],
                                   MpmWaveType *wave)
{
  const PetscInt vector  = MpmModesVectorOf(of->scheme);
  PetscReal      largest = 0, least = 1, most = 0, excess;
  PetscInt       exponent;
  MpmBloch       bloch;
  MpmSmallEigen  whole;

  PetscFunctionBegin;
  *wave = MPM_WAVE_NONE;
  if (vector == MPM_NONE) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmBlochCreate(of->layout, of->scheme, of->step.drift, &bloch));
  PetscCall(MpmSmallEigenCreate(bloch.size, &whole));
  PetscCall(MpmBlochMatrices(&bloch, 1, &courant, beta, PETSC_FALSE, whole.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&whole, PETSC_TRUE));
  MpmBlochSetStep(&bloch, 0);
  for (PetscInt i = 0; i < whole.n; i++) largest = fmax(largest, cabs(whole.value[i]));
  excess = log(largest) + (PetscReal)exponent * M_LN2;
  for (PetscInt i = 0; i < whole.n; i++) {
    const PetscReal share = ShareAlong(&bloch, whole.right + whole.n * i, vector, beta);

    if (log(cabs(whole.value[i])) + (PetscReal)exponent * M_LN2 < NEARLY * excess || isnan(share)) continue;
    least = PetscMin(least, share);
    most  = PetscMax(most, share);
  }
  if (excess > 0 && most >= least) *wave = MpmCriticalWaveOf(least, most);
  PetscCall(MpmSmallEigenDestroy(&whole));
  PetscCall(MpmBlochDestroy(&bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}
