/* Texts that grow, and texts that have a bound. */
#include "base/text.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MORE "..." /* ends a text that has been cut */

char *MpmTextMade(const char format[], va_list arguments)
{
  va_list again;
  char   *made;
  int     length;

  va_copy(again, arguments);
  length = vsnprintf(NULL, 0, format, again);
  va_end(again);
  made = length < 0 ? NULL : malloc((size_t)length + 1);
  if (made) (void)vsnprintf(made, (size_t)length + 1, format, arguments);
  return made;
}

PetscErrorCode MpmTextAdd(MpmText *text, const char format[], ...)
{
  va_list arguments;
  char   *more, *longer = NULL;
  size_t  length;

  PetscFunctionBegin;
  va_start(arguments, format);
  more = MpmTextMade(format, arguments);
  va_end(arguments);
  length = more ? strlen(more) : 0;
  if (more) longer = realloc(text->text, text->length + length + 1);
  if (longer) {
    memcpy(longer + text->length, more, length + 1);
    *text = (MpmText){longer, text->length + length};
  }
  free(more);
  PetscCheck(longer, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for a text");
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmTextFree(MpmText *text)
{
  free(text->text);
  *text = (MpmText){NULL, 0};
}

void MpmTextJoin(char text[], const char more[], size_t room)
{
  const size_t used = strlen(text), length = strlen(more);

  memcpy(text + used, more, PetscMin(length, room - 1 - used));
  text[PetscMin(used + length, room - 1)] = '\0';
  if (used + length > room - 1 && room > sizeof MORE) memcpy(text + room - sizeof MORE, MORE, sizeof MORE);
}
