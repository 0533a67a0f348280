/* Computes growth at the points of a rectangle, through the symbol of one scene after another. */
#include "symbol/predict.h"
#include <mpmstab/critical.h>
#include "base/farm.h"
#include "scene/layout.h"
#include "analysis/stability_map.h"
#include <math.h>

#define MOST_POINTS 10000000

/*
   What the symbol of a point depends on: the scene's own layout and step, except for the two numbers that the map
   varies.
*/
typedef struct {
  MpmLayout layout;
  MpmStep   step;
} Point;

static Point OwnPoint(const MpmScene *scene)
{
  return (Point){.layout = scene->layout, .step = scene->step};
}

static void SetParameter(Point *at, MpmAxisKind kind, const MpmFraction *value)
{
  switch (kind) {
  case MPM_AXIS_COURANT:
    at->step.courant = value->value;
    break;
  case MPM_AXIS_DRIFT:
    at->step.drift[0] = *value;
    break;
  case MPM_AXIS_OFFSET:
    at->layout.offset[0] = *value;
    break;
  case MPM_AXIS_PPC:
    MpmLayoutSetPpc(&at->layout, (PetscInt)value->num);
    break;
  }
}

static MpmFraction NumberOf(const MpmAxis *axis, PetscInt i)
{
  return MpmFractionBetween(&axis->from, &axis->to, i, axis->points);
}

static Point PointOf(const MpmStabilityMap *map, PetscInt point)
{
  const PetscInt i[2] = {point / map->points[1], point % map->points[1]};
  Point          at   = OwnPoint(map->scene);

  for (int a = 0; a < 2; a++) {
    const MpmFraction value = NumberOf(&map->request->axes[a], i[a]);

    SetParameter(&at, map->request->axes[a].kind, &value);
  }
  return at;
}

/*
   Refuses, on all ranks together, what could be refused at a point. The option's own range bounds the particles per
   cell.
*/
static PetscErrorCode Check(const MpmScene *scene, const MpmRequest *request)
{
  Point    at = OwnPoint(scene);
  PetscInt period;

  PetscFunctionBegin;
  MpmCheckInput((PetscReal)request->axes[0].points * request->axes[1].points <= MOST_POINTS,
                "map_points %" PetscInt_FMT ",%" PetscInt_FMT ": too many; allowed: at most %d together",
                request->axes[0].points, request->axes[1].points, MOST_POINTS);
  for (int a = 0; a < 2; a++)
    for (PetscInt i = 0; i < request->axes[a].points; i++) {
      const MpmFraction value = NumberOf(&request->axes[a], i);

      MpmCheckInput(request->axes[a].kind != MPM_AXIS_DRIFT || (value.den > 0 && value.den <= MPM_LONGEST_PERIOD),
                    "map_drift with map_points %" PetscInt_FMT ",%" PetscInt_FMT
                    ": particles that drift by %.6g are not back in their places within %d steps; allowed: ends that "
                    "are fractions such as 1/2, and fewer points",
                    request->axes[0].points, request->axes[1].points, value.value, MPM_LONGEST_PERIOD);
      SetParameter(&at, request->axes[a].kind, &value);
    }
  PetscCall(MpmStepPeriod(&at.step, &period));
  PetscCall(MpmSymbolCheck(&at.layout));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SolvePoint(void *context, PetscInt i)
{
  MpmStabilityMap    *map  = context;
  MpmFinding          f    = {.tolerance = map->request->tolerance};
  const Point         at   = PointOf(map, i);
  const MpmSymbolWish wish = {.phases    = {map->request->phases[0]},
                              .tolerance = map->request->tolerance}; /* the map's own progress line counts the points */
  MpmSymbol          *symbol;

  PetscFunctionBegin;
  PetscCall(MpmSymbolCreate(PETSC_COMM_SELF, &at.layout, &map->scene->scheme, &at.step, &wish, &symbol));
  f.growth          = symbol->growth;
  f.uncertainty     = symbol->uncertainty;
  f.defective_error = symbol->defective_error;
  map->growth[i]    = symbol->growth;
  map->beta[i]      = symbol->beta_at_max[0];
  f.verdict         = MpmVerdictOf(&f);
  PetscCall(MpmFindingOfPhases(&f, symbol->phases[0], at.layout.grid[0].cells));
  map->verdict[i] = f.verdict;
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Solve(MpmStabilityMap *map)
{
  const PetscInt n = map->points[0] * map->points[1];

  PetscFunctionBegin;
  PetscCall(MpmFarm("point", n, SolvePoint, map));
  PetscCall(MpmFarmSumReals(n, map->growth));
  PetscCall(MpmFarmSumReals(n, map->beta));
  PetscCall(MpmFarmSumInts(n, map->verdict));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Sum(MpmStabilityMap *map)
{
  const PetscInt n = map->points[0] * map->points[1];
  MpmFinding    *f = &map->finding;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) {
    map->unstable += map->verdict[i] == MPM_UNSTABLE;
    map->undecided += map->verdict[i] == MPM_UNDECIDED;
    if (!(map->growth[i] <= map->growth[map->worst])) map->worst = i;
  }
  f->tolerance = map->request->tolerance;
  f->growth    = map->growth[map->worst];
  f->verdict   = map->unstable ? MPM_UNSTABLE : map->undecided ? MPM_UNDECIDED : MPM_STABLE;
  PetscCall(PetscSNPrintf(f->evidence, sizeof f->evidence,
                          "the symbol at %" PetscInt_FMT " phases of each of %" PetscInt_FMT " points",
                          map->request->phases[0], n));
  if (map->request->phases[0] % map->scene->layout.grid[0].cells)
    PetscCall(PetscStrlcat(f->evidence, ", which leave out waves of the grid", sizeof f->evidence));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PublishedLimit(MpmStabilityMap *map)
{
  MpmPredictor predictor;

  PetscFunctionBegin;
  map->published_limit = NAN;
  if (!MpmRequestVaries(map->request, MPM_AXIS_COURANT)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmPredictorCreate(&map->scene->layout, &map->scene->scheme, PETSC_FALSE, &predictor));
  if (!predictor.why_not_published) map->published_limit = map->scene->scheme.formulation->published_limit;
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStabilityMapLimits(MpmStabilityMap *map)
{
  const MpmAxis *axes  = map->request->axes;
  const int      other = axes[0].kind == MPM_AXIS_COURANT ? 1 : 0;
  Point          at    = OwnPoint(map->scene);
  MpmCritical    critical;

  PetscFunctionBegin;
  if (!MpmRequestVaries(map->request, MPM_AXIS_COURANT)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(map->points[other], &map->limits));
  for (PetscInt i = 0; i < map->points[other]; i++) {
    const MpmFraction value = NumberOf(&axes[other], i);

    SetParameter(&at, axes[other].kind, &value);
    PetscCall(MpmCriticalByClosedForm(&at.layout, &map->scene->scheme, MpmStepDrifts(&at.step), &critical));
    map->limits[i] = critical.closed;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStabilityMapCreate(const MpmScene *scene, const MpmRequest *request, MpmStabilityMap **map)
{
  const PetscReal  begin = MPI_Wtime();
  MpmStabilityMap *m;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(Check(scene, request));
  PetscCall(PetscNew(map));
  m          = *map;
  m->scene   = scene;
  m->request = request;
  for (int a = 0; a < 2; a++) {
    m->points[a] = request->axes[a].points;
    PetscCall(PetscMalloc1(m->points[a], &m->at[a]));
    for (PetscInt i = 0; i < m->points[a]; i++) m->at[a][i] = NumberOf(&request->axes[a], i).value;
  }
  n = m->points[0] * m->points[1];
  PetscCall(PetscCalloc3(n, &m->growth, n, &m->beta, n, &m->verdict));
  PetscCall(Solve(m));
  PetscCall(Sum(m));
  PetscCall(PublishedLimit(m));
  m->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStabilityMapDestroy(MpmStabilityMap **map)
{
  PetscFunctionBegin;
  for (int a = 0; a < 2; a++) PetscCall(PetscFree((*map)->at[a]));
  PetscCall(PetscFree3((*map)->growth, (*map)->beta, (*map)->verdict));
  PetscCall(PetscFree((*map)->limits));
  PetscCall(PetscFree(*map));
  PetscFunctionReturn(PETSC_SUCCESS);
}
