/* The nearest known name to a misspelled one, by Levenshtein's distance. */
#include "base/suggest.h"
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
