/* The stability map of a code: growth over two of its parameters. */
#pragma once
#include "analysis/stability_map.h"
#include "probe/program.h"

/*
   MpmStabilityMapOfProgram - probes a code at each point, where two of its parameters have the point's numbers.

   Collective on PETSC_COMM_WORLD: the ranks share the columns of each point. The program must have been opened and not be
   prepared; afterwards it is prepared for the point that grows fastest, and must outlive the map. Errors:
   PETSC_ERR_USER_INPUT when the code has no such parameter, or fails at a point.
*/
PetscErrorCode MpmStabilityMapOfProgram(MpmProgram *program, MpmStabilityMap **map);
