/* Growth: what a time series of norms shows about stability. It takes plain numbers and returns a verdict. */
#pragma once
#include <mpmstab/compat.h>
#include <mpmstab/verdict.h>

/*S
   MpmSeries - natural logarithms of the state's norm and of its size on the grid (MpmNorms), at sampled steps.

   They are logarithms because an unstable run leaves the range of doubles long before its growth is known.
S*/
typedef struct {
  PetscInt    n, room;
  PetscInt64 *step;
  PetscReal  *log_state, *log_grid;
} MpmSeries;

/* Not collective. MpmSeriesAppend adds a sample to a series, which is empty when all of it is 0. */
PetscErrorCode MpmSeriesAppend(MpmSeries *series, PetscInt64 step, PetscReal log_state, PetscReal log_grid);
PetscErrorCode MpmSeriesDestroy(MpmSeries *series);

/*S
   MpmGrowth - growth per step over the late half of a run.

   measured: false when there were too few samples for a result, or the state vanished. per_step: exp of the fitted
   slope of the logarithm of the size on the grid. Where the particles' places never repeat, it estimates the largest
   Lyapunov exponent. error: its standard error, from the slopes over ten parts of the late half; NaN when these have
   too few samples. decided: false when linear and exponential growth fit the series about equally well.
S*/
typedef struct {
  PetscBool     measured, decided;
  PetscReal     per_step, error;
  MpmGrowthKind kind;
  PetscInt64    from, to;
} MpmGrowth;

/*
   MpmGrowthFit - fits the late half of a series.

   Not collective.

   Input Parameters:
+  tolerance - growth per step up to 1 + tolerance counts as bounded
-  watch_state - whether growth of the state that the grid does not feel (rigid motion, null space of P2G) counts as
                 linear growth; false for waves whose displacement swings anyway

   Growth counts as such when it exceeds four times the scatter around the fit. Exponential growth is a straight line in
   the logarithm. Linear growth is a straight line in the size itself, or a power of time while eigenvalues near 1 still
   act as defective ones. The better fit decides. A rise of more than a factor e over the second half of a run cannot be
   linear.
*/
PetscErrorCode MpmGrowthFit(const MpmSeries *series, PetscReal tolerance, PetscBool watch_state, MpmGrowth *growth);

/* Not collective. Returns the verdict of a run. Linear growth (a defective eigenvalue 1) is not instability. */
MpmVerdict MpmGrowthVerdict(const MpmGrowth *growth, PetscReal tolerance);
