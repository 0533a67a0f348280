/* The task adapter: prints an adapter for the user's code, with five places to fill in. */
#include "base/suggest.h"
#include "base/text.h"
#include "task/task.h"
#include "task/texts.h"
#include <mpmstab/errors.h>
#include <string.h>

PetscErrorCode MpmTaskAdapter(int argc, char **argv)
{
  char        known[128] = "";
  const char *names[16], *near;
  PetscInt    n = 0;

  PetscFunctionBegin;
  for (; MpmAdapterTexts[n].name; n++) {
    names[n] = MpmAdapterTexts[n].name;
    if (n) MpmTextJoin(known, MpmAdapterTexts[n + 1].name ? ", " : " or ", sizeof known);
    MpmTextJoin(known, names[n], sizeof known);
    if (argc != 1 || strcmp(argv[0], names[n])) continue;
    MpmPrint("%s", MpmAdapterTexts[n].text);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  near = argc == 1 ? MpmSuggest(argv[0], n, names) : NULL;
  MpmRefuse("adapter%s%.200s: allowed: one word: %s%s%s%s", argc ? " " : "", argc ? argv[argc > 1] : "", known,
            near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
}
