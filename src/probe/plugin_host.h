/*
   Plugin host: the process in which a shared library runs (option plugin), so that nothing that the library does ends
   mpmstab.
*/
#pragma once

#define MPM_PLUGIN_HOST                                                                                                \
  "plugin-host" /* the first word of a command line that starts one; the second is the library's path */

/*
   MpmPluginHost - loads a shared library with the functions of <mpmstab/plugin.h>, and answers protocol 1 with them on
   standard input and output, until its input ends.

   Not collective; it needs neither MPI nor PETSc. What is wrong with the library, or went wrong in it, is an answer
   with a "failure". The library itself has an empty standard input, and its standard output is the standard error.

   Returns: the exit status of the process.
*/
int MpmPluginHost(const char path[]);
