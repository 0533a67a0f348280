/* From settings to a request: what a task is to do with its scene. */
#include "scene/settings.h"
#include "scene/solution.h"
#include <math.h>
#include <string.h>

#define MOST_STEPS 1e15

/* ---- time ---- */

/* Refuses a run whose end is at a time out of the range of doubles, and blames the option that is farthest from 1. */
static PetscErrorCode CheckEnd(const MpmSettings *settings, const MpmScene *scene, const MpmRequest *request)
{
  static const char *const given[]  = {"length",     "courant",     "dt",      "wave_speed", "steps", "time",
                                       "cell_width", "sound_speed", "density", "young",      "bulk",  "shear"};
  static const char        faster[] = "wave_speed sound_speed young bulk shear";
  const char              *blamed;

  PetscFunctionBegin;
  if (isfinite((PetscReal)request->steps * scene->dt)) PetscFunctionReturn(PETSC_SUCCESS);
  blamed = MpmSettingsFarthest(settings, PETSC_STATIC_ARRAY_LENGTH(given), given);
  PetscCall(MpmSettingsRefuse(settings, blamed, "steps times dt is out of range; allowed: a %s %s",
                              strstr(faster, blamed) ? "larger" : "smaller", blamed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A run that chooses its steps ends at a time after as many of them as it takes. */
static PetscErrorCode ReadSteps(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  PetscReal time, steps;

  PetscFunctionBegin;
  if (MpmSettingsGiven(settings, "time") && scene->safety > 0) {
    PetscCall(MpmSettingsReal(settings, "time", &request->end));
    request->steps = (PetscInt64)MOST_STEPS;
  } else if (MpmSettingsGiven(settings, "time")) {
    PetscCall(MpmSettingsReal(settings, "time", &time));
    /* a time that is a whole number of steps but for rounding does not get one more */
    steps = ceil(time / scene->dt * (1 - 1e-12));
    MpmSettingsRefuseIf(!(steps <= MOST_STEPS), settings, "time", "allowed: at most 1e15 steps of dt");
    request->steps = PetscMax((PetscInt64)steps, 1);
  }
  if (request->end == 0) PetscCall(CheckEnd(settings, scene, request));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what tasks measure ---- */

/* The waves are those of the phases along x that are at least 3 cells long. */
static PetscErrorCode ReadDamping(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  PetscFunctionBegin;
  if (!request->damping)
    PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_COMMAND_LINE, "damping_divisors", "allowed: only with damping"));
  if (!request->damping || strcmp(request->task, "symbol")) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(!scene->scheme.formulation->wave, settings, "damping",
                      "the formulation names no continuous problem whose waves could be followed; allowed: a "
                      "formulation with an exact solution");
  MpmSettingsRefuseIf(scene->layout.dim > 1 && MpmSpaceIsPrestressed(&scene->scheme.space), settings, "damping",
                      "waves about a prestressed state have no exact solution here; allowed: with dim 1, or "
                      "without a prestress");
  MpmSettingsRefuseIf(request->phases[0] < 3, settings, MpmSettingsGiven(settings, "phases") ? "phases" : "cells",
                      "damping needs a wave of 3 cells or more; allowed: 3 or more along x");
  PetscCall(MpmSettingsList(settings, "damping_divisors", MPM_MAX_DIVISORS, &request->ndivisors, request->divisors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Reads the Mach number. Of tasks that go over a period of steps, those that take the scene's own Courant number need a
   drift M k with a short one.
*/
static PetscErrorCode ReadMach(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  const PetscBool map = !strcmp(request->task, "map") ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(MpmSettingsReadMach(settings, scene->layout.dim, &request->mach));
  request->at_mach = request->mach.unit.num ? PETSC_TRUE : PETSC_FALSE;
  if (!request->at_mach || !strcmp(request->task, "run")) PetscFunctionReturn(PETSC_SUCCESS);
  if (!map || !(MpmRequestVaries(request, MPM_AXIS_COURANT) || MpmRequestVaries(request, MPM_AXIS_DRIFT) ||
                MpmRequestVaries(request, MPM_AXIS_MACH)))
    PetscCall(MpmSettingsCheckPeriod(settings, scene, &request->mach));
  MpmSettingsRefuseIf(request->survey, settings, "mach", "a survey keeps the drift; allowed: drift, or without survey");
  MpmSettingsRefuseIf(MpmRequestVaries(request, MPM_AXIS_DRIFT_ANGLE) && MpmRequestVaries(request, MPM_AXIS_COURANT),
                      settings, "mach", "a map that turns the drift keeps its size; allowed: drift");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A map over the Courant number keeps the drift, and a velocity whose drift is kept would not be kept itself. The limit
   is sought at one drift, too; it must not be that of the default Courant number.
*/
static PetscErrorCode CheckVelocity(const MpmSettings *settings, const MpmScene *scene, const MpmRequest *request)
{
  PetscFunctionBegin;
  MpmSettingsRefuseIf(MpmRequestVaries(request, MPM_AXIS_COURANT) && !MpmRequestVaries(request, MPM_AXIS_DRIFT) &&
                          !MpmRequestVaries(request, MPM_AXIS_MACH) && MpmSettingsGiven(settings, "velocity") &&
                          MpmSceneDrifts(scene),
                      settings, "velocity",
                      "the Courant number is varied at a fixed drift, and with it the drift of a velocity "
                      "would change; allowed: drift or mach");
  MpmSettingsRefuseIf(!strcmp(request->task, "critical") && MpmSettingsGiven(settings, "velocity") &&
                          !MpmSceneHasStep(scene),
                      settings, "velocity",
                      "how many cells particles move per step depends on the time step; allowed: with dt or "
                      "courant, or drift");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- axes of a map ---- */

const char *const MpmAxisNames[] = {"courant", "drift", "offset", "ppc", "poisson", "drift_angle", "mach", NULL};

static const char *const spans[] = {"map_courant", "map_drift",       "map_offset", "map_ppc",
                                    "map_poisson", "map_drift_angle", "map_mach"};

/* The options, by any of their names, whose place an axis takes. An angle turns the drift that is given. */
static const char *const replaced[] = {"courant,dt", "drift,velocity,mach", "offset", "ppc", "poisson",
                                       "",           "mach,velocity,drift"};

/* In more dimensions than one the scene's drift, or mach, still says along which axes the map's goes. */
static PetscErrorCode RefuseReplaced(const MpmSettings *settings, const MpmScene *scene, PetscInt kind)
{
  const char *names = replaced[kind];
  char        why[128];

  PetscFunctionBegin;
  (void)snprintf(why, sizeof why, "the map goes over it; allowed: -%s lo,hi", spans[kind]);
  if (scene->layout.dim > 1 && (kind == MPM_AXIS_DRIFT || kind == MPM_AXIS_MACH)) names = strchr(names, ',') + 1;
  PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_COMMAND_LINE, names, why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An axis of particles per cell has every number between its ends; the default number of points does not count. */
static PetscErrorCode CountPpc(const MpmSettings *settings, PetscInt points, MpmAxis *axis)
{

  PetscFunctionBegin;
  MpmSettingsRefuseIf(axis->from.den != 1 || axis->to.den != 1, settings, "map_ppc",
                      "allowed: two whole numbers lo,hi");
  axis->points = (PetscInt)(axis->to.num - axis->from.num) + 1;
  MpmSettingsRefuseIf(MpmSettingsSource(settings, "map_points") != MPM_FROM_DEFAULT && points != axis->points, settings,
                      "map_points", "map_ppc takes every number between its ends; allowed: %" PetscInt_FMT " for it",
                      axis->points);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses axes that the scene does not have. */
static PetscErrorCode CheckAxes(const MpmSettings *settings, const MpmScene *scene, const MpmRequest *request)
{
  PetscFunctionBegin;
  if (MpmRequestVaries(request, MPM_AXIS_POISSON) && !MpmSceneHasPoisson(scene))
    PetscCall(MpmSettingsRefuse(
        settings, "map_axes",
        "allowed: poisson only with dim 2 or 3, and a formulation with a stress (usl, usf, musl, usavg)"));
  MpmSettingsRefuseIf(MpmRequestVaries(request, MPM_AXIS_POISSON) && MpmSpaceIsPrestressed(&scene->scheme.space),
                      settings, "map_axes", "the prestress is of one Poisson's ratio; allowed: other axes");
  if (MpmRequestVaries(request, MPM_AXIS_POISSON))
    PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_SCENE, "young,bulk",
                                   "the map varies Poisson's ratio, and with it the wave speed of a modulus would "
                                   "change; allowed: sound_speed"));
  MpmSettingsRefuseIf(MpmRequestVaries(request, MPM_AXIS_DRIFT_ANGLE) && scene->layout.dim == 1, settings, "map_axes",
                      "allowed: drift_angle only with dim 2 or 3");
  MpmSettingsRefuseIf(MpmRequestVaries(request, MPM_AXIS_MACH) && (MpmRequestVaries(request, MPM_AXIS_DRIFT) ||
                                                                   MpmRequestVaries(request, MPM_AXIS_DRIFT_ANGLE)),
                      settings, "map_axes", "mach makes the drift; allowed: mach with another axis");
  MpmSettingsRefuseIf(MpmRequestVaries(request, MPM_AXIS_DRIFT_ANGLE) && !MpmRequestVaries(request, MPM_AXIS_DRIFT) &&
                          scene->step.drift[0].value == 0 && scene->step.drift[1].value == 0,
                      settings, "map_axes",
                      "drift_angle turns the drift in the plane of x and y, which is 0; allowed: with a "
                      "drift such as 1/8,0");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells the two words of map_axes from one another. A word that is no axis may be a parameter of the scheme. */
static PetscErrorCode ReadKinds(const MpmSettings *settings, MpmRequest *request)
{
  const char *text = MpmSettingsText(settings, "map_axes"), *separators = ", ";

  PetscFunctionBegin;
  for (int a = 0; a < 2; a++) {
    const size_t length = strcspn(text, separators);
    MpmAxis     *axis   = &request->axes[a];

    MpmSettingsRefuseIf(length >= sizeof axis->name, settings, "map_axes",
                        "allowed: two names of axes, none of them so long");
    (void)snprintf(axis->name, length + 1, "%s", text);
    axis->parameter = settings->scheme ? MpmWrittenFindParameter(settings->scheme, axis->name) : MPM_NONE;
    text += length + strspn(text + length, separators);
  }
  if (request->axes[0].parameter == MPM_NONE && request->axes[1].parameter == MPM_NONE) {
    PetscInt kinds[1][2];

    PetscCall(MpmSettingsEnds(settings, "map_axes", 1, kinds));
    for (int a = 0; a < 2; a++) request->axes[a].kind = (MpmAxisKind)kinds[0][a];
  } else
    for (int a = 0; a < 2; a++) {
      PetscInt kind = 0;

      while (MpmAxisNames[kind] && strcmp(MpmAxisNames[kind], request->axes[a].name)) kind++;
      MpmSettingsRefuseIf(!MpmAxisNames[kind] && request->axes[a].parameter == MPM_NONE, settings, "map_axes",
                          "allowed: two different ones of courant, drift, offset, ppc, poisson, drift_angle, "
                          "mach and the parameters of the scheme");
      request->axes[a].kind = request->axes[a].parameter == MPM_NONE ? (MpmAxisKind)kind : MPM_AXIS_PARAMETER;
    }
  for (int a = 0; a < 2; a++)
    if (request->axes[a].kind != MPM_AXIS_PARAMETER)
      (void)snprintf(request->axes[a].name, sizeof request->axes[a].name, "%s", MpmAxisNames[request->axes[a].kind]);
  MpmSettingsRefuseIf(*text || !strcmp(request->axes[0].name, request->axes[1].name), settings, "map_axes",
                      "allowed: two different ones of courant, drift, offset, ppc, poisson, drift_angle and mach");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The span of a parameter, which has no default. The map takes the place of the parameter's value. */
static PetscErrorCode ReadParameterSpan(const MpmSettings *settings, const MpmAxis *axis, MpmFraction span[2])
{
  const MpmSettingsParameter *own  = MpmSettingsParameterSaid(settings, "", axis->name);
  const MpmSettingsParameter *said = MpmSettingsParameterSaid(settings, "map_", axis->name);

  PetscFunctionBegin;
  if (own && own->source == MPM_FROM_COMMAND_LINE)
    PetscCall(MpmSettingsRefuseParameter(settings, own, "the map goes over it; allowed: its span lo,hi, after map_"));
  MpmCheckInput(said, "map_axes %s: allowed: with its span, as -map_%s lo,hi", MpmSettingsText(settings, "map_axes"),
                axis->name);
  if (!MpmSettingsParseSpan(said->text, span))
    PetscCall(MpmSettingsRefuseParameter(settings, said,
                                         "allowed: two numbers or fractions lo,hi (in a scene: [lo, hi]), lo < hi"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses the span of a parameter that is on the command line and that this map, or another task, does not read. */
static PetscErrorCode CheckSpans(const MpmSettings *settings, const MpmRequest *request)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; settings->scheme && i < settings->scheme->nparameters; i++) {
    const char                 *name = settings->scheme->parameters[i].name.text;
    const MpmSettingsParameter *said = MpmSettingsParameterSaid(settings, "map_", name);
    const PetscBool             axis =
        !strcmp(request->task, "map") && (request->axes[0].parameter == i || request->axes[1].parameter == i)
                        ? PETSC_TRUE
                        : PETSC_FALSE;

    if (said && said->source == MPM_FROM_COMMAND_LINE && !axis)
      PetscCall(
          MpmSettingsRefuseParameter(settings, said, "allowed: with task map, where map_axes names the parameter"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadAxes(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  PetscInt points[2], n;

  PetscFunctionBegin;
  PetscCall(ReadKinds(settings, request));
  PetscCall(MpmSettingsList(settings, "map_points", 2, &n, points));
  MpmSettingsRefuseIf(n != 2, settings, "map_points", "allowed: two whole numbers, one for each axis");
  for (int a = 0; a < 2; a++) {
    MpmAxis    *axis = &request->axes[a];
    MpmFraction span[2];

    if (axis->kind == MPM_AXIS_PARAMETER)
      PetscCall(ReadParameterSpan(settings, axis, span));
    else {
      PetscCall(RefuseReplaced(settings, scene, axis->kind));
      PetscCall(MpmSettingsSpan(settings, spans[axis->kind], span));
    }
    axis->from   = span[0];
    axis->to     = span[1];
    axis->points = points[a];
    if (axis->kind == MPM_AXIS_PPC) PetscCall(CountPpc(settings, points[a], axis));
  }
  for (PetscInt i = 0; i < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(spans); i++)
    MpmSettingsRefuseIf(MpmSettingsSource(settings, spans[i]) == MPM_FROM_COMMAND_LINE &&
                            i != (PetscInt)request->axes[0].kind && i != (PetscInt)request->axes[1].kind,
                        settings, spans[i], "map_axes does not name it; allowed: with an axis of that name");
  PetscCall(CheckAxes(settings, scene, request));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- files ---- */

/* The file with the eigenmode that a run starts from; the tasks that do not march leave initial data alone. */
static PetscErrorCode CheckModeFile(const MpmSettings *settings, const MpmScene *scene, const MpmRequest *request)
{
  const PetscBool wanted = scene->initial == MPM_INITIAL_EIGENMODE ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (strcmp(request->task, "run")) PetscFunctionReturn(PETSC_SUCCESS);
  MpmCheckInput(!wanted || request->mode_file[0],
                "initial eigenmode needs mode_file; allowed: a file that 'mpmstab spectrum -output' has written");
  if (!wanted && request->mode_file[0])
    PetscCall(MpmSettingsRefuseUnless(settings, "mode_file", "initial", "allowed: only with initial eigenmode"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Steps between two outputs or checkpoints of a run: as many as the run has when the option is not given. */
static PetscErrorCode CheckEvery(const MpmSettings *settings, const char name[], const char file[], const char path[],
                                 const MpmRequest *request, PetscInt64 *every)
{

  PetscFunctionBegin;
  if (strcmp(request->task, "run") || !MpmSettingsGiven(settings, name))
    *every = request->steps;
  else if (!path[0]) {
    PetscCall(MpmSettingsRefuse(settings, name, "allowed: only with %s", file));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadOutputs(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  PetscBool progress;

  PetscFunctionBegin;
  if (scene) PetscCall(CheckModeFile(settings, scene, request));
  PetscCall(MpmSettingsReadFiles(settings, request));
  PetscCall(CheckEvery(settings, "output_every", "output", request->output, request, &request->output_every));
  MpmSettingsRefuseIf(request->output_interval > 0 && !request->output[0], settings, "output_interval",
                      "allowed: only with output");
  PetscCall(
      CheckEvery(settings, "checkpoint_every", "checkpoint", request->checkpoint, request, &request->checkpoint_every));
  MpmSettingsRefuseIf(request->output[0] && scene && scene->layout.particles > PETSC_MAX_INT / 3, settings, "output",
                      "too many particles for it; allowed: at most 715827882");
  if (MpmSettingsGiven(settings, "progress")) {
    PetscCall(MpmSettingsSwitch(settings, "progress", &progress));
    request->progress = progress ? MPM_PROGRESS_ALWAYS : MPM_PROGRESS_NEVER;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what must come out ---- */

const char *const MpmExpectOptions[MPM_EXPECTED] = {"expect_growth", "expect_spectrum", "expect_error",
                                                    "expect_energy", "expect_critical", "expect_share"};

/* A scene's verdict may be that of a run; critical has none for a time step that was not given. */
static PetscErrorCode CheckVerdictAsked(const MpmSettings *settings, const MpmScene *scene, const char task[],
                                        MpmExpect *expect)
{
  PetscFunctionBegin;
  if (strcmp(task, "critical") || !scene || MpmSceneHasStep(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(MpmSettingsSource(settings, "expect") != MPM_FROM_SCENE, settings, "expect",
                      "the scene has no time step to judge; allowed: with dt or courant");
  expect->has_verdict = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadExpect(const MpmSettings *settings, const MpmScene *scene, const char task[],
                                 MpmExpect *expect)
{
  PetscFunctionBegin;
  expect->has_verdict = MpmSettingsGiven(settings, "expect");
  expect->has_kind    = MpmSettingsGiven(settings, "expect_kind");
  for (MpmExpected e = 0; e < MPM_EXPECTED; e++) expect->has[e] = MpmSettingsGiven(settings, MpmExpectOptions[e]);
  if (expect->has_verdict && scene) PetscCall(CheckVerdictAsked(settings, scene, task, expect));
  if (expect->has[MPM_EXPECT_ERROR] && scene && !MpmSceneHasExact(scene)) {
    PetscCall(MpmSettingsRefuseUnless(
        settings, "expect_error", "initial,boundary",
        "there is no exact solution; allowed: with initial mode, pulse or step in a full domain"));
    expect->has[MPM_EXPECT_ERROR] = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define NODAL_FROM 500 /* unknowns of particles; fewer take no time, and their operator is the better balanced one */

/* What reads the linear step of a scheme has none at finite deformation. */
static PetscErrorCode CheckKinematics(const MpmSettings *settings, const MpmScene *scene, const MpmRequest *request)
{
  PetscFunctionBegin;
  MpmSettingsRefuseIf(scene->safety > 0 && strcmp(request->task, "run"), settings, "courant",
                      "allowed with this task: a number");
  if (!scene->scheme.space.finite) PetscFunctionReturn(PETSC_SUCCESS);
  if (strcmp(request->task, "run") && strcmp(request->task, "spectrum"))
    PetscCall(MpmSettingsRefuse(
        settings, "kinematics",
        "this task needs a linear step; allowed: tasks run and spectrum; or kinematics linear, which with "
        "material and stretch, or prestress, is about a uniform state"));
  MpmSettingsRefuseIf((request->weights || request->source_term || request->ringing), settings, "kinematics",
                      "weights, source_term and ringing are of the linear step; allowed: without them");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An exact solution that ends before the run does would be wrong. */
static PetscErrorCode CheckSolution(const MpmSettings *settings, const MpmScene *scene, const MpmRequest *request)
{
  const MpmSolution *solution = MpmSolutionOf(scene);

  PetscFunctionBegin;
  if (!solution) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(scene->safety > 0 && request->end == 0, settings, "courant",
                      "its exact solution holds until some time, and the time of so many steps is not known; "
                      "allowed: with time in the place of steps");
  if ((scene->safety > 0 ? request->end : request->steps * scene->dt) <= solution->end(scene))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRefuse(settings, "initial",
                              "its exact solution holds until time %.6g; allowed: a run to that time or before",
                              (double)solution->end(scene)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadRequest(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    request->phases[a] = scene->layout.grid[a].cells; /* unless something else is said */
  PetscCall(MpmSettingsReadFields(settings, MPM_OF_REQUEST, &scene->layout.dim, request));
  request->nodal_asked = MpmSettingsGiven(settings, "nodal");
  if (!request->nodal_asked)
    request->nodal = scene->layout.particles * scene->scheme.table->nstate >= NODAL_FROM ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(CheckKinematics(settings, scene, request));
  PetscCall(MpmSettingsReadTangent(settings, scene, request));
  PetscCall(ReadSteps(settings, scene, request));
  PetscCall(CheckSolution(settings, scene, request));
  if (request->survey) /* it does not depend on the scene's Courant number */
    PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_COMMAND_LINE,
                                   "formulation,scheme,basis,transfer,courant,dt,expect,expect_critical,json",
                                   "a survey goes through all schemes; allowed: without survey"));
  PetscCall(ReadDamping(settings, scene, request));
  for (int a = 0; a < 2; a++) request->axes[a].parameter = MPM_NONE;
  if (!strcmp(request->task, "map")) PetscCall(ReadAxes(settings, scene, request));
  PetscCall(CheckSpans(settings, request));
  PetscCall(CheckVelocity(settings, scene, request));
  PetscCall(ReadMach(settings, scene, request));
  PetscCall(MpmSettingsReadNeighbourhoods(settings, scene, request));
  /* the slides define their weights for hat functions, at nodes with a cell on either side */
  MpmSettingsRefuseIf(!strcmp(request->task, "run") && request->weights &&
                          !(scene->scheme.basis->hat && MpmSceneIsPeriodic(scene)),
                      settings, "weights", "allowed: with basis linear and boundary periodic");
  PetscCall(ReadOutputs(settings, scene, request));
  PetscCall(ReadExpect(settings, scene, request->task, &request->expect));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Reads what a task is to do with a matrix. How many directions its lattice has is known when its file is read: one number
   of phases is for all of them.
*/
PetscErrorCode MpmSettingsReadMatrixRequest(const MpmSettings *settings, MpmRequest *request)
{
  PetscInt dim;

  PetscFunctionBegin;
  MpmSettingsPhases(settings, &request->given_phases);
  dim = request->given_phases > 1 ? PetscMin(request->given_phases, MPM_MAX_DIM) : MPM_MAX_DIM;
  PetscCall(MpmSettingsReadFields(settings, MPM_OF_REQUEST, &dim, request));
  PetscCall(MpmSettingsReadProgram(settings, request));
  if (!strcmp(request->task, "map")) PetscCall(MpmSettingsReadProgramAxes(settings, request));
  PetscCall(ReadOutputs(settings, NULL, request));
  PetscCall(ReadExpect(settings, NULL, request->task, &request->expect));
  PetscFunctionReturn(PETSC_SUCCESS);
}
