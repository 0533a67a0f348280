/* What Open MPI is told when the program is started without mpirun or srun. */
#pragma once

/*
   MpmLaunchAlone - tells Open MPI, by environment variables, that there is one process and no other to talk to. Open MPI
   then neither starts a daemon nor looks for a network. A small task takes 0.06 s instead of 0.36 s.

   Not collective. Call it before MPI_Init. It does nothing when a launcher has started the process. Variables that are
   set already stay as they are. Other MPI libraries do not read them.
*/
void MpmLaunchAlone(void);
