/* Words of the command line, the list of tasks, what all tasks on a scene share, usage, and expectations. */
#include "base/launch.h"
#include "base/memory.h"
#include "base/stop.h"
#include "base/suggest.h"
#include "base/text.h"
#include "base/textfile.h"
#include "io/checkpoint.h"
#include "io/mode_file.h"
#include "scene/fields.h"
#include "scene/settings.h"
#include "task/task.h"
#include <mpmstab/errors.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

static char help[] = "help", version[] = "version", formulation_option[] = "-formulation";

typedef struct {
  int    n;
  char **word;
} Words;

static void Add(Words *words, char word[])
{
  words->word[words->n++] = word;
  words->word[words->n]   = NULL;
}

static int IsOption(const char word[])
{
  return word[0] == '-' && (word[1] == '-' || isalpha((unsigned char)word[1]));
}

static int IsAmong(const char word[], const char *const among[])
{
  for (; *among; among++)
    if (!strcasecmp(word, *among)) return 1;
  return 0;
}

/* A task in any case of letters. */
static const MpmTask *TaskOf(const char word[])
{
  for (const MpmTask *task = MpmTasks; task->name; task++)
    if (!strcasecmp(task->name, word)) return task;
  return NULL;
}

static const MpmFormulation *FormulationOf(const char word[])
{
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    if (!strcasecmp(MpmFormulations[f]->name, word) && access(word, F_OK)) return MpmFormulations[f];
  return NULL;
}

/* An option of ours gets the name of the list; others, such as PETSc's, stay as they are but for their second dash. */
static void AddOption(Words *words, char word[])
{
  char *const  name   = word[1] == '-' && isalpha((unsigned char)word[2]) ? word + 2 : word + 1;
  const size_t length = strcspn(name, "=");

  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    if (strncasecmp(MpmOptions[i].name, name, length) || MpmOptions[i].name[length]) continue;
    memcpy(name, MpmOptions[i].name, length);
    break;
  }
  if (name == word + 2 && name[length] == '=') {
    name[length] = 0;
    Add(words, name - 1);
    Add(words, name + length + 1);
  } else
    Add(words, name - 1);
}

/* help, or help TASK, wherever the user asks for it. */
static int TakesHelp(int argc, char **argv, Words *words)
{
  static const char *const asks[] = {"-h", "-help", "--help", NULL};

  for (int w = 1; w < argc; w++) {
    if (!IsAmong(argv[w], asks)) continue;
    Add(words, help);
    if (w > 1 && TaskOf(argv[1])) Add(words, argv[1]);
    return 1;
  }
  return 0;
}

int MpmWordsRead(int *argc, char ***argv)
{
  static const char *const versions[] = {"version", "-version", "--version", NULL};

  char *const *const given = *argv;
  const int          n     = *argc;
  Words              words = {.word = calloc((size_t)(2 * n + 2), sizeof *words.word)};

  if (!words.word) return 1;
  Add(&words, given[0]);
  if (!TakesHelp(n, *argv, &words) && n > 1) {
    const MpmTask *task = TaskOf(given[1]);

    Add(&words, IsAmong(given[1], versions) ? version : given[1]);
    if (task) memcpy(given[1], task->name, strlen(task->name));
    if (n > 2 && task && !task->words && FormulationOf(given[2])) Add(&words, formulation_option);
    for (int i = 2; i < n; i++)
      if (IsOption(given[i]))
        AddOption(&words, given[i]);
      else
        Add(&words, given[i]);
  }
  *argc = words.n;
  *argv = words.word;
  return 0;
}

/* The word that names a file of ours: the scene, and the values of options that name files. */
static int NamesFile(char **argv, int i)
{
  const PetscInt option = i > 2 && IsOption(argv[i - 1]) ? MpmOptionIndex(argv[i - 1] + 1) : MPM_NOT_AN_OPTION;

  if (i == 2) return !IsOption(argv[i]);
  return option != MPM_NOT_AN_OPTION && MpmOptions[option].file != MPM_FILE_NONE;
}

int MpmWordsCheckViewers(int argc, char **argv)
{
  char file[PETSC_MAX_PATH_LEN];

  for (int i = 2; i + 1 < argc; i++) {
    const char *colon = strchr(argv[i + 1], ':'); /* as in ascii:FILE:format */
    const char *name  = !strcmp(argv[i], "-history") ? argv[i + 1] : colon ? colon + 1 : "";

    if (!IsOption(argv[i]) || MpmOptionIndex(argv[i] + 1) != MPM_NOT_AN_OPTION) continue;
    (void)snprintf(file, sizeof file, "%.*s", (int)strcspn(name, ":"), name);
    for (int k = 2; k < argc; k++) {
      if (!NamesFile(argv, k) || !MpmFileIsSame(argv[k], file)) continue;
      MpmLaunchRefuse(argv[i],
                      "PETSc would write over a file that this command names otherwise; allowed: another file");
      return 0;
    }
  }
  return 1;
}

/* ---- tasks ---- */

/* Prints an adapter for the user's code, with five places to fill in. */
static PetscErrorCode Adapter(int argc, char **argv)
{
  const char *names[16];
  PetscInt    n = 0;

  PetscFunctionBegin;
  for (; MpmAdapterTexts[n].name; n++) {
    names[n] = MpmAdapterTexts[n].name;
    if (argc != 1 || strcmp(argv[0], names[n])) continue;
    MpmPrint("%s", MpmAdapterTexts[n].text);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmSuggestRefuse(argc == 1 ? argv[0] : NULL, n, names,
                             "adapter%s%.200s: allowed: one word: ", argc ? " " : "", argc ? argv[argc > 1] : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmTask MpmTasks[] = {
    {"run", "march a scene: error against the exact solution, measured growth, energy, throughput",
     "run -formulation usl -cells 64 -courant 1/2 -time 1", MpmTaskRun, NULL, NULL},
    {"spectrum", "eigenvalues of the assembled operator beside symbol, closed forms and measured growth",
     "spectrum -formulation gas2 -drift 1/8 -cells 16 -courant 0.1", MpmTaskSpectrum, NULL, NULL},
    {"symbol", "abs(G) over the phase beta, exact for uniform layouts",
     "symbol -formulation musl -drift 1/8 -courant 0.3", MpmTaskSymbol, NULL, NULL},
    {"critical", "the largest stable Courant number, and the wave or mode that limits it",
     "critical -formulation musl -basis quadratic", MpmTaskCritical, NULL, NULL},
    {"map", "growth over two of Courant number, drift, offset and particles per cell",
     "map -formulation musl -map_points 40,20", MpmTaskMap, NULL, NULL},
    {"ensemble", "the share of random layouts that are unstable, with its 95% confidence interval",
     "ensemble -formulation musl -jitter 0.5 -cells 16 -layouts 20", MpmTaskEnsemble, NULL, NULL},
    {"list", "formulations, bases, transfers, boundaries, layouts, options; 'list codes': public codes",
     "list formulation musl", NULL, MpmTaskList,
     "[formulation [NAME]|basis|transfer [NAME [NUMBER]]|boundary|layout|options|versions|scope|codes]"},
    {"adapter", "an adapter for your own code, with five places to fill in", "adapter python", NULL, Adapter,
     "python|octave|matlab|c|fortran|julia|javascript"},
    {NULL, NULL, NULL, NULL, NULL, NULL},
};

PetscErrorCode MpmTaskOnScene(const MpmTask *task, int argc, char **argv, PetscReal started, int *status)
{
  const char *path   = argc > 0 && argv[0][0] != '-' ? argv[0] : NULL;
  PetscInt    missed = 0;
  MpmScene   *scene;
  MpmRequest  request;

  PetscFunctionBegin;
  PetscCall(MpmSettingsCheckCommandLine(task->name, argc, argv, path ? 1 : 0));
  PetscCall(MpmSettingsCheckOutside(task->name, path));
  PetscCall(MpmMemoryCheckLapack());
  PetscCall(MpmSceneCreate(task->name, path, &scene, &request));
  if (scene && scene->initial == MPM_INITIAL_EIGENMODE && request.mode_file[0])
    PetscCall(MpmModeFileCheck(scene, request.mode_file));
  if (scene && request.restart[0]) PetscCall(MpmCheckpointCheck(request.restart, scene, request.steps));
  MpmProgressShow(request.progress);
  PetscCall(task->work(scene, &request, started, &missed));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(MpmSettingsCheckUnused());
  *status = missed == MPM_WORK_FAILED ? MPM_EXIT_FAILED
            : MpmStopped()            ? MPM_EXIT_STOPPED
            : missed                  ? MPM_EXIT_MISSED
                                      : MPM_EXIT_DONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmPrintVersion(void)
{
  MpmPrint("mpmstab %s\n", MPMSTAB_VERSION);
}

void MpmPrintUsage(void)
{
  MpmPrint(
      "mpmstab %s: is this material point scheme stable, for which time step, and how accurate?\n"
      "  [mpirun -n R] mpmstab TASK [SCENE.yaml] [-option value]...  as in: mpmstab spectrum -drift 1/8 -courant 0.1\n",
      MPMSTAB_VERSION);
  for (const MpmTask *task = MpmTasks; task->name; task++) MpmPrint("  %-9s%s\n", task->name, task->summary);
}

/* An option of a list of this task's own, or of those that all tasks read. */
static void PrintOptions(const char task[], PetscBool own)
{
  for (const MpmField *o = MpmOptions; o->name; o++)
    if (own ? o->tasks && MpmFieldIsOf(o, task) : !o->tasks)
      MpmPrint("  -%-17s %-11s %s\n", o->name, o->fallback ? o->fallback : "", o->help);
}

PetscErrorCode MpmPrintHelp(const char name[])
{
  const char    *names[16];
  const MpmTask *task = TaskOf(name);
  PetscInt       n    = 0;

  PetscFunctionBegin;
  for (; MpmTasks[n].name; n++) names[n] = MpmTasks[n].name;
  if (!task) PetscCall(MpmSuggestRefuse(name, n, names, "help %.200s: allowed: ", name));
  MpmPrint("mpmstab %s: %s\n  for example: mpmstab %s\n", task->name, task->summary, task->example);
  if (task->words) {
    MpmPrint("  mpmstab %s %s\n", task->name, task->usage);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  MpmPrint("options of this task: name, default, meaning\n");
  PrintOptions(task->name, PETSC_TRUE);
  MpmPrint("options that all tasks read: the scene and its files; also keys of a scene file\n");
  PrintOptions(task->name, PETSC_FALSE);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A scene with an expect block is a test: each expectation that is missed is printed, and the program ends with status
   3.
*/

static PetscErrorCode Miss(const char what[], const char found[], const char expected[], PetscInt *missed)
{
  PetscFunctionBegin;
  fflush(stdout);
  PetscCall(PetscFPrintf(PETSC_COMM_WORLD, stderr, "mpmstab: expected %s %s, found %s\n", what, expected, found));
  (*missed)++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ExpectNumber(const MpmExpect *expect, MpmExpected which, PetscReal value, PetscInt *missed)
{
  static const char *const what[MPM_EXPECTED] = {"growth",
                                                 "growth of the spectrum",
                                                 "largest l2 error",
                                                 "final / initial energy",
                                                 "critical Courant number",
                                                 "share of unstable layouts"};
  const PetscReal         *range              = expect->range[which];
  char                     expected[80], found[40];

  PetscFunctionBegin;
  if (!expect->has[which] || (value >= range[0] && value <= range[1])) PetscFunctionReturn(PETSC_SUCCESS);
  (void)snprintf(expected, sizeof expected, "in [%.10g, %.10g]", range[0], range[1]);
  (void)snprintf(found, sizeof found, isnan(value) ? "no value" : "%.10g", value);
  PetscCall(Miss(what[which], found, expected, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmExpectFinding(const MpmExpect *expect, MpmVerdict verdict, PetscReal number, PetscInt *missed)
{
  static const MpmExpected which[] = {MPM_EXPECT_SPECTRUM, MPM_EXPECT_CRITICAL, MPM_EXPECT_SHARE};

  PetscFunctionBegin;
  if (expect->has_verdict && expect->verdict != verdict)
    PetscCall(Miss("verdict", MpmVerdictNames[verdict], MpmVerdictNames[expect->verdict], missed));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(which); i++)
    PetscCall(ExpectNumber(expect, which[i], number, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmExpectRun(const MpmRun *run, PetscInt *missed)
{
  const MpmExpect *expect = &run->request->expect;
  const MpmGrowth *growth = &run->growth;
  PetscReal        worst  = 0;
  const char      *name[MPM_MOST_ERRORS];

  PetscFunctionBegin;
  PetscCall(MpmExpectFinding(expect, run->verdict, NAN, missed));
  if (expect->has_kind && (!growth->measured || growth->kind != expect->kind))
    PetscCall(Miss("growth of kind", growth->measured ? MpmGrowthKindNames[growth->kind] : "none measured",
                   MpmGrowthKindNames[expect->kind], missed));
  PetscCall(ExpectNumber(expect, MPM_EXPECT_GROWTH, growth->measured ? growth->per_step : NAN, missed));
  PetscCall(ExpectNumber(expect, MPM_EXPECT_ENERGY, run->energy_ratio, missed));
  for (PetscInt f = 0; run->has_errors && f < MpmSceneErrorFields(run->scene, name); f++)
    if (!(run->error[f].l2 <= worst)) worst = run->error[f].l2; /* NaN is the worst */
  PetscCall(ExpectNumber(expect, MPM_EXPECT_ERROR, worst, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}
