/* From the words of the command line to those that were meant. */
#include "base/textfile.h"
#include "task/words.h"
#include "base/launch.h"
#include "scene/fields.h"
#include "task/task.h"
#include <ctype.h>
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

static int AsksForHelp(const char word[])
{
  static const char *const asks[] = {"-h", "-help", "--help", NULL};

  return IsAmong(word, asks);
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
  for (int w = 1; w < argc; w++) {
    if (!AsksForHelp(argv[w])) continue;
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

/* The file that the value of a viewer's option names, as in ascii:FILE:format; "": none. */
static void FileOf(const char option[], const char value[], char file[PETSC_MAX_PATH_LEN])
{
  const char *colon = strchr(value, ':');
  const char *name  = !strcmp(option, "-history") ? value : colon ? colon + 1 : "";

  (void)snprintf(file, PETSC_MAX_PATH_LEN, "%.*s", (int)strcspn(name, ":"), name);
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
    if (!IsOption(argv[i]) || MpmOptionIndex(argv[i] + 1) != MPM_NOT_AN_OPTION) continue;
    FileOf(argv[i], argv[i + 1], file);
    for (int k = 2; k < argc; k++) {
      if (!NamesFile(argv, k) || !MpmFileIsSame(argv[k], file)) continue;
      MpmLaunchRefuse(argv[i],
                      "PETSc would write over a file that this command names otherwise; allowed: another file");
      return 0;
    }
  }
  return 1;
}
