/*
   The nonlinear march: its step against that of plain loops (tests/support/finite.h), from random states of jittered
   layouts; momentum and mass; and growth from noise against the numbers of an independent program.
*/
#include "analysis/run.h"
#include "finite.h"
#include "gather.h"
#include "march/diagnostics.h"
#include "oracle.h"
#include <string.h>

#define LEAST 1.0001        /* growth per step; rows without growth have nothing to measure */
#define LEAST_ON_RANKS 1.05 /* the same, where steps wait for messages */

static PetscInt rows, agree;

/* The place of each particle in cells, by id. */
static PetscErrorCode GatherPlaces(const MpmMarch *march, PetscReal x[])
{
  const PetscInt    dim = march->layout->dim;
  const PetscInt64 *id;
  const PetscInt   *cell;
  const PetscReal  *xi;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(x, dim * march->particles->total));
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  for (PetscInt a = 0; a < dim; a++) {
    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[a], &xi));
    for (PetscInt p = 0; p < march->particles->count; p++)
      x[dim * id[p] + a] = march->grid->axis[a].first + cell[p] + xi[p];
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &xi));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell));
  }
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, x, (PetscMPIInt)(dim * march->particles->total), MPIU_REAL, MPI_SUM,
                             PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest distance between the states of the march and of the loops. take: the loops take that of the march. */
static PetscErrorCode Compare(const MpmMarch *march, Finite *loops, PetscBool take, PetscReal *distance)
{
  const MpmLayout *l = march->layout;
  PetscReal       *x, *q;

  PetscFunctionBegin;
  *distance = 0;
  PetscCall(PetscMalloc1(l->dim * loops->n, &x));
  PetscCall(GatherPlaces(march, x));
  for (PetscInt i = 0; i < l->dim * loops->n; i++) {
    const MpmDirection *direction = &l->grid[i % l->dim];
    PetscReal           apart     = x[i] - creal(loops->x[i]);

    if (take) loops->x[i] = x[i];
    if (direction->ends[0] == MPM_PERIODIC) apart = remainder(apart, direction->cells);
    *distance = PetscMax(*distance, fabs(apart));
  }
  PetscCall(PetscFree(x));
  for (PetscInt r = 0; r < march->scheme->table->nstate; r++) {
    PetscCall(GatherField(march, march->scheme->table->fields[r], &q));
    for (PetscInt p = 0; p < loops->n; p++) {
      if (take) loops->q[r * loops->n + p] = q[p];
      *distance = PetscMax(*distance, fabs(q[p] - creal(loops->q[r * loops->n + p])));
    }
    PetscCall(PetscFree(q));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of squares of P2G of the first velocity, as output files have it, by the march and by the loops. */
static PetscErrorCode CheckProjection(MpmMarch *march, Finite *loops, const char options[])
{
  const MpmOp     *seen = MpmTableSeenBy(march->scheme->table, 0);
  const MpmGridBox box  = MpmGridBoxOf(march->grid, 0);
  const MpmOp      p2g  = P2G(seen->dst, 0);
  PetscReal        sum = 0, expected = 0, *values;
  Vec              node;

  PetscFunctionBegin;
  PetscCall(DMCreateLocalVector(march->grid->da, &node));
  PetscCall(MpmMarchProject(march, 0, march->particles->step, NULL, node));
  PetscCall(MpmGridGetArray(march->grid, node, &values));
  for (PetscInt r = 0; r < MpmGridRows(&box); r++)
    for (PetscInt i = 0; i < box.hi[0]; i++) sum += PetscSqr(values[MpmGridRow(march->grid, &box, r) + i]);
  PetscCall(MpmGridRestoreArray(march->grid, node, &values));
  PetscCall(VecDestroy(&node));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD));
  FiniteMasses(loops);
  FiniteToNodes(loops, &p2g, 1);
  for (PetscInt i = 0; i < loops->nodes; i++) expected += PetscSqr(creal(loops->node[seen->dst * loops->nodes + i]));
  CHECK(fabs(sum - expected) <= 1e-12 * expected, "%s: P2G of v has the squares %g, not %g", options, sum, expected);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Marches a scene and the loops from one state, and compares. */
static PetscErrorCode CheckSteps(const char options[], PetscInt steps)
{
  PetscReal    distance, changes[2];
  MpmScene    *scene;
  MpmMarch    *march;
  MpmConserved before;
  Finite       loops;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  PetscCall(MpmConservedSum(march, &before));
  PetscCall(FiniteCreate(scene, &loops));
  PetscCall(Compare(march, &loops, PETSC_TRUE, &distance));
  for (PetscInt n = 0; n < steps; n++) {
    PetscCall(MpmMarchStep(march));
    FiniteStep(&loops);
  }
  CHECK(!march->failure[0], "%s: %s", options, march->failure);
  PetscCall(Compare(march, &loops, PETSC_FALSE, &distance));
  CHECK(distance < 1e-13, "%s: the march is %.2e from the loops", options, distance);
  PetscCall(CheckProjection(march, &loops, options));
  PetscCall(MpmConservedCheck(march, &before, changes));
  CHECK(!(changes[1] > 1e-14) || scene->scheme.space.loaded, "%s: momentum changes by %.1e", options, changes[1]);
  PetscCall(FiniteDestroy(&loops));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TestSteps(void)
{
  static const char *const        schemes[]   = {"usl",
                                                 "usf",
                                                 "musl",
                                                 "musl -move projected",
                                                 "usavg",
                                                 "verlet",
                                                 "verlet -move_share 1",
                                                 "rk -rk_on nodes",
                                                 "rk -rk_on nodes -rk kg5 -move_share 0.8"},
                           *const transfers[] = {"flip", "pic", "apic", "blend", "xpic", "tpic", "aflip", "fmpm"},
                           *const bases[]     = {"linear", "quadratic", "cubic", "gimp"},
                           *const materials[] = {"neo -lame_ratio 0.7", "gas", "tait", "polytropic"},
                           *const grids[]     = {"-cells 12", "-dim 2 -cells 6,5", "-dim 3 -cells 6,4,4 -ppc 1"},
                           *const ends[] = {"", "-boundary fixed", "-boundary symmetry", "-boundary fixed_reaction"};
  PetscInt                        case_number = 0;

  PetscFunctionBegin;
  for (size_t b = 0; b < PETSC_STATIC_ARRAY_LENGTH(bases); b++)
    for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(schemes); f++)
      for (size_t t = 0; t < PETSC_STATIC_ARRAY_LENGTH(transfers); t++) {
        const PetscInt i    = case_number++;
        const PetscInt dim  = i % 20 == 19 ? 2 : i % 3 == 1 ? 1 : 0; /* three dimensions take a while */
        PetscBool      turn = PETSC_FALSE;
        char           options[512];

        PetscCall(CheckHasTurn(i, &turn));
        if (!turn) continue;
        PetscCall(PetscSNPrintf(
            options, sizeof options,
            "-kinematics finite -formulation %s -transfer %s -basis %s -material %s %s %s %s "
            "-gradient %s -jitter 0.4 -initial random -amplitude 0.02 -stretch 1.2 -seed %" PetscInt_FMT
            " -courant 0.3",
            schemes[f], transfers[t], bases[b], materials[(i / 7) % 4], grids[dim], dim == 2 ? "" : ends[(i / 5) % 4],
            (i / 11) % 2 ? "-gravity 0.01" : "", i % 2 ? "mls" : "basis", i));
        PetscCall(CheckSteps(options, dim == 2 ? 2 : 3));
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Growth from noise of 1e-11 until it is 1e-4: the late half of such a run, about the mean motion. Where other modes grow
   nearly as fast, they are still there. Under drift the particles of one row on hats come to lie on nodes: noise puts
   them on either side, where the slopes differ, so that they have no common growth.
*/
static PetscErrorCode CheckRow(const char row[], const char options[], PetscReal growth)
{
  PetscBool         turn = PETSC_FALSE;
  PetscReal         ratio;
  char              all[512];
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);
  MpmScene         *scene;
  MpmRun           *run;

  PetscFunctionBegin;
  PetscCall(CheckHasTurn(rows++, &turn));
  if (growth < (size > 1 ? LEAST_ON_RANKS : LEAST) || !turn || strstr(row, "musl,flip,linear,neo,mu=1;lam=0,1.0,1/8"))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(all, sizeof all, "%s -kinematics finite -initial random -amplitude 1e-11", options));
  PetscCall(CheckScene(all, &scene));
  PetscCall(MpmRunRandom(scene, (PetscInt64)ceil(log(1e7) / log(growth)), 1e-6, &run));
  ratio = log(run->growth.per_step) / log(growth);
  CHECK(fabs(ratio - 1) <= 0.07, "%s: measured %.9g", row, (double)run->growth.per_step);
  if (fabs(ratio - 1) <= 0.01) agree++;
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   About a uniform stretch, also one that differs between directions, noise grows as the linear scheme with that prestress
   says: its march from random data is rescaled and runs for as long as the fastest mode needs.
*/
static PetscErrorCode CheckLinear(void)
{
  static const char *const scenes[] = {
      "-formulation usl -basis linear -material neo -stretch 2 -courant 0.7 -cells 8",
      "-dim 2 -formulation usf -basis quadratic -gradient mls -transfer apic -material svk -poisson 0.2 "
      "-stretch 1.2,0.9 -courant 1.9 -cells 6,4 -offset 0.3",
      "-dim 2 -formulation usl -basis cubic -material neo -poisson 0.2 -stretch 1.2,0.9 -courant 1.6 -cells 4 -offset "
      "0.3",
      "-dim 3 -formulation usl -basis cubic -material neo -poisson 0.2 -stretch 1.2,0.9,1 -courant 1.6 -cells 6,4,4 "
      "-offset 0.3 -ppc 1"};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(scenes); i++) {
    MpmScene *scene;
    MpmRun   *linear, *run;
    char      all[512];

    PetscCall(CheckScene(scenes[i], &scene));
    PetscCall(MpmRunRandom(scene, 400, 1e-6, &linear));
    PetscCall(MpmSceneDestroy(&scene));
    PetscCall(PetscSNPrintf(all, sizeof all, "%s -kinematics finite -initial random -amplitude 1e-11", scenes[i]));
    PetscCall(CheckScene(all, &scene));
    PetscCall(
        MpmRunRandom(scene, (PetscInt64)ceil(log(1e7) / log(PetscMax(1.001, linear->growth.per_step))), 1e-6, &run));
    CHECK_NEAR(log(run->growth.per_step) / log(linear->growth.per_step), 1, 1e-3);
    CHECK(linear->growth.per_step > 1.05, "%s: %g is too slow a growth to compare", all, linear->growth.per_step);
    PetscCall(MpmRunDestroy(&run));
    PetscCall(MpmRunDestroy(&linear));
    PetscCall(MpmSceneDestroy(&scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Never(const MpmMaterialNumbers *m, PetscReal e[3], PetscReal *q, PetscReal slope[4][4])
{
  (void)m, (void)e, (void)slope;
  *q = NAN;
}

/* A return mapping that does not converge ends the march, with the particle, its state and the step. */
static PetscErrorCode CheckReturn(void)
{
  MpmPlastic plastic = *MpmLawClay.plastic;
  MpmLaw     law     = MpmLawClay;
  MpmScene  *scene;
  MpmMarch  *march;

  PetscFunctionBegin;
  plastic.back = Never;
  law.plastic  = &plastic;
  PetscCall(
      CheckScene("-kinematics finite -dim 2 -formulation usl -basis quadratic -material clay -cells 8 -initial random "
                 "-amplitude 0.01 -courant 0.2 -steps 1",
                 &scene));
  scene->scheme.table->material.law = &law;
  PetscCall(MarchScene(PETSC_COMM_WORLD, scene, &march));
  CHECK(strstr(march->failure, "step 1: particle ") && strstr(march->failure, " with the stretch F = ") &&
            strstr(march->failure, " does not come back to the yield surface of material clay"),
        "%s", march->failure);
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Body(int argc, char **argv)
{
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);

  PetscFunctionBeginUser;
  PetscCheck(argc > 1, PETSC_COMM_SELF, PETSC_ERR_USER_INPUT, "test_finite growth-nonlinear.csv");
  PetscCall(TestSteps());
  PetscCall(CheckReturn());
  PetscCall(OracleGrowthNonlinear(argv[1], 40, CheckRow));
  if (size == 1) PetscCall(CheckLinear()); /* that ranks do not matter is shown by the steps */
  CHECK(size > 1 || agree >= 18, "only %" PetscInt_FMT " rows agree to 1%% of the logarithm", agree);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Body)
