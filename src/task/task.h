/* Tasks: what a user can ask the program to do. */
#pragma once
#include "scene/request.h"

/*S
   MpmTask - one task. example is a command that anybody can run. run gets the words after the task's name and sets the exit status.
S*/
typedef struct {
  const char *name, *summary, *example;
  PetscErrorCode (*run)(int argc, char **argv, PetscReal started, int *status);
} MpmTask;

extern const MpmTask MpmTasks[];

/*
   Does the work of a task on its scene (NULL: a matrix takes its place) and request. missed: the number of expectations
   that are not met, or MPM_WORK_FAILED: the work has ended early, and has said why.
*/
#define MPM_WORK_FAILED -1
typedef PetscErrorCode (*MpmSceneWork)(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                       PetscInt *missed);

/*
   MpmTaskOnScene - makes a scene from the words [SCENE.yaml] [-option value]..., does the task's work on it, and sets
   the exit status.

   Collective. Refuses options that nothing has read.
*/
PetscErrorCode MpmTaskOnScene(const char task[], MpmSceneWork work, int argc, char **argv, PetscReal started,
                              int *status);

/*
   Collective. MpmPrintUsage describes the program in ten lines, and MpmPrintHelp a task: an example, and the options that
   it reads. MpmPrintHelp refuses a name that is no task's. MpmPrintVersion prints name and version. MpmTaskNames gives
   the names of all tasks as a text for people.
*/
PetscErrorCode MpmPrintUsage(void);
PetscErrorCode MpmPrintVersion(void);
PetscErrorCode MpmPrintHelp(const char task[]);
PetscErrorCode MpmTaskNames(size_t room, char text[]);

PetscErrorCode MpmTaskRun(int argc, char **argv, PetscReal started, int *status);
PetscErrorCode MpmTaskSpectrum(int argc, char **argv, PetscReal started, int *status);
PetscErrorCode MpmTaskSymbol(int argc, char **argv, PetscReal started, int *status);
PetscErrorCode MpmTaskCritical(int argc, char **argv, PetscReal started, int *status);
PetscErrorCode MpmTaskEnsemble(int argc, char **argv, PetscReal started, int *status);
PetscErrorCode MpmTaskMap(int argc, char **argv, PetscReal started, int *status);
PetscErrorCode MpmTaskList(int argc, char **argv, PetscReal started, int *status);
