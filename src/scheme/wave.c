/*
   Exact solutions, with X = x - U0 t. A mode is in any dimension; a pulse and a step are in one.

   First order, u_t = c r_x and r_t = c u_x:

     mode     u = A sin(KX + phase) cos(Kct),    r = A cos(KX + phase) sin(Kct)
     pulse    u = A f(X - ct),                   r = -A f(X - ct)
     step     u = 0,                             r = -A                          at time 0

   Second order, u_t = v and v_t = c^2 u_xx, written with w = v h / c:

     mode     u = (A/omega) sin(omega t) sin(KX + phase),    v = A cos(omega t) sin(KX + phase),    omega = K c
     pulse    u = A f(X - ct),                               v = -c A f'(X - ct)
     step     u = -(A/c) X,                                  v = 0               at time 0

   With more dimensions KX is K.X, and a mode is the sum of plane waves of wave vector K = abs(K) n and weight m:

     gas         u = m A d sin(K.X + phase) cos(omega t),    r = m A (d.n) cos(K.X + phase) sin(omega t),    d = n
     momentum    v as u,    s = (c/speed) (lambda (d.n) I + mu (d n^T + n d^T)) m A cos(K.X + phase) sin(omega t)

   with omega = abs(K) speed, and with damping and viscosity as InTime says. P waves have d = n and speed c, S waves
   have d across n and speed c sqrt(mu). A Poisson ratio of 1/2 makes lambda 1 and mu 0. Then s is r, and in one
   dimension the stress of a bar. The scalars u and w are as in one dimension.

   Field MPM_NONE is h times the gradient of u, and MPM_DISPLACEMENT x with x_t = (c/h) u.

   By d'Alembert u - r travels to the right, and u + r to the left. f is a Gaussian of standard deviation L/20 around
   L/4. It is repeated with period L, or between ends with its mirror images. Those beyond a fixed end have velocities
   of the other sign.

   step is a load A rho0 c on the free end of a bar at rest, from time 0 on. The equations are linear. So stress and
   displacement are counted from the equilibrium of the loaded bar, r = A and u = (A/c) X, and the load itself drops
   out.
*/
#include <mpmstab/wave.h>
#include <math.h>

const char *const MpmInitialNames[] = {"mode",   "random",      "pulse",      "eigenmode", "step",    "manufactured",
                                       "vortex", "simple_wave", "shock_tube", "collision", "uniform", NULL};
const char *const MpmPolarisationNames[] = {"p", "s", NULL};

static PetscReal PulseWidth(const MpmProfile *p)
{
  return p->length / 20;
}

/* f or its slope at Y on an unbounded line, with pulses at L/4 + n L, or between ends at L/4 + 2 n L with signs. */
static PetscReal Pulse(const MpmProfile *p, PetscReal Y, PetscBool slope)
{
  const PetscBool ends   = p->image[0] != 0 ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal period = ends ? 2 * p->length : p->length, n = round((Y - p->length / 4) / period);
  const PetscReal z    = (Y - p->length / 4 - n * period) / PulseWidth(p);
  const PetscReal sign = ends && fmod(fabs(n), 2) == 1 ? p->image[0] * p->image[1] : 1;

  return sign * exp(-z * z / 2) * (slope ? -z / PulseWidth(p) : 1);
}

/* A pulse is the sum of two waves: one travels to the right, and the other comes back from the right end. */
static PetscReal Travelling(const MpmProfile *p, PetscReal X, PetscReal ct, PetscBool slope)
{
  return p->amplitude * Pulse(p, X - ct, slope);
}

static PetscReal Returning(const MpmProfile *p, PetscReal X, PetscReal ct, PetscBool slope)
{
  return p->image[1] == 0 ? 0 : p->image[1] * p->amplitude * Pulse(p, 2 * p->length - X - ct, slope);
}

/*
   The stress of a bar at time 0, counted from the loaded bar's equilibrium, on an unbounded line. It is antisymmetric
   about the free end at L and symmetric about the fixed one at 0. StepDisplacement is its integral divided by c.
*/
static PetscReal StepStress(const MpmProfile *p, PetscReal Y)
{
  return fabs(remainder(Y, 4 * p->length)) < p->length ? -p->amplitude : p->amplitude;
}

static PetscReal StepDisplacement(const MpmProfile *p, PetscReal Y)
{
  const PetscReal y = remainder(Y, 4 * p->length);

  return -p->amplitude / p->wave_speed * (fabs(y) <= p->length ? y : copysign(2 * p->length - fabs(y), y));
}

static PetscReal StepVelocity(const MpmProfile *p, PetscReal X, PetscReal ct)
{
  return (StepStress(p, X + ct) - StepStress(p, X - ct)) / 2;
}

static PetscReal Angle(const MpmProfile *p, const MpmPlaneWave *wave, const PetscReal X[])
{
  PetscReal along = 0;

  for (PetscInt a = 0; a < p->dim; a++) along += wave->normal[a] * X[a];
  return p->wavenumber * along + p->phase;
}

/* omega t */
static PetscReal Turn(const MpmProfile *p, PetscReal t)
{
  return p->wavenumber * (p->speed * t);
}

/* The stress ab of a plane wave, relative to A. Components of a stress have the order 00 01 02 11 12 22. */
static PetscReal Stress(const MpmProfile *p, const MpmPlaneWave *wave, PetscInt component)
{
  const PetscReal lambda = p->poisson / (1 - p->poisson), mu = (1 - 2 * p->poisson) / (2 * (1 - p->poisson));
  PetscReal       along = 0;
  PetscInt        a = 0, b = component;

  for (; b >= p->dim; a++) b -= p->dim - a - 1;
  for (PetscInt c = 0; c < p->dim; c++) along += wave->direction[c] * wave->normal[c];
  return p->wave_speed / p->speed *
         ((a == b ? lambda * along : 0) +
          mu * (wave->direction[a] * wave->normal[b] + wave->direction[b] * wave->normal[a]));
}

/* The amplitude of x_t = (c/h) u in a mode. */
static PetscReal Displacement(const MpmProfile *p)
{
  return p->amplitude * p->wave_speed / (p->cell_width * p->wavenumber * p->speed);
}

/*
   The factors of the velocity and of the stress of a mode that loses the part decay of its velocity per time: of

     v_t = - omega s - decay v,    s_t = omega v,    v = 1 and s = 0 at time 0

   with w^2 = omega^2 - decay^2 / 4, which may be negative, v = e^(-decay t / 2) (cos w t - decay / (2 w) sin w t) and
   s = e^(-decay t / 2) (omega / w) sin w t.
*/
static PetscReal InTime(const MpmProfile *p, PetscBool stress, PetscReal t)
{
  const PetscReal omega = p->wavenumber * p->speed, half = p->decay / 2, square = omega * omega - half * half,
                  w = sqrt(fabs(square));
  PetscReal cosine = cos(w * t), sine = w * t == 0 ? t : sin(w * t) / w;

  if (half == 0) return stress ? sin(Turn(p, t)) : cos(Turn(p, t));
  if (square < 0) {
    cosine = cosh(w * t);
    sine   = sinh(w * t) / w;
  }
  return exp(-half * t) * (stress ? omega * sine : cosine - half * sine);
}

static PetscReal FirstOrderMode(const MpmProfile *p, PetscInt field, PetscInt component, const PetscReal X[],
                                PetscReal t)
{
  PetscReal sum = 0;

  for (PetscInt w = 0; w < p->nwaves; w++) {
    const MpmPlaneWave *wave  = &p->wave[w];
    const PetscReal     angle = Angle(p, wave, X);

    if (field == 0 || field == MPM_DISPLACEMENT)
      sum += wave->weight * wave->direction[component] * sin(angle);
    else if (field == 1)
      sum += wave->weight * Stress(p, wave, component) * cos(angle);
    else
      sum += wave->weight * wave->direction[component / p->dim] * wave->normal[component % p->dim] * cos(angle);
  }
  if (field == MPM_NONE) return p->amplitude * p->wavenumber * p->cell_width * sum * InTime(p, PETSC_FALSE, t);
  if (field == MPM_DISPLACEMENT) return Displacement(p) * sum * sin(Turn(p, t));
  return p->amplitude * (sum * InTime(p, field ? PETSC_TRUE : PETSC_FALSE, t));
}

static PetscReal FirstOrderPulse(const MpmProfile *p, PetscInt field, PetscReal X, PetscReal ct)
{
  if (field == MPM_NONE) return p->cell_width * (Travelling(p, X, ct, PETSC_TRUE) - Returning(p, X, ct, PETSC_TRUE));
  return (field ? -1 : 1) * Travelling(p, X, ct, PETSC_FALSE) + Returning(p, X, ct, PETSC_FALSE);
}

static PetscReal FirstOrderStep(const MpmProfile *p, PetscInt field, PetscReal X, PetscReal ct)
{
  if (field == MPM_NONE) return 0;
  return field ? (StepStress(p, X + ct) + StepStress(p, X - ct)) / 2 : StepVelocity(p, X, ct);
}

static PetscReal FirstOrderValue(const MpmProfile *p, PetscInt field, PetscInt component, const PetscReal X[],
                                 PetscReal t)
{
  if (p->initial == MPM_INITIAL_PULSE) return FirstOrderPulse(p, field, X[0], p->wave_speed * t);
  if (p->initial == MPM_INITIAL_STEP) return FirstOrderStep(p, field, X[0], p->wave_speed * t);
  return FirstOrderMode(p, field, component, X, t);
}

static PetscReal FirstOrderAmplitude(const MpmProfile *p, PetscInt field)
{
  if (field == 0 || p->initial == MPM_INITIAL_STEP) return p->amplitude;
  if (field == MPM_DISPLACEMENT) return Displacement(p);
  if (field == 1) return p->initial == MPM_INITIAL_PULSE ? p->amplitude : p->amplitude * (p->speed / p->wave_speed);
  return p->amplitude * p->cell_width *
         (p->initial == MPM_INITIAL_PULSE ? 1 / (PulseWidth(p) * sqrt(M_E)) : p->wavenumber);
}

static PetscReal FirstOrderVelocityUnit(const MpmProfile *p)
{
  (void)p;
  return 1;
}

static PetscReal SecondOrderMode(const MpmProfile *p, PetscInt field, const PetscReal X[], PetscReal t)
{
  PetscReal sum = 0;

  for (PetscInt w = 0; w < p->nwaves; w++) sum += p->wave[w].weight * sin(Angle(p, &p->wave[w], X));
  if (field) return p->amplitude * p->cell_width / p->wave_speed * cos(Turn(p, t)) * sum;
  return p->amplitude / (p->wavenumber * p->wave_speed) * sin(Turn(p, t)) * sum;
}

static PetscReal SecondOrderPulse(const MpmProfile *p, PetscInt field, PetscReal X, PetscReal ct)
{
  if (field) return -p->cell_width * (Travelling(p, X, ct, PETSC_TRUE) + Returning(p, X, ct, PETSC_TRUE));
  return Travelling(p, X, ct, PETSC_FALSE) + Returning(p, X, ct, PETSC_FALSE);
}

static PetscReal SecondOrderStep(const MpmProfile *p, PetscInt field, PetscReal X, PetscReal ct)
{
  if (field) return p->cell_width / p->wave_speed * StepVelocity(p, X, ct);
  return (StepDisplacement(p, X + ct) + StepDisplacement(p, X - ct)) / 2;
}

static PetscReal SecondOrderValue(const MpmProfile *p, PetscInt field, PetscInt component, const PetscReal X[],
                                  PetscReal t)
{
  (void)component; /* u and w are numbers */
  if (p->initial == MPM_INITIAL_PULSE) return SecondOrderPulse(p, field, X[0], p->wave_speed * t);
  if (p->initial == MPM_INITIAL_STEP) return SecondOrderStep(p, field, X[0], p->wave_speed * t);
  return SecondOrderMode(p, field, X, t);
}

static PetscReal SecondOrderAmplitude(const MpmProfile *p, PetscInt field)
{
  if (p->initial == MPM_INITIAL_PULSE) return p->amplitude * (field ? p->cell_width / (PulseWidth(p) * sqrt(M_E)) : 1);
  if (field) return p->amplitude * p->cell_width / p->wave_speed;
  return p->amplitude * (p->initial == MPM_INITIAL_STEP ? p->length : 1 / p->wavenumber) / p->wave_speed;
}

/* v = w c / h, and c u_x = (difference of u over a cell) c / h. */
static PetscReal SecondOrderVelocityUnit(const MpmProfile *p)
{
  return p->wave_speed / p->cell_width;
}

const MpmWave MpmWaveFirstOrder  = {.equations     = "u_t = c r_x, r_t = c u_x",
                                    .equations_nd  = "u_t = c grad r, r_t = c div u",
                                    .value         = FirstOrderValue,
                                    .amplitude     = FirstOrderAmplitude,
                                    .velocity_unit = FirstOrderVelocityUnit};
const MpmWave MpmWaveMomentum    = {.equations     = "v_t = c s_x, s_t = c v_x",
                                    .equations_nd  = "v_t = c div s, s_t = c (lambda div v I + mu (grad v + grad v^T))",
                                    .value         = FirstOrderValue,
                                    .amplitude     = FirstOrderAmplitude,
                                    .velocity_unit = FirstOrderVelocityUnit};
const MpmWave MpmWaveSecondOrder = {.equations     = "u_t = (c/h) w, w_t = h c u_xx",
                                    .equations_nd  = "u_t = (c/h) w, w_t = h c div grad u",
                                    .value         = SecondOrderValue,
                                    .amplitude     = SecondOrderAmplitude,
                                    .velocity_unit = SecondOrderVelocityUnit};
