/*
   Fuzzes the functions that read checkpoints, and the march that resumes from them.

   The first byte of an input is the number of a scene. With 128 added, the rest of the input is the file itself.
   Otherwise the rest are edits to the scene's own checkpoint (checked.h), which then gets a right checksum. So the
   fuzzer reaches what is behind the checksum, and HDF5, which may crash on damaged files, reads a whole one.
*/
#include "fuzz.h"
#include "checked.h"
#include "io/checkpoint.h"
#include "march/diagnostics.h"
#include "scene/request.h"
#include <math.h>
#include <string.h>

#define WRITTEN_AT 9
#define STEPS 12
#define TOLERANCE 1e-6
#define RAW 128

static const char checkpoint_file[] = "input.h5";

/*
   There are scenes whose drift fits in the slack of the ghost layer and one whose drift does not, walls, and particles
   that differ.
*/
static const char *const options[] = {
    "-formulation gas2 -cells 4 -courant 0.5",
    "-formulation gas2 -cells 6 -courant 0.2 -drift 0.3 -jitter 0.7",
    "-formulation musl -transfer xpic -basis cubic -cells 8 -courant 0.2 -drift -7.3 -jitter 0.5",
    "-formulation usl -transfer apic -basis quadratic -cells 6 -boundary fixed,free -material two -courant 0.2",
};

static MpmScene *scenes[PETSC_STATIC_ARRAY_LENGTH(options)];
static Checked   good[PETSC_STATIC_ARRAY_LENGTH(options)];

/* Records a sample as the task run would. follow: the state is still in range. */
static PetscErrorCode Sample(MpmMarch *march, MpmRun *run, PetscBool *follow)
{
  const PetscReal ln2 = M_LN2 * march->exponent;
  MpmNorms        norms;

  PetscFunctionBegin;
  PetscCall(MpmMarchNorms(march, &norms));
  *follow = isfinite(norms.state) && isfinite(norms.energy) && isfinite(norms.grid) ? PETSC_TRUE : PETSC_FALSE;
  if (!*follow) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSeriesAppend(&run->series, march->step, log(norms.state) + ln2, log(norms.grid) + ln2));
  if (norms.state > 0) PetscCall(MpmMarchRescale(march, ilogb(norms.state)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode March(MpmMarch *march, MpmRun *run, PetscInt64 last, PetscBool *follow)
{
  PetscFunctionBegin;
  *follow = PETSC_TRUE;
  while (march->step < last && *follow) {
    PetscCall(MpmMarchStep(march));
    PetscCall(Sample(march, run, follow));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Make(const char words[], MpmScene **scene, Checked *checked)
{
  MpmRun    run = {.blew_up_at_step = MPM_NEVER};
  MpmMarch *march;
  PetscBool follow;

  PetscFunctionBegin;
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscOptionsInsertString(NULL, words));
  PetscCall(MpmSceneCreate("run", NULL, scene, NULL));
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, *scene, &march));
  PetscCall(March(march, &run, WRITTEN_AT, &follow));
  PetscCall(MpmCheckpointWrite(checkpoint_file, march, &run, "step,norm\n0,1\n"));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSeriesDestroy(&run.series));
  CheckedLoad(checkpoint_file, checked);
  PetscFunctionReturn(PETSC_SUCCESS);
}

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
  (void)argc;
  (void)argv;
  FuzzStart("checkpoint", checkpoint_file);
  FuzzEnter();
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(options); i++)
    FuzzNeed(Make(options[i], &scenes[i], &good[i]) ? PETSC_FALSE : PETSC_TRUE, "no checkpoint to begin with");
  FuzzReturn();
  return 0;
}

/* Resumes from a checkpoint as the task run does. */
static PetscErrorCode GoOn(const MpmScene *scene, MpmMarch *march, MpmRun *run, char **csv)
{
  PetscReal    changes[2];
  PetscBool    follow;
  MpmConserved start;
  MpmError     error[MPM_MAX_FIELDS];

  PetscFunctionBegin;
  PetscCall(MpmCheckpointRead(checkpoint_file, STEPS, march, run, csv));
  FuzzNeed(march->step >= 0 && march->step < STEPS, "a step that is none of the scene's");
  PetscCall(MpmConservedSum(march, &start));
  PetscCall(March(march, run, STEPS, &follow));
  if (follow) PetscCall(MpmConservedCheck(march, &start, changes));
  if (MpmSceneHasExact(scene)) PetscCall(MpmDiagnosticsErrors(march, error));
  PetscCall(MpmGrowthFit(&run->series, TOLERANCE, PETSC_TRUE, &run->growth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadAndGoOn(const MpmScene *scene)
{
  MpmRun         run = {.blew_up_at_step = MPM_NEVER};
  char          *csv = NULL;
  MpmMarch      *march;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(MpmCheckpointCheck(checkpoint_file, scene, STEPS));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  ierr = GoOn(scene, march, &run, &csv);
  PetscCall(PetscFree(csv));
  PetscCall(MpmSeriesDestroy(&run.series));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  const size_t   which = size ? data[0] % RAW % PETSC_STATIC_ARRAY_LENGTH(options) : 0;
  PetscErrorCode ierr;

  FuzzEnter();
  if (size && data[0] >= RAW)
    FuzzWrite(data + 1, size - 1);
  else {
    Checked checked;

    CheckedCopy(&good[which], &checked);
    if (size) CheckedEdit(&checked, data + 1, size - 1);
    CheckedWrite(&checked, checkpoint_file);
    CheckedFree(&checked);
  }
  ierr = ReadAndGoOn(scenes[which]);
  FuzzReturn();
  FuzzNeed(!ierr || ierr == PETSC_ERR_USER_INPUT ? PETSC_TRUE : PETSC_FALSE, "not refused but failed");
  return 0;
}
