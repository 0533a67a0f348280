/* The list of the exact solutions at finite strain, and what they have in common. */
#include "scene/solution.h"
#include <string.h>

static const MpmSolution *const solutions[] = {&MpmManufacturedBar, &MpmVortex, &MpmSimpleWave, &MpmShockTube};

static const MpmSolution *Find(MpmInitial initial)
{
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(solutions); s++)
    if (solutions[s]->initial == initial) return solutions[s];
  return NULL;
}

const MpmSolution *MpmSolutionOf(const MpmScene *scene)
{
  return scene->scheme.space.finite ? Find(scene->initial) : NULL;
}

/* The velocity's gradient da v_b in cells, in units of c. */
static PetscReal Gradient(const MpmScene *scene, const PetscReal X[], PetscInt a, PetscInt b, PetscReal t)
{
  const MpmSolution *solution = MpmSolutionOf(scene);
  PetscReal          velocity[2];

  for (int side = 0; side < 2; side++) {
    PetscReal        beside[MPM_MAX_DIM];
    MpmSolutionState state;

    memcpy(beside, X, sizeof(PetscReal) * (size_t)scene->layout.dim);
    beside[b] += (side ? -0.5 : 0.5) * scene->cell_width;
    solution->exact(scene, beside, beside, t, &state);
    velocity[side] = state.velocity[a];
  }
  return (velocity[0] - velocity[1]) / scene->wave_speed;
}

PetscReal MpmSolutionRegister(const MpmScene *scene, PetscInt r, const PetscReal X[], const PetscReal x[], PetscReal t)
{
  const MpmTable       *table      = scene->scheme.table;
  const MpmFormulation *f          = scene->scheme.formulation;
  const PetscBool       is_stretch = table->field[r] == MPM_STRETCHED ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt        component = table->component[r], dim = scene->layout.dim;
  MpmSolutionState      state;

  if (scene->stagger && is_stretch == (f->particle_ranks[f->staggered] == MPM_TENSOR)) t -= scene->dt / 2;
  if (table->field[r] == MPM_NONE)
    return Gradient(scene, X, (r - table->affine_part) / dim, (r - table->affine_part) % dim, t);
  MpmSolutionOf(scene)->exact(scene, X, x, t, &state);
  return is_stretch ? state.stretch[component] : state.velocity[component] / scene->wave_speed;
}

/* ---- which scenes have them ---- */

static PetscErrorCode CheckSpace(const MpmSettings *settings, const MpmScene *scene, const MpmSolution *s)
{
  const MpmLayout *l = &scene->layout;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(l->dim < s->least || l->dim > s->most, settings, "initial",
                      s->most == 1 ? "its exact solution is of one dimension; allowed: dim 1"
                                   : "its exact solution is of the plane; allowed: dim 2");
  MpmSettingsRefuseIf(!s->any && scene->law != s->law, settings, "initial",
                      s->law == &MpmLawNeo ? "its exact solution is of another material; allowed: material neo"
                                           : "its exact solution is of another material; allowed: material gas");
  MpmSettingsRefuseIf(s->any && (!scene->law->solid || scene->law->plastic), settings, "initial",
                      "it is of a solid; allowed: material uniform, neo or svk");
  for (PetscInt a = 0; a < l->dim; a++) {
    MpmSettingsRefuseIf(scene->stretch[a] != 1, settings, "initial",
                        "its exact solution starts from rest; allowed: stretch 1");
    MpmSettingsRefuseIf(scene->step.drift[a].value != 0 || scene->gravity[a] != 0, settings, "initial",
                        "its exact solution is without drift, velocity and gravity; allowed: none of them");
  }
  MpmSettingsRefuseIf(l->counts.n > 1, settings, "initial", "allowed: with ppc, and not with counts");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadSolution(const MpmSettings *settings, MpmScene *scene)
{
  const MpmSolution *s = Find(scene->initial);

  PetscFunctionBegin;
  if (!s) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckSpace(settings, scene, s));
  PetscCall(s->check(settings, scene));
  scene->body_force = s->force;
  if (s->force) scene->scheme.space.loaded = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- errors ---- */

PetscInt MpmSceneErrorFields(const MpmScene *scene, const char *name[])
{
  static const char *const places[] = {"x", "y", "z"};
  const MpmSolution       *s        = MpmSolutionOf(scene);
  const MpmTable          *table    = scene->scheme.table;
  PetscInt                 n        = 0;

  for (PetscInt a = 0; s && !s->density && a < scene->layout.dim; a++) name[n++] = places[a];
  for (PetscInt r = 0; r < table->nstate; r++) {
    if (s && table->field[r] == MPM_NONE) continue;
    name[n++] = s && s->density && table->field[r] == MPM_STRETCHED ? "rho" : table->fields[r];
  }
  return n;
}
