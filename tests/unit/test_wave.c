/* The exact solutions satisfy their equations, by central differences, and have the amplitude they claim. */
#include "check.h"

static PetscReal Value(const MpmWave *wave, const MpmProfile *p, PetscInt field, PetscReal X, PetscReal t)
{
  return wave->value(p, field, 0, &X, t);
}

/*
   Checks the conditions at the ends: velocity and displacement vanish at a fixed end, strain and stress at a free end.
*/
static void CheckEnds(const MpmWave *wave, const MpmProfile *p, PetscBool second_order, int left, int right,
                      PetscReal t)
{
  const int       kind[2] = {left, right};
  const PetscReal d = 1e-4, at[2] = {0, p->length};

  for (int end = 0; end < 2; end++) {
    const PetscReal stretch =
        (Value(wave, p, 0, at[end] + d, t) - Value(wave, p, 0, at[end] - d, t)) / (2 * d) * p->cell_width;

    /* the tail of the pulse reaches the ends */
    if (kind[end] == -1) CHECK_NEAR(Value(wave, p, 0, at[end], t), 0, 1e-5);
    if (kind[end] == -1 && second_order) CHECK_NEAR(Value(wave, p, 1, at[end], t), 0, 1e-5);
    if (kind[end] == 1) CHECK_NEAR(second_order ? stretch : Value(wave, p, 1, at[end], t), 0, 1e-5);
  }
}

/*
   Checks a bar that is released from stress -A at time 0: the four stages of its period, at places and times found by
   hand.
*/
static void CheckStep(void)
{
  const MpmProfile p = {
      .initial = MPM_INITIAL_STEP, .length = 2, .wave_speed = 4, .cell_width = 0.1, .amplitude = 3, .image = {-1, 1}};
  const struct {
    PetscReal X, t, v, s, u;
  } cases[] = {{1, 0, 0, -3, -0.75},     {0.5, 0.25, 0, -3, -0.375}, {1.5, 0.25, 3, 0, -0.75},
               {0.5, 0.75, 0, 3, 0.375}, {1.5, 0.75, 3, 0, 0.75},    {1.5, 1.25, -3, 0, 0.75},
               {0.5, 1.25, 0, 3, 0.375}, {0.5, 1.75, 0, -3, -0.375}, {1.5, 1.75, -3, 0, -0.75},
               {2, 1, 0, 3, 1.5},        {0.3, 2, 0, -3, -0.225}};

  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
    const PetscReal X = cases[i].X, t = cases[i].t;

    if (X < 2) {
      CHECK_NEAR(Value(&MpmWaveMomentum, &p, 0, X, t), cases[i].v, 1e-12);
      CHECK_NEAR(Value(&MpmWaveMomentum, &p, 1, X, t), cases[i].s, 1e-12);
      CHECK_NEAR(Value(&MpmWaveSecondOrder, &p, 1, X, t), cases[i].v * 0.1 / 4, 1e-12);
    }
    CHECK_NEAR(Value(&MpmWaveSecondOrder, &p, 0, X, t), cases[i].u, 1e-12);
  }
  CHECK_NEAR(MpmWaveSecondOrder.amplitude(&p, 0), 1.5, 1e-15);
}

/* left and right: 0 for periodic, -1 for a fixed end, 1 for a free end. */
static void CheckEquations(const MpmWave *wave, MpmInitial initial, PetscBool second_order, int left, int right)
{
  const PetscReal  waves = !left ? 3 : left == right ? 1.5 : 1.25;
  const MpmProfile p     = {.initial    = initial,
                            .dim        = 1,
                            .nwaves     = 1,
                            .wave       = {{.normal = {1}, .direction = {1}, .weight = 1}},
                            .poisson    = 0.5,
                            .speed      = 1.5,
                            .length     = 2,
                            .wave_speed = 1.5,
                            .cell_width = 0.1,
                            .amplitude  = 0.7,
                            .wavenumber = 2 * PETSC_PI * waves / 2,
                            .phase      = left == 1 ? PETSC_PI / 2 : 0,
                            .image      = {left, right}};
  const PetscReal  d = 1e-4, c = p.wave_speed, h = p.cell_width;
  PetscReal        largest[2] = {0, 0};

  for (PetscInt i = 0; i < 200; i++) {
    const PetscReal X = 0.01 * i, t = 0.37 + 0.003 * i;
    PetscReal       dt[2], dx[2], dxx;

    for (PetscInt f = 0; f < 2; f++) {
      dt[f] = (Value(wave, &p, f, X, t + d) - Value(wave, &p, f, X, t - d)) / (2 * d);
      dx[f] = (Value(wave, &p, f, X + d, t) - Value(wave, &p, f, X - d, t)) / (2 * d);
      if (!left) CHECK_NEAR(Value(wave, &p, f, X + p.length, t), Value(wave, &p, f, X, t), 1e-12);
      for (PetscInt j = 0; j < 500; j++)
        largest[f] = PetscMax(largest[f], fabs(Value(wave, &p, f, 0.004 * j, 0.004 * i)));
    }
    dxx = (Value(wave, &p, 0, X + d, t) - 2 * Value(wave, &p, 0, X, t) + Value(wave, &p, 0, X - d, t)) / (d * d);
    if (second_order) {
      CHECK_NEAR(dt[0], c / h * Value(wave, &p, 1, X, t), 1e-4);
      CHECK_NEAR(dt[1], h * c * dxx, 1e-4);
    } else {
      CHECK_NEAR(dt[0], c * dx[1], 1e-4);
      CHECK_NEAR(dt[1], c * dx[0], 1e-4);
      CHECK_NEAR(Value(wave, &p, MPM_NONE, X, t), h * dx[0], 1e-4);
    }
    CheckEnds(wave, &p, second_order, left, right, t);
  }
  for (PetscInt f = 0; f < 2; f++) CHECK_NEAR(largest[f], wave->amplitude(&p, f), 2e-3 * largest[f]);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (int left = -1; left <= 1; left++)
    for (int right = -1; right <= 1; right++) {
      if (!left != !right) continue;
      CheckEquations(&MpmWaveFirstOrder, MPM_INITIAL_MODE, PETSC_FALSE, left, right);
      CheckEquations(&MpmWaveMomentum, MPM_INITIAL_PULSE, PETSC_FALSE, left, right);
      CheckEquations(&MpmWaveSecondOrder, MPM_INITIAL_MODE, PETSC_TRUE, left, right);
      CheckEquations(&MpmWaveSecondOrder, MPM_INITIAL_PULSE, PETSC_TRUE, left, right);
    }
  CheckStep();
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
