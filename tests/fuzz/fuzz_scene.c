/*
   Fuzzes the functions that read a scene: YAML, options, and every check up to a finished MpmScene. No cells are
   allocated, and nothing is marched.

   The input is a scene. Its first line may be one such as '#symbol -cells 8 -drift 1/8': for YAML it is a comment, and
   here it is the command line.
*/
#include "fuzz.h"
#include "scene/settings.h"
#include "task/task.h"
#include <math.h>
#include <string.h>

#define MOST_WORDS 64

static const char scene_file[] = "input.yaml";

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
  (void)argc;
  (void)argv;
  FuzzStart("scene", scene_file);
  return 0;
}

/* Splits the first line into words, when it is such a comment. */
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

/* Takes the options, except for PETSc's own, which would act on the fuzzer itself. */
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

/* Checks what every function that gets a scene relies on. */
static void CheckScene(const MpmScene *s, const MpmRequest *r)
{
  const MpmLayout *l     = &s->layout;
  PetscInt64       taken = 1;

  FuzzNeed(l->dim >= 1 && l->dim <= MPM_MAX_DIM && s->scheme.table->dim == l->dim, "dimension");
  for (PetscInt a = 0; a < l->dim; a++) {
    const PetscInt64 places = (PetscInt64)l->grid[a].cells * l->ppc[a];

    FuzzNeed(l->grid[a].cells >= 1 && l->ppc[a] >= 1 && l->grid[a].nodes >= l->grid[a].cells &&
                 places <= PETSC_MAX_INT / 2,
             "cells");
    FuzzNeed(l->row[a] >= 1 && l->first[a] >= 0 && l->first[a] + l->row[a] <= places, "particles");
    FuzzNeed(isfinite(s->step.drift[a].value) && s->step.drift[a].den >= 0 && l->offset[a].value >= 0 &&
                 l->offset[a].value < 1,
             "places");
    FuzzNeed(s->step.drift[a].value == 0 || l->grid[a].ends[0] == MPM_PERIODIC, "drift into a wall");
    FuzzNeed(fabs(s->length[a] - s->cell_width * l->grid[a].cells) <= 1e-9 * s->length[a], "width");
    FuzzNeed(r->phases[a] >= 1, "phases");
    taken *= l->row[a];
  }
  FuzzNeed(l->particles == taken && l->sites <= PETSC_MAX_INT / 2, "particles in all");
  FuzzNeed(isnormal(s->cell_width) && isnormal(s->dt) && isnormal(s->step.courant), "a size that is no number");
  FuzzNeed(s->dt > 0 && s->step.courant > 0 && r->steps >= 1 && r->output_every >= 1, "time");
  FuzzNeed(s->layout.jitter >= 0 && s->layout.jitter <= 1 && r->tolerance > 0 && s->amplitude > 0, "a range");
  FuzzNeed(r->modes >= 0 && (s->mode[0] || s->mode[1] || s->mode[2]) && s->scheme.table->nops > 0, "a count");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  char           line[1024], *words[MOST_WORDS];
  const int      n    = Words(data, size, line, sizeof line, words);
  const char    *task = n ? TaskNamed(words[0]) : "run";
  MpmScene      *scene;
  MpmRequest     request;
  PetscErrorCode ierr;

  FuzzEnter();
  FuzzWrite(data, size);
  ierr = TakeOptions(task, n > 1 ? n - 1 : 0, words + 1);
  if (!ierr) ierr = MpmSceneCreate(task, scene_file, &scene, &request);
  if (!ierr) {
    if (scene) CheckScene(scene, &request); /* a matrix may take its place */
    ierr = MpmSceneDestroy(&scene);
  }
  FuzzReturn();
  FuzzNeed(!ierr || ierr == PETSC_ERR_USER_INPUT ? PETSC_TRUE : PETSC_FALSE, "not refused but failed");
  return 0;
}
