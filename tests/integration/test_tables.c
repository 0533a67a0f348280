/*
   Tables that no built-in formulation has: a higher power of the Courant number, operations that accumulate, more
   registers than any built-in table. March, operator and symbol must agree on them. A table that they do not support is
   refused when it is made.
*/
#include "check.h"
#include "linalg/dense.h"
#include <mpmstab/operator.h>
#include <mpmstab/symbol.h>

/*
   The elastic bar in w' = k w is u_tt = k^2 LAP u, so only LAP carries the Courant number, squared. It has the
   eigenvalues of the formulation elastic. LAP is split into two halves, of which the second accumulates. COPIES copies
   of the two fields side by side have the same growth.
*/
enum { COPIES = 6, OPS = 8 };

#define HALF_LAP(node, other, adds)                                                                                    \
  {                                                                                                                    \
    .kind = MPM_LAP, .dst = node, .src = other, .accumulates = adds, .coefficient = MPM_COURANT_SQUARED, .factor = 0.5 \
  }

static const MpmOp bar[OPS] = {
    P2G(0, 0),      P2G(1, 1), HALF_LAP(2, 0, PETSC_FALSE), HALF_LAP(2, 0, PETSC_TRUE), ADD(1, 2), G2P(1, 2, ONE),
    G2P(0, 1, ONE), DRIFT};

static MpmFormulation SideBySide(PetscInt copies, MpmOp ops[])
{
  static const char *const names[] = {"u0", "w0", "u1", "w1", "u2", "w2", "u3", "w3", "u4", "w4", "u5", "w5"};
  MpmFormulation           f       = {.name      = "test",
                                      .nops      = (OPS - 1) * copies + 1,
                                      .ops       = ops,
                                      .staggered = MPM_NONE,
                                      .affine    = MPM_NONE,
                                      .conserved = MPM_NONE};

  for (PetscInt c = 0; c < copies; c++) {
    for (PetscInt field = 0; field < 2; field++) f.particle_fields[2 * c + field] = names[2 * c + field];
    for (PetscInt node = 0; node < 3; node++) f.node_fields[3 * c + node] = "node";
    for (PetscInt o = 0; o < OPS - 1; o++) {
      const PetscBool gathers = bar[o].kind == MPM_G2P ? PETSC_TRUE : PETSC_FALSE;
      MpmOp          *op      = &ops[o * copies + c];

      *op = bar[o];
      op->dst += gathers ? 2 * c : 3 * c;
      op->src += bar[o].kind == MPM_P2G ? 2 * c : 3 * c;
    }
  }
  ops[(OPS - 1) * copies] = bar[OPS - 1];
  return f;
}

static PetscErrorCode GrowthOf(const MpmOperator *op, PetscReal *growth)
{
  PetscReal value[2];

  PetscFunctionBegin;
  PetscCall(MpmDenseLargest(op->A, value));
  *growth = MpmGrowthPerStep(hypot(value[0], value[1]), op->exponent, op->period);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Agrees(const char options[], PetscInt copies)
{
  MpmOp                ops[OPS * COPIES];
  const MpmFormulation test = SideBySide(copies, ops);
  MpmSymbolWish        wish = {.tolerance = 1e-6};
  MpmScene            *scene;
  MpmScheme            scheme;
  MpmOperator         *op, *elastic;
  MpmSymbol           *symbol;
  PetscReal            mismatch, growth = NAN, expected = NAN;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  scheme             = scene->scheme;
  scheme.formulation = &test;
  PetscCall(MpmTableCreate(&test, scheme.transfer, &scheme.numbers, &scheme.space, &scheme.table));
  CHECK(scheme.table->nstate == 2 * copies && scheme.table->nnodes >= 3 * copies, "%s: %d particle fields", options,
        (int)scheme.table->nstate);
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scheme, &scene->step, &op));
  PetscCall(MpmOperatorMismatch(op, &mismatch));
  CHECK(mismatch <= 1e-14 * op->period, "%s, %d copies: march and operator differ by %.3g", options, (int)copies,
        mismatch);
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &elastic));
  PetscCall(GrowthOf(op, &growth));
  PetscCall(GrowthOf(elastic, &expected));
  CHECK(expected > 1.01, "%s: growth %g says nothing", options, expected);
  CHECK_NEAR(growth, expected, 1e-8);
  wish.phases[0] = scene->layout.grid[0].cells;
  if (!MpmSymbolWhyNot(&scene->layout)) {
    PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scheme, &scene->step, &wish, &symbol));
    CHECK_NEAR(symbol->growth, expected, 1e-8);
    PetscCall(MpmSymbolDestroy(&symbol));
  }
  PetscCall(MpmOperatorDestroy(&elastic));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmTableDestroy(&scheme.table));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Refuses(const char what[], PetscInt nops, const MpmOp ops[])
{
  const MpmFormulation test  = {.name            = "test",
                                .particle_fields = {"u", "w"},
                                .node_fields     = {"u_i", "w_i"},
                                .nops            = nops,
                                .ops             = ops,
                                .staggered       = MPM_NONE,
                                .affine          = MPM_NONE,
                                .conserved       = MPM_NONE};
  const MpmSpace       space = {.dim = 1}; /* periodic */
  MpmTable            *table;
  PetscErrorCode       error;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  error = MpmTableCreate(&test, MpmTransferFind("flip"), &(MpmSchemeNumbers){.order = 1}, &space, &table);
  PetscCall(PetscPopErrorHandler());
  CHECK(error == PETSC_ERR_SUP, "%s: error %d", what, (int)error);
  PetscCall(MpmTableDestroy(&table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define REFUSES(what, ...)                                                                                             \
  do {                                                                                                                 \
    const MpmOp ops[] = {__VA_ARGS__};                                                                                 \
    PetscCall(Refuses(what, PETSC_STATIC_ARRAY_LENGTH(ops), ops));                                                     \
  } while (0)

static PetscErrorCode RefusesUnsupported(void)
{
  PetscFunctionBegin;
  REFUSES("a second axis", P2G(0, 0), {.kind = MPM_GRAD, .axis = 1, .accumulates = PETSC_TRUE, .factor = 1});
  REFUSES("a third side", P2G(0, 0), {.kind = MPM_WALL, .side = 2});
  REFUSES("a negative power", P2G(0, 0), {.kind = MPM_G2P, .accumulates = PETSC_TRUE, .coefficient = -1});
  REFUSES("particles that are replaced", P2G(0, 0), {.kind = MPM_G2P, .factor = 1});
  REFUSES("a scale that accumulates", {.kind = MPM_SCALE, .accumulates = PETSC_TRUE, .factor = 2});
  REFUSES("a stencil on itself", P2G(0, 0), LAP(0, 0, ONE));
  REFUSES("a register too far", P2G(2, 0));
  REFUSES("a node field before it is written", G2P(0, 1, ONE), P2G(1, 1));
  REFUSES("a sum into nothing", P2G(0, 0), ADD(1, 0));
  REFUSES("a sum that goes on after a stencil", P2G(0, 0), P2G(1, 1), ADD(0, 1),
          {.kind = MPM_DIV, .dst = 0, .src = 0, .accumulates = PETSC_TRUE, .factor = 1});
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt CountOps(const MpmTable *table, MpmOpKind kind)
{
  PetscInt n = 0;

  for (PetscInt o = 0; o < table->nops; o++) n += table->ops[o].kind == kind;
  return n;
}

/* The names of the state's registers, and the numbers of operations along axes, of a scene. */
static PetscErrorCode Holds(const char options[], const char names[], PetscInt div, PetscInt grad)
{
  char            all[256] = "";
  MpmScene       *scene;
  const MpmTable *t;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  t = scene->scheme.table;
  for (PetscInt f = 0; t->fields[f]; f++) {
    if (f) PetscCall(PetscStrlcat(all, " ", sizeof all));
    PetscCall(PetscStrlcat(all, t->fields[f], sizeof all));
  }
  CHECK(!strcmp(all, names), "%s: %s", options, all);
  CHECK(CountOps(t, MPM_DIV) + CountOps(t, MPM_DIV_MLS) == div, "%s: %d of DIV", options, (int)CountOps(t, MPM_DIV));
  CHECK(CountOps(t, MPM_GRAD) + CountOps(t, MPM_GRAD_MLS) == grad, "%s: %d of GRAD", options,
        (int)CountOps(t, MPM_GRAD));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A table has the registers and operations of its dimension and material, and no others. */
static PetscErrorCode HoldsWhatItNeeds(void)
{
  PetscFunctionBegin;
  PetscCall(Holds("-formulation usl", "v s", 1, 1));
  PetscCall(Holds("-formulation usl -transfer apic", "v s c", 1, 1));
  PetscCall(Holds("-dim 2 -cells 4 -formulation usl -poisson 0", "v_x v_y s_xx s_xy s_yy", 4, 4));
  PetscCall(Holds("-dim 2 -cells 4 -formulation usl -poisson 0.3", "v_x v_y s_xx s_xy s_yy", 4, 6));
  PetscCall(Holds("-dim 2 -cells 4 -formulation usl -poisson 0.5", "v_x v_y s", 2, 2));
  PetscCall(Holds("-dim 2 -cells 4 -formulation usl -poisson 0.5 -transfer apic -gradient mls",
                  "v_x v_y s c_xx c_xy c_yx c_yy", 2, 2));
  PetscCall(Holds("-dim 3 -cells 4 -formulation usl", "v_x v_y v_z s_xx s_xy s_xz s_yy s_yz s_zz", 9, 15));
  PetscCall(Holds("-dim 3 -cells 4 -formulation gas2", "u_x u_y u_z r", 0, 6));
  PetscCall(Holds("-dim 3 -cells 4 -formulation elastic", "u w", 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A formulation whose GRAD makes a number of a number works in one dimension only. */
static PetscErrorCode RefusesRanks(void)
{
  const MpmOp          ops[] = {P2G(0, 0), GRAD(1, 0, COURANT), DRIFT};
  const MpmFormulation test  = {.name            = "test",
                                .particle_fields = {"u", "w"},
                                .node_fields     = {"u_i"},
                                .nops            = PETSC_STATIC_ARRAY_LENGTH(ops),
                                .ops             = ops,
                                .staggered       = MPM_NONE,
                                .affine          = MPM_NONE,
                                .conserved       = MPM_NONE};

  PetscFunctionBegin;
  for (PetscInt dim = 1; dim <= MPM_MAX_DIM; dim++) {
    const MpmSpace space = {.dim = dim};
    MpmTable      *table;
    PetscErrorCode error;

    PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
    error = MpmTableCreate(&test, MpmTransferFind("flip"), &(MpmSchemeNumbers){.order = 1}, &space, &table);
    PetscCall(PetscPopErrorHandler());
    CHECK(error == (dim == 1 ? PETSC_SUCCESS : PETSC_ERR_SUP), "dim %d: error %d", (int)dim, (int)error);
    PetscCall(MpmTableDestroy(&table));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const rests[] = {
      "-cells 12 -ppc 1 -courant 3",
      "-cells 13 -ppc 3 -offset 0.3 -courant 1.9 -basis quadratic",
      "-cells 14 -jitter 0.6 -courant 1.8",
      "-cells 12 -drift 1/3 -courant 1.5",
  };
  char options[256];

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(rests); r++) {
    PetscCall(PetscSNPrintf(options, sizeof options, "-formulation elastic %s", rests[r]));
    PetscCall(Agrees(options, 1));
    PetscCall(Agrees(options, COPIES));
  }
  PetscCall(RefusesUnsupported());
  PetscCall(RefusesRanks());
  PetscCall(HoldsWhatItNeeds());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
