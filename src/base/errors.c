/*
   Starts and ends MPI, PETSc and SLEPc, and handles errors. A refusal prints one line, and so does an error that memory
   or one of PETSc's options has caused. Any other error keeps PETSc's stack trace.
*/
#include "base/errors_private.h"
#include "base/launch.h"
#include "base/text.h"
#include "base/textfile.h"
#include <ctype.h>
#include <slepcsys.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/*
   Prints one line whatever the input holds: line ends and control sequences of a terminal, which a value may contain,
   become question marks.
*/
static void PrintLine(const char message[])
{
  fflush(stdout); /* so that report and error do not mix where both go to one place */
  fprintf(stderr, "mpmstab: ");
  for (const char *c = message; *c; c++) fputc(iscntrl((unsigned char)*c) ? '?' : *c, stderr);
  fprintf(stderr, "\n");
}

/* The prefixes of the options of PETSc and SLEPc; none of ours begins with one of them. */
static const char *const foreign[] = {"mat_",   "vec_",      "sf_",    "ksp_",   "pc_",  "eps_", "st_",
                                      "ds_",    "bv_",       "rg_",    "fn_",    "svd_", "dm_",  "is_",
                                      "nodal_", "implicit_", "swarm_", "petsc_", "mg_"};

static PetscBool IsForeign(const char word[])
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(foreign); i++)
    if (word[0] == '-' && !strncmp(word + 1, foreign[i], strlen(foreign[i]))) return PETSC_TRUE;
  return PETSC_FALSE;
}

/*
   PETSc gives all options as words. A word that begins with '-' and a letter is the name of an option; the words up to
   the next name are its value.
*/
PetscErrorCode MpmErrorsGivenOptions(MpmText *given)
{
  char     *all, *next = NULL;
  PetscBool take = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(PetscOptionsGetAll(NULL, &all));
  for (char *word = strtok_r(all, " ", &next); word; word = strtok_r(NULL, " ", &next)) {
    if (word[0] == '-' && isalpha((unsigned char)word[1])) take = IsForeign(word);
    if (take) PetscCall(MpmTextAdd(given, "%s%s", given->text ? " " : "", word));
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode explained; /* the code of an error that was told in one line although it is no refusal */
static char          *refusal;   /* the last one at its length, of which PETSc hands the beginning to a handler */

void MpmErrorsRefuse(int line, const char function[], const char file[], const char format[], ...)
{
  va_list arguments;

  free(refusal);
  va_start(arguments, format);
  refusal = MpmTextMade(format, arguments);
  va_end(arguments);
  (void)PetscError(PETSC_COMM_WORLD, line, function, file, PETSC_ERR_USER_INPUT, PETSC_ERROR_INITIAL, "%s",
                   refusal ? refusal : format);
}

/* What is said in one line of an error that is no fault of this program; NULL: it is none. why is room for that. */
static const char *Explain(PetscErrorCode code, const char function[], const char message[], MpmText *why)
{
  MpmText given = {NULL, 0};

  /* these two give a message with the name of their caller, and in some versions another code */
  if (code == PETSC_ERR_MEM || !strcmp(function, "PetscMallocAlign") || !strcmp(function, "PetscReallocAlign"))
    return "memory ends; allowed: fewer cells or particles, more ranks or more memory";
  if (code == PETSC_ERR_PLIB || code == PETSC_ERR_SIG || MpmErrorsGivenOptions(&given) || !given.text) return NULL;
  if (MpmTextAdd(why, "PETSc cannot do what its options ask: %s; given: %s; allowed: see its manual pages", message,
                 given.text))
    return NULL;
  MpmTextFree(&given);
  return why->text;
}

/*
   An error may be that of one rank or of all ranks. The first rank prints at once and ends the others; they wait for
   that, so that the line appears once.
*/
static PetscErrorCode RefusalHandler(MPI_Comm comm, int line, const char *function, const char *file,
                                     PetscErrorCode code, PetscErrorType kind, const char *message, void *context)
{
  const char *said = NULL;
  MpmText     why  = {NULL, 0};

  if (kind != PETSC_ERROR_INITIAL && (code == PETSC_ERR_USER_INPUT || code == explained)) return code;
  if (code == PETSC_ERR_USER_INPUT)
    said = refusal && !strncmp(refusal, message, strlen(message)) ? refusal : message;
  else if (kind == PETSC_ERROR_INITIAL)
    said = Explain(code, function ? function : "", message, &why);
  if (!said) return PetscTraceBackErrorHandler(comm, line, function, file, code, kind, message, context);
  if (code != PETSC_ERR_USER_INPUT) explained = code;
  if (code == explained && MpmRankOf(PETSC_COMM_WORLD)) (void)sleep(1);
  if (MpmRankOf(comm) == 0) PrintLine(said);
  MpmTextFree(&why);
  return code;
}

static PetscErrorCode OutsideHandler(MPI_Comm comm, int line, const char *function, const char *file,
                                     PetscErrorCode code, PetscErrorType kind, const char *message, void *context)
{
  char        why[1024];
  int         started = 0;
  PetscMPIInt rank    = 0;

  (void)comm, (void)line, (void)function, (void)file, (void)context;
  if (kind != PETSC_ERROR_INITIAL) return code;
  MPI_Initialized(&started);
  if (started) MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  (void)snprintf(why, sizeof why, "PETSc refuses one of its options: %s", message);
  if (rank == 0) PrintLine(why);
  return code;
}

PetscErrorCode MpmErrorsInstall(void)
{
  PetscFunctionBeginUser;
  PetscCall(PetscPushErrorHandler(RefusalHandler, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmPrintFailure(const char message[])
{
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) PrintLine(message);
}

static FILE  *held; /* what is printed goes there until it is released */
static char  *held_text;
static size_t held_length;

void MpmPrintHold(void)
{
  if (!held && !MpmRankOf(PETSC_COMM_WORLD)) held = open_memstream(&held_text, &held_length);
}

void MpmPrintRelease(void)
{
  if (!held) return;
  (void)fclose(held);
  held = NULL;
  (void)fwrite(held_text, 1, held_length, stdout);
  free(held_text);
}

void MpmPrintArguments(const char format[], va_list arguments)
{
  if (!MpmRankOf(PETSC_COMM_WORLD)) (void)vfprintf(held ? held : stdout, format, arguments);
}

void MpmPrint(const char format[], ...)
{
  va_list arguments;

  va_start(arguments, format);
  MpmPrintArguments(format, arguments);
  va_end(arguments);
}

static PetscBool ReportLost(void)
{
  struct stat is;

  if (!fflush(stdout) && !ferror(stdout)) return PETSC_FALSE;
  if (!fstat(fileno(stdout), &is) && (S_ISFIFO(is.st_mode) || S_ISSOCK(is.st_mode))) return PETSC_FALSE;
  fprintf(stderr, "mpmstab: standard output cannot be written: the report is lost\n");
  if (!freopen("/dev/null", "w", stdout)) (void)fclose(stdout); /* PETSc flushes it when it ends, and would complain */
  return PETSC_TRUE;
}

/* ---- start and end ---- */

PetscErrorCode MpmInitialize(int *argc, char ***argv)
{
  PetscErrorCode ierr;

  MpmLaunchAlone();
  if (!MpmLaunchMemory()) return PETSC_ERR_MEM;
  ierr = PetscPushErrorHandler(OutsideHandler, NULL); /* this library does nothing while PETSc starts and ends */
  if (!ierr) ierr = SlepcInitialize(argc, argv, NULL, NULL);
  return ierr ? ierr : MpmErrorsInstall();
}

int MpmFinalize(PetscErrorCode error, int status)
{
  if (error) {
    MpmUnfinishedRemove();
    MpmTextFileAbandon();
    status = error == PETSC_ERR_USER_INPUT || error == explained ? MPM_EXIT_REFUSED : MPM_EXIT_FAILED;
  }
  if (error && error != PETSC_ERR_USER_INPUT) { /* the other ranks may be waiting */
    fflush(NULL);
    if (MpmRanksOf(PETSC_COMM_WORLD) == 1) _exit(status); /* MPI_Abort would print a message of its own */
    MPI_Abort(PETSC_COMM_WORLD, status);
  }
  (void)PetscPopErrorHandler();
  if (ReportLost()) status = MPM_EXIT_FAILED;
  return SlepcFinalize() ? MPM_EXIT_REFUSED : status;
}
