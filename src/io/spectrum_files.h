/* Files of the task spectrum. */
#pragma once
#include "analysis/spectrum.h"

/*
   MpmSpectrumWriteFiles - eigenvalues, modes, the symbol's curves and transient growth, as HDF5; eigenvalues as CSV.

   Collective. Writes the files that the scene names, and none where it names none.
*/
PetscErrorCode MpmSpectrumWriteFiles(const MpmSpectrum *spectrum);
