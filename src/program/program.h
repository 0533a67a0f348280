/*
   Program: a step, or several, as a list of lines on registers, and the one interpreter that walks them. What a
   register is, an algebra says: a vector (program.c), a sparse matrix whose columns are the numbers that the program
   takes (matrices.c), or a polynomial of small matrices (operator/nodal.c).

   Registers are numbered: first those of particles, then those of nodes. A line with a map M is

     dst  = f k^power left * M (right * src)        k the Courant number, * number by number
     dst += f k^power left * M (right * src)        where it accumulates

   The transpose of a program is made of the lines' transposes in the opposite order. The transpose of the line above is
   src += f k^power right * M^T (left * dst), and then dst = 0 unless the line accumulates.
*/
#pragma once
#include "base/float_check.h"
#include "program/maps.h"
#include <petscksp.h>

#define MPM_MAX_STATE (MPM_MAX_FIELDS + MPM_MAX_DIM)

/*S
   MpmRegisters - how many registers a program has, and which hold what it takes and gives.

   rows, n - of particles (0) and of nodes (1): how many of them this rank has, and the number of registers
   nin, in, nout, out - the registers that hold what the program takes, and what it gives. All other registers are 0 at
             the start. Number f of row i is unknown nin i + f, and nout i + f.
S*/
typedef struct {
  MPI_Comm comm;
  PetscInt rows[2], n[2], nin, nout, in[MPM_MAX_STATE], out[MPM_MAX_STATE];
} MpmRegisters;

/* Not collective. Whether a register is one of nodes. */
static inline PetscInt MpmRegisterPlace(const MpmRegisters *r, PetscInt reg)
{
  return reg >= r->n[0] ? 1 : 0;
}

/*S
   MpmLine - a line of a program.

   op          - the key of the line's map: the operation of a table that it comes from. NULL: the identity
   key         - in a plan (operator/nodal.h) the number of the line's map, or MPM_NONE: the identity
   map         - the matrix of the map, of a line that is bound to particles at their places. NULL: the identity
   nsolve, solve - 0, or register dst and the nsolve - 1 after it, node by node, become the solution of a system with
                 these as its right side. The line has no map then.
   transposed  - the line's map is the transpose of map
   left, right - NULL: ones
S*/
typedef struct {
  PetscInt     dst, src, power, key;
  PetscReal    factor;
  PetscBool    accumulates, transposed;
  const MpmOp *op;
  Mat          map;
  Vec          left, right;
  KSP          solve;
  PetscInt     nsolve;
} MpmLine;

/*S
   MpmAlgebra - what the interpreter needs to know of registers.

   zero  - register dst = 0
   scale - register dst = f k^power left * register dst, of a line without a map from a register to itself
   add   - the line, as one that accumulates; back: its transpose
   solve - a line that solves; back: the system's transpose
S*/
typedef struct {
  PetscErrorCode (*zero)(void *registers, PetscInt dst);
  PetscErrorCode (*scale)(void *registers, const MpmLine *line);
  PetscErrorCode (*add)(void *registers, const MpmLine *line, PetscBool back);
  PetscErrorCode (*solve)(void *registers, const MpmLine *line, PetscBool back);
} MpmAlgebra;

/*S
   MpmStepProgram - the lines, and the Courant number that their powers are of. nonzeros: the numbers in all maps on all
   ranks, 0 where nobody counted them. users: how many refer to it.
S*/
typedef struct {
  MpmRegisters registers;
  PetscReal    courant, nonzeros;
  PetscInt     n, room, users;
  MpmLine     *line;
} MpmStepProgram;

/*
   MpmStepProgramCreate  - an empty program
   MpmStepProgramDestroy - takes away a reference to it
   MpmStepProgramAppend  - appends a line; the program keeps references to its map, left and right
   MpmStepProgramRun     - the interpreter: takes the lines in order or, back, their transposes. MpmLineRun: of one line

   Collective.
*/
PetscErrorCode MpmStepProgramCreate(const MpmRegisters *registers, PetscReal courant, MpmStepProgram **program);
PetscErrorCode MpmStepProgramDestroy(MpmStepProgram **program);
PetscErrorCode MpmStepProgramAppend(MpmStepProgram *program, MpmLine line);
PetscErrorCode MpmStepProgramRun(const MpmStepProgram *program, const MpmAlgebra *algebra, void *registers,
                                 PetscBool back);
PetscErrorCode MpmLineRun(const MpmLine *line, const MpmAlgebra *algebra, void *registers, PetscBool back);

/* Not collective. f k^power */
PetscReal MpmLineValue(const MpmLine *line, PetscReal courant);

/* Collective. The bytes of all that the lines refer to. */
PetscErrorCode MpmStepProgramBytes(const MpmStepProgram *program, PetscReal *bytes);

/*
   Lowering (lower.c): the operations of a table as lines.

   MpmRegistersOf - the registers of a slab's table, which takes and gives its state
   MpmStepProgramAppendStep - appends the operations of a table, with the particles where maps has them. again: a step
             came before, whose scratch registers are set to 0
   MpmStepProgramAppendTable - appends the operations of a table. maps: NULL for lines with keys alone, for an algebra
             that knows what a map is by its operation
   MpmLinesOfOp - the lines of an operation, with keys, in a table of dim directions whose first register of nodes is
             nodes; returns how many there are. Only that is not collective.
   MpmLineBind - sets the map of a line with a key, or left of COLLIDE of linear colliders, or the solver of IMPLICIT
   MpmLineRelease - destroys them
   MpmCollision - what COLLIDE adds at the nodes of a slab, whose velocity is u, NULL: 0; and its derivative by each
             component of u, as vectors that the caller destroys
   MpmFactorised - a solver that has factorised a matrix by LU, for a line that solves

   Collective.
*/
PetscErrorCode MpmFactorised(Mat matrix, KSP *solve);
PetscErrorCode MpmRegistersOf(const MpmSlab *slab, MpmRegisters *registers);
PetscErrorCode MpmStepProgramAppendStep(MpmStepProgram *program, MpmMaps *maps, PetscBool again);
PetscErrorCode MpmStepProgramAppendTable(MpmStepProgram *program, const MpmTable *table, MpmMaps *maps);
PetscInt       MpmLinesOfOp(const MpmOp *op, PetscInt dim, PetscInt nodes, MpmLine line[MPM_MAX_DIM]);
PetscErrorCode MpmLineBind(const MpmStepProgram *program, MpmMaps *maps, MpmLine *line);
PetscErrorCode MpmLineRelease(MpmLine *line);
PetscErrorCode MpmCollision(const MpmSlab *slab, const MpmOp *op, PetscReal time, const Vec u[], Vec *adds,
                            Vec slope[MPM_MAX_DIM]);

/*S
   MpmVectors - registers as vectors, each made when it is first written to; NULL is 0. Several matrices of programs
   with the same registers may share them.

   courant - of the program that runs
   slot    - the registers
   scratch - two vectors each for what is multiplied on particles and on nodes
S*/
typedef struct {
  MpmRegisters registers;
  PetscReal    courant;
  PetscInt     users;
  Vec         *slot, scratch[2][2];
} MpmVectors;

extern const MpmAlgebra MpmVectorAlgebra;

/*
   MpmVectorsCreate - registers that are all 0; MpmVectorsDestroy takes away a reference.
   MpmRegisterVector - a new vector of the size of a register on particles (0) or on nodes (1), of zeros.

   Collective.
*/
PetscErrorCode MpmVectorsCreate(const MpmRegisters *registers, MpmVectors **vectors);
PetscErrorCode MpmVectorsDestroy(MpmVectors **vectors);
PetscErrorCode MpmRegisterVector(const MpmRegisters *registers, PetscInt place, Vec *vector);

/*
   MpmStepProgramMatrix - a MATSHELL whose products, and transposed products, run a program on vectors. The matrix has
   references to both from then on. vectors: NULL for memory of its own. MatGetInfo has the program's nonzeros. MatNorm
   has its infinity norm from below; other norms are not known.

   MpmMatrixProgram - the program of such a matrix. MpmMatrixCopy - a second matrix of the same program, which may be
   scaled by itself.

   Collective.
*/
PetscErrorCode MpmStepProgramMatrix(MpmStepProgram *program, MpmVectors *vectors, Mat *matrix);
PetscErrorCode MpmMatrixProgram(Mat matrix, const MpmStepProgram **program);
PetscErrorCode MpmMatrixCopy(Mat matrix, Mat *copy);

/*S
   MpmMatrices - registers as sparse matrices. Their rows are particles or nodes, and their columns what the program
   takes. NULL is 0. As polynomials in the Courant number they have a block of columns for each power, and a
   multiplication by k moves each block to the next one.

   columns       - of this rank
   times_courant - what multiplies by k, or NULL where k is the number courant
S*/
typedef struct {
  MpmRegisters  registers;
  PetscReal     courant;
  PetscInt      columns;
  Mat          *reg, times_courant;
  MpmFloatCheck float_check;
} MpmMatrices;

/*
   MpmMatricesCreate - the registers that a program takes are rows of the identity. degree: 0, or of polynomials; powers
   beyond it are dropped, and the calling rank holds everything.
   MpmMatricesRun - runs a program on them, which messages call step number step
   MpmMatricesGather - what the program gives, as one matrix. Number f of row i becomes row nout x i + f.
                       diagonal: it has every entry of its diagonal, if only as 0, so that it can be shifted.
   MpmStepProgramAssemble - all of this, of one program

   Collective.
*/
PetscErrorCode MpmMatricesCreate(const MpmRegisters *registers, PetscReal courant, PetscInt degree, MpmMatrices *m);
PetscErrorCode MpmMatricesRun(MpmMatrices *m, const MpmStepProgram *program, PetscInt64 step);
PetscErrorCode MpmMatricesGather(const MpmMatrices *m, PetscBool diagonal, Mat *A);
PetscErrorCode MpmMatricesDestroy(MpmMatrices *m);
PetscErrorCode MpmStepProgramAssemble(const MpmStepProgram *program, PetscBool diagonal, Mat *A);

/* ---- the operator of some steps: as matrices, or without its matrix as their program ---- */

/*
   MpmStepsMatrix - a MATSHELL whose product with a state is what the steps first .. first + steps - 1 make of it: a
   program's matrix (MpmStepProgramMatrix). It holds the maps of every step, and MatGetInfo counts their numbers.

   Collective. The rows are those of MpmMatricesStep. layout and scheme must outlive it.
*/
PetscErrorCode MpmStepsMatrix(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                              PetscInt first, PetscInt steps, Mat *matrix);

/* Not collective. An upper bound of the numbers in the maps of one step, over all ranks. */
PetscReal MpmStepsNonzeros(const MpmLayout *layout, const MpmScheme *scheme);

/*
   MpmMatricesOfSlab - registers as matrices, for the steps of a slab's scheme; degree is that of MpmMatricesCreate.
   MpmMatricesStep - takes them through a step.

   Collective.
*/
PetscErrorCode MpmMatricesOfSlab(const MpmSlab *slab, PetscInt degree, MpmMatrices *m);
PetscErrorCode MpmMatricesStep(MpmMatrices *m, const MpmSlab *slab, PetscInt64 step);
