/*
   Unfinished files: a file is written under a temporary name, PATH.HOST-PID-RANDOM.part, and gets its own name when it
   is whole. The temporary name belongs to this process alone, so that no other program writes to the file or removes
   it.

   The functions are not collective: only the first rank writes files and calls them.
*/
#pragma once
#include <mpmstab/compat.h>

/*
   MpmUnfinishedCreate - creates an empty file under a new temporary name beside path, and sets part to this name.

   Returns an errno; 0 when the file has been created. The file is locked (flock) until it is finished or dropped.
*/
int MpmUnfinishedCreate(const char path[], char part[PETSC_MAX_PATH_LEN]);

/*
   Returns the descriptor of such a file, or -1. It is open for reading and writing until the file is finished or
   dropped.
*/
int MpmUnfinishedDescriptor(const char part[]);

/*
   Gives a whole file its own name; a file that had this name is replaced. Returns an errno; if it is not 0, the file is
   removed.
*/
int MpmUnfinishedFinish(const char part[], const char path[]);

/*
   MpmUnfinishedDrop removes one file, MpmUnfinishedRemove all files that this process has not finished. The second
   function may be called from a signal handler.
*/
void MpmUnfinishedDrop(const char part[]);
void MpmUnfinishedRemove(void);

/*
   MpmUnfinishedClear - removes the unfinished files that dead processes of this host have left beside path.

   It keeps a file of another host, of a process that runs, or one that is locked.
*/
void MpmUnfinishedClear(const char path[]);
