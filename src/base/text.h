/* Texts whose length depends on what a user wrote, and the end of texts that have a bound. */
#pragma once
#include <mpmstab/compat.h>
#include <stdarg.h>

/*
   A text that grows, for names, values and files of a user and for lists of them. {0} is one without characters; text
   is then NULL.
*/
typedef struct {
  char  *text;
  size_t length;
} MpmText;

/* Not collective. Adds what the printf format and its arguments say. Free the text when it is no longer needed. */
PetscErrorCode MpmTextAdd(MpmText *text, const char format[], ...) __attribute__((format(printf, 2, 3)));
void           MpmTextFree(MpmText *text);

/* Not collective. The text that a printf format makes, to be freed with free(); NULL: there is no memory. */
char *MpmTextMade(const char format[], va_list arguments) __attribute__((format(printf, 1, 0)));

/*
   MpmTextJoin - appends to a text in memory of room bytes, for numbers and for words of this program. What does not fit
   is left out, and the text then ends with "...". PetscStrlcat of PETSc 3.18 writes beyond the memory there: it takes
   the length of what it adds from the room, where the length of both counts.

   Not collective.
*/
void MpmTextJoin(char text[], const char more[], size_t room);
