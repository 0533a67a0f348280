/* Handlers of errors: the parts that MpmInitialize, MpmFinalize and the files of a run use. */
#pragma once
#include <mpmstab/errors.h>

/*
   MpmErrorsOutside - installs the handler for errors that occur while PETSc starts and ends. This library does nothing
   then, so such an error means that one of PETSc's own options is wrong; the handler says so in one line.

   Not collective. Part of MpmInitialize, which calls it before PETSc starts.
*/
PetscErrorCode MpmErrorsOutside(void);

/*
   MpmErrorsReportLost - whether standard output has not taken all that was printed, as on a full disk; if so, says it in
   one line on standard error. A pipe whose reader has gone, as with '| head', is no loss.

   Not collective. Part of MpmFinalize.
*/
PetscBool MpmErrorsReportLost(void);

/*
   MpmErrorsBlame - names the file that is being written, so that an error of HDF5 is reported as a refusal that names
   this file. One process prints it and the program ends at once on all processes, because HDF5's collective operations
   cannot be left in another way.

   Not collective. Input Parameter: file - the file's name; "" when no file is being written any more.
*/
void MpmErrorsBlame(const char file[]);
