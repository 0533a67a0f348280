/* The state of a written scheme while its lines become operations. */
#pragma once
#include "scheme/language_line.h"

/*
   f        - the formulation that is made; the fields of nodes that the text does not name come after the others
   text     - the line that is read
   has_mass - a sum has made the nodal masses
   written_to, imposed, reacts, node_read, particle_read, filtered - what the lines so far did with each field
   holds    - holds[n]: the particle field that node field n is P2G of as it stands, or MPM_NONE
   at_wall  - at_wall[n]: node field n is 0 at fixed walls, as IMPOSE sets it
   lap      - lap[n]: the line in which LAP first reads node field n without such values; NULL: none
   from     - from[n]: 1 + the node field that node field n is first made of; 0: of none
*/
typedef struct {
  const MpmWritten     *written;
  MpmFormulation       *f;
  const MpmWrittenText *text;
  PetscInt              nnodes, nops, room, holds[MPM_MAX_FIELDS], from[MPM_MAX_FIELDS];
  MpmOp                *ops;
  PetscBool             has_mass, drifts, written_to[MPM_MAX_FIELDS], imposed[MPM_MAX_FIELDS], reacts[MPM_MAX_FIELDS];
  PetscBool             node_read[MPM_MAX_FIELDS], particle_read[MPM_MAX_FIELDS];
  PetscInt              filtered[MPM_MAX_FIELDS];
  PetscBool             at_wall[MPM_MAX_FIELDS];
  const MpmWrittenText *lap[MPM_MAX_FIELDS];
} MpmCompiler;

/* Collective. Appends the operations of a line, or refuses it. */
PetscErrorCode MpmCompileLine(MpmCompiler *compiler, MpmLine *line);
