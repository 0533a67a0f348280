/* From settings to a request: what a task is to do with its scene. */
#include "scene/settings.h"
#include "scene/solution.h"
#include <math.h>
#include <string.h>

#define ALL MPM_NEIGHBOURHOODS /* the word after those of the kinds */
#define MANY_LAYOUTS 100       /* of an ensemble, when the option layouts is not given */
#define SOME_LAYOUTS 20        /* of neighbourhoods random and disordered, whose limits are sought too */

static PetscBool Is(const MpmRequest *request, const char task[])
{
  return strcmp(request->task, task) ? PETSC_FALSE : PETSC_TRUE;
}

const char *const MpmNeighbourhoodNames[] = {"bulk",       "edge",  "corner", "lone", "random",
                                             "disordered", "worst", "all",    NULL};

/*
   The default answer of critical has a table of steps by layout for lattices at rest with a scheme of the program,
   whose searches are quick. Of such lattices it says why there is none.
*/
static const char *WhyNoTable(const MpmScheme *scheme)
{
  if (MpmTableSolves(scheme->table)) return "the searches for other layouts are for steps without a linear system";
  if (scheme->formulation->written) return "it is made for the schemes of the program";
  if (MpmSpaceIsDamped(&scheme->space)) return "it is made for schemes without damping and viscosity";
  if (MpmSpaceIsPrestressed(&scheme->space)) return "a particle with nothing around it holds no prestress";
  return NULL;
}

static void AskTable(const MpmScene *scene, MpmRequest *request)
{
  const MpmLayout *layout = &scene->layout;

  if (request->survey || request->at_mach || !MpmLayoutIsUniform(layout) || layout->counts.n > 1 ||
      layout->cluster[1] - layout->cluster[0] < 1 || MpmSceneDrifts(scene))
    return;
  request->no_table = WhyNoTable(&scene->scheme);
  request->table    = request->no_table ? PETSC_FALSE : PETSC_TRUE;
}

/*
   What is asked of where nothing was given. With a table of steps only what is quick, since it names the others: edges
   take long with rk, and random layouts where growth is not known to stay.
*/
static PetscInt Default(const MpmScene *scene, PetscBool all, PetscBool table, PetscInt word[])
{
  static const PetscInt quick[] = {MPM_IN_BULK, MPM_ALONE, MPM_AT_EDGE, MPM_DISORDERED};
  const MpmScheme      *scheme  = &scene->scheme;
  const PetscBool       stays = scheme->formulation->leftmost && scheme->transfer->leftmost ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt        n     = scene->layout.dim == 3 || scheme->formulation->quiet ? 2 : stays ? 4 : 3;

  word[0] = all ? ALL : MPM_IN_BULK;
  if (!all || !table || (scene->layout.dim == 1 && n == 4)) return 1;
  for (PetscInt i = 0; i < n; i++) word[i] = quick[i];
  return n;
}

static PetscErrorCode ReadNeighbourhoods(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  const PetscBool critical = Is(request, "critical");
  /* one with walls, gaps or jitter says itself where its particles end */
  const PetscBool fills = MpmSceneIsPhysical(scene) && MpmLayoutIsUniform(&scene->layout) ? PETSC_TRUE : PETSC_FALSE;
  PetscInt        word[MPM_NEIGHBOURHOODS + 1], n = 0;

  PetscFunctionBegin;
  if ((critical || Is(request, "spectrum")) && MpmSettingsGiven(settings, "neighbourhood"))
    PetscCall(MpmSettingsWords(settings, "neighbourhood", MPM_NEIGHBOURHOODS + 1, &n, word));
  if (critical && !n) AskTable(scene, request);
  if (!n) n = Default(scene, critical && !request->survey && !request->at_mach && fills, request->table, word);
  /* all leaves out a corner in one dimension, where it is an edge, and the worst, whose search takes long */
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt kind = 0; kind < MPM_NEIGHBOURHOODS; kind++)
      if (kind == word[i] ||
          (word[i] == ALL && (scene->layout.dim > 1 || kind != MPM_AT_CORNER) && kind != MPM_AT_WORST))
        request->neighbourhood[kind] = PETSC_TRUE;
  if (!MpmSettingsGiven(settings, "layouts")) request->layouts = Is(request, "ensemble") ? MANY_LAYOUTS : SOME_LAYOUTS;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the tangent of a run ---- */

const char *const MpmTangentNames[] = {"none", "random", "mode", NULL};

/* Why the step of a scene has no tangent here, or NULL where it has one. */
static const char *WhyNot(const MpmScene *scene)
{
  if (!scene->scheme.space.finite) return "the step is linear, and is its own tangent; allowed: with kinematics finite";
  if (scene->scheme.space.local != 0)
    return "with local_damping the step has no derivative where a velocity is 0; allowed: without local_damping";
  if (scene->artificial[0] > 0 || scene->artificial[1] > 0)
    return "an artificial viscosity acts in compression alone, and has no derivative where the volume rests; allowed: "
           "without artificial_linear and artificial_quadratic, or bulk_viscosity in their place";
  if (scene->scheme.numbers.rk_relax)
    return "with rk_relax a step has a factor, which has no derivative where it comes to 1; allowed: without rk_relax";
  if (MpmCollidersStiffness(scene->layout.colliders) > 0)
    return "what a collider of contact penalty gives particles has no part in the tangent; allowed: another contact";
  if (scene->scheme.numbers.rk_places == MPM_RK_STAGES && scene->body_force)
    return "with rk_places stages a body force is also that of other times than the step's; allowed: rk_places frozen";
  if (MpmTableHas(scene->scheme.table, MPM_SOLVE))
    return "transfer nullspace has a pseudoinverse, whose derivative is not known here; allowed: another transfer";
  if (MpmBasisIsAltered(scene->scheme.basis))
    return "with spline_ends modified or open the derivatives of its weights are not known here; allowed: spline_ends "
           "mirror";
  return NULL;
}

/*
   Refuses a scene without a tangent, and more numbers of a state than PETSC_MAX_INT: of each place there are a cell and
   a place in the cell.
*/
static PetscErrorCode CheckTangent(const MpmSettings *settings, const MpmScene *scene, const char option[])
{
  const PetscInt64 each = 2 * scene->layout.dim + scene->scheme.table->nstate;
  const char      *why  = WhyNot(scene);

  PetscFunctionBegin;
  MpmSettingsRefuseIf(why, settings, option, "%s", why);
  MpmSettingsRefuseIf(scene->layout.particles > PETSC_MAX_INT / each, settings, option,
                      "too many particles for a tangent, %" PetscInt64_FMT "; allowed: at most %" PetscInt64_FMT,
                      scene->layout.particles, PETSC_MAX_INT / each);
  PetscFunctionReturn(PETSC_SUCCESS);
}

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

/* ---- axes of a map ---- */

const char *const MpmAxisNames[] = {"courant", "drift", "offset", "ppc", "poisson", "drift_angle", "mach", NULL};

/* The options, by any of their names, whose place an axis takes. An angle turns the drift that is given. */
static const char *const replaced[] = {"courant,dt", "drift,velocity,mach", "offset", "ppc", "poisson",
                                       "",           "mach,velocity,drift"};

/*
   In more dimensions than one the first of these, drift or mach, still says along which axes the map's goes, and stays.
*/
static PetscErrorCode RefuseReplaced(const MpmSettings *settings, const MpmScene *scene, PetscInt kind)
{
  const PetscBool rest =
      scene->layout.dim > 1 && (kind == MPM_AXIS_DRIFT || kind == MPM_AXIS_MACH) ? PETSC_TRUE : PETSC_FALSE;
  const char *names = rest ? strchr(replaced[kind], ',') + 1 : replaced[kind];
  char        why[128];

  PetscFunctionBegin;
  (void)snprintf(why, sizeof why, "the map goes over it; allowed: -map_%s lo,hi", MpmAxisNames[kind]);
  GIVEN(names, MPM_FROM_COMMAND_LINE, PETSC_TRUE, why);
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

/* The two words of map_axes; whether there are two that differ. */
static PetscBool NameAxes(const char text[], MpmAxis axes[2])
{
  for (int a = 0; a < 2; a++) {
    const size_t length = strcspn(text, ", ");

    if (length >= sizeof axes[a].name) return PETSC_FALSE;
    (void)snprintf(axes[a].name, PetscMin(length + 1, sizeof axes[a].name), "%s", text);
    text += length + strspn(text + length, ", ");
  }
  return axes[0].name[0] && axes[1].name[0] && !*text && strcmp(axes[0].name, axes[1].name) ? PETSC_TRUE : PETSC_FALSE;
}

/* What the axes of a map of a scene are: words of map_axes, or parameters of its scheme. */
static PetscErrorCode ReadKinds(const MpmSettings *settings, MpmAxis axes[2])
{
  PetscBool two = NameAxes(MpmSettingsText(settings, "map_axes"), axes);

  PetscFunctionBegin;
  for (int a = 0; a < 2; a++)
    axes[a].parameter = settings->scheme ? MpmWrittenFindParameter(settings->scheme, axes[a].name) : MPM_NONE;
  if (axes[0].parameter == MPM_NONE && axes[1].parameter == MPM_NONE) {
    PetscInt kinds[2];

    PetscCall(MpmSettingsRead(settings, "map_axes", MPM_AS_ENDS, 1, 0, kinds));
    for (int a = 0; a < 2; a++) (void)snprintf(axes[a].name, sizeof axes[a].name, "%s", MpmAxisNames[kinds[a]]);
    two = kinds[0] != kinds[1] ? PETSC_TRUE : PETSC_FALSE;
  }
  for (int a = 0; a < 2; a++) {
    PetscInt kind = 0;

    while (MpmAxisNames[kind] && strcmp(MpmAxisNames[kind], axes[a].name)) kind++;
    MpmSettingsRefuseIf(!MpmAxisNames[kind] && axes[a].parameter == MPM_NONE, settings, "map_axes",
                        "allowed: two different ones of courant, drift, offset, ppc, poisson, drift_angle, "
                        "mach and the parameters of the scheme");
    axes[a].kind = axes[a].parameter == MPM_NONE ? (MpmAxisKind)kind : MPM_AXIS_PARAMETER;
  }
  MpmSettingsRefuseIf(!two, settings, "map_axes",
                      "allowed: two different ones of courant, drift, offset, ppc, poisson, drift_angle and mach");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The axes of a map of a code are parameters that the code names, which are known only when it has been started. */
static PetscErrorCode ReadKindsOfCode(MpmSettings *settings, MpmAxis axes[2])
{
  PetscFunctionBegin;
  MpmCheckInput(
      MpmSettingsSource(settings, "map_axes") != MPM_FROM_DEFAULT,
      "map of a code: map_axes is missing; allowed: -map_axes with two parameters that the code names, such as "
      "dt,E, and a span for each, as -map_dt lo,hi");
  MpmSettingsRefuseIf(!NameAxes(MpmSettingsText(settings, "map_axes"), axes), settings, "map_axes",
                      "allowed: two different parameters that the code names, such as dt,E");
  for (int a = 0; a < 2; a++) {
    char span[48];

    (void)snprintf(span, sizeof span, "map_%s", axes[a].name);
    MpmCheckInput(!MpmSettingsIsOfMap(axes[a].name) && !strchr(axes[a].name, '/'),
                  "-map_axes %s: files of maps cannot hold numbers of that name; allowed: other parameters",
                  axes[a].name);
    PetscCall(MpmSettingsReadOption(settings, span, MPM_FROM_DEFAULT));
    axes[a].kind      = MPM_AXIS_PARAMETER;
    axes[a].parameter = MPM_NONE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The span of a parameter, of a scheme or of a code, has no default. The map takes the place of a scheme's value. */
static PetscErrorCode ReadParameterSpan(const MpmSettings *settings, const MpmAxis *axis, PetscBool code,
                                        const char option[], MpmFraction span[2])
{
  PetscFunctionBegin;
  MpmSettingsRefuseIf(!code && MpmSettingsSource(settings, axis->name) == MPM_FROM_COMMAND_LINE, settings, axis->name,
                      "the map goes over it; allowed: its span lo,hi, after map_");
  MpmCheckInput(MpmSettingsSource(settings, option) != MPM_FROM_DEFAULT,
                code ? "-map_axes %.32s: the span of that axis is missing; allowed: with -map_%s lo,hi"
                     : "map_axes %s: allowed: with its span, as -map_%s lo,hi",
                code ? axis->name : MpmSettingsText(settings, "map_axes"), axis->name);
  MpmSettingsRefuseIf(!MpmSettingsParseSpan(MpmSettingsText(settings, option), span), settings, option,
                      code ? "allowed: two numbers or fractions lo,hi with lo < hi"
                           : "allowed: two numbers or fractions lo,hi (in a scene: [lo, hi]), lo < hi");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses the span of a parameter that is on the command line and that this map, or another task, does not read. */
static PetscErrorCode CheckSpans(const MpmSettings *settings, const MpmRequest *request)
{
  char span[96];

  PetscFunctionBegin;
  for (PetscInt i = 0; settings->scheme && i < settings->scheme->nparameters; i++) {
    (void)snprintf(span, sizeof span, "map_%s", settings->scheme->parameters[i].name.text);
    MpmSettingsRefuseIf(
        MpmSettingsSource(settings, span) == MPM_FROM_COMMAND_LINE &&
            !(Is(request, "map") && (request->axes[0].parameter == i || request->axes[1].parameter == i)),
        settings, span, "allowed: with task map, where map_axes names the parameter");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The numbers of the axes, whose kinds are known. scene NULL: a code takes its place. */
static PetscErrorCode ReadAxes(const MpmSettings *settings, const MpmScene *scene, MpmAxis axes[2])
{
  PetscInt points[2], n;

  PetscFunctionBegin;
  PetscCall(MpmSettingsList(settings, "map_points", 2, &n, points));
  MpmSettingsRefuseIf(n != 2, settings, "map_points", "allowed: two whole numbers, one for each axis");
  for (int a = 0; a < 2; a++) {
    char        option[48];
    MpmFraction span[2];

    (void)snprintf(option, sizeof option, "map_%s", axes[a].name);
    if (axes[a].kind == MPM_AXIS_PARAMETER)
      PetscCall(ReadParameterSpan(settings, &axes[a], scene ? PETSC_FALSE : PETSC_TRUE, option, span));
    else {
      PetscCall(RefuseReplaced(settings, scene, axes[a].kind));
      PetscCall(MpmSettingsSpan(settings, option, span));
    }
    axes[a].from   = span[0];
    axes[a].to     = span[1];
    axes[a].points = points[a];
    if (axes[a].kind == MPM_AXIS_PPC) PetscCall(CountPpc(settings, points[a], &axes[a]));
  }
  for (PetscInt i = 0; MpmAxisNames[i]; i++) {
    char option[48];

    (void)snprintf(option, sizeof option, "map_%s", MpmAxisNames[i]);
    MpmSettingsRefuseIf(MpmSettingsSource(settings, option) >= (scene ? MPM_FROM_COMMAND_LINE : MPM_FROM_SCENE) &&
                            strcmp(MpmAxisNames[i], axes[0].name) && strcmp(MpmAxisNames[i], axes[1].name),
                        settings, option, "map_axes does not name it; allowed: with %s of that name",
                        scene ? "an axis" : "a parameter of the code");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- files ---- */

/* A run writes its last step where it is not said how many steps there are between two outputs or checkpoints. */
static PetscErrorCode ReadOutputs(const MpmSettings *settings, MpmRequest *request)
{
  PetscBool progress;

  PetscFunctionBegin;
  PetscCall(MpmSettingsReadFiles(settings, request));
  if (!MpmSettingsGiven(settings, "output_every")) request->output_every = request->steps;
  if (!MpmSettingsGiven(settings, "checkpoint_every")) request->checkpoint_every = request->steps;
  if (MpmSettingsGiven(settings, "progress")) {
    PetscCall(MpmSettingsSwitch(settings, "progress", &progress));
    request->progress = progress ? MPM_PROGRESS_ALWAYS : MPM_PROGRESS_NEVER;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what must come out ---- */

const char *const MpmExpectOptions[MPM_EXPECTED] = {"expect_growth", "expect_spectrum", "expect_error",
                                                    "expect_energy", "expect_critical", "expect_share"};

static PetscErrorCode ReadExpect(const MpmSettings *settings, const MpmScene *scene, const char task[],
                                 MpmExpect *expect)
{
  PetscFunctionBegin;
  expect->has_verdict = MpmSettingsGiven(settings, "expect");
  expect->has_kind    = MpmSettingsGiven(settings, "expect_kind");
  for (MpmExpected e = 0; e < MPM_EXPECTED; e++) /* a scene may have what other tasks find */
    expect->has[e] = MpmSettingsGiven(settings, MpmExpectOptions[e]) &&
                             MpmFieldIsOf(&MpmOptions[MpmOptionIndex(MpmExpectOptions[e])], task)
                         ? PETSC_TRUE
                         : PETSC_FALSE;
  if (expect->has_verdict && scene && !strcmp(task, "critical") && !MpmSceneHasStep(scene)) {
    /* a scene's verdict may be that of a run; critical has none for a time step that was not given */
    MpmSettingsRefuseIf(MpmSettingsSource(settings, "expect") != MPM_FROM_SCENE, settings, "expect",
                        "the scene has no time step to judge; allowed: with dt or courant");
    expect->has_verdict = PETSC_FALSE;
  }
  if (MpmSettingsGiven(settings, "expect_error") && scene && !MpmSceneHasExact(scene)) {
    STANDS("expect_error", "initial,boundary", PETSC_TRUE,
           "there is no exact solution; allowed: with initial mode, pulse or step in a full domain");
    expect->has[MPM_EXPECT_ERROR] = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define NODAL_FROM 500 /* unknowns of particles; fewer take no time, and their operator is the better balanced one */

/* ---- what does not go together ---- */

/* clang-format off */
#define VARIES(axis) MpmRequestVaries(r, MPM_AXIS_##axis)
#define SEES(where)  r->neighbourhood[MPM_##where]

static PetscBool IsBeyondBulk(const MpmRequest *r)
{
  for (int kind = 0; kind < MPM_NEIGHBOURHOODS; kind++)
    if (r->neighbourhood[kind] != (kind == MPM_IN_BULK)) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Rules that follow from options alone. */
static PetscErrorCode CheckAtFirst(const MpmSettings *settings, const MpmScene *s, const MpmRequest *r)
{
  PetscFunctionBegin;
  GIVEN("courant", MPM_FROM_DEFAULT, s->safety > 0 && !Is(r, "run"), "allowed with this task: a number");
  GIVEN("kinematics", MPM_FROM_DEFAULT, s->scheme.space.finite && !Is(r, "run") && !Is(r, "spectrum"), "this task needs a linear step; allowed: tasks run and spectrum; or kinematics linear, which with material and stretch, or prestress, is about a uniform state");
  GIVEN("kinematics", MPM_FROM_DEFAULT, s->scheme.space.finite && (r->weights || r->source_term || r->ringing), "weights, source_term and ringing are of the linear step; allowed: without them");
  GIVEN("measure,nodal,neighbourhood,modes", MPM_FROM_SCENE, s->scheme.space.finite && Is(r, "spectrum"), "it is of a linear step; allowed: with kinematics linear");
  GIVEN("initial,mode,polarisation,amplitude,gravity,at_step", MPM_FROM_COMMAND_LINE, !s->scheme.space.finite && Is(r, "spectrum"), "the spectrum of a linear step does not depend on it; allowed: with task run, or with kinematics finite");
  GIVEN("window,exponents,warn_above", MPM_FROM_SCENE, !r->tangent, "nothing reads it here; allowed: with tangent");
  GIVEN("exponents", MPM_FROM_DEFAULT, (PetscInt64)r->exponents > (s->layout.dim + s->scheme.table->nstate) * s->layout.particles, "allowed: no more than places and fields of all particles");
  GIVEN("formulation,scheme,basis,transfer,courant,dt,expect,expect_critical,json", MPM_FROM_COMMAND_LINE, r->survey, "a survey goes through all schemes; allowed: without survey");
  GIVEN("damping_divisors", MPM_FROM_COMMAND_LINE, !r->damping, "allowed: only with damping");
  GIVEN("damping", MPM_FROM_DEFAULT, r->damping && Is(r, "symbol") && !s->scheme.formulation->wave, "the formulation names no continuous problem whose waves could be followed; allowed: a formulation with an exact solution");
  GIVEN("damping", MPM_FROM_DEFAULT, r->damping && Is(r, "symbol") && s->layout.dim > 1 && MpmSpaceIsPrestressed(&s->scheme.space), "waves about a prestressed state have no exact solution here; allowed: with dim 1, or without a prestress");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rules of axes, Mach numbers and neighbourhoods, which are read before. */
static PetscErrorCode CheckAtLast(const MpmSettings *settings, const MpmScene *s, const MpmRequest *r)
{
  PetscFunctionBegin;
  GIVEN("map_axes", MPM_FROM_DEFAULT, VARIES(POISSON) && !MpmSceneHasPoisson(s), "allowed: poisson only with dim 2 or 3, and a formulation with a stress (usl, usf, musl, usavg)");
  GIVEN("map_axes", MPM_FROM_DEFAULT, VARIES(POISSON) && MpmSpaceIsPrestressed(&s->scheme.space), "the prestress is of one Poisson's ratio; allowed: other axes");
  GIVEN("young,bulk", MPM_FROM_SCENE, VARIES(POISSON), "the map varies Poisson's ratio, and with it the wave speed of a modulus would change; allowed: sound_speed");
  GIVEN("map_axes", MPM_FROM_DEFAULT, VARIES(DRIFT_ANGLE) && s->layout.dim == 1, "allowed: drift_angle only with dim 2 or 3");
  GIVEN("map_axes", MPM_FROM_DEFAULT, VARIES(MACH) && (VARIES(DRIFT) || VARIES(DRIFT_ANGLE)), "mach makes the drift; allowed: mach with another axis");
  GIVEN("map_axes", MPM_FROM_DEFAULT, VARIES(DRIFT_ANGLE) && !VARIES(DRIFT) && s->step.drift[0].value == 0 && s->step.drift[1].value == 0, "drift_angle turns the drift in the plane of x and y, which is 0; allowed: with a drift such as 1/8,0");
  /* a map over the Courant number keeps the drift, and a velocity whose drift is kept would not be kept itself */
  GIVEN("velocity", MPM_FROM_SCENE, VARIES(COURANT) && !VARIES(DRIFT) && !VARIES(MACH) && MpmSceneDrifts(s), "the Courant number is varied at a fixed drift, and with it the drift of a velocity would change; allowed: drift or mach");
  /* the limit is sought at one drift, too; it must not be that of the default Courant number */
  GIVEN("velocity", MPM_FROM_SCENE, Is(r, "critical") && !MpmSceneHasStep(s), "how many cells particles move per step depends on the time step; allowed: with dt or courant, or drift");
  GIVEN("mach", MPM_FROM_SCENE, r->survey && r->at_mach, "a survey keeps the drift; allowed: drift, or without survey");
  GIVEN("mach", MPM_FROM_SCENE, r->at_mach && VARIES(DRIFT_ANGLE) && VARIES(COURANT), "a map that turns the drift keeps its size; allowed: drift");
  GIVEN("neighbourhood", MPM_FROM_SCENE, r->survey && (Is(r, "critical") || Is(r, "spectrum")), "a survey is of the bulk; allowed: without survey");
  GIVEN("neighbourhood", MPM_FROM_SCENE, Is(r, "critical") && r->at_mach, "at a Mach number the search is of the bulk; allowed: drift");
  GIVEN("neighbourhood", MPM_FROM_DEFAULT, s->layout.given && IsBeyondBulk(r), "the layout of a file has its own surfaces; allowed: bulk, or layout uniform");
  GIVEN("neighbourhood", MPM_FROM_DEFAULT, s->layout.colliders && IsBeyondBulk(r), "colliders stand in the grid of the scene; allowed: bulk");
  GIVEN("csv,output,powers,pseudospectrum,modes,measure,nodal,write_matrix", MPM_FROM_COMMAND_LINE, !SEES(IN_BULK), "it is of the bulk; allowed: with neighbourhood bulk");
  GIVEN("voids", MPM_FROM_COMMAND_LINE, !SEES(AT_RANDOM), "allowed: with neighbourhood random");
  GIVEN("layouts", MPM_FROM_COMMAND_LINE, !Is(r, "ensemble") && !SEES(AT_RANDOM) && !SEES(DISORDERED) && !SEES(AT_WORST), "allowed: with neighbourhood random, disordered or worst");
  GIVEN("write_layout", MPM_FROM_COMMAND_LINE, !SEES(AT_WORST) && !s->layout.given, "allowed: with neighbourhood worst, or with layout FILE or random");
  /* the slides define their weights for hat functions, at nodes with a cell on either side */
  GIVEN("weights", MPM_FROM_DEFAULT, Is(r, "run") && r->weights && !(s->scheme.basis->hat && MpmSceneIsPeriodic(s)), "allowed: with basis linear and boundary periodic");
  STANDS("mode_file", "initial", Is(r, "run") && s->initial != MPM_INITIAL_EIGENMODE && r->mode_file[0], "allowed: only with initial eigenmode");
  GIVEN("output_every,output_interval", MPM_FROM_SCENE, Is(r, "run") && !r->output[0], "allowed: only with output");
  GIVEN("checkpoint_every", MPM_FROM_SCENE, Is(r, "run") && !r->checkpoint[0], "allowed: only with checkpoint");
  GIVEN("output", MPM_FROM_SCENE, r->output[0] && s->layout.particles > PETSC_MAX_INT / 3, "too many particles for it; allowed: at most 715827882");
  PetscFunctionReturn(PETSC_SUCCESS);
}
/* clang-format on */

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
  PetscCall(CheckAtFirst(settings, scene, request));
  if (request->tangent) PetscCall(CheckTangent(settings, scene, "tangent"));
  if (scene->scheme.space.finite && Is(request, "spectrum")) PetscCall(CheckTangent(settings, scene, "kinematics"));
  PetscCall(ReadSteps(settings, scene, request));
  PetscCall(CheckSolution(settings, scene, request));
  if (request->damping && Is(request, "symbol")) {
    MpmSettingsRefuseIf(request->phases[0] < 3, settings, MpmSettingsGiven(settings, "phases") ? "phases" : "cells",
                        "damping needs a wave of 3 cells or more; allowed: 3 or more along x");
    PetscCall(MpmSettingsList(settings, "damping_divisors", MPM_MAX_DIVISORS, &request->ndivisors, request->divisors));
  }
  for (int a = 0; a < 2; a++) request->axes[a].parameter = MPM_NONE;
  if (Is(request, "map")) {
    PetscCall(ReadKinds(settings, request->axes));
    PetscCall(ReadAxes(settings, scene, request->axes));
  }
  PetscCall(CheckSpans(settings, request));
  PetscCall(MpmSettingsReadMach(settings, scene->layout.dim, &request->mach));
  request->at_mach = request->mach.unit.num ? PETSC_TRUE : PETSC_FALSE;
  /* tasks that go over a period of steps at the scene's own Courant number need a drift M k with a short one */
  if (request->at_mach && !Is(request, "run") && !MpmRequestVaries(request, MPM_AXIS_COURANT) &&
      !MpmRequestVaries(request, MPM_AXIS_DRIFT) && !MpmRequestVaries(request, MPM_AXIS_MACH))
    PetscCall(MpmSettingsCheckPeriod(settings, scene, &request->mach));
  PetscCall(ReadNeighbourhoods(settings, scene, request));
  PetscCall(CheckAtLast(settings, scene, request));
  MpmCheckInput(!Is(request, "run") || scene->initial != MPM_INITIAL_EIGENMODE || request->mode_file[0],
                "initial eigenmode needs mode_file; allowed: a file that 'mpmstab spectrum -output' has written");
  PetscCall(ReadOutputs(settings, request));
  PetscCall(ReadExpect(settings, scene, request->task, &request->expect));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Reads what a task is to do with a matrix. How many directions its lattice has is known when its file is read: one
   number of phases is for all of them.
*/
PetscErrorCode MpmSettingsReadMatrixRequest(MpmSettings *settings, MpmRequest *request)
{
  const char *phases = MpmSettingsText(settings, "phases");
  PetscInt    dim;

  PetscFunctionBegin;
  request->given_phases = phases ? 1 : 0;
  for (; phases && *phases; phases++) request->given_phases += *phases == ',';
  dim = request->given_phases > 1 ? PetscMin(request->given_phases, MPM_MAX_DIM) : MPM_MAX_DIM;
  PetscCall(MpmSettingsReadFields(settings, MPM_OF_REQUEST, &dim, request));
  PetscCall(MpmSettingsReadProgram(settings, request));
  if (Is(request, "map")) {
    PetscCall(ReadKindsOfCode(settings, request->axes));
    PetscCall(ReadAxes(settings, NULL, request->axes));
  }
  PetscCall(ReadOutputs(settings, request));
  PetscCall(ReadExpect(settings, NULL, request->task, &request->expect));
  PetscFunctionReturn(PETSC_SUCCESS);
}
