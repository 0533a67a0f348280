/* Least squares on the late half of a run: constant, a + b t, or exp(lambda t)? */
#include <mpmstab/growth.h>
#include <math.h>

const char *const MpmVerdictNames[]    = {"stable", "unstable", "undecided", NULL};
const char *const MpmGrowthKindNames[] = {"bounded", "linear", "exponential", NULL};

#define FEWEST_SAMPLES 8
#define LARGEST_LINEAR_RISE                                                                                  \
  1.0                       /* ln 2 when linear from the first step on; e leaves room for a slow start       \
                             */
#define CLEARLY_BETTER 1.25 /* ratio of residuals below which two fits are not told apart */

PetscErrorCode MpmSeriesAppend(MpmSeries *s, PetscInt64 step, PetscReal log_norm, PetscReal log_energy)
{
  PetscFunctionBegin;
  if (s->n == s->room) {
    s->room = PetscMax(512, 2 * s->room);
    PetscCall(PetscRealloc(sizeof(*s->step) * (size_t)s->room, &s->step));
    PetscCall(PetscRealloc(sizeof(*s->log_norm) * (size_t)s->room, &s->log_norm));
    PetscCall(PetscRealloc(sizeof(*s->log_energy) * (size_t)s->room, &s->log_energy));
  }
  s->step[s->n]       = step;
  s->log_norm[s->n]   = log_norm;
  s->log_energy[s->n] = log_energy;
  s->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSeriesDestroy(MpmSeries *s)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(s->step));
  PetscCall(PetscFree(s->log_norm));
  PetscCall(PetscFree(s->log_energy));
  s->n = s->room = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  PetscReal slope, rise, scatter, linear_scatter;
} Fit;

/* y = c + slope t: slope, rise over the window, and root mean square of what remains. */
static void FitExponential(PetscInt n, const PetscInt64 step[], const PetscReal y[], Fit *fit)
{
  PetscReal mean_t = 0, mean_y = 0, tt = 0, ty = 0, rest = 0;

  for (PetscInt i = 0; i < n; i++) {
    mean_t += (PetscReal)(step[i] - step[0]) / n;
    mean_y += y[i] / n;
  }
  for (PetscInt i = 0; i < n; i++) {
    const PetscReal t = (PetscReal)(step[i] - step[0]) - mean_t;

    tt += t * t;
    ty += t * (y[i] - mean_y);
  }
  fit->slope = ty / tt;
  fit->rise  = fit->slope * (PetscReal)(step[n - 1] - step[0]);
  for (PetscInt i = 0; i < n; i++)
    rest += PetscSqr(y[i] - mean_y - fit->slope * ((PetscReal)(step[i] - step[0]) - mean_t));
  fit->scatter = sqrt(rest / n);
}

/* N = exp(y) = a + b t with relative weights 1/N: minimises sum ((a + b t) / N - 1)^2. */
static void FitLinear(PetscInt n, const PetscInt64 step[], const PetscReal y[], Fit *fit)
{
  PetscReal aa = 0, ab = 0, bb = 0, ra = 0, rb = 0, rest = 0, a, b, det;

  for (PetscInt i = 0; i < n; i++) {
    const PetscReal w = exp(y[0] - y[i]),
                    t = (PetscReal)(step[i] - step[0]) / (PetscReal)(step[n - 1] - step[0]);

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
    const PetscReal t = (PetscReal)(step[i] - step[0]) / (PetscReal)(step[n - 1] - step[0]);
    rest += PetscSqr((a + b * t) * exp(y[0] - y[i]) - 1);
  }
  fit->linear_scatter = sqrt(rest / n);
}

static Fit FitLate(PetscInt n, const PetscInt64 step[], const PetscReal y[])
{
  Fit fit;

  FitExponential(n, step, y, &fit);
  FitLinear(n, step, y, &fit);
  return fit;
}

static PetscBool Grows(const Fit *fit, PetscReal tolerance)
{
  return fit->slope > log1p(tolerance) && fit->rise > 4 * fit->scatter ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool IsLinear(const Fit *fit)
{
  return fit->rise <= LARGEST_LINEAR_RISE && fit->linear_scatter < fit->scatter ? PETSC_TRUE : PETSC_FALSE;
}

MpmGrowth MpmGrowthFit(const MpmSeries *s, PetscReal tolerance, PetscBool watch_norm)
{
  MpmGrowth growth = {.measured = PETSC_FALSE, .decided = PETSC_TRUE, .kind = MPM_BOUNDED};
  PetscInt  late   = 0, n;
  Fit       energy, norm;

  while (late < s->n && 2 * s->step[late] < s->step[s->n - 1]) late++;
  n = s->n - late;
  if (n < FEWEST_SAMPLES) return growth;
  for (PetscInt i = late; i < s->n; i++)
    if (!isfinite(s->log_energy[i]) || !isfinite(s->log_norm[i])) return growth;
  energy          = FitLate(n, s->step + late, s->log_energy + late);
  norm            = FitLate(n, s->step + late, s->log_norm + late);
  growth.measured = PETSC_TRUE;
  growth.per_step = exp(energy.slope);
  growth.from     = s->step[late];
  growth.to       = s->step[s->n - 1];
  if (Grows(&energy, tolerance)) {
    const PetscReal worse  = PetscMax(energy.scatter, energy.linear_scatter),
                    better = PetscMin(energy.scatter, energy.linear_scatter);

    growth.kind = IsLinear(&energy) ? MPM_LINEAR : MPM_EXPONENTIAL;
    growth.decided =
        energy.rise > LARGEST_LINEAR_RISE || worse > CLEARLY_BETTER * better ? PETSC_TRUE : PETSC_FALSE;
  } else if (watch_norm && Grows(&norm, tolerance) && IsLinear(&norm))
    growth.kind = MPM_LINEAR;
  return growth;
}

MpmVerdict MpmGrowthVerdict(const MpmGrowth *growth, PetscReal tolerance)
{
  if (!growth->measured || !growth->decided) return MPM_UNDECIDED;
  return growth->kind == MPM_EXPONENTIAL && growth->per_step > 1 + tolerance ? MPM_UNSTABLE : MPM_STABLE;
}
