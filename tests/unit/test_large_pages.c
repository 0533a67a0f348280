/* An array keeps its values when it is asked to be in large pages, and the system knows that it has been asked. */
#define _DEFAULT_SOURCE /* MADV_HUGEPAGE */
#include "check.h"
#include "base/large_pages.h"
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define N ((size_t)1 << 20)
#define LINE 1024 /* of smaps */

/* Whether the flags of the mapping that an address is in have hg: large pages are wanted. */
static PetscBool IsAdvised(const void *address)
{
  FILE     *file = fopen("/proc/self/smaps", "r");
  char      line[LINE];
  PetscBool inside = PETSC_FALSE, advised = PETSC_FALSE;

  while (file && fgets(line, sizeof line, file)) {
    void *begin, *end;

    if (sscanf(line, "%p-%p ", &begin, &end) == 2)
      inside = (const char *)address >= (const char *)begin && (const char *)address < (const char *)end ? PETSC_TRUE
                                                                                                         : PETSC_FALSE;
    else if (inside && !strncmp(line, "VmFlags:", 8) && strstr(line, " hg"))
      advised = PETSC_TRUE;
  }
  if (file) fclose(file);
  return advised;
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscReal *large, small[8] = {0};
  PetscInt   differ = 0;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(PetscMalloc1(N, &large));
  for (size_t i = 0; i < N; i++) large[i] = (PetscReal)i;
  MpmLargePages(large, N * sizeof *large);
  MpmLargePages(small, sizeof small);
  for (size_t i = 0; i < N; i++) differ += large[i] != (PetscReal)i;
  CHECK(!differ, "%d values have changed", (int)differ);
#ifdef MADV_HUGEPAGE
  if (!access("/sys/kernel/mm/transparent_hugepage/enabled", R_OK))
    CHECK(IsAdvised(large + N / 2), "the system has not been asked");
#endif
  CHECK(!IsAdvised(small), "all memory is advised, which says nothing");
  PetscCall(PetscFree(large));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
