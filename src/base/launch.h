/* How the program is started. */
#pragma once

/*
   MpmLaunchAlone - without a launcher, tells Open MPI that there will be one rank and no other process to talk to: it
   then neither starts a daemon nor looks for a network, which is five sixths of the time that a small task takes (0.36
   s and 0.06 s). What the environment says already is left as it is; other MPIs do not read it.

   Not collective; call before MPI_Init.
*/
void MpmLaunchAlone(void);

/*
   MpmLaunchStandardFiles - where standard input, output or error is closed, opens a file there that takes nothing: else
   the next file that anybody opens would get its number, and the report with it.

   Not collective; call first. A report that cannot be written is then noticed at the end (MpmErrorsReportLost).
*/
void MpmLaunchStandardFiles(void);

/*
   MpmLaunchOptionFiles - whether the files in which PETSc looks for options can be read without waiting; else says
   which cannot, from the first rank.

   Not collective; call before PetscInitialize. PETSc would wait for ever for the writer of a pipe.
*/
int MpmLaunchOptionFiles(int argc, char **argv);
