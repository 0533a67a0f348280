/*
   A run that resumes from a checkpoint is the same as an uninterrupted one: to the last bit on as many ranks, and to
   rounding on another number of ranks.
*/
#include "gather.h"
#include "io/checkpoint.h"

#define FILE_NAME "test_checkpoint.h5"

/* Compares all particle data that the next step uses, in the order in which this rank holds them. */
static PetscErrorCode SameBits(const MpmMarch *a, const MpmMarch *b, const char options[])
{
  const char *names[MPM_MAX_FIELDS + MPM_MAX_DIM + 1] = {DMSwarmField_pid};
  PetscInt    n                                       = 1;

  PetscFunctionBegin;
  for (PetscInt d = 0; d < a->layout->dim; d++) names[n++] = MpmFieldXi[d];
  for (PetscInt f = 0; a->scene->scheme.table->fields[f]; f++) names[n++] = a->scene->scheme.table->fields[f];
  CHECK(a->step == b->step && a->exponent == b->exponent, "%s: steps or exponents", options);
  CHECK(a->particles->count == b->particles->count, "%s: particles here", options);
  for (PetscInt i = 0; i < n && a->particles->count == b->particles->count; i++) {
    const PetscReal *x, *y;

    PetscCall(MpmParticlesGet(a->particles, names[i], &x));
    PetscCall(MpmParticlesGet(b->particles, names[i], &y));
    CHECK(!memcmp(x, y, sizeof *x * (size_t)a->particles->count), "%s: %s is not the same to the bit", options,
          names[i]);
    PetscCall(MpmParticlesRestore(b->particles, names[i], &y));
    PetscCall(MpmParticlesRestore(a->particles, names[i], &x));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Steps(MpmMarch *march, PetscInt64 last)
{
  PetscFunctionBegin;
  while (march->step < last) {
    PetscCall(MpmMarchStep(march));
    if (march->step == 20) PetscCall(MpmMarchRescale(march, 3));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SameToRounding(const MpmMarch *a, const MpmMarch *b, const char options[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; a->scene->scheme.table->fields[f]; f++) {
    PetscReal *x, *y;

    PetscCall(GatherField(a, a->scene->scheme.table->fields[f], &x));
    PetscCall(GatherField(b, a->scene->scheme.table->fields[f], &y));
    CHECK(LargestDifference(a->particles->total, x, y) <= 1e-10 * LargestNumber(a->particles->total, x), "%s: %s: %g",
          options, a->scene->scheme.table->fields[f], LargestDifference(a->particles->total, x, y));
    PetscCall(PetscFree(y));
    PetscCall(PetscFree(x));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Interrupts a run on comm and resumes it on other; a rank that is not in one of them has MPI_COMM_NULL for it. same:
   the result must be the uninterrupted one to the last bit.
*/
static PetscErrorCode GoOn(const char options[], MPI_Comm comm, MPI_Comm other, PetscBool same)
{
  MpmRun    before = {.blew_up_at_step = 17, .energy_initial = 0.1}, after = {.energy_initial = 0};
  MpmScene *scene;
  MpmMarch *whole, *parts;
  char     *csv = NULL;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmSeriesAppend(&before.series, 5, 1.0 / 3, -7));
  if (comm != MPI_COMM_NULL) {
    PetscCall(MpmMarchCreate(comm, scene, &parts));
    PetscCall(Steps(parts, 33));
    PetscCall(MpmCheckpointWrite(FILE_NAME, parts, &before, "a,b\n1,2\n"));
    PetscCall(MpmMarchDestroy(&parts));
  }
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscCall(MpmCheckpointCheck(FILE_NAME, scene, check_request.steps));
  if (other != MPI_COMM_NULL) {
    PetscCall(MpmMarchCreate(other, scene, &whole));
    PetscCall(Steps(whole, 60));
    PetscCall(MpmMarchCreate(other, scene, &parts));
    PetscCall(MpmCheckpointRead(FILE_NAME, check_request.steps, parts, &after, &csv));
    CHECK(parts->step == 33 && after.blew_up_at_step == 17 && after.energy_initial == 0.1, "%s: the run", options);
    CHECK(after.series.n == 1 && after.series.step[0] == 5 && after.series.log_state[0] == 1.0 / 3, "%s: its series",
          options);
    CHECK(!strcmp(csv, "a,b\n1,2\n"), "%s: its CSV is '%s'", options, csv);
    PetscCall(Steps(parts, 60));
    if (same) PetscCall(SameBits(whole, parts, options));
    PetscCall(SameToRounding(whole, parts, options));
    PetscCall(PetscFree(csv));
    PetscCall(MpmMarchDestroy(&parts));
    PetscCall(MpmMarchDestroy(&whole));
  }
  PetscCall(MpmSeriesDestroy(&before.series));
  PetscCall(MpmSeriesDestroy(&after.series));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCallMPI(MPI_Barrier(PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const scenes[] = {
      "-formulation gas2 -courant 0.5",
      "-formulation gas2 -courant 0.2 -drift 0.3 -jitter 0.7",
      "-formulation gas1 -courant 0.5 -drift -7",
      "-formulation musl -transfer xpic -basis cubic -drift 2.7 -courant 0.3 -jitter 0.5",
      "-formulation usl -transfer nullspace -drift 1/8 -courant 0.1",
      "-formulation usl -transfer apic -boundary fixed,free -courant 0.4 -counts 1,3,0,2",
      "-formulation usf -material two -density_ratio 3 -stiffness_ratio 0.2 -drift 5/7 -courant 0.2 -jitter 0.9",
      "-formulation elastic -drift 3.3 -cells 12 -courant 0.5",
      "-formulation usl -transfer apic -dim 2 -cells 16,12 -drift 1/3,-1/4 -courant 0.1 -basis quadratic",
      "-formulation musl -dim 3 -cells 12,3,4 -ppc 1 -drift 2/3,0,0 -courant 0.1 -boundary periodic,symmetry,fixed",
  };
  PetscMPIInt rank;
  MPI_Comm    first;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_split(PETSC_COMM_WORLD, rank == 0 ? 0 : MPI_UNDEFINED, 0, &first));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(scenes); i++) {
    char options[512];

    PetscCall(PetscSNPrintf(options, sizeof options, "-cells 48 %s -initial random", scenes[i]));
    PetscCall(GoOn(options, PETSC_COMM_WORLD, PETSC_COMM_WORLD, PETSC_TRUE));
    PetscCall(GoOn(options, first, PETSC_COMM_WORLD, PETSC_FALSE));
    PetscCall(GoOn(options, PETSC_COMM_WORLD, first, PETSC_FALSE));
  }
  if (rank == 0) (void)remove(FILE_NAME);
  if (first != MPI_COMM_NULL) PetscCallMPI(MPI_Comm_free(&first));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
