/* Tasks: what a user can ask the program to do. */
#pragma once
#include "scene/request.h"

/*
   Does the work of a task on its scene (NULL: a matrix takes its place) and request. missed: the number of expectations
   that are not met, or MPM_WORK_FAILED: the work has ended early, and has said why.
*/
#define MPM_WORK_FAILED -1
typedef PetscErrorCode (*MpmSceneWork)(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                       PetscInt *missed);

/*S
   MpmTask - one task. example is a command that anybody can run. work is what it does on a scene. A task that has no scene
   has words instead, which takes the rest of the command line: usage says what this may be.
S*/
typedef struct {
  const char  *name, *summary, *example;
  MpmSceneWork work;
  PetscErrorCode (*words)(int argc, char **argv);
  const char *usage;
} MpmTask;

extern const MpmTask MpmTasks[];

/*
   MpmTaskOnScene - makes a scene from the words [SCENE.yaml] [-option value]..., does the task's work on it, and sets
   the exit status.

   Collective. Refuses options that nothing has read.
*/
PetscErrorCode MpmTaskOnScene(const MpmTask *task, int argc, char **argv, PetscReal started, int *status);

/*
   Collective. MpmPrintUsage describes the program in ten lines, and MpmPrintHelp a task: an example, and the options that
   it reads. MpmPrintHelp refuses a name that is no task's. MpmPrintVersion prints name and version. MpmTaskNames gives
   the names of all tasks as a text for people.
*/
void           MpmPrintUsage(void);
void           MpmPrintVersion(void);
PetscErrorCode MpmPrintHelp(const char task[]);
void           MpmTaskNames(size_t room, char text[]);

/* Collective. The work of each task, in its file. */
PetscErrorCode MpmTaskList(int argc, char **argv);
PetscErrorCode MpmTaskAdapter(int argc, char **argv);
PetscErrorCode MpmTaskRun(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed);
PetscErrorCode MpmTaskSpectrum(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed);
PetscErrorCode MpmTaskSymbol(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed);
PetscErrorCode MpmTaskCritical(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed);
PetscErrorCode MpmTaskEnsemble(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed);
PetscErrorCode MpmTaskMap(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed);

/* Collective. The same for a code that is probed, and for the blocks of a lattice, in the place of a scene. */
PetscErrorCode MpmSpectrumOfProgram(const MpmRequest *request, PetscReal started, PetscInt *missed);
PetscErrorCode MpmSymbolOfBlocks(const MpmRequest *request, PetscReal started, PetscInt *missed);

/*
   What is installed beside the program, made from its list of options: a JSON schema of scene files, for editors;
   completions for bash or zsh; the man page, in the language of man(7).

   Collective: the first rank prints.
*/
PetscErrorCode MpmPrintSchema(void);
void           MpmPrintCompletion(PetscBool zsh);
void           MpmPrintManual(void);
