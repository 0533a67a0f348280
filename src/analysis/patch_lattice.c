/*
   The maps of a lattice are products over the directions, and so are the masses. So the matrices of P W are Kronecker
   products of small matrices of one direction each:

     T_ij = sum_p conj(P_pi) W_pj / sqrt(m_i m_j)

   p are the particles in a row and i, j the nodes along it. In a direction without an end there is one node, the rows
   are symbols of a cell's particles, sum_d row_d e^(i beta d).
*/
#include "analysis/patch_lattice.h"
#include "linalg/matrix_polynomial.h"
#include "scheme/maps.h"
#include <math.h>

#define MOST_NODES 128 /* along a direction */
#define ROUNDING 1e-14 /* what a field has besides others is rounding below this part of it */

/*
   nodes, particles - along the direction
   at    - the place of each node, in cells
   root  - the root of its mass
   row   - row[kind][p x nodes + i]: the weight of a map; NULL for kinds that are not in use
   product - product[to_nodes][to_particles]: T of two kinds, by columns; NULL until it is asked for
*/
typedef struct {
  PetscInt        nodes, particles;
  PetscInt       *at;
  PetscReal      *root;
  double complex *row[MPM_OP_KINDS], *product[MPM_OP_KINDS][MPM_OP_KINDS];
} Line;

/*
   The kinds of maps that a plan has along an axis. P2G and G2P are always among them: they weigh the other directions.
*/
static void KindsAlong(const MpmNodalPlan *plan, PetscInt axis, PetscBool used[])
{
  for (PetscInt kind = 0; kind < MPM_OP_KINDS; kind++)
    used[kind] = kind == MPM_P2G || kind == MPM_G2P ? PETSC_TRUE : PETSC_FALSE;
  for (PetscInt m = 0; m < plan->nmaps; m++) {
    const MpmNodalMap *map = &plan->map[m];

    if (map->product && map->to_nodes.axis == axis) used[map->to_nodes.kind] = PETSC_TRUE;
    if (map->product && map->to_particles.axis == axis) used[map->to_particles.kind] = PETSC_TRUE;
  }
}

/* The cell of particle p of a row, and its place there. */
static PetscInt PlaceOf(const MpmPatchSpot *spot, PetscInt axis, PetscInt ppc, PetscInt p, PetscReal *xi)
{
  const PetscInt site = spot->j[axis] + p;

  *xi = ((PetscReal)(site % ppc) + spot->t[axis]) / (PetscReal)ppc;
  return site / ppc;
}

/* The weights of a map at all particles, on nodes from first on. Without an end all nodes are one, with phases. */
static void FillRows(const MpmPatchLattice *l, const MpmPatchSpot *spot, PetscInt axis, PetscInt first, MpmOpKind kind,
                     Line *line)
{
  const MpmBasis *basis = l->of->scheme->basis;
  const PetscBool wave  = l->end[axis] == MPM_PATCH_ENDLESS ? PETSC_TRUE : PETSC_FALSE;

  for (PetscInt p = 0; p < line->particles; p++) {
    PetscReal      xi, weight[MPM_MAX_REACH];
    const PetscInt cell = PlaceOf(spot, axis, l->of->layout->ppc[axis], p, &xi);

    MpmMapRow(basis, kind, xi, l->of->layout->half_width[axis], MpmNoWalls, weight);
    for (PetscInt d = 0; d < MpmMapReach(basis); d++) {
      const PetscInt node = cell - basis->reach_left + d, i = wave ? 0 : node - first;

      if (i < 0 || i >= line->nodes) continue;
      line->row[kind][p * line->nodes + i] += weight[d] * (wave ? cexp(I * (spot->beta[axis] * (PetscReal)node)) : 1);
    }
  }
}

/* Masses of nodes; in a direction without an end that of a cell's particles. */
static void FillMasses(const MpmPatchLattice *l, PetscInt axis, Line *line)
{
  for (PetscInt i = 0; i < line->nodes; i++) {
    PetscReal mass = l->end[axis] == MPM_PATCH_ENDLESS ? (PetscReal)line->particles : 0;

    for (PetscInt p = 0; p < line->particles && l->end[axis] != MPM_PATCH_ENDLESS; p++)
      mass += creal(line->row[MPM_P2G][p * line->nodes + i]);
    line->root[i] = sqrt(mass);
  }
}

/* Takes the nodes without mass out: what a sum over particles gives them is 0. */
static void DropEmpty(Line *line)
{
  PetscInt kept = 0, from[MOST_NODES];

  for (PetscInt i = 0; i < line->nodes; i++)
    if (line->root[i] > 0) from[kept++] = i;
  for (PetscInt kind = 0; kind < MPM_OP_KINDS; kind++)
    for (PetscInt p = 0; p < line->particles && line->row[kind]; p++)
      for (PetscInt i = 0; i < kept; i++) line->row[kind][p * kept + i] = line->row[kind][p * line->nodes + from[i]];
  for (PetscInt i = 0; i < kept; i++) {
    line->at[i]   = line->at[from[i]];
    line->root[i] = line->root[from[i]];
  }
  line->nodes = kept;
}

static PetscErrorCode LineCreate(const MpmPatchLattice *l, const MpmPatchSpot *spot, PetscInt axis, Line *line)
{
  const MpmBasis *basis = l->of->scheme->basis;
  const PetscInt  ppc = l->of->layout->ppc[axis], reach = MpmMapReach(basis);
  PetscBool       used[MPM_OP_KINDS];
  PetscInt        first = -basis->reach_left;

  PetscFunctionBegin;
  *line = (Line){.nodes = 1, .particles = ppc};
  if (l->end[axis] == MPM_PATCH_SURFACE) {
    if (l->held) first = l->depth / 2;
    line->nodes     = l->depth + 1 - first;
    line->particles = (l->depth + reach) * ppc;
  } else if (l->end[axis] == MPM_PATCH_SINGLE) {
    line->nodes     = reach;
    line->particles = 1;
  }
  PetscCheck(line->nodes <= MOST_NODES, PETSC_COMM_SELF, PETSC_ERR_PLIB, "too many nodes in a row");
  PetscCall(PetscMalloc2(line->nodes, &line->at, line->nodes, &line->root));
  for (PetscInt i = 0; i < line->nodes; i++) line->at[i] = i + first;
  KindsAlong(l->plan, axis, used);
  for (PetscInt kind = 0; kind < MPM_OP_KINDS; kind++) {
    if (!used[kind]) continue;
    PetscCall(PetscCalloc1(line->particles * line->nodes, &line->row[kind]));
    FillRows(l, spot, axis, first, (MpmOpKind)kind, line);
  }
  FillMasses(l, axis, line);
  DropEmpty(line);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LineDestroy(Line *line)
{
  PetscFunctionBegin;
  for (PetscInt kind = 0; kind < MPM_OP_KINDS; kind++) {
    if (!line->row[kind]) continue;
    for (PetscInt other = 0; other < MPM_OP_KINDS; other++) PetscCall(PetscFree(line->product[kind][other]));
    PetscCall(PetscFree(line->row[kind]));
  }
  PetscCall(PetscFree2(line->at, line->root));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodes that a particle gives to or reads: from first up to but not end. */
static void Reach(PetscInt n, const double complex row[], PetscInt *first, PetscInt *end)
{
  for (*first = 0; *first < n && row[*first] == 0; ++*first)
    ;
  for (*end = n; *end > *first && row[*end - 1] == 0; --*end)
    ;
}

/* Most maps of a plan have the same kinds along most directions, so each T is computed once. */
static PetscErrorCode Product(Line *line, MpmOpKind to_nodes, MpmOpKind to_particles, const double complex **T)
{
  const double complex *P = line->row[to_nodes], *W = line->row[to_particles];
  const PetscInt        n     = line->nodes;
  double complex      **known = &line->product[to_nodes][to_particles];

  PetscFunctionBegin;
  *T = *known;
  if (*T) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc1(n * n, known));
  for (PetscInt p = 0; p < line->particles; p++) {
    PetscInt i0, i1, j0, j1;

    Reach(n, P + p * n, &i0, &i1);
    Reach(n, W + p * n, &j0, &j1);
    for (PetscInt j = j0; j < j1; j++)
      for (PetscInt i = i0; i < i1; i++) (*known)[j * n + i] += conj(P[p * n + i]) * W[p * n + j];
  }
  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++) (*known)[j * n + i] /= line->root[i] * line->root[j];
  *T = *known;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The second difference along a direction. */
static void Laplacian(const MpmPatchLattice *l, const MpmPatchSpot *spot, PetscInt axis, const MpmOp *op,
                      const Line *line, double complex T[])
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscInt    n      = line->nodes;

  for (PetscInt c = 0; c < n * n; c++) T[c] = 0;
  for (PetscInt s = -1; s <= 1; s++)
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++) {
        if (l->end[axis] == MPM_PATCH_ENDLESS)
          T[0] += traits.stencil[s + 1] * cexp(I * (spot->beta[axis] * (PetscReal)s));
        else if (line->at[j] == line->at[i] + s)
          T[j * n + i] += traits.stencil[s + 1] * line->root[i] / line->root[j];
      }
}

/* out += T_2 x T_1 x T_0, Kronecker; direction 0 counts first. */
static void AddKronecker(PetscInt dim, const Line line[], const double complex *const T[], double complex out[])
{
  const PetscInt n0 = line[0].nodes, n1 = dim > 1 ? line[1].nodes : 1, n2 = dim > 2 ? line[2].nodes : 1;
  const PetscInt n = n0 * n1 * n2;

  for (PetscInt j2 = 0; j2 < n2; j2++)
    for (PetscInt j1 = 0; j1 < n1; j1++)
      for (PetscInt i2 = 0; i2 < n2; i2++)
        for (PetscInt i1 = 0; i1 < n1; i1++) {
          const double complex scale = (dim > 1 ? T[1][j1 * n1 + i1] : 1) * (dim > 2 ? T[2][j2 * n2 + i2] : 1);

          for (PetscInt j0 = 0; j0 < n0; j0++) {
            double complex *column = out + ((j2 * n1 + j1) * n0 + j0) * n + (i2 * n1 + i1) * n0;

            for (PetscInt i0 = 0; i0 < n0; i0++) column[i0] += scale * T[0][j0 * n0 + i0];
          }
        }
}

static void Identity(PetscInt n, double complex T[])
{
  for (PetscInt c = 0; c < n; c++)
    for (PetscInt i = 0; i < n; i++) T[c * n + i] = i == c ? 1 : 0;
}

/* A spot, its nodes and particles along the directions, and room for a matrix of each direction. */
typedef struct {
  const MpmPatchLattice *l;
  const MpmPatchSpot    *spot;
  Line                   line[MPM_MAX_DIM];
  double complex        *room[MPM_MAX_DIM];
  PetscInt               nodes, rank; /* rank: of the fields of a lone particle */
  PetscReal             *basis, *field[2];
} Spot;

/* The matrix of one of the plan's maps. */
static PetscErrorCode MapOf(void *context, const MpmNodalMap *map, double complex out[])
{
  Spot                 *s   = context;
  const PetscInt        dim = s->l->plan->dim;
  const MpmOp          *P = &map->to_nodes, *W = &map->to_particles;
  const double complex *T[MPM_MAX_DIM] = {s->room[0], s->room[1], s->room[2]};

  PetscFunctionBegin;
  PetscCheck(map->product || P->kind == MPM_LAP, PETSC_COMM_SELF, PETSC_ERR_SUP, "SOLVE in a patch");
  for (PetscInt a = 0; a < dim; a++) {
    if (map->product)
      PetscCall(Product(&s->line[a], MpmKindAlong(P->kind, P->axis, a), a == W->axis ? W->kind : MPM_G2P, &T[a]));
    else if (a == P->axis)
      Laplacian(s->l, s->spot, a, P, &s->line[a], s->room[a]);
    else
      Identity(s->line[a].nodes, s->room[a]);
  }
  AddKronecker(dim, s->line, T, out);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- a lone particle ---- */

/*
   What a particle without a neighbour gives to nodes, and what it reads of them, are few fields of the nodes: a product
   of its weights, and one for each gradient or distance. All other fields of the nodes stay what they are.
*/
static PetscBool IsLone(const MpmPatchLattice *l)
{
  for (PetscInt a = 0; a < l->plan->dim; a++)
    if (l->end[a] != MPM_PATCH_SINGLE) return PETSC_FALSE;
  for (PetscInt m = 0; m < l->plan->nmaps; m++)
    if (!l->plan->map[m].product) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The weights of a map over the roots of the masses; other: the kind along the other directions than axis. */
static void FieldOf(PetscInt dim, const Line line[], MpmOpKind kind, PetscInt axis, MpmOpKind other, PetscReal field[])
{
  PetscInt n = 1;

  field[0] = 1;
  for (PetscInt a = 0; a < dim; a++) {
    const double complex *row = line[a].row[a == axis ? kind : other];

    for (PetscInt i = line[a].nodes - 1; i >= 0; i--)
      for (PetscInt j = 0; j < n; j++) field[i * n + j] = field[j] * creal(row[i]) / line[a].root[i];
    n *= line[a].nodes;
  }
}

static PetscReal Dot(PetscInt n, const PetscReal a[], const PetscReal b[])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* Adds what a field has besides the orthonormal fields of a basis to the basis. */
static void Widen(PetscInt n, const PetscReal field[], PetscInt *rank, PetscReal basis[])
{
  PetscReal *rest = basis + *rank * n, norm;

  if (*rank == n) return;
  for (PetscInt i = 0; i < n; i++) rest[i] = field[i];
  for (PetscInt twice = 0; twice < 2; twice++)
    for (PetscInt r = 0; r < *rank; r++) {
      const PetscReal share = Dot(n, basis + r * n, rest);

      for (PetscInt i = 0; i < n; i++) rest[i] -= share * basis[r * n + i];
    }
  norm = sqrt(Dot(n, rest, rest));
  if (norm <= ROUNDING * sqrt(Dot(n, field, field))) return;
  for (PetscInt i = 0; i < n; i++) rest[i] /= norm;
  ++*rank;
}

/* The fields of a product of maps: field[0] is what it gives to nodes and field[1] what it reads of them. */
static void FieldsOf(const Spot *s, const MpmNodalMap *map)
{
  const PetscInt dim = s->l->plan->dim;

  FieldOf(dim, s->line, map->to_nodes.kind, map->to_nodes.axis, MPM_P2G, s->field[0]);
  FieldOf(dim, s->line, map->to_particles.kind, map->to_particles.axis, MPM_G2P, s->field[1]);
}

/* A basis of all fields, of rank fields. */
static void FindBasis(Spot *s)
{
  const MpmNodalPlan *plan = s->l->plan;

  for (PetscInt m = 0; m < plan->nmaps; m++) {
    FieldsOf(s, &plan->map[m]);
    for (int i = 0; i < 2; i++) Widen(s->nodes, s->field[i], &s->rank, s->basis);
  }
}

/* The matrix of a map on these fields alone: rank x rank. */
static PetscErrorCode LoneMapOf(void *context, const MpmNodalMap *map, double complex out[])
{
  Spot          *s    = context;
  const PetscInt rank = s->rank;

  PetscFunctionBegin;
  FieldsOf(s, map);
  for (PetscInt c = 0; c < rank; c++) {
    const PetscReal part = Dot(s->nodes, s->basis + c * s->nodes, s->field[1]);

    for (PetscInt r = 0; r < rank; r++) out[c * rank + r] = part * Dot(s->nodes, s->basis + r * s->nodes, s->field[0]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the operator ---- */

PetscErrorCode MpmPatchPlanCreate(const MpmScheme *scheme, MpmNodalPlan **plan)
{
  MpmSpace  space = scheme->space;
  MpmTable *table;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) space.ends[a][0] = space.ends[a][1] = MPM_PERIODIC;
  PetscCall(MpmTableCreate(scheme->formulation, scheme->transfer, &scheme->numbers, &space, &table));
  PetscCall(MpmNodalPlanCreate(table, NULL, plan));
  PetscCall(MpmTableDestroy(&table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPatchOperator(const MpmPatchLattice *l, const MpmPatchSpot *spot, PetscInt *n,
                                double complex *coefficient[], PetscReal *unseen)
{
  const MpmNodalPlan *plan = l->plan;
  const PetscBool     lone = IsLone(l);
  Spot                s    = {.l = l, .spot = spot, .nodes = 1};
  PetscInt            square;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < plan->dim; a++) {
    PetscCall(LineCreate(l, spot, a, &s.line[a]));
    PetscCall(PetscMalloc1(s.line[a].nodes * s.line[a].nodes, &s.room[a]));
    s.nodes *= s.line[a].nodes;
  }
  square = lone ? s.nodes * s.nodes : 0;
  PetscCall(PetscMalloc3(square, &s.basis, s.nodes, &s.field[0], s.nodes, &s.field[1]));
  if (lone) FindBasis(&s);
  *n      = plan->nimages * (lone ? s.rank : s.nodes);
  *unseen = 0;
  for (PetscInt g = 0; g < plan->nimages && *n < plan->nimages * s.nodes; g++)
    *unseen = PetscMax(*unseen, PetscAbsReal(plan->image[g].c));
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscMalloc1(*n * *n, &coefficient[j]));
  PetscCall(MpmNodalRun(plan, *n / plan->nimages, lone ? LoneMapOf : MapOf, &s, coefficient));
  PetscCall(PetscFree3(s.basis, s.field[0], s.field[1]));
  for (PetscInt a = 0; a < plan->dim; a++) {
    PetscCall(PetscFree(s.room[a]));
    PetscCall(LineDestroy(&s.line[a]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPatchCrossing(MpmPatchLattice *l, const MpmPatchSpot *spot, PetscReal *courant)
{
  const PetscInt  degree = l->plan->degree;
  double complex *c[64];
  PetscInt        n;
  PetscReal       x, unseen;

  PetscFunctionBegin;
  PetscCall(MpmPatchOperator(l, spot, &n, c, &unseen));
  for (PetscInt i = 0; i < n; i++) c[0][i * n + i] += 1;
  PetscCall(MpmPolynomialSingular(n, degree, c, &x));
  *courant = l->plan->stride == 2 ? sqrt(x) : x;
  for (PetscInt j = 0; j <= degree; j++) PetscCall(PetscFree(c[j]));
  l->count++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The polynomial at x, which takes the place of its first coefficient; returns the largest sum of abs in a row. */
static PetscReal Evaluate(PetscInt n, PetscInt degree, PetscReal x, double complex *const c[])
{
  PetscReal norm = 0;

  for (PetscInt row = 0; row < n; row++) {
    PetscReal sum = 0;

    for (PetscInt i = row; i < n * n; i += n) {
      double complex value = 0;

      for (PetscInt j = degree; j >= 0; j--) value = value * x + c[j][i];
      c[0][i] = value;
      sum += cabs(value);
    }
    norm = PetscMax(norm, sum);
  }
  return norm;
}

PetscErrorCode MpmPatchGrowth(MpmPatchLattice *l, const MpmPatchSpot *spot, PetscReal courant, PetscReal *growth,
                              PetscReal *rounding)
{
  const PetscInt  degree = l->plan->degree;
  double complex *c[64];
  PetscInt        n;
  PetscReal       norm, unseen;

  PetscFunctionBegin;
  PetscCall(MpmPatchOperator(l, spot, &n, c, &unseen));
  norm      = Evaluate(n, degree, l->plan->stride == 2 ? courant * courant : courant, c);
  *rounding = MpmDefectiveErrorOf(MpmOperatorErrorOf(norm, 0, 0), 0, 1);
  PetscCall(MpmPolynomialRadius(n, c[0], growth));
  *growth = PetscMax(*growth, unseen);
  for (PetscInt j = 0; j <= degree; j++) PetscCall(PetscFree(c[j]));
  l->count++;
  PetscFunctionReturn(PETSC_SUCCESS);
}
