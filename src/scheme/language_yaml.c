/* From YAML to a written scheme: its keys, the names of its fields and parameters, its lines. */
#include "scheme/language.h"
#include "base/text.h"
#include "scheme/language_line.h"
#include "base/suggest.h"
#include <mpmstab/errors.h>
#include <ctype.h>
#include <string.h>

#define LONGEST_TEXT 400 /* characters of a line, a name or a reference */

typedef struct {
  yaml_document_t *document;
  MpmWritten      *written;
} Reader;

typedef PetscErrorCode (*ReadKey)(Reader *r, const char key[], const yaml_node_t *node);

static int LineOf(const yaml_node_t *node)
{
  return (int)node->start_mark.line + 1;
}

/* ---- texts ---- */

static PetscErrorCode KeepText(Reader *r, const char key[], const char text[], size_t length, int line,
                               MpmWrittenText *kept)
{
  const char *file = r->written->file;

  PetscFunctionBegin;
  MpmCheckInput(memchr(text, 0, length) == NULL, "%s:%d: %s: a zero byte in its text", file, line, key);
  MpmCheckInput(length <= LONGEST_TEXT, "%s:%d: %s: its text is too long; allowed: %d characters", file, line, key,
                LONGEST_TEXT);
  PetscCall(PetscFree(kept->text));
  PetscCall(PetscMalloc1(length + 1, &kept->text));
  PetscCall(PetscArraycpy(kept->text, text, length));
  kept->text[length] = 0;
  kept->line         = line;
  for (size_t i = 0; i < length; i++)
    MpmCheckInput(!iscntrl((unsigned char)text[i]) || text[i] == '\n' || text[i] == '\t',
                  "%s:%d: %s: a control character in its text", file, line, key);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TextOf(Reader *r, const char key[], const yaml_node_t *node, MpmWrittenText *kept)
{
  PetscFunctionBegin;
  MpmCheckInput(node->type == YAML_SCALAR_NODE && node->data.scalar.length, "%s:%d: %s: allowed: a text",
                r->written->file, LineOf(node), key);
  PetscCall(KeepText(r, key, (const char *)node->data.scalar.value, node->data.scalar.length, LineOf(node), kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Goes through the entries of a mapping, at most room of them. */
static PetscErrorCode EachEntry(Reader *r, const char key[], const yaml_node_t *node, PetscInt room, PetscInt *n,
                                PetscErrorCode (*entry)(Reader *r, PetscInt i, const yaml_node_t *name,
                                                        const yaml_node_t *value))
{
  PetscFunctionBegin;
  MpmCheckInput(node->type == YAML_MAPPING_NODE, "%s:%d: %s: allowed: names with a value each, as {v: vector}",
                r->written->file, LineOf(node), key);
  for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
    const yaml_node_t *name = yaml_document_get_node(r->document, pair->key);

    MpmCheckInput(*n < room, "%s:%d: %s: more than the %" PetscInt_FMT " that fit", r->written->file, LineOf(name), key,
                  room);
    ++*n; /* first, so that what is kept of it is freed when it is refused */
    PetscCall(entry(r, *n - 1, name, yaml_document_get_node(r->document, pair->value)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- names ---- */

/* Whether a particle field's name is that of a component of another, as v_x is of v. */
static PetscBool IsComponent(const char name[], const char of[])
{
  const size_t length = strlen(of);

  return !strncmp(name, of, length) && name[length] == '_' && name[length + 1] &&
                 strspn(name + length + 1, "xyz") == strlen(name + length + 1)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* Names that arrays of particles in memory and files have already; c is an affine part. */
static PetscBool IsReserved(const char name[])
{
  static const char *const names[] = {"c", "x", "y", "z", "id", "cell", "xi", "mass", "volume", "stiffness"};

  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(names); i++)
    if (!strcmp(name, names[i]) || IsComponent(name, names[i])) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscErrorCode CheckName(const MpmWritten *w, const MpmWrittenText *name)
{
  size_t n = 0;

  PetscFunctionBegin;
  while (isalnum((unsigned char)name->text[n]) || name->text[n] == '_') n++;
  if (name->text[n] || isdigit((unsigned char)name->text[0]))
    MpmRefuseLine(w, name, "allowed in a name: letters, digits and _, a letter first");
  if (n > MPM_MOST_NAME) MpmRefuseLine(w, name, "allowed: names of at most %d characters", MPM_MOST_NAME);
  if (MpmWrittenIsWord(name->text)) MpmRefuseLine(w, name, "is a word of the language; allowed: another name");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a name that a field or a parameter has already. */
static PetscErrorCode CheckOnce(const MpmWritten *w)
{
  const MpmWrittenText *names[2 * MPM_MAX_FIELDS + MPM_MOST_PARAMETERS];
  PetscInt              n = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < w->nparticles; i++) names[n++] = &w->particles[i].name;
  for (PetscInt i = 0; i < w->nnodes; i++) names[n++] = &w->nodes[i].name;
  for (PetscInt i = 0; i < w->nparameters; i++) names[n++] = &w->parameters[i].name;
  for (PetscInt i = 0; i < n; i++) PetscCall(CheckName(w, names[i]));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      if (j < i && !strcmp(names[i]->text, names[j]->text))
        MpmRefuseLine(w, names[i], "this name is given a second time; allowed: once");
      if (i < w->nparticles && j < w->nparticles && IsComponent(names[i]->text, names[j]->text))
        MpmRefuseLine(w, names[i], "is a component of %s; allowed: another name", names[j]->text);
    }
  for (PetscInt i = 0; i < w->nparticles; i++)
    if (IsReserved(names[i]->text))
      MpmRefuseLine(w, names[i], "particles have something of this name already; allowed: another name");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- keys ---- */

static PetscErrorCode RankOf(Reader *r, const yaml_node_t *value, MpmRank *rank)
{
  static const char *const names[] = {"scalar", "vector", "stress"};
  MpmWrittenText           text    = {NULL, 0};
  PetscErrorCode           ierr    = PETSC_SUCCESS;
  size_t                   i       = 0;

  PetscFunctionBegin;
  PetscCall(TextOf(r, "a rank", value, &text));
  while (i < 3 && strcmp(text.text, names[i])) i++;
  if (i == 3) ierr = MpmWrittenRefuse(r->written, &text, "allowed as a rank: scalar, vector or stress");
  PetscCall(PetscFree(text.text));
  PetscCall(ierr);
  *rank = (MpmRank)i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OneParticle(Reader *r, PetscInt i, const yaml_node_t *name, const yaml_node_t *value)
{
  PetscFunctionBegin;
  PetscCall(TextOf(r, "particles", name, &r->written->particles[i].name));
  PetscCall(RankOf(r, value, &r->written->particles[i].rank));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Particles(Reader *r, const char key[], const yaml_node_t *node)
{
  PetscFunctionBegin;
  PetscCall(EachEntry(r, key, node, MPM_MAX_FIELDS, &r->written->nparticles, OneParticle));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OneNode(Reader *r, PetscInt i, const yaml_node_t *name, const yaml_node_t *value)
{
  PetscFunctionBegin;
  PetscCall(TextOf(r, "nodes", name, &r->written->nodes[i].name));
  PetscCall(RankOf(r, value, &r->written->nodes[i].rank));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Nodes(Reader *r, const char key[], const yaml_node_t *node)
{
  PetscFunctionBegin;
  PetscCall(EachEntry(r, key, node, MPM_MAX_FIELDS, &r->written->nnodes, OneNode));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OneParameter(Reader *r, PetscInt i, const yaml_node_t *name, const yaml_node_t *value)
{
  PetscFunctionBegin;
  PetscCall(TextOf(r, "parameters", name, &r->written->parameters[i].name));
  PetscCall(TextOf(r, "parameters", value, &r->written->parameters[i].text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Parameters(Reader *r, const char key[], const yaml_node_t *node)
{
  PetscFunctionBegin;
  PetscCall(EachEntry(r, key, node, MPM_MOST_PARAMETERS, &r->written->nparameters, OneParameter));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OneTerm(Reader *r, PetscInt i, const yaml_node_t *name, const yaml_node_t *value)
{
  PetscFunctionBegin;
  PetscCall(TextOf(r, "energy", name, &r->written->energy[i].field));
  PetscCall(TextOf(r, "energy", value, &r->written->energy[i].kind));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Energy(Reader *r, const char key[], const yaml_node_t *node)
{
  PetscFunctionBegin;
  PetscCall(EachEntry(r, key, node, MPM_MAX_FIELDS, &r->written->nenergy, OneTerm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Lines, of the step or of a filter, of which there is room for so many. */
typedef struct {
  const char     *key;
  PetscInt        room, *n;
  MpmWrittenText *line;
} Lines;

static PetscErrorCode AddLine(Reader *r, const Lines *lines, const char text[], size_t length, int line)
{
  PetscFunctionBegin;
  while (length && isspace((unsigned char)*text)) {
    text++;
    length--;
  }
  while (length && isspace((unsigned char)text[length - 1])) length--;
  if (!length) PetscFunctionReturn(PETSC_SUCCESS);
  MpmCheckInput(*lines->n < lines->room, "%s:%d: %s: more than the %" PetscInt_FMT " lines that fit", r->written->file,
                line, lines->key, lines->room);
  ++*lines->n;
  PetscCall(KeepText(r, lines->key, text, length, line, &lines->line[*lines->n - 1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A list with a line each, or one text of several lines. */
static PetscErrorCode ReadLines(Reader *r, const Lines *lines, const yaml_node_t *node)
{
  const char *key = lines->key;

  PetscFunctionBegin;
  if (node->type == YAML_SCALAR_NODE) {
    const char *text = (const char *)node->data.scalar.value, *end = text + node->data.scalar.length;
    int         line = LineOf(node) + (node->data.scalar.style == YAML_LITERAL_SCALAR_STYLE ? 1 : 0);

    for (; text < end; line++) {
      const char *next = memchr(text, '\n', (size_t)(end - text));

      if (!next) next = end;
      PetscCall(AddLine(r, lines, text, (size_t)(next - text), line));
      text = next + 1;
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  MpmCheckInput(node->type == YAML_SEQUENCE_NODE, "%s:%d: %s: allowed: a list of lines, as '- v_i = P2G v'",
                r->written->file, LineOf(node), key);
  for (const yaml_node_item_t *i = node->data.sequence.items.start; i < node->data.sequence.items.top; i++) {
    const yaml_node_t *item = yaml_document_get_node(r->document, *i);

    MpmCheckInput(item->type == YAML_SCALAR_NODE && item->data.scalar.length,
                  "%s:%d: %s: allowed: a list of lines, as '- v_i = P2G v'", r->written->file, LineOf(item), key);
    PetscCall(AddLine(r, lines, (const char *)item->data.scalar.value, item->data.scalar.length, LineOf(item)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Step(Reader *r, const char key[], const yaml_node_t *node)
{
  const Lines lines = {key, MPM_MOST_LINES_OF_STEP, &r->written->nstep, r->written->step};

  PetscFunctionBegin;
  PetscCall(ReadLines(r, &lines, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OneText(Reader *r, const char key[], const yaml_node_t *node)
{
  const struct {
    const char     *key;
    MpmWrittenText *text;
  } texts[] = {{"name", &r->written->name},           {"reference", &r->written->reference},
               {"summary", &r->written->summary},     {"wave", &r->written->wave},
               {"staggered", &r->written->staggered}, {"affine", &r->written->affine},
               {"conserved", &r->written->conserved}};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(texts); i++)
    if (!strcmp(key, texts[i].key)) PetscCall(TextOf(r, key, node, texts[i].text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  const char *name;
  ReadKey     read;
} Key;

#define MOST_KEYS 16

static PetscErrorCode FindKey(const Reader *r, const char what[], size_t n, const Key keys[], const yaml_node_t *node,
                              size_t *at)
{
  const char *names[MOST_KEYS], *near, *key;
  char        all[256] = "";

  PetscFunctionBegin;
  MpmCheckInput(node->type == YAML_SCALAR_NODE, "%s:%d: %s: allowed: lines of the form key: value", r->written->file,
                LineOf(node), what);
  key = (const char *)node->data.scalar.value;
  for (*at = 0; *at < n; ++*at) {
    if (!strcmp(key, keys[*at].name)) PetscFunctionReturn(PETSC_SUCCESS);
    names[*at] = keys[*at].name;
    MpmTextJoin(all, *at == 0 ? "" : *at < n - 1 ? ", " : " and ", sizeof all);
    MpmTextJoin(all, names[*at], sizeof all);
  }
  near = MpmSuggest(key, (PetscInt)n, names);
  MpmRefuse("%s:%d: unknown key '%.100s' in a %s; allowed: %s%s%s%s", r->written->file, LineOf(node), key, what, all,
            near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
}

/* Reads the keys of a mapping, which is what a message calls it. */
static PetscErrorCode ReadMapping(Reader *r, const char what[], size_t n, const Key keys[], const yaml_node_t *node)
{
  const MpmWritten *w               = r->written;
  PetscBool         seen[MOST_KEYS] = {PETSC_FALSE};

  PetscFunctionBegin;
  MpmCheckInput(node->type == YAML_MAPPING_NODE, "%s:%d: %s: allowed: lines of the form key: value", w->file,
                LineOf(node), what);
  for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
    const yaml_node_t *name = yaml_document_get_node(r->document, pair->key);
    size_t             at;

    PetscCall(FindKey(r, what, n, keys, name, &at));
    MpmCheckInput(!seen[at], "%s:%d: key '%s' is given a second time; allowed: once", w->file, LineOf(name),
                  keys[at].name);
    seen[at] = PETSC_TRUE;
    PetscCall(keys[at].read(r, keys[at].name, yaml_document_get_node(r->document, pair->value)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- transfers ---- */

static PetscErrorCode TransferName(Reader *r, const char key[], const yaml_node_t *node)
{
  PetscFunctionBegin;
  PetscCall(TextOf(r, key, node, &r->written->transfer.name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The fields that a filter has besides q and g. They are of their rank. */
static PetscErrorCode TransferFields(Reader *r, const char key[], const yaml_node_t *node)
{
  MpmWrittenTransfer *t    = &r->written->transfer;
  const PetscBool     on   = !strcmp(key, "nodes") ? PETSC_TRUE : PETSC_FALSE;
  PetscInt           *n    = on ? &t->nnodes : &t->nparticles;
  MpmWrittenText     *name = on ? t->node : t->particle;

  PetscFunctionBegin;
  MpmCheckInput(node->type == YAML_SEQUENCE_NODE, "%s:%d: %s of a transfer: allowed: a list of names, as [a, b]",
                r->written->file, LineOf(node), key);
  for (const yaml_node_item_t *i = node->data.sequence.items.start; i < node->data.sequence.items.top; i++) {
    const yaml_node_t *item = yaml_document_get_node(r->document, *i);

    MpmCheckInput(*n < MPM_MAX_FIELDS - 1, "%s:%d: %s of a transfer: more than the %d that fit", r->written->file,
                  LineOf(item), key, MPM_MAX_FIELDS - 1);
    ++*n;
    PetscCall(TextOf(r, key, item, &name[*n - 1]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TransferLines(Reader *r, const char key[], const yaml_node_t *node)
{
  MpmWrittenTransfer *t     = &r->written->transfer;
  const Lines         lines = {key, MPM_MOST_LINES_OF_FILTER, &t->nlines, t->lines};

  PetscFunctionBegin;
  PetscCall(ReadLines(r, &lines, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Transfer(Reader *r, const char key[], const yaml_node_t *node)
{
  static const Key keys[] = {{"name", TransferName},
                             {"parameters", Parameters},
                             {"particles", TransferFields},
                             {"nodes", TransferFields},
                             {"filter", TransferLines}};

  const MpmWrittenTransfer *t = &r->written->transfer;

  PetscFunctionBegin;
  PetscCall(ReadMapping(r, key, PETSC_STATIC_ARRAY_LENGTH(keys), keys, node));
  MpmCheckInput(t->name.text && t->nlines, "%s:%d: transfer: '%s' is missing; allowed: a transfer with name and filter",
                r->written->file, LineOf(node), t->name.text ? "filter" : "name");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- a scheme ---- */

/* A text with a transfer and nothing else is for a formulation of the program. */
static PetscBool IsTransferAlone(const MpmWritten *w)
{
  return w->transfer.name.text && !w->name.text && !w->reference.text && !w->summary.text && !w->wave.text &&
                 !w->staggered.text && !w->affine.text && !w->conserved.text && !w->nparticles && !w->nnodes &&
                 !w->nstep && !w->nenergy
             ? PETSC_TRUE
             : PETSC_FALSE;
}

static PetscErrorCode ReadScheme(Reader *r, const yaml_node_t *node)
{
  static const Key keys[] = {{"name", OneText},          {"reference", OneText}, {"summary", OneText},
                             {"particles", Particles},   {"nodes", Nodes},       {"step", Step},
                             {"parameters", Parameters}, {"energy", Energy},     {"wave", OneText},
                             {"staggered", OneText},     {"affine", OneText},    {"conserved", OneText},
                             {"transfer", Transfer}};

  const MpmWritten *w = r->written;

  PetscFunctionBegin;
  PetscCall(ReadMapping(r, "scheme", PETSC_STATIC_ARRAY_LENGTH(keys), keys, node));
  if (IsTransferAlone(w)) PetscFunctionReturn(PETSC_SUCCESS);
  MpmCheckInput(w->name.text && w->nparticles && w->nnodes && w->nstep,
                "%s:%d: scheme: '%s' is missing; allowed: a scheme with name, particles, nodes and step", w->file,
                w->line,
                !w->name.text    ? "name"
                : !w->nparticles ? "particles"
                : !w->nnodes     ? "nodes"
                                 : "step");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The name of a scheme or a transfer is printed in tables, in CSV and on pictures. */
static PetscErrorCode CheckShownName(const MpmWritten *w, const MpmWrittenText *name)
{
  PetscFunctionBegin;
  if (name->text && (strpbrk(name->text, ",\"'\n\t{}") || strlen(name->text) > 60))
    MpmRefuseLine(w, name, "allowed as a name: up to 60 characters without commas, quotes and braces");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The names of a filter are its own, but for parameters. */
static PetscErrorCode CheckTransfer(const MpmWritten *w)
{
  static char               q[] = "q", g[] = "g";
  const MpmWrittenTransfer *t = &w->transfer;
  const MpmWrittenText     *names[2 * MPM_MAX_FIELDS + MPM_MOST_PARAMETERS];
  const MpmWrittenText      own[] = {{q, 0}, {g, 0}};
  PetscInt                  n     = 0;

  PetscFunctionBegin;
  if (!t->name.text) PetscFunctionReturn(PETSC_SUCCESS);
  if (MpmTransferFind(t->name.text))
    MpmRefuseLine(w, &t->name, "this name is taken by a transfer of the program; allowed: another name");
  for (PetscInt i = 0; i < 2; i++) names[n++] = &own[i];
  for (PetscInt i = 0; i < t->nparticles; i++) names[n++] = &t->particle[i];
  for (PetscInt i = 0; i < t->nnodes; i++) names[n++] = &t->node[i];
  for (PetscInt i = 0; i < w->nparameters; i++) names[n++] = &w->parameters[i].name;
  for (PetscInt i = 2; i < n; i++) {
    PetscCall(CheckName(w, names[i]));
    for (PetscInt j = 0; j < i; j++)
      if (!strcmp(names[i]->text, names[j]->text))
        MpmRefuseLine(w, names[i],
                      j < 2 ? "a filter has a field of this name already; allowed: another name"
                            : "this name is given a second time; allowed: once");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWrittenFromYaml(const char file[], yaml_document_t *document, const yaml_node_t *node,
                                  MpmWritten **written)
{
  Reader r = {.document = document};

  PetscFunctionBegin;
  PetscCall(PetscNew(written));
  r.written = *written;
  PetscCall(PetscStrncpy(r.written->file, file, sizeof r.written->file));
  r.written->line = LineOf(node);
  PetscCall(ReadScheme(&r, node));
  PetscCall(CheckShownName(r.written, &r.written->name));
  PetscCall(CheckShownName(r.written, &r.written->transfer.name));
  PetscCall(CheckOnce(r.written));
  PetscCall(CheckTransfer(r.written));
  if (r.written->wave.text && r.written->nparticles == 2 && r.written->particles[0].rank != MPM_VECTOR &&
      r.written->particles[1].rank == MPM_VECTOR) { /* exact solutions have the vector first */
    const MpmWrittenField first = r.written->particles[0];

    r.written->particles[0] = r.written->particles[1];
    r.written->particles[1] = first;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWrittenDestroy(MpmWritten **written)
{
  MpmWritten *w = *written;

  PetscFunctionBegin;
  if (!w) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(w->name.text));
  PetscCall(PetscFree(w->reference.text));
  PetscCall(PetscFree(w->summary.text));
  PetscCall(PetscFree(w->wave.text));
  PetscCall(PetscFree(w->staggered.text));
  PetscCall(PetscFree(w->affine.text));
  PetscCall(PetscFree(w->conserved.text));
  for (PetscInt i = 0; i < w->nparticles; i++) PetscCall(PetscFree(w->particles[i].name.text));
  for (PetscInt i = 0; i < w->nnodes; i++) PetscCall(PetscFree(w->nodes[i].name.text));
  for (PetscInt i = 0; i < w->nstep; i++) PetscCall(PetscFree(w->step[i].text));
  for (PetscInt i = 0; i < w->nparameters; i++) {
    PetscCall(PetscFree(w->parameters[i].name.text));
    PetscCall(PetscFree(w->parameters[i].text.text));
  }
  for (PetscInt i = 0; i < w->nenergy; i++) {
    PetscCall(PetscFree(w->energy[i].field.text));
    PetscCall(PetscFree(w->energy[i].kind.text));
  }
  PetscCall(PetscFree(w->transfer.name.text));
  for (PetscInt i = 0; i < w->transfer.nparticles; i++) PetscCall(PetscFree(w->transfer.particle[i].text));
  for (PetscInt i = 0; i < w->transfer.nnodes; i++) PetscCall(PetscFree(w->transfer.node[i].text));
  for (PetscInt i = 0; i < w->transfer.nlines; i++) PetscCall(PetscFree(w->transfer.lines[i].text));
  PetscCall(PetscFree(*written));
  PetscFunctionReturn(PETSC_SUCCESS);
}
