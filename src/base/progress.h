/* Progress: one line with the time left, on a terminal, for work that takes long, and after 10 s the option that makes it
   shorter. A log gets a line a minute. */
#pragma once
#include <mpmstab/compat.h>

/*
   Who sees the line. MPM_PROGRESS_ON_TERMINAL: a terminal, if the work takes longer than 2 s; where standard error is
   something else, such as the log of a job, it gets a line of its own each minute. MPM_PROGRESS_ALWAYS:
   whoever reads standard error. MPM_PROGRESS_NEVER: nobody; this holds until MpmProgressShow is called.
*/
typedef enum { MPM_PROGRESS_ON_TERMINAL, MPM_PROGRESS_ALWAYS, MPM_PROGRESS_NEVER } MpmProgressWish;

typedef struct {
  const char *unit; /* what is counted, such as steps or phases */
  PetscBool   enabled, shown, owns, lines;
  PetscReal   started, last, between;
} MpmProgress;

/* Not collective. Sets who sees the lines of all work that begins afterwards. */
void MpmProgressShow(MpmProgressWish wish);

/*
   MpmProgressBegin, MpmProgressUpdate, MpmProgressEnd - show how much of some work is done.

   Not collective. Only the first rank prints. There is one line: work that begins as a part of other work, which has
   the line, shows nothing.
*/
PetscErrorCode MpmProgressBegin(const char unit[], MpmProgress *progress);
PetscErrorCode MpmProgressUpdate(MpmProgress *progress, PetscInt64 done, PetscInt64 total);
PetscErrorCode MpmProgressEnd(MpmProgress *progress);

/* Not collective. Shows what a long stage without steps is doing, until MpmProgressEnd. */
PetscErrorCode MpmProgressNote(MpmProgress *progress, const char text[]);
