/* The nodal operator of a layout as a sparse matrix, with its maps to and from the particles. */
#pragma once
#include "linalg/reduced.h"
#include <mpmstab/operator.h>

/*
   MpmNodalMatrixUnknowns - the order of the nodal operator of a layout, or 0 where it is not smaller than that of the
   particles or does not have its eigenvalues: particles that drift, tables without a plan, more
   unknowns on nodes than on particles.

   Not collective.
*/
PetscErrorCode MpmNodalMatrixUnknowns(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                      PetscInt64 *unknowns);

/*
   MpmNodalMatrixCreate - the nodal operator M of a layout at rest, the images Z that nodes have of the particles, and
   what B a step sends to the particles: A = C + B Z (see MpmReduced), with A the operator of one step.

   Collective. layout and scheme must outlive it; MpmReducedDestroy destroys it. Call it where MpmNodalMatrixUnknowns is
   not 0. unit: NULL, or that of an operator, which then is its balanced in place of A.

   Unknown g of node i has the number g + images x i. The slab of nodes of a rank is that of its registers (MpmSlab).
   B is a shell that runs the plan on vectors.
*/
PetscErrorCode MpmNodalMatrixCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme,
                                    const MpmStep *step, Vec unit, MpmReduced **nodal);

/*
   MpmNodalMatrixOf - the nodal operator of an operator, checked against it, or NULL where it has none or the check fails.

   Collective.
*/
PetscErrorCode MpmNodalMatrixOf(const MpmOperator *op, MpmReduced **nodal);
