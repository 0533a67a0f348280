/*
   Fits the late half of a run by least squares: is it constant, algebraic (a + b t, or t^p), or exponential (exp(lambda
   t))?
*/
#include "analysis/growth.h"
#include <math.h>

#define FEWEST_SAMPLES 8
#define BATCHES 10
#define CLEARLY_BETTER 1.5 /* two fits whose residuals have a smaller ratio are not told apart */

/*
   Over the second half of a run, growth like t, t^2 and t^3 from the first step on rises by ln 2, 2 ln 2 and 3 ln 2.
   Eigenvalues 1 in blocks of up to four grow like that. A larger rise does not count as algebraic.
*/
#define LARGEST_ALGEBRAIC_RISE 2.2

PetscErrorCode MpmSeriesAppend(MpmSeries *s, PetscInt64 step, PetscReal log_state, PetscReal log_grid)
{
  PetscFunctionBegin;
  if (s->n == s->room) {
    s->room = PetscMax(512, 2 * s->room);
    PetscCall(PetscRealloc(sizeof(*s->step) * (size_t)s->room, &s->step));
    PetscCall(PetscRealloc(sizeof(*s->log_state) * (size_t)s->room, &s->log_state));
    PetscCall(PetscRealloc(sizeof(*s->log_grid) * (size_t)s->room, &s->log_grid));
  }
  s->step[s->n]      = step;
  s->log_state[s->n] = log_state;
  s->log_grid[s->n]  = log_grid;
  s->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSeriesDestroy(MpmSeries *s)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(s->step));
  PetscCall(PetscFree(s->log_state));
  PetscCall(PetscFree(s->log_grid));
  s->n = s->room = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  PetscReal slope, rise, scatter, linear_scatter; /* linear_scatter: of the better algebraic fit */
} Fit;

/* Fits y = c + slope x. Returns the slope; scatter is the root mean square of the residuals. */
static PetscReal FitLine(PetscInt n, const PetscReal x[], const PetscReal y[], PetscReal *scatter)
{
  PetscReal mean_x = 0, mean_y = 0, xx = 0, xy = 0, rest = 0;

  for (PetscInt i = 0; i < n; i++) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  for (PetscInt i = 0; i < n; i++) {
    xx += PetscSqr(x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  for (PetscInt i = 0; i < n; i++) rest += PetscSqr(y[i] - mean_y - xy / xx * (x[i] - mean_x));
  *scatter = sqrt(rest / n);
  return xy / xx;
}

/* Fits N = exp(y) = a + b t with relative weights 1/N: it minimises sum ((a + b t) / N - 1)^2. */
static PetscReal LinearScatter(PetscInt n, const PetscReal x[], const PetscReal y[])
{
  PetscReal aa = 0, ab = 0, bb = 0, ra = 0, rb = 0, rest = 0, a, b, det;

  for (PetscInt i = 0; i < n; i++) {
    const PetscReal w = exp(y[0] - y[i]), t = (x[i] - x[0]) / (x[n - 1] - x[0]);

    aa += w * w;
    ab += w * w * t;
    bb += w * w * t * t;
    ra += w;
    rb += w * t;
  }
  det = aa * bb - ab * ab;
  a   = (ra * bb - rb * ab) / det;
  b   = (rb * aa - ra * ab) / det;
  for (PetscInt i = 0; i < n; i++) {
    const PetscReal t = (x[i] - x[0]) / (x[n - 1] - x[0]);

    rest += PetscSqr((a + b * t) * exp(y[0] - y[i]) - 1);
  }
  return sqrt(rest / n);
}

/*
   x holds n steps and then their logarithms. A defective eigenvalue 1 makes the norm grow like t in the end, but more
   slowly as long as eigenvalues close to 1 cannot be distinguished from it. So t^p is fitted as well as a + b t.
*/
static Fit FitLate(PetscInt n, const PetscReal x[], const PetscReal y[])
{
  Fit       fit;
  PetscReal power_scatter;

  fit.slope          = FitLine(n, x, y, &fit.scatter);
  fit.rise           = fit.slope * (x[n - 1] - x[0]);
  fit.linear_scatter = LinearScatter(n, x, y);
  (void)FitLine(n, x + n, y, &power_scatter);
  fit.linear_scatter = PetscMin(fit.linear_scatter, power_scatter);
  return fit;
}

static PetscBool StandsOut(const Fit *fit)
{
  return fit->rise > 4 * fit->scatter ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Returns whether the norm grows. Growth that has just emerged does not follow a line yet, but a rise this large is no
   scatter either.
*/
static PetscBool Grows(const Fit *fit, PetscReal tolerance)
{
  if (fit->slope <= log1p(tolerance)) return PETSC_FALSE;
  return StandsOut(fit) || fit->rise > LARGEST_ALGEBRAIC_RISE ? PETSC_TRUE : PETSC_FALSE;
}

/* Returns whether one of the two fits is clearly better. */
static PetscBool IsDecided(const Fit *fit)
{
  const PetscReal worse  = PetscMax(fit->scatter, fit->linear_scatter),
                  better = PetscMin(fit->scatter, fit->linear_scatter);

  if (!StandsOut(fit)) return PETSC_FALSE;
  return fit->rise > LARGEST_ALGEBRAIC_RISE || worse > CLEARLY_BETTER * better ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool IsLinear(const Fit *fit)
{
  return fit->rise <= LARGEST_ALGEBRAIC_RISE && fit->linear_scatter < fit->scatter ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Finds the first sample of the late half. Returns n when too few samples follow, or when they are not finite because
   the state has vanished.
*/
static PetscInt FirstLate(const MpmSeries *s)
{
  PetscInt late = 0;

  while (late < s->n && 2 * s->step[late] < s->step[s->n - 1]) late++;
  if (s->n - late < FEWEST_SAMPLES) return s->n;
  for (PetscInt i = late; i < s->n; i++)
    if (!isfinite(s->log_grid[i]) || !isfinite(s->log_state[i])) return s->n;
  return late;
}

/*
   Computes the standard error of the slope by batch means: the slopes over parts of the series, taken as independent,
   scatter about the slope of the whole.
*/
static PetscReal StandardError(PetscInt n, const PetscReal x[], const PetscReal y[])
{
  PetscReal sum = 0, squares = 0;

  if (n < 3 * BATCHES) return NAN;
  for (PetscInt b = 0; b < BATCHES; b++) {
    const PetscInt  first = (n - 1) * b / BATCHES, last = (n - 1) * (b + 1) / BATCHES;
    const PetscReal slope = (y[last] - y[first]) / (x[last] - x[first]);

    sum += slope;
    squares += slope * slope;
  }
  return sqrt(PetscMax(squares - sum * sum / BATCHES, 0) / (BATCHES - 1) / BATCHES);
}

PetscErrorCode MpmGrowthFit(const MpmSeries *s, PetscReal tolerance, PetscBool watch_state, MpmGrowth *growth)
{
  const PetscInt late = FirstLate(s), n = s->n - late;
  PetscReal     *x;
  Fit            grid, state;

  PetscFunctionBegin;
  *growth = (MpmGrowth){.measured = PETSC_FALSE, .error = NAN, .decided = PETSC_TRUE, .kind = MPM_BOUNDED};
  if (n == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(2 * n, &x));
  for (PetscInt i = 0; i < n; i++) {
    x[i]     = (PetscReal)s->step[late + i];
    x[n + i] = log(x[i]);
  }
  grid             = FitLate(n, x, s->log_grid + late);
  state            = FitLate(n, x, s->log_state + late);
  growth->measured = PETSC_TRUE;
  growth->per_step = exp(grid.slope);
  growth->error    = growth->per_step * StandardError(n, x, s->log_grid + late);
  growth->from     = s->step[late];
  growth->to       = s->step[s->n - 1];
  if (Grows(&grid, tolerance)) {
    growth->kind    = IsLinear(&grid) ? MPM_LINEAR : MPM_EXPONENTIAL;
    growth->decided = IsDecided(&grid);
  } else if (watch_state && Grows(&state, tolerance))
    growth->kind = MPM_LINEAR;
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

MpmVerdict MpmGrowthVerdict(const MpmGrowth *growth, PetscReal tolerance)
{
  if (!growth->measured || !growth->decided) return MPM_UNDECIDED;
  return growth->kind == MPM_EXPONENTIAL && growth->per_step > 1 + tolerance ? MPM_UNSTABLE : MPM_STABLE;
}
