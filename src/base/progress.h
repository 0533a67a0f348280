/* Progress: one line with the time left, on a terminal, for work that takes long. */
#pragma once
#include <mpmstab/compat.h>
#include <mpmstab/progress.h>

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
