/*
   The largest Courant number with growth within tolerance in one dimension for particles that move, through the symbol.

   Windows of growth open along curves of the plane of phase beta and Courant number k, where two amplification factors
   meet. Each of many phases is followed upwards in k (see follow.h). Then each curve that may reach the tolerance
   between two of those phases is followed in beta: where its window is open, down in k; where it is not, towards the
   phase at which it is widest.
*/
#include "analysis/critical_parts.h"
#include "analysis/follow.h"
#include "symbol/bloch.h"
#include "base/progress.h"
#include "base/text.h"
#include <mpmstab/symbol.h>
#include <math.h>

#define COARSE 32   /* the first pass takes one phase in so many, later passes halve the distance */
#define MARGIN 0.01 /* other phases are followed to so far above the least limit so far, relative */
#define LEAST_BETA 1e-6
#define FINEST 1e-9  /* step in beta that ends a descent */
#define LOWER 1e-12  /* relative gain in k that counts */
#define SLOPE 8      /* a curve rises by at most this times the step in beta, */
#define SLOPE_LONG 2 /* and in long waves by k / beta times this more */
#define WIDEST 100   /* a widest place is found to this part of the distance between phases */
#define PROMISING 3  /* halvings after which a curve must have reached half the tolerance */

#define NEAR_LIMIT 1e-4 /* factors that could not be told apart so near the limit do not matter (relative) */

typedef struct {
  PetscReal stable, unstable, beta;
} Limit;

typedef struct {
  PetscReal  phase; /* m of MpmSearchPhase */
  MpmMeeting meeting;
} Place;

/*
   Computes the amplification factors of a turn along a line: over Courant numbers at a fixed phase, or over phases at
   a fixed Courant number.
*/
typedef struct {
  MpmBloch      bloch;
  MpmSmallEigen eigen;
  MpmFollow     follow;
  PetscReal     fixed, log_tolerance; /* log_tolerance: of 1 + tolerance */
  PetscBool     over_phases;
  Limit         least, phases[MPM_CRITICAL_PHASES + 1];
  PetscInt      nplaces, room;
  Place        *places;
} Plane;

static PetscErrorCode FactorsAt(void *context, PetscReal x, double complex value[])
{
  Plane          *p    = (Plane *)context;
  const PetscReal beta = p->over_phases ? x : p->fixed, courant = p->over_phases ? p->fixed : x;
  PetscInt        exponent;

  PetscFunctionBegin;
  PetscCall(MpmBlochTurns(&p->bloch, 1, &courant, &beta, p->eigen.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&p->eigen, PETSC_FALSE));
  for (PetscInt i = 0; i < p->eigen.n; i++) value[i] = p->eigen.value[i] * scalbn(1, (int)exponent);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PlaneCreate(const MpmCriticalCase *of, Plane **plane)
{
  Plane *p;

  PetscFunctionBegin;
  PetscCall(PetscNew(plane));
  p                = *plane;
  p->log_tolerance = log1p(of->tolerance);
  p->least         = (Limit){INFINITY, INFINITY, NAN};
  PetscCall(MpmBlochCreate(of->layout, of->scheme, of->step.drift, &p->bloch));
  PetscCall(MpmSmallEigenCreate(p->bloch.turn_size, &p->eigen));
  PetscCall(MpmFollowCreate(p->bloch.turn_size, p->bloch.turn, of->tolerance, FactorsAt, p, &p->follow));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PlaneDestroy(Plane **plane)
{
  PetscFunctionBegin;
  PetscCall(MpmFollowDestroy(&(*plane)->follow));
  PetscCall(MpmSmallEigenDestroy(&(*plane)->eigen));
  PetscCall(MpmBlochDestroy(&(*plane)->bloch));
  PetscCall(PetscFree((*plane)->places));
  PetscCall(PetscFree(*plane));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Finds the first Courant number of [from, to] that grows at a phase. If from grows already, the search goes down from
   there.
*/
static PetscErrorCode LimitBetween(Plane *p, PetscReal beta, PetscReal from, PetscReal to, Limit *limit)
{
  PetscReal bracket[2];

  PetscFunctionBegin;
  p->fixed = beta;
  PetscCall(MpmFollowFirst(&p->follow, PetscMin(MPM_CRITICAL_FROM, from / 2), from, to, bracket));
  *limit = (Limit){bracket[0], bracket[1], beta};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Goes from a limit at a phase to lower limits at phases beside it, with ever smaller steps in beta. */
static PetscErrorCode Descend(Plane *p, Limit limit, PetscReal step)
{
  Limit beside = limit;
  int   side   = 1;

  PetscFunctionBegin;
  for (int failed = 0; step > FINEST;) {
    const PetscReal beta = PetscMin(PetscMax(limit.beta + side * step, LEAST_BETA), PETSC_PI);
    const PetscReal rise = fabs(beta - limit.beta) * (SLOPE + SLOPE_LONG * limit.unstable / beta);

    if (beta != limit.beta) {
      PetscCall(LimitBetween(p, beta, PetscMax(limit.unstable / 2, limit.unstable - rise), limit.unstable, &beside));
      if (beside.unstable < limit.unstable * (1 - LOWER)) {
        limit  = beside;
        failed = 0;
        continue;
      }
    }
    side = -side;
    if (++failed < 2) continue;
    failed = 0;
    step /= 2;
  }
  if (limit.unstable < p->least.unstable) p->least = limit;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Among the meetings of the last line that grow more than a given meeting, finds the one that continues it. Returns
   NULL when there is none.
*/
static const MpmMeeting *Continued(const MpmFollow *f, const MpmMeeting *meeting)
{
  const MpmMeeting *found = NULL;
  PetscReal         least = INFINITY;

  for (PetscInt i = 0; i < f->nmeetings; i++) {
    const PetscReal off =
        cabs(cexp(I * f->meetings[i].angle) - cexp(I * meeting->angle)) + fabs(f->meetings[i].x / meeting->x - 1);

    if (f->meetings[i].peak <= meeting->peak || off >= least) continue;
    found = &f->meetings[i];
    least = off;
  }
  return found;
}

/*
   Follows a curve of meetings towards the phase of its largest growth. Where growth exceeds the tolerance, it descends
   from there.
*/
static PetscErrorCode Ascend(Plane *p, MpmMeeting meeting, PetscReal beta, PetscReal step)
{
  const PetscReal finest = step / WIDEST, promising = step / (1 << PROMISING);
  Limit           limit;
  int             side = 1;

  PetscFunctionBegin;
  for (int failed = 0; step > finest && (step > promising || meeting.peak > p->log_tolerance / 2);) {
    const PetscReal   next = PetscMin(PetscMax(beta + side * step, LEAST_BETA), PETSC_PI);
    const PetscReal   rise = fabs(next - beta) * (SLOPE + SLOPE_LONG * meeting.x / next);
    const PetscReal   from = PetscMax(meeting.x / 2, meeting.x - rise), to = meeting.x + rise;
    const MpmMeeting *on = NULL;

    if (next != beta && from < p->least.unstable) {
      PetscCall(LimitBetween(p, next, from, PetscMin(to, p->least.unstable), &limit));
      if (limit.unstable < p->least.unstable * (1 - LOWER)) {
        PetscCall(Descend(p, limit, step));
        PetscFunctionReturn(PETSC_SUCCESS);
      }
      on = Continued(&p->follow, &meeting);
    }
    if (on) {
      meeting = *on;
      beta    = next;
      failed  = 0;
      continue;
    }
    side = -side;
    if (++failed < 2) continue;
    failed = 0;
    step /= 2;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the limit of one phase, and the places where its amplification factors meet. */
static PetscErrorCode VisitPhase(Plane *p, PetscInt m, PetscReal bound)
{
  const PetscReal to = PetscMin(bound * (1 + MARGIN), MPM_CRITICAL_TO), from = PetscMin(MPM_CRITICAL_FROM, to / 2);
  MpmFollow      *f = &p->follow;

  PetscFunctionBegin;
  PetscCall(LimitBetween(p, MpmSearchPhase(m), from, to, &p->phases[m]));
  if (p->nplaces + f->nmeetings > p->room) {
    p->room = 2 * (p->nplaces + f->nmeetings);
    PetscCall(PetscRealloc(sizeof(*p->places) * (size_t)p->room, &p->places));
  }
  for (PetscInt i = 0; i < f->nmeetings; i++) p->places[p->nplaces++] = (Place){m, f->meetings[i]};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Visits all phases, spread over the ranks. It visits every COARSEth one first, since these limits bound the lines at
   the phases between.
*/
static PetscErrorCode VisitPhases(Plane *p, PetscMPIInt rank, PetscMPIInt size)
{
  PetscReal   bound = MPM_CRITICAL_TO;
  PetscInt    done  = 0;
  MpmProgress progress;

  PetscFunctionBegin;
  PetscCall(MpmProgressBegin("wave", &progress));
  for (PetscInt stride = COARSE; stride > 0; stride /= 2) {
    for (PetscInt m = MPM_CRITICAL_PHASES; m > 0; m -= stride) {
      if (stride < COARSE && m % (2 * stride) == 0) continue;
      p->phases[m] = (Limit){INFINITY, INFINITY, MpmSearchPhase(m)};
      if (done++ % size != rank) continue;
      PetscCall(VisitPhase(p, m, bound));
      PetscCall(MpmProgressUpdate(&progress, done, MPM_CRITICAL_PHASES));
    }
    for (PetscInt m = MPM_CRITICAL_PHASES; m > 0; m -= stride) bound = PetscMin(bound, p->phases[m].unstable);
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &bound, 1, MPIU_REAL, MPI_MIN, PETSC_COMM_WORLD));
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int ByPhase(const void *a, const void *b)
{
  const Place    *one = (const Place *)a, *other = (const Place *)b;
  const PetscReal d = one->phase != other->phase ? one->phase - other->phase : one->meeting.x - other->meeting.x;

  return (d > 0) - (d < 0);
}

/* Gives what all ranks have found to each of them, in the same order. */
static PetscErrorCode Gather(Plane *p, PetscMPIInt size)
{
  const PetscMPIInt width = sizeof(Place) / sizeof(PetscReal);
  PetscMPIInt      *counts, *begins, mine;
  PetscReal         limits[2 * (MPM_CRITICAL_PHASES + 1)] = {0};
  PetscInt          all                                   = 0;
  Place            *places;

  PetscFunctionBegin;
  for (PetscInt m = 1; m <= MPM_CRITICAL_PHASES; m++) {
    limits[2 * m]     = p->phases[m].stable;
    limits[2 * m + 1] = p->phases[m].unstable;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &p->follow.doubtful, 1, MPIU_REAL, MPI_MIN, PETSC_COMM_WORLD));
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, limits, 2 * (MPM_CRITICAL_PHASES + 1), MPIU_REAL, MPI_MIN, PETSC_COMM_WORLD));
  for (PetscInt m = 1; m <= MPM_CRITICAL_PHASES; m++)
    p->phases[m] = (Limit){limits[2 * m], limits[2 * m + 1], MpmSearchPhase(m)};
  PetscCall(PetscMPIIntCast(width * p->nplaces, &mine));
  PetscCall(PetscMalloc2(size, &counts, size, &begins));
  PetscCallMPI(MPI_Allgather(&mine, 1, MPI_INT, counts, 1, MPI_INT, PETSC_COMM_WORLD));
  for (PetscMPIInt r = 0; r < size; r++) {
    begins[r] = (PetscMPIInt)all;
    all += counts[r];
  }
  PetscCall(PetscMalloc1(all / width, &places));
  PetscCallMPI(MPI_Allgatherv(p->places, mine, MPIU_REAL, places, counts, begins, MPIU_REAL, PETSC_COMM_WORLD));
  PetscCall(PetscFree2(counts, begins));
  PetscCall(PetscFree(p->places));
  p->places  = places;
  p->nplaces = p->room = all / width;
  if (all > 0) qsort(places, (size_t)p->nplaces, sizeof(*places), ByPhase);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Spacing(PetscInt m)
{
  return MpmSearchPhase(PetscMin(m + 1, MPM_CRITICAL_PHASES)) - MpmSearchPhase(PetscMin(m, MPM_CRITICAL_PHASES - 1));
}

/* Returns whether a neighbouring phase has the same meeting with more growth. Then the search goes on from that one. */
static PetscBool IsOutgrown(const Plane *p, const Place *place)
{
  for (PetscInt i = 0; i < p->nplaces; i++) {
    const Place    *other = &p->places[i];
    const PetscReal d = fabs(other->phase - place->phase), turn = other->meeting.angle - place->meeting.angle;
    const PetscReal rise = Spacing((PetscInt)place->phase) * SLOPE;

    if (d > 0 && d <= 1 && other->meeting.peak > place->meeting.peak &&
        fabs(other->meeting.x - place->meeting.x) <= rise && cos(turn) > 0.9)
      return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Finds the least limit between the phases. Every rank does all of this work. */
static PetscErrorCode Refine(Plane *p)
{
  PetscReal bound = INFINITY;

  PetscFunctionBegin;
  for (PetscInt m = 1; m <= MPM_CRITICAL_PHASES; m++) bound = PetscMin(bound, p->phases[m].unstable);
  for (PetscInt m = MPM_CRITICAL_PHASES; m > 0 && isfinite(bound); m--) {
    const PetscReal limit = p->phases[m].unstable;

    if (limit > bound * (1 + MARGIN) || isinf(limit) || (m > 1 && p->phases[m - 1].unstable < limit) ||
        (m < MPM_CRITICAL_PHASES && p->phases[m + 1].unstable <= limit))
      continue;
    PetscCall(Descend(p, p->phases[m], Spacing(m) / 2));
  }
  for (PetscInt i = 0; i < p->nplaces; i++) {
    const Place   *place = &p->places[i];
    const PetscInt m     = (PetscInt)place->phase;

    if (place->meeting.x < p->least.unstable && !IsOutgrown(p, place))
      PetscCall(Ascend(p, place->meeting, MpmSearchPhase(m), Spacing(m) / 2));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies what was found to the result. */
static PetscErrorCode SetLimit(Plane *p, MpmCritical *c)
{
  PetscFunctionBegin;
  c->stable_at   = p->least.stable;
  c->unstable_at = p->least.unstable;
  c->beta[0]     = p->least.beta;
  c->courant     = c->stable_at;
  c->followed    = PETSC_TRUE;
  c->doubtful    = p->follow.doubtful < c->stable_at * (1 - NEAR_LIMIT) ? p->follow.doubtful : INFINITY;
  p->fixed       = c->beta[0];
  if (isfinite(c->unstable_at)) PetscCall(MpmSearchThreshold(MpmFollowGrowth, &p->follow, p->follow.tolerance, 0, c));
  c->evaluations += p->follow.evaluations;
  p->follow.evaluations = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the least limit that can be reached from a phase which grows at a Courant number. */
static PetscErrorCode Below(Plane *p, PetscReal courant, PetscReal beta)
{
  Limit limit;

  PetscFunctionBegin;
  PetscCall(LimitBetween(p, beta, PetscMin(MPM_CRITICAL_FROM, courant / 2), courant, &limit));
  if (isfinite(limit.unstable)) PetscCall(Descend(p, limit, PETSC_PI / MPM_CRITICAL_PHASES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalLineUnderDrift(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c)
{
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);
  Plane            *p;

  PetscFunctionBegin;
  PetscCall(PlaneCreate(of, &p));
  c->order = p->bloch.size;
  if (isfinite(start->unstable)) {
    PetscCall(Below(p, start->unstable, start->beta[0]));
  } else {
    PetscCall(VisitPhases(p, MpmRankOf(PETSC_COMM_WORLD), size));
    PetscCall(Gather(p, size));
    PetscCall(Refine(p));
  }
  if (isinf(start->unstable) || isfinite(p->least.unstable)) PetscCall(SetLimit(p, c));
  PetscCall(PlaneDestroy(&p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalLineGrowth(const MpmCriticalCase *of, MpmFinding *finding, PetscReal *beta)
{
  const MpmSymbolWish wish = {.phases = {2 * MPM_CRITICAL_PHASES}, .tolerance = of->tolerance};
  MpmSymbol          *symbol;
  PetscReal           bracket[2] = {0, INFINITY};
  Plane              *p;

  PetscFunctionBegin;
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, of->layout, of->scheme, &of->step, &wish, &symbol));
  *beta                    = symbol->beta_at_max[0];
  finding->tolerance       = of->tolerance;
  finding->growth          = symbol->growth;
  finding->uncertainty     = symbol->uncertainty;
  finding->defective_error = symbol->defective_error;
  PetscCall(PetscSNPrintf(finding->evidence, sizeof finding->evidence, "the symbol at %d phases, and followed between",
                          2 * MPM_CRITICAL_PHASES));
  finding->verdict = MpmVerdictOf(finding);
  PetscCall(MpmSymbolDestroy(&symbol));
  if (finding->verdict != MPM_STABLE) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PlaneCreate(of, &p));
  p->over_phases = PETSC_TRUE;
  p->fixed       = of->step.courant;
  PetscCall(MpmFollowLine(&p->follow, LEAST_BETA, PETSC_PI, bracket));
  if (isfinite(bracket[1])) {
    finding->growth      = exp(p->follow.peak);
    finding->uncertainty = finding->defective_error;
    *beta                = bracket[1];
  }
  finding->verdict = MpmVerdictOf(finding);
  if (finding->verdict == MPM_STABLE && isfinite(p->follow.doubtful)) {
    finding->verdict = MPM_UNDECIDED;
    MpmTextJoin(finding->evidence, ", but not all of its factors could be told apart", sizeof finding->evidence);
  }
  PetscCall(PlaneDestroy(&p));
  PetscFunctionReturn(PETSC_SUCCESS);
}
