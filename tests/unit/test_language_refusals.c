/*
   What a scheme as text may not say: each refusal names the file, the line and what is wrong there. The file is called
   'text', and the scheme of the tests begins in its first line.
*/
#include "check.h"
#include "scene/settings.h"

static char message[4096];

/* Keeps the first message of an error instead of printing it. */
static PetscErrorCode Keep(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                           PetscErrorType type, const char *text, void *context)
{
  (void)comm;
  (void)line;
  (void)function;
  (void)file;
  (void)context;
  if (type == PETSC_ERROR_INITIAL) (void)snprintf(message, sizeof message, "%s", text);
  return code;
}

static PetscErrorCode Refuses(const char text[], const char expected[])
{
  MpmScene      *scene = NULL;
  PetscErrorCode error;

  PetscFunctionBegin;
  message[0] = 0;
  PetscCall(PetscPushErrorHandler(Keep, NULL));
  error = MpmSceneFromText(text, &scene);
  PetscCall(PetscPopErrorHandler());
  CHECK(error == PETSC_ERR_USER_INPUT && !scene, "error %d for\n%s", (int)error, text);
  CHECK(strstr(message, expected), "'%s'\nand not '%s' for\n%s", message, expected, text);
  if (!error) PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The scheme of these tests: line 5 on are its step, in which one line is replaced, or added after the last with 0. */
static const char *const head   = "scheme:\n"
                                  "  name: probe\n"
                                  "  particles: {v: vector, s: stress, r: scalar}\n"
                                  "  nodes: {v_i: vector, a_i: vector, r_i: scalar}\n";
static const char *const step[] = {"v_i = P2G v",  "a_i = -k DIV s",         "r_i = P2G r", "v += G2P a_i",
                                   "r += G2P r_i", "s += k STRESS GRAD v_i", "DRIFT"};

/* Line n of the step is number n + 5 of the text, since 'step:' is number 5; line is then what stands there. */
static PetscErrorCode RefusesLine(PetscInt n, const char line[], const char expected[])
{
  char text[4096], all[512];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof text, "%s  step:\n", head));
  for (PetscInt i = 0; i < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(step); i++) {
    PetscCall(PetscStrlcat(text, "    - ", sizeof text));
    PetscCall(PetscStrlcat(text, i == n - 1 ? line : step[i], sizeof text));
    PetscCall(PetscStrlcat(text, "\n", sizeof text));
  }
  PetscCall(PetscSNPrintf(all, sizeof all, "text:%d: %s: %s", (int)n + 5, line, expected));
  PetscCall(Refuses(text, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The scheme of these tests with more keys, which begin in line 13. */
static PetscErrorCode RefusesKeys(const char keys[], const char expected[])
{
  char text[8192];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof text, "%s  step:\n", head));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(step); i++) {
    PetscCall(PetscStrlcat(text, "    - ", sizeof text));
    PetscCall(PetscStrlcat(text, step[i], sizeof text));
    PetscCall(PetscStrlcat(text, "\n", sizeof text));
  }
  PetscCall(PetscStrlcat(text, keys, sizeof text));
  PetscCall(Refuses(text, expected));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckLines(void)
{
  static const struct {
    PetscInt    n;
    const char *line, *expected;
  } lines[] = {
      {2, "a_i = -k DIV t", "there is no field or parameter t; allowed: v, s, r, v_i, a_i, r_i"},
      {2, "b_i = -k DIV s", "there is no field or parameter b_i; allowed"},
      {2, "a_i = -k DIV v_i", "DIV takes a field of particles, and v_i is one of nodes"},
      {2, "a_i = -k DIV v", "a_i is a vector and v a vector; DIV does not fit; allowed: DIV makes"},
      {3, "r_i = P2G v",
       "r_i is a scalar and v a vector; P2G does not fit; allowed: P2G makes a field of the same rank"},
      {4, "v += G2P r_i", "v is a vector and r_i a scalar; G2P does not fit"},
      {4, "v += k GRAD . v_i",
       "v is a vector and v_i a vector; GRAD . does not fit; allowed: GRAD . makes a scalar of a vector"},
      {4, "v += k STRESS GRAD r_i",
       "v is a vector and r_i a scalar; STRESS GRAD does not fit; allowed: STRESS GRAD makes a stress of"},
      {4, "v += a_i", "a_i is of nodes, and v of particles; allowed: P2G takes"},
      {4, "v += P2G v", "P2G v is of nodes, and v of particles"},
      {4, "v += r", "v is a vector and r a scalar; allowed: a term makes a field of the same rank"},
      {3, "r_i = v_i", "r_i is a scalar and v_i a vector; allowed"},
      {1, "v_i = a_i", "a_i is read before the step has set it; allowed: after a line 'a_i = ...'"},
      {1, "v_i += P2G v", "v_i is added to before the step has set it"},
      {1, "v_i = -k DIV s", "DIV comes before the nodes have masses; allowed: after a line with P2G"},
      {4, "IMPOSE v", "v is a field of particles; allowed here: one of nodes"},
      {2, "IMPOSE a_i", "a_i is imposed before the step has set it"},
      {4, "REACT a_i v_i", "v_i has not been imposed; allowed: after IMPOSE v_i"},
      {4, "FILTER v a_i", "a_i is not P2G of v here"},
      {4, "FILTER r v_i", "r is a scalar and v_i a vector; allowed: fields of the same rank"},
      {4, "FILTER v", "the name of a field is missing"},
      {4, "v += G2P a_i +", "something is missing at its end"},
      {4, "v += G2P (a_i", "a bracket is not closed"},
      {4, "v += G2P a_i v_i", "a product of two fields; allowed: linear combinations"},
      {4, "v += G2P P2G v", "G2P acts on the result of an operation; allowed: give that a line of its own"},
      {4, "v += G2P 0.5", "G2P acts on a number; allowed: on a field"},
      {4, "v += G2P a_i + 1", "a sum of a number and a field"},
      {4, "v += G2P a_i / k", "allowed: to divide by numbers that are not 0"},
      {4, "v += G2P a_i / 0", "allowed: to divide by numbers that are not 0"},
      {4, "v += k^9 G2P a_i", "allowed: powers of numbers, from 0 to 8"},
      {4, "v += k^8 k G2P a_i", "allowed: powers of k up to 8"},
      {4, "v += 1e999 G2P a_i", "1e999 is not a finite number"},
      {4, "v += 1e300 1e300 G2P a_i", "a factor is not a finite number"},
      {4, "v ~ G2P a_i",
       "allowed: field = ..., field += ..., field -= ..., IMPOSE, REACT, FILTER, MOVE, IMPLICIT or DRIFT"},
      {4, "v =+ G2P a_i", "'=+' is not allowed; did you mean +=?"},
      {4, "v += GRAD ; a_i", "';' is not expected here"},
      {4, "v += STRESS DIV a_i", "STRESS acts on a gradient; allowed: STRESS GRAD field"},
      {4, "v += 0.5", "there is no field on its right side"},
      {4, "MOVE k v_i", "allowed: a field of nodes, or a number times such a field"},
      {4, "MOVE v_i + a_i", "'+ a_i' is not expected here"},
      {4, "MOVE (1 - 0.5) v", "allowed: a field of nodes, or a number times such a field"},
      {4, "v = (1 - k + k^2) v + G2P a_i", "the factor of v has three powers of k; allowed: two"},
      {4, "v += ((((((((((((((((((((((((((((G2P a_i", "too many brackets inside one another"},
  };

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(lines); i++)
    PetscCall(RefusesLine(lines[i].n, lines[i].line, lines[i].expected));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A transfer alone, whose filter begins in line 6. */
static PetscErrorCode CheckTransfers(void)
{
  static const struct {
    const char *lines, *expected;
  } filters[] = {
      {"['g = P2G q']", "text:6: g = P2G q: g belongs to the step"},
      {"['a = G2P g']", "text:6: a = G2P g: G2P g is of particles, and a of nodes"},
      {"['a = DIV q']", "text:6: a = DIV q: a filter acts on each component by itself"},
      {"['FILTER q g']", "text:6: FILTER q g: this stands in the step"},
      {"[DRIFT]", "text:6: DRIFT: this stands in the step"},
      {"['a = v']", "text:6: a = v: there is no field or parameter v; allowed: q, p, g, a"},
      {"['a = P2G p', 'q = G2P a']", "text:6: a = P2G p: p lasts until it has gone to the nodes; allowed: P2G p in"},
      {"['p = G2P g', 'q += p']", "text:6: q += p: p lasts until it has gone to the nodes"},
      {"['p = G2P g', 'q = 0.5 q', 'a = P2G p']", "text:6: a = P2G p: p lasts until it has gone to the nodes"},
      {"['p += G2P g']", "text:6: p += G2P g: allowed for a field of particles other than q: field = ..."},
      {"['p = G2P g', 'a = P2G p']", "text:3: probe: no line of its filter sets q"},
      {"['q = G2P g']", "text:4: p: nothing reads this field"},
      {"['p = G2P g', 'a = P2G p', 'q = G2P g']", "text:5: a: nothing reads this field"},
      {"[]", "transfer: 'filter' is missing"},
      {"{q: 1}", "text:6: filter: allowed: a list of lines"},
  };
  char text[512];

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(filters); i++) {
    PetscCall(
        PetscSNPrintf(text, sizeof text,
                      "scheme:\n  transfer:\n    name: probe\n    particles: [p]\n    nodes: [a]\n    filter: %s\n",
                      filters[i].lines));
    PetscCall(Refuses(text, filters[i].expected));
  }
  PetscCall(RefusesKeys("  transfer: {name: probe, filter: [q = G2P g]}\n", "text:13: probe: the step has no FILTER"));
  PetscCall(RefusesKeys("  transfer: {name: pic, filter: [q = G2P g]}\n", "text:13: pic: this name is taken by a"));
  PetscCall(RefusesKeys("  transfer: {name: probe, nodes: [q], filter: [q = G2P g]}\n",
                        "text:13: q: a filter has a field of this name already"));
  PetscCall(
      RefusesKeys("  transfer: {name: probe, filter: [q = G2P g], step: [DRIFT]}\n",
                  "text:13: unknown key 'step' in a transfer; allowed: name, parameters, particles, nodes and filter"));
  PetscCall(Refuses("transfer: pic\nscheme:\n  transfer: {name: probe, filter: [q = G2P g]}\n",
                    "text:1: transfer: pic: the scheme has the transfer probe of its own; allowed: one of the two"));
  PetscCall(Refuses("formulation: usl\nscheme:\n  name: x\n  particles: {v: vector}\n  nodes: {v_i: vector}\n"
                    "  step: [v_i = P2G v, v = G2P v_i, DRIFT]\n",
                    "formulation and scheme are both given in text; allowed: one of them"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckKeys(void)
{
  PetscFunctionBegin;
  PetscCall(RefusesKeys("  wavs: gas\n", "text:13: unknown key 'wavs' in a scheme; allowed"));
  PetscCall(RefusesKeys("  wavs: gas\n", "did you mean wave?"));
  PetscCall(RefusesKeys("  wave: sea\n", "text:13: sea: allowed as wave: gas, bar or momentum"));
  PetscCall(RefusesKeys("  wave: momentum\n",
                        "text:13: momentum: its exact solutions are of a vector and a stress; allowed"));
  PetscCall(RefusesKeys("  energy: {v: compliance}\n", "text:13: compliance: v is no stress; allowed: mass"));
  PetscCall(RefusesKeys("  energy: {v_i: mass}\n", "text:13: mass: v_i is a field of nodes; allowed: difference"));
  PetscCall(RefusesKeys("  energy: {w: mass}\n", "text:13: w: there is no such field"));
  PetscCall(RefusesKeys("  affine: s\n", "text:13: s: is no vector"));
  PetscCall(RefusesKeys("  staggered: v_i\n", "text:13: v_i: is a field of nodes; allowed: one of particles"));
  PetscCall(RefusesKeys("  name: again\n", "text:13: key 'name' is given a second time; allowed: once"));
  PetscCall(RefusesKeys("  parameters: {v: 1}\n", "text:13: v: this name is given a second time"));
  PetscCall(RefusesKeys("  parameters: {P2G: 1}\n", "text:13: P2G: is a word of the language"));
  PetscCall(RefusesKeys("  parameters: {a-b: 1}\n", "text:13: a-b: allowed in a name: letters, digits and _"));
  PetscCall(RefusesKeys("  parameters: {mix: 1}\n", "text:13: mix: nothing reads this parameter"));
  PetscCall(RefusesKeys("  parameters: {courant: 1}\n",
                        "text:13: parameter courant: that is the name of an option; allowed: another name"));
  PetscCall(RefusesKeys("  parameters:\n    a: 1 - b\n    b: 2 a\n",
                        "is defined by itself, in a cycle; allowed: parameters that end in numbers"));
  PetscCall(RefusesKeys("  parameters: {a: 2 k}\n", "text:13: 2 k: a parameter is a number; allowed: k in lines"));
  PetscCall(RefusesKeys("  parameters: {a: 2 b}\n", "text:13: 2 b: there is no parameter b"));
  PetscCall(RefusesKeys("transfer: pic\n", "text:13: transfer: pic: probe has no FILTER"));
  PetscCall(RefusesKeys("transfer: apic\n", "text:13: transfer: apic: probe has no FILTER"));
  PetscCall(RefusesKeys("boundary: fixed\n", "text:13: boundary: fixed: probe has no IMPOSE"));
  PetscCall(RefusesKeys("formulation: usl\n", "formulation and scheme are both given in text; allowed: one of them"));
  PetscCall(RefusesKeys("mix: 1\n", "text:13: unknown key 'mix'"));
  PetscCall(RefusesKeys("scheme: other.yaml\n", "text:13: key 'scheme' is given a second time"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Faults of the whole: what nothing sets or reads, names that are taken, more than fits. */
static PetscErrorCode CheckWhole(void)
{
  char text[8192];

  PetscFunctionBegin;
  PetscCall(Refuses("scheme:\n  name: x\n  particles: {v: vector}\n  nodes: {v_i: vector, b_i: scalar}\n  step:\n"
                    "    - v_i = P2G v\n    - v += G2P v_i\n    - DRIFT\n",
                    "text:4: b_i: no line sets this field of nodes"));
  PetscCall(Refuses("scheme:\n  name: x\n  particles: {v: vector}\n  nodes: {v_i: vector, b_i: vector}\n  step:\n"
                    "    - v_i = P2G v\n    - b_i = v_i\n    - v += G2P v_i\n    - DRIFT\n",
                    "text:4: b_i: nothing reads this field of nodes"));
  PetscCall(Refuses("scheme:\n  name: x\n  particles: {v: vector, d: vector}\n  nodes: {v_i: vector}\n  step:\n"
                    "    - v_i = P2G v\n    - d += k G2P v_i\n    - DRIFT\n",
                    "text:3: d: nothing reads this field of particles"));
  PetscCall(Refuses("scheme:\n  name: x\n  particles: {v: vector}\n  nodes: {v_i: vector}\n  step:\n"
                    "    - v_i = P2G v\n    - v += G2P v_i\n",
                    "text:2: x: its step has no DRIFT; allowed: DRIFT as the last line"));
  PetscCall(Refuses("scheme:\n  name: x\n  particles: {v: vector}\n  nodes: {v_i: vector}\n  step:\n"
                    "    - v_i = P2G v\n    - DRIFT\n    - v += G2P v_i\n",
                    "text:8: v += G2P v_i: a line comes after DRIFT"));
  PetscCall(Refuses("scheme:\n  name: usl\n  particles: {v: vector}\n  nodes: {v_i: vector}\n  step:\n"
                    "    - v_i = P2G v\n    - v += G2P v_i\n    - DRIFT\n",
                    "text:2: usl: this name is taken by a formulation of the program"));
  PetscCall(Refuses("scheme:\n  name: x\n  particles: {v: tensor}\n",
                    "text:3: tensor: allowed as a rank: scalar, vector or stress"));
  PetscCall(
      Refuses("scheme:\n  name: x\n  particles: {v: vector, v_x: scalar}\n  nodes: {v_i: vector}\n  step: [DRIFT]\n",
              "text:3: v_x: is a component of v"));
  PetscCall(Refuses("scheme:\n  name: x\n  particles: {xi: vector}\n  nodes: {v_i: vector}\n  step: [DRIFT]\n",
                    "text:3: xi: particles have something of this name already"));
  PetscCall(Refuses("scheme:\n  name: x\n  particles: {gone: vector}\n  nodes: {v_i: vector}\n  step: [DRIFT]\n",
                    "text:3: gone: particles have something of this name already"));
  PetscCall(Refuses(
      "scheme:\n  name: x\n  particles: {z: vector, y: vector}\n  nodes: {v_i: vector}\n", /* names of their own */
      "scheme: 'step' is missing; allowed: a scheme with name, particles, nodes and step"));
  PetscCall(Refuses("scheme:\n  name: x\n  particles: {v: vector}\n  nodes: {v_i: vector}\n",
                    "scheme: 'step' is missing; allowed: a scheme with name, particles, nodes and step"));
  PetscCall(Refuses("scheme:\n  name: x\n  particles: {v: vector\n", "text:4: not YAML: "));
  PetscCall(Refuses("scheme:\n  name: x\n\tparticles: {v: vector}\n", ", in column 1; allowed: lines of the form"));
  PetscCall(PetscStrncpy(text, "scheme:\n  name: x\n  particles:\n", sizeof text));
  for (int i = 0; i < 65; i++) (void)snprintf(text + strlen(text), 32, "    f%d: scalar\n", i);
  PetscCall(Refuses(text, "text:68: particles: more than the 64 that fit"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fields that fit in one dimension and do not in three. */
static PetscErrorCode CheckRegisters(void)
{
  char text[8192] = "dim: 3\nscheme:\n  name: many\n  particles: {s: stress}\n  nodes:\n";

  PetscFunctionBegin;
  for (int i = 0; i < 12; i++) (void)snprintf(text + strlen(text), 32, "    s_%d: stress\n", i);
  PetscCall(PetscStrlcat(text, "  step:\n    - s_0 = P2G s\n", sizeof text));
  for (int i = 1; i < 12; i++) (void)snprintf(text + strlen(text), 40, "    - s_%d = s_%d\n", i, i - 1);
  PetscCall(PetscStrlcat(text, "    - s += G2P s_11\n    - DRIFT\n", sizeof text));
  PetscCall(
      Refuses(text, "text:3: scheme many: more than the 64 numbers that fit at a node, with dim 3 and transfer flip"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckLines());
  PetscCall(CheckKeys());
  PetscCall(CheckTransfers());
  PetscCall(CheckWhole());
  PetscCall(CheckRegisters());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
