/* Environment variables of Open MPI for a process without mpirun or srun. */
#include "base/launch.h"
#include <stdlib.h>

void MpmLaunchAlone(void)
{
  static const char *const launchers[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};

  for (unsigned i = 0; i < sizeof launchers / sizeof launchers[0]; i++)
    if (getenv(launchers[i])) return;
  (void)setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  (void)setenv("OMPI_MCA_pml", "ob1", 0);
  /* All such processes would share one session folder, and the first one that ends would remove it under the others. */
  (void)setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  (void)setenv("OMPI_MCA_sharedfp", "^sm", 0); /* would keep a file there; we share no file pointer */
}
