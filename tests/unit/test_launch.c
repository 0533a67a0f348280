/* What is set before MPI starts: for a process alone, not for a rank, and never over what the user has set. */
#define _DEFAULT_SOURCE /* setenv */
#include "check.h"
#include "base/launch.h"
#include <stdlib.h>

static const char *const set[]       = {"OMPI_MCA_ess_singleton_isolated", "OMPI_MCA_pml",
                                        "OMPI_MCA_orte_create_session_dirs", "HWLOC_COMPONENTS"};
static const char *const launchers[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};

#define SET PETSC_STATIC_ARRAY_LENGTH(set)

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(launchers); i++) (void)unsetenv(launchers[i]);
  for (size_t i = 0; i < SET; i++) (void)unsetenv(set[i]);
  (void)setenv("PMI_RANK", "0", 1);
  MpmLaunchAlone();
  for (size_t i = 0; i < SET; i++) CHECK(!getenv(set[i]), "%s is set for a rank", set[i]);
  (void)unsetenv("PMI_RANK");
  MpmLaunchAlone();
  for (size_t i = 0; i < SET; i++) CHECK(getenv(set[i]), "%s is not set", set[i]);
  for (size_t i = 0; i < SET; i++) (void)setenv(set[i], "own", 1);
  MpmLaunchAlone();
  for (size_t i = 0; i < SET; i++) CHECK(!strcmp(getenv(set[i]), "own"), "%s is %s", set[i], getenv(set[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
