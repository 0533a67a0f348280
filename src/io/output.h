/* Output: the fields of a run as HDF5, with an XDMF file beside it. */
#pragma once
#include "march/march_private.h"
#include "scene/request.h"

/*S
   MpmOutput - the HDF5 file of a run.

   Groups /step_NNNNNNNNNN with attributes step and time hold particles/coordinates (n x dim, in one dimension n x 3, in
   units of length, wrapped into the domain), particles/FIELD (n) in the order of global ids, and nodes/FIELD (nodes, ny
   x nx or nz x ny x nx), the P2G of each particle field. FIELD is a register of the table, such as v_x or s_xy. Values
   beyond the range of doubles are infinite. Scene and version are attributes of the root.
S*/
typedef struct MpmOutput_ MpmOutput;

/* Collective. Opens both files under temporary names. MpmOutputStep refuses at once when a step cannot be written. */
PetscErrorCode MpmOutputCreate(const MpmMarch *march, const MpmRequest *request, MpmOutput **output);
PetscErrorCode MpmOutputStep(MpmOutput *output, MpmMarch *march);

/*
   Collective. Gives both files, PATH and PATH.xmf (there PATH without .h5 or .hdf5), their own names; removes them when
   they are not to be kept.
*/
PetscErrorCode MpmOutputDestroy(PetscBool keep, MpmOutput **output);

/* Collective. Finds whether the request's output exists already and holds a step. */
PetscErrorCode MpmOutputHasStep(const MpmRequest *request, PetscInt64 step, PetscBool *has);
