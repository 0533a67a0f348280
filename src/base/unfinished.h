/*
   Unfinished files: a file is written under a name aside, PATH.HOST-PID-RANDOM.part, and gets its own name when it is
   whole. The name aside belongs to this process alone, so that no other program ever writes to it or removes it.

   The functions are not collective: the first rank alone writes files, and calls them.
*/
#pragma once
#include <mpmstab/compat.h>

/*
   MpmUnfinishedCreate - makes an empty file under a new name beside path and tells its name in part.

   Returns an errno, 0 when the file is there. The file is locked (flock) until it is finished or dropped.
*/
int MpmUnfinishedCreate(const char path[], char part[PETSC_MAX_PATH_LEN]);

/* The descriptor of such a file, open for reading and writing as long as it is neither finished nor dropped. */
int MpmUnfinishedDescriptor(const char part[]);

/* Gives a whole file its name, in place of what was there. Returns an errno; with one the file is removed. */
int MpmUnfinishedFinish(const char part[], const char path[]);

/* Removes one file, or all that this process has not finished. The second may be called from a signal's handler. */
void MpmUnfinishedDrop(const char part[]);
void MpmUnfinishedRemove(void);

/*
   MpmUnfinishedClear - removes what dead processes of this host have left beside path.

   A file of another host, of a process that runs, or that somebody has locked stays.
*/
void MpmUnfinishedClear(const char path[]);
