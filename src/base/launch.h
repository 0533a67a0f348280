/* Launch: what is set for the process before MPI starts. */
#pragma once
#include <stddef.h>

/*
   MpmLaunchAlone - tells Open MPI, by environment variables, that there is one process and no other to talk to. Open
   MPI then neither starts a daemon nor looks for a network or for devices. A small task takes 0.05 s instead of 0.36 s.

   Not collective. Call it before MPI_Init. It does nothing when a launcher has started the process. Variables that are
   set already stay as they are. Other MPI libraries read none of them but that of hwloc.
*/
void MpmLaunchAlone(void);

/*
   MpmLaunchStandardFiles - opens /dev/null in place of standard input, output or error where one of them is closed.
   Otherwise the next file that the program opens would get this number, and the report would be written to it.

   Not collective; call it first. /dev/null is opened for reading only, so a report that cannot be written is noticed at
   the end (MpmFinalize).
*/
void MpmLaunchStandardFiles(void);

/*
   MpmLaunchMemory - returns whether the shell grants the address space (ulimit -v) that MPI and LAPACK start with.
   Otherwise the first rank says so. Without it Open MPI prints several lines of its own, or ends without any.

   Not collective; call it before MPI_Init. MpmLaunchGrants: whether it grants so many bytes more.
*/
int MpmLaunchMemory(void);
int MpmLaunchGrants(size_t bytes);

/* Not collective. The first rank alone prints a refusal: what it is about, and why with what is allowed. */
void MpmLaunchRefuse(const char what[], const char why[]);

/*
   MpmLaunchOptionFile - gives the names of the files in which PETSc looks for options, the one that overrules the
   others first. Returns 0 when there is no i-th.

   Not collective.
*/
int MpmLaunchOptionFile(int i, size_t room, char name[]);

/*
   MpmLaunchOptionFiles - returns whether the files in which PETSc looks for options, and those that -options_file
   names, can be read without waiting, and are not too large. Otherwise the first rank prints which one cannot.

   Not collective; call it before PetscInitialize, which would wait for ever for the writer of a pipe.
*/
int MpmLaunchOptionFiles(int argc, char **argv);
