/*
   The assemble reader: an operation of the table is a sparse product, q(t+1) = A(x_t) q(t).

     particle -> node       g = M^-1 S^T q      S: phi_ip, M: nodal masses
     node -> particle       q += a S g,  q += a D g     D: h dphi_ip/dx
     node -> node           g = a L f,   g += f         L: the operation's stencil
*/
#include <mpmstab/assemble.h>
#include <mpmstab/layout.h>

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

PetscErrorCode MpmRegistersCreate(MPI_Comm comm, const MpmScene *scene, MpmRegisters *r)
{
  PetscMPIInt rank, size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  *r       = (MpmRegisters){.comm = comm, .scene = scene};
  r->cells = scene->cells / size + (scene->cells % size > rank ? 1 : 0); /* as DMDA gives them */
  r->first = 0;
  PetscCallMPI(MPI_Exscan(&r->cells, &r->first, 1, MPIU_INT, MPI_SUM, comm));
  r->fields    = MpmFormulationParticleFields(scene->formulation);
  r->nodes     = MpmFormulationNodeFields(scene->formulation);
  r->particles = r->cells * scene->ppc;
  r->state     = r->particles * r->fields;
  for (PetscInt f = 0; f < r->fields; f++) PetscCall(Identity(r, f, &r->particle[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersDestroy(MpmRegisters *r)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < r->fields; f++) PetscCall(MatDestroy(&r->particle[f]));
  for (PetscInt f = 0; f < r->nodes; f++) PetscCall(MatDestroy(&r->node[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rows are particles in the order of their ids. Nodes that a short grid's wrap makes one add up. */
static PetscErrorCode ParticlesByNodes(const MpmRegisters *r, MpmOpKind kind, PetscInt64 step, Mat *map)
{
  const MpmScene *scene = r->scene;
  const PetscInt  reach = MpmMapReach(scene->basis), own = PetscMin(reach, r->cells);
  const PetscInt  far = PetscMin(reach, scene->cells - r->cells);

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, r->particles, r->cells, PETSC_DETERMINE, PETSC_DETERMINE, own, NULL, far, NULL, map));
  for (PetscInt p = 0; p < r->particles; p++) {
    const PetscInt id = r->first * scene->ppc + p;
    PetscInt       cell, columns[MPM_MAX_REACH];
    PetscReal      xi, row[MPM_MAX_REACH];

    MpmLayoutPlaceAt(scene, id, step, &cell, &xi);
    MpmMapRow(scene->basis, kind, xi, row);
    for (PetscInt d = 0; d < reach; d++) {
      const PetscInt node = (cell - scene->basis->reach_left + d) % scene->cells;

      columns[d] = node < 0 ? node + scene->cells : node;
    }
    PetscCall(MatSetValues(*map, 1, &id, reach, columns, row, ADD_VALUES));
  }
  PetscCall(MatAssemblyBegin(*map, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*map, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersMap(const MpmRegisters *r, MpmOpKind kind, PetscInt64 step, Mat *map)
{
  Mat        shape;
  Vec        ones, mass;
  PetscReal *m;

  PetscFunctionBegin;
  if (MpmOpTraitsOf(kind).dst == MPM_ON_PARTICLES) {
    PetscCall(ParticlesByNodes(r, kind, step, map));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ParticlesByNodes(r, kind, step, &shape));
  PetscCall(MatCreateVecs(shape, &mass, &ones));
  PetscCall(VecSet(ones, 1));
  PetscCall(MatMultTranspose(shape, ones, mass));
  PetscCall(VecGetArray(mass, &m));
  for (PetscInt i = 0; i < r->cells; i++) m[i] = m[i] > 0 ? 1 / m[i] : 0;
  PetscCall(VecRestoreArray(mass, &m));
  PetscCall(MatDiagonalScale(shape, NULL, mass));
  PetscCall(MatTranspose(shape, MAT_INITIAL_MATRIX, map));
  PetscCall(VecDestroy(&ones));
  PetscCall(VecDestroy(&mass));
  PetscCall(MatDestroy(&shape));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Stencil(const MpmRegisters *r, MpmOpKind kind, Mat *map)
{
  const MpmOpTraits traits = MpmOpTraitsOf(kind);

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, r->cells, r->cells, PETSC_DETERMINE, PETSC_DETERMINE, PetscMin(3, r->cells), NULL,
                         PetscMin(2, r->scene->cells - r->cells), NULL, map));
  for (PetscInt i = r->first; i < r->first + r->cells; i++)
    for (PetscInt d = -traits.halo; d <= traits.halo; d++)
      PetscCall(MatSetValue(*map, i, (i + d + r->scene->cells) % r->scene->cells, traits.stencil[d + 1], ADD_VALUES));
  PetscCall(MatAssemblyBegin(*map, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*map, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* dst = a map src, or dst += a map src. */
static PetscErrorCode Apply(Mat map, PetscReal a, Mat src, PetscBool accumulates, Mat *dst)
{
  Mat product;

  PetscFunctionBegin;
  PetscCall(MatMatMult(map, src, MAT_INITIAL_MATRIX, PETSC_DEFAULT, &product));
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

PetscErrorCode MpmRegistersStep(MpmRegisters *r, PetscInt64 step)
{
  const MpmFormulation *f                   = r->scene->formulation;
  Mat                   maps[MPM_DRIFT + 1] = {NULL};

  PetscFunctionBegin;
  for (PetscInt o = 0; o < f->nops; o++) {
    const MpmOp      *op           = &f->ops[o];
    const MpmOpTraits traits       = MpmOpTraitsOf(op->kind);
    const PetscReal   a            = MpmCoefficientValue(op->coefficient, r->scene->courant);
    Mat *const        sides[2]     = {r->particle, r->node};
    const PetscBool   between_them = traits.dst != traits.src ? PETSC_TRUE : PETSC_FALSE;

    if (traits.dst == MPM_NOWHERE) continue;
    if (!maps[op->kind] && between_them) PetscCall(MpmRegistersMap(r, op->kind, step, &maps[op->kind]));
    if (!maps[op->kind]) PetscCall(Stencil(r, op->kind, &maps[op->kind]));
    PetscCall(Apply(maps[op->kind], a, sides[traits.src == MPM_ON_NODES][op->src], traits.accumulates,
                    &sides[traits.dst == MPM_ON_NODES][op->dst]));
  }
  for (PetscInt k = 0; k <= MPM_DRIFT; k++) PetscCall(MatDestroy(&maps[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers of each row of A in this rank's and in other ranks' columns. */
static PetscErrorCode CountRows(const MpmRegisters *r, PetscInt begin, PetscInt end, PetscInt own[], PetscInt far[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < r->fields; f++) {
    PetscInt first;

    PetscCall(MatGetOwnershipRange(r->particle[f], &first, NULL));
    for (PetscInt p = 0; p < r->particles; p++) {
      const PetscInt  row = r->fields * p + f;
      const PetscInt *columns;
      PetscInt        n;

      PetscCall(MatGetRow(r->particle[f], first + p, &n, &columns, NULL));
      own[row] = far[row] = 0;
      for (PetscInt c = 0; c < n; c++)
        if (columns[c] >= begin && columns[c] < end)
          own[row]++;
        else
          far[row]++;
      PetscCall(MatRestoreRow(r->particle[f], first + p, &n, &columns, NULL));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyRows(const MpmRegisters *r, Mat A)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < r->fields; f++) {
    PetscInt begin, end;

    PetscCall(MatGetOwnershipRange(r->particle[f], &begin, &end));
    for (PetscInt p = begin; p < end; p++) {
      const PetscInt     row = r->fields * p + f;
      const PetscInt    *columns;
      const PetscScalar *values;
      PetscInt           n;

      PetscCall(MatGetRow(r->particle[f], p, &n, &columns, &values));
      PetscCall(MatSetValues(A, 1, &row, n, columns, values, INSERT_VALUES));
      PetscCall(MatRestoreRow(r->particle[f], p, &n, &columns, &values));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersGather(const MpmRegisters *r, Mat *A)
{
  PetscInt *own, *far, begin, end;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRangeColumn(r->particle[0], &begin, &end));
  PetscCall(PetscMalloc2(r->state, &own, r->state, &far));
  PetscCall(CountRows(r, begin, end, own, far));
  PetscCall(MatCreateAIJ(r->comm, r->state, r->state, PETSC_DETERMINE, PETSC_DETERMINE, 0, own, 0, far, A));
  PetscCall(PetscFree2(own, far));
  PetscCall(CopyRows(r, *A));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}
