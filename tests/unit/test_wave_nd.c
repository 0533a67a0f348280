/*
   The modes of two and three dimensions satisfy their equations and the conditions at the ends of the domain, by central
   differences. Between ends that no wave stands between there is none.
*/
#include "base/hash.h"
#include "check.h"

#define STEP 1e-4      /* of the differences, in lengths of the domain */
#define TOLERANCE 1e-5 /* relative to the amplitude of the field */
#define MOST 32

/* A place and a time, and all registers and their slopes there. */
typedef struct {
  const MpmScene *scene;
  MpmProfile      profile;
  PetscReal       X[MPM_MAX_DIM], t;
  PetscReal       value[MOST], dt[MOST], dx[MOST][MPM_MAX_DIM], laplace[MOST];
} Sample;

static PetscReal Exact(const Sample *s, PetscInt r, const PetscReal X[], PetscReal t)
{
  return MpmSceneExact(s->scene, &s->profile, r, X, t);
}

static void Differentiate(Sample *s)
{
  const PetscReal d = STEP;

  for (PetscInt r = 0; r < s->scene->scheme.table->nstate; r++) {
    s->value[r]   = Exact(s, r, s->X, s->t);
    s->dt[r]      = (Exact(s, r, s->X, s->t + d) - Exact(s, r, s->X, s->t - d)) / (2 * d);
    s->laplace[r] = 0;
    for (PetscInt a = 0; a < s->scene->layout.dim; a++) {
      PetscReal X[2][MPM_MAX_DIM], at[2];

      for (int side = 0; side < 2; side++) {
        PetscCallVoid(PetscArraycpy(X[side], s->X, MPM_MAX_DIM));
        X[side][a] += side ? d : -d;
        at[side] = Exact(s, r, X[side], s->t);
      }
      s->dx[r][a] = (at[1] - at[0]) / (2 * d);
      s->laplace[r] += (at[1] - 2 * s->value[r] + at[0]) / (d * d);
    }
  }
}

/* The register of stress ab. A fluid has one for all a = b, and none else. */
static PetscInt Stress(const MpmScene *s, PetscInt a, PetscInt b)
{
  static const PetscInt plane[2][2] = {{0, 1}, {1, 2}}, space[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  const PetscInt        dim = s->layout.dim;

  if (MpmSpaceIsFluid(&s->scheme.space)) return a == b ? dim : MPM_NONE;
  return dim + (dim == 2 ? plane[a][b] : space[a][b]);
}

/* v_t = c div s, s_t = c (lambda div v I + mu (grad v + grad v^T)), and the affine part is h grad v */
static void CheckMomentum(const Sample *s)
{
  const MpmScene *scene = s->scene;
  const PetscInt  dim = scene->layout.dim, affine = scene->scheme.table->affine_part;
  const PetscReal c = scene->wave_speed, nu = scene->scheme.space.poisson, size = 30 * scene->amplitude;
  const PetscReal lambda = nu / (1 - nu), mu = (1 - 2 * nu) / (2 * (1 - nu));

  for (PetscInt a = 0; a < dim; a++) {
    PetscReal force = 0, div = 0;

    for (PetscInt b = 0; b < dim; b++) {
      const PetscInt ab = Stress(scene, a, b);

      if (ab >= 0) force += s->dx[ab][b];
      div += s->dx[b][b];
    }
    CHECK_NEAR(s->dt[a], c * force, TOLERANCE * size);
    for (PetscInt b = 0; b < dim; b++) {
      const PetscInt ab = Stress(scene, a, b);

      if (ab >= 0)
        CHECK_NEAR(s->dt[ab], c * ((a == b ? lambda * div : 0) + mu * (s->dx[a][b] + s->dx[b][a])), TOLERANCE * size);
      if (scene->scheme.table->affine != MPM_NONE)
        CHECK_NEAR(s->value[affine + dim * a + b], scene->cell_width * s->dx[a][b], TOLERANCE * size);
    }
  }
}

/* u_t = c grad r, r_t = c div u */
static void CheckGas(const Sample *s)
{
  const PetscInt  dim = s->scene->layout.dim;
  const PetscReal c = s->scene->wave_speed, size = 30 * s->scene->amplitude;
  PetscReal       div = 0;

  for (PetscInt a = 0; a < dim; a++) {
    CHECK_NEAR(s->dt[a], c * s->dx[dim][a], TOLERANCE * size);
    div += s->dx[a][a];
  }
  CHECK_NEAR(s->dt[dim], c * div, TOLERANCE * size);
}

/* u_t = (c / h) w, w_t = h c div grad u */
static void CheckScalar(const Sample *s)
{
  const PetscReal c = s->scene->wave_speed, h = s->scene->cell_width, size = 30 * s->scene->amplitude;

  CHECK_NEAR(s->dt[0], c / h * s->value[1], TOLERANCE * size);
  CHECK_NEAR(s->dt[1], h * c * s->laplace[0], TOLERANCE * size);
}

/*
   At an end a scalar is 0, or its normal slope is. A velocity is 0, or its normal component and the tangential stress
   are, or the stress on the end is.
*/
static void CheckEnd(const Sample *s, PetscInt axis, MpmEnd end)
{
  const MpmScene *scene = s->scene;
  const PetscInt  dim   = scene->layout.dim;
  const PetscReal size  = 30 * scene->amplitude;

  if (scene->scheme.formulation->particle_ranks[0] == MPM_SCALAR) {
    CHECK_NEAR(end == MPM_FIXED ? s->value[0] : s->dx[0][axis], 0, TOLERANCE * size);
    return;
  }
  for (PetscInt a = 0; a < dim; a++) {
    const PetscBool stress = scene->scheme.formulation->particle_ranks[1] == MPM_TENSOR ? PETSC_TRUE : PETSC_FALSE;
    const PetscInt  pull   = stress ? Stress(scene, a, axis) : a == axis ? dim : MPM_NONE;

    if (end == MPM_FIXED || (end == MPM_SYMMETRY && a == axis)) CHECK_NEAR(s->value[a], 0, TOLERANCE * size);
    if ((end == MPM_FREE || (end == MPM_SYMMETRY && a != axis)) && pull != MPM_NONE)
      CHECK_NEAR(s->value[pull], 0, TOLERANCE * size);
  }
}

/* Takes the sample at a place given by one number in each direction from 0 to 1. */
static void CheckAt(Sample *s, const PetscReal place[])
{
  const MpmScene *scene = s->scene;

  for (PetscInt a = 0; a < scene->layout.dim; a++) s->X[a] = place[a] * scene->length[a];
  Differentiate(s);
  if (scene->scheme.formulation->particle_ranks[0] == MPM_SCALAR)
    CheckScalar(s);
  else if (scene->scheme.formulation->particle_ranks[1] == MPM_TENSOR)
    CheckMomentum(s);
  else
    CheckGas(s);
  for (PetscInt a = 0; a < scene->layout.dim; a++) {
    PetscReal       X[MPM_MAX_DIM];
    const PetscReal inside = s->X[a];

    PetscCallVoid(PetscArraycpy(X, s->X, MPM_MAX_DIM));
    X[a] += scene->length[a];
    if (scene->layout.grid[a].ends[0] == MPM_PERIODIC)
      for (PetscInt r = 0; r < scene->scheme.table->nstate; r++)
        CHECK_NEAR(Exact(s, r, X, s->t), Exact(s, r, s->X, s->t), 1e-11 * 30 * scene->amplitude);
    else
      for (int e = 0; e < 2; e++) {
        s->X[a] = e * scene->length[a];
        Differentiate(s);
        CheckEnd(s, a, scene->layout.grid[a].ends[e]);
      }
    s->X[a] = inside;
  }
}

/* size: the largest first component that the mode must reach, relative to the amplitude; all fields stay below theirs. */
static PetscErrorCode CheckMode(const char options[], PetscReal size)
{
  const int failures      = check_failures;
  PetscReal largest[MOST] = {0};
  MpmScene *scene;
  Sample    s;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  CHECK(MpmSceneHasExact(scene), "no exact solution");
  s = (Sample){.scene = scene, .profile = MpmSceneProfile(scene, scene->amplitude)};
  for (PetscInt i = 0; i < 8000 && MpmSceneHasExact(scene); i++) {
    const PetscReal place[] = {MpmHash(1, i), MpmHash(2, i), MpmHash(3, i)};

    s.t = 2 * MpmHash(4, i);
    if (i < 40) CheckAt(&s, place);
    for (PetscInt a = 0; a < scene->layout.dim; a++) s.X[a] = place[a] * scene->length[a];
    for (PetscInt r = 0; r < scene->scheme.table->nstate; r++)
      largest[r] = PetscMax(largest[r], fabs(Exact(&s, r, s.X, s.t)));
  }
  for (PetscInt r = 0; r < scene->scheme.table->nstate; r++) {
    const PetscReal unit = scene->scheme.formulation->wave->amplitude(&s.profile, scene->scheme.table->field[r]);

    CHECK(largest[r] <= unit * (1 + 1e-12), "%s: %g, amplitude %g", scene->scheme.table->fields[r], largest[r], unit);
    if (r == 0) CHECK_NEAR(largest[0] / unit, size, 0.05);
  }
  if (check_failures > failures) fprintf(stderr, "  in %s\n", options);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Without being asked for, initial data for which there is no wave are random. */
static PetscErrorCode CheckNone(const char options[])
{
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  CHECK(!MpmSceneHasExact(scene) && scene->initial == MPM_INITIAL_RANDOM, "%s: a wave", options);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define UNITS " -cells 12,8 -length 3,2 -wave_speed 1.5 -amplitude 0.7 "
#define UNITS_3D " -dim 3 -cells 12,8,4 -length 3,2,1 -wave_speed 1.5 -amplitude 0.7 "

/* A unit vector along (K_x, K_y): the wave numbers of mode i, j are i / 3 and j / 2. */
static PetscReal Cosine(PetscReal i, PetscReal j)
{
  return i / 3 / hypot(i / 3, j / 2);
}

static PetscErrorCode CheckPeriodic(void)
{
  static const char *const schemes[] = {"usl -transfer apic -poisson 0", "musl -poisson 0.3", "usf -poisson 0.5",
                                        "gas2", "elastic"};
  static const PetscInt    mode[][2] = {{1, 0}, {0, 1}, {2, 1}, {-1, 3}};
  char                     options[256];

  PetscFunctionBegin;
  for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(schemes); f++)
    for (size_t m = 0; m < PETSC_STATIC_ARRAY_LENGTH(mode); m++) {
      const PetscInt i = mode[m][0], j = mode[m][1];

      PetscCall(PetscSNPrintf(options, sizeof options,
                              "-dim 2 -formulation %s -mode %" PetscInt_FMT ",%" PetscInt_FMT UNITS, schemes[f], i, j));
      PetscCall(CheckMode(options, !strcmp(schemes[f], "elastic") ? 1 : fabs(Cosine(i, j))));
      if (f > 1) continue;
      PetscCall(PetscStrlcat(options, "-polarisation s", sizeof options));
      PetscCall(CheckMode(options, fabs(Cosine(j * 3.0 / 2, -i * 2.0 / 3))));
    }
  PetscCall(CheckMode("-formulation usl -transfer apic -mode 1,-2,1" UNITS_3D, 1 / 3.0 / sqrt(1 / 9.0 + 1 + 1)));
  PetscCall(CheckMode("-formulation usl -polarisation s -mode 1,2,-1" UNITS_3D, 3 / sqrt(10)));
  PetscCall(CheckMode("-formulation usl -polarisation s -mode 0,0,1" UNITS_3D, 1));
  PetscCall(CheckMode("-formulation gas1 -mode 1,1,1" UNITS_3D, 1 / 3.0 / sqrt(1 / 9.0 + 1 / 4.0 + 1)));
  PetscCall(CheckMode("-formulation elastic -mode 1,1,1" UNITS_3D, 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckBoxes(void)
{
  PetscFunctionBegin;
  /* along one direction, between any ends of it */
  PetscCall(CheckMode("-dim 2 -formulation usl -boundary fixed-free,periodic -mode 2,0" UNITS, 1));
  PetscCall(CheckMode("-dim 2 -formulation usl -boundary free,symmetry -mode 1" UNITS, 1));
  PetscCall(CheckMode("-dim 2 -formulation usl -boundary free-fixed,periodic -mode 3 -polarisation s" UNITS, 0));
  PetscCall(CheckMode("-dim 2 -formulation usl -boundary periodic,symmetry-fixed -mode 0,2 -polarisation s" UNITS, 1));
  PetscCall(CheckMode("-dim 2 -formulation usl -boundary periodic,symmetry -mode 0,2 -polarisation s" UNITS, 1));
  PetscCall(CheckMode("-dim 2 -formulation gas2 -boundary fixed,symmetry -mode 1,0" UNITS, 1));
  /* oblique, in boxes of symmetry */
  PetscCall(CheckMode("-dim 2 -formulation usl -transfer apic -boundary symmetry -mode 2,1" UNITS, Cosine(2, 1)));
  PetscCall(CheckMode("-dim 2 -formulation usl -boundary symmetry -mode 3,1 -polarisation s" UNITS, Cosine(1.5, 2.0)));
  PetscCall(CheckMode("-dim 2 -formulation usl -boundary periodic,symmetry -mode -1,2" UNITS, Cosine(2, 2)));
  PetscCall(CheckMode("-dim 2 -formulation usl -boundary symmetry,periodic -mode 2,1 -polarisation s" UNITS,
                      Cosine(3, 4.0 / 3)));
  PetscCall(CheckMode("-dim 2 -formulation gas1 -boundary symmetry -mode 0,1" UNITS, 0));
  PetscCall(CheckMode("-dim 2 -formulation gas1 -boundary symmetry -mode 1,1" UNITS, Cosine(1, 1)));
  PetscCall(
      CheckMode("-formulation usl -boundary symmetry -mode 1,1,1" UNITS_3D, 1 / 3.0 / sqrt(1 / 9.0 + 1 / 4.0 + 1)));
  PetscCall(CheckMode("-formulation usl -boundary symmetry -mode 3,2,1 -polarisation s" UNITS_3D, M_SQRT1_2));
  PetscCall(CheckMode("-formulation usl -boundary symmetry,periodic,symmetry -mode 1,0,1 -polarisation s" UNITS_3D, 0));
  PetscCall(CheckMode("-formulation usl -boundary periodic,fixed,symmetry -mode 0,1,0 -polarisation s" UNITS_3D, 1));
  /* a scalar stands between any ends */
  PetscCall(CheckMode("-dim 2 -formulation elastic -boundary fixed -mode 1,2" UNITS, 1));
  PetscCall(CheckMode("-dim 2 -formulation elastic -boundary free-fixed,symmetry -mode 2,0" UNITS, 1));
  PetscCall(CheckMode("-dim 2 -formulation elastic -boundary periodic,fixed-free -mode -2,1" UNITS, 1));
  PetscCall(CheckMode("-formulation elastic -boundary fixed -mode 1,2,1" UNITS_3D, 1));
  PetscCall(CheckMode("-formulation elastic -boundary fixed,free-fixed,periodic -mode 1,2,1" UNITS_3D, 1));
  /* no wave stands here */
  PetscCall(CheckNone("-dim 2 -formulation usl -boundary fixed"));
  PetscCall(CheckNone("-dim 2 -formulation usl -boundary symmetry,free"));
  PetscCall(CheckNone("-dim 2 -formulation gas2 -boundary symmetry,fixed"));
  PetscCall(CheckNone("-dim 2 -formulation elastic -boundary fixed"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckPeriodic());
  PetscCall(CheckBoxes());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
