/* The nearest name to a misspelled one. */
#include "check.h"
#include "base/suggest.h"

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const names[] = {"courant", "drift", "cells", "output"};
  const struct {
    const char *misspelled, *near;
  } cases[] = {{"coruant", "courant"}, {"drfit", "drift"}, {"cels", "cells"}, {"outptu", "output"},
               {"viscosity", NULL},    {"x", NULL},        {"", NULL},        {"courantnumber", NULL}};

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
    const char *near = MpmSuggest(cases[i].misspelled, 4, names);

    CHECK(near == cases[i].near || (near && cases[i].near && !strcmp(near, cases[i].near)), "'%s' gives '%s'",
          cases[i].misspelled, near ? near : "none");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
