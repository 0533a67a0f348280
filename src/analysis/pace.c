/* Chooses the steps of a run by the fastest waves at any particle. */
#include "analysis/pace.h"
#include "analysis/neighbourhood.h"
#include "base/text.h"
#include "march/march_private.h"
#include "march/finite.h"
#include <mpmstab/critical.h>
#include <mpmstab/errors.h>
#include <math.h>

#define CELLS 16     /* of the layout whose limit is sought; the limit of an endless one does not depend on them */
#define FARTHEST 0.9 /* cells that a particle may move in a step; a run ends where one goes a whole cell */
#define WORTH 1.18   /* a step is printed when it is so many times larger or smaller than the one printed before */
#define DIGITS 1e6   /* the limit is rounded, since a search on other ranks ends with other last digits */
#define SAME_TIME 1e-12
#define TOLERANCE 1e-6 /* growth per step above 1 + TOLERANCE counts */

/*
   Cells that particles may move until P is looked at anew and until a new certificate, for hats and for others; what P
   may fall to until then, and how many times slower the fastest waves may become until P is looked at: others may
   decide then. scripts/step_moved.py measured what the limit falls to meanwhile.
*/
#define LOOK(basis) ((basis)->hat ? 0.05 : 0.25)
#define LIFE(basis) ((basis)->hat ? 2 : 4)
#define FALLS 0.9
#define FADES 1.05
#define SAME_LEVEL 1e-9 /* levels: rounding, which differs between ranks, does not choose among steps */

const char *const MpmPaceReasonNames[]             = {"waves", "motion", "end"};
const PetscReal   MpmPaceFactors[MPM_PACE_FACTORS] = {1, 1.1, 1.25, 1.5, 2};

/* ---- the limit of the linear scheme ---- */

/* A periodic domain with the particles of the scene in each cell, all at their sites. */
static PetscErrorCode LayoutAtRest(const MpmScene *scene, MpmScene **rest)
{
  const MpmLayout *l = &scene->layout;
  char             text[512], part[64];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof text, "{formulation: usl, dim: %" PetscInt_FMT ", cells: %d, basis: %s, ppc: '",
                          l->dim, CELLS, scene->scheme.basis->name));
  for (PetscInt a = 0; a < l->dim; a++) {
    PetscCall(PetscSNPrintf(part, sizeof part, "%s%" PetscInt_FMT, a ? "," : "", l->ppc[a]));
    MpmTextJoin(text, part, sizeof text);
  }
  MpmTextJoin(text, "', offset: '", sizeof text);
  for (PetscInt a = 0; a < l->dim; a++) {
    PetscCall(PetscSNPrintf(part, sizeof part, "%s%.17g", a ? "," : "", l->offset[a].value));
    MpmTextJoin(text, part, sizeof text);
  }
  MpmTextJoin(text, "'}", sizeof text);
  PetscCall(MpmSceneFromText(text, rest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Poisson's ratio at rest, of which the linear scheme knows the material; 1/2 of a fluid. */
static PetscReal PoissonOf(const MpmMaterialNumbers *m)
{
  return m->law->solid ? m->lambda / (2 * (m->lambda + m->mu)) : 0.5;
}

/* Whether particles end somewhere inside the grid, or at a free end: there they are near a surface, or alone. */
static PetscBool HasSurface(const MpmLayout *layout)
{
  for (PetscInt a = 0; a < layout->dim; a++)
    if (layout->grid[a].ends[0] == MPM_FREE || layout->grid[a].ends[1] == MPM_FREE) return PETSC_TRUE;
  return MpmLayoutIsFull(layout) ? PETSC_FALSE : PETSC_TRUE;
}

/*
   The limit of a lone particle, in closed form where there is one, else by a search. Without a limit, or one that the
   search tells, that at an edge counts.
*/
static PetscErrorCode LimitAtSurface(const MpmCriticalCase *of, PetscReal *limit, MpmNeighbourhoodKind *where)
{
  MpmNeighbourhood found;

  PetscFunctionBegin;
  PetscCall(MpmLoneFind(of->layout, of->scheme, of->step.courant, &found));
  if (!found.closed) PetscCall(MpmPatchFind(of, MPM_ALONE, &found));
  *limit = found.courant;
  *where = MPM_ALONE;
  if (isfinite(*limit)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmPatchFind(of, MPM_AT_EDGE, &found));
  *limit = found.courant;
  *where = MPM_AT_EDGE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LimitAtRest(const MpmScene *scene, const MpmMaterialNumbers *material, PetscReal *limit,
                                  MpmNeighbourhoodKind *where)
{
  MpmCriticalCase of     = {.tolerance = TOLERANCE};
  MpmScheme       scheme = scene->scheme;
  MpmScene       *rest;
  MpmCritical     critical;

  PetscFunctionBegin;
  PetscCall(LayoutAtRest(scene, &rest));
  scheme.space          = rest->scheme.space;
  scheme.space.gradient = scene->scheme.space.gradient;
  scheme.space.filter   = scene->scheme.space.filter;
  scheme.space.poisson  = PoissonOf(material);
  PetscCall(MpmTableCreate(scheme.formulation, scheme.transfer, &scheme.numbers, &scheme.space, &scheme.table));
  of.layout = &rest->layout;
  of.scheme = &scheme;
  of.step   = (MpmStep){.courant = 1};
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) of.step.drift[a] = (MpmFraction){.den = 1};
  PetscCall(MpmCriticalFind(&of, PETSC_TRUE, &critical));
  *limit = critical.courant;
  *where = MPM_IN_BULK;
  if (HasSurface(&scene->layout)) {
    PetscReal            other = NAN;
    MpmNeighbourhoodKind at    = MPM_IN_BULK;

    PetscCall(LimitAtSurface(&of, &other, &at));
    if (!(other >= *limit)) {
      *limit = other;
      *where = at;
    }
  }
  PetscCall(MpmTableDestroy(&scheme.table));
  PetscCall(MpmSceneDestroy(&rest));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K where no bound is known: the least of all materials. */
static PetscErrorCode FindAtRest(const MpmScene *scene, MpmPace *pace)
{
  const MpmMaterialNumbers *material = &scene->scheme.space.material;
  const MpmMaterials       *all      = material->several;
  MpmNeighbourhoodKind      where    = MPM_IN_BULK;
  PetscReal                 limit    = INFINITY;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < (all ? all->n : 1); i++) {
    MpmNeighbourhoodKind at;
    PetscReal            own;

    PetscCall(LimitAtRest(scene, all ? &all->of[i] : material, &own, &at));
    if (own >= limit) continue;
    limit = own;
    where = at;
  }
  limit = rint(limit * DIGITS) / DIGITS;
  MpmCheckInput(limit > 0 && isfinite(limit),
                "%s: the scheme has no largest stable step with particles at rest (%s, %s); allowed: a number, or "
                "another scheme",
                scene->watched ? "step_bound" : "courant auto", MpmNeighbourhoodNames[where],
                isnan(limit) ? "where the limit is undecided"
                : limit > 0  ? "where all are stable"
                             : "where none is stable");
  pace->where      = where;
  pace->held.limit = pace->held.first = limit;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPaceCreate(const MpmScene *scene, const MpmRequest *request, MpmPace **pace)
{
  const MpmStep rest = {.courant = 1};

  PetscFunctionBegin;
  PetscCall(PetscNew(pace));
  **pace = (MpmPace){.end     = INFINITY,
                     .least   = INFINITY,
                     .fastest = NAN,
                     .motion  = NAN,
                     .number  = NAN,
                     .chance  = request->step_bound_chance};
  if (request->end > 0) (*pace)->end = request->end * scene->wave_speed / scene->cell_width;
  (*pace)->why_not = MpmStepBoundWhyNot(&scene->layout, &scene->scheme, &rest);
  MpmCheckInput(!(*pace)->why_not || !MpmSpaceIsDamped(&scene->scheme.space), "%s: %s; allowed: %s%s",
                scene->watched ? "step_bound" : "courant auto", (*pace)->why_not,
                scene->watched ? "to leave it out" : "with a number for courant",
                scene->scheme.space.local != 0 ? "" : ", or formulation musl, usf or usavg and transfer flip");
  if ((*pace)->why_not) PetscCall(FindAtRest(scene, *pace));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPaceDestroy(MpmPace **pace)
{
  PetscFunctionBegin;
  if (*pace) PetscCall(PetscFree((*pace)->moduli));
  PetscCall(PetscFree(*pace));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const char *MpmPaceLimitName(const MpmPace *pace)
{
  return pace->why_not ? MpmNeighbourhoodNames[pace->where] : MpmStepBoundNames[pace->by];
}

/* ---- the next step ---- */

PetscBool MpmPaceIsOver(const MpmPace *pace, const MpmMarch *march)
{
  return march->elapsed >= pace->end * (1 - SAME_TIME) ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmPaceSpeeds(const MpmMarch *march, PetscReal **moduli, PetscReal speed[2])
{
  const MpmTable *t   = march->scheme->table;
  const PetscInt  dim = t->dim, components = MpmTableStretches(t), n = march->particles->count;
  MpmMarchArrays  at = {.march = march};

  PetscFunctionBegin;
  speed[0] = speed[1] = 0;
  PetscCall(PetscFree(*moduli));
  PetscCall(PetscMalloc1(n, moduli));
  PetscCall(MpmMarchGetArrays(march, march->particles->step, &at));
  for (PetscInt p = 0; p < n; p++) {
    PetscReal F[MPM_MOST_STRETCH], modulus, square;

    for (PetscInt c = 0; c < components; c++) F[c] = at.particle[t->stretch + c][p];
    modulus      = MpmMaterialModulus(&t->material, dim, F);
    (*moduli)[p] = modulus > 0 ? modulus * march->scheme->space.stiffness : 0;
    square       = (*moduli)[p];
    if (at.weight[MPM_STIFFNESS]) square *= at.weight[MPM_STIFFNESS][p];
    if (at.weight[MPM_VOLUME]) square *= at.weight[MPM_VOLUME][p];
    if (at.weight[MPM_MASS]) square /= at.weight[MPM_MASS][p];
    speed[0] = PetscMax(speed[0], square);
  }
  speed[0] = sqrt(speed[0]);
  for (PetscInt r = 0; r < t->nstate; r++)
    for (PetscInt p = 0; t->field[r] != MPM_STRETCHED && t->field[r] != MPM_NONE && p < n; p++)
      speed[1] = PetscMax(speed[1], fabs(at.particle[r][p]));
  PetscCall(MpmMarchRestoreArrays(march, &at));
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, speed, 2, MPIU_REAL, MPI_MAX, PetscObjectComm((PetscObject)march->grid->da)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Speeds(MpmPace *pace, const MpmMarch *march)
{
  PetscReal speed[2];

  PetscFunctionBegin;
  PetscCall(MpmPaceSpeeds(march, &pace->moduli, speed));
  pace->fastest = speed[0];
  pace->motion  = speed[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds bounds of a march's particles; value: that of the kind, which may have MPM_BOUND_LOSS, too. */
static PetscErrorCode Bound(const MpmPace *pace, MpmMarch *march, PetscInt kind, MpmStepBounds *b, PetscReal *value)
{
  PetscFunctionBegin;
  *b = (MpmStepBounds){
      .kinds = kind, .moduli = pace->moduli, .chance = pace->chance, .seed = march->layout->seed + march->step};
  PetscCall(MpmStepBoundsFind(march, b));
  *value = kind & MPM_BOUND_LONE ? b->lone : kind & MPM_BOUND_PARTICLE ? b->particle : b->lanczos;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A certificate where there is none that holds. */
static PetscErrorCode Certify(MpmPace *pace, MpmMarch *march, PetscReal particle)
{
  MpmPaceHeld  *h = &pace->held;
  MpmStepBounds b;

  PetscFunctionBegin;
  if (h->certified > 0 && h->way <= LIFE(march->scheme->basis) &&
      particle * pace->fastest >= FALLS * h->particle * h->fastest)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Bound(pace, march, MPM_BOUND_LANCZOS | MPM_BOUND_LOSS, &b, &h->certified));
  PetscCall(PetscArraycpy(h->form, b.form, 2));
  h->particle = particle;
  h->fastest  = pace->fastest;
  h->way      = 0;
  h->certificates++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Looks at the bound of the particles as they stand. Where no waves travel at all there is none, and K stays. */
static PetscErrorCode Look(MpmPace *pace, MpmMarch *march)
{
  const MpmStepBound asked = march->scene->step_bound;
  MpmPaceHeld       *h     = &pace->held;
  MpmStepBounds      b;
  PetscReal          limit;

  PetscFunctionBegin;
  if (!(pace->fastest > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Bound(pace, march,
                  asked == MPM_STEP_LONE       ? MPM_BOUND_LONE | MPM_BOUND_LOSS
                  : asked == MPM_STEP_PARTICLE ? MPM_BOUND_PARTICLE | MPM_BOUND_LOSS
                                               : MPM_BOUND_PARTICLE,
                  &b, &pace->number));
  if (asked != MPM_STEP_LANCZOS) PetscCall(PetscArraycpy(h->form, b.form, 2));
  pace->at = asked == MPM_STEP_LONE ? b.lone_at : b.particle_at;
  pace->by = asked;
  limit    = pace->number * pace->fastest;
  if (asked == MPM_STEP_LANCZOS) {
    PetscReal certified;

    PetscCall(Certify(pace, march, pace->number));
    certified = h->certified * PetscMin(h->fastest, pace->number * pace->fastest / h->particle);
    pace->by  = certified > limit ? MPM_STEP_LANCZOS : MPM_STEP_PARTICLE;
    limit     = PetscMax(limit, certified);
  }
  h->falls = asked == MPM_STEP_LANCZOS ? PetscMax(1, h->particle * h->fastest / (pace->number * pace->fastest)) : 1;
  limit    = rint(limit * DIGITS) / DIGITS;
  MpmCheckInput(limit > 0 || march->scene->safety == 0,
                "courant auto: bound %s allows no step at step %" PetscInt64_FMT ", since particle %" PetscInt64_FMT
                " meets a node; allowed: step_bound particle or lanczos",
                MpmStepBoundNames[asked], march->step + 1, pace->at.id);
  h->limit = limit;
  h->seen  = 0;
  h->waves = pace->fastest;
  h->looks++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the bound of the last look may not hold any more. */
static PetscBool IsOld(const MpmPace *pace, const MpmMarch *march)
{
  const MpmPaceHeld *h = &pace->held;

  return march->scene->step_bound != MPM_STEP_LANCZOS || h->looks == 0 || h->seen > LOOK(march->scheme->basis) ||
                 pace->fastest * FADES < h->waves
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/*
   The largest artificial viscosity that a step can begin with: of the nodes' velocities a particle sees differences of
   at most twice the largest, along each axis.
*/
static PetscErrorCode FirstArtificial(const MpmMarch *march, MpmPace *pace)
{
  const PetscReal *number  = march->scheme->space.material.artificial;
  PetscReal        density = 0;
  MpmMarchArrays   at      = {.march = march};

  PetscFunctionBegin;
  if (number[0] == 0 && number[1] == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmMarchGetArrays(march, march->particles->step, &at));
  for (PetscInt p = 0; p < march->particles->count; p++)
    density = PetscMax(density, (at.weight[MPM_MASS] ? at.weight[MPM_MASS][p] : 1) /
                                    (at.weight[MPM_VOLUME] ? at.weight[MPM_VOLUME][p] : 1));
  PetscCall(MpmMarchRestoreArrays(march, &at));
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, &density, 1, MPIU_REAL, MPI_MAX, PetscObjectComm((PetscObject)march->grid->da)));
  pace->held.artificial = density * (number[0] * pace->fastest + 4 * number[1] * march->layout->dim * pace->motion);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPaceTook(MpmPace *pace, const MpmMarch *march)
{
  const PetscReal *number = march->scheme->space.material.artificial;

  PetscFunctionBegin;
  if (number[0] == 0 && number[1] == 0) PetscFunctionReturn(PETSC_SUCCESS);
  pace->held.artificial = march->watch->viscosity;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &pace->held.artificial, 1, MPIU_REAL, MPI_MAX,
                             PetscObjectComm((PetscObject)march->grid->da)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPaceBegin(MpmPace *pace, MpmMarch *march, const MpmRequest *request)
{
  MpmPaceHeld *h = &pace->held;

  PetscFunctionBegin;
  if (!pace->why_not && h->looks == 0) {
    PetscCall(Speeds(pace, march));
    PetscCall(FirstArtificial(march, pace));
    PetscCall(Look(pace, march));
    MpmCheckInput(h->looks > 0, "courant auto: no waves travel at the start; allowed: a number");
    h->first = h->limit;
  }
  pace->expected = request->end > 0 ? ceil(pace->end / (march->scene->safety * h->first)) : (PetscReal)request->steps;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   What damping and viscosity take at most. As the bounds of a certificate, what it depends on grows as bound particle
   falls.
*/
static PetscReal Loss(const MpmPace *pace, const MpmMarch *march)
{
  const MpmPaceHeld *h = &pace->held;

  return PetscSqr(h->falls) * MpmStepLoss(&march->scheme->space, h->form, h->artificial);
}

/* The bound of the step, or K without one, of the waves of now, colliders that push, damping and viscosity. */
static PetscReal BoundOfNow(const MpmPace *pace, const MpmMarch *march)
{
  const PetscReal push  = sqrt(MpmCollidersStiffness(march->layout->colliders)) / 2;
  const PetscReal alone = pace->fastest > 0 ? pace->held.limit / pace->fastest : pace->held.limit;

  /* docs/floors.md has the proofs. */
  return MpmStepWithLoss(push > 0 ? 1 / hypot(1 / alone, push) : alone, Loss(pace, march));
}

/* Counts the next step among those under the bound, or above it. */
static void Compare(MpmPace *pace, const MpmMarch *march)
{
  const PetscReal share = BoundOfNow(pace, march) / march->courant;
  MpmPaceHeld    *h     = &pace->held;

  h->steps++;
  for (PetscInt f = 0; f < MPM_PACE_FACTORS; f++) h->under[f] += share >= MpmPaceFactors[f] * (1 - SAME_TIME);
  if (h->above == 0 && share < 1 - SAME_TIME) h->above = (PetscReal)march->step + 1;
  h->share = h->steps > 1 ? PetscMin(h->share, share) : share;
}

/* Notes which particle decides P now. */
static void NoteDecider(MpmPace *pace, const MpmMarch *march)
{
  MpmPaceHeld *h = &pace->held;

  h->id     = (PetscReal)pace->at.id;
  h->number = pace->number;
  h->step   = (PetscReal)march->step + 1;
  for (PetscInt a = 0; a < march->layout->dim; a++) h->place[a] = pace->at.place[a];
}

PetscErrorCode MpmPaceWatch(MpmPace *pace, MpmMarch *march)
{
  MpmPaceHeld    *h      = &pace->held;
  const PetscReal before = h->steps > 0 ? h->share : INFINITY;

  PetscFunctionBegin;
  PetscCall(Speeds(pace, march));
  if (h->looks == 0) PetscCall(FirstArtificial(march, pace));
  if (!pace->why_not && IsOld(pace, march)) PetscCall(Look(pace, march));
  if (h->looks == 0 && !pace->why_not) PetscFunctionReturn(PETSC_SUCCESS); /* no waves travel yet */
  Compare(pace, march);
  if (h->share < before && !pace->why_not) NoteDecider(pace, march);
  h->way += pace->motion * march->courant;
  h->seen += pace->motion * march->courant;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The Courant number of the next step. It follows from the state, the time and what the pace holds, which checkpoints
   have, so that a run that resumes goes on as it would have. Where no waves travel at all, the step of the start is
   taken.
*/
static PetscReal Choose(MpmPace *pace, const MpmMarch *march)
{
  const PetscReal safety = march->scene->safety, first = safety * pace->held.first,
                  waves  = safety * BoundOfNow(pace, march);
  const PetscReal motion = FARTHEST / pace->motion, left = pace->end - march->elapsed;
  PetscReal       k = PetscMin(waves, motion);

  pace->reason = waves <= motion ? MPM_PACE_WAVES : MPM_PACE_MOTION;
  k            = first * exp2(floor(MPM_PACE_LEVELS * log2(k / first) + SAME_LEVEL) / MPM_PACE_LEVELS);
  if (left >= 2 * k) return k;
  pace->reason = MPM_PACE_END;
  return left > k ? left / 2 : left; /* two steps share what is left, so that the last one is not tiny */
}

PetscErrorCode MpmPaceStep(MpmPace *pace, MpmMarch *march, PetscInt64 *last)
{
  MpmPaceHeld *h = &pace->held;
  PetscReal    courant;

  PetscFunctionBegin;
  PetscCall(Speeds(pace, march));
  if (!pace->why_not && IsOld(pace, march)) PetscCall(Look(pace, march));
  courant = Choose(pace, march);
  if (courant >= pace->end - march->elapsed) *last = PetscMin(*last, march->step + 1);
  if (courant != march->courant) {
    PetscCall(MpmMarchSetCourant(march, courant));
    PetscCall(MpmMarchStart(march));
    pace->changes += march->step > 0 ? 1 : 0;
  }
  Compare(pace, march);
  if (pace->reason != MPM_PACE_END && courant < pace->least && isfinite(pace->number)) NoteDecider(pace, march);
  h->way += pace->motion * courant;
  h->seen += pace->motion * courant;
  if (pace->reason != MPM_PACE_END) {
    pace->least   = PetscMin(pace->least, courant);
    pace->largest = PetscMax(pace->largest, courant);
    pace->sum += courant;
  }
  pace->taken[pace->reason]++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPaceTell(MpmPace *pace, const MpmMarch *march)
{
  const MpmScene *scene = march->scene;
  const PetscReal ratio = pace->told > 0 ? march->courant / pace->told : INFINITY;

  PetscFunctionBegin;
  if (pace->reason == MPM_PACE_END || (ratio < WORTH && ratio > 1 / WORTH)) PetscFunctionReturn(PETSC_SUCCESS);
  pace->told = march->courant;
  MpmPrint("step %" PetscInt64_FMT ": dt = %.6g, ", march->step + 1, MpmSceneTimeStep(scene, march->courant));
  if (pace->reason == MPM_PACE_MOTION)
    MpmPrint("in which the fastest particle, of speed %.4g, moves at most %g of a cell\n",
             pace->motion * scene->wave_speed, FARTHEST);
  else
    MpmPrint("%g of %.6g h / c (%s), at the fastest waves, c = %.4g\n", scene->safety, pace->held.limit,
             MpmPaceLimitName(pace), pace->fastest * scene->wave_speed);
  PetscFunctionReturn(PETSC_SUCCESS);
}
