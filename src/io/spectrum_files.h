/* Files of the task spectrum. */
#pragma once
#include "analysis/spectrum.h"

/*
   MpmSpectrumWriteFiles - writes eigenvalues, modes, the symbol's curves and transient growth as HDF5, and eigenvalues
   as CSV.

   Collective. It writes only the files that the request names.
*/
PetscErrorCode MpmSpectrumWriteFiles(const MpmSpectrum *spectrum);
