/*
   Finds the physical mode among the eigenvectors of a phase's matrix, by the angle between each and the exact wave.

   Over a period of several steps the angle of an amplification factor is known up to whole turns only. So the mode is
   followed step by step, and its turns against the exact wave at rest are added up.
*/
#include "analysis/damping.h"
#include "base/farm.h"
#include "linalg/small_eigen.h"
#include "scene/layout.h"
#include "symbol/bloch.h"
#include <math.h>

#define AS_NEAR 0.6 /* modes with this share of the largest match are about as near to the exact wave */
#define EQUAL 1e-9  /* relative: abs that differ by less are taken for equal */
#define WHOLE 1e-3  /* turns that differ less from a whole number are taken for it */

/*
   wave: the exact wave, a state of a cell; weight: what squares of its numbers are multiplied by; match: of each
   eigenvector; at: the number of the time step of bloch, -1 for none
*/
typedef struct {
  const MpmScene *scene;
  MpmDamping     *damping;
  MpmBloch        bloch;
  MpmSmallEigen   eigen;
  MpmStep         step;
  PetscInt        at;
  double complex *wave;
  PetscReal      *weight, *match;
} Search;

/* The time step of a scene over a whole number, with particles of the same speed. */
static MpmStep Part(const MpmScene *scene, PetscInt divisor)
{
  const MpmFraction part = {.num = 1, .den = divisor, .value = 1.0 / (PetscReal)divisor};
  MpmStep           step = {.courant = scene->step.courant / (PetscReal)divisor};

  for (PetscInt a = 0; a < MPM_MAX_DIM; a++)
    step.drift[a] = divisor == 1 || scene->step.drift[a].value == 0
                        ? scene->step.drift[a]
                        : MpmFractionProduct(2, (MpmFraction[]){scene->step.drift[a], part});
  return step;
}

/* A plane wave along x, in units of cells and h / c. */
static MpmProfile Profile(const MpmScene *scene, PetscReal beta)
{
  MpmProfile p = {.initial    = MPM_INITIAL_MODE,
                  .dim        = scene->layout.dim,
                  .nwaves     = 1,
                  .length     = 1,
                  .wave_speed = 1,
                  .cell_width = 1,
                  .amplitude  = 1,
                  .poisson    = MpmSceneHasPoisson(scene) ? scene->scheme.space.poisson : 0.5,
                  .speed      = 1,
                  .wavenumber = beta};

  p.wave[0] = (MpmPlaneWave){.normal = {1}, .direction = {1}, .weight = 1};
  return p;
}

/*
   The part e^(i (beta X - omega t)) of the exact standing wave f, at time 0. A quarter of the wave or of the period
   later such a part is multiplied by i or -i, so the other three cancel in

     1/4 (f(X, 0) - i f(X + quarter, 0) + i f(X, quarter) + f(X + quarter, quarter))
*/
static double complex Travelling(const MpmWave *wave, const MpmProfile *p, PetscInt field, PetscInt component,
                                 PetscReal x)
{
  const PetscReal quarter           = PETSC_PI / 2 / p->wavenumber;
  const PetscReal X[2][MPM_MAX_DIM] = {{x}, {x + quarter}};
  PetscReal       f[2][2];

  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) f[i][j] = wave->value(p, field, component, X[i], j * quarter);
  return CMPLX((f[0][0] + f[1][1]) / 4, (f[0][1] - f[1][0]) / 4);
}

static void SetWave(Search *s, PetscReal beta)
{
  const MpmTable  *table   = s->scene->scheme.table;
  const MpmWave   *wave    = s->scene->scheme.formulation->wave;
  const MpmProfile profile = Profile(s->scene, beta);

  for (PetscInt j = 0; j < s->bloch.ppc; j++) {
    PetscReal xi[MPM_MAX_DIM];
    PetscInt  cell[MPM_MAX_DIM];

    MpmLayoutPlace(&s->scene->layout, j % s->scene->layout.ppc[0], cell, xi);
    for (PetscInt r = 0; r < table->nstate; r++) {
      const PetscInt at = table->nstate * j + r;

      s->wave[at]   = 0;
      s->weight[at] = 0;
      if (table->field[r] == MPM_NONE) continue;
      s->wave[at]   = Travelling(wave, &profile, table->field[r], table->component[r], cell[0] + xi[0]);
      s->weight[at] = 1 / PetscSqr(wave->amplitude(&profile, table->field[r]));
    }
  }
}

/* The product of the exact wave with a state of a cell. */
static double complex Along(const Search *s, const double complex state[])
{
  double complex sum = 0;

  for (PetscInt i = 0; i < s->bloch.size; i++) sum += s->weight[i] * conj(s->wave[i]) * state[i];
  return sum;
}

static PetscReal Norm(const Search *s, const double complex state[])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < s->bloch.size; i++) sum += s->weight[i] * PetscSqr(cabs(state[i]));
  return sqrt(sum);
}

static void Normalise(const Search *s, double complex state[])
{
  const PetscReal norm = Norm(s, state);

  for (PetscInt i = 0; i < s->bloch.size && norm > 0; i++) state[i] /= norm;
}

/*
   Finds the eigenvector that is nearest to the exact wave. Of those that are about as near it is the one that decays
   most slowly, by more than rounding.
*/
static PetscInt Nearest(Search *s, PetscReal *match)
{
  const PetscInt  n    = s->bloch.size;
  const PetscReal wave = Norm(s, s->wave);
  PetscReal       most = 0;
  PetscInt        best = 0;

  for (PetscInt j = 0; j < n; j++) {
    const PetscReal norm = Norm(s, s->eigen.right + j * n);

    s->match[j] = norm > 0 ? PetscSqr(cabs(Along(s, s->eigen.right + j * n)) / (norm * wave)) : 0;
    if (s->match[j] > most) best = j;
    most = PetscMax(most, s->match[j]);
  }
  for (PetscInt j = 0; j < n; j++)
    if (s->match[j] > AS_NEAR * most && cabs(s->eigen.value[j]) > cabs(s->eigen.value[best]) * (1 + EQUAL)) best = j;
  *match = s->match[best];
  return best;
}

/*
   By how much a mode turns in a period: the angle of its amplification factor, and the whole turns that it is followed
   through. NaN where rounding that grows has taken over on the way, so that the two do not agree.
*/
static PetscErrorCode Turn(Search *s, const PetscReal beta[], double complex factor, double complex mode[],
                           PetscReal *turn)
{
  const PetscReal angle    = carg(factor);
  PetscReal       followed = 0, turns;

  PetscFunctionBegin;
  *turn = angle;
  if (s->bloch.period == 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt step = 0; step < s->bloch.period; step++) {
    const double complex before = Along(s, mode);

    PetscCall(MpmBlochStep(&s->bloch, s->step.courant, beta, step, mode));
    followed += carg(Along(s, mode) / before);
    Normalise(s, mode);
  }
  turns = (followed - angle) / (2 * PETSC_PI);
  *turn = fabs(turns - round(turns)) < WHOLE ? angle + 2 * PETSC_PI * round(turns) : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes ready for a time step; what belonged to another one is freed. */
static PetscErrorCode SetStep(Search *s, PetscInt i)
{
  PetscFunctionBegin;
  if (s->at == i) PetscFunctionReturn(PETSC_SUCCESS);
  if (s->at >= 0) PetscCall(MpmBlochDestroy(&s->bloch));
  s->at   = i;
  s->step = Part(s->scene, s->damping->divisor[i]);
  PetscCall(MpmBlochCreate(&s->scene->layout, &s->scene->scheme, s->step.drift, &s->bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindOne(void *context, PetscInt i)
{
  Search         *s                 = context;
  MpmDamping     *d                 = s->damping;
  const PetscReal beta[MPM_MAX_DIM] = {2 * PETSC_PI / d->wavelength[i % d->nwaves]};
  PetscInt        exponent, best;
  PetscReal       turn, time, growth;

  PetscFunctionBegin;
  PetscCall(SetStep(s, i / d->nwaves));
  time = s->step.courant * s->bloch.period;
  SetWave(s, beta[0]);
  PetscCall(MpmBlochMatrices(&s->bloch, 1, &s->step.courant, beta, PETSC_FALSE, s->eigen.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&s->eigen, PETSC_TRUE));
  best = Nearest(s, &d->match[i]);
  PetscCall(Turn(s, beta, s->eigen.value[best], s->eigen.right + best * s->bloch.size, &turn));
  growth          = log(cabs(s->eigen.value[best])) + exponent * log(2);
  d->decay[i]     = -growth / time;
  d->frequency[i] = -turn / time / beta[0] - 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDampingCreate(const MpmScene *scene, const MpmRequest *request, MpmDamping **damping)
{
  const PetscReal begin = MPI_Wtime();
  const PetscInt  size  = scene->scheme.table->nstate * MpmLayoutPpc(&scene->layout);
  Search          s     = {.scene = scene, .at = -1};
  PetscInt        n, period;
  MpmDamping     *d;

  PetscFunctionBegin;
  PetscCall(PetscNew(damping));
  d = s.damping = *damping;
  d->nwaves     = request->phases[0] / 3;
  d->nsteps     = request->ndivisors;
  d->divisor    = request->divisors;
  n             = d->nwaves * d->nsteps;
  PetscCall(PetscMalloc2(d->nwaves, &d->wavelength, d->nsteps, &d->courant));
  PetscCall(PetscCalloc3(n, &d->decay, n, &d->frequency, n, &d->match));
  for (PetscInt m = 1; m <= d->nwaves; m++) d->wavelength[m - 1] = (PetscReal)request->phases[0] / (PetscReal)m;
  for (PetscInt i = 0; i < d->nsteps; i++) {
    const MpmStep step = Part(scene, d->divisor[i]);

    d->courant[i] = step.courant;
    PetscCall(MpmStepPeriod(&step, &period));
  }
  PetscCall(MpmSmallEigenCreate(size, &s.eigen));
  PetscCall(PetscMalloc3(size, &s.wave, size, &s.weight, size, &s.match));
  PetscCall(MpmFarm("wave", n, FindOne, &s));
  PetscCall(MpmFarmSumReals(n, d->decay));
  PetscCall(MpmFarmSumReals(n, d->frequency));
  PetscCall(MpmFarmSumReals(n, d->match));
  PetscCall(PetscFree3(s.wave, s.weight, s.match));
  PetscCall(MpmSmallEigenDestroy(&s.eigen));
  if (s.at >= 0) PetscCall(MpmBlochDestroy(&s.bloch));
  d->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDampingDestroy(MpmDamping **damping)
{
  MpmDamping *d = *damping;

  PetscFunctionBegin;
  if (!d) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree2(d->wavelength, d->courant));
  PetscCall(PetscFree3(d->decay, d->frequency, d->match));
  PetscCall(PetscFree(*damping));
  PetscFunctionReturn(PETSC_SUCCESS);
}
