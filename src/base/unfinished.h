/* Files that are being written aside: none of them stays when the program ends before they have their names. */
#pragma once
#include <mpmstab/compat.h>

/* Not collective. Begins and ends the care for a file. */
void MpmUnfinishedAdd(const char part[]);
void MpmUnfinishedDone(const char part[]);

/* Not collective. Removes those that are left; whether the last one added was still there. */
PetscBool MpmUnfinishedRemove(void);
