/*
   Reads a line of a written scheme. Its right side is a sum of products. A product has numbers, names of parameters, k,
   and at most one field, on which an operation may act:

     sum     = ['-'] product {('+' | '-') product}
     product = factor {['*' | '/'] factor}
     factor  = (number | name | '(' sum ')') ['^' whole number]  |  operation product
*/
#include "scheme/language_compile.h"
#include "base/suggest.h"
#include "base/text.h"
#include <mpmstab/errors.h>
#include <ctype.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#define DEEPEST 24 /* brackets and operands inside one another */
#define WORD 64    /* characters */

/* What a part of a line is: a number, or a sum of terms with fields. */
typedef struct {
  PetscInt  n; /* 0: a number */
  MpmPowers number;
  MpmTerm   term[MPM_MOST_TERMS];
} Value;

typedef struct {
  const MpmWritten     *written;
  const MpmWrittenText *text;
  const PetscReal      *numbers;
  MpmLookUp             found; /* of a parameter's text, where there are no fields and no k */
  void                 *context;
  const char           *at;
  PetscInt              depth;
} Reader;

typedef struct {
  const char *word;
  MpmOpKind   kind;
} Word;
static const Word operations[] = {{"P2G", MPM_P2G},   {"DIV", MPM_DIV}, {"G2P", MPM_G2P},
                                  {"GRAD", MPM_GRAD}, {"LAP", MPM_LAP}, {"SOLVE", MPM_SOLVE}};
static const Word statements[] = {{"IMPOSE", MPM_IMPOSE},
                                  {"REACT", MPM_REACT},
                                  {"FILTER", MPM_FILTER},
                                  {"FILTER_BEFORE", MPM_FILTER_BEFORE},
                                  {"FILTER_AFTER", MPM_FILTER_AFTER},
                                  {"MOVE", MPM_MOVE},
                                  {"MOVE_PROJECTED", MPM_MOVE_PROJECTED},
                                  {"IMPLICIT", MPM_IMPLICIT},
                                  {"DRIFT", MPM_DRIFT}};

const char *const MpmRankNames[] = {"scalar", "vector", "stress"};

/* The entry of a word, or with a NULL of a kind; NULL: there is none. */
static const Word *Find(size_t n, const Word words[], const char word[], MpmOpKind kind)
{
  for (size_t i = 0; i < n; i++)
    if (word ? !strcmp(words[i].word, word) : words[i].kind == kind) return &words[i];
  return NULL;
}

#define FIND(words, word, kind) Find(PETSC_STATIC_ARRAY_LENGTH(words), words, word, kind)

const char *MpmOperationWord(MpmOpKind kind, PetscBool dot, PetscBool stress)
{
  const Word *found = FIND(operations, NULL, kind);

  if (kind == MPM_GRAD && (dot || stress)) return dot ? "GRAD ." : "STRESS GRAD";
  return found ? found->word : "";
}

const char *MpmStatementWord(MpmOpKind kind)
{
  const Word *found = FIND(statements, NULL, kind);

  return found ? found->word : NULL;
}

PetscErrorCode MpmWrittenRefuse(const MpmWritten *written, const MpmWrittenText *where, const char format[], ...)
{
  va_list        arguments;
  char          *why;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  va_start(arguments, format);
  why = MpmTextMade(format, arguments);
  va_end(arguments);
  ierr = MpmRefusal("%s:%d: %.*s%s: %s", written->file, where->line, MPM_SHOWN_OF_LINE, where->text,
                    strlen(where->text) > MPM_SHOWN_OF_LINE ? "..." : "", why ? why : format);
  free(why);
  PetscFunctionReturn(ierr);
}

PetscBool MpmWrittenIsWord(const char name[])
{
  return FIND(operations, name, MPM_P2G) || FIND(statements, name, MPM_P2G) || !strcmp(name, "STRESS") ||
                 !strcmp(name, "k")
             ? PETSC_TRUE
             : PETSC_FALSE;
}

MpmPlace MpmWrittenFindField(const MpmWritten *w, const char name[], PetscInt *field)
{
  for (*field = 0; *field < w->nparticles; ++*field)
    if (!strcmp(name, w->particles[*field].name.text)) return MPM_ON_PARTICLES;
  for (*field = 0; *field < w->nnodes; ++*field)
    if (!strcmp(name, w->nodes[*field].name.text)) return MPM_ON_NODES;
  return MPM_NOWHERE;
}

/* ---- polynomials in k ---- */

PetscBool MpmPowersIsOne(const MpmPowers *p, PetscInt *power)
{
  PetscInt n = 0;

  for (PetscInt i = 0; i <= MPM_MOST_POWER; i++) {
    if (!p->has[i]) continue;
    *power = i;
    n++;
  }
  return n == 1 ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmPowersIsUnit(const MpmPowers *p)
{
  PetscInt power = 0;

  return MpmPowersIsOne(p, &power) && power == 0 && p->of[0] == 1 ? PETSC_TRUE : PETSC_FALSE;
}

static MpmPowers Constant(PetscReal value)
{
  return (MpmPowers){.of = {value}, .has = {PETSC_TRUE}};
}

static void AddPowers(MpmPowers *sum, const MpmPowers *more, PetscReal sign)
{
  for (PetscInt i = 0; i <= MPM_MOST_POWER; i++) {
    sum->of[i] += sign * more->of[i];
    if (more->has[i]) sum->has[i] = PETSC_TRUE;
  }
}

static PetscErrorCode Multiply(const Reader *r, MpmPowers *a, const MpmPowers *b)
{
  MpmPowers product = {{0}, {PETSC_FALSE}};

  PetscFunctionBegin;
  for (PetscInt i = 0; i <= MPM_MOST_POWER; i++)
    for (PetscInt j = 0; j <= MPM_MOST_POWER; j++) {
      if (!a->has[i] || !b->has[j]) continue;
      if (i + j > MPM_MOST_POWER) MpmRefuseLine(r->written, r->text, "allowed: powers of k up to %d", MPM_MOST_POWER);
      product.of[i + j] += a->of[i] * b->of[j];
      product.has[i + j] = PETSC_TRUE;
    }
  *a = product;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- words ---- */

static char Next(Reader *r)
{
  while (isspace((unsigned char)*r->at)) r->at++;
  return *r->at;
}

static PetscBool Takes(Reader *r, char c)
{
  if (Next(r) != c) return PETSC_FALSE;
  r->at++;
  return PETSC_TRUE;
}

static PetscBool BeginsWord(char c)
{
  return isalpha((unsigned char)c) || c == '_' ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode TakeWord(Reader *r, char word[WORD])
{
  size_t n = 0;

  PetscFunctionBegin;
  (void)Next(r);
  while (BeginsWord(r->at[n]) || isdigit((unsigned char)r->at[n])) n++;
  if (n == 0) MpmRefuseLine(r->written, r->text, "the name of a field is missing");
  if (n >= WORD) MpmRefuseLine(r->written, r->text, "a name is too long");
  PetscCall(PetscStrncpy(word, r->at, n + 1));
  r->at += n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Names the fields that there are, and one that may be meant. */
static PetscErrorCode RefuseName(const Reader *r, const char name[])
{
  const MpmWritten *w = r->written;
  const char       *names[2 * MPM_MAX_FIELDS + MPM_MOST_PARAMETERS], *near;
  MpmText           all = {NULL, 0};
  PetscInt          n   = 0;
  PetscErrorCode    ierr;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < w->nparticles; i++) names[n++] = w->particles[i].name.text;
  for (PetscInt i = 0; i < w->nnodes; i++) names[n++] = w->nodes[i].name.text;
  for (PetscInt i = 0; i < w->nparameters; i++) names[n++] = w->parameters[i].name.text;
  for (PetscInt i = 0; i < n; i++) PetscCall(MpmTextAdd(&all, "%s%s", i ? ", " : "", names[i]));
  near = MpmSuggest(name, n, names);
  ierr =
      MpmWrittenRefuse(w, r->text, "there is no field or parameter %s; allowed: %s%s%s%s", name,
                       all.text ? all.text : "none", near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
  MpmTextFree(&all);
  PetscFunctionReturn(ierr);
}

/* ---- sums and products ---- */

static PetscErrorCode ReadSum(Reader *r, Value *sum);
static PetscErrorCode ReadProduct(Reader *r, Value *product);

static PetscErrorCode ReadNumber(Reader *r, Value *value)
{
  char   text[WORD];
  size_t n = strspn(r->at, "0123456789.");

  PetscFunctionBegin;
  if ((r->at[n] | 32) == 'e') {
    const size_t sign = r->at[n + 1] == '+' || r->at[n + 1] == '-', digits = strspn(r->at + n + 1 + sign, "0123456789");

    if (digits) n += 1 + sign + digits;
  }
  if (n >= WORD) MpmRefuseLine(r->written, r->text, "a number is too long");
  PetscCall(PetscStrncpy(text, r->at, n + 1));
  r->at += n;
  *value = (Value){.number = Constant(strtod(text, NULL))};
  if (strchr(text, '.') != strrchr(text, '.') || !PetscIsNormalReal(value->number.of[0] == 0 ? 1 : value->number.of[0]))
    MpmRefuseLine(r->written, r->text, "%s is not a finite number", text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An operation acts on each term of what follows it. */
static PetscErrorCode ReadOperation(Reader *r, const char word[], MpmOpKind kind, PetscBool stress, Value *value)
{
  PetscBool dot = PETSC_FALSE;

  PetscFunctionBegin;
  if (kind == MPM_GRAD && Next(r) == '.' && !isdigit((unsigned char)r->at[1])) dot = Takes(r, '.');
  PetscCall(ReadProduct(r, value));
  if (!value->n) MpmRefuseLine(r->written, r->text, "%s acts on a number; allowed: on a field", word);
  for (PetscInt t = 0; t < value->n; t++) {
    MpmTerm *term = &value->term[t];

    if (term->kind != MPM_COPY && term->kind != MPM_ADD)
      MpmRefuseLine(r->written, r->text, "%s acts on the result of an operation; allowed: give that a line of its own",
                    word);
    if ((MpmOpTraitsOf(kind).src == MPM_ON_NODES) != (term->place == MPM_ON_NODES))
      MpmRefuseLine(r->written, r->text, "%s takes a field of %s, and %s is one of %s", word,
                    MpmOpTraitsOf(kind).src == MPM_ON_NODES ? "nodes" : "particles",
                    term->place == MPM_ON_NODES ? r->written->nodes[term->field].name.text
                                                : r->written->particles[term->field].name.text,
                    term->place == MPM_ON_NODES ? "nodes" : "particles");
    term->kind   = kind;
    term->dot    = dot;
    term->stress = stress;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadName(Reader *r, Value *value)
{
  const Word *operation;
  char        word[WORD];
  PetscInt    i;
  MpmPlace    place;

  PetscFunctionBegin;
  PetscCall(TakeWord(r, word));
  *value = (Value){.n = 0};
  if (r->found) {
    value->number.has[0] = PETSC_TRUE;
    PetscCall(r->found(r->context, r->text, word, &value->number.of[0]));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!strcmp(word, "k")) {
    value->number.has[1] = PETSC_TRUE;
    value->number.of[1]  = 1;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!strcmp(word, "STRESS")) { /* it stands before GRAD alone */
    PetscCall(TakeWord(r, word));
    if (strcmp(word, "GRAD"))
      MpmRefuseLine(r->written, r->text, "STRESS acts on a gradient; allowed: STRESS GRAD field");
    PetscCall(ReadOperation(r, "STRESS GRAD", MPM_GRAD, PETSC_TRUE, value));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  operation = FIND(operations, word, MPM_P2G);
  if (operation) {
    PetscCall(ReadOperation(r, word, operation->kind, PETSC_FALSE, value));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  i = MpmWrittenFindParameter(r->written, word);
  if (i != MPM_NONE) {
    value->number = Constant(r->numbers[i]);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  place = MpmWrittenFindField(r->written, word, &i);
  if (place == MPM_NOWHERE) PetscCall(RefuseName(r, word));
  value->n = 1;
  value->term[0] =
      (MpmTerm){.kind = place == MPM_ON_NODES ? MPM_COPY : MPM_ADD, .place = place, .field = i, .factor = Constant(1)};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Raises a number to the power that follows it, if one does. */
static PetscErrorCode ReadPower(Reader *r, Value *value)
{
  const MpmPowers base  = value->number;
  MpmPowers       power = Constant(1);
  char           *end;
  long            n;

  PetscFunctionBegin;
  if (!Takes(r, '^')) PetscFunctionReturn(PETSC_SUCCESS);
  n = isdigit((unsigned char)Next(r)) ? strtol(r->at, &end, 10) : -1;
  if (n < 0 || n > MPM_MOST_POWER || value->n)
    MpmRefuseLine(r->written, r->text, "allowed: powers of numbers, from 0 to %d", MPM_MOST_POWER);
  r->at = end;
  for (long i = 0; i < n; i++) PetscCall(Multiply(r, &power, &base));
  value->number = power;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadFactor(Reader *r, Value *value)
{
  const char c = Next(r);

  PetscFunctionBegin;
  if (++r->depth > DEEPEST) MpmRefuseLine(r->written, r->text, "too many brackets inside one another");
  if (Takes(r, '(')) {
    PetscCall(ReadSum(r, value));
    if (!Takes(r, ')')) MpmRefuseLine(r->written, r->text, "a bracket is not closed");
  } else if (isdigit((unsigned char)c) || (c == '.' && isdigit((unsigned char)r->at[1])))
    PetscCall(ReadNumber(r, value));
  else if (BeginsWord(c))
    PetscCall(ReadName(r, value));
  else if (c)
    MpmRefuseLine(r->written, r->text, "'%c' is not expected here; allowed: a number, a name or a bracket", c);
  else
    MpmRefuseLine(r->written, r->text, "something is missing at its end; allowed: a number, a name or a bracket");
  PetscCall(ReadPower(r, value));
  r->depth--;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* product *= factor, or with divides product /= factor. */
static PetscErrorCode Join(const Reader *r, Value *product, const Value *factor, PetscBool divides)
{
  MpmPowers number = factor->number;
  PetscInt  power  = 0;

  PetscFunctionBegin;
  if (product->n && factor->n)
    MpmRefuseLine(r->written, r->text, "a product of two fields; allowed: linear combinations");
  if (divides) {
    if (factor->n || !MpmPowersIsOne(&number, &power) || power || number.of[0] == 0)
      MpmRefuseLine(r->written, r->text, "allowed: to divide by numbers that are not 0");
    number = Constant(1 / number.of[0]);
  }
  if (factor->n) {
    number   = product->number;
    *product = *factor;
  }
  for (PetscInt t = 0; t < product->n; t++) PetscCall(Multiply(r, &product->term[t].factor, &number));
  if (!product->n) PetscCall(Multiply(r, &product->number, &number));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A factor that may have a sign of its own, as in v + -0.25 a. */
static PetscErrorCode ReadSigned(Reader *r, Value *factor)
{
  const PetscReal sign = Takes(r, '-') ? -1 : 1;

  PetscFunctionBegin;
  PetscCall(ReadFactor(r, factor));
  for (PetscInt t = 0; t < factor->n; t++)
    for (PetscInt p = 0; p <= MPM_MOST_POWER; p++) factor->term[t].factor.of[p] *= sign;
  for (PetscInt p = 0; p <= MPM_MOST_POWER; p++) factor->number.of[p] *= sign;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadProduct(Reader *r, Value *product)
{
  PetscFunctionBegin;
  PetscCall(ReadSigned(r, product));
  while (PETSC_TRUE) {
    const char c = Next(r);
    Value      factor;

    if (c != '*' && c != '/' && c != '(' && c != '.' && !isdigit((unsigned char)c) && !BeginsWord(c)) break;
    if (c == '*' || c == '/') r->at++;
    PetscCall(ReadSigned(r, &factor));
    PetscCall(Join(r, product, &factor, c == '/' ? PETSC_TRUE : PETSC_FALSE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsSame(const MpmTerm *a, const MpmTerm *b)
{
  return a->kind == b->kind && a->field == b->field && a->dot == b->dot && a->stress == b->stress ? PETSC_TRUE
                                                                                                  : PETSC_FALSE;
}

/* Adds the terms of a product; those of the same operation and field become one. */
static PetscErrorCode AddTerms(const Reader *r, Value *sum, const Value *product, PetscReal sign)
{
  PetscFunctionBegin;
  for (PetscInt t = 0; t < product->n; t++) {
    const MpmTerm *more = &product->term[t];
    PetscInt       same = 0;

    while (same < sum->n && !IsSame(&sum->term[same], more)) same++;
    if (same == MPM_MOST_TERMS) MpmRefuseLine(r->written, r->text, "allowed: at most %d terms", MPM_MOST_TERMS);
    if (same == sum->n) {
      sum->term[sum->n++]    = *more;
      sum->term[same].factor = (MpmPowers){{0}, {PETSC_FALSE}};
    }
    AddPowers(&sum->term[same].factor, &more->factor, sign);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadSum(Reader *r, Value *sum)
{
  PetscBool first = PETSC_TRUE;

  PetscFunctionBegin;
  *sum = (Value){.n = 0};
  while (first || Next(r) == '+' || Next(r) == '-') {
    const PetscReal sign = Takes(r, '-') ? -1 : 1;
    Value           product;

    if (sign > 0) (void)Takes(r, '+');
    PetscCall(ReadProduct(r, &product));
    if (!first && !product.n != !sum->n)
      MpmRefuseLine(r->written, r->text, "a sum of a number and a field; allowed: numbers, or multiples of fields");
    if (product.n)
      PetscCall(AddTerms(r, sum, &product, sign));
    else
      AddPowers(&sum->number, &product.number, sign);
    first = PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadEnd(Reader *r)
{
  PetscFunctionBegin;
  if (Next(r)) MpmRefuseLine(r->written, r->text, "'%.20s' is not expected here", r->at);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNumberRead(const MpmWritten *written, const MpmWrittenText *text, MpmLookUp found, void *context,
                             PetscReal *value)
{
  Reader r = {.written = written, .text = text, .found = found, .context = context, .at = text->text};
  Value  sum;

  PetscFunctionBegin;
  PetscCall(ReadSum(&r, &sum));
  PetscCall(ReadEnd(&r));
  *value = sum.number.of[0];
  if (PetscIsInfOrNanReal(*value)) MpmRefuseLine(written, text, "is not a finite number");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- lines ---- */

/* A field that a statement names, of the place that it wants. */
static PetscErrorCode ReadField(Reader *r, MpmPlace wanted, PetscInt *field)
{
  char     word[WORD];
  MpmPlace place;

  PetscFunctionBegin;
  PetscCall(TakeWord(r, word));
  place = MpmWrittenFindField(r->written, word, field);
  if (place == MPM_NOWHERE) PetscCall(RefuseName(r, word));
  if (place != wanted)
    MpmRefuseLine(r->written, r->text, "%s is a field of %s; allowed here: one of %s", word,
                  place == MPM_ON_NODES ? "nodes" : "particles", wanted == MPM_ON_NODES ? "nodes" : "particles");
  (void)Takes(r, ',');
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The a of IMPLICIT, a number times a power of k that is not negative. */
static PetscErrorCode ReadImplicit(Reader *r, MpmWrittenLine *line)
{
  Value    sum;
  PetscInt power = 0;

  PetscFunctionBegin;
  PetscCall(ReadField(r, MPM_ON_NODES, &line->field));
  PetscCall(ReadSum(r, &sum));
  if (sum.n || !MpmPowersIsOne(&sum.number, &power) || sum.number.of[power] < 0)
    MpmRefuseLine(r->written, r->text,
                  "allowed: IMPLICIT field a, a number that is not negative times a power of k, as 0.25 k^2");
  line->term[0].factor = sum.number;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A field of nodes, and how much of it: 1/2 v_i. */
static PetscErrorCode ReadShare(Reader *r, MpmWrittenLine *line)
{
  Value          product;
  const MpmTerm *term  = &product.term[0];
  PetscInt       power = 0;

  PetscFunctionBegin;
  PetscCall(ReadProduct(r, &product));
  if (product.n != 1 || term->kind != MPM_COPY || !MpmPowersIsOne(&term->factor, &power) || power)
    MpmRefuseLine(r->written, r->text, "allowed: a field of nodes, or a number times such a field");
  line->field = term->field;
  line->share = term->factor.of[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadStatement(Reader *r, MpmWrittenLine *line)
{
  const MpmOpKind op      = line->op;
  const PetscBool moves   = op == MPM_MOVE || op == MPM_MOVE_PROJECTED ? PETSC_TRUE : PETSC_FALSE,
                  plain   = moves || op == MPM_DRIFT || op == MPM_IMPLICIT ? PETSC_TRUE : PETSC_FALSE,
                  filter  = !plain && op != MPM_IMPOSE && op != MPM_REACT ? PETSC_TRUE : PETSC_FALSE,
                  bracket = !plain && Takes(r, '(') ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (moves) PetscCall(ReadShare(r, line));
  if (op == MPM_IMPLICIT) PetscCall(ReadImplicit(r, line));
  if (!plain) PetscCall(ReadField(r, filter ? MPM_ON_PARTICLES : MPM_ON_NODES, &line->field));
  if (!plain && op != MPM_IMPOSE) PetscCall(ReadField(r, MPM_ON_NODES, &line->other));
  if (bracket && !Takes(r, ')')) MpmRefuseLine(r->written, r->text, "a bracket is not closed");
  PetscCall(ReadEnd(r));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sign of '=', '+=' or '-='. */
static PetscErrorCode ReadSign(Reader *r, MpmWrittenLine *line, PetscReal *sign)
{
  const char c = Next(r);

  PetscFunctionBegin;
  *sign      = c == '-' ? -1 : 1;
  line->adds = c == '+' || c == '-' ? PETSC_TRUE : PETSC_FALSE;
  if (line->adds) r->at++;
  if (!Takes(r, '='))
    MpmRefuseLine(r->written, r->text,
                  "allowed: field = ..., field += ..., field -= ..., IMPOSE, REACT, FILTER, MOVE, IMPLICIT or DRIFT");
  if (*r->at == '+') MpmRefuseLine(r->written, r->text, "'=+' is not allowed; did you mean +=?");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmLineRead(const MpmWritten *written, const PetscReal numbers[], const MpmWrittenText *text,
                           MpmWrittenLine *line)
{
  Reader      r = {.written = written, .text = text, .numbers = numbers, .at = text->text};
  const Word *statement;
  char        word[WORD];
  PetscReal   sign;
  Value       sum, terms = {.n = 0};

  PetscFunctionBegin;
  *line = (MpmWrittenLine){.op = MPM_LINE_SETS};
  if (!BeginsWord(Next(&r))) MpmRefuseLine(written, text, "allowed: a line that begins with a field or a statement");
  PetscCall(TakeWord(&r, word));
  statement = FIND(statements, word, MPM_P2G);
  if (statement) {
    line->op = statement->kind;
    PetscCall(ReadStatement(&r, line));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ReadSign(&r, line, &sign));
  line->place = MpmWrittenFindField(written, word, &line->field);
  if (line->place == MPM_NOWHERE) PetscCall(RefuseName(&r, word));
  PetscCall(ReadSum(&r, &sum));
  PetscCall(ReadEnd(&r));
  if (!sum.n) MpmRefuseLine(written, text, "there is no field on its right side");
  PetscCall(AddTerms(&r, &terms, &sum, sign));
  line->nterms = terms.n;
  PetscCall(PetscArraycpy(line->term, terms.term, terms.n));
  PetscFunctionReturn(PETSC_SUCCESS);
}
