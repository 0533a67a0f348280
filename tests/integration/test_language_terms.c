/*
   Terms of schemes as text. A sum of two terms in one line is what the two are in lines of their own: where a line of one
   term is refused, the sum is, and else the two schemes grow by the same. What a filter or a transfer takes from a field
   of nodes is what the field holds then.
*/
#include "check.h"
#include "analysis/spectrum.h"
#include <slepcsys.h>

/* All fields act on one another. The sums go where %s stands: on nodes first, then on particles. */
static const char around[] = "scheme:\n  name: terms\n"
                             "  particles: {v: vector, u: vector, s: stress, t: stress, r: scalar, q: scalar%s}\n"
                             "  nodes: {v_i: vector, u_i: vector, s_i: stress, t_i: stress, r_i: scalar, q_i: scalar,\n"
                             "          a_i: vector%s}\n"
                             "  step:\n"
                             "    - v_i = P2G v\n    - u_i = 0.9 P2G u\n    - s_i = P2G s\n    - t_i = 0.8 P2G t\n"
                             "    - r_i = P2G r\n    - q_i = 0.7 P2G q\n"
                             "%s"
                             "    - a_i = -k DIV s - 0.3 k DIV t - 0.2 k DIV r + 0.4 k DIV q + 0.1 u_i\n"
                             "    - v = 0.9 v + 0.2 G2P v_i + G2P a_i\n"
                             "    - u = 0.8 u + 0.3 v - 0.1 G2P u_i + 0.5 k GRAD r_i\n"
                             "    - s += k STRESS GRAD v_i - 0.2 G2P t_i\n"
                             "    - t = 0.9 t + 0.7 k STRESS GRAD u_i + 0.2 s + 0.1 G2P s_i\n"
                             "    - r += k GRAD . v_i - 0.1 G2P q_i\n"
                             "    - q = 0.8 q + 0.6 k GRAD . u_i + 0.3 r + 0.1 G2P r_i\n"
                             "%s"
                             "    - DRIFT\n";

static const struct {
  const char *field, *rank;
  PetscBool   on_nodes;
} targets[] = {{"u_i", "vector", PETSC_TRUE}, {"t_i", "stress", PETSC_TRUE}, {"q_i", "scalar", PETSC_TRUE},
               {"u", "vector", PETSC_FALSE},  {"t", "stress", PETSC_FALSE},  {"q", "scalar", PETSC_FALSE}};

static const char *const terms[] = {"v",
                                    "u",
                                    "s",
                                    "t",
                                    "r",
                                    "q",
                                    "v_i",
                                    "u_i",
                                    "s_i",
                                    "t_i",
                                    "r_i",
                                    "q_i",
                                    "P2G v",
                                    "P2G u",
                                    "P2G s",
                                    "P2G r",
                                    "DIV s",
                                    "DIV t",
                                    "DIV r",
                                    "DIV v",
                                    "DIV u",
                                    "G2P v_i",
                                    "G2P s_i",
                                    "G2P r_i",
                                    "GRAD v_i",
                                    "GRAD r_i",
                                    "GRAD . v_i",
                                    "GRAD . u_i",
                                    "GRAD u_i",
                                    "STRESS GRAD v_i",
                                    "STRESS GRAD u_i",
                                    "LAP v_i",
                                    "LAP u_i",
                                    "LAP s_i",
                                    "LAP q_i",
                                    "SOLVE v_i",
                                    "SOLVE t_i",
                                    "SOLVE r_i"};

#define TERMS ((PetscInt)PETSC_STATIC_ARRAY_LENGTH(terms))

/* ---- schemes ---- */

/* A line for target, 'field sign first second', in one line or with each of the two in a line of its own. */
static PetscErrorCode Write(PetscInt target, const char sign[], const char first[], const char second[],
                            PetscBool apart, size_t room, char text[])
{
  const PetscBool   nodes = targets[target].on_nodes;
  const char *const field = targets[target].field, *const w = nodes ? "w_i" : "w";
  char lines[512], own[32]                                  = "";

  PetscFunctionBegin;
  if (apart) {
    PetscCall(PetscSNPrintf(own, sizeof own, ", %s: %s", w, targets[target].rank));
    PetscCall(PetscSNPrintf(lines, sizeof lines, "    - %s = %s\n    - %s += %s\n    - %s %s %s\n", w, first, w, second,
                            field, sign, w));
  } else
    PetscCall(
        PetscSNPrintf(lines, sizeof lines, "    - %s %s %s%s%s\n", field, sign, first, *second ? " + " : "", second));
  (void)snprintf(text, room, around, nodes ? "" : own, nodes ? own : "", nodes ? lines : "", nodes ? "" : lines);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Quiet(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                            PetscErrorType type, const char *text, void *context)
{
  (void)comm;
  (void)line;
  (void)function;
  (void)file;
  (void)type;
  (void)text;
  (void)context;
  return code;
}

static PetscErrorCode IsAllowed(const char text[], PetscBool *allowed)
{
  MpmScene      *scene = NULL;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(Quiet, NULL));
  error = MpmSceneFromText(text, &scene);
  PetscCall(PetscPopErrorHandler());
  CHECK(!error || error == PETSC_ERR_USER_INPUT, "error %d for\n%s", (int)error, text);
  *allowed = error ? PETSC_FALSE : PETSC_TRUE;
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth by the symbol and by all eigenvalues of the assembled step. */
static PetscErrorCode Grows(const char scheme[], const char keys[], PetscReal growth[2])
{
  MpmRequest    request = {.task = "spectrum", .tolerance = 1e-6};
  MpmSymbolWish wish    = {.tolerance = 1e-6};
  MpmScene     *scene;
  MpmSpectrum  *spectrum;
  MpmSymbol    *symbol;
  char          text[8192];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof text, "%s%s", scheme, keys));
  PetscCall(MpmSceneFromText(text, &scene));
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) wish.phases[a] = request.phases[a] = scene->layout.grid[a].cells;
  growth[0] = 0;
  if (!strstr(keys, "fixed")) {
    PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &wish, &symbol));
    growth[0] = symbol->growth;
    PetscCall(MpmSymbolDestroy(&symbol));
  }
  PetscCall(MpmSpectrumCreate(scene, &request, 0, &spectrum));
  growth[1] = spectrum->growth;
  PetscCall(MpmSpectrumDestroy(&spectrum));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckSame(const char one[], const char other[], const char keys[])
{
  PetscReal growth[2][2];

  PetscFunctionBegin;
  PetscCall(Grows(one, keys, growth[0]));
  PetscCall(Grows(other, keys, growth[1]));
  for (int by = 0; by < 2; by++)
    CHECK(fabs(growth[0][by] - growth[1][by]) <= 1e-9 * growth[0][by], "%s: %.12g and %.12g with %s of\n%s%s",
          by ? "spectrum" : "symbol", growth[0][by], growth[1][by], keys, one, other);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- two terms ---- */

static PetscErrorCode CheckPair(PetscInt target, PetscInt a, PetscInt b, PetscBool allowed)
{
  static const char *const factors[][2] = {{"k", "k"}, {"-0.4 k", "0.7"}, {"-k^2", "1"}};
  static const char *const spaces[]     = {"cells: 5\nppc: 2\ncourant: 0.4\n",
                                           "dim: 2\ncells: [2, 3]\nppc: 1\noffset: 1/4\ncourant: 0.4\npoisson: 0.2\n",
                                           "dim: 3\ncells: [2, 2, 2]\nppc: 1\noffset: 1/4\ncourant: 0.4\npoisson: 0.2\n"};

  const PetscInt    turn = a + b;
  const char *const sign = turn % 2 || !targets[target].on_nodes ? "+=" : "=";
  char              first[64], second[64], sum[4096], apart[4096];
  PetscBool         is;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(first, sizeof first, "%s %s", factors[turn % 3][0], terms[a]));
  PetscCall(PetscSNPrintf(second, sizeof second, "%s %s", factors[turn % 3][1], terms[b]));
  PetscCall(Write(target, sign, first, second, PETSC_FALSE, sizeof sum, sum));
  PetscCall(Write(target, sign, first, second, PETSC_TRUE, sizeof apart, apart));
  PetscCall(IsAllowed(sum, &is));
  CHECK(is == allowed, "%s, which is %s in lines of its terms:\n%s", is ? "allowed" : "refused",
        allowed ? "allowed" : "refused", sum);
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(spaces) && allowed; s++) PetscCall(CheckSame(sum, apart, spaces[s]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckTarget(PetscInt target)
{
  PetscBool allowed[TERMS];
  PetscInt  n = 0;
  char      text[4096];

  PetscFunctionBegin;
  for (PetscInt t = 0; t < TERMS; t++) {
    PetscCall(Write(target, "+=", terms[t], "", PETSC_FALSE, sizeof text, text));
    PetscCall(IsAllowed(text, &allowed[t]));
    n += allowed[t];
  }
  CHECK(n >= 4, "%s: %d terms fit", targets[target].field, (int)n);
  for (PetscInt a = 0; a < TERMS; a++)
    for (PetscInt b = 0; b < TERMS; b++)
      if (allowed[a] && (b >= a || !allowed[b])) PetscCall(CheckPair(target, a, b, allowed[b]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what a field of nodes holds ---- */

/* A filter where the nodes hold no P2G of its field any more is P2G anew, as the lines of pic say it. */
static PetscErrorCode CheckFiltered(void)
{
  static const char        bar[]      = "scheme:\n  name: held\n  particles: {v: vector, s: stress}\n"
                                        "  nodes: {v_i: vector, a_i: vector, w_i: vector}\n  step:\n"
                                        "    - w_i = P2G v\n    - a_i = -k DIV s\n%s    - s += k STRESS GRAD v_i\n%s"
                                        "    - v += G2P a_i + 0.1 G2P w_i\n    - DRIFT\n";
  static const char *const velocity[] = {"    - v_i = P2G v\n", "    - v_i = P2G v\n    - v_i += 3 k P2G v\n",
                                         "    - v_i = 2 P2G v\n", "    - v_i = P2G v\n    - v_i = 0.5 v_i + w_i\n"};
  char                     named[1024], lines[1024];

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(velocity); i++) {
    (void)snprintf(named, sizeof named, bar, velocity[i], "    - FILTER_AFTER v v_i\n");
    PetscCall(PetscStrlcat(named, "transfer: pic\n", sizeof named));
    (void)snprintf(lines, sizeof lines, bar, velocity[i], "    - v_i = P2G v\n    - v = G2P v_i\n");
    PetscCall(CheckSame(named, lines, "cells: 6\ncourant: 0.9\n"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What fmpm makes of a field before IMPOSE is not what it makes of the field after. */
static PetscErrorCode CheckSharpened(void)
{
  static const char bar[] = "scheme:\n  name: walls\n  particles: {v: vector, s: stress, r: scalar}\n"
                            "  nodes: {v_i: vector, a_i: vector, r_i: scalar%s}\n  step:\n"
                            "    - v_i = P2G v\n    - r = 0.1 GRAD . v_i\n    - IMPOSE v_i\n    - FILTER v v_i\n%s"
                            "    - r_i = P2G r\n    - a_i = -k DIV s\n    - REACT a_i v_i\n"
                            "    - v += G2P a_i + 0.1 GRAD r_i\n    - DRIFT\ntransfer: fmpm\n";
  char              same[1024], other[1024];

  PetscFunctionBegin;
  (void)snprintf(same, sizeof same, bar, "", "    - s += k STRESS GRAD v_i\n");
  (void)snprintf(other, sizeof other, bar, ", w_i: vector", "    - w_i = v_i\n    - s += k STRESS GRAD w_i\n");
  PetscCall(CheckSame(same, other, "cells: 8\nboundary: fixed\ncourant: 1.9\n"));
  PetscCall(CheckSame(same, other, "cells: 8\nboundary: fixed_reaction\ncourant: 1.9\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  for (PetscInt t = 0; t < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(targets); t++) PetscCall(CheckTarget(t));
  PetscCall(CheckFiltered());
  PetscCall(CheckSharpened());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
