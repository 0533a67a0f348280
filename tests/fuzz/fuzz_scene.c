/*
   Fuzzes what reads a scene: YAML, options, and every check up to a finished MpmScene. Nothing is allocated for its
   cells or marched.

   The input is a scene. A first line such as '#symbol -cells 8 -drift 1/8' is a comment to YAML and the command line here.
*/
#include <mpmstab/task.h>
#include <fcntl.h>
#include <math.h>
#include <slepcsys.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* LeakSanitizer's, where it is linked */
__attribute__((weak)) void __lsan_disable(void);
__attribute__((weak)) void __lsan_enable(void);

#define MOST_WORDS 64

static char folder[PETSC_MAX_PATH_LEN], scene_file[] = "input.yaml";
static int  home; /* where the program was started: names of inputs may be relative */

/* Whatever fails but by a refusal is a finding, and so is a refusal that is not one line of text. */
static PetscErrorCode Judge(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                            PetscErrorType kind, const char *message, void *context)
{
  if (code != PETSC_ERR_USER_INPUT) {
    (void)PetscTraceBackErrorHandler(comm, line, function, file, code, kind, message, context);
    abort();
  }
  if (kind == PETSC_ERROR_INITIAL && (!message || !strlen(message) || strlen(message) > 1000)) abort();
  return code;
}

/* Ends the program when something else than what the fuzzer does to its input fails. */
static void Need(PetscBool condition, const char what[])
{
  if (condition) return;
  fprintf(stderr, "%s\n", what);
  abort();
}

static void Leave(void)
{
  if (chdir(folder)) return;
  (void)unlink(scene_file);
  (void)rmdir(folder);
}

/* In a folder of its own: a scene names files, which are tried. MPI leaks where it starts and where it ends. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
  static char  name[] = "fuzz_scene", quiet[] = "-no_signal_handler"; /* crashes are for libFuzzer and sanitizers */
  static char *words[] = {name, quiet, NULL}, **mine = words;
  const char  *parent = getenv("TMPDIR");
  int          n      = 2;

  (void)argc;
  (void)argv;
  if (__lsan_disable) __lsan_disable();
  Need(SlepcInitialize(&n, &mine, NULL, NULL) ? PETSC_FALSE : PETSC_TRUE, "SLEPc does not start");
  if (__lsan_enable) __lsan_enable();
  Need(PetscPushErrorHandler(Judge, NULL) ? PETSC_FALSE : PETSC_TRUE, "no error handler");
  (void)snprintf(folder, sizeof folder, "%s/fuzz_scene.XXXXXX", parent ? parent : "/tmp");
  home = open(".", O_RDONLY);
  Need(home >= 0 && mkdtemp(folder) ? PETSC_TRUE : PETSC_FALSE, "no folder to work in");
  return atexit(Leave);
}

static void WriteScene(const uint8_t *data, size_t size)
{
  FILE *file = fopen(scene_file, "wb");

  Need(file && fwrite(data, 1, size, file) == size && !fclose(file) ? PETSC_TRUE : PETSC_FALSE, "no file to write to");
}

/* The words of the first line, when that is a comment. */
static int Words(const uint8_t *data, size_t size, char line[], size_t room, char *words[])
{
  int    n = 0;
  size_t length;

  if (!size || data[0] != '#') return 0;
  for (length = 0; length + 1 < PetscMin(room, size) && data[length + 1] != '\n'; length++)
    line[length] = (char)data[length + 1];
  line[length] = '\0';
  for (char *word = strtok(line, " "); word && n < MOST_WORDS; word = strtok(NULL, " ")) words[n++] = word;
  return n;
}

static const char *TaskNamed(const char word[])
{
  for (const MpmTask *task = MpmTasks; task->name; task++)
    if (!strcmp(word, task->name)) return task->name;
  return "run";
}

/* PETSc's own options would act on the fuzzer itself. */
static PetscErrorCode TakeOptions(const char task[], int n, char **words)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(MpmSettingsCheckCommandLine(task, n, words, 0));
  for (int i = 0; i < n; i++) {
    const PetscBool value =
        i + 1 < n && (words[i + 1][0] != '-' || strchr("0123456789.", words[i + 1][1])) ? PETSC_TRUE : PETSC_FALSE;

    if (MpmOptionIndex(words[i] + 1) != MPM_NOT_AN_OPTION)
      PetscCall(PetscOptionsSetValue(NULL, words[i], value ? words[i + 1] : NULL));
    if (value) i++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What every reader of a scene relies on. */
static void CheckScene(const MpmScene *s)
{
  const PetscInt64 places = (PetscInt64)s->cells * s->ppc;

  Need(s->cells >= 1 && s->ppc >= 1 && s->nodes >= s->cells && places <= PETSC_MAX_INT / 2, "cells");
  Need(s->particles >= 1 && s->first >= 0 && s->first + s->particles <= places, "particles");
  Need(isnormal(s->cell_width) && isnormal(s->dt) && isnormal(s->courant), "a size that is no number");
  Need(s->dt > 0 && s->courant > 0 && s->steps >= 1 && s->output_every >= 1, "time");
  Need(isfinite(s->drift.value) && s->drift.den >= 0 && s->offset.value >= 0 && s->offset.value < 1, "places");
  Need(s->jitter >= 0 && s->jitter <= 1 && s->tolerance > 0 && s->amplitude > 0, "a range");
  Need(s->phases >= 1 && s->modes >= 0 && s->mode >= 1 && s->table->nops > 0, "a count");
  Need(!MpmSceneDrifts(s) || MpmSceneIsPeriodic(s), "drift into a wall");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  char           line[1024], *words[MOST_WORDS];
  const int      n    = Words(data, size, line, sizeof line, words);
  const char    *task = n ? TaskNamed(words[0]) : "run";
  MpmScene      *scene;
  PetscErrorCode ierr;

  Need(chdir(folder) ? PETSC_FALSE : PETSC_TRUE, "no folder");
  WriteScene(data, size);
  ierr = TakeOptions(task, n > 1 ? n - 1 : 0, words + 1);
  if (!ierr) ierr = MpmSceneCreate(task, scene_file, &scene);
  if (!ierr) {
    CheckScene(scene);
    ierr = MpmSceneDestroy(&scene);
  }
  Need(fchdir(home) ? PETSC_FALSE : PETSC_TRUE, "no way back");
  Need(!ierr || ierr == PETSC_ERR_USER_INPUT ? PETSC_TRUE : PETSC_FALSE, "not refused but failed");
  return 0;
}
