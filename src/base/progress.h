/* Progress: one line with the time left, on a terminal, for work that takes long. */
#pragma once
#include <mpmstab/compat.h>

/* Who sees the line: a terminal, if the work takes longer than 2 s; or whoever asks for it, or does not want it. */
typedef enum { MPM_PROGRESS_ON_TERMINAL, MPM_PROGRESS_ALWAYS, MPM_PROGRESS_NEVER } MpmProgressWish;

typedef struct {
  const char *unit; /* what is counted: steps, phases */
  PetscBool   enabled, shown;
  PetscReal   started, last;
} MpmProgress;

/* Not collective. Only the first rank prints. */
PetscErrorCode MpmProgressBegin(MpmProgressWish wish, const char unit[], MpmProgress *progress);
PetscErrorCode MpmProgressUpdate(MpmProgress *progress, PetscInt64 done, PetscInt64 total);
PetscErrorCode MpmProgressEnd(MpmProgress *progress);

/* Not collective. Says what a long stage without steps is doing; MpmProgressEnd takes it away. */
PetscErrorCode MpmProgressNote(MpmProgress *progress, const char text[]);
