/* The state of a written scheme while its lines become operations. */
#pragma once
#include "scheme/language_line.h"

/*
   f        - the formulation that is made; the fields of nodes that the text does not name come after the others
   text     - the line that is read
   has_mass - a sum has made the nodal masses
   written_to, imposed, reacts, node_read, particle_read, filtered - what the lines so far did with each field
   lost     - lost[n]: a filter may have put something else in node field n than the lines did
   holds    - holds[n]: the particle field that node field n is P2G of as it stands, or MPM_NONE
   at_wall  - at_wall[n]: node field n is 0 at fixed walls, as IMPOSE sets it
   lap      - lap[n]: the line in which LAP first reads node field n without such values; NULL: none
   group    - group[n]: the number of the group of node field n; combinations are of fields of one group
*/
typedef struct {
  const MpmWritten     *written;
  MpmFormulation       *f;
  const MpmWrittenText *text;
  PetscInt              nnodes, nops, room, holds[MPM_MAX_FIELDS], group[MPM_MAX_FIELDS];
  MpmOp                *ops;
  PetscBool             has_mass, drifts, written_to[MPM_MAX_FIELDS], imposed[MPM_MAX_FIELDS], reacts[MPM_MAX_FIELDS];
  PetscBool             node_read[MPM_MAX_FIELDS], particle_read[MPM_MAX_FIELDS];
  PetscInt              filtered[MPM_MAX_FIELDS];
  PetscBool             lost[MPM_MAX_FIELDS], at_wall[MPM_MAX_FIELDS];
  const MpmWrittenText *lap[MPM_MAX_FIELDS];
} MpmCompiler;

/* Collective. Appends the operations of a line, or refuses it. */
PetscErrorCode MpmCompileLine(MpmCompiler *compiler, MpmLine *line);

/* Not collective. The fields of compiler->written become those of compiler->f. */
PetscErrorCode MpmCompilerBegin(MpmCompiler *compiler);

/* Collective. The transfer of a written scheme. *transfer is to be destroyed after a refusal, too. */
PetscErrorCode MpmWrittenCompileTransfer(const MpmWritten *written, const PetscReal numbers[], MpmTransfer **transfer);
PetscErrorCode MpmWrittenTransferDestroy(MpmTransfer **transfer);

/* Not collective. The line that says an operation on fields of a formulation. */
PetscErrorCode MpmWrittenLineText(const MpmFormulation *formulation, const MpmOp *op, size_t room, char text[]);
