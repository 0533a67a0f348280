/*
   Matrix Market: a line that says what the file is, comments, sizes, and an entry a line (Boisvert, Pozo and Remington
   1996, NISTIR 5935). Rows and columns count from 1.

   A comment '% steps: 8' says that the matrix covers 8 steps. For other comments see io/hooked.h.
*/
#include "io/matrix_file.h"
#include <stdlib.h>
#include <string.h>

#define LINE 1025
#define SHORTEST 2 /* bytes of a line with a number */
#define STEPS "steps:"

/* What the first line says. */
typedef struct {
  PetscBool dense, symmetric, skew;
} Banner;

static PetscErrorCode ReadBanner(FILE *stream, Banner *b, char why[MPM_WHY_TEXT])
{
  char  line[LINE], *save, *word[5] = {NULL};
  char *next;

  PetscFunctionBegin;
  if (!fgets(line, sizeof line, stream)) line[0] = '\0';
  for (char *c = line; *c; c++) *c = (char)(*c >= 'A' && *c <= 'Z' ? *c + 32 : *c);
  next = strtok_r(line, " \t\r\n", &save);
  for (int i = 0; i < 5 && next; i++) {
    word[i] = next;
    next    = strtok_r(NULL, " \t\r\n", &save);
  }
  if (!word[4] || strcmp(word[1], "matrix") || (strcmp(word[2], "coordinate") && strcmp(word[2], "array")) ||
      (strcmp(word[3], "real") && strcmp(word[3], "double") && strcmp(word[3], "integer")) ||
      (strcmp(word[4], "general") && strcmp(word[4], "symmetric") && strcmp(word[4], "skew-symmetric"))) {
    PetscCall(
        PetscSNPrintf(why, MPM_WHY_TEXT,
                      "Matrix Market of kind %.20s %.20s %.20s; allowed: coordinate or array, real or integer, and "
                      "general, symmetric or skew-symmetric",
                      word[2] ? word[2] : "", word[3] ? word[3] : "", word[4] ? word[4] : ""));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  b->dense     = strcmp(word[2], "array") ? PETSC_FALSE : PETSC_TRUE;
  b->skew      = strcmp(word[4], "skew-symmetric") ? PETSC_FALSE : PETSC_TRUE;
  b->symmetric = strcmp(word[4], "general") ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the next line that is no comment and not blank, and takes the comments before it. found: not the file's end. */
static PetscErrorCode NextLine(FILE *stream, MpmEntries *e, char line[LINE], PetscBool *found)
{
  PetscFunctionBegin;
  *found = PETSC_FALSE;
  while (!*found && fgets(line, LINE, stream)) {
    const char *said = line[0] == '%' ? line + 1 + strspn(line + 1, " ") : "";

    if (!strncmp(said, STEPS, strlen(STEPS))) e->steps = strtoll(said + strlen(STEPS), NULL, 10);
    if (line[0] == '%') PetscCall(MpmHookedTake(said, &e->hooked));
    if (line[0] != '%' && line[strspn(line, " \t\r\n")]) *found = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads so many numbers of a line, and nothing else. */
static PetscBool Numbers(const char line[], int n, PetscReal number[])
{
  for (int i = 0; i < n; i++) {
    char *end;

    number[i] = strtod(line, &end);
    if (end == line) return PETSC_FALSE;
    line = end;
  }
  return line[strspn(line, " \t\r\n")] ? PETSC_FALSE : PETSC_TRUE;
}

/* A row or column of the file as PetscInt; what is none becomes -1, which is refused later. */
static PetscInt Index(PetscReal number)
{
  return number >= 1 && number <= PETSC_MAX_INT && number == (PetscReal)(PetscInt)number ? (PetscInt)number - 1 : -1;
}

static void Put(MpmEntries *e, PetscInt row, PetscInt column, PetscReal value)
{
  e->row[e->n]     = row;
  e->column[e->n]  = column;
  e->value[e->n++] = value;
}

/* Reads the entries. Of a symmetric matrix the file has those below the diagonal, and of a skew one not the diagonal. */
static PetscErrorCode ReadEntries(FILE *stream, const Banner *b, PetscInt64 listed, MpmEntries *e,
                                  char why[MPM_WHY_TEXT])
{
  PetscInt64 row = b->skew, column = 0;
  char       line[LINE];
  PetscBool  found;

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < listed; i++) {
    PetscReal number[3];
    PetscInt  r, c;

    PetscCall(NextLine(stream, e, line, &found));
    if (!found || !Numbers(line, b->dense ? 1 : 3, number)) {
      PetscCall(PetscSNPrintf(why, MPM_WHY_TEXT, "entry %" PetscInt64_FMT " of %" PetscInt64_FMT "; allowed: %s", i + 1,
                              listed, b->dense ? "a line with one number" : "a line with row, column and value"));
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    r = b->dense ? (PetscInt)row : Index(number[0]);
    c = b->dense ? (PetscInt)column : Index(number[1]);
    Put(e, r, c, number[b->dense ? 0 : 2]);
    if (b->symmetric && r != c) Put(e, c, r, (b->skew ? -1 : 1) * number[b->dense ? 0 : 2]);
    if (b->dense && ++row == e->rows) {
      column++;
      row = b->symmetric ? column + b->skew : 0;
    }
  }
  PetscCall(NextLine(stream, e, line, &found));
  if (found)
    PetscCall(PetscSNPrintf(why, MPM_WHY_TEXT, "something follows its %" PetscInt64_FMT " entries; allowed: no more",
                            listed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatrixReadText(FILE *stream, MpmEntries *e, char why[MPM_WHY_TEXT])
{
  Banner     b = {PETSC_FALSE, PETSC_FALSE, PETSC_FALSE};
  char       line[LINE];
  PetscBool  found;
  PetscReal  size[3];
  PetscInt64 listed;
  struct {
    off_t at, end;
  } place;

  PetscFunctionBegin;
  PetscCall(ReadBanner(stream, &b, why));
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(NextLine(stream, e, line, &found));
  if (!found || !Numbers(line, b.dense ? 2 : 3, size)) {
    PetscCall(PetscSNPrintf(why, MPM_WHY_TEXT, "no line with its sizes; allowed: rows and columns%s",
                            b.dense ? "" : ", and the number of entries"));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (b.dense) size[2] = !b.symmetric ? size[0] * size[1] : size[0] * (size[0] + (b.skew ? -1 : 1)) / 2;
  place.at = ftello(stream);
  if (fseeko(stream, 0, SEEK_END)) place.at = -1;
  place.end = ftello(stream);
  if (place.at < 0 || fseeko(stream, place.at, SEEK_SET) ||
      !(size[2] >= 0 && size[2] * SHORTEST - 1 <= (PetscReal)(place.end - place.at))) {
    PetscCall(PetscSNPrintf(why, MPM_WHY_TEXT, "it is too short for %.10g entries; allowed: a whole file", size[2]));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmEntriesRoom(size[0], size[1], (b.symmetric ? 2 : 1) * size[2], e, why));
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  listed = (PetscInt64)size[2];
  e->n   = 0;
  PetscCall(ReadEntries(stream, &b, listed, e, why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatrixWriteText(const MpmCsr *c, PetscInt steps, FILE *stream)
{
  PetscFunctionBegin;
  (void)fprintf(stream, "%%%%MatrixMarket matrix coordinate real general\n%% " STEPS " %" PetscInt_FMT "\n", steps);
  (void)fprintf(stream, "%" PetscInt_FMT " %" PetscInt_FMT " %" PetscInt_FMT "\n", c->order, c->order,
                c->begin[c->order]);
  for (PetscInt i = 0; i < c->order; i++)
    for (PetscInt k = c->begin[i]; k < c->begin[i + 1]; k++)
      (void)fprintf(stream, "%" PetscInt_FMT " %" PetscInt_FMT " %.17g\n", i + 1, c->column[k] + 1, c->value[k]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
