/*
   Child: another program that this process runs and talks to through pipes, its standard input and output. A talk is
   one message to the child and one answer from it.

   A child fails in its own way on each rank, so these functions return no PetscError for what the child does. They note
   the first failure in the child's failure, and do nothing after it; the caller tells all ranks.
*/
#pragma once
#include <mpmstab/compat.h>

#define MPM_FAILURE_TEXT 1024

/*S
   MpmChild - a child and what it last said.

   failure - what has gone wrong, as a sentence without a subject, such as 'it has ended with status 1'; empty: nothing
   errors  - the end of what it has written to standard error
S*/
typedef struct MpmChild_ MpmChild;

/*
   MpmChildStart        - starts a command that is given as words, the last of which is NULL.
   MpmChildStartCommand - starts one that is given as text. It is split at blanks. Quotation marks and backslashes keep
   blanks in a word, as a shell would; there is no shell.

   Not collective. The child and all that it has started end when this process ends, in whatever way, and take no
   terminal signals.

   Input Parameter: timeout - in seconds, of each talk.

   Errors: PETSC_ERR_USER_INPUT when the text has an open quotation mark or no word.
*/
PetscErrorCode MpmChildStart(char *const words[], PetscReal timeout, MpmChild **child);
PetscErrorCode MpmChildStartCommand(const char command[], PetscReal timeout, MpmChild **child);

/*
   MpmChildTalk - sends a line and bytes, and reads a line.

   Not collective. Input Parameters: line - without the end of line; bytes, size - what follows the line, or NULL and 0.
   Output Parameter: answer - the line of the answer, valid until the next talk; NULL after a failure.
*/
PetscErrorCode MpmChildTalk(MpmChild *child, const char line[], const void *bytes, size_t size, const char **answer);

/* Not collective. Reads bytes that follow the line of the answer; zeros after a failure. */
PetscErrorCode MpmChildTake(MpmChild *child, size_t size, void *bytes);

/* Not collective. The failure, or an empty text; and the last lines that the child has written to standard error. */
const char *MpmChildFailure(const MpmChild *child);
const char *MpmChildErrors(const MpmChild *child);

/* Not collective. Sends a line if the child still listens, waits a moment for its end, and ends it otherwise. */
PetscErrorCode MpmChildEnd(MpmChild **child, const char line[]);
