/* Matrices as text of Matrix Market, and in PETSc's binary format. */
#include "io/matrix_file.h"
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* ---- comments that the hook writes ---- */

#define MANY SIZE_MAX     /* in place of where a number is kept: the comment may be there many times */
#define MOST_COUNTED 1e15 /* a whole number up to this is exact */

void MpmHookedBegin(MpmHooked *h)
{
  *h = (MpmHooked){.dim = 0};
  for (int i = 0; i < MPM_CERTIFICATES; i++) h->value[i] = NAN;
}

/* Reads the numbers of a text: -1 if something else is in it, or more than so many. */
static PetscInt Numbers(const char text[], PetscInt most, PetscReal number[])
{
  PetscInt n = 0;

  for (text += strspn(text, " \t\r\n"); *text; text += strspn(text, " \t\r\n")) {
    char *end;

    if (n == most) return -1;
    number[n++] = strtod(text, &end);
    if (end == text) return -1;
    text = end;
  }
  return n;
}

/* Which numbers a comment may have. A certificate of a code that has failed may be infinite, or none (NaN). */
typedef enum { CERTIFICATE, NOT_NEGATIVE, POSITIVE, FINITE, SWITCH, COUNT } Kind;
static const char *const kinds[] = {
    "a number from 0, inf or nan", "a finite number from 0", "a finite number above 0", "finite numbers", "0 or 1",
    "a whole number from 1"};

static PetscBool IsOf(Kind kind, PetscReal number)
{
  if (kind == CERTIFICATE) return number < 0 ? PETSC_FALSE : PETSC_TRUE;
  if (!isfinite(number) || (kind == COUNT && (number > MOST_COUNTED || number != rint(number)))) return PETSC_FALSE;
  if (kind == SWITCH) return number == 0 || number == 1 ? PETSC_TRUE : PETSC_FALSE;
  if (kind == COUNT) return number >= 1 ? PETSC_TRUE : PETSC_FALSE;
  if (kind == POSITIVE) return number > 0 ? PETSC_TRUE : PETSC_FALSE;
  return kind == FINITE || number >= 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* Keeps numbers that may be there many times: the place of a particle, or a scale. */
static PetscErrorCode Append(PetscBool place, PetscInt n, const PetscReal number[], MpmHooked *h, const char **wrong)
{
  PetscFunctionBegin;
  if (!place && h->scales < MPM_HOOKED_NUMBERS) h->scale[h->scales] = number[0];
  if (!place) h->scales++;
  if (place && h->places && h->place_dim != n) *wrong = "as many numbers as the other places have";
  if (!place || *wrong) PetscFunctionReturn(PETSC_SUCCESS);
  if (h->places == h->room) {
    h->room = 2 * h->room + 1024;
    PetscCall(PetscRealloc(sizeof *h->x * MPM_MAX_DIM * (size_t)h->room, &h->x));
  }
  h->place_dim = n;
  PetscCall(PetscArrayzero(h->x + MPM_MAX_DIM * h->places, MPM_MAX_DIM));
  PetscCall(PetscArraycpy(h->x + MPM_MAX_DIM * h->places++, number, n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A field's scale, where it comes from, and the name of the field. */
static void TakeFieldScale(const char text[], MpmHooked *h, const char **wrong)
{
  MpmFieldScale field;

  if (sscanf(text, "%lf %15s %63[^\r\n]", &field.scale, field.from, field.name) != 3 || !IsOf(POSITIVE, field.scale))
    *wrong = "a number above 0, a word and a name";
  else if (h->nfields < MPM_STEPPER_FIELDS)
    h->field[h->nfields++] = field;
}

/*
   Takes a comment, without its '%'. wrong: what is allowed in the place of one that has not the numbers it should have;
   NULL: nothing is wrong, or the comment is none of these.
*/
static PetscErrorCode TakeComment(const char comment[], MpmHooked *h, const char **wrong)
{
  static const struct {
    const char *name;
    Kind        kind;
    PetscInt    most;
    size_t      at;
  } said[] = {{"at", FINITE, MPM_MAX_DIM, MANY},
              {"scale", POSITIVE, 1, MANY},
              {"period", NOT_NEGATIVE, MPM_MAX_DIM, offsetof(MpmHooked, period)},
              {"steps", COUNT, 1, offsetof(MpmHooked, steps)},
              {"numbers", COUNT, 1, offsetof(MpmHooked, numbers)},
              {"single", SWITCH, 1, offsetof(MpmHooked, single)},
              {"size", NOT_NEGATIVE, 1, offsetof(MpmHooked, size)},
              {"cell_width", NOT_NEGATIVE, 1, offsetof(MpmHooked, cell_width)},
              {"moved", CERTIFICATE, 1, offsetof(MpmHooked, value[MPM_CERTIFY_EQUILIBRIUM])},
              {"repeat", CERTIFICATE, 1, offsetof(MpmHooked, value[MPM_CERTIFY_REPEAT])},
              {"two_steps", CERTIFICATE, 1, offsetof(MpmHooked, value[MPM_CERTIFY_COMPOSED])},
              {"one_sided", CERTIFICATE, 1, offsetof(MpmHooked, value[MPM_CERTIFY_ONE_SIDED])},
              {"two_sizes", CERTIFICATE, 1, offsetof(MpmHooked, value[MPM_CERTIFY_SIZES])},
              {"additivity", CERTIFICATE, 1, offsetof(MpmHooked, value[MPM_CERTIFY_ADDITIVITY])},
              {"unsettled", CERTIFICATE, 1, offsetof(MpmHooked, value[MPM_CERTIFY_SCALES])}};
  PetscReal   number[MPM_MAX_DIM];
  const char *text;
  PetscInt    i = 0, n;

  PetscFunctionBegin;
  *wrong = NULL;
  comment += strspn(comment, " ");
  text = strchr(comment, ':');
  if (text && text - comment == (ptrdiff_t)strlen("field_scale") &&
      !strncmp(comment, "field_scale", strlen("field_scale"))) {
    TakeFieldScale(text + 1, h, wrong);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  while (text && i < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(said) &&
         (strlen(said[i].name) != (size_t)(text - comment) || strncmp(comment, said[i].name, strlen(said[i].name))))
    i++;
  if (!text || i == (PetscInt)PETSC_STATIC_ARRAY_LENGTH(said)) PetscFunctionReturn(PETSC_SUCCESS);
  n = Numbers(text + 1, said[i].most, number);
  if (n < 1) *wrong = kinds[said[i].kind];
  for (PetscInt k = 0; k < n && !*wrong; k++)
    if (!IsOf(said[i].kind, number[k])) *wrong = kinds[said[i].kind];
  if (!*wrong && said[i].at != MANY && (h->given & 1u << i)) *wrong = "once";
  h->given |= 1u << i;
  if (*wrong) PetscFunctionReturn(PETSC_SUCCESS);
  if (said[i].at != MANY)
    PetscCall(PetscArraycpy((PetscReal *)((char *)h + said[i].at), number, n));
  else
    PetscCall(Append(i == 0 ? PETSC_TRUE : PETSC_FALSE, n, number, h, wrong));
  if (!strcmp(said[i].name, "period")) h->dim = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHookedFree(MpmHooked *h)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(h->x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What steps from the same state differ by is felt by an entry over the size of the perturbations. */
PetscErrorCode MpmHookedCertificates(MPI_Comm comm, const MpmHooked *h, PetscReal tolerance, MpmCertificates *c)
{
  PetscReal value[MPM_CERTIFICATES + 1];
  PetscBool single;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(value, h->value, MPM_CERTIFICATES));
  value[MPM_CERTIFICATES] = h->single;
  for (MpmCertificate which = MPM_CERTIFY_REPEAT; which <= MPM_CERTIFY_COMPOSED; which++)
    if (h->size > 0) value[which] /= h->size;
  PetscCallMPI(MPI_Bcast(value, MPM_CERTIFICATES + 1, MPIU_REAL, 0, comm));
  single = value[MPM_CERTIFICATES] > 0 ? PETSC_TRUE : PETSC_FALSE;
  MpmCertificatesBegin(single, single ? PetscMax(tolerance, MPM_TOLERANCE_SINGLE) : tolerance, c);
  PetscCall(PetscArraycpy(c->value, value, MPM_CERTIFICATES));
  c->nfields = h->nfields; /* for the first rank, which reports */
  PetscCall(PetscArraycpy(c->field, h->field, h->nfields));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Matrix Market: a line that says what the file is, comments, sizes, and an entry a line (Boisvert, Pozo and Remington
   1996, NISTIR 5935). Rows and columns count from 1.

   A comment '% steps: 8' says that the matrix covers 8 steps. For other comments see io/matrix_file.h.
*/

#define LINE 1025
#define SHOWN 60   /* characters of a line in a message */
#define SHORTEST 2 /* bytes of a line with a number */

/* What the first line says. */
typedef struct {
  PetscBool dense, symmetric, skew, whole;
} Banner;

/* The file, and its line that was read last. What is beyond LINE - 1 characters of a line is not kept. */
typedef struct {
  FILE      *stream;
  PetscInt64 number;
  char       text[LINE];
  PetscBool  cut;
} Line;

/* Reads one line. A zero byte, where a C string would end, becomes a question mark. */
static PetscBool Next(Line *line)
{
  size_t n = 0;
  int    c = getc(line->stream);

  if (c == EOF) return PETSC_FALSE;
  for (; c != EOF && c != '\n'; c = getc(line->stream), n++)
    if (n < LINE - 1) line->text[n] = c ? (char)c : '?';
  line->text[PetscMin(n, LINE - 1)] = '\0';
  line->cut                         = n > LINE - 1 ? PETSC_TRUE : PETSC_FALSE;
  line->number++;
  return PETSC_TRUE;
}

static void Refuse(const Line *line, const char allowed[], char why[MPM_WHY_TEXT])
{
  MpmWhy(why, "line %" PetscInt64_FMT ": %.*s%s; allowed: %s", line->number, SHOWN, line->text,
         strlen(line->text) > SHOWN ? "..." : "", allowed);
}

static void ReadBanner(Line *line, Banner *b, char why[MPM_WHY_TEXT])
{
  char *save, *next, *word[5] = {NULL};

  if (!Next(line)) line->text[0] = '\0';
  for (char *c = line->text; *c; c++) *c = (char)(*c >= 'A' && *c <= 'Z' ? *c + 32 : *c);
  next = strtok_r(line->text, " \t\r", &save);
  for (int i = 0; i < 5 && next; i++) {
    word[i] = next;
    next    = strtok_r(NULL, " \t\r", &save);
  }
  if (!word[4] || strcmp(word[0], "%%matrixmarket") || strcmp(word[1], "matrix") ||
      (strcmp(word[2], "coordinate") && strcmp(word[2], "array")) ||
      (strcmp(word[3], "real") && strcmp(word[3], "double") && strcmp(word[3], "integer")) ||
      (strcmp(word[4], "general") && strcmp(word[4], "symmetric") && strcmp(word[4], "skew-symmetric"))) {
    MpmWhy(why,
           "Matrix Market of kind %.20s %.20s %.20s; allowed: coordinate or array, real or integer, and "
           "general, symmetric or skew-symmetric",
           word[2] ? word[2] : "", word[3] ? word[3] : "", word[4] ? word[4] : "");
    return;
  }
  b->dense     = strcmp(word[2], "array") ? PETSC_FALSE : PETSC_TRUE;
  b->whole     = strcmp(word[3], "integer") ? PETSC_FALSE : PETSC_TRUE;
  b->skew      = strcmp(word[4], "skew-symmetric") ? PETSC_FALSE : PETSC_TRUE;
  b->symmetric = strcmp(word[4], "general") ? PETSC_TRUE : PETSC_FALSE;
}

/* Finds the next line that is no comment and not blank, and takes the comments before it. found: not the file's end. */
static PetscErrorCode NextEntry(Line *line, MpmEntries *e, PetscBool *found, char why[MPM_WHY_TEXT])
{
  const char *wrong = NULL;

  PetscFunctionBegin;
  *found = PETSC_FALSE;
  while (!*found && !why[0] && Next(line)) {
    if (line->text[0] == '%')
      PetscCall(TakeComment(line->text + 1, &e->hooked, &wrong));
    else if (line->text[strspn(line->text, " \t\r")])
      *found = PETSC_TRUE;
    if (*found && line->cut) wrong = "a shorter line";
    if (wrong) Refuse(line, wrong, why);
  }
  e->steps = (PetscInt64)e->hooked.steps;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsWhole(PetscReal number, PetscReal from, PetscReal to)
{
  return number >= from && number <= to && number == rint(number) ? PETSC_TRUE : PETSC_FALSE;
}

static void Put(MpmEntries *e, PetscInt row, PetscInt column, PetscReal value)
{
  e->row[e->n]     = row;
  e->column[e->n]  = column;
  e->value[e->n++] = value;
}

/*
   What is allowed in the place of an entry; NULL: nothing is wrong with it. number: row and column from 1, and the
   value.
*/
static const char *WrongEntry(const Banner *b, const MpmEntries *e, const PetscReal number[])
{
  if (!IsWhole(number[0], 1, (PetscReal)e->rows) || !IsWhole(number[1], 1, (PetscReal)e->columns))
    return "rows and columns from 1 to the order";
  if (!isfinite(number[2])) return "finite numbers";
  if (b->whole && number[2] != rint(number[2])) return "whole numbers, as the first line says";
  if (b->skew && number[0] <= number[1]) return "of a skew-symmetric matrix the entries below the diagonal";
  if (b->symmetric && number[0] < number[1])
    return "of a symmetric matrix the entries on and below the diagonal, or 'general' in the first line";
  return NULL;
}

/*
   Reads the entries. Of a symmetric matrix the file has those below the diagonal, and of a skew one not the diagonal.
*/
static PetscErrorCode ReadEntries(Line *line, const Banner *b, PetscInt64 listed, MpmEntries *e, char why[MPM_WHY_TEXT])
{
  PetscInt64 row = b->skew, column = 0;
  PetscBool  found;

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < listed && !why[0]; i++) {
    PetscReal   number[3] = {(PetscReal)row + 1, (PetscReal)column + 1};
    const char *wrong     = NULL;

    PetscCall(NextEntry(line, e, &found, why));
    if (why[0]) break;
    if (!found || Numbers(line->text, b->dense ? 1 : 3, b->dense ? number + 2 : number) != (b->dense ? 1 : 3)) {
      MpmWhy(why, "entry %" PetscInt64_FMT " of %" PetscInt64_FMT "; allowed: %s", i + 1, listed,
             b->dense ? "a line with one number" : "a line with row, column and value");
      break;
    }
    wrong = WrongEntry(b, e, number);
    if (wrong) Refuse(line, wrong, why);
    if (wrong) break;
    Put(e, (PetscInt)number[0] - 1, (PetscInt)number[1] - 1, number[2]);
    if (b->symmetric && number[0] != number[1])
      Put(e, (PetscInt)number[1] - 1, (PetscInt)number[0] - 1, (b->skew ? -1 : 1) * number[2]);
    if (b->dense && ++row == e->rows) {
      column++;
      row = b->symmetric ? column + b->skew : 0;
    }
  }
  if (!why[0]) PetscCall(NextEntry(line, e, &found, why));
  if (!why[0] && found) MpmWhy(why, "something follows its %" PetscInt64_FMT " entries; allowed: no more", listed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses more entries than the file has room for. */
static void CheckLength(FILE *stream, PetscReal listed, char why[MPM_WHY_TEXT])
{
  const off_t at  = ftello(stream);
  off_t       end = 0;

  if (at >= 0 && !fseeko(stream, 0, SEEK_END)) end = ftello(stream);
  if (at < 0 || fseeko(stream, at, SEEK_SET) || !(listed * SHORTEST - 1 <= (PetscReal)(end - at)))
    MpmWhy(why, "it is too short for %.10g entries; allowed: a whole file", listed);
}

PetscErrorCode MpmMatrixReadText(FILE *stream, MpmEntries *e, char why[MPM_WHY_TEXT])
{
  Banner    b    = {.dense = PETSC_FALSE};
  Line      line = {.stream = stream};
  PetscBool found;
  PetscReal size[3] = {0};

  PetscFunctionBegin;
  ReadBanner(&line, &b, why);
  if (!why[0]) PetscCall(NextEntry(&line, e, &found, why));
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (!found || Numbers(line.text, b.dense ? 2 : 3, size) != (b.dense ? 2 : 3)) {
    MpmWhy(why, "no line with its sizes; allowed: rows and columns%s", b.dense ? "" : ", and the number of entries");
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (int i = 0; i < 3 && !why[0]; i++)
    if (!IsWhole(size[i], 0, 1e18)) Refuse(&line, "whole numbers from 0", why);
  if (b.dense) size[2] = !b.symmetric ? size[0] * size[1] : size[0] * (size[0] + (b.skew ? -1 : 1)) / 2;
  if (!why[0]) CheckLength(stream, size[2], why);
  if (!why[0]) PetscCall(MpmEntriesRoom(size[0], size[1], (b.symmetric ? 2 : 1) * size[2], e, why));
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  e->n = 0;
  PetscCall(ReadEntries(&line, &b, (PetscInt64)size[2], e, why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmMatrixWriteText(const MpmCsr *c, PetscInt steps, FILE *stream)
{
  (void)fprintf(stream, "%%%%MatrixMarket matrix coordinate real general\n%% steps: %" PetscInt_FMT "\n", steps);
  (void)fprintf(stream, "%" PetscInt_FMT " %" PetscInt_FMT " %" PetscInt_FMT "\n", c->order, c->order,
                c->begin[c->order]);
  for (PetscInt i = 0; i < c->order; i++)
    for (PetscInt k = c->begin[i]; k < c->begin[i + 1]; k++)
      (void)fprintf(stream, "%" PetscInt_FMT " %" PetscInt_FMT " %.17g\n", i + 1, c->column[k] + 1, c->value[k]);
}

/*
   PETSc's binary format of a sparse matrix, as its manual page of MatView has it: class, rows, columns, entries, the
   number of entries of each row, their columns, their values; whole numbers of 32 bits, or of 64 where PetscInt has
   them, all with the highest byte first. Read by hand, since MatLoad takes any number in a damaged file for granted.
*/

#define DENSE -1 /* in place of the number of entries */

/* Reads so many numbers of so many bytes each, and turns the bytes round. */
static PetscBool Read(FILE *stream, size_t n, size_t width, void *numbers)
{
  unsigned char *bytes = numbers;

  if (fread(numbers, width, n, stream) != n) return PETSC_FALSE;
  for (size_t i = 0; i < n; i++)
    for (size_t b = 0; b < width / 2; b++) {
      const unsigned char kept = bytes[i * width + b];

      bytes[i * width + b]             = bytes[i * width + width - 1 - b];
      bytes[i * width + width - 1 - b] = kept;
    }
  return PETSC_TRUE;
}

static PetscBool ReadWhole(FILE *stream, size_t width, PetscInt64 *number)
{
  union {
    int32_t narrow;
    int64_t wide;
  } as;

  if (!Read(stream, 1, width, &as)) return PETSC_FALSE;
  *number = width == 4 ? as.narrow : as.wide;
  return PETSC_TRUE;
}

/* An index as PetscInt; what does not fit becomes -1, which is refused later. */
static PetscInt Index(PetscInt64 number)
{
  return number >= 0 && number <= PETSC_MAX_INT ? (PetscInt)number : -1;
}

static PetscBool ReadSparse(FILE *stream, size_t width, MpmEntries *e)
{
  PetscInt64 at = 0, number;

  for (PetscInt64 row = 0; row < e->rows; row++) {
    if (!ReadWhole(stream, width, &number) || number < 0 || number > e->n - at) return PETSC_FALSE;
    for (PetscInt64 i = 0; i < number; i++) e->row[at++] = (PetscInt)row;
  }
  if (at != e->n) return PETSC_FALSE;
  for (PetscInt64 i = 0; i < e->n; i++) {
    if (!ReadWhole(stream, width, &number)) return PETSC_FALSE;
    e->column[i] = Index(number);
  }
  return Read(stream, (size_t)e->n, sizeof(PetscReal), e->value);
}

static PetscBool ReadDense(FILE *stream, MpmEntries *e)
{
  for (PetscInt64 i = 0; i < e->n; i++) {
    e->row[i]    = (PetscInt)(i / e->columns);
    e->column[i] = (PetscInt)(i % e->columns);
  }
  return Read(stream, (size_t)e->n, sizeof(PetscReal), e->value);
}

PetscErrorCode MpmMatrixReadPetsc(FILE *stream, MpmEntries *e, char why[MPM_WHY_TEXT])
{
  size_t     width = 4;
  PetscInt64 head[4], end;
  PetscReal  entries, bytes;
  PetscBool  ok;

  PetscFunctionBegin;
  MpmWhy(why, "it is cut off; allowed: a whole file of PETSc");
  if (!ReadWhole(stream, 4, &head[0])) PetscFunctionReturn(PETSC_SUCCESS);
  if (head[0] == 0) { /* the upper half of a wide number */
    width = 8;
    if (!ReadWhole(stream, 4, &head[0])) PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (int i = 1; i < 4; i++)
    if (!ReadWhole(stream, width, &head[i])) PetscFunctionReturn(PETSC_SUCCESS);
  if (fseeko(stream, 0, SEEK_END)) PetscFunctionReturn(PETSC_SUCCESS);
  end     = (PetscInt64)ftello(stream);
  entries = head[3] == DENSE ? (PetscReal)head[1] * (PetscReal)head[2] : (PetscReal)head[3];
  bytes   = 4.0 * (PetscReal)width + 8 * entries;
  if (head[3] != DENSE) bytes += (PetscReal)width * ((PetscReal)head[1] + entries);
  if (bytes > (PetscReal)end) PetscFunctionReturn(PETSC_SUCCESS);
  if (bytes + 8 * entries == (PetscReal)end && entries > 0)
    MpmWhy(why, "it has complex numbers; allowed: a file of PETSc with real ones");
  else
    why[0] = '\0';
  if (!why[0]) PetscCall(MpmEntriesRoom((PetscReal)head[1], (PetscReal)head[2], entries, e, why));
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  ok = !fseeko(stream, (off_t)(4 * width), SEEK_SET);
  if (ok) ok = head[3] == DENSE ? ReadDense(stream, e) : ReadSparse(stream, width, e);
  if (!ok) MpmWhy(why, "the numbers of entries in its rows do not fit; allowed: a whole file of PETSc");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Write(FILE *stream, size_t width, const void *number)
{
  const unsigned char *bytes = number;

  for (size_t b = width; b > 0; b--) (void)fputc(bytes[b - 1], stream);
}

static void WriteWhole(FILE *stream, PetscInt number)
{
  const int32_t narrow = (int32_t)number;

  Write(stream, sizeof narrow, &narrow);
}

void MpmMatrixWritePetsc(const MpmCsr *c, FILE *stream)
{
  WriteWhole(stream, MAT_FILE_CLASSID);
  WriteWhole(stream, c->order);
  WriteWhole(stream, c->order);
  WriteWhole(stream, c->begin[c->order]);
  for (PetscInt i = 0; i < c->order; i++) WriteWhole(stream, c->begin[i + 1] - c->begin[i]);
  for (PetscInt k = 0; k < c->begin[c->order]; k++) WriteWhole(stream, c->column[k]);
  for (PetscInt k = 0; k < c->begin[c->order]; k++) Write(stream, sizeof(PetscReal), &c->value[k]);
}
