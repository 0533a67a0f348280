/*
   The columns of an operator: particles of one colour of <mpmstab_scales.h> are perturbed together. Cells are left free
   between what two of them reach: what arrives there shows that the reach was taken too short. Without places each
   particle has a colour of its own.
*/
#include "probe/columns.h"
#include "linalg/singular.h"
#include "base/hash.h"
#include <mpmstab/errors.h>
#include <mpmstab_scales.h>

#define BETWEEN 1  /* cells between the reaches of two particles of a colour: what is felt farther is felt there, too */
#define FELT 1e-14 /* a response below this, of the largest, is none */
#define FELT_SINGLE 0.0       /* floats far away do not change at all */
#define MOST_NUMBERS 10000000 /* of states that are made at a time */
#define VECTORS 4             /* random ones, for a norm */

typedef struct {
  MpmProbe       *probe;
  mpmstab_colours at;
} Colouring;

static PetscInt CellOf(const MpmStepper *s, PetscInt64 i, PetscInt a)
{
  if (s->place == MPM_NONE) return s->cell[i * s->dim + a];
  return (PetscInt)floor(s->base[i * s->width + s->fields[s->place].first + a] / s->cell_width);
}

/* With a period cells are counted around it, without one from the first particle to the last. */
static void Box(Colouring *c)
{
  const MpmStepper *s = c->probe->stepper;

  for (PetscInt a = 0; a < s->dim; a++) {
    PetscInt least = CellOf(s, 0, a), most = least;

    for (PetscInt64 i = 0; i < s->particles; i++) {
      least = PetscMin(least, CellOf(s, i, a));
      most  = PetscMax(most, CellOf(s, i, a));
    }
    c->at.wraps[a] = s->period[a] > 0;
    c->at.bins[a]  = c->at.wraps[a] ? (long)ceil(s->period[a] / s->cell_width - 1e-6) : most - least + 1;
    for (PetscInt64 i = 0; i < s->particles; i++) c->at.bin[3 * i + a] = (CellOf(s, i, a) - least) % c->at.bins[a];
  }
}

/* alone: each particle by itself, wherever it is. */
static PetscErrorCode Begin(MpmProbe *p, PetscBool alone, Colouring *c)
{
  const MpmStepper *s = p->stepper;

  PetscFunctionBegin;
  *c = (Colouring){.probe = p,
                   .at    = {.dim = (int)s->dim, .alone = alone, .between = BETWEEN, .particles = s->particles}};
  MpmCheckInput(alone || s->place != MPM_NONE || s->cell,
                "%s: it does not say where its particles are; needed: a field with \"place\": true, or \"cell\" in its "
                "description",
                s->where);
  PetscCall(PetscMalloc3(3 * s->particles, &c->at.bin, s->particles, &c->at.colour_of, s->particles, &c->at.owner));
  if (alone) PetscFunctionReturn(PETSC_SUCCESS);
  Box(c);
  PetscCall(PetscMalloc1(mpmstab_cells_(&c->at), &c->at.grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode End(Colouring *c)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(c->at.bin, c->at.colour_of, c->at.owner));
  PetscCall(PetscFree(c->at.grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- reach ---- */

/* The particle that is nearest to the middle of the box, where the response has most room. */
static PetscInt64 Central(const Colouring *c)
{
  const MpmStepper *s       = c->probe->stepper;
  PetscInt64        central = 0;
  PetscReal         nearest = PETSC_MAX_REAL;

  for (PetscInt64 i = 0; i < s->particles; i++) {
    PetscReal distance = 0;

    for (PetscInt a = 0; a < s->dim; a++)
      distance += PetscSqr((PetscReal)c->at.bin[3 * i + a] - (PetscReal)c->at.bins[a] / 2);
    if (distance >= nearest) continue;
    nearest = distance;
    central = i;
  }
  return central;
}

static PetscErrorCode Reach(Colouring *c)
{
  MpmProbe         *p       = c->probe;
  const MpmStepper *s       = p->stepper;
  const PetscInt64  central = Central(c);
  PetscInt64       *unknown;
  PetscReal        *amount, *response, largest = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(s->width, &unknown, s->width, &amount, s->particles * s->width, &response));
  for (PetscInt j = 0; j < s->width; j++) {
    unknown[j] = central * s->width + j;
    amount[j]  = p->size;
  }
  PetscCall(MpmProbeRespond(p, PETSC_FALSE, s->width, unknown, amount, response));
  PetscCall(MpmStepperAgree(p->stepper));
  for (PetscInt64 i = 0; i < s->particles * s->width; i++) largest = PetscMax(largest, PetscAbsReal(response[i]));
  for (PetscInt64 i = 0; i < s->particles * s->width; i++) {
    if (PetscAbsReal(response[i]) <= (p->single ? FELT_SINGLE : FELT) * largest) continue;
    for (int a = 0; a < s->dim; a++)
      c->at.reach[a] = PetscMax(c->at.reach[a], mpmstab_cells_apart_(&c->at, (long)(i / s->width), (long)central, a));
  }
  PetscCall(PetscFree3(unknown, amount, response));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Colour(Colouring *c, MpmProbeColours *colours)
{
  PetscFunctionBegin;
  PetscCheck(mpmstab_colour_(&c->at), PETSC_COMM_SELF, PETSC_ERR_MEM, "colours of particles");
  colours->colours = (PetscInt)c->at.colours * c->probe->stepper->width;
  for (PetscInt a = 0; a < c->at.dim; a++) colours->reach[a] = (PetscInt)c->at.reach[a];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeReach(MpmProbe *p, MpmProbeColours *colours)
{
  Colouring c;

  PetscFunctionBegin;
  *colours = (MpmProbeColours){.colours = 0};
  PetscCall(Begin(p, PETSC_FALSE, &c));
  PetscCall(Reach(&c));
  PetscCall(Colour(&c, colours));
  colours->everywhere = PETSC_TRUE;
  for (PetscInt a = 0; a < c.at.dim; a++)
    if (2 * c.at.reach[a] + 1 < c.at.bins[a]) colours->everywhere = PETSC_FALSE;
  PetscCall(End(&c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- matrices ---- */

/* The rows of a rank are whole particles. */
static PetscInt LocalRows(const MpmStepper *s, PetscInt width)
{
  const PetscMPIInt ranks = MpmRanksOf(PETSC_COMM_WORLD), rank = MpmRankOf(PETSC_COMM_WORLD);

  return (PetscInt)(s->particles * (rank + 1) / ranks - s->particles * rank / ranks) * width;
}

PetscErrorCode MpmProbeNewMatrix(const MpmStepper *s, PetscInt width, PetscInt most, Mat *A)
{
  const PetscInt rows = LocalRows(s, width), all = (PetscInt)s->particles * width;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, rows, rows, all, all, most ? PetscMin(most, rows) : PETSC_DEFAULT, NULL,
                         most ? PetscMin(most, all - rows) : PETSC_DEFAULT, NULL, A));
  PetscCall(MatSetOption(*A, most ? MAT_IGNORE_ZERO_ENTRIES : MAT_NEW_NONZERO_ALLOCATION_ERR,
                         most ? PETSC_TRUE : PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeFillDiagonal(Mat A)
{
  PetscInt first, last;

  PetscFunctionBegin;
  PetscCall(MatAssemblyBegin(A, MAT_FLUSH_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FLUSH_ASSEMBLY));
  PetscCall(MatSetOption(A, MAT_IGNORE_ZERO_ENTRIES, PETSC_FALSE));
  PetscCall(MatGetOwnershipRange(A, &first, &last));
  for (PetscInt i = first; i < last; i++) PetscCall(MatSetValue(A, i, i, 0, ADD_VALUES));
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeEach(MpmProbe *p, PetscInt total, PetscInt64 most, MpmProbePerturb perturb, MpmProbeTake take,
                            void *context)
{
  const PetscMPIInt ranks = MpmRanksOf(PETSC_COMM_WORLD);
  const PetscInt64  all   = p->stepper->particles * p->stepper->width;
  const PetscInt    fit   = (PetscInt)PetscMax(1, PetscMin(p->stepper->batch / 2, MOST_NUMBERS / all));
  MpmPerturbation  *each;
  PetscInt         *which, j = MpmRankOf(PETSC_COMM_WORLD);

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(fit, &each, fit, &which));
  for (PetscInt k = 0; k < fit; k++)
    PetscCall(PetscMalloc3(most, &each[k].unknown, most, &each[k].amount, all, &each[k].response));
  while (j < total) {
    PetscInt m = 0;

    for (; j < total && m < fit; j += ranks) {
      which[m]  = j;
      each[m].n = 0;
      PetscCall(perturb(context, j, &each[m]));
      if (each[m].n) m++;
    }
    PetscCall(MpmProbeRespondAll(p, PETSC_FALSE, m, each));
    for (PetscInt k = 0; k < m; k++) PetscCall(take(context, which[k], &each[k]));
  }
  for (PetscInt k = 0; k < fit; k++) PetscCall(PetscFree3(each[k].unknown, each[k].amount, each[k].response));
  PetscCall(PetscFree2(each, which));
  PetscCall(MpmStepperAgree(p->stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- columns ---- */

/* by: for each particle what its unknown of a colour was perturbed by. seen: the largest leak, and response. */
typedef struct {
  Colouring *colouring;
  PetscReal  size, *by, seen[2];
  Mat        A;
} Columns;

static PetscErrorCode Perturb(void *context, PetscInt colour, MpmPerturbation *d)
{
  const Columns    *columns = context;
  const Colouring  *c       = columns->colouring;
  const MpmStepper *s       = c->probe->stepper;
  const PetscInt    number  = colour % s->width;

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < s->particles && !MpmProbeIsApart(c->probe, number); i++) {
    if (c->at.colour_of[i] != colour / s->width) continue;
    d->unknown[d->n]  = i * s->width + number;
    d->amount[d->n++] = columns->size;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Take(void *context, PetscInt colour, const MpmPerturbation *d)
{
  Columns          *columns = context;
  Colouring        *c       = columns->colouring;
  const MpmStepper *s       = c->probe->stepper;

  PetscFunctionBegin;
  for (PetscInt64 k = 0; k < d->n; k++) columns->by[d->unknown[k] / s->width] = d->amount[k];
  mpmstab_own_(&c->at, colour / s->width);
  for (PetscInt64 i = 0; i < s->particles; i++) {
    const long source = c->at.owner[i];

    for (PetscInt j = 0; j < s->width; j++) {
      const PetscReal felt = d->response[i * s->width + j];
      const PetscInt  row = (PetscInt)(i * s->width + j), column = (PetscInt)source * s->width + colour % s->width;

      columns->seen[1] = PetscMax(columns->seen[1], PetscAbsReal(felt));
      if (source < 0)
        columns->seen[0] = PetscMax(columns->seen[0], PetscAbsReal(felt));
      else if (felt != 0)
        PetscCall(MatSetValue(columns->A, row, column, felt / columns->by[source], ADD_VALUES));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Probe(Colouring *c, PetscReal size, MpmProbeColours *colours, Mat A)
{
  const MpmStepper *s       = c->probe->stepper;
  Columns           columns = {.colouring = c, .size = size, .A = A};

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(s->particles, &columns.by));
  PetscCall(MpmProbeEach(c->probe, colours->colours, s->particles, Perturb, Take, &columns));
  PetscCall(PetscFree(columns.by));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, columns.seen, 2, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD));
  colours->leaks = columns.seen[1] > 0 ? columns.seen[0] / columns.seen[1] : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeMatrix(MpmProbe *p, PetscReal size, MpmProbeColours *colours, Mat *A)
{
  const MpmStepper *s     = p->stepper;
  MpmProbeColours   each  = {.colours = 0};
  PetscBool         grows = PETSC_TRUE;
  Colouring         c;

  PetscFunctionBegin;
  *A = NULL;
  PetscCall(Begin(p, colours ? PETSC_FALSE : PETSC_TRUE, &c));
  if (colours) {
    each = *colours;
    PetscCall(Reach(&c));
    for (PetscInt a = 0; a < c.at.dim; a++) c.at.reach[a] = PetscMax(c.at.reach[a], each.reach[a]);
  }
  while (grows) {
    PetscCall(Colour(&c, &each));
    PetscCall(MatDestroy(A));
    PetscCall(MpmProbeNewMatrix(s, s->width, colours ? 0 : (PetscInt)s->particles * s->width, A));
    PetscCall(Probe(&c, size, &each, *A));
    grows = PETSC_FALSE;
    for (PetscInt a = 0; a < c.at.dim && colours; a++) {
      if (each.leaks <= FELT || 2 * c.at.reach[a] + 1 >= c.at.bins[a]) continue;
      c.at.reach[a]++;
      grows = PETSC_TRUE;
    }
  }
  PetscCall(MpmProbeFillDiagonal(*A));
  if (colours) *colours = each;
  PetscCall(End(&c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the shell ---- */

/* all: the vector on every rank; amount, response: of a product. */
typedef struct {
  MpmProbe  *probe;
  PetscReal  size, *amount, *response;
  Vec        all;
  VecScatter scatter;
} Shell;

/* The response to size / largest(x) x, over that factor. */
static PetscErrorCode Respond(Shell *shell, const PetscScalar x[], PetscReal largest)
{
  const MpmStepper *s = shell->probe->stepper;
  const PetscInt64  n = s->particles * s->width;

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < n; i++) shell->amount[i] = shell->size / largest * x[i];
  if (MpmRankOf(PETSC_COMM_WORLD) == 0)
    PetscCall(MpmProbeRespond(shell->probe, PETSC_FALSE, n, NULL, shell->amount, shell->response));
  PetscCall(MpmStepperAgree(shell->probe->stepper));
  PetscCallMPI(MPI_Bcast(shell->response, (PetscMPIInt)n, MPIU_REAL, 0, PETSC_COMM_WORLD));
  for (PetscInt64 i = 0; i < n; i++) shell->response[i] *= largest / shell->size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Multiply(Mat A, Vec x, Vec y)
{
  PetscReal          largest;
  PetscInt           first, last;
  const PetscScalar *values;
  PetscScalar       *own;
  Shell             *shell;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(A, &shell));
  PetscCall(VecNorm(x, NORM_INFINITY, &largest));
  PetscCall(VecSet(y, 0));
  if (!(largest > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecScatterBegin(shell->scatter, x, shell->all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(shell->scatter, x, shell->all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArrayRead(shell->all, &values));
  PetscCall(Respond(shell, values, largest));
  PetscCall(VecRestoreArrayRead(shell->all, &values));
  PetscCall(VecGetOwnershipRange(y, &first, &last));
  PetscCall(VecGetArray(y, &own));
  PetscCall(PetscArraycpy(own, shell->response + first, last - first));
  PetscCall(VecRestoreArray(y, &own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Mat A)
{
  Shell *shell;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(A, &shell));
  PetscCall(PetscFree2(shell->amount, shell->response));
  PetscCall(VecDestroy(&shell->all));
  PetscCall(VecScatterDestroy(&shell->scatter));
  PetscCall(PetscFree(shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeShell(MpmProbe *p, PetscReal size, Mat *A)
{
  const PetscInt rows = LocalRows(p->stepper, p->stepper->width),
                 n    = (PetscInt)p->stepper->particles * p->stepper->width;
  Shell *shell;
  Vec    x;

  PetscFunctionBegin;
  PetscCall(PetscNew(&shell));
  shell->probe = p;
  shell->size  = size;
  PetscCall(PetscMalloc2(n, &shell->amount, n, &shell->response));
  PetscCall(MatCreateShell(PETSC_COMM_WORLD, rows, rows, n, n, shell, A));
  PetscCall(MatShellSetOperation(*A, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(MatShellSetOperation(*A, MATOP_NORM, (void (*)(void))MpmNormBelow));
  PetscCall(MatShellSetOperation(*A, MATOP_DESTROY, (void (*)(void))Destroy));
  PetscCall(MatCreateVecs(*A, &x, NULL));
  PetscCall(VecScatterCreateToAll(x, &shell->scatter, &shell->all));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeShellDistance(Mat one, Mat other, PetscReal *distance)
{
  Vec x, y[2];

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(one, &x, &y[0]));
  PetscCall(VecDuplicate(y[0], &y[1]));
  *distance = 0;
  for (PetscInt k = 0; k < VECTORS; k++) {
    PetscReal of, norm;

    PetscCall(MpmSingularStart(71 + k, x));
    PetscCall(MatMult(one, x, y[0]));
    PetscCall(MatMult(other, x, y[1]));
    PetscCall(VecAXPY(y[0], -1, y[1]));
    PetscCall(VecNorm(y[0], NORM_2, &norm));
    PetscCall(VecNorm(x, NORM_2, &of));
    *distance = PetscMax(*distance, norm / of);
  }
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y[0]));
  PetscCall(VecDestroy(&y[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
