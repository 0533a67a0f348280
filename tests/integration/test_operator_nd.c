/*
   Operators in two and three dimensions: their growth on small grids is that of an independent program. A scene and its
   image under an exchange of axes and reflections take steps that are images of one another. P and S waves along an
   axis take the steps of the one-dimensional scene. Between walls of symmetry is half of a periodic domain.
*/
#include "oracle.h"
#include "base/hash.h"
#include "linalg/dense.h"
#include <mpmstab/operator.h>
#include <stdlib.h>

static int         largest_order = 350;
static PetscMPIInt ranks; /* more ranks take a part of the schemes: every second, or every third */

static PetscErrorCode OperatorOf(const char options[], MpmScene **scene, MpmOperator **op)
{
  PetscFunctionBegin;
  PetscCall(CheckScene(options, scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &(*scene)->layout, &(*scene)->scheme, &(*scene)->step, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Close(MpmScene **scene, MpmOperator **op)
{
  PetscFunctionBegin;
  PetscCall(MpmOperatorDestroy(op));
  PetscCall(MpmSceneDestroy(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Replaces a state, which every rank holds whole, by its image after a step or a period. */
static PetscErrorCode Advance(const MpmOperator *op, PetscReal state[])
{
  Vec              q, image, whole;
  VecScatter       gather;
  PetscInt         begin, end;
  PetscReal       *own;
  const PetscReal *all;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(op->A, &q, &image));
  PetscCall(VecGetOwnershipRange(q, &begin, &end));
  PetscCall(VecGetArrayWrite(q, &own));
  PetscCall(PetscArraycpy(own, state + begin, end - begin));
  PetscCall(VecRestoreArrayWrite(q, &own));
  PetscCall(MatMult(op->A, q, image));
  PetscCall(VecScatterCreateToAll(image, &gather, &whole));
  PetscCall(VecScatterBegin(gather, image, whole, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(gather, image, whole, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArrayRead(whole, &all));
  for (PetscInt i = 0; i < op->order; i++) state[i] = scalbn(all[i], (int)op->exponent);
  PetscCall(VecRestoreArrayRead(whole, &all));
  PetscCall(VecScatterDestroy(&gather));
  PetscCall(VecDestroy(&whole));
  PetscCall(VecDestroy(&q));
  PetscCall(VecDestroy(&image));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The two axes of a register's number; a vector has only the first, and a number none. */
static PetscInt AxesOf(const MpmTable *table, const MpmFormulation *f, PetscInt r, PetscInt axis[2])
{
  const PetscInt field = table->field[r], dim = table->dim;
  PetscInt       c = table->component[r];

  if (field == MPM_NONE) {
    axis[0] = c / dim;
    axis[1] = c % dim;
    return 2;
  }
  axis[0] = c;
  if (f->particle_ranks[field] == MPM_VECTOR) return 1;
  if (f->particle_ranks[field] == MPM_SCALAR || strlen(table->fields[r]) == 1) return 0; /* the pressure of a fluid */
  axis[0] = table->fields[r][2] - 'x';
  axis[1] = table->fields[r][3] - 'x';
  return 2;
}

/* An image of a scene: axis a becomes to[a], and is turned round where sign[a] is -1. */
typedef struct {
  PetscInt to[MPM_MAX_DIM], sign[MPM_MAX_DIM];
} Image;

static PetscInt RegisterOfImage(const MpmScene *scene, PetscInt r, const Image *image, PetscReal *sign)
{
  const MpmTable *table = scene->scheme.table;
  PetscInt        axis[2], other[2], n = AxesOf(table, scene->scheme.formulation, r, axis);

  *sign = 1;
  for (PetscInt i = 0; i < n; i++) *sign *= (PetscReal)image->sign[axis[i]];
  for (PetscInt o = 0; o < table->nstate; o++) {
    PetscBool same = table->field[o] == table->field[r] ? PETSC_TRUE : PETSC_FALSE;

    if (!same || AxesOf(table, scene->scheme.formulation, o, other) != n) continue;
    if (n == 0 || (n == 1 && other[0] == image->to[axis[0]])) return o;
    if (n == 2 && other[0] == image->to[axis[0]] && other[1] == image->to[axis[1]]) return o;
    if (n == 2 && table->field[r] != MPM_NONE && other[1] == image->to[axis[0]] && other[0] == image->to[axis[1]])
      return o; /* a stress is symmetric */
  }
  return -1;
}

static PetscInt64 ParticleOfImage(const MpmLayout *from, const MpmLayout *to, PetscInt64 id, const Image *image)
{
  PetscInt64 place[MPM_MAX_DIM], other = 0;

  for (PetscInt a = 0; a < from->dim; a++) {
    const PetscInt64 i = id % from->row[a];

    place[image->to[a]] = image->sign[a] > 0 ? i : from->row[a] - 1 - i;
    id /= from->row[a];
  }
  for (PetscInt a = to->dim - 1; a >= 0; a--) other = other * to->row[a] + place[a];
  return other;
}

/* The image of a state. */
static void MapState(const MpmScene *from, const MpmScene *to, const Image *image, const PetscReal q[], PetscReal w[])
{
  const PetscInt fields = from->scheme.table->nstate;

  for (PetscInt64 id = 0; id < from->layout.particles; id++)
    for (PetscInt f = 0; f < fields; f++) {
      PetscReal        sign;
      const PetscInt   g     = RegisterOfImage(from, f, image, &sign);
      const PetscInt64 other = ParticleOfImage(&from->layout, &to->layout, id, image);

      w[fields * other + g] = sign * q[fields * id + f];
    }
}

static void Random(PetscInt n, PetscReal q[])
{
  for (PetscInt i = 0; i < n; i++) q[i] = MpmHash(17, i) - 0.5;
}

static PetscReal Farthest(PetscInt n, const PetscReal a[], const PetscReal b[])
{
  PetscReal farthest = 0;

  for (PetscInt i = 0; i < n; i++)
    if (!(fabs(a[i] - b[i]) <= farthest)) farthest = fabs(a[i] - b[i]);
  return farthest;
}

/* A step of a scene's image is the image of its step. */
static PetscErrorCode CheckImage(const char scheme[], const char options[], const char others[], Image image)
{
  char         first[512], second[512];
  MpmScene    *scene[2];
  MpmOperator *op[2];
  PetscReal   *q, *w, *x, farthest;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(first, sizeof first, "%s %s", scheme, options));
  PetscCall(PetscSNPrintf(second, sizeof second, "%s %s", scheme, others));
  PetscCall(OperatorOf(first, &scene[0], &op[0]));
  PetscCall(OperatorOf(second, &scene[1], &op[1]));
  PetscCall(PetscMalloc3(op[0]->order, &q, op[0]->order, &w, op[0]->order, &x));
  Random(op[0]->order, q);
  MapState(scene[0], scene[1], &image, q, w);
  PetscCall(Advance(op[0], q));
  PetscCall(Advance(op[1], w));
  MapState(scene[0], scene[1], &image, q, x);
  farthest = Farthest(op[0]->order, w, x);
  CHECK(farthest <= 2e-14 * op[0]->period, "%s and %s: %.3g", first, others, farthest);
  PetscCall(PetscFree3(q, w, x));
  PetscCall(Close(&scene[0], &op[0]));
  PetscCall(Close(&scene[1], &op[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckImages(void)
{
  static const Image       exchange = {{1, 0, 2}, {1, 1, 1}}, turn = {{0, 1, 2}, {-1, 1, 1}};
  static const Image       both = {{1, 0, 2}, {-1, 1, 1}}, cycle = {{1, 2, 0}, {1, 1, -1}};
  static const char *const schemes[] = {"-formulation usl -basis quadratic",
                                        "-formulation usavg -transfer apic -basis gimp",
                                        "-formulation musl -transfer xpic -poisson 0.5",
                                        "-formulation usf -transfer apic -gradient mls -basis cubic",
                                        "-formulation gas2 -transfer blend",
                                        "-formulation gas1 -basis quadratic -gradient mls",
                                        "-formulation elastic -transfer nullspace"};

  PetscFunctionBegin;
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(schemes); s += ranks) {
    PetscCall(CheckImage(schemes[s], "-dim 2 -cells 4,3 -ppc 1,2 -offset 0.2,0.5",
                         "-dim 2 -cells 3,4 -ppc 2,1 -offset 0.5,0.2", exchange));
    PetscCall(CheckImage(schemes[s], "-dim 2 -cells 4,3 -ppc 1,2 -drift 1/3,1/2",
                         "-dim 2 -cells 3,4 -ppc 2,1 -drift 1/2,-1/3", both));
    PetscCall(CheckImage(schemes[s], "-dim 2 -cells 3,4 -ppc 2,1 -drift 1/3,0",
                         "-dim 2 -cells 3,4 -ppc 2,1 -drift -1/3,0", turn));
    PetscCall(CheckImage(schemes[s], "-dim 3 -cells 3,3,2 -ppc 1,1,2 -drift 1/3,0,-1/3",
                         "-dim 3 -cells 2,3,3 -ppc 2,1,1 -drift 1/3,1/3,0", cycle));
    if (strstr(schemes[s], "gas")) continue;
    PetscCall(CheckImage(schemes[s], "-dim 2 -cells 4,3 -boundary fixed-free,symmetry-fixed_reaction",
                         "-dim 2 -cells 3,4 -boundary symmetry-fixed_reaction,free-fixed", both));
    PetscCall(CheckImage(schemes[s], "-dim 3 -cells 2,3,2 -ppc 1,2,1 -boundary fixed,periodic,symmetry-free",
                         "-dim 3 -cells 2,2,3 -ppc 1,1,2 -boundary free-symmetry,fixed,periodic", cycle));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The register that takes the part of register r of the one-dimensional scene in a wave along axis, polarised along
   another axis: for a P wave they are the same.
*/
static PetscInt RegisterOfWave(const MpmScene *scene, const MpmScene *line, PetscInt r, PetscInt axis, PetscInt along)
{
  const MpmTable *table = scene->scheme.table;
  const PetscInt  field = line->scheme.table->field[r];

  for (PetscInt o = 0; o < table->nstate; o++) {
    PetscInt       other[2];
    const PetscInt n = table->field[o] == field ? AxesOf(table, scene->scheme.formulation, o, other) : -1;

    if (n == 0 || (n == 1 && other[0] == along)) return o;
    if (n == 2 && field == MPM_NONE && other[0] == along && other[1] == axis) return o;
    if (n == 2 && field != MPM_NONE && other[0] == PetscMin(axis, along) && other[1] == PetscMax(axis, along)) return o;
  }
  return -1;
}

/*
   A wave along an axis takes the steps of the one-dimensional scene: a P wave at its Courant number, an S wave at sqrt(mu)
   times it, with the stress in units of sqrt(mu).
*/
static PetscErrorCode CheckWave(const char scheme[], const char options[], const char line_options[], PetscInt axis,
                                PetscInt along)
{
  char         all[512], one[512];
  MpmScene    *scene, *line;
  MpmOperator *op, *line_op;
  PetscReal   *q, *w, farthest = 0;
  PetscReal    unit;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof all, "%s -courant 0.4 %s", scheme, options));
  PetscCall(OperatorOf(all, &scene, &op));
  unit = along == axis ? 1 : sqrt((1 - 2 * scene->scheme.space.poisson) / (2 * (1 - scene->scheme.space.poisson)));
  PetscCall(PetscSNPrintf(one, sizeof one, "%s -courant %.17g %s", scheme, 0.4 * unit, line_options));
  PetscCall(OperatorOf(one, &line, &line_op));
  PetscCall(PetscCalloc2(op->order, &q, line_op->order, &w));
  Random(line_op->order, w);
  for (int after = 0; after < 2; after++) {
    for (PetscInt64 id = 0, stride = 1; id < scene->layout.particles; id++, stride = 1) {
      for (PetscInt a = 0; a < axis; a++) stride *= scene->layout.row[a];
      for (PetscInt r = 0; r < line_op->fields; r++) {
        const PetscInt  field = line->scheme.table->field[r], g = RegisterOfWave(scene, line, r, axis, along);
        const PetscBool stress = field != MPM_NONE && line->scheme.formulation->particle_ranks[field] == MPM_TENSOR
                                     ? PETSC_TRUE
                                     : PETSC_FALSE;
        const PetscReal value  = w[line_op->fields * (id / stride % scene->layout.row[axis]) + r] * (stress ? unit : 1);

        if (after)
          farthest = PetscMax(farthest, fabs(q[op->fields * id + g] - value));
        else
          q[op->fields * id + g] = value;
      }
    }
    if (after) break;
    PetscCall(Advance(op, q));
    PetscCall(Advance(line_op, w));
  }
  CHECK(farthest <= 2e-14 * op->period, "%s, and %s: %.3g", all, one, farthest);
  PetscCall(PetscFree2(q, w));
  PetscCall(Close(&scene, &op));
  PetscCall(Close(&line, &line_op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckWaves(void)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++) {
      const char *gradient = t % 2 ? "mls" : "basis";
      char        scheme[256];

      if (MpmTransfers[t]->affine && MpmFormulations[f]->affine == MPM_NONE) continue;
      if ((f + t) % ranks) continue;
      PetscCall(PetscSNPrintf(scheme, sizeof scheme, "-formulation %s -transfer %s -basis %s %s %s",
                              MpmFormulations[f]->name, MpmTransfers[t]->name, MpmBases[(f + t) % 4]->name,
                              MpmFormulationHas(MpmFormulations[f], MPM_GRAD) ? "-gradient" : "",
                              MpmFormulationHas(MpmFormulations[f], MPM_GRAD) ? gradient : ""));
      PetscCall(CheckWave(scheme, "-dim 2 -cells 4,3 -ppc 2,1 -drift 1/3,0", "-cells 4 -ppc 2 -drift 1/3", 0, 0));
      PetscCall(
          CheckWave(scheme, "-dim 3 -cells 2,2,4 -ppc 1,2,1 -offset 0.5,0,0.25", "-cells 4 -ppc 1 -offset 0.25", 2, 2));
      if (MpmFormulations[f]->affine == MPM_NONE) continue;
      PetscCall(CheckWave(scheme, "-dim 2 -cells 4,3 -ppc 2,1 -drift 1/4,0", "-cells 4 -drift 1/4", 0, 1));
      PetscCall(CheckWave(scheme, "-dim 3 -cells 2,4,2 -ppc 1,2,1 -poisson 0.1", "-cells 4", 1, 2));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Between walls of symmetry at both ends of x is half of a periodic domain with the mirror images of all particles. */
static PetscErrorCode CheckSymmetry(const char scheme[], const char options[], const char others[])
{
  static const Image turn = {{0, 1, 2}, {-1, 1, 1}};
  char               half[512], whole[512];
  MpmScene          *scene[2];
  MpmOperator       *op[2];
  PetscReal         *q, *w, farthest = 0;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(half, sizeof half, "%s %s", scheme, options));
  PetscCall(PetscSNPrintf(whole, sizeof whole, "%s %s", scheme, others));
  PetscCall(OperatorOf(half, &scene[0], &op[0]));
  PetscCall(OperatorOf(whole, &scene[1], &op[1]));
  CHECK(op[1]->order == 2 * op[0]->order, "%s: orders %d and %d", half, (int)op[0]->order, (int)op[1]->order);
  PetscCall(PetscMalloc2(op[0]->order, &q, op[1]->order, &w));
  Random(op[0]->order, q);
  for (int after = 0; after < 2; after++) {
    const PetscInt row = (PetscInt)scene[0]->layout.row[0], fields = op[0]->fields;

    for (PetscInt id = 0; id < scene[0]->layout.particles; id++)
      for (PetscInt r = 0; r < fields; r++) {
        const PetscInt place = id / row * 2 * row + id % row, mirrored = id / row * 2 * row + 2 * row - 1 - id % row;
        PetscReal      sign;

        PetscCheck(RegisterOfImage(scene[0], r, &turn, &sign) == r, PETSC_COMM_SELF, PETSC_ERR_PLIB, "%d", (int)r);
        if (after) {
          farthest = PetscMax(farthest, fabs(w[fields * place + r] - q[fields * id + r]));
          farthest = PetscMax(farthest, fabs(w[fields * mirrored + r] - sign * q[fields * id + r]));
        } else {
          w[fields * place + r]    = q[fields * id + r];
          w[fields * mirrored + r] = sign * q[fields * id + r];
        }
      }
    if (after) break;
    PetscCall(Advance(op[0], q));
    PetscCall(Advance(op[1], w));
  }
  CHECK(farthest <= 2e-14, "%s, and %s: %.3g", half, whole, farthest);
  PetscCall(PetscFree2(q, w));
  PetscCall(Close(&scene[0], &op[0]));
  PetscCall(Close(&scene[1], &op[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckSymmetries(void)
{
  static const char *const schemes[] = {"-formulation usl -basis quadratic",
                                        "-formulation usavg -transfer apic -basis cubic",
                                        "-formulation musl -transfer nullspace -gradient mls -basis quadratic",
                                        "-formulation usf -transfer xpic -poisson 0.5"};

  PetscFunctionBegin;
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(schemes); s += ranks) {
    PetscCall(CheckSymmetry(schemes[s], "-dim 2 -cells 4,3 -boundary symmetry,fixed-free",
                            "-dim 2 -cells 8,3 -boundary periodic,fixed-free"));
    PetscCall(CheckSymmetry(schemes[s], "-dim 3 -cells 2,3,2 -ppc 2,1,1 -boundary symmetry,periodic,fixed",
                            "-dim 3 -cells 4,3,2 -ppc 2,1,1 -boundary periodic,periodic,fixed"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The defective eigenvalues 1 of elastic and of gases split by rounding. */
static PetscErrorCode CheckGrowth(const char row[], const char options[], PetscReal oracle)
{
  MpmScene    *scene;
  MpmOperator *op;
  PetscReal    value[2], growth;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  if (scene->scheme.table->nstate * scene->layout.particles > largest_order) {
    PetscCall(MpmSceneDestroy(&scene));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmDenseLargest(op->A, value));
  growth = pow(scalbn(hypot(value[0], value[1]), (int)op->exponent), 1.0 / (PetscReal)op->period);
  CHECK(fabs(growth - oracle) <= (oracle == 1 ? 1e-6 : 1e-7), "%s: %.12g", row, growth);
  if (largest_order > 1000) PetscCall(PetscPrintf(PETSC_COMM_WORLD, "%s: %.12g\n", row, growth));
  PetscCall(Close(&scene, &op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  if (ranks > 1) largest_order = 100;
  if (argc > 2) largest_order = atoi(argv[2]);
  PetscCall(OracleGrowthNd(argv[1], 183, CheckGrowth));
  PetscCall(CheckImages());
  PetscCall(CheckWaves());
  PetscCall(CheckSymmetries());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
