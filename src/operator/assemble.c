/*
   The assemble reader: an operation of the table is a sparse product, q(t+1) = A(x_t) q(t).

     particle -> node       g = M^-1 S^T q      S: phi_ip (or h dphi_ip/dx), M: nodal masses
     node -> particle       q += a S g,  q += a D g     D: h dphi_ip/dx
     node -> node           g = a L f,   g += a f       L: the operation's stencil
*/
#include "operator/assemble.h"
#include "scene/layout.h"

/* The identity's rows of one field: particle p of this rank is number fields p + field of the state. */
static PetscErrorCode Identity(const MpmRegisters *r, PetscInt field, Mat *matrix)
{
  PetscInt row, column;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, r->particles, r->state, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, matrix));
  PetscCall(MatGetOwnershipRange(*matrix, &row, NULL));
  column = r->fields * row + field;
  for (PetscInt p = 0; p < r->particles; p++)
    PetscCall(MatSetValue(*matrix, row + p, column + r->fields * p, 1, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(*matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A register that holds nothing yet. */
static PetscErrorCode Empty(const MpmRegisters *r, PetscInt rows, Mat *matrix)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(matrix));
  PetscCall(MatCreateAIJ(r->comm, rows, r->state, PETSC_DETERMINE, PETSC_DETERMINE, 0, NULL, 0, NULL, matrix));
  PetscCall(MatAssemblyBegin(*matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                  MpmRegisters *r)
{
  PetscMPIInt rank, size;
  PetscInt64  begin, end;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  *r       = (MpmRegisters){.comm = comm, .layout = layout, .scheme = scheme, .step = *step, .masses_step = -1};
  r->cells = layout->grid.cells / size + (layout->grid.cells % size > rank ? 1 : 0); /* as DMDA gives them */
  r->first = 0;
  PetscCallMPI(MPI_Exscan(&r->cells, &r->first, 1, MPIU_INT, MPI_SUM, comm));
  r->nodes     = r->cells + (rank == size - 1 ? layout->grid.nodes - layout->grid.cells : 0);
  begin        = PetscMax(MpmLayoutSitesBefore(layout, r->first) - layout->first, 0);
  end          = PetscMin(MpmLayoutSitesBefore(layout, r->first + r->cells) - layout->first, layout->particles);
  r->begin     = (PetscInt)begin;
  r->particles = (PetscInt)PetscMax(end - begin, 0);
  r->fields    = scheme->table->nstate;
  r->state     = r->particles * r->fields;
  for (PetscInt f = 0; f < scheme->table->nparticles; f++)
    if (f < r->fields)
      PetscCall(Identity(r, f, &r->particle[f]));
    else
      PetscCall(Empty(r, r->particles, &r->particle[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersDestroy(MpmRegisters *r)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < MPM_MAX_FIELDS; f++) {
    PetscCall(MatDestroy(&r->particle[f]));
    PetscCall(MatDestroy(&r->node[f]));
  }
  PetscCall(VecDestroy(&r->masses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A stencil's rows; nodes beyond a wall are images. */
static PetscErrorCode Stencil(const MpmRegisters *r, const MpmOp *op, PetscBool antisymmetric, Mat *map)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, r->nodes, r->nodes, PETSC_DETERMINE, PETSC_DETERMINE, PetscMin(3, r->nodes), NULL,
                         PetscMin(2, r->layout->grid.nodes - r->nodes), NULL, map));
  for (PetscInt i = r->first; i < r->first + r->nodes; i++) {
    for (PetscInt d = -traits.halo; d <= traits.halo; d++) {
      PetscReal      sign;
      const PetscInt j = MpmDirectionImage(&r->layout->grid, i + d, antisymmetric, &sign);

      PetscCall(MatSetValue(*map, i, j, sign * traits.stencil[d + 1], ADD_VALUES));
    }
  }
  PetscCall(MatAssemblyBegin(*map, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*map, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The row of one wall node becomes a times that of another register. */
static PetscErrorCode SetWall(MpmRegisters *r, const MpmOp *op, PetscReal a)
{
  const PetscInt  wall = op->side ? r->layout->grid.nodes - 1 : 0;
  const PetscBool mine = wall >= r->first && wall < r->first + r->nodes ? PETSC_TRUE : PETSC_FALSE;
  Mat             only, row;
  Vec             keep;

  PetscFunctionBegin;
  if (!r->node[op->dst]) PetscCall(Empty(r, r->nodes, &r->node[op->dst]));
  PetscCall(MatCreateVecs(r->node[op->dst], NULL, &keep));
  PetscCall(VecSet(keep, 1));
  if (mine) PetscCall(VecSetValue(keep, wall, 0, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(keep));
  PetscCall(VecAssemblyEnd(keep));
  PetscCall(MatDiagonalScale(r->node[op->dst], keep, NULL));
  PetscCall(VecDestroy(&keep));
  if (a == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateAIJ(r->comm, r->nodes, r->nodes, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, &only));
  if (mine) PetscCall(MatSetValue(only, wall, wall, a, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(only, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(only, MAT_FINAL_ASSEMBLY));
  PetscCall(MatMatMult(only, r->node[op->src], MAT_INITIAL_MATRIX, PETSC_DETERMINE, &row));
  PetscCall(MatAXPY(r->node[op->dst], 1, row, DIFFERENT_NONZERO_PATTERN));
  PetscCall(MatDestroy(&row));
  PetscCall(MatDestroy(&only));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* dst = a map src, or dst += a map src. */
static PetscErrorCode Apply(Mat map, PetscReal a, Mat src, PetscBool accumulates, Mat *dst)
{
  Mat product;

  PetscFunctionBegin;
  PetscCall(MatMatMult(map, src, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &product));
  if (accumulates) {
    PetscCall(MatAXPY(*dst, a, product, DIFFERENT_NONZERO_PATTERN));
    PetscCall(MatDestroy(&product));
  } else {
    PetscCall(MatScale(product, a));
    PetscCall(MatDestroy(dst));
    *dst = product;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The maps of a step, each made when it is first used, for symmetric and antisymmetric node fields. */
typedef struct {
  Mat map[MPM_OP_KINDS][2];
} Maps;

static PetscErrorCode MapOf(MpmRegisters *r, const MpmOp *op, PetscInt64 step, Maps *maps, Mat *map)
{
  const MpmOpTraits traits        = MpmOpTraitsOf(op->kind);
  const PetscBool   antisymmetric = r->scheme->table->antisymmetric[traits.dst == MPM_ON_NODES ? op->dst : op->src];
  Mat              *known         = &maps->map[op->kind][antisymmetric ? 1 : 0];

  PetscFunctionBegin;
  if (!*known && op->kind == MPM_SOLVE)
    PetscCall(MpmRegistersSolve(r, antisymmetric, step, known));
  else if (!*known && traits.dst == traits.src)
    PetscCall(Stencil(r, op, antisymmetric, known));
  else if (!*known)
    PetscCall(MpmRegistersMap(r, op->kind, antisymmetric, step, known));
  *map = *known;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyOp(MpmRegisters *r, const MpmOp *op, PetscInt64 step, Maps *maps)
{
  const MpmOpTraits traits   = MpmOpTraitsOf(op->kind);
  const PetscReal   a        = MpmOpValue(op, r->step.courant);
  Mat *const        sides[2] = {r->particle, r->node};
  Mat               map      = NULL;

  PetscFunctionBegin;
  if (traits.dst == MPM_NOWHERE) PetscFunctionReturn(PETSC_SUCCESS);
  if (op->kind == MPM_WALL)
    PetscCall(SetWall(r, op, a));
  else if (op->kind == MPM_SCALE && a == 0)
    PetscCall(Empty(r, r->particles, &r->particle[op->dst]));
  else if (op->kind == MPM_SCALE)
    PetscCall(MatScale(r->particle[op->dst], a));
  else {
    PetscCall(MapOf(r, op, step, maps, &map));
    PetscCall(Apply(map, a, sides[traits.src == MPM_ON_NODES][op->src], op->accumulates,
                    &sides[traits.dst == MPM_ON_NODES][op->dst]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersStep(MpmRegisters *r, PetscInt64 step)
{
  const MpmTable *table = r->scheme->table;
  Maps            maps  = {{{NULL}}};

  PetscFunctionBegin;
  MpmFloatBegin();
  for (PetscInt o = 0; o < table->nops; o++) PetscCall(ApplyOp(r, &table->ops[o], step, &maps));
  for (PetscInt k = 0; k < MPM_OP_KINDS; k++)
    for (int antisymmetric = 0; antisymmetric < 2; antisymmetric++) PetscCall(MatDestroy(&maps.map[k][antisymmetric]));
  PetscCall(MpmFloatEnd(r->comm, &r->float_check, "assembly", step));
  PetscFunctionReturn(PETSC_SUCCESS);
}
