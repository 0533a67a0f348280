/*
   Growth of particles that move at a fixed fraction M of the wave speed. Their drift M k changes with the Courant
   number k, and only where it is a fraction p/q do they come back to their places, after q steps. So k goes over such
   numbers.
*/
#include "analysis/critical_mach.h"
#include "analysis/critical_parts.h"
#include "base/farm.h"
#include <mpmstab/symbol.h>
#include <math.h>

#define BEYOND 1.25 /* the search ends at so many times the limit of particles at rest, */
#define UNKNOWN 1.0 /* or of this where there is none or it is 0 */
#define MOST 100    /* steps of the Courant number */
#define FEWEST 12   /* and the least number of them, however long the periods */
#define WORK 1.28e6 /* bearable: steps of all periods, times the squared order of the matrices */
#define SPACE 16    /* so many times that in two and three dimensions, which have more phases */

typedef struct {
  const MpmCriticalCase *of;
  const MpmMach         *mach;
  MpmCriticalMach       *found;
  PetscReal             *numbers; /* growth, verdict and phases of each point */
} Work;
#define NUMBERS (2 + MPM_MAX_DIM)

static int Compare(const void *a, const void *b)
{
  const PetscReal x = ((const MpmMachPoint *)a)->courant, y = ((const MpmMachPoint *)b)->courant;

  return (x > y) - (x < y);
}

static void Append(const MpmMach *mach, const MpmFraction *part, MpmCriticalMach *c)
{
  c->points[c->n++] = (MpmMachPoint){.part = *part, .courant = MpmMachCourant(mach, part).value};
}

/* All fractions up to the largest with small denominators, each once. */
static void AppendAll(const MpmMach *mach, PetscInt room, MpmCriticalMach *c)
{
  for (PetscInt64 den = 1; den <= MPM_CRITICAL_MACH_ALL; den++)
    for (PetscInt64 num = 1; (PetscReal)num <= c->to * mach->unit.value * (PetscReal)den && c->n < room; num++) {
      const MpmFraction factors[2] = {{num, 1, (PetscReal)num}, {1, den, 1 / (PetscReal)den}};
      const MpmFraction part       = MpmFractionProduct(2, factors);

      if (part.den == den) Append(mach, &part, c);
    }
}

/* Those nearest to equal steps; returns the steps of their periods. */
static PetscReal AppendSteps(const MpmMach *mach, PetscInt steps, MpmCriticalMach *c)
{
  PetscReal all = 0;

  for (PetscInt i = 1; i <= steps; i++) {
    const MpmFraction part = MpmMachNearest(mach, c->to * i / steps, MPM_CRITICAL_MACH_STEPS);

    if (!part.den) continue;
    Append(mach, &part, c);
    all += (PetscReal)part.den;
  }
  c->steps = steps;
  return all;
}

/* Chooses the Courant numbers: with fewer steps where periods are long. */
static PetscErrorCode Choose(const MpmCriticalCase *of, const MpmMach *mach, MpmCriticalMach *c)
{
  const PetscReal order = (PetscReal)of->scheme->table->nstate * MpmLayoutPpc(of->layout),
                  work  = WORK / (order * order) / (of->layout->dim > 1 ? SPACE : 1);
  const PetscInt room   = 4096;
  PetscInt       all, n = 0;
  PetscReal      steps;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(room + MOST, &c->points));
  AppendAll(mach, room, c);
  all = c->n;
  for (PetscInt i = MOST;; i = PetscMax(i / 2, FEWEST)) {
    c->n  = all;
    steps = AppendSteps(mach, i, c);
    if (steps <= work || i == FEWEST) break;
  }
  qsort(c->points, (size_t)c->n, sizeof *c->points, Compare);
  for (PetscInt i = 0; i < c->n; i++)
    if (!n || c->points[n - 1].courant != c->points[i].courant) c->points[n++] = c->points[i];
  c->n = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Solve(void *context, PetscInt i)
{
  Work           *w       = (Work *)context;
  PetscReal      *numbers = w->numbers + NUMBERS * i;
  MpmCriticalCase at      = *w->of;
  MpmRefined      refined;
  MpmFinding      finding;

  PetscFunctionBegin;
  at.step.courant = w->found->points[i].courant;
  MpmMachDrift(w->mach, &w->found->points[i].part, at.step.drift);
  PetscCall(MpmRefinedGrowth(PETSC_COMM_SELF, at.layout, at.scheme, &at.step, PETSC_FALSE, &refined));
  PetscCall(MpmRefinedFinding(&refined, at.tolerance, &finding));
  numbers[0] = refined.growth;
  numbers[1] = finding.verdict;
  for (PetscInt a = 0; a < at.layout->dim; a++) numbers[2 + a] = isnan(refined.beta[0]) ? 0 : refined.beta[a];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SolveAll(const MpmCriticalCase *of, const MpmMach *mach, MpmCriticalMach *c)
{
  Work work = {.of = of, .mach = mach, .found = c};

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(NUMBERS * c->n, &work.numbers));
  PetscCall(MpmFarm("Courant number", c->n, Solve, &work));
  PetscCall(MpmFarmSumReals(NUMBERS * c->n, work.numbers));
  for (PetscInt i = 0; i < c->n; i++) {
    c->points[i].growth  = work.numbers[NUMBERS * i];
    c->points[i].verdict = (PetscInt)work.numbers[NUMBERS * i + 1];
    PetscCall(PetscArraycpy(c->points[i].beta, work.numbers + NUMBERS * i + 2, of->layout->dim));
  }
  PetscCall(PetscFree(work.numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Sum(MpmCriticalMach *c)
{
  const PetscReal largest = c->rest > 0 && c->rest < c->to ? c->rest : c->to;

  c->stable = c->n;
  for (PetscInt i = c->n - 1; i >= 0; i--) {
    const MpmMachPoint *p = &c->points[i];

    if (p->verdict != MPM_STABLE) c->stable = i;
    c->unstable += p->verdict == MPM_UNSTABLE;
    c->undecided += p->verdict == MPM_UNDECIDED;
    if (p->courant <= largest && p->growth > c->points[c->worst].growth) c->worst = i;
  }
}

PetscErrorCode MpmCriticalMachCreate(const MpmCriticalCase *of, const MpmMach *mach, MpmCriticalMach *c)
{
  const PetscReal begin = MPI_Wtime();
  MpmCriticalCase rest  = *of;
  MpmCritical     limit;
  MpmRefined      refined;

  PetscFunctionBegin;
  *c = (MpmCriticalMach){.n = 0};
  MpmCheckInput(!MpmSymbolWhyNot(of->layout),
                "mach: %s; allowed: a full periodic domain with the same particles in every cell",
                MpmSymbolWhyNot(of->layout));
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) rest.step.drift[a] = (MpmFraction){.den = 1};
  PetscCall(MpmCriticalFind(&rest, PETSC_TRUE, &limit));
  c->rest = limit.courant;
  c->to   = c->rest > 0 && isfinite(c->rest) ? BEYOND * c->rest : UNKNOWN;
  PetscCall(Choose(of, mach, c));
  MpmCheckInput(c->n,
                "mach %.6g: up to Courant number %.6g particles take more than %d steps for a cell; allowed: larger",
                mach->unit.value, c->to, MPM_LONGEST_PERIOD);
  PetscCall(SolveAll(of, mach, c));
  Sum(c);
  PetscCall(MpmRefinedGrowth(PETSC_COMM_WORLD, of->layout, of->scheme, &of->step, PETSC_FALSE, &refined));
  PetscCall(MpmRefinedFinding(&refined, of->tolerance, &c->asked));
  c->theorem.asked = c->asked;
  PetscCall(MpmCriticalQuieten(of, &c->theorem));
  c->asked   = c->theorem.asked;
  c->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalMachDestroy(MpmCriticalMach *c)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(c->points));
  PetscFunctionReturn(PETSC_SUCCESS);
}
