/* What operators share, whether a table or somebody else made their matrix. */
#pragma once
#include <mpmstab/operator.h>

/* Not collective. Sets nonzeros and bytes from A. */
PetscErrorCode MpmOperatorCount(MpmOperator *op);
