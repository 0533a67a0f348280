/* Settings -> Scene: units, derived numbers, and options that exclude each other. */
#include "io/checkpoint.h"
#include "io/mode_file.h"
#include <mpmstab/scene.h>
#include <math.h>
#include <string.h>

static PetscErrorCode ReadWords(const MpmSettings *settings, MpmScene *scene)
{
  PetscInt i;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "formulation", &i));
  scene->scheme.formulation = MpmFormulations[i];
  PetscCall(MpmSettingsWord(settings, "basis", &i));
  scene->scheme.basis = MpmBases[i];
  PetscCall(MpmSettingsWord(settings, "transfer", &i));
  scene->scheme.transfer = MpmTransfers[i];
  PetscCall(MpmSettingsWord(settings, "layout", &i));
  scene->layout.name = MpmOptions[MpmOptionIndex("layout")].word(i);
  PetscCall(MpmSettingsWord(settings, "initial", &i));
  scene->initial = (MpmInitial)i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadGrid(const MpmSettings *settings, MpmScene *scene)
{
  PetscInt64 n;

  PetscFunctionBegin;
  PetscCall(MpmSettingsInteger(settings, "dim", &n));
  scene->dim = (PetscInt)n;
  PetscCall(MpmSettingsInteger(settings, "cells", &n));
  scene->layout.grid.cells = (PetscInt)n;
  PetscCall(MpmSettingsReal(settings, "length", &scene->length));
  scene->cell_width = scene->length / scene->layout.grid.cells;
  if (!isnormal(scene->cell_width))
    PetscCall(MpmSettingsRefuse(settings, "length", "cells of this length vanish; allowed: a larger length"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadTime(const MpmSettings *settings, MpmScene *scene)
{
  PetscReal value;

  PetscFunctionBegin;
  PetscCall(MpmSettingsReal(settings, "wave_speed", &scene->wave_speed));
  if (MpmSettingsGiven(settings, "dt")) {
    PetscCall(MpmSettingsReal(settings, "dt", &scene->dt));
    scene->step.courant = scene->wave_speed * scene->dt / scene->cell_width;
    if (!isnormal(scene->step.courant))
      PetscCall(MpmSettingsRefuse(settings, "dt", "c dt / h is out of range; allowed: a finite Courant number"));
  } else {
    PetscCall(MpmSettingsReal(settings, "courant", &scene->step.courant));
    scene->dt = scene->step.courant * scene->cell_width / scene->wave_speed;
    if (!isnormal(scene->dt))
      PetscCall(MpmSettingsRefuse(settings, "courant", "dt = k h / c is out of range; allowed: a finite time step"));
  }
  if (MpmSettingsGiven(settings, "velocity")) {
    PetscCall(MpmSettingsReal(settings, "velocity", &value));
    scene->step.drift = (MpmFraction){.num = 0, .den = value == 0, .value = value * scene->dt / scene->cell_width};
    if (!(PetscAbsReal(scene->step.drift.value) <= 1e6))
      PetscCall(MpmSettingsRefuse(settings, "velocity", "allowed: at most 1e6 cells per step"));
  } else
    PetscCall(MpmSettingsFraction(settings, "drift", &scene->step.drift));
  if (MpmSettingsGiven(settings, "time")) {
    PetscCall(MpmSettingsReal(settings, "time", &value));
    /* a time that is whole steps but for rounding is not given one more */
    value = ceil(value / scene->dt * (1 - 1e-12));
    if (!(value <= 1e15)) PetscCall(MpmSettingsRefuse(settings, "time", "allowed: at most 1e15 steps of dt"));
    scene->steps = PetscMax((PetscInt64)value, 1);
  } else
    PetscCall(MpmSettingsInteger(settings, "steps", &scene->steps));
  if (!isfinite((PetscReal)scene->steps * scene->dt))
    PetscCall(MpmSettingsRefuse(settings, "length", "steps times dt is out of range; allowed: a smaller length"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadStagger(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(MpmSettingsSwitch(settings, "stagger", &scene->stagger));
  if (scene->stagger && scene->scheme.formulation->staggered == MPM_NONE) {
    scene->stagger = PETSC_FALSE;
    if (!MpmSettingsOverruled(settings, "stagger", "formulation"))
      PetscCall(MpmSettingsRefuse(settings, "stagger",
                                  "no field of this formulation lags half a step; allowed: with those where one does"));
  }
  if (scene->stagger && scene->initial != MPM_INITIAL_MODE && scene->initial != MPM_INITIAL_PULSE) {
    scene->stagger = PETSC_FALSE;
    if (!MpmSettingsOverruled(settings, "stagger", "initial"))
      PetscCall(
          MpmSettingsRefuse(settings, "stagger", "these data have no half step; allowed: with initial mode or pulse"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a run measures besides; the slides' weights are those of hats, and of nodes with a cell to either side. */
static PetscErrorCode ReadDiagnostics(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  if (strcmp(scene->task, "run")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsSwitch(settings, "weights", &scene->weights));
  PetscCall(MpmSettingsSwitch(settings, "source_term", &scene->source_term));
  PetscCall(MpmSettingsSwitch(settings, "ringing", &scene->ringing));
  if (scene->weights && !(scene->scheme.basis->hat && MpmSceneIsPeriodic(scene)))
    PetscCall(MpmSettingsRefuse(settings, "weights", "allowed: with basis linear and boundary periodic"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where initial eigenmode is; the tasks that do not march leave initial data alone. */
static PetscErrorCode ReadModeFile(const MpmSettings *settings, MpmScene *scene)
{
  const PetscBool wanted = scene->initial == MPM_INITIAL_EIGENMODE ? PETSC_TRUE : PETSC_FALSE;
  const char     *path;

  PetscFunctionBegin;
  if (strcmp(scene->task, "run")) PetscFunctionReturn(PETSC_SUCCESS);
  MpmCheckInput(!wanted || MpmSettingsGiven(settings, "mode_file"),
                "initial eigenmode needs mode_file; allowed: a file that 'mpmstab spectrum -output' has written");
  if (!MpmSettingsGiven(settings, "mode_file")) PetscFunctionReturn(PETSC_SUCCESS);
  if (!wanted && !MpmSettingsOverruled(settings, "mode_file", "initial"))
    PetscCall(MpmSettingsRefuse(settings, "mode_file", "allowed: only with initial eigenmode"));
  PetscCall(MpmSettingsPath(settings, "mode_file", &path));
  PetscCall(PetscStrncpy(scene->mode_file, path, sizeof scene->mode_file));
  if (wanted) PetscCall(MpmModeFileCheck(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A survey is of all schemes, whatever Courant number a scene has. */
static PetscErrorCode CheckSurvey(const MpmSettings *settings, const MpmScene *scene)
{
  static const char *const idle[] = {"formulation", "basis",  "transfer",        "courant",
                                     "dt",          "expect", "expect_critical", "json"};

  PetscFunctionBegin;
  for (size_t i = 0; scene->survey && i < PETSC_STATIC_ARRAY_LENGTH(idle); i++)
    if (MpmSettingsSource(settings, idle[i]) == MPM_FROM_COMMAND_LINE)
      PetscCall(MpmSettingsRefuse(settings, idle[i], "a survey goes through all schemes; allowed: without survey"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A count that may not be given: then it stays what it is. */
static PetscErrorCode ReadCount(const MpmSettings *settings, const char name[], PetscInt *value)
{
  PetscInt64 n = *value;

  PetscFunctionBegin;
  if (MpmSettingsGiven(settings, name)) PetscCall(MpmSettingsInteger(settings, name, &n));
  *value = (PetscInt)n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How finely symbol and pseudospectrum are read, what the spectrum keeps, and how many layouts there are. */
static PetscErrorCode ReadAnalysis(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  scene->phases = scene->layout.grid.cells;
  PetscCall(ReadCount(settings, "phases", &scene->phases));
  PetscCall(ReadCount(settings, "modes", &scene->modes));
  PetscCall(ReadCount(settings, "layouts", &scene->layouts));
  PetscCall(ReadCount(settings, "powers", &scene->powers));
  PetscCall(ReadCount(settings, "pseudospectrum", &scene->pseudospectrum));
  PetscCall(MpmSettingsSwitch(settings, "measure", &scene->measure));
  PetscCall(MpmSettingsSwitch(settings, "survey", &scene->survey));
  PetscCall(CheckSurvey(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadInitial(const MpmSettings *settings, MpmScene *scene)
{
  PetscInt64 n;

  PetscFunctionBegin;
  PetscCall(MpmSettingsInteger(settings, "mode", &n));
  scene->mode = (PetscInt)n;
  if (scene->initial == MPM_INITIAL_MODE &&
      scene->mode > PetscMax(1, MpmSceneIsPeriodic(scene) ? scene->layout.grid.cells / 2 : scene->layout.grid.cells))
    PetscCall(MpmSettingsRefuse(settings, "mode",
                                MpmSceneIsPeriodic(scene) ? "allowed: a whole number from 1 to cells / 2"
                                                          : "allowed: a whole number from 1 to cells"));
  if (MpmInitialHasExact(scene->initial) && !scene->scheme.formulation->wave) {
    if (MpmSettingsSource(settings, "initial") != MPM_FROM_DEFAULT)
      PetscCall(MpmSettingsRefuse(settings, "initial",
                                  "the formulation has no exact solution to start from; allowed: random or eigenmode"));
    scene->initial = MPM_INITIAL_RANDOM;
  }
  if (scene->initial == MPM_INITIAL_STEP &&
      (!MpmEndIsFixed(scene->layout.grid.ends[0]) || scene->layout.grid.ends[1] != MPM_FREE))
    PetscCall(
        MpmSettingsRefuse(settings, "initial", "a load needs an end to act on; allowed: with boundary fixed,free"));
  if (scene->initial != MPM_INITIAL_MODE && scene->initial != MPM_INITIAL_EIGENMODE &&
      MpmSettingsSource(settings, "mode") != MPM_FROM_DEFAULT && !MpmSettingsOverruled(settings, "mode", "initial"))
    PetscCall(MpmSettingsRefuse(settings, "mode", "allowed: only with initial mode or eigenmode"));
  PetscCall(MpmSettingsReal(settings, "amplitude", &scene->amplitude));
  PetscCall(ReadModeFile(settings, scene));
  PetscCall(ReadStagger(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadOutputs(const MpmSettings *settings, MpmScene *scene)
{
  PetscBool progress;

  PetscFunctionBegin;
  PetscCall(MpmSettingsReal(settings, "tolerance", &scene->tolerance));
  PetscCall(MpmSettingsFiles(settings, scene));
  scene->output_every = scene->steps;
  if (MpmSettingsGiven(settings, "output_every") && !strcmp(scene->task, "run")) {
    PetscCall(MpmSettingsInteger(settings, "output_every", &scene->output_every));
    if (!scene->output[0]) PetscCall(MpmSettingsRefuse(settings, "output_every", "allowed: only with output"));
  }
  scene->checkpoint_every = scene->steps;
  if (MpmSettingsGiven(settings, "checkpoint_every") && !strcmp(scene->task, "run")) {
    PetscCall(MpmSettingsInteger(settings, "checkpoint_every", &scene->checkpoint_every));
    if (!scene->checkpoint[0])
      PetscCall(MpmSettingsRefuse(settings, "checkpoint_every", "allowed: only with checkpoint"));
  }
  if (scene->output[0] && scene->layout.particles > PETSC_MAX_INT / 3)
    PetscCall(MpmSettingsRefuse(settings, "output", "too many particles for it; allowed: at most 715827882"));
  if (MpmSettingsGiven(settings, "progress")) {
    PetscCall(MpmSettingsSwitch(settings, "progress", &progress));
    scene->progress = progress ? MPM_PROGRESS_ALWAYS : MPM_PROGRESS_NEVER;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses units in which the exact solution itself has no size. */
static PetscErrorCode CheckSizes(const MpmSettings *settings, const MpmScene *scene)
{
  const MpmProfile profile = MpmSceneProfile(scene, scene->amplitude);

  PetscFunctionBegin;
  for (PetscInt f = 0; f < scene->scheme.table->nstate && scene->scheme.formulation->wave; f++)
    if (!isnormal(scene->scheme.formulation->wave->amplitude(&profile, f)))
      PetscCall(
          MpmSettingsRefuse(settings, "wave_speed",
                            "a field's amplitude is out of range with it; allowed: a speed nearer to length / time"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In this order: what comes later needs what came before. */
static PetscErrorCode ReadScene(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(ReadWords(settings, scene));
  PetscCall(ReadGrid(settings, scene));
  PetscCall(MpmSettingsLayout(settings, scene));
  PetscCall(ReadTime(settings, scene));
  PetscCall(MpmSettingsScheme(settings, scene));
  PetscCall(MpmSettingsMaterial(settings, scene));
  PetscCall(ReadAnalysis(settings, scene));
  if (!strcmp(scene->task, "map")) PetscCall(MpmSettingsAxes(settings, scene));
  PetscCall(ReadInitial(settings, scene));
  PetscCall(ReadDiagnostics(settings, scene));
  PetscCall(CheckSizes(settings, scene));
  PetscCall(ReadOutputs(settings, scene));
  PetscCall(MpmSettingsExpect(settings, scene, &scene->expect));
  if (scene->restart[0]) PetscCall(MpmCheckpointCheck(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A refusal frees what there is: the fuzzer reads one scene after another. */
PetscErrorCode MpmSceneCreate(const char task[], const char path[], MpmScene **scene)
{
  MpmSettings   *settings = NULL;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(PetscNew(scene));
  (*scene)->task = task;
  ierr           = MpmSettingsCreate(path, &settings);
  if (!ierr) ierr = ReadScene(settings, *scene);
  PetscCall(MpmSettingsDestroy(&settings));
  if (ierr) PetscCall(MpmSceneDestroy(scene));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneDestroy(MpmScene **scene)
{
  PetscFunctionBegin;
  PetscCall(MpmTableDestroy(&(*scene)->scheme.table));
  PetscCall(PetscFree(*scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
