/* Progress: one line with the time left, on a terminal, for work that takes long. */
#pragma once
#include <mpmstab/compat.h>

/*
   Who sees the line: a terminal, if the work takes longer than 2 s; or whoever asks for it, or nobody. The program's
   tasks say so once, with MpmProgressShow; until then nobody does.
*/
typedef enum { MPM_PROGRESS_ON_TERMINAL, MPM_PROGRESS_ALWAYS, MPM_PROGRESS_NEVER } MpmProgressWish;

typedef struct {
  const char *unit; /* what is counted: steps, phases */
  PetscBool   enabled, shown, owns;
  PetscReal   started, last;
} MpmProgress;

/* Not collective. Sets who sees the lines of all work that begins after. */
void MpmProgressShow(MpmProgressWish wish);

/*
   Not collective. Only the first rank prints. There is one line: work that begins while other work has the line, as a
   part of it, shows nothing.
*/
PetscErrorCode MpmProgressBegin(const char unit[], MpmProgress *progress);
PetscErrorCode MpmProgressUpdate(MpmProgress *progress, PetscInt64 done, PetscInt64 total);
PetscErrorCode MpmProgressEnd(MpmProgress *progress);

/* Not collective. Says what a long stage without steps is doing; MpmProgressEnd takes it away. */
PetscErrorCode MpmProgressNote(MpmProgress *progress, const char text[]);
