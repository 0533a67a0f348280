/* Without mpirun or srun there is nothing to wait for. */
#include <mpmstab/launch.h>
#include <stdlib.h>

void MpmLaunchAlone(void)
{
  static const char *const launchers[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};

  for (unsigned i = 0; i < sizeof launchers / sizeof launchers[0]; i++)
    if (getenv(launchers[i])) return;
  (void)setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  (void)setenv("OMPI_MCA_pml", "ob1", 0);
}
