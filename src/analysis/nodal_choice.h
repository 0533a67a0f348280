/* The option nodal, where it has no sense. */
#pragma once
#include "scene/request.h"

/*
   MpmNodalChoiceCheck - refuses the option nodal, true or false, where the task takes no eigenvalues that the nodes' own
   operator could have: of particles that move, of tables and layouts without such an operator, and of critical where the
   symbol has the answer.

   Collective. Errors: PETSC_ERR_USER_INPUT.
*/
PetscErrorCode MpmNodalChoiceCheck(const MpmScene *scene, const MpmRequest *request);
