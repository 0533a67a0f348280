/*
   Growth measured by marches from random data in two and three dimensions, against an independent program's growth over
   all phases of the same grid. Random data excite every mode, and long runs are led by the one that grows fastest.
*/
#include "analysis/run.h"
#include "check.h"
#include "oracle.h"

#define LEAST 1.01 /* growth per step; slower rows would need long runs */
#define TIMES 1e60 /* by which a state grows in a run */
#define SHARE 0.02 /* by which logarithms may differ */

/*
   In rows of apic on hats a mode shows on the grid at every other step only. A run does not measure its growth, or says that the
   error of it is large.
*/
static PetscInt tried, rows, unmeasured;

static PetscErrorCode CheckRow(const char row[], const char options[], PetscReal growth)
{
  MpmScene *scene;
  MpmRun   *run;
  PetscBool measured, turn = PETSC_FALSE;
  int       ranks;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  if (growth < LEAST || !strstr(row, ",") || row[0] == '1') PetscFunctionReturn(PETSC_SUCCESS);
  if (ranks > 1 && strstr(options, "-cells 3")) PetscFunctionReturn(PETSC_SUCCESS); /* a rank needs 2 cells */
  PetscCall(CheckHasTurn(tried++, &turn));
  if (!turn) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmRunRandom(scene, (PetscInt64)ceil(log(TIMES) / log(growth)), 1e-6, &run));
  measured = run->growth.measured && run->growth.error <= log(growth) / 2 ? PETSC_TRUE : PETSC_FALSE;
  if (measured)
    CHECK(fabs(log(run->growth.per_step) - log(growth)) <= SHARE * log(growth), "%s: measured %.9g", row,
          (double)run->growth.per_step);
  else
    unmeasured++;
  rows += measured ? 1 : 0;
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  PetscCheck(argc > 1, PETSC_COMM_WORLD, PETSC_ERR_USER, "growth_nd FILE");
  PetscCall(OracleGrowthNd(argv[1], 183, CheckRow));
  CHECK(tried >= 21 && unmeasured <= 3, "%d of %d rows measured, %d not", (int)rows, (int)tried, (int)unmeasured);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
