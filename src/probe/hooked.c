/* Comments that the hook writes. */
#include "probe/hooked.h"
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

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

PetscErrorCode MpmHookedTake(const char comment[], MpmHooked *h, const char **wrong)
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
