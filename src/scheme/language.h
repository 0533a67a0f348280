/*
   Language: a scheme as text. docs/theory.md, section 3, has the language; a written scheme becomes a formulation,
   which is the same table as one of src/scheme/formulation.

   YAML is the form of the whole, so that it can stand in a scene. A line of the step is one of

     field = combination        field += combination        field -= combination
     IMPOSE node                REACT node imposed          FILTER particle node          DRIFT
     FILTER_BEFORE particle node                            FILTER_AFTER particle node
     MOVE [number] node         MOVE_PROJECTED [number] node    IMPLICIT node number

   where a combination is a sum of products of numbers, names of parameters, powers of k, and one field each, on which
   P2G, DIV, G2P, GRAD, GRAD ., STRESS GRAD, LAP or SOLVE may act.
*/
#pragma once
#include <mpmstab/formulation.h>
#include <mpmstab/transfer.h>
#include <yaml.h> /* MpmWrittenFromYaml takes a node of a document */

#define MPM_MOST_PARAMETERS 12
#define MPM_MOST_LINES_OF_STEP 64
#define MPM_MOST_LINES_OF_FILTER 64
#define MPM_MOST_NAME 12 /* characters in the name of a field, since names of components are at most 15 */
#define MPM_MOST_POWER 8 /* of the Courant number */

/* A piece of text, and the line of the file that it stands in. */
typedef struct {
  char *text;
  int   line;
} MpmWrittenText;

typedef struct {
  MpmWrittenText name;
  MpmRank        rank;
} MpmWrittenField;

/* An entry of energy: a field, and mass, compliance or difference. */
typedef struct {
  MpmWrittenText field, kind;
} MpmWrittenTerm;

/*
   A constant with a name. text is a number or an expression in other parameters; with set the number value takes its
   place.
*/
typedef struct {
  MpmWrittenText name, text;
  PetscBool      set;
  PetscReal      value;
} MpmWrittenParameter;

/*
   A transfer: its filter as lines, and the fields that these have besides q and g (language_transfer.c). Without one
   the text of its name is NULL.
*/
typedef struct {
  MpmWrittenText name;
  PetscInt       nparticles, nnodes, nlines;
  MpmWrittenText particle[MPM_MAX_FIELDS], node[MPM_MAX_FIELDS], lines[MPM_MOST_LINES_OF_FILTER];
} MpmWrittenTransfer;

/*S
   MpmWritten - a scheme as it is written. Texts that were not given are NULL.

   file        - the file, or what messages call the text
   line        - where the scheme begins
   particles, nodes - the fields, in the order of the text
   step        - the lines
   parameters  - the named constants, those of the transfer among them
   transfer    - takes the place of FILTER. A text may have a transfer alone; the scheme is then a formulation's
                 (MpmWrittenAddFormulation).
   energy, wave, staggered, affine, conserved - what MpmFormulation has of the same name
S*/
struct MpmWritten_ {
  char                file[PETSC_MAX_PATH_LEN];
  int                 line;
  MpmWrittenText      name, reference, summary, wave, staggered, affine, conserved;
  PetscInt            nparticles, nnodes, nstep, nparameters, nenergy;
  MpmWrittenField     particles[MPM_MAX_FIELDS], nodes[MPM_MAX_FIELDS];
  MpmWrittenText      step[MPM_MOST_LINES_OF_STEP];
  MpmWrittenParameter parameters[MPM_MOST_PARAMETERS];
  MpmWrittenTerm      energy[MPM_MAX_FIELDS];
  MpmWrittenTransfer  transfer;
};

/*
   MpmWrittenFromYaml - reads a scheme from a node of a YAML document, a mapping. file is what messages call the text.

   Collective. Errors: PETSC_ERR_USER_INPUT for keys that do not exist or are missing, and names that cannot be; the
   message names file and line. *written is then to be destroyed, too.
*/
PetscErrorCode MpmWrittenFromYaml(const char file[], yaml_document_t *document, const yaml_node_t *node,
                                  MpmWritten **written);

/* Not collective. Adds the text of a formulation; what that does not say, such as closed forms, is left out. */
PetscErrorCode MpmWrittenAddFormulation(const MpmFormulation *formulation, const MpmSchemeNumbers *numbers,
                                        const MpmTransfer *transfer, MpmWritten *written);

/* Collective. The text of a transfer. Refuses one without a filter, and one that does more than to filter. */
PetscErrorCode MpmWrittenFromTransfer(const MpmTransfer *transfer, const MpmSchemeNumbers *numbers,
                                      MpmWritten **written);

PetscErrorCode MpmWrittenDestroy(MpmWritten **written);

/* Not collective. The text as YAML, to be freed by PetscFree. */
PetscErrorCode MpmWrittenYaml(const MpmWritten *written, char **yaml);

/* Not collective. The number of a parameter, or MPM_NONE. */
PetscInt MpmWrittenFindParameter(const MpmWritten *written, const char name[]);

/* Collective. The numbers of all parameters. Refuses cycles, names that do not exist and what is not a number. */
PetscErrorCode MpmWrittenNumbers(const MpmWritten *written, PetscReal numbers[]);

/*
   MpmWrittenCompile - makes a formulation of a written scheme.

   Collective.

   Input Parameters:
+  nset      - the number of parameters that have another value than the written one
.  parameter - their numbers
-  value     - their values

   Output Parameter: formulation - destroyed with MpmWrittenFormulationDestroy; it refers to written, which must outlive
   it

   Errors: PETSC_ERR_USER_INPUT; the message names the line and says what is allowed there.
*/
PetscErrorCode MpmWrittenCompile(const MpmWritten *written, PetscInt nset, const PetscInt parameter[],
                                 const PetscReal value[], MpmFormulation **formulation);
PetscErrorCode MpmWrittenFormulationDestroy(MpmFormulation **formulation);

/*
   MpmWrittenHash - 16 hexadecimal digits that tell the tables of written schemes apart. Names and references of
   schemes, comments, blanks and the values that parameters are given from outside do not change it.

   Not collective.
*/
#define MPM_HASH_TEXT 17
void MpmWrittenHash(const MpmWritten *written, char text[MPM_HASH_TEXT]);

/* Not collective. The values of the parameters, as name=value with commas between them. */
#define MPM_PARAMETERS_TEXT 512
PetscErrorCode MpmWrittenParametersText(const MpmWritten *written, char text[MPM_PARAMETERS_TEXT]);
