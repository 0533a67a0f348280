/* Computes growth at the points of a rectangle, through the symbols of one scene after another. */
#include "symbol/predict.h"
#include <mpmstab/critical.h>
#include "base/farm.h"
#include "base/text.h"
#include "scene/layout.h"
#include "scheme/language.h"
#include "analysis/waves.h"
#include "analysis/stability_map.h"
#include <math.h>

#define MOST_POINTS 10000000

/*
   The components of a drift that is turned are fractions with a common denominator, the least one from here on that the
   scene's own drift has too. A period is so many steps. A drift M k has a denominator of at most this, or of a step for
   each part of a cell where it is slower.
*/
#define DENOMINATOR 240

#define TOGETHER 64 /* at most so many Courant numbers are computed together; what they share is then soon paid */

/*
   What the symbol of a point depends on: the scene's own layout, step and scheme, except for the two numbers that the
   map varies. turned, angle: the drift is turned to this angle. fixed, mach: the drift is M k. own: the point has its
   own table. nset, parameter, value: parameters of a written scheme, of which the point has its own formulation.
*/
typedef struct {
  MpmLayout layout;
  MpmStep   step;
  MpmScheme scheme;
  PetscBool turned, fixed, own;
  PetscReal angle;
  MpmMach   mach;

  PetscInt        nset, parameter[2];
  PetscReal       value[2];
  MpmFormulation *formulation;
} Point;

static Point OwnPoint(const MpmStabilityMap *map)
{
  return (Point){.layout = map->scene->layout,
                 .step   = map->scene->step,
                 .scheme = map->scene->scheme,
                 .mach   = map->request->mach,
                 .fixed  = MpmRequestKeepsMach(map->request)};
}

/* A drift goes along the axes that the scene's drift has, or along all. One that is turned begins along x. */
static void SetDrift(Point *at, const MpmStabilityMap *map, const MpmFraction *value)
{
  const MpmStep  *own  = &map->scene->step;
  const PetscBool turn = MpmRequestVaries(map->request, MPM_AXIS_DRIFT_ANGLE);

  for (PetscInt a = 0; a < at->layout.dim; a++)
    if (turn ? a == 0 : !MpmStepDrifts(own) || own->drift[a].value != 0) at->step.drift[a] = *value;
  if (turn) at->step.drift[1] = (MpmFraction){.den = 1};
}

/* A Mach number goes along the axes that the scene's drift has, or along all. */
static PetscErrorCode SetMach(Point *at, const MpmScene *scene, const MpmFraction *value)
{
  MpmFraction number[MPM_MAX_DIM];
  PetscBool   ok;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < at->layout.dim; a++)
    number[a] = !MpmSceneDrifts(scene) || scene->step.drift[a].value != 0 ? *value : (MpmFraction){.den = 1};
  MpmMachCreate(at->layout.dim, number, &at->mach, &ok);
  if (!ok) at->mach.unit.den = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetParameter(Point *at, const MpmStabilityMap *map, const MpmAxis *axis, const MpmFraction *value)
{
  PetscFunctionBegin;
  switch (axis->kind) {
  case MPM_AXIS_COURANT:
    at->step.courant = value->value;
    break;
  case MPM_AXIS_DRIFT:
    SetDrift(at, map, value);
    break;
  case MPM_AXIS_OFFSET:
    for (PetscInt a = 0; a < at->layout.dim; a++) at->layout.offset[a] = *value;
    break;
  case MPM_AXIS_PPC:
    MpmLayoutSetPpc(&at->layout, (PetscInt)value->num);
    break;
  case MPM_AXIS_POISSON:
    at->scheme.space.poisson = value->value;
    at->own                  = PETSC_TRUE;
    break;
  case MPM_AXIS_DRIFT_ANGLE:
    at->angle  = value->value * PETSC_PI / 180;
    at->turned = PETSC_TRUE;
    break;
  case MPM_AXIS_PARAMETER:
    at->parameter[at->nset] = axis->parameter;
    at->value[at->nset++]   = value->value;
    at->own                 = PETSC_TRUE;
    break;
  case MPM_AXIS_MACH:
    PetscCall(SetMach(at, map->scene, value));
    break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Turns the drift in the plane of x and y. */
static void Turn(Point *at)
{
  MpmFraction    *drift  = at->step.drift;
  const PetscReal size   = hypot(drift[0].value, drift[1].value);
  PetscInt64      common = drift[0].den;

  while (common % drift[1].den) common += drift[0].den;
  common *= (DENOMINATOR - 1) / common + 1;
  for (PetscInt a = 0; a < 2; a++) {
    const PetscInt64  n          = llrint((PetscReal)common * size * (a ? sin(at->angle) : cos(at->angle)));
    const MpmFraction factors[2] = {{n, 1, (PetscReal)n}, {1, common, 1 / (PetscReal)common}};

    drift[a] = MpmFractionProduct(2, factors);
  }
}

/* The drift M k, rounded to a fraction with a small denominator; its own is 0 where there is none. */
static void SetMachDrift(Point *at)
{
  const MpmFraction part =
      at->mach.unit.den ? MpmMachNearest(&at->mach, at->step.courant, DENOMINATOR) : (MpmFraction){.value = 1};

  MpmMachDrift(&at->mach, &part, at->step.drift);
}

/* Ends what SetParameter has begun. PointDestroy frees what this allocates. */
static PetscErrorCode PointFinish(Point *at)
{
  MpmScheme *scheme = &at->scheme;

  PetscFunctionBegin;
  if (at->turned) Turn(at);
  if (at->fixed) SetMachDrift(at);
  if (at->nset) {
    PetscCall(MpmWrittenCompile(scheme->formulation->written, at->nset, at->parameter, at->value, &at->formulation));
    if (scheme->formulation->transfer && scheme->transfer == scheme->formulation->transfer)
      scheme->transfer = at->formulation->transfer;
    scheme->formulation = at->formulation;
  }
  if (at->own)
    PetscCall(MpmTableCreate(scheme->formulation, scheme->transfer, &scheme->numbers, &scheme->space, &scheme->table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PointDestroy(Point *at)
{
  PetscFunctionBegin;
  if (at->own) PetscCall(MpmTableDestroy(&at->scheme.table));
  PetscCall(MpmWrittenFormulationDestroy(&at->formulation));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static MpmFraction NumberOf(const MpmAxis *axis, PetscInt i)
{
  return MpmFractionBetween(&axis->from, &axis->to, i, axis->points);
}

static PetscErrorCode PointCreate(const MpmStabilityMap *map, PetscInt point, Point *at)
{
  const PetscInt i[2] = {point / map->points[1], point % map->points[1]};

  PetscFunctionBegin;
  *at = OwnPoint(map);
  for (int a = 0; a < 2; a++) {
    const MpmFraction value = NumberOf(&map->request->axes[a], i[a]);

    PetscCall(SetParameter(at, map, &map->request->axes[a], &value));
  }
  PetscCall(PointFinish(at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses points at which a drift that follows from a direction or from a Mach number has no short period. */
static PetscErrorCode CheckDrifts(const MpmStabilityMap *map)
{
  PetscInt period;
  Point    at;

  PetscFunctionBegin;
  for (PetscInt point = 0; point < map->points[0] * map->points[1]; point++) {
    PetscCall(PointCreate(map, point, &at));
    for (PetscInt a = 0; a < at.layout.dim && at.fixed; a++)
      MpmCheckInput(at.step.drift[a].den,
                    "%s: at Courant number %.6g particles take more than %d steps for a cell; allowed: a larger Mach "
                    "number, or a larger Courant number",
                    map->request->at_mach ? "mach" : "map_mach", at.step.courant, MPM_LONGEST_PERIOD);
    PetscCall(MpmStepPeriod(&at.step, &period));
    PetscCall(PointDestroy(&at));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Refuses, on all ranks together, what could be refused at a point. The option's own range bounds the particles per
   cell.
*/
static PetscErrorCode Check(const MpmStabilityMap *map)
{
  const MpmRequest *request = map->request;
  Point             at      = OwnPoint(map);
  PetscInt          period;

  PetscFunctionBegin;
  for (int a = 0; a < 2; a++)
    for (PetscInt i = 0; i < map->points[a]; i++) {
      const MpmFraction value = NumberOf(&request->axes[a], i);

      MpmCheckInput(request->axes[a].kind != MPM_AXIS_DRIFT || (value.den > 0 && value.den <= MPM_LONGEST_PERIOD),
                    "map_drift with map_points %" PetscInt_FMT ",%" PetscInt_FMT
                    ": particles that drift by %.6g are not back in their places within %d steps; allowed: ends that "
                    "are fractions such as 1/2, and fewer points",
                    map->points[0], map->points[1], value.value, MPM_LONGEST_PERIOD);
      at.nset = 0;
      PetscCall(SetParameter(&at, map, &request->axes[a], &value));
      if (!at.fixed) PetscCall(MpmStepPeriod(&at.step, &period));
    }
  PetscCall(MpmSymbolCheck(&at.layout));
  if (at.fixed || at.turned) PetscCall(CheckDrifts(map));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth between the phases of the symbol, where it is larger there. */
static PetscErrorCode RefinePoint(MpmStabilityMap *map, const Point *at, PetscInt i, MpmFinding *f)
{
  MpmRefined r;

  PetscFunctionBegin;
  PetscCall(MpmRefinedGrowth(PETSC_COMM_SELF, &at->layout, &at->scheme, &at->step, PETSC_TRUE, &r));
  if (r.growth <= f->growth) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmRefinedFinding(&r, map->request->tolerance, f));
  map->growth[i] = r.growth;
  for (PetscInt a = 0; a < at->layout.dim; a++) {
    const PetscReal beta = r.beta[0] < 0 ? -r.beta[a] : r.beta[a]; /* the growth of beta and of -beta is the same */

    map->beta[a][i] = beta < 0 ? beta + 2 * PETSC_PI : beta;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps what the symbol of a point says. */
static PetscErrorCode KeepPoint(MpmStabilityMap *map, const Point *at, PetscInt i, const MpmSymbol *symbol)
{
  MpmFinding f = {.tolerance       = map->request->tolerance,
                  .growth          = symbol->growth,
                  .uncertainty     = symbol->uncertainty,
                  .defective_error = symbol->defective_error};

  PetscFunctionBegin;
  map->growth[i] = symbol->growth;
  f.verdict      = MpmVerdictOf(&f);
  for (PetscInt a = 0; a < at->layout.dim; a++) {
    if (map->drift[a]) map->drift[a][i] = at->step.drift[a].value;
    map->beta[a][i] = symbol->beta_at_max[a];
    PetscCall(MpmFindingOfPhases(&f, symbol->phases[a], at->layout.grid[a].cells));
  }
  if (map->request->refine) PetscCall(RefinePoint(map, at, i, &f));
  map->verdict[i] = f.verdict;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Part of a map: points that differ in their Courant number alone, at most TOGETHER of them. Where no axis is the
   Courant number, or the drift depends on it, a part is one point.

   n      - the number of points
   first, stride - the first point, and from a point to the next
   axis, at - the axis of the Courant number, and where the part begins along it; axis is MPM_NONE for one point
*/
typedef struct {
  PetscInt n, first, stride, axis, at;
} Part;

static PetscInt AxisOfParts(const MpmStabilityMap *map)
{
  const MpmAxis *axes = map->request->axes;

  if (!MpmRequestVaries(map->request, MPM_AXIS_COURANT) || MpmRequestKeepsMach(map->request)) return MPM_NONE;
  return axes[0].kind == MPM_AXIS_COURANT ? 0 : 1;
}

static PetscInt PartsAlong(const MpmStabilityMap *map, PetscInt axis)
{
  return (map->points[axis] + TOGETHER - 1) / TOGETHER;
}

static PetscInt Parts(const MpmStabilityMap *map)
{
  const PetscInt axis = AxisOfParts(map);

  return axis == MPM_NONE ? map->points[0] * map->points[1] : map->points[1 - axis] * PartsAlong(map, axis);
}

static Part PartOf(const MpmStabilityMap *map, PetscInt number)
{
  const PetscInt axis = AxisOfParts(map);
  PetscInt       across;
  Part           p;

  if (axis == MPM_NONE) return (Part){.n = 1, .first = number, .axis = MPM_NONE};
  across   = number / PartsAlong(map, axis);
  p.axis   = axis;
  p.at     = number % PartsAlong(map, axis) * TOGETHER;
  p.n      = PetscMin(TOGETHER, map->points[axis] - p.at);
  p.stride = axis == 0 ? map->points[1] : 1;
  p.first  = p.at * p.stride + across * (axis == 0 ? 1 : map->points[1]);
  return p;
}

static PetscErrorCode SolvePart(void *context, PetscInt number)
{
  MpmStabilityMap    *map    = context;
  const Part          part   = PartOf(map, number);
  const PetscInt     *phases = map->request->phases;
  const MpmSymbolWish wish   = {.phases    = {phases[0], phases[1], phases[2]},
                                .tolerance = map->request->tolerance}; /* the map's own progress line counts the parts */
  Point               at;
  PetscReal           courant[TOGETHER];
  MpmSymbol          *symbol[TOGETHER];

  PetscFunctionBegin;
  PetscCall(PointCreate(map, part.first, &at));
  for (PetscInt i = 0; i < part.n; i++)
    courant[i] = part.axis == MPM_NONE ? at.step.courant : NumberOf(&map->request->axes[part.axis], part.at + i).value;
  PetscCall(MpmSymbolsCreate(PETSC_COMM_SELF, &at.layout, &at.scheme, &at.step, part.n, courant, &wish, symbol));
  for (PetscInt i = 0; i < part.n; i++) {
    at.step.courant = courant[i];
    PetscCall(KeepPoint(map, &at, part.first + i * part.stride, symbol[i]));
    PetscCall(MpmSymbolDestroy(&symbol[i]));
  }
  PetscCall(PointDestroy(&at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Solve(MpmStabilityMap *map)
{
  const PetscInt n = map->points[0] * map->points[1];

  PetscFunctionBegin;
  PetscCall(MpmFarm("part", Parts(map), SolvePart, map));
  PetscCall(MpmFarmSumReals(n, map->growth));
  for (PetscInt a = 0; a < map->scene->layout.dim; a++) {
    PetscCall(MpmFarmSumReals(n, map->beta[a]));
    if (map->drift[a]) PetscCall(MpmFarmSumReals(n, map->drift[a]));
  }
  PetscCall(MpmFarmSumInts(n, map->verdict));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt64 MpmStabilityMapPhases(const MpmStabilityMap *map)
{
  PetscInt64 all = 1;

  for (PetscInt a = 0; a < map->waves; a++) all *= map->phases[a];
  return all;
}

PetscErrorCode MpmStabilityMapSum(MpmStabilityMap *map)
{
  const PetscInt n = map->points[0] * map->points[1];
  MpmFinding    *f = &map->finding;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    map->unstable += map->verdict[i] == MPM_UNSTABLE;
    map->undecided += map->verdict[i] == MPM_UNDECIDED;
    if (!(map->growth[i] <= map->growth[map->worst])) map->worst = i;
  }
  f->growth  = map->growth[map->worst];
  f->verdict = map->unstable ? MPM_UNSTABLE : map->undecided ? MPM_UNDECIDED : MPM_STABLE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the verdict on a scene's points rests on. */
static PetscErrorCode Explain(MpmStabilityMap *map)
{
  MpmFinding *f          = &map->finding;
  PetscBool   leaves_out = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < map->waves; a++)
    if (map->phases[a] % map->scene->layout.grid[a].cells) leaves_out = PETSC_TRUE;
  f->tolerance = map->request->tolerance;
  PetscCall(PetscSNPrintf(f->evidence, sizeof f->evidence,
                          "the symbol at %" PetscInt64_FMT " phases of each of %" PetscInt_FMT " points",
                          MpmStabilityMapPhases(map), map->points[0] * map->points[1]));
  if (leaves_out) MpmTextJoin(f->evidence, ", which leave out waves of the grid", sizeof f->evidence);
  if (map->request->refine) MpmTextJoin(f->evidence, ", and refined phases between them", sizeof f->evidence);
  if (MpmRequestVaries(map->request, MPM_AXIS_DRIFT_ANGLE))
    MpmTextJoin(f->evidence, "; drifts that are turned are rounded to fractions of a cell", sizeof f->evidence);
  if (map->drift[0])
    MpmTextJoin(f->evidence, "; drifts M k are rounded to fractions with small denominators", sizeof f->evidence);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PublishedLimit(MpmStabilityMap *map)
{
  MpmPredictor predictor;

  PetscFunctionBegin;
  if (!MpmRequestVaries(map->request, MPM_AXIS_COURANT)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmPredictorCreate(&map->scene->layout, &map->scene->scheme, PETSC_FALSE, NULL, &predictor));
  if (!predictor.why_not_published) map->published_limit = map->scene->scheme.formulation->published_limit;
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStabilityMapLimits(MpmStabilityMap *map)
{
  const MpmAxis *axes  = map->request->axes;
  const int      other = axes[0].kind == MPM_AXIS_COURANT ? 1 : 0;
  MpmCritical    critical;

  PetscFunctionBegin;
  if (!MpmRequestVaries(map->request, MPM_AXIS_COURANT)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(map->points[other], &map->limits));
  for (PetscInt i = 0; i < map->points[other]; i++) {
    Point at;

    PetscCall(PointCreate(map, other == 1 ? i : i * map->points[1], &at));
    PetscCall(MpmCriticalByClosedForm(&at.layout, &at.scheme, MpmStepDrifts(&at.step), &critical));
    map->limits[i] = critical.closed;
    PetscCall(PointDestroy(&at));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStabilityMapBegin(const MpmRequest *request, MpmStabilityMap **map)
{
  MpmStabilityMap *m;
  PetscInt         n;

  PetscFunctionBegin;
  MpmCheckInput((PetscReal)request->axes[0].points * request->axes[1].points <= MOST_POINTS,
                "map_points %" PetscInt_FMT ",%" PetscInt_FMT ": too many; allowed: at most %d together",
                request->axes[0].points, request->axes[1].points, MOST_POINTS);
  PetscCall(PetscNew(map));
  m                  = *map;
  m->request         = request;
  m->published_limit = NAN;
  for (int a = 0; a < 2; a++) {
    m->points[a] = request->axes[a].points;
    PetscCall(PetscMalloc1(m->points[a], &m->at[a]));
    for (PetscInt i = 0; i < m->points[a]; i++) m->at[a][i] = NumberOf(&request->axes[a], i).value;
  }
  n = m->points[0] * m->points[1];
  PetscCall(PetscCalloc2(n, &m->growth, n, &m->verdict));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStabilityMapCreate(const MpmScene *scene, const MpmRequest *request, MpmStabilityMap **map)
{
  const PetscReal  begin = MPI_Wtime();
  MpmStabilityMap *m;

  PetscFunctionBegin;
  PetscCall(MpmStabilityMapBegin(request, map));
  m        = *map;
  m->scene = scene;
  m->waves = scene->layout.dim;
  PetscCall(PetscArraycpy(m->phases, request->phases, m->waves));
  PetscCall(Check(m));
  for (PetscInt a = 0; a < m->waves; a++) {
    PetscCall(PetscCalloc1(m->points[0] * m->points[1], &m->beta[a]));
    if (MpmRequestKeepsMach(request)) PetscCall(PetscCalloc1(m->points[0] * m->points[1], &m->drift[a]));
  }
  PetscCall(Solve(m));
  PetscCall(MpmStabilityMapSum(m));
  PetscCall(Explain(m));
  PetscCall(PublishedLimit(m));
  m->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStabilityMapDestroy(MpmStabilityMap **map)
{
  PetscFunctionBegin;
  for (int a = 0; a < 2; a++) PetscCall(PetscFree((*map)->at[a]));
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) PetscCall(PetscFree((*map)->beta[a]));
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) PetscCall(PetscFree((*map)->drift[a]));
  PetscCall(PetscFree2((*map)->growth, (*map)->verdict));
  PetscCall(PetscFree((*map)->limits));
  PetscCall(PetscFree((*map)->fault));
  PetscCall(PetscFree(*map));
  PetscFunctionReturn(PETSC_SUCCESS);
}
