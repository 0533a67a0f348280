/* Comments that the hook writes. */
#include "io/hooked.h"
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

void MpmHookedBegin(MpmHooked *h)
{
  *h       = (MpmHooked){.dim = 0};
  h->moved = h->repeat = h->one_sided = h->two_sizes = h->additivity = h->unsettled = NAN;
}

/* As many numbers as a text begins with, at most so many. */
static PetscInt Numbers(const char text[], PetscInt most, PetscReal number[])
{
  for (PetscInt i = 0; i < most; i++) {
    char *end;

    number[i] = strtod(text, &end);
    if (end == text) return i;
    text = end;
  }
  return most;
}

static PetscErrorCode TakePlace(const char text[], MpmHooked *h)
{
  PetscFunctionBegin;
  if (h->places == h->room) {
    h->room = 2 * h->room + 1024;
    PetscCall(PetscRealloc(sizeof *h->x * MPM_MAX_DIM * (size_t)h->room, &h->x));
  }
  PetscCall(PetscArrayzero(h->x + MPM_MAX_DIM * h->places, MPM_MAX_DIM));
  (void)Numbers(text, MPM_MAX_DIM, h->x + MPM_MAX_DIM * h->places++);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHookedTake(const char comment[], MpmHooked *h)
{
  static const struct {
    const char *name;
    size_t      at;
  } said[]         = {{"moved", offsetof(MpmHooked, moved)},           {"repeat", offsetof(MpmHooked, repeat)},
                      {"one_sided", offsetof(MpmHooked, one_sided)},   {"two_sizes", offsetof(MpmHooked, two_sizes)},
                      {"additivity", offsetof(MpmHooked, additivity)}, {"size", offsetof(MpmHooked, size)},
                      {"single", offsetof(MpmHooked, single)},         {"numbers", offsetof(MpmHooked, numbers)},
                      {"cell_width", offsetof(MpmHooked, cell_width)}, {"unsettled", offsetof(MpmHooked, unsettled)}};
  const char *text = strchr(comment, ':');
  size_t      length;

  PetscFunctionBegin;
  comment += strspn(comment, " ");
  if (!text) PetscFunctionReturn(PETSC_SUCCESS);
  length = (size_t)(text++ - comment);
  if (length == 2 && !strncmp(comment, "at", 2)) PetscCall(TakePlace(text, h));
  if (length == 5 && !strncmp(comment, "scale", 5) && h->scales < MPM_HOOKED_NUMBERS)
    h->scales += Numbers(text, 1, h->scale + h->scales);
  if (length == 11 && !strncmp(comment, "field_scale", 11) && h->nfields < MPM_STEPPER_FIELDS) {
    MpmFieldScale *field = &h->field[h->nfields];

    if (sscanf(text, "%lf %15s %63[^\r\n]", &field->scale, field->from, field->name) == 3) h->nfields++;
  }
  if (length == 6 && !strncmp(comment, "period", 6)) h->dim = Numbers(text, MPM_MAX_DIM, h->period);
  for (size_t i = 0; i < sizeof said / sizeof *said; i++)
    if (strlen(said[i].name) == length && !strncmp(comment, said[i].name, length))
      (void)Numbers(text, 1, (PetscReal *)((char *)h + said[i].at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHookedFree(MpmHooked *h)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(h->x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What two steps from the same state differ by is felt by an entry over the size of the perturbations. */
PetscErrorCode MpmHookedCertificates(MPI_Comm comm, const MpmHooked *h, PetscReal tolerance, MpmCertificates *c)
{
  PetscReal said[] = {
      h->moved,    h->repeat / (h->size > 0 ? h->size : 1), h->one_sided, h->two_sizes, h->additivity, h->single,
      h->unsettled};
  PetscBool single;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(said, sizeof said / sizeof *said, MPIU_REAL, 0, comm));
  single = said[5] > 0 ? PETSC_TRUE : PETSC_FALSE;
  MpmCertificatesBegin(single, single ? PetscMax(tolerance, MPM_TOLERANCE_SINGLE) : tolerance, c);
  c->value[MPM_CERTIFY_EQUILIBRIUM] = said[0];
  c->value[MPM_CERTIFY_REPEAT]      = said[1];
  c->value[MPM_CERTIFY_ONE_SIDED]   = said[2];
  c->value[MPM_CERTIFY_SIZES]       = said[3];
  c->value[MPM_CERTIFY_ADDITIVITY]  = said[4];
  c->value[MPM_CERTIFY_SCALES]      = said[6];
  c->nfields                        = h->nfields; /* for the first rank, which reports */
  PetscCall(PetscArraycpy(c->field, h->field, h->nfields));
  PetscFunctionReturn(PETSC_SUCCESS);
}
