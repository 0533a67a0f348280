/*
   Exact solutions, with X = x - U0 t.

   First order, u_t = c r_x and r_t = c u_x:

     mode     u = A sin(KX + phase) cos(Kct),    r = A cos(KX + phase) sin(Kct)
     pulse    u = A f(X - ct),                   r = -A f(X - ct)
     step     u = 0,                             r = -A                          at time 0

   Field 2 is h u_x.

   Second order, u_t = v and v_t = c^2 u_xx, written with w = v h / c:

     mode     u = (A/omega) sin(omega t) sin(KX + phase),    v = A cos(omega t) sin(KX + phase),    omega = K c
     pulse    u = A f(X - ct),                               v = -c A f'(X - ct)
     step     u = -(A/c) X,                                  v = 0               at time 0

   By d'Alembert u - r travels to the right, and u + r to the left. f is a Gaussian of standard deviation L/20 around
   L/4. It is repeated with period L, or between ends with its mirror images. Those beyond a fixed end have velocities
   of the other sign.

   step is a load A rho0 c on the free end of a bar at rest, from time 0 on. The equations are linear. So stress and
   displacement are counted from the equilibrium of the loaded bar, r = A and u = (A/c) X, and the load itself drops
   out.
*/
#include <mpmstab/wave.h>
#include <math.h>

const char *const MpmInitialNames[] = {"mode", "random", "pulse", "eigenmode", "step", NULL};

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

static PetscReal FirstOrderPulse(const MpmProfile *p, PetscInt field, PetscReal X, PetscReal ct)
{
  if (field == 2) return p->cell_width * (Travelling(p, X, ct, PETSC_TRUE) - Returning(p, X, ct, PETSC_TRUE));
  return (field ? -1 : 1) * Travelling(p, X, ct, PETSC_FALSE) + Returning(p, X, ct, PETSC_FALSE);
}

static PetscReal FirstOrderValue(const MpmProfile *p, PetscInt field, PetscReal X, PetscReal t)
{
  const PetscReal K = p->wavenumber, ct = p->wave_speed * t, angle = K * X + p->phase;

  if (p->initial == MPM_INITIAL_PULSE) return FirstOrderPulse(p, field, X, ct);
  if (p->initial == MPM_INITIAL_STEP) {
    if (field == 2) return 0;
    return field ? (StepStress(p, X + ct) + StepStress(p, X - ct)) / 2 : StepVelocity(p, X, ct);
  }
  if (field == 2) return p->amplitude * K * p->cell_width * cos(angle) * cos(K * ct);
  return p->amplitude * (field ? cos(angle) * sin(K * ct) : sin(angle) * cos(K * ct));
}

static PetscReal FirstOrderAmplitude(const MpmProfile *p, PetscInt field)
{
  if (field < 2 || p->initial == MPM_INITIAL_STEP) return p->amplitude;
  return p->amplitude * p->cell_width *
         (p->initial == MPM_INITIAL_PULSE ? 1 / (PulseWidth(p) * sqrt(M_E)) : p->wavenumber);
}

static PetscReal FirstOrderVelocityUnit(const MpmProfile *p)
{
  (void)p;
  return 1;
}

static PetscReal SecondOrderPulse(const MpmProfile *p, PetscInt field, PetscReal X, PetscReal ct)
{
  if (field) return -p->cell_width * (Travelling(p, X, ct, PETSC_TRUE) + Returning(p, X, ct, PETSC_TRUE));
  return Travelling(p, X, ct, PETSC_FALSE) + Returning(p, X, ct, PETSC_FALSE);
}

static PetscReal SecondOrderValue(const MpmProfile *p, PetscInt field, PetscReal X, PetscReal t)
{
  const PetscReal K = p->wavenumber, ct = p->wave_speed * t, angle = K * X + p->phase;

  if (p->initial == MPM_INITIAL_PULSE) return SecondOrderPulse(p, field, X, ct);
  if (p->initial == MPM_INITIAL_STEP)
    return field ? p->cell_width / p->wave_speed * StepVelocity(p, X, ct)
                 : (StepDisplacement(p, X + ct) + StepDisplacement(p, X - ct)) / 2;
  if (field) return p->amplitude * p->cell_width / p->wave_speed * cos(K * ct) * sin(angle);
  return p->amplitude / (K * p->wave_speed) * sin(K * ct) * sin(angle);
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
                                    .value         = FirstOrderValue,
                                    .amplitude     = FirstOrderAmplitude,
                                    .velocity_unit = FirstOrderVelocityUnit};
const MpmWave MpmWaveMomentum    = {.equations     = "v_t = c s_x, s_t = c v_x",
                                    .value         = FirstOrderValue,
                                    .amplitude     = FirstOrderAmplitude,
                                    .velocity_unit = FirstOrderVelocityUnit};
const MpmWave MpmWaveSecondOrder = {.equations     = "u_t = (c/h) w, w_t = h c u_xx",
                                    .value         = SecondOrderValue,
                                    .amplitude     = SecondOrderAmplitude,
                                    .velocity_unit = SecondOrderVelocityUnit};
