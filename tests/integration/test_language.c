/*
   Schemes as text. Those of the program, printed and read back, have the same tables. Of others march, operator and
   symbol agree, and numbers by hand come out.
*/
#include "check.h"
#include "analysis/spectrum.h"
#include "scheme/language.h"
#include <mpmstab/critical.h>
#include <mpmstab/operator.h>
#include <slepcsys.h>

/* The scheme of issue and example: musl with the mean of two nodal velocities in the stress update. */
static const char musl_mid[] = "scheme:\n"
                               "  name: musl-mid\n"
                               "  particles: {v: vector, s: stress}\n"
                               "  nodes: {v_i: vector, a_i: vector, w_i: vector}\n"
                               "  step:\n"
                               "    - v_i  = P2G v\n"
                               "    - a_i  = -k DIV s\n"
                               "    - v   += G2P a_i\n"
                               "    - w_i  = P2G v\n"
                               "    - w_i  = 0.5 w_i + 0.5 v_i\n"
                               "    - s   += k STRESS GRAD w_i\n"
                               "    - DRIFT\n"
                               "  energy: {v: mass, s: compliance}\n"
                               "  wave: momentum\n";

/* Every kind of line and of term, also those that need fields without a name. */
static const char every[] = "scheme:\n"
                            "  name: every\n"
                            "  particles: {v: vector, s: stress, q: vector}\n"
                            "  nodes: {v_i: vector, a_i: vector, w_i: vector, y_i: vector}\n"
                            "  parameters: {mix: 0.3, eta: (1 - mix) / 2}\n"
                            "  step:\n"
                            "    - v_i = P2G v\n"
                            "    - IMPOSE v_i\n"
                            "    - FILTER v v_i\n"
                            "    - a_i = 0.1 P2G q - k DIV s\n"
                            "    - IMPOSE a_i\n"
                            "    - a_i = (1 - 0.1 k) a_i + 0.05 k LAP a_i\n"
                            "    - REACT a_i v_i\n"
                            "    - w_i = SOLVE v_i\n"
                            "    - IMPOSE w_i\n"
                            "    - w_i += 0.1 (P2G v - LAP w_i)\n"
                            "    - IMPOSE w_i\n"
                            "    - y_i = eta v_i + mix/2 w_i - k^2 SOLVE a_i\n"
                            "    - v += G2P a_i\n"
                            "    - q = 0.5 q + 0.1 v + 0.1 G2P (y_i + v_i)\n"
                            "    - v = (1 - 0.02 k) v\n"
                            "    - q -= 0.1 q\n"
                            "    - s += k STRESS GRAD (0.5 y_i + v_i / 4)\n"
                            "    - DRIFT\n";

/* Divergences and gradients between numbers and vectors. */
static const char fluid[] = "scheme:\n"
                            "  name: fluid\n"
                            "  particles: {u: vector, p: scalar, d: scalar}\n"
                            "  nodes: {u_i: vector, a_i: vector, p_i: scalar, d_i: scalar}\n"
                            "  step:\n"
                            "    - p_i = 0.9 P2G p\n"
                            "    - u_i = P2G u\n"
                            "    - a_i = -0.5 k DIV p\n"
                            "    - d_i = 0.1 k DIV u + 0.1 P2G d\n"
                            "    - u += 0.2 k GRAD p_i + G2P a_i\n"
                            "    - u_i += a_i\n"
                            "    - p += k GRAD . u_i\n"
                            "    - d = 0.9 d + 0.1 p + G2P d_i\n"
                            "    - DRIFT\n";

static PetscErrorCode SceneOf(const char scheme[], const char keys[], MpmScene **scene)
{
  char text[8192];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof text, "%s%s", scheme, keys));
  PetscCall(MpmSceneFromText(text, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- there and back ---- */

static void CompareOps(const char what[], const MpmTable *a, const MpmTable *b)
{
  CHECK(a->nops == b->nops, "%s: %d and %d operations", what, (int)a->nops, (int)b->nops);
  for (PetscInt o = 0; o < PetscMin(a->nops, b->nops); o++) {
    const MpmOp *x = &a->ops[o], *y = &b->ops[o];

    CHECK(x->kind == y->kind && x->axis == y->axis && x->dst == y->dst && x->src == y->src &&
              x->accumulates == y->accumulates && x->coefficient == y->coefficient && x->factor == y->factor &&
              x->side == y->side,
          "%s: operation %d", what, (int)o);
  }
}

/* Everything that march, operator and symbol read of a table. */
static void CompareTables(const char what[], const MpmTable *a, const MpmTable *b)
{
  CHECK(a->nops == b->nops && a->nstate == b->nstate && a->nparticles == b->nparticles && a->nnodes == b->nnodes &&
            a->unfiltered == b->unfiltered && a->affine == b->affine,
        "%s: sizes of tables", what);
  if (a->nops != b->nops || a->nstate != b->nstate || a->nnodes != b->nnodes) return;
  CompareOps(what, a, b);
  for (PetscInt r = 0; r < a->nstate; r++)
    CHECK(!strcmp(a->fields[r], b->fields[r]) && a->field[r] == b->field[r] && a->component[r] == b->component[r] &&
              a->filtered[r] == b->filtered[r],
          "%s: field %s", what, a->fields[r]);
  for (PetscInt n = 0; n < a->nnodes; n++)
    for (PetscInt d = 0; d < a->dim; d++) CHECK(a->parity[n][d] == b->parity[n][d], "%s: parity", what);
}

static PetscBool CanBe(const MpmFormulation *f, const MpmTransfer *t, const char end[])
{
  if (t->affine && f->affine == MPM_NONE) return PETSC_FALSE;
  if (strstr(end, "reaction") && !MpmFormulationHas(f, MPM_REACT)) return PETSC_FALSE;
  return strstr(end, "free") && !f->free_ends ? PETSC_FALSE : PETSC_TRUE;
}

/* The text of a formulation with its numbers, under another name, is the scheme that the program has. both: keys of both. */
static PetscErrorCode CheckThereAndBack(const MpmFormulation *f, const MpmSchemeNumbers *numbers, const char said[],
                                        const char both[])
{
  static const char *const ends[] = {"periodic", "fixed", "[fixed_reaction, free]", "symmetry"};
  MpmWritten              *written;
  char                    *yaml, plain[128], keys[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(plain, sizeof plain, "formulation: %s\n%s", f->name, said));
  for (PetscInt t = 0; MpmTransfers[t]; t++) {
    if (numbers->rk_on == MPM_RK_PARTICLES && MpmTransfers[t]->filter) continue;
    if (*both && (MpmTransfers[t]->same_as || MpmTransfers[t]->sharpen)) continue; /* no step, or too many registers */
    PetscCall(PetscNew(&written));
    PetscCall(MpmWrittenAddFormulation(f, numbers, MpmTransfers[t], written));
    written->name.text[0] = 'w';
    PetscCall(MpmWrittenYaml(written, &yaml));
    for (PetscInt dim = 1; dim <= 3; dim++)
      for (size_t e = 0; e < PETSC_STATIC_ARRAY_LENGTH(ends); e++) {
        MpmScene *scenes[2];

        if (!CanBe(f, MpmTransfers[t], ends[e])) continue;
        if (dim > 1 && ends[e][0] == '[') continue;
        PetscCall(PetscSNPrintf(keys, sizeof keys, "dim: %d\ntransfer: %s\nboundary: %s\ncells: 8\n%s", (int)dim,
                                MpmTransfers[t]->name, ends[e], both));
        PetscCall(SceneOf(yaml, keys, &scenes[0]));
        PetscCall(SceneOf(plain, keys, &scenes[1]));
        CHECK(scenes[0]->written && !scenes[1]->written, "%s: written", f->name);
        CompareTables(f->name, scenes[0]->scheme.table, scenes[1]->scheme.table);
        for (int s = 0; s < 2; s++) PetscCall(MpmSceneDestroy(&scenes[s]));
      }
    PetscCall(PetscFree(yaml));
    PetscCall(MpmWrittenDestroy(&written));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Each formulation as it is by default, verlet with each share that has another table, and each method of rk. */
static PetscErrorCode CheckAllThereAndBack(void)
{
  MpmSchemeNumbers numbers = {.share = 0.5, .rk = MPM_RK_USUAL, .theta = 0.5, .move_share = 0.5};
  char             said[64];

  PetscFunctionBegin;
  for (PetscInt f = 0; MpmFormulations[f]; f++) PetscCall(CheckThereAndBack(MpmFormulations[f], &numbers, "", ""));
  for (int tenths = 0; tenths <= 10; tenths += 5) {
    numbers.share = tenths / 10.0;
    PetscCall(PetscSNPrintf(said, sizeof said, "share: %g\n", (double)numbers.share));
    PetscCall(CheckThereAndBack(MpmFormulationFind("verlet"), &numbers, said, ""));
  }
  for (int tenths = 0; tenths <= 10; tenths += 5) {
    numbers.theta = tenths / 10.0;
    PetscCall(PetscSNPrintf(said, sizeof said, "theta: %g\n", (double)numbers.theta));
    PetscCall(CheckThereAndBack(MpmFormulationFind("implicit"), &numbers, said, ""));
  }
  numbers.share = 0.5;
  for (numbers.move_share = 0; numbers.move_share <= 1; numbers.move_share += 0.25) {
    PetscCall(PetscSNPrintf(said, sizeof said, "move_share: %g\n", (double)numbers.move_share));
    PetscCall(CheckThereAndBack(MpmFormulationFind("verlet"), &numbers, said, "kinematics: finite\n"));
    PetscCall(CheckThereAndBack(MpmFormulationFind("rk"), &numbers, said, "kinematics: finite\n"));
  }
  numbers.move_share = 0.5;
  for (numbers.rk = 0; MpmRkWord(numbers.rk); numbers.rk++)
    for (numbers.rk_on = MPM_RK_AUTO; MpmRkOnNames[numbers.rk_on]; numbers.rk_on++) {
      PetscCall(
          PetscSNPrintf(said, sizeof said, "rk: %s\nrk_on: %s\n", MpmRkWord(numbers.rk), MpmRkOnNames[numbers.rk_on]));
      PetscCall(CheckThereAndBack(MpmFormulationFind("rk"), &numbers, said, ""));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a formulation says besides its table is the same, too. */
static PetscErrorCode CheckTraits(const MpmFormulation *f)
{
  MpmWritten           *written;
  MpmScene             *scene;
  const MpmFormulation *back;
  char                 *yaml;

  PetscFunctionBegin;
  PetscCall(PetscNew(&written));
  PetscCall(MpmWrittenAddFormulation(f, NULL, NULL, written));
  PetscCall(MpmWrittenYaml(written, &yaml));
  PetscCall(SceneOf(yaml, "cells: 8\n", &scene));
  back = scene->scheme.formulation;
  CHECK(back->staggered == f->staggered && back->affine == f->affine && back->conserved == f->conserved &&
            back->free_ends == f->free_ends && back->materials == f->materials && back->wave == f->wave &&
            back->nenergy == f->nenergy,
        "%s: traits", f->name);
  for (PetscInt t = 0; t < PetscMin(back->nenergy, f->nenergy); t++)
    CHECK(back->energy[t].place == f->energy[t].place && back->energy[t].field == f->energy[t].field &&
              back->energy[t].stress == f->energy[t].stress,
          "%s: energy", f->name);
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(PetscFree(yaml));
  PetscCall(MpmWrittenDestroy(&written));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the readers of a table agree ---- */

/* The same without eigenvalues. */
static PetscErrorCode CheckMarch(const char scheme[], const char keys[])
{
  MpmScene    *scene;
  MpmOperator *op;
  PetscReal    mismatch;

  PetscFunctionBegin;
  PetscCall(SceneOf(scheme, keys, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmOperatorMismatch(op, &mismatch));
  CHECK(mismatch <= 1e-12 * op->period, "%s, %s: the march differs from the operator by %g",
        scene->scheme.formulation->name, keys, mismatch);
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckReaders(const char scheme[], const char keys[])
{
  MpmScene    *scene;
  MpmRequest   request = {.task = "spectrum", .tolerance = 1e-6, .steps = 100};
  MpmSpectrum *spectrum;

  PetscFunctionBegin;
  PetscCall(SceneOf(scheme, keys, &scene));
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) request.phases[a] = scene->layout.grid[a].cells;
  PetscCall(MpmSpectrumCreate(scene, &request, 0, &spectrum));
  CHECK(spectrum->step_mismatch <= 1e-12 * spectrum->op->period, "%s, %s: the march differs from the operator by %g",
        scene->scheme.formulation->name, keys, spectrum->step_mismatch);
  if (spectrum->symbol && scene->layout.dim == 1)
    CHECK(spectrum->symbol_mismatch <= 3e-5, "%s, %s: the symbol differs by %g", scene->scheme.formulation->name, keys,
          spectrum->symbol_mismatch);
  if (spectrum->symbol) CHECK_NEAR(spectrum->symbol->growth, spectrum->growth, 3e-5 * spectrum->growth);
  CHECK(strstr(keys, "boundary") || spectrum->symbol || strstr(keys, "jitter"), "%s: no symbol", keys);
  PetscCall(MpmSpectrumDestroy(&spectrum));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- numbers by hand ---- */

/*
   On hats with two particles a cell the four factors of musl-mid at a phase are 1, 1 and two whose product is
   1 + alpha s / 2, with alpha = 1 - 3/8 (1 - cos beta) and s = k^2 kappa, kappa = 2 (1 - cos beta).
*/
static PetscErrorCode CheckDeterminant(void)
{
  const MpmSymbolWish wish = {.phases = {48}, .tolerance = 1e-6, .keep = PETSC_TRUE};
  const PetscReal     k    = 0.5;
  MpmScene           *scene;
  MpmSymbol          *symbol;

  PetscFunctionBegin;
  PetscCall(SceneOf(musl_mid, "cells: 48\n", &scene));
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &wish, &symbol));
  CHECK(symbol->size == 4, "%d factors", (int)symbol->size);
  for (PetscInt i = 0; i < symbol->count && symbol->size == 4; i++) {
    PetscReal beta[MPM_MAX_DIM], alpha, s, product[2] = {1, 0};

    MpmSymbolBeta(symbol, MpmSymbolPhaseOfClass(symbol, symbol->first + i), beta);
    alpha = 1 - 0.375 * (1 - cos(beta[0]));
    s     = k * k * 2 * (1 - cos(beta[0]));
    for (PetscInt j = 0; j < 4; j++) {
      const PetscReal *f = symbol->factors + 2 * (4 * i + j), re = product[0];

      product[0] = re * f[0] - product[1] * f[1];
      product[1] = re * f[1] + product[1] * f[0];
    }
    CHECK_NEAR(product[0], 1 + alpha * s / 2, 1e-13);
    CHECK_NEAR(product[1], 0, 1e-13);
  }
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GrowthOf(const char scheme[], const char keys[], PetscInt phases, PetscReal *growth)
{
  const MpmSymbolWish wish = {.phases = {phases}, .tolerance = 1e-6};
  MpmScene           *scene;
  MpmSymbol          *symbol;

  PetscFunctionBegin;
  PetscCall(SceneOf(scheme, keys, &scene));
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &wish, &symbol));
  *growth = symbol->growth;
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The growth of musl-mid, the largest over beta of sqrt(1 + alpha s / 2): at cos beta = -1/3, where alpha is 1/2. */
static PetscErrorCode CheckGrowth(void)
{
  const PetscReal k = 0.5, growth = sqrt(1 + k * k * (1 + 1.0 / 3) * 0.5);
  PetscReal       found;
  MpmScene       *scene;
  MpmCriticalCase of;
  MpmCritical     critical;

  PetscFunctionBegin;
  PetscCall(SceneOf(musl_mid, "cells: 16\n", &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &critical));
  CHECK(critical.courant == 0, "the critical Courant number of a scheme that always grows is %g", critical.courant);
  CHECK_NEAR(growth, 1.0801, 5e-5); /* as the issue has it */
  PetscCall(GrowthOf(musl_mid, "courant: 0.5\n", 20000, &found));
  CHECK_NEAR(found, growth, 1e-7);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- parameters ---- */

static const char mixed[] = "scheme:\n"
                            "  name: mix\n"
                            "  particles: {s: stress, v: vector}\n" /* waves want the vector first */
                            "  nodes: {v_i: vector, a_i: vector}\n"
                            "  parameters: {eta: 1 - mix, mix: 0.25}\n"
                            "  step: |\n"
                            "    v_i=P2G v\n"
                            "    a_i = k*(-DIV(s))\n"
                            "    v+=G2P a_i\n"
                            "    s += k STRESS GRAD (eta v_i + mix (v_i + a_i))\n"
                            "    DRIFT\n"
                            "  wave: momentum\n";

/* mix = 1 is usl, 0 usf but for the order of its lines, 1/2 the usmid of docs/dev/formulation.md. */
static PetscErrorCode CheckParameters(void)
{
  PetscReal growth, same;

  PetscFunctionBegin;
  PetscCall(GrowthOf(mixed, "courant: 0.9\nmix: 1\n", 32, &growth));
  PetscCall(GrowthOf("formulation: usl\n", "courant: 0.9\n", 32, &same));
  CHECK(growth > 1.2, "usl does not grow at 0.9");
  CHECK_NEAR(growth, same, 1e-12);
  PetscCall(GrowthOf(mixed, "courant: 0.5\ncells: 51\nmix: 1/2\n", 51, &growth));
  CHECK(growth > 1.0407 && growth < 1.04084, "usmid grows by %g", growth); /* sqrt(1 + k^2 / 3), at the best phase */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   What a march must not leave out: sums that set a field anew before particles have changed, multiples of a sum that the
   field holds, and at walls combinations of fields of which only one is imposed.
*/
static const char anew[] = "scheme:\n  name: anew\n  particles: {v: vector, s: stress}\n"
                           "  nodes: {v_i: vector, a_i: vector, w_i: vector}\n  step:\n"
                           "    - v_i = P2G v\n    - IMPOSE v_i\n    - a_i = -k DIV s\n    - w_i = v_i + 0.3 a_i\n"
                           "    - v_i = 1.1 P2G v\n    - v_i = v_i - 0.2 P2G v + 0.1 w_i\n"
                           "    - v += G2P a_i\n    - s += k STRESS GRAD v_i\n    - DRIFT\n";

/* A transfer's filter written as lines makes the operations of that transfer. */
static PetscErrorCode CheckFilters(void)
{
  static const char before[] = "scheme:\n  name: filtered\n  particles: {v: vector, s: stress}\n"
                               "  nodes: {v_i: vector, a_i: vector%s}\n  parameters: {%s}\n  step:\n"
                               "    - v_i = P2G v\n    - IMPOSE v_i\n%s    - a_i = -k DIV s\n    - REACT a_i v_i\n"
                               "    - v_i += a_i\n    - IMPOSE v_i\n    - v += G2P a_i\n"
                               "    - s += k STRESS GRAD v_i\n    - DRIFT\n";
  static const struct {
    const char *transfer, *fields, *parameters, *lines;
  } filters[] = {
      {"pic", "", "", "    - v = G2P v_i\n"},
      {"blend", "", "ratio: 0.95", "    - v = ratio v + (1 - ratio) G2P v_i\n"},
      {"nullspace", ", y_i: vector", "", "    - y_i = SOLVE v_i\n    - v = G2P y_i\n"},
  };

  PetscFunctionBegin;
  for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(filters); f++) {
    char      text[1024], keys[64];
    MpmScene *scenes[2];

    (void)snprintf(text, sizeof text, before, filters[f].fields, filters[f].parameters, filters[f].lines);
    PetscCall(PetscSNPrintf(keys, sizeof keys, "transfer: %s\ncells: 8\n", filters[f].transfer));
    PetscCall(SceneOf(text, "cells: 8\n", &scenes[0]));
    PetscCall(SceneOf("formulation: usl\n", keys, &scenes[1]));
    CompareOps(filters[f].transfer, scenes[0]->scheme.table, scenes[1]->scheme.table);
    for (int s = 0; s < 2; s++) PetscCall(MpmSceneDestroy(&scenes[s]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- transfers ---- */

/* The transfer of the program as text, with a formulation of the program, has the operations of the two by name. */
static PetscErrorCode CheckTransfer(const MpmTransfer *transfer, PetscInt order)
{
  static const char *const spaces[] = {"cells: 8\nboundary: fixed\n", "cells: 8\nboundary: fixed\npic_filter: before\n",
                                       "cells: 8\nboundary: [fixed_reaction, free]\n",
                                       "dim: 2\ncells: [3, 4]\nboundary: symmetry\n"};

  const MpmSchemeNumbers numbers = {.order = order, .ratio = 0.95};
  MpmWritten            *written;
  char                  *yaml, keys[256], named[64] = "";

  PetscFunctionBegin;
  PetscCall(MpmWrittenFromTransfer(transfer, &numbers, &written));
  PetscCall(MpmWrittenYaml(written, &yaml));
  if (transfer->option && !strcmp(transfer->option, "xpic_order"))
    PetscCall(PetscSNPrintf(named, sizeof named, "xpic_order: %d\n", (int)order));
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(spaces); s++) {
      const char *const name = MpmFormulations[f]->name;
      MpmScene         *scenes[2];

      if (!CanBe(MpmFormulations[f], transfer, spaces[s])) continue;
      if (strstr(spaces[s], "before") && !MpmFormulationHas(MpmFormulations[f], MPM_FILTER_BEFORE)) continue;
      PetscCall(PetscSNPrintf(keys, sizeof keys, "formulation: %s\n%s", name, spaces[s]));
      PetscCall(SceneOf(yaml, keys, &scenes[0]));
      PetscCall(PetscSNPrintf(keys, sizeof keys, "formulation: %s\ntransfer: %s\n%s%s", name, transfer->name, named,
                              spaces[s]));
      PetscCall(SceneOf("", keys, &scenes[1]));
      CHECK(scenes[0]->scheme.transfer->lines && strlen(scenes[0]->scheme_hash) == 16, "%s: not as text", name);
      CompareTables(transfer->name, scenes[0]->scheme.table, scenes[1]->scheme.table);
      for (int i = 0; i < 2; i++) PetscCall(MpmSceneDestroy(&scenes[i]));
    }
  PetscCall(PetscFree(yaml));
  PetscCall(MpmWrittenDestroy(&written));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A filter with a parameter, sums that follow one another, and a particle field besides q. */
static const char smooth[] = "scheme:\n"
                             "  transfer:\n"
                             "    name: smooth\n"
                             "    parameters: {ratio: 0.5}\n"
                             "    particles: [p]\n"
                             "    nodes: [a, b]\n"
                             "    filter:\n"
                             "      - p = G2P g\n"
                             "      - a = P2G p\n"
                             "      - p = 0.5 q - 0.5 G2P a\n"
                             "      - b = a + P2G p\n"
                             "      - IMPOSE b\n"
                             "      - q = ratio q + (1 - ratio) G2P b\n";

/* half of q and half of G2P g is blend with this ratio; the map over the ratio changes the transfer with it */
static PetscErrorCode CheckOwnTransfer(void)
{
  static const char half[] =
      "formulation: usl\nscheme:\n  transfer:\n    name: half-pic\n    parameters: {ratio: 0.5}\n"
      "    filter: ['q = ratio q + (1 - ratio) G2P g']\n";
  PetscReal growth, same;

  PetscFunctionBegin;
  PetscCall(GrowthOf(half, "courant: 0.9\nratio: 0.9\n", 32, &growth));
  PetscCall(GrowthOf("formulation: usl\ntransfer: blend\nblend_ratio: 0.9\n", "courant: 0.9\n", 32, &same));
  CHECK(same > 1.01, "blend does not grow");
  CHECK_NEAR(growth, same, 1e-13);
  PetscCall(GrowthOf(half, "courant: 0.9\n", 32, &same));
  CHECK(fabs(growth - same) > 1e-3, "the ratio changes nothing");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Blanks and comments do not change the hash of a scheme, and a factor does. */
static PetscErrorCode CheckHash(void)
{
  static const char same[] =
      "scheme: # a comment\n"
      "  name: other-name\n"
      "  particles: {v: vector, s: stress}\n"
      "  nodes:\n    v_i: vector\n    a_i: vector\n    w_i: vector\n"
      "  wave: momentum\n"
      "  step:\n    - v_i=P2G   v\n    - a_i = - k DIV s\n    - v += G2P a_i\n"
      "    - w_i = P2G v\n    - w_i = 0.5 w_i+0.5 v_i\n    - s += k STRESS GRAD w_i\n    - DRIFT\n"
      "  energy: {v: mass, s: compliance}\n";
  char      other[sizeof musl_mid];
  MpmScene *scenes[3];

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(other, musl_mid, sizeof other));
  *strstr(other, "5 w_i") = '6';
  PetscCall(SceneOf(musl_mid, "", &scenes[0]));
  PetscCall(SceneOf(same, "", &scenes[1]));
  PetscCall(SceneOf(other, "", &scenes[2]));
  CHECK(strlen(scenes[0]->scheme_hash) == 16, "%s", scenes[0]->scheme_hash);
  CHECK(!strcmp(scenes[0]->scheme_hash, scenes[1]->scheme_hash), "blanks change the hash");
  CHECK(strcmp(scenes[0]->scheme_hash, scenes[2]->scheme_hash), "another factor does not change the hash");
  for (int s = 0; s < 3; s++) PetscCall(MpmSceneDestroy(&scenes[s]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is the same on every rank: tables, and numbers by hand. */
static PetscErrorCode CheckTables(void)
{
  PetscFunctionBegin;
  PetscCall(CheckAllThereAndBack());
  for (PetscInt f = 0; MpmFormulations[f]; f++) PetscCall(CheckTraits(MpmFormulations[f]));
  for (PetscInt t = 0; MpmTransfers[t]; t++)
    for (PetscInt order = 1; order <= 3; order++)
      if (MpmTransfers[t]->filter && !MpmTransfers[t]->affine && !MpmTransfers[t]->sharpen)
        PetscCall(CheckTransfer(MpmTransfers[t], order));
  PetscCall(CheckDeterminant());
  PetscCall(CheckGrowth());
  PetscCall(CheckParameters());
  PetscCall(CheckFilters());
  PetscCall(CheckOwnTransfer());
  PetscCall(CheckHash());
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const rests[] = {
      "cells: 12\ncourant: 0.3\n",
      "cells: 12\ncourant: 0.3\ndrift: 1/4\nppc: 3\n",
      "cells: 13\njitter: 0.6\nbasis: quadratic\ndrift: 1/2\n",
      "dim: 2\ncells: [3, 6]\ncourant: 0.2\ndrift: [1/2, 0]\nbasis: quadratic\npoisson: 0.2\n",
      "dim: 3\ncells: [3, 3, 3]\nppc: 1\ncourant: 0.2\npoisson: 0.5\n",
  };
  static const char *const walls[] = {
      "cells: 12\nboundary: fixed\nbasis: cubic\njitter: 0.4\n",
      "cells: 13\nboundary: [fixed_reaction, free]\nbasis: quadratic\ntransfer: xpic\n",
      "dim: 2\ncells: [3, 9]\nboundary: [fixed, symmetry]\nbasis: quadratic\ntransfer: pic\n",
  };
  int ranks;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  if (ranks == 1) PetscCall(CheckTables());
  for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(rests); r++) {
    PetscErrorCode (*const check)(const char[], const char[]) = ranks == 1 ? CheckReaders : CheckMarch;

    PetscCall(check(musl_mid, rests[r]));
    if (!strstr(rests[r], "dim")) PetscCall(check(every, rests[r]));
    if (!strstr(rests[r], "poisson")) PetscCall(check(fluid, rests[r]));
    if (!strstr(rests[r], "poisson")) PetscCall(check(smooth, rests[r]));
  }
  if (ranks == 1)
    PetscCall(
        CheckReaders(fluid, "dim: 2\ncells: [2, 6]\nppc: [2, 1]\ncourant: 0.2\ndrift: [1/2, 0]\nbasis: quadratic\n"));
  PetscCall(CheckMarch(anew, "cells: 12\njitter: 0.4\nbasis: quadratic\n"));
  PetscCall(CheckMarch(anew, "cells: 12\ndrift: 1/2\n"));
  PetscCall(CheckMarch(anew, "cells: 13\nboundary: fixed\nbasis: cubic\njitter: 0.4\n"));
  PetscCall(CheckMarch(every, "dim: 2\ncells: [3, 9]\ncourant: 0.2\ndrift: [1/2, 0]\nbasis: quadratic\n"));
  PetscCall(CheckMarch(every, "dim: 3\ncells: [2, 3, 6]\ncourant: 0.2\npoisson: 0.2\n"));
  PetscCall(CheckMarch(every, "dim: 3\ncells: [2, 3, 6]\ncourant: 0.2\npoisson: 0.5\n"));
  for (size_t w = 0; w < PETSC_STATIC_ARRAY_LENGTH(walls); w++) PetscCall(CheckMarch(every, walls[w]));
  PetscCall(CheckMarch(smooth, "formulation: usl\ndim: 2\ncells: [3, 6]\ncourant: 0.2\ndrift: [1/2, 0]\n"));
  PetscCall(CheckMarch(smooth, "formulation: usl\ncells: 13\nboundary: fixed_reaction\nbasis: quadratic\n"));
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
