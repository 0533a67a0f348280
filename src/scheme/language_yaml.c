/*
   The text of a scheme: from YAML to its keys, the names of its fields and parameters, its lines; back to YAML; its
   hash.
*/
#include "base/hash.h"
#include "base/text.h"
#include "scheme/language_compile.h"
#include "base/suggest.h"
#include <mpmstab/errors.h>
#include <ctype.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST_TEXT 400 /* characters of a line, a name or a reference */

typedef struct {
  yaml_document_t *document;
  MpmWritten      *written;
} Reader;

/*
   What the value of a key is: a text, which may need quotes; names with a rank, or a text, each; lines; names; or the
   keys of a transfer.
*/
typedef enum { A_TEXT, QUOTED, RANKS, TEXTS, LINES, NAMES, TRANSFER } Kind;

/* Whether a key tells schemes apart: no; its texts do; and the end of its list, too. */
typedef enum { UNMIXED, MIXED, MIXED_LIST } Mixing;

/* A key: where in MpmWritten its texts are, and their number; the bytes from one to the next; how many fit. */
typedef struct {
  const char *name;
  Mixing      mixing;
  Kind        kind;
  size_t      at, n, size;
  PetscInt    room;
} Key;

#define AT(member) offsetof(MpmWritten, member)
#define ONE_TEXT(kind, member) kind, AT(member), 0, 0, 1
#define MANY(kind, member, n, room) kind, AT(member), AT(n), sizeof *((MpmWritten *)0)->member, room
#define NKEYS(keys) PETSC_STATIC_ARRAY_LENGTH(keys)

/* In the order in which they are printed and mixed. Parameters are printed as those of the scheme. */
static const Key of_transfer[] = {
    {"name", UNMIXED, ONE_TEXT(A_TEXT, transfer.name)},
    {"parameters", UNMIXED, MANY(TEXTS, parameters, nparameters, MPM_MOST_PARAMETERS)},
    {"particles", MIXED_LIST, MANY(NAMES, transfer.particle, transfer.nparticles, MPM_MAX_FIELDS - 1)},
    {"nodes", MIXED_LIST, MANY(NAMES, transfer.node, transfer.nnodes, MPM_MAX_FIELDS - 1)},
    {"filter", MIXED, MANY(LINES, transfer.lines, transfer.nlines, MPM_MOST_LINES_OF_FILTER)}};

static const Key of_scheme[] = {{"name", UNMIXED, ONE_TEXT(A_TEXT, name)},
                                {"summary", UNMIXED, ONE_TEXT(QUOTED, summary)},
                                {"reference", UNMIXED, ONE_TEXT(QUOTED, reference)},
                                {"particles", MIXED_LIST, MANY(RANKS, particles, nparticles, MPM_MAX_FIELDS)},
                                {"nodes", MIXED_LIST, MANY(RANKS, nodes, nnodes, MPM_MAX_FIELDS)},
                                {"parameters", MIXED_LIST, MANY(TEXTS, parameters, nparameters, MPM_MOST_PARAMETERS)},
                                {"step", MIXED_LIST, MANY(LINES, step, nstep, MPM_MOST_LINES_OF_STEP)},
                                {"energy", MIXED, MANY(TEXTS, energy, nenergy, MPM_MAX_FIELDS)},
                                {"wave", MIXED, ONE_TEXT(A_TEXT, wave)},
                                {"staggered", MIXED, ONE_TEXT(A_TEXT, staggered)},
                                {"affine", MIXED, ONE_TEXT(A_TEXT, affine)},
                                {"conserved", MIXED, ONE_TEXT(A_TEXT, conserved)},
                                {"transfer", MIXED, TRANSFER, 0, 0, 0, 0}};

static PetscInt *NumberOf(MpmWritten *w, const Key *key)
{
  return (PetscInt *)(void *)((char *)w + key->n);
}

/* The number of places for texts that a key has in use: a single text has one, which may be NULL. */
static PetscInt Used(const MpmWritten *w, const Key *key)
{
  return key->n ? *NumberOf((MpmWritten *)(void *)w, key) : key->room;
}

/* The text i of a key. A name is followed by its text, or its rank. */
static MpmWrittenText *TextAt(MpmWritten *w, const Key *key, PetscInt i)
{
  return (MpmWrittenText *)(void *)((char *)w + key->at + (size_t)i * key->size);
}

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

/* The next text of a key. It is counted first, so that what is kept of it is freed when it is refused. */
static PetscErrorCode Next(Reader *r, const Key *key, int line, MpmWrittenText **text)
{
  PetscInt *n = NumberOf(r->written, key);

  PetscFunctionBegin;
  MpmCheckInput(*n < key->room, "%s:%d: %s%s: more than the %" PetscInt_FMT "%s that fit", r->written->file, line,
                key->name, key->kind == NAMES ? " of a transfer" : "", key->room, key->kind == LINES ? " lines" : "");
  *text = TextAt(r->written, key, (*n)++);
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
  static const char *const names[] = {"c", "x", "id", "cell", "xi", "gone", "mass", "volume", "stiffness", "mobility"};

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
  MpmWrittenText text = {NULL, 0};
  PetscErrorCode ierr = PETSC_SUCCESS;
  size_t         i    = 0;

  PetscFunctionBegin;
  PetscCall(TextOf(r, "a rank", value, &text));
  while (i < 3 && strcmp(text.text, MpmRankNames[i])) i++;
  if (i == 3) ierr = MpmWrittenRefuse(r->written, &text, "allowed as a rank: scalar, vector or stress");
  PetscCall(PetscFree(text.text));
  PetscCall(ierr);
  *rank = (MpmRank)i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the entries of a mapping. */
static PetscErrorCode ReadPairs(Reader *r, const Key *key, const yaml_node_t *node)
{
  MpmWrittenText *text;

  PetscFunctionBegin;
  MpmCheckInput(node->type == YAML_MAPPING_NODE, "%s:%d: %s: allowed: names with a value each, as {v: vector}",
                r->written->file, LineOf(node), key->name);
  for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
    const yaml_node_t *name  = yaml_document_get_node(r->document, pair->key);
    const yaml_node_t *value = yaml_document_get_node(r->document, pair->value);

    PetscCall(Next(r, key, LineOf(name), &text));
    PetscCall(TextOf(r, key->name, name, text));
    if (key->kind == RANKS)
      PetscCall(RankOf(r, value, &((MpmWrittenField *)(void *)text)->rank));
    else
      PetscCall(TextOf(r, key->name, value, text + 1));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddLine(Reader *r, const Key *key, const char text[], size_t length, int line)
{
  MpmWrittenText *kept;

  PetscFunctionBegin;
  while (length && isspace((unsigned char)*text)) {
    text++;
    length--;
  }
  while (length && isspace((unsigned char)text[length - 1])) length--;
  if (!length) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Next(r, key, line, &kept));
  PetscCall(KeepText(r, key->name, text, length, line, kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A list with a line each, or one text of several lines. */
static PetscErrorCode ReadLines(Reader *r, const Key *key, const yaml_node_t *node)
{
  PetscFunctionBegin;
  if (node->type == YAML_SCALAR_NODE) {
    const char *text = (const char *)node->data.scalar.value, *end = text + node->data.scalar.length;
    int         line = LineOf(node) + (node->data.scalar.style == YAML_LITERAL_SCALAR_STYLE ? 1 : 0);

    for (; text < end; line++) {
      const char *next = memchr(text, '\n', (size_t)(end - text));

      if (!next) next = end;
      PetscCall(AddLine(r, key, text, (size_t)(next - text), line));
      text = next + 1;
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  MpmCheckInput(node->type == YAML_SEQUENCE_NODE, "%s:%d: %s: allowed: a list of lines, as '- v_i = P2G v'",
                r->written->file, LineOf(node), key->name);
  for (const yaml_node_item_t *i = node->data.sequence.items.start; i < node->data.sequence.items.top; i++) {
    const yaml_node_t *item = yaml_document_get_node(r->document, *i);

    MpmCheckInput(item->type == YAML_SCALAR_NODE && item->data.scalar.length,
                  "%s:%d: %s: allowed: a list of lines, as '- v_i = P2G v'", r->written->file, LineOf(item), key->name);
    PetscCall(AddLine(r, key, (const char *)item->data.scalar.value, item->data.scalar.length, LineOf(item)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The fields that a filter has besides q and g. They are of their rank. */
static PetscErrorCode ReadNames(Reader *r, const Key *key, const yaml_node_t *node)
{
  MpmWrittenText *text;

  PetscFunctionBegin;
  MpmCheckInput(node->type == YAML_SEQUENCE_NODE, "%s:%d: %s of a transfer: allowed: a list of names, as [a, b]",
                r->written->file, LineOf(node), key->name);
  for (const yaml_node_item_t *i = node->data.sequence.items.start; i < node->data.sequence.items.top; i++) {
    const yaml_node_t *item = yaml_document_get_node(r->document, *i);

    PetscCall(Next(r, key, LineOf(item), &text));
    PetscCall(TextOf(r, key->name, item, text));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadTransfer(Reader *r, const yaml_node_t *node);

static PetscErrorCode ReadKey(Reader *r, const Key *key, const yaml_node_t *node)
{
  PetscFunctionBegin;
  if (key->kind == A_TEXT || key->kind == QUOTED) PetscCall(TextOf(r, key->name, node, TextAt(r->written, key, 0)));
  if (key->kind == RANKS || key->kind == TEXTS) PetscCall(ReadPairs(r, key, node));
  if (key->kind == LINES) PetscCall(ReadLines(r, key, node));
  if (key->kind == NAMES) PetscCall(ReadNames(r, key, node));
  if (key->kind == TRANSFER) PetscCall(ReadTransfer(r, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
    PetscCall(ReadKey(r, &keys[at], yaml_document_get_node(r->document, pair->value)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadTransfer(Reader *r, const yaml_node_t *node)
{
  const MpmWrittenTransfer *t = &r->written->transfer;

  PetscFunctionBegin;
  PetscCall(ReadMapping(r, "transfer", NKEYS(of_transfer), of_transfer, node));
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
  const MpmWritten *w = r->written;

  PetscFunctionBegin;
  PetscCall(ReadMapping(r, "scheme", NKEYS(of_scheme), of_scheme, node));
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

static PetscErrorCode Free(MpmWritten *w, size_t n, const Key keys[])
{
  PetscFunctionBegin;
  for (size_t k = 0; k < n; k++)
    for (PetscInt i = 0; i < Used(w, &keys[k]); i++) {
      MpmWrittenText *text = TextAt(w, &keys[k], i);

      PetscCall(PetscFree(text->text));
      if (keys[k].kind == TEXTS) PetscCall(PetscFree(text[1].text));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWrittenDestroy(MpmWritten **written)
{
  PetscFunctionBegin;
  if (!*written) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Free(*written, NKEYS(of_scheme), of_scheme));
  PetscCall(Free(*written, NKEYS(of_transfer), of_transfer));
  PetscCall(PetscFree(*written));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- to YAML ---- */

/* The second text of a name: its rank, or what it is. */
static const char *SecondOf(const MpmWrittenText *text, Kind kind)
{
  return kind == RANKS ? MpmRankNames[((const MpmWrittenField *)(const void *)text)->rank] : text[1].text;
}

static void PutKeys(FILE *out, const MpmWritten *w, int indent, size_t n, const Key keys[]);

/* In single quotes YAML takes everything but the quote as it stands. */
static void PutKey(FILE *out, const MpmWritten *w, int indent, const Key *key)
{
  const PetscInt        n    = Used(w, key);
  const MpmWrittenText *text = TextAt((MpmWritten *)(void *)w, key, 0);

  if (key->kind == TRANSFER ? !w->transfer.name.text : n == 0 || (!key->n && !text->text)) return;
  fprintf(out, "%*s%s:", indent, "", key->name);
  if (key->kind == A_TEXT) fprintf(out, " %s\n", text->text);
  if (key->kind == QUOTED) {
    fprintf(out, " '");
    for (const char *at = text->text; *at; at++) fprintf(out, *at == '\'' ? "''" : "%c", *at);
    fprintf(out, "'\n");
  }
  for (PetscInt i = 0; i < n && key->n; i++) {
    text = TextAt((MpmWritten *)(void *)w, key, i);
    if (key->kind == LINES)
      fprintf(out, "%s%*s- %s\n", i ? "" : "\n", indent + 2, "", text->text);
    else if (key->kind == NAMES)
      fprintf(out, "%s%s%s", i ? ", " : " [", text->text, i == n - 1 ? "]\n" : "");
    else
      fprintf(out, "%s%s: %s%s", i ? ", " : " {", text->text, SecondOf(text, key->kind), i == n - 1 ? "}\n" : "");
  }
  if (key->kind == TRANSFER) fprintf(out, "\n");
  if (key->kind == TRANSFER) PutKeys(out, w, indent + 2, NKEYS(of_transfer), of_transfer);
}

static void PutKeys(FILE *out, const MpmWritten *w, int indent, size_t n, const Key keys[])
{
  for (size_t k = 0; k < n; k++)
    if (keys != of_transfer || strcmp(keys[k].name, "parameters")) PutKey(out, w, indent, &keys[k]);
}

PetscErrorCode MpmWrittenYaml(const MpmWritten *w, char **yaml)
{
  char  *text = NULL;
  size_t size = 0;
  FILE  *out  = open_memstream(&text, &size);

  PetscFunctionBegin;
  PetscCheck(out, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for the text of a scheme");
  fprintf(out, "scheme:\n");
  PutKeys(out, w, 2, NKEYS(of_scheme), of_scheme);
  PetscCheck(!fclose(out), PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for the text of a scheme");
  PetscCall(PetscStrallocpy(text, yaml));
  free(text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the hash ---- */

static PetscBool IsInWord(char c)
{
  return isalnum((unsigned char)c) || c == '_' || c == '.' ? PETSC_TRUE : PETSC_FALSE;
}

static void Mix(uint64_t *hash, unsigned char c)
{
  *hash = MpmHashMix(*hash + MPM_HASH_INCREMENT + c);
}

/* Adds a text and its end. Of blanks those between two words count, as one. */
static void MixText(uint64_t *hash, const char text[])
{
  char last = 0;

  for (const char *at = text ? text : ""; *at; at++) {
    if (isspace((unsigned char)*at)) continue;
    if (at > text && isspace((unsigned char)at[-1]) && IsInWord(last) && IsInWord(*at)) Mix(hash, ' ');
    Mix(hash, (unsigned char)*at);
    last = *at;
  }
  Mix(hash, 0);
}

static void MixKeys(uint64_t *hash, const MpmWritten *w, size_t n, const Key keys[])
{
  for (const Key *key = keys; key < keys + n; key++) {
    if (key->mixing == UNMIXED) continue;
    for (PetscInt i = 0; i < Used(w, key); i++) {
      const MpmWrittenText *text = TextAt((MpmWritten *)(void *)w, key, i);

      MixText(hash, text->text);
      if (key->kind == RANKS || key->kind == TEXTS) MixText(hash, SecondOf(text, key->kind));
    }
    if (key->mixing == MIXED_LIST) Mix(hash, 1);
    if (key->kind == TRANSFER && w->transfer.name.text) MixKeys(hash, w, NKEYS(of_transfer), of_transfer);
  }
}

void MpmWrittenHash(const MpmWritten *w, char text[MPM_HASH_TEXT])
{
  uint64_t hash = 0;

  MixKeys(&hash, w, NKEYS(of_scheme), of_scheme);
  (void)snprintf(text, MPM_HASH_TEXT, "%016llx", (unsigned long long)hash);
}

PetscErrorCode MpmWrittenParametersText(const MpmWritten *w, char text[MPM_PARAMETERS_TEXT])
{
  PetscReal numbers[MPM_MOST_PARAMETERS];

  PetscFunctionBegin;
  text[0] = 0;
  PetscCall(MpmWrittenNumbers(w, numbers));
  for (PetscInt i = 0; i < w->nparameters; i++)
    (void)snprintf(text + strlen(text), MPM_PARAMETERS_TEXT - strlen(text), "%s%s=%.17g", i ? "," : "",
                   w->parameters[i].name.text, numbers[i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
