/*
   Exact solutions at finite strain satisfy their equations: F = dx/dX, v = dx/dt and rho0 x_tt = div P + rho0 b of solids,
   conservation of mass and momentum of gases, and the conditions at a shock. Derivatives are differences of sixth order.
*/
#include "check.h"
#include "scene/solution.h"

#define STEP 0x1p-9
#define NEAR 1e-7

static const PetscReal differences[3] = {45. / 60, -9. / 60, 1. / 60};

/* The nominal stress P = tau F^-T in units of length^2 / time^2, by cofactors. */
static void Nominal(const MpmScene *scene, const PetscReal X[], PetscReal t, PetscReal P[])
{
  const PetscInt   dim = scene->layout.dim;
  const PetscReal *f[9];
  PetscReal        tau[6], *to[6], full[9], cofactor[9], J = 0;
  MpmSolutionState s;

  MpmSolutionOf(scene)->exact(scene, X, X, t, &s);
  for (PetscInt c = 0; c < dim * dim; c++) f[c] = &s.stretch[c];
  for (PetscInt c = 0; c < 6; c++) to[c] = &tau[c];
  MpmMaterialStress(&scene->scheme.space.material, dim, 1, f, to);
  for (PetscInt a = 0, c = 0; a < dim; a++)
    for (PetscInt b = a; b < dim; b++, c++) full[a * dim + b] = full[b * dim + a] = tau[c];
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++) {
      const PetscInt a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;

      cofactor[a * dim + b] = dim == 1   ? 1
                              : dim == 2 ? (a == b ? 1 : -1) * s.stretch[(1 - a) * 2 + 1 - b]
                                         : s.stretch[a1 * 3 + b1] * s.stretch[a2 * 3 + b2] -
                                               s.stretch[a1 * 3 + b2] * s.stretch[a2 * 3 + b1];
    }
  for (PetscInt b = 0; b < dim; b++) J += s.stretch[b] * cofactor[b];
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++) {
      P[a * dim + b] = 0;
      for (PetscInt c = 0; c < dim; c++)
        P[a * dim + b] += PetscSqr(scene->wave_speed) * full[a * dim + c] * cofactor[c * dim + b] / J;
    }
}

/* At one particle and one time. */
static void CheckSolid(const MpmScene *scene, const PetscReal X[], PetscReal t)
{
  const MpmSolution *solution = MpmSolutionOf(scene);
  const PetscInt     dim      = scene->layout.dim;
  PetscReal          v[3] = {0}, a[3] = {0}, F[9] = {0}, div[3] = {0}, b[3];
  MpmSolutionState   here, side[2];

  solution->exact(scene, X, X, t, &here);
  solution->force(scene, X, t, b);
  for (int k = 0; k < 3; k++) {
    const PetscReal d = (k + 1) * STEP, w = differences[k] / STEP;

    for (int e = 0; e < 2; e++) solution->exact(scene, X, X, t + (e ? -d : d), &side[e]);
    for (PetscInt i = 0; i < dim; i++) {
      v[i] += w * (side[0].place[i] - side[1].place[i]);
      a[i] += w * (side[0].velocity[i] - side[1].velocity[i]);
    }
    for (PetscInt j = 0; j < dim; j++) {
      PetscReal P[2][9];

      for (int e = 0; e < 2; e++) {
        PetscReal beside[3] = {X[0], X[1], X[2]};

        beside[j] += e ? -d : d;
        solution->exact(scene, beside, beside, t, &side[e]);
        Nominal(scene, beside, t, P[e]);
      }
      for (PetscInt i = 0; i < dim; i++) {
        F[i * dim + j] += w * (side[0].place[i] - side[1].place[i]);
        div[i] += w * (P[0][i * dim + j] - P[1][i * dim + j]);
      }
    }
  }
  for (PetscInt i = 0; i < dim; i++) {
    CHECK_NEAR(here.velocity[i], v[i], NEAR);
    CHECK_NEAR(a[i], div[i] + b[i], 100 * NEAR);
    for (PetscInt j = 0; j < dim; j++) CHECK_NEAR(here.stretch[i * dim + j], F[i * dim + j], NEAR);
  }
}

/* In the ring of the vortex, and beyond its edge. The third coordinate is for dim 3. */
static PetscErrorCode CheckSolids(const char options[])
{
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  for (PetscReal t = 0.05; t < 0.9; t += 0.23)
    for (PetscReal angle = 0.3; angle < 6; angle += 1.1)
      for (PetscReal r = 0.82; r < 1.4; r += 0.14) {
        const PetscReal X[3] = {scene->length[0] / 2 + r * cos(angle), scene->length[1] / 2 + r * sin(angle), 0.3};

        CheckSolid(scene, X, t);
      }
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Density and velocity at a place. */
static void Gas(const MpmScene *scene, PetscReal x, PetscReal t, PetscReal *rho, PetscReal *v)
{
  const PetscReal  X[1] = {0.25 * scene->length[0]}, here[1] = {x};
  MpmSolutionState start, now;

  MpmSolutionOf(scene)->exact(scene, X, here, t, &now);
  MpmSolutionOf(scene)->exact(scene, X, X, 0, &start); /* F = 1 there, so rho is known at one place */
  CHECK_NEAR(start.stretch[0], 1, 1e-15);
  *rho = 1 / now.stretch[0];
  *v   = now.velocity[0];
}

static PetscErrorCode CheckGas(const char options[], PetscReal t, PetscReal from, PetscReal to)
{
  MpmScene *scene;
  PetscReal rho, v, side[2][2], c;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  c = scene->wave_speed;
  for (PetscReal x = from; x < to; x += (to - from) / 17) {
    PetscReal rho_t = 0, v_t = 0, rho_x = 0, v_x = 0;

    Gas(scene, x, t, &rho, &v);
    for (int k = 0; k < 3; k++) {
      const PetscReal d = (k + 1) * STEP / 4, w = differences[k] / (STEP / 4);

      for (int e = 0; e < 2; e++) Gas(scene, x, t + (e ? -d : d), &side[e][0], &side[e][1]);
      rho_t += w * (side[0][0] - side[1][0]);
      v_t += w * (side[0][1] - side[1][1]);
      for (int e = 0; e < 2; e++) Gas(scene, x + (e ? -d : d), t, &side[e][0], &side[e][1]);
      rho_x += w * (side[0][0] - side[1][0]);
      v_x += w * (side[0][1] - side[1][1]);
    }
    CHECK_NEAR(rho_t, -v * rho_x - rho * v_x, NEAR);
    CHECK_NEAR(v_t, -v * v_x - c * c * rho_x / rho, NEAR);
  }
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What flows into a shock comes out of it; the numbers are those of theory. */
static void CheckShock(void)
{
  const MpmRiemann r = MpmRiemannSolve(0.125);

  CHECK_NEAR(r.density, 0.345780, 5e-7);
  CHECK_NEAR(r.velocity, 1.061952, 5e-7);
  CHECK_NEAR(r.shock, 1.663202, 5e-7);
  CHECK_NEAR(r.shock * (r.density - r.ratio), r.density * r.velocity, 1e-15);
  CHECK_NEAR(r.shock * r.density * r.velocity, r.density * (r.velocity * r.velocity + 1) - r.ratio, 1e-15);
}

#define SOLID "-formulation usl -kinematics finite -cells 8 "
#define GAS "-formulation usl -kinematics finite -cells 8 -material gas -steps 1 "

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckSolids(SOLID "-initial manufactured -material neo -amplitude 0.05 -length 2"));
  PetscCall(CheckSolids(SOLID "-initial manufactured -material svk -amplitude 0.05 -dim 3 -wave_speed 1.5 -length 3"));
  PetscCall(CheckSolids(SOLID "-initial manufactured -material uniform -amplitude 0.05 -dim 2 -length 2.5"));
  PetscCall(CheckSolids(SOLID "-initial vortex -material neo -amplitude 0.7 -dim 2 -wave_speed 1.3 -length 2.7"));
  PetscCall(CheckGas(GAS "-initial simple_wave -amplitude 0.2 -wave_speed 1.2", 0.5, 0, 1));
  PetscCall(CheckGas(GAS "-initial shock_tube -boundary fixed", 0.2, 0.31, 0.49)); /* in the rarefaction */
  CheckShock();
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
