/* Output: the fields of a run as HDF5, with XDMF beside it. */
#pragma once
#include "march/march_private.h"
#include "scene/request.h"

/*S
   MpmOutput - the HDF5 file of a run.

   Groups /step_NNNNNNNNNN with attributes step and time hold particles/coordinates (n x 3, in units of
   length, wrapped into the domain), particles/FIELD (n) in the order of global ids and nodes/FIELD (cells),
   the P2G of each particle field. Values beyond the range of doubles are infinite. The scene and the version
   are attributes of the root.
*/
typedef struct MpmOutput_ MpmOutput;

/* Collective. Opens both files aside; a step that cannot be written is refused at once. */
PetscErrorCode MpmOutputCreate(const MpmMarch *march, const MpmRequest *request, MpmOutput **output);
PetscErrorCode MpmOutputStep(MpmOutput *output, MpmMarch *march);

/* Collective. Gives PATH and PATH.xmf (PATH without .h5 or .hdf5) their names, or, when they are not to be kept, removes
   both. */
PetscErrorCode MpmOutputDestroy(PetscBool keep, MpmOutput **output);

/* Collective. Whether the request's output is there already and holds a step. */
PetscErrorCode MpmOutputHasStep(const MpmRequest *request, PetscInt64 step, PetscBool *has);
