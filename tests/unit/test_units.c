/* Units: wave speed and Poisson's ratio from moduli, cell width, time step and drift from them, and what is refused. */
#include "check.h"

/* What must come out of options: c, nu, h, the length of the first direction, k and the drift of the first direction. */
typedef struct {
  const char *options;
  PetscReal   wave_speed, poisson, cell_width, length, courant, drift;
} Case;

#define PLANE "-dim 2 -formulation usl -cells 8,4 "
#define BAR "-formulation usl -cells 8 "

/* 7.2 / (1 + nu) (1 - nu) / (1 - 2 nu) = 8 for nu = 1 / 5; K = 4, G = 3 is the same material. */
static const Case cases[] = {
    {BAR "-young 400 -density 4", 10, 0.3, 0.125, 1, 0.5, 0},
    {BAR "-bulk 4 -shear 3 -density 2", 2, 0, 0.125, 1, 0.5, 0},
    {BAR "-sound_speed 3", 3, 0.3, 0.125, 1, 0.5, 0},
    {BAR "-sound_speed 3 -density 7", 3, 0.3, 0.125, 1, 0.5, 0},
    {BAR "-wave_speed 3 -density 7", 3, 0.3, 0.125, 1, 0.5, 0},
    {BAR "-cell_width 0.25", 1, 0.3, 0.25, 2, 0.5, 0},
    {BAR "-dt 0.0625", 1, 0.3, 0.125, 1, 0.5, 0},
    {BAR "-young 400 -density 1 -cell_width 0.0078125 -dt 0.0002", 20, 0.3, 0.0078125, 0.0625, 0.512, 0},
    {BAR "-young 400 -density 1 -length 0.0625 -dt 0.0002 -velocity 4.8828125", 20, 0.3, 0.0078125, 0.0625, 0.512,
     0.125},
    {BAR "-young 400 -density 1 -courant 0.25 -velocity 10", 20, 0.3, 0.125, 1, 0.25, 0.125},
    {BAR "-sound_speed 20 -courant 0.25 -velocity 10", 20, 0.3, 0.125, 1, 0.25, 0.125},
    {BAR "-cell_width 0.1 -dt 0.01 -velocity 1.25", 1, 0.3, 0.1, 0.8, 0.1, 0.125},
    {"-cells 8 -bulk 400 -shear 0 -density 1", 20, 0.5, 0.125, 1, 0.5, 0},
    {"-cells 8 -dim 2 -bulk 400 -shear 0 -density 1", 20, 0, 0.125, 1, 0.5, 0},
    {PLANE "-young 7.2 -poisson 0.2 -density 2", 2, 0.2, 0.125, 1, 0.5, 0},
    {PLANE "-bulk 4 -shear 3 -density 2", 2, 0.2, 0.125, 1, 0.5, 0},
    {PLANE "-bulk 400 -shear 0 -density 1", 20, 0.5, 0.125, 1, 0.5, 0},
    {PLANE "-bulk 4 -shear 6 -density 3", 2, 0, 0.125, 1, 0.5, 0},
    {PLANE "-young 7.2 -poisson 0 -density 1.8 -cell_width 0.25", 2, 0, 0.25, 2, 0.5, 0},
    {"-dim 3 -formulation usl -cells 4 -bulk 4 -shear 3 -density 2", 2, 0.2, 0.25, 1, 0.5, 0},
};

static PetscErrorCode CheckCase(const Case *c)
{
  MpmScene *s;

  PetscFunctionBegin;
  PetscCall(CheckScene(c->options, &s));
  CHECK_NEAR(s->wave_speed, c->wave_speed, 4e-16 * c->wave_speed);
  if (MpmSceneHasPoisson(s)) CHECK_NEAR(s->scheme.space.poisson, c->poisson, 2e-16);
  CHECK_NEAR(s->cell_width, c->cell_width, 0);
  CHECK_NEAR(s->length[0], c->length, 0);
  CHECK_NEAR(s->step.courant, c->courant, 2e-16);
  CHECK_NEAR(s->dt, c->courant * c->cell_width / c->wave_speed, 4e-16 * s->dt);
  CHECK_NEAR(s->step.drift[0].value, c->drift, 0);
  CHECK(c->drift == 0 || s->step.drift[0].den == 8, "%s: the drift is no fraction", c->options);
  CHECK(MpmSceneIsPhysical(s), "%s", c->options);
  CHECK(s->has_step == (strstr(c->options, "-dt") || strstr(c->options, "-courant")), "%s", c->options);
  PetscCall(MpmSceneDestroy(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Options and what their refusal says. */
static const char *const refused[][2] = {
    {"-young 4", "-young 4: the wave speed needs density besides; allowed: young with density, bulk with"},
    {PLANE "-young 4", "-young 4: the wave speed needs poisson and density besides; allowed: young with poisson and"},
    {PLANE "-young 4 -density 1", "-young 4: the wave speed needs poisson besides"},
    {"-bulk 4", "-bulk 4: the wave speed needs shear and density besides"},
    {"-shear 4 -density 1", "-shear 4: the wave speed needs bulk besides"},
    {PLANE "-bulk 4 -shear 0", "-bulk 4: the wave speed needs density besides"},
    {"-density 4", "-density 4: there is no stiffness beside it; allowed: with young (and poisson with dim 2 or 3)"},
    {"-density 0 -young 1", "-density 0: allowed: a finite number greater than 0"},
    {"-young 0 -density 1", "-young 0: allowed: a finite number greater than 0"},
    {"-bulk 0 -shear 1 -density 1", "-bulk 0: allowed: a finite number greater than 0"},
    {"-bulk 1 -shear -1 -density 1", "-shear -1: allowed: a finite number from 0"},
    {"-sound_speed 0", "-sound_speed 0: allowed: a finite number greater than 0"},
    {"-cell_width 0", "-cell_width 0: allowed: a finite number greater than 0"},
    {PLANE "-young 1 -poisson 0.5 -density 1",
     "-poisson 0.5: with young, the wave speed would be infinite; allowed: less"},
    {PLANE "-bulk 1 -shear 1.6 -density 1", "-shear 1.6: Poisson's ratio would be below 0; allowed: at most 1.5 times"},
    {"-dim 2 -young 1 -density 1",
     "-young 1: gas2 has no stress with dim 2; allowed: bulk with shear 0, or sound_speed"},
    {"-dim 2 -bulk 1 -shear 1 -density 1", "-shear 1: gas2 has no stress with dim 2; allowed: bulk with shear 0"},
    {"-bulk 1e308 -shear 1e308 -density 1", "-bulk 1e308: the wave speed is out of range with it"},
    {"-cell_width 1e307", "-cell_width 1e307: the domain's length is out of range"},
    {"-young 1e-200 -density 1 -cell_width 1e300", "-cell_width 1e300: dt = k h / c is out of range"},
    {"-length 1 -cell_width 1", "length and cell_width are both given on the command line"},
    {"-wave_speed 1 -sound_speed 1", "wave_speed and sound_speed are both given on the command line"},
    {"-wave_speed 1 -young 1", "wave_speed and young are both given on the command line"},
    {"-sound_speed 1 -bulk 1", "sound_speed and bulk are both given on the command line"},
    {"-sound_speed 1 -shear 1", "sound_speed and shear are both given on the command line"},
    {"-young 1 -bulk 1 -shear 1", "young and bulk are both given on the command line"},
    {PLANE "-poisson 0.3 -shear 1", "poisson and shear are both given on the command line"},
};

/* Keeps the first message of an error. */
static PetscErrorCode Keep(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode error,
                           PetscErrorType type, const char *message, void *kept)
{
  (void)comm;
  (void)line;
  (void)function;
  (void)file;
  if (type == PETSC_ERROR_INITIAL) (void)snprintf((char *)kept, 512, "%s", message);
  return error;
}

static PetscErrorCode CheckRefused(const char options[], const char says[])
{
  char           message[512] = "";
  MpmScene      *scene;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscOptionsInsertString(NULL, options));
  PetscCall(PetscPushErrorHandler(Keep, message));
  error = MpmSceneCreate("run", NULL, &scene, &check_request);
  PetscCall(PetscPopErrorHandler());
  CHECK(error == PETSC_ERR_USER_INPUT && strstr(message, says) == message, "%s: %s", options, message);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Scenes in units of length, c and cells are not in physical ones. */
static PetscErrorCode CheckNotPhysical(void)
{
  static const char *const options[] = {"-cells 8", "-courant 0.4 -drift 1/8", "-length 3 -wave_speed 2",
                                        "-velocity 1"};
  MpmScene                *scene;

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(options); i++) {
    PetscCall(CheckScene(options[i], &scene));
    CHECK(!MpmSceneIsPhysical(scene), "%s", options[i]);
    PetscCall(MpmSceneDestroy(&scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A step in seconds is to the last bit the one that is given as Courant number and drift. */
static PetscErrorCode CheckSameStep(void)
{
  MpmScene *a, *b;

  PetscFunctionBegin;
  PetscCall(CheckScene(PLANE "-courant 0.512 -drift 1/8,-1/16 -poisson 0.2", &a));
  PetscCall(CheckScene(PLANE "-young 360 -poisson 0.2 -density 1 -cell_width 0.0078125 -dt 0.0002 "
                             "-velocity 4.8828125,-2.44140625",
                       &b));
  CHECK(!memcmp(&a->step, &b->step, sizeof a->step), "%.17g and %.17g", a->step.courant, b->step.courant);
  CHECK(!memcmp(&a->layout, &b->layout, sizeof a->layout), "layouts differ");
  CHECK(a->scheme.space.poisson == b->scheme.space.poisson, "Poisson's ratios differ");
  PetscCall(MpmSceneDestroy(&a));
  PetscCall(MpmSceneDestroy(&b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) PetscCall(CheckCase(&cases[i]));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(refused); i++) PetscCall(CheckRefused(refused[i][0], refused[i][1]));
  PetscCall(CheckNotPhysical());
  PetscCall(CheckSameStep());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
