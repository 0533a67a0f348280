/* Tasks: what a user can ask the program to do. */
#pragma once
#include "analysis/neighbourhoods.h"
#include "analysis/run.h"
#include "analysis/spectrum.h"
#include "symbol/predict.h"
#include <jansson.h>

typedef struct MpmDataFile MpmDataFile; /* io/datafile.h */

/*
   Does the work of a task on its scene (NULL: a matrix takes its place) and request. missed: the number of expectations
   that are not met, or MPM_WORK_FAILED: the work has ended early, and has said why.
*/
#define MPM_WORK_FAILED -1
typedef PetscErrorCode MpmSceneWorker(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                      PetscInt *missed);

/*S
   MpmTask - one task. example is a command that anybody can run. work is what it does on a scene. A task that has no
   scene has words instead, which takes the rest of the command line: usage says what this may be.
S*/
typedef struct {
  const char     *name, *summary, *example;
  MpmSceneWorker *work;
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
   Collective. MpmPrintUsage describes the program in ten lines, and MpmPrintHelp a task: an example, and the options
   that it reads. MpmPrintHelp refuses a name that is no task's. MpmPrintVersion prints name and version: a program of
   main.c and the installed library has no other way to it.
*/
void           MpmPrintUsage(void);
void           MpmPrintVersion(void);
PetscErrorCode MpmPrintHelp(const char task[]);

/* Collective. The work of each task, in its file. */
PetscErrorCode MpmTaskList(int argc, char **argv);
MpmSceneWorker MpmTaskRun, MpmTaskSpectrum, MpmTaskSymbol, MpmTaskCritical, MpmTaskEnsemble, MpmTaskMap;

/* Collective. The same for a code that is probed in the place of a scene. */
PetscErrorCode MpmSpectrumOfProgram(const MpmRequest *request, PetscReal started, PetscInt *missed);

/*
   MpmSpectrumReport - the part of a report on a spectrum that comes after its heading. spectrum: of the bulk, or NULL.
   all: of the neighbourhoods, or NULL where there is the bulk alone.
   MpmSpectrumWriteFiles - writes eigenvalues, modes, the symbol's curves and transient growth as HDF5, and eigenvalues
   as CSV, where the request names such files.

   Collective.
*/
PetscErrorCode MpmSpectrumReport(json_t *result, const MpmScene *scene, const MpmRequest *request,
                                 const MpmSpectrum *spectrum, const MpmNeighbourhoods *all);
PetscErrorCode MpmSpectrumWriteFiles(const MpmSpectrum *spectrum);

/*
   Collective. Compare what a scene expects with what came out, print each expectation that is missed, and add to their
   number: of a run; of a verdict, and of the number that the task finds: growth, critical Courant number or share.
*/
PetscErrorCode MpmExpectRun(const MpmRun *run, PetscInt *missed);
PetscErrorCode MpmExpectFinding(const MpmExpect *expect, MpmVerdict verdict, PetscReal number, PetscInt *missed);

/*
   MpmRunFilesCreate - marches a scene, reads and writes the files that it names, and measures.

   Collective on PETSC_COMM_WORLD. The files that it starts from must have been checked. A run that a signal has stopped (run->stopped) leaves its checkpoint and no other file. started: see MpmRunCreate.
*/
PetscErrorCode MpmRunFilesCreate(const MpmScene *scene, const MpmRequest *request, PetscReal started, MpmRun **run);

/*
   MpmSymbolWrite - writes curves over all phases, in the order of their numbers: /symbol/beta (phases x dim),
   /symbol/growth, /symbol/published and /symbol/corrected, and where the amplification factors are kept,
   /symbol/factors (phases x 2 size: real and imaginary part of each amplification factor in turn).

   Collective. A number is NaN where a formula does not cover the phase. predictor NULL: there are no formulas.
*/
PetscErrorCode MpmSymbolWrite(const MpmSymbol *symbol, const MpmPredictor *predictor, MpmDataFile *file);

/*
   MpmWordsRead - gives *argc and *argv the words that were meant. The old words stay as they are.

     --option value, --option=value    -option value
     -Courant                          -courant
     version, --version, -version      version
     help, --help, -h, TASK --help     help, or help TASK
     critical musl                     critical -formulation musl, unless there is a file of that name

   Not collective. Returns 0, or 1 when memory ends. The new *argv is freed with free, after MpmFinalize.
*/
int MpmWordsRead(int *argc, char ***argv);

/*
   MpmWordsCheckViewers - returns whether no option of PETSc's, such as -log_view :FILE, names the file of another word:
   the scene, or a file that is read or written. Otherwise the first rank prints which one does.

   Not collective; call it before PetscInitialize, which empties such a file.
*/
int MpmWordsCheckViewers(int argc, char **argv);

/* Texts that are files in the source, and that the build puts into the library. */

/*S
   MpmNamedText - a text with its name. A list of them ends with a name that is NULL.
S*/
typedef struct {
  const char *name, *text;
} MpmNamedText;

extern const char MpmCodesText[]; /* codes.json, the public codes */
extern const MpmNamedText
    MpmAdapterTexts[]; /* examples/your-code/adapters, by language; and a file that one of them calls */
