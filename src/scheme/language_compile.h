/* A written scheme while it is read: a line as it is understood, and the state while lines become operations. */
#pragma once
#include "scheme/language.h"

/*
   A polynomial in the Courant number: of[p] multiplies its power p. has[p]: the text has such a term, if only with 0.
*/
typedef struct {
  PetscReal of[MPM_MOST_POWER + 1];
  PetscBool has[MPM_MOST_POWER + 1];
} MpmPowers;

/* Whether a polynomial is one power alone, and which; whether it is the number 1. */
PetscBool MpmPowersIsOne(const MpmPowers *powers, PetscInt *power);
PetscBool MpmPowersIsUnit(const MpmPowers *powers);

/*
   A term: factor times an operation on a field. The kind is COPY for a field of nodes as it stands, and ADD for one of
   particles. dot and stress: the text says 'GRAD .' or 'STRESS GRAD'.
*/
typedef struct {
  MpmOpKind kind;
  MpmPlace  place;
  PetscInt  field;
  PetscBool dot, stress;
  MpmPowers factor;
} MpmTerm;

#define MPM_MOST_TERMS 24

/*
   A line as it is understood. op is its statement: IMPOSE, REACT, one of the filters, MOVE, MOVE_PROJECTED, IMPLICIT or
   DRIFT; of a FILTER field is that of particles, and other that of nodes. MPM_LINE_SETS: the line sets a field, field =
   terms; with adds field += terms, where 'field -= terms' has become a sum. share: how much of a field particles move
   with. IMPLICIT has its number as the factor of a term.
*/
#define MPM_LINE_SETS MPM_COPY
typedef struct {
  MpmOpKind op;
  MpmPlace  place;
  PetscInt  field, other, nterms;
  PetscBool adds;
  PetscReal share;
  MpmTerm   term[MPM_MOST_TERMS];
} MpmWrittenLine;

/* Collective. Reads a line. numbers: the values of the parameters. Refuses what is not one of the language's lines. */
PetscErrorCode MpmLineRead(const MpmWritten *written, const PetscReal numbers[], const MpmWrittenText *text,
                           MpmWrittenLine *line);

/*
   Collective. The value of the text of a parameter; found(context, name, &value) looks other parameters up and refuses
   those that do not exist.
*/
typedef PetscErrorCode (*MpmLookUp)(void *context, const MpmWrittenText *text, const char name[], PetscReal *value);
PetscErrorCode MpmNumberRead(const MpmWritten *written, const MpmWrittenText *text, MpmLookUp found, void *context,
                             PetscReal *value);

/* Not collective. The field of a name, and where it is; MPM_NOWHERE when there is none. */
MpmPlace MpmWrittenFindField(const MpmWritten *written, const char name[], PetscInt *field);

/*
   Not collective. The word of an operation on a field, "" of none; GRAD with a dot, or after STRESS. MpmStatementWord:
   of IMPOSE and the like. MpmRankNames: of MpmRank.
*/
const char *MpmOperationWord(MpmOpKind kind, PetscBool dot, PetscBool stress);
const char *MpmStatementWord(MpmOpKind kind);

extern const char *const MpmRankNames[];

/* Not collective. Whether a word has a meaning of its own in lines, so that nothing else may have its name. */
PetscBool MpmWrittenIsWord(const char name[]);

/* Refuses a line: its place, the line itself, and what is wrong with it. */
#define MPM_SHOWN_OF_LINE 100
#define MpmRefuseLine(written, where, ...) return MpmWrittenRefuse(written, where, __VA_ARGS__)
PetscErrorCode MpmWrittenRefuse(const MpmWritten *written, const MpmWrittenText *where, const char format[], ...)
    __attribute__((format(printf, 3, 4)));

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
PetscErrorCode MpmCompileLine(MpmCompiler *compiler, MpmWrittenLine *line);

/* Not collective. The fields of compiler->written become those of compiler->f. */
PetscErrorCode MpmCompilerBegin(MpmCompiler *compiler);

/* Collective. The transfer of a written scheme. *transfer is to be destroyed after a refusal, too. */
PetscErrorCode MpmWrittenCompileTransfer(const MpmWritten *written, const PetscReal numbers[], MpmTransfer **transfer);
PetscErrorCode MpmWrittenTransferDestroy(MpmTransfer **transfer);
