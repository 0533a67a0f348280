/*
   Exact solutions on a periodic domain, X = x - U0 t:
     first order   u_t = c r_x, r_t = c u_x
       mode        u = A sin(KX) cos(Kct),  r = A cos(KX) sin(Kct)
       pulse       u = A f(X - ct),         r = -A f(X - ct)      (d'Alembert: u - r travels to the right)
     second order  u_t = v, v_t = c^2 u_xx, written with w = v h / c
       mode        u = (A/omega) sin(omega t) sin(KX), v = A cos(omega t) sin(KX), omega = K c
       pulse       u = A f(X - ct),         v = -c A f'(X - ct)
   f is a Gaussian of standard deviation L/20 around L/4, repeated with period L.
*/
#include <mpmstab/wave.h>
#include <math.h>

const char *const MpmInitialNames[] = {"mode", "random", "pulse", "eigenmode", NULL};

static PetscReal PulseWidth(const MpmProfile *p)
{
  return p->length / 20;
}

/* Distance from the pulse's centre, in (-L/2, L/2]. */
static PetscReal PulseDistance(const MpmProfile *p, PetscReal X)
{
  return remainder(X - p->length / 4, p->length);
}

static PetscReal Pulse(const MpmProfile *p, PetscReal X)
{
  const PetscReal z = PulseDistance(p, X) / PulseWidth(p);
  return exp(-z * z / 2);
}

static PetscReal PulseSlope(const MpmProfile *p, PetscReal X)
{
  return -PulseDistance(p, X) / PetscSqr(PulseWidth(p)) * Pulse(p, X);
}

static PetscReal FirstOrderValue(const MpmProfile *p, PetscInt field, PetscReal X, PetscReal t)
{
  const PetscReal K = p->wavenumber, ct = p->wave_speed * t;

  if (p->initial == MPM_INITIAL_PULSE) return (field ? -1 : 1) * p->amplitude * Pulse(p, X - ct);
  return p->amplitude * (field ? cos(K * X) * sin(K * ct) : sin(K * X) * cos(K * ct));
}

static PetscReal FirstOrderAmplitude(const MpmProfile *p, PetscInt field)
{
  (void)field;
  return p->amplitude;
}

static PetscReal FirstOrderVelocityUnit(const MpmProfile *p)
{
  (void)p;
  return 1;
}

static PetscReal SecondOrderValue(const MpmProfile *p, PetscInt field, PetscReal X, PetscReal t)
{
  const PetscReal K = p->wavenumber, ct = p->wave_speed * t;

  if (p->initial == MPM_INITIAL_PULSE)
    return p->amplitude * (field ? -p->cell_width * PulseSlope(p, X - ct) : Pulse(p, X - ct));
  if (field) return p->amplitude * p->cell_width / p->wave_speed * cos(K * ct) * sin(K * X);
  return p->amplitude / (K * p->wave_speed) * sin(K * ct) * sin(K * X);
}

static PetscReal SecondOrderAmplitude(const MpmProfile *p, PetscInt field)
{
  if (p->initial == MPM_INITIAL_PULSE) return p->amplitude * (field ? p->cell_width / (PulseWidth(p) * sqrt(M_E)) : 1);
  return p->amplitude * (field ? p->cell_width / p->wave_speed : 1 / (p->wavenumber * p->wave_speed));
}

/* v = w c / h, and c u_x = difference c / h. */
static PetscReal SecondOrderVelocityUnit(const MpmProfile *p)
{
  return p->wave_speed / p->cell_width;
}

const MpmWave MpmWaveFirstOrder  = {.equations     = "u_t = c r_x, r_t = c u_x",
                                    .value         = FirstOrderValue,
                                    .amplitude     = FirstOrderAmplitude,
                                    .velocity_unit = FirstOrderVelocityUnit};
const MpmWave MpmWaveSecondOrder = {.equations     = "u_t = (c/h) w, w_t = h c u_xx",
                                    .value         = SecondOrderValue,
                                    .amplitude     = SecondOrderAmplitude,
                                    .velocity_unit = SecondOrderVelocityUnit};
