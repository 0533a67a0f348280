/*
   A scheme about a stretched state: the prestress s0 = sigma0 / (rho c^2), given as such or by a material and a stretch.

   With P(F) the nominal stress of a material at the stretch F, small waves travel with c^2 = F^2 P'(F) / rho0 in the
   stretched state, and s0 = P / (F P'). The scheme knows the material by s0 and c alone (THEORY.md, section 9).
*/
#include "scene/layout.h"
#include "scene/settings.h"
#include <math.h>

#define TIE 1e-9 /* places nearer to a tie than this are on it */

const char *const MpmLawNames[] = {"linear", "neo", "svk", "tait", "gas", "polytropic", NULL};

/* The nominal stress and its slope at a stretch F, in units of the material. */
typedef struct {
  PetscReal stress, slope;
} Nominal;

/*
   neo        - P = mu (F - 1/F) + lambda ln F / F, compressible neo-Hookean
   svk        - P = E F (F^2 - 1) / 2, Saint Venant and Kirchhoff
   tait       - P = -(rho0 c0^2 / n) (F^-n - 1), a liquid
   gas        - P = -a^2 rho0 / F, at constant temperature
   polytropic - P = -p0 F^-n
*/
static Nominal NominalOf(const MpmScene *scene, PetscReal F)
{
  const PetscReal n = scene->exponent, lame = scene->lame_ratio;

  switch (scene->law) {
  case MPM_LAW_NEO:
    return (Nominal){F - 1 / F + lame * log(F) / F, 1 + (1 + lame * (1 - log(F))) / (F * F)};
  case MPM_LAW_SVK:
    return (Nominal){F * (F * F - 1) / 2, (3 * F * F - 1) / 2};
  case MPM_LAW_TAIT:
    return (Nominal){(1 - pow(F, -n)) / n, pow(F, -n - 1)};
  case MPM_LAW_GAS:
    return (Nominal){-1 / F, 1 / (F * F)};
  case MPM_LAW_POLYTROPIC:
    return (Nominal){-pow(F, -n), n * pow(F, -n - 1)};
  default:
    return (Nominal){0, 1};
  }
}

/* Refuses a number of a material that the scene's material does not have. */
static PetscErrorCode CheckReads(const MpmSettings *settings, const char option[], PetscBool reads, const char why[])
{
  PetscFunctionBegin;
  if (!reads && MpmSettingsSource(settings, option) != MPM_FROM_DEFAULT &&
      !MpmSettingsOverruled(settings, option, "material"))
    PetscCall(MpmSettingsRefuse(settings, option, why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadLaw(const MpmSettings *settings, MpmScene *scene)
{
  PetscInt  word;
  PetscBool power;
  Nominal   at;
  PetscReal F;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "material", &word));
  scene->law = word < MPM_MATERIAL_KINDS ? MPM_LAW_LINEAR : (MpmLaw)(word - MPM_MATERIAL_KINDS + 1);
  power      = scene->law == MPM_LAW_TAIT || scene->law == MPM_LAW_POLYTROPIC ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(CheckReads(settings, "stretch", scene->law != MPM_LAW_LINEAR,
                       "allowed: only with material neo, svk, tait, gas or polytropic"));
  PetscCall(CheckReads(settings, "lame_ratio", scene->law == MPM_LAW_NEO, "allowed: only with material neo"));
  PetscCall(CheckReads(settings, "exponent", power, "allowed: only with material tait or polytropic"));
  if (scene->law == MPM_LAW_LINEAR) PetscFunctionReturn(PETSC_SUCCESS);
  if (power && !MpmSettingsGiven(settings, "exponent")) scene->exponent = scene->law == MPM_LAW_TAIT ? 7 : 1.4;
  if (MpmSettingsSource(settings, "prestress") != MPM_FROM_DEFAULT)
    PetscCall(MpmSettingsRefuse(settings, "prestress", "material and stretch give it; allowed: one of the two"));
  F  = scene->stretch;
  at = NominalOf(scene, F);
  if (!(at.slope > 0) || !isfinite(at.stress / (F * at.slope)))
    PetscCall(
        MpmSettingsRefuse(settings, "stretch",
                          "the material has no stiffness against more stretch there, so that waves have no speed; "
                          "allowed: a stretch with a stress that rises"));
  scene->scheme.space.prestress = at.stress / (F * at.slope);
  scene->wave_speed *= F * sqrt(at.slope / NominalOf(scene, 1).slope);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what a prestress asks of a scene ---- */

static PetscBool HasMove(const MpmFormulation *f)
{
  return MpmFormulationHas(f, MPM_MOVE);
}

/* Without MOVE_PROJECTED there is no second P2G. */
static PetscBool HasProjected(const MpmFormulation *f)
{
  return MpmFormulationHas(f, MPM_MOVE_PROJECTED);
}

static PetscErrorCode Refuse(const MpmSettings *settings, const MpmScene *scene, const char why[])
{
  PetscFunctionBegin;
  PetscCall(MpmSettingsRefuse(settings, scene->law == MPM_LAW_LINEAR ? "prestress" : "material", why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The state that a scheme is linear about must stay as it is: in each cell the forces of its particles cancel. */
static PetscErrorCode CheckEquilibrium(const MpmSettings *settings, const MpmScene *scene)
{
  const MpmLayout *l = &scene->layout;

  PetscFunctionBegin;
  if (l->dim > 1) PetscCall(Refuse(settings, scene, "with a prestress there is one dimension only; allowed: dim 1"));
  if (l->jitter != 0 || !MpmLayoutIsFull(l) || l->counts.n > 1 || l->material.kind != MPM_MATERIAL_UNIFORM)
    PetscCall(
        Refuse(settings, scene,
               "a stretched layout whose cells differ is no equilibrium; allowed: ppc, without jitter, fill, counts "
               "and a second material"));
  for (int end = 0; end < 2; end++)
    if (l->grid[0].ends[end] == MPM_FREE)
      PetscCall(Refuse(settings, scene, "a free end holds no stress; allowed: boundary periodic or fixed"));
  if (MpmBasisIsAltered(scene->scheme.basis))
    PetscCall(Refuse(settings, scene,
                     "with spline_ends modified or open a stretched bar is no equilibrium next to its "
                     "ends; allowed: spline_ends mirror"));
  if (scene->initial == MPM_INITIAL_PULSE || scene->initial == MPM_INITIAL_STEP)
    PetscCall(Refuse(settings, scene, "allowed: initial mode, random or eigenmode"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Where a slope of a basis has a jump in its own slope, a particle's force depends on the side to which it moves, and
   the step has no linear operator: in the middle of a cell for quadratic splines, and where the edge of a gimp particle
   meets a node.
*/
static PetscErrorCode CheckTies(const MpmSettings *settings, const MpmScene *scene)
{
  const MpmLayout *l      = &scene->layout;
  const PetscReal  half   = scene->scheme.basis->wide ? l->half_width[0] : 0.5;
  PetscInt         period = 1;
  const MpmStep   *step   = &scene->step;

  PetscFunctionBegin;
  if (scene->scheme.basis->smooth || !scene->scheme.space.displaced) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmStepPeriod(step, &period));
  for (PetscInt n = 0; n < period; n++)
    for (PetscInt j = 0; j < l->ppc[0]; j++) {
      PetscInt  cell[MPM_MAX_DIM];
      PetscReal xi[MPM_MAX_DIM];

      MpmLayoutPlaceAt(l, step->drift, j, n, cell, xi);
      if (fabs(remainder(xi[0] - half, 1)) > TIE && fabs(remainder(xi[0] + half, 1)) > TIE) continue;
      PetscCall(
          Refuse(settings, scene,
                 scene->scheme.basis->wide
                     ? "the edge of a particle is on a node, where its force has no derivative; allowed: another "
                       "offset or ppc, or basis cubic"
                     : "a particle is in the middle of a cell, where its force has no derivative with basis "
                       "quadratic; allowed: another offset or ppc (not ppc odd with offset 1/2), or basis cubic"));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadPrestress(const MpmSettings *settings, MpmScene *scene)
{
  MpmSpace *space = &scene->scheme.space;
  PetscInt  i;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "move", &i));
  space->move      = (MpmMove)i;
  space->displaced = space->prestress != 0 && scene->scheme.basis->kernel[MPM_CURVE] ? PETSC_TRUE : PETSC_FALSE;
  if (MpmSettingsSource(settings, "move") != MPM_FROM_DEFAULT) {
    if (!space->displaced && !MpmSettingsOverruled(settings, "move", "basis"))
      PetscCall(MpmSettingsRefuse(
          settings, "move", "nothing depends on it here; allowed: with a prestress, and another basis than linear"));
    if (space->move == MPM_MOVES_PROJECTED)
      PetscCall(MpmSettingsRequire(settings, scene, "move", HasProjected, "second P2G of the velocity"));
  }
  if (space->prestress == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRequire(settings, scene, scene->law == MPM_LAW_LINEAR ? "prestress" : "material", HasMove,
                               "MOVE, which says what velocity particles move with"));
  PetscCall(CheckEquilibrium(settings, scene));
  PetscCall(CheckTies(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
