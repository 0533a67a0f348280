/* The program around the fuzz targets. */
#include "fuzz.h"
#include <fcntl.h>
#include <slepcsys.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* a function of LeakSanitizer, where that is linked */
__attribute__((weak)) void __lsan_disable(void);
__attribute__((weak)) void __lsan_enable(void);

static char        folder[PETSC_MAX_PATH_LEN];
static const char *input;
static int         home;

void FuzzNeed(PetscBool condition, const char what[])
{
  if (condition) return;
  fprintf(stderr, "%s\n", what);
  abort();
}

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

static void Leave(void)
{
  if (chdir(folder)) return;
  (void)unlink(input);
  (void)rmdir(folder);
}

/*
   The target gets a folder of its own, since an input may name files, which are tried. Leaks of MPI at its start and
   end are ignored.
*/
void FuzzStart(const char name[], const char file[])
{
  static char  program[] = "fuzz", quiet[] = "-no_signal_handler"; /* crashes are for libFuzzer and the sanitizers */
  static char *words[] = {program, quiet, NULL}, **mine = words;
  const char  *parent = getenv("TMPDIR");
  int          n      = 2;

  input = file;
  if (__lsan_disable) __lsan_disable();
  FuzzNeed(SlepcInitialize(&n, &mine, NULL, NULL) ? PETSC_FALSE : PETSC_TRUE, "SLEPc does not start");
  if (__lsan_enable) __lsan_enable();
  FuzzNeed(PetscPushErrorHandler(Judge, NULL) ? PETSC_FALSE : PETSC_TRUE, "no error handler");
  (void)snprintf(folder, sizeof folder, "%s/fuzz_%s.XXXXXX", parent ? parent : P_tmpdir, name);
  home = open(".", O_RDONLY);
  FuzzNeed(home >= 0 && mkdtemp(folder) ? PETSC_TRUE : PETSC_FALSE, "no folder to work in");
  FuzzNeed(atexit(Leave) ? PETSC_FALSE : PETSC_TRUE, "the folder would stay");
}

void FuzzEnter(void)
{
  FuzzNeed(chdir(folder) ? PETSC_FALSE : PETSC_TRUE, "no folder");
}

void FuzzReturn(void)
{
  FuzzNeed(fchdir(home) ? PETSC_FALSE : PETSC_TRUE, "no way back");
}

void FuzzWrite(const uint8_t *data, size_t size)
{
  FILE *file = fopen(input, "wb");

  FuzzNeed(file && fwrite(data, 1, size, file) == size && !fclose(file) ? PETSC_TRUE : PETSC_FALSE,
           "no file to write to");
}
