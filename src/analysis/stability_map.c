/* Growth at the points of a rectangle: the symbol of one scene after another, dealt to the ranks. */
#include "symbol/predict.h"
#include <mpmstab/critical.h>
#include "base/farm.h"
#include "scene/layout.h"
#include "analysis/stability_map.h"
#include <math.h>

#define MOST_POINTS 10000000

/* A scene's parameter; whatever follows from it and the symbol reads. */
static void SetParameter(MpmScene *scene, MpmAxisKind kind, const MpmFraction *value)
{
  switch (kind) {
  case MPM_AXIS_COURANT:
    scene->courant = value->value;
    scene->dt      = scene->courant * scene->cell_width / scene->wave_speed;
    break;
  case MPM_AXIS_DRIFT:
    scene->drift = *value;
    break;
  case MPM_AXIS_OFFSET:
    scene->offset = *value;
    break;
  case MPM_AXIS_PPC:
    MpmSceneSetPpc(scene, (PetscInt)value->num);
    break;
  }
}

static MpmFraction NumberOf(const MpmAxis *axis, PetscInt i)
{
  return MpmFractionBetween(&axis->from, &axis->to, i, axis->points);
}

/* The scene of a point. */
static void Place(const MpmStabilityMap *map, PetscInt point, MpmScene *scene)
{
  const PetscInt i[2] = {point / map->points[1], point % map->points[1]};

  for (int a = 0; a < 2; a++) {
    const MpmFraction value = NumberOf(&map->request->axes[a], i[a]);

    SetParameter(scene, map->request->axes[a].kind, &value);
  }
}

/* Whatever could be refused at a point, by all ranks together; particles per cell are bounded by their option. */
static PetscErrorCode Check(const MpmScene *scene, const MpmRequest *request)
{
  MpmScene at = *scene;
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
  PetscCall(MpmLayoutPeriod(&at, &period));
  PetscCall(MpmSymbolCheck(&at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SolvePoint(void *context, PetscInt i)
{
  MpmStabilityMap *map = context;
  MpmFinding       f   = {.tolerance = map->request->tolerance};
  MpmScene         at  = *map->scene;
  MpmSymbol       *symbol;

  PetscFunctionBegin;
  Place(map, i, &at);
  PetscCall(MpmSymbolCreate(PETSC_COMM_SELF, &at, map->request->phases, f.tolerance, PETSC_FALSE, &symbol));
  f.growth        = symbol->growth;
  f.uncertainty   = symbol->uncertainty;
  f.blur          = symbol->blur;
  map->growth[i]  = symbol->growth;
  map->beta[i]    = symbol->beta_at_max;
  map->verdict[i] = MpmVerdictOf(&f);
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
                          map->request->phases, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PublishedLimit(MpmStabilityMap *map)
{
  MpmScene     at = *map->scene;
  MpmPredictor predictor;

  PetscFunctionBegin;
  map->published_limit = NAN;
  if (!MpmRequestVaries(map->request, MPM_AXIS_COURANT)) PetscFunctionReturn(PETSC_SUCCESS);
  at.drift = (MpmFraction){.num = 0, .den = 1, .value = 0};
  PetscCall(MpmPredictorCreate(&at, &predictor));
  if (!predictor.why_not_published) map->published_limit = map->scene->formulation->published_limit;
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStabilityMapLimits(MpmStabilityMap *map)
{
  const MpmAxis *axes  = map->request->axes;
  const int      other = axes[0].kind == MPM_AXIS_COURANT ? 1 : 0;
  MpmScene       at    = *map->scene;
  MpmCritical    critical;

  PetscFunctionBegin;
  if (!MpmRequestVaries(map->request, MPM_AXIS_COURANT)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(map->points[other], &map->limits));
  for (PetscInt i = 0; i < map->points[other]; i++) {
    const MpmFraction value = NumberOf(&axes[other], i);

    SetParameter(&at, axes[other].kind, &value);
    PetscCall(MpmCriticalByClosedForm(&at, &critical));
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
