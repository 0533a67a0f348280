/* Output: the fields of a run as HDF5, with XDMF beside it. */
#pragma once
#include "march/march_private.h"

/*S
   MpmOutput - the HDF5 file of a run.

   Groups /step_NNNNNNNNNN with attributes step and time hold particles/coordinates (n x 3, in units of
   length, wrapped into the domain), particles/FIELD (n) in the order of global ids and nodes/FIELD (cells),
   the P2G of each particle field. Values beyond the range of doubles are infinite. The scene and the version
   are attributes of the root.
*/
typedef struct MpmOutput_ MpmOutput;

/* Collective. */
PetscErrorCode MpmOutputCreate(const MpmMarch *march, MpmOutput **output);
PetscErrorCode MpmOutputStep(MpmOutput *output, MpmMarch *march);

/* Collective. Writes PATH.xmf (PATH without .h5) and gives both files their names, or, not keep, removes both. */
PetscErrorCode MpmOutputDestroy(PetscBool keep, MpmOutput **output);
