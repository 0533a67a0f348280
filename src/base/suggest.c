/* The nearest known name to a misspelled one, by Levenshtein's distance. */
#include "base/suggest.h"
#include <mpmstab/errors.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST 40 /* in letters; no name is near to a longer word */

static PetscInt Distance(const char a[], const char b[])
{
  PetscInt row[LONGEST + 1];
  PetscInt n = (PetscInt)strlen(a), m = (PetscInt)strlen(b);

  if (n > LONGEST || m > LONGEST) return LONGEST;
  for (PetscInt j = 0; j <= m; j++) row[j] = j;
  for (PetscInt i = 1; i <= n; i++) {
    PetscInt diagonal = row[0];

    row[0] = i;
    for (PetscInt j = 1; j <= m; j++) {
      const PetscInt replace = diagonal + (a[i - 1] != b[j - 1]);

      diagonal = row[j];
      row[j]   = PetscMin(replace, 1 + PetscMin(row[j], row[j - 1]));
    }
  }
  return row[m];
}

const char *MpmSuggest(const char misspelled[], PetscInt n, const char *const names[])
{
  const char *nearest = NULL;
  PetscInt    least   = PetscMax(2, (PetscInt)strlen(misspelled) / 3) + 1;

  for (PetscInt i = 0; i < n; i++) {
    const PetscInt distance = Distance(misspelled, names[i]);

    if (distance < least && distance < (PetscInt)strlen(names[i])) { /* a letter at least is right */
      least   = distance;
      nearest = names[i];
    }
  }
  return nearest;
}

PetscErrorCode MpmSuggestAdd(MpmText *text, const char word[], PetscInt n, const char *const names[])
{
  const char *near = word ? MpmSuggest(word, n, names) : NULL;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++)
    PetscCall(MpmTextAdd(text, "%s%s", i == 0 ? "" : i == n - 1 ? " or " : ", ", names[i]));
  if (near) PetscCall(MpmTextAdd(text, "; did you mean %s?", near));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSuggestRefuse(const char word[], PetscInt n, const char *const names[], const char format[], ...)
{
  MpmText        all = {NULL, 0};
  char          *begin;
  va_list        arguments;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  va_start(arguments, format);
  begin = MpmTextMade(format, arguments);
  va_end(arguments);
  PetscCall(MpmSuggestAdd(&all, word, n, names));
  ierr = MpmRefusal("%s%s", begin ? begin : "", all.text);
  free(begin);
  MpmTextFree(&all);
  PetscFunctionReturn(ierr);
}
