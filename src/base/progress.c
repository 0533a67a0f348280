/* A progress line on standard error. */
#include "base/progress.h"
#include <mpmstab/errors.h>
#include <unistd.h>

#define SILENT_S 2.0 /* shorter work shows nothing, unless -progress true asks for it */
#define BETWEEN_S 0.5
#define BETWEEN_LINES_S 60.0 /* in a log */
#define LONG_S 10.0          /* longer work says which option makes it shorter */

static MpmProgressWish wish = MPM_PROGRESS_NEVER;
static PetscBool       taken; /* whether some work is showing its line */

/* The options that make the work of a unit shorter. */
static const struct {
  const char *unit, *option;
} shorter[] = {{"layout", "-layouts"},
               {"start", "-neighbourhood bulk,lone"},
               {"place", "-neighbourhood bulk,lone"},
               {"part", "-map_points"},
               {"points", "-map_points"},
               {"phase", "-phases"},
               {"step", "-steps or -time"},
               {"steps of powers", "-powers"}};

static const char *ShorterBy(const char unit[])
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(shorter); i++)
    if (!strcmp(unit, shorter[i].unit)) return shorter[i].option;
  return NULL;
}

void MpmProgressShow(MpmProgressWish who)
{
  wish  = who;
  taken = PETSC_FALSE; /* refused work ends without MpmProgressEnd and still has the line */
}

PetscErrorCode MpmProgressBegin(const char unit[], MpmProgress *progress)
{
  PetscFunctionBegin;
  progress->unit    = unit;
  progress->owns    = taken ? PETSC_FALSE : PETSC_TRUE;
  progress->enabled = !MpmRankOf(PETSC_COMM_WORLD) && !taken && wish != MPM_PROGRESS_NEVER ? PETSC_TRUE : PETSC_FALSE;
  progress->lines   = wish == MPM_PROGRESS_ON_TERMINAL && !isatty(STDERR_FILENO) ? PETSC_TRUE : PETSC_FALSE;
  progress->between = progress->lines ? BETWEEN_LINES_S : BETWEEN_S;
  progress->shown   = PETSC_FALSE;
  progress->started = MPI_Wtime();
  progress->last    = progress->started;
  if (!progress->lines) progress->last += (wish == MPM_PROGRESS_ALWAYS ? 0 : SILENT_S) - BETWEEN_S;
  taken = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgressUpdate(MpmProgress *progress, PetscInt64 done, PetscInt64 total)
{
  const PetscReal now    = progress->enabled ? MPI_Wtime() : 0;
  const char     *option = NULL;

  PetscFunctionBegin;
  if (!progress->enabled || done < 1 || total < done || now < progress->last + progress->between)
    PetscFunctionReturn(PETSC_SUCCESS);
  if ((now - progress->started) * (double)total / (double)done > LONG_S) option = ShorterBy(progress->unit);
  fprintf(stderr, "%s%s %" PetscInt64_FMT " of %" PetscInt64_FMT ", %.0f%%, %.0f s left%s%s%s%s",
          progress->lines ? "" : "\r", progress->unit, done, total, 100.0 * (double)done / (double)total,
          (now - progress->started) * (double)(total - done) / (double)done, option ? " (less by " : "",
          option ? option : "", option ? ")" : "", progress->lines ? "\n" : "   ");
  fflush(stderr);
  progress->last  = now;
  progress->shown = progress->lines ? PETSC_FALSE : PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgressEnd(MpmProgress *progress)
{
  PetscFunctionBegin;
  if (progress->shown) fprintf(stderr, "\r%79s\r", "");
  if (progress->owns) taken = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgressNote(MpmProgress *progress, const char text[])
{
  PetscFunctionBegin;
  if (!progress->enabled || progress->lines) PetscFunctionReturn(PETSC_SUCCESS);
  fprintf(stderr, "\r%-79s", text);
  fflush(stderr);
  progress->shown = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
