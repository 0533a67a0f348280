/* What a stretched state asks of a scene: that it is an equilibrium, and that the force has a derivative at each particle. */
#include "scene/layout.h"
#include "scene/settings.h"
#include <math.h>

#define TIE 1e-9 /* places nearer to a tie than this are on it */

static PetscBool HasMove(const MpmFormulation *f)
{
  return MpmFormulationHas(f, MPM_MOVE);
}

PetscBool MpmFormulationIsProjected(const MpmFormulation *f)
{
  return MpmFormulationHas(f, MPM_MOVE_PROJECTED);
}

static PetscErrorCode Refuse(const MpmSettings *settings, const MpmScene *scene, const char why[])
{
  PetscFunctionBegin;
  PetscCall(MpmSettingsRefuse(settings, scene->law == &MpmLawLinear ? "prestress" : "material", "%s", why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The state that a scheme is linear about must stay as it is: in each cell the forces of its particles cancel. */
static PetscErrorCode CheckEquilibrium(const MpmSettings *settings, const MpmScene *scene)
{
  const MpmLayout *l = &scene->layout;

  PetscFunctionBegin;
  if (l->jitter != 0 || !MpmLayoutIsFull(l) || l->counts.n > 1 || l->material.kind != MPM_MATERIAL_UNIFORM)
    PetscCall(
        Refuse(settings, scene,
               "a stretched layout whose cells differ is no equilibrium; allowed: ppc, without jitter, fill, counts "
               "and a second material"));
  for (PetscInt a = 0; a < l->dim; a++)
    for (int end = 0; end < 2; end++) {
      if (l->grid[a].ends[end] == MPM_FREE)
        PetscCall(Refuse(settings, scene, "a free end holds no stress; allowed: boundary periodic or fixed"));
      if (l->grid[a].ends[end] == MPM_SYMMETRY && !MpmSpaceMirrors(&scene->scheme.space, a))
        PetscCall(Refuse(settings, scene, "a wall of symmetry holds no shear; allowed: boundary periodic or fixed"));
    }
  if (MpmBasisIsAltered(scene->scheme.basis))
    PetscCall(Refuse(settings, scene,
                     "with spline_ends modified or open a stretched bar is no equilibrium next to its "
                     "ends; allowed: spline_ends mirror"));
  if (scene->initial == MPM_INITIAL_PULSE || scene->initial == MPM_INITIAL_STEP)
    PetscCall(Refuse(settings, scene, "allowed: initial mode, random or eigenmode"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a direction's second derivatives are in the force: the state has a stress on planes across it. */
static PetscBool IsLoaded(const MpmSpace *space, PetscInt a)
{
  for (PetscInt b = 0; b < space->dim; b++)
    if (MpmSpacePrestress(space, a, b) != 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Whether a particle of a direction is at a place xi in its cell, or the same distance to the left, in any step. */
static PetscErrorCode HasParticleAt(const MpmScene *scene, PetscInt a, PetscReal place, PetscBool *has)
{
  const MpmLayout *l      = &scene->layout;
  PetscInt         period = 1;
  MpmStep          step   = {.drift = {{.den = 1}, {.den = 1}, {.den = 1}}};
  PetscInt64       stride = 1;

  PetscFunctionBegin;
  *has          = PETSC_FALSE;
  step.drift[a] = scene->step.drift[a];
  for (PetscInt b = 0; b < a; b++) stride *= l->row[b];
  PetscCall(MpmStepPeriod(&step, &period));
  for (PetscInt n = 0; n < period; n++)
    for (PetscInt j = 0; j < l->ppc[a]; j++) {
      PetscInt  cell[MPM_MAX_DIM];
      PetscReal xi[MPM_MAX_DIM];

      MpmLayoutPlaceAt(l, step.drift, j * stride, n, cell, xi);
      if (fabs(remainder(xi[a] - place, 1)) <= TIE || fabs(remainder(xi[a] + place, 1)) <= TIE) *has = PETSC_TRUE;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Where a slope of a basis has a jump in its own slope, a particle's force depends on the side to which it moves, and
   the step has no linear operator: in the middle of a cell for quadratic splines, and where the edge of a gimp particle
   meets a node. The slopes of hats have a jump themselves, on a node; in one dimension nothing depends on them elsewhere.
   The weights of mls have none.
*/
static PetscErrorCode CheckTies(const MpmSettings *settings, const MpmScene *scene)
{
  const MpmLayout *l     = &scene->layout;
  const MpmSpace  *space = &scene->scheme.space;
  const MpmBasis  *basis = scene->scheme.basis;
  PetscBool        has;

  PetscFunctionBegin;
  if (!space->displaced || (space->curved && (basis->smooth || space->gradient == MPM_GRADIENT_MLS)))
    PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < l->dim; a++) {
    if (space->curved && !IsLoaded(space, a)) continue;
    PetscCall(HasParticleAt(scene, a, !space->curved ? 0 : basis->wide ? l->half_width[a] : 0.5, &has));
    if (!has) continue;
    PetscCall(Refuse(
        settings, scene,
        !space->curved ? "a particle is on a node, where its force jumps with basis linear; allowed: another "
                         "offset, ppc or drift, or basis cubic"
        : basis->wide  ? "the edge of a particle is on a node, where its force has no derivative; allowed: another "
                         "offset or ppc, or basis cubic"
                       : "a particle is in the middle of a cell, where its force has no derivative with basis "
                         "quadratic; allowed: another offset or ppc (not ppc odd with offset 1/2), or basis cubic"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadPrestress(const MpmSettings *settings, MpmScene *scene)
{
  static const char *const moves[] = {"move", "move_share"};
  MpmSpace                *space   = &scene->scheme.space;

  PetscFunctionBegin;
  space->curved    = scene->scheme.basis->weights[MPM_CURVE] ? PETSC_TRUE : PETSC_FALSE;
  space->displaced = MpmSpaceIsPrestressed(space) && (space->curved || space->dim > 1) ? PETSC_TRUE : PETSC_FALSE;
  for (size_t o = 0; o < PETSC_STATIC_ARRAY_LENGTH(moves); o++)
    if (MpmSettingsGiven(settings, moves[o]) && MpmSettingsSource(settings, moves[o]) != MPM_FROM_DEFAULT &&
        !space->displaced)
      PetscCall(MpmSettingsRefuseUnless(
          settings, moves[o], "basis",
          "nothing depends on it here; allowed: with a prestress, and with dim 1 another basis than linear"));
  if (space->move == MPM_MOVES_PROJECTED)
    PetscCall(MpmSettingsRequire(settings, scene, "move", MpmFormulationIsProjected, "second P2G of the velocity"));
  MpmSettingsRefuseIf(scene->scheme.numbers.rk_relax, settings, "rk_relax",
                      "a linear step does not raise the energy below its limit; allowed: only with kinematics finite");
  for (PetscInt a = 0; a < space->dim; a++)
    if (scene->step.drift[a].value != 0 || MpmSpaceIsPrestressed(space))
      MpmSettingsRefuseIf(
          scene->scheme.numbers.rk_places == MPM_RK_STAGES, settings, "rk_places",
          "at small strain no particle moves in a stage; allowed: frozen, or without drift and prestress, where "
          "both are the same, or with kinematics finite");
  if (!MpmSpaceIsPrestressed(space)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRequire(settings, scene, scene->law == &MpmLawLinear ? "prestress" : "material", HasMove,
                               "MOVE, which says what velocity particles move with"));
  PetscCall(CheckEquilibrium(settings, scene));
  PetscCall(CheckTies(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
