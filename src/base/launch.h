/* How the program is started. */
#pragma once

/*
   MpmLaunchAlone - without a launcher, tells Open MPI that there will be one rank and no other process to talk to: it
   then neither starts a daemon nor looks for a network, which is five sixths of the time that a small task takes (0.36
   s and 0.06 s). What the environment says already is left as it is; other MPIs do not read it.

   Not collective; call before MPI_Init.
*/
void MpmLaunchAlone(void);
