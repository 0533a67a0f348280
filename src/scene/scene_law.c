/*
   The state that a scheme is linear about: its stress sigma0, its stiffness and its wave speed, from a material and a
   stretch, or from the stress itself.

   With P(F) the nominal stress of a material at the stretch F, small waves travel with c^2 = F^2 P'(F) / rho0 in the
   stretched state of one dimension, and s0 = P / (F P'). A fluid feels the change of its volume alone, J = det F in the
   place of F. A solid in more dimensions has the stretches F_a along the axes (docs/theory.md, section 9).
*/
#include "linalg/small_eigen.h"
#include "scene/settings.h"
#include <math.h>

static const char slow[] =
    "the stretched state is unstable by itself, because some of its waves have no real speed; allowed: a smaller "
    "compression";
static const char stiff[] = "the material has no stiffness against more stretch there, so that waves have no speed; "
                            "allowed: a stretch with a stress that rises";

/* The state of one dimension, and of a fluid, by the change of its volume. */
static PetscErrorCode FromVolume(const MpmSettings *settings, MpmScene *scene)
{
  const MpmMaterialNumbers numbers = MpmMaterialOfRatio(scene->law, scene->lame_ratio, scene->exponent);
  PetscReal                J       = 1, tau, modulus;
  const PetscReal         *of[1]   = {&J};
  PetscReal               *to[1]   = {&tau};

  PetscFunctionBegin;
  MpmSettingsRefuseIf(MpmSceneHasPoisson(scene) && scene->scheme.space.poisson != 0.5, settings, "material",
                      "it is a fluid, with a pressure alone; allowed: with poisson 0.5, or neo or svk");
  for (PetscInt a = 0; a < scene->layout.dim; a++) J *= scene->stretch[a];
  modulus = MpmMaterialModulus(&numbers, 1, &J);
  MpmMaterialStress(&numbers, 1, 1, of, to);
  MpmSettingsRefuseIf(!(modulus > 0) || !isfinite(tau / modulus), settings, "stretch", stiff);
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    scene->scheme.space.prestress[MpmStressComponent(scene->layout.dim, a, a)] = tau / modulus;
  scene->wave_speed *= sqrt(modulus);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest of the wave speeds' squares that are below 0, over rho c^2, or any positive number: of P and of S waves. */
static PetscReal LeastSpeed(const MpmSpace *space, PetscInt dim, const PetscReal along[])
{
  const PetscReal *q     = space->squares;
  PetscReal        least = INFINITY;

  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++)
      least = PetscMin(least, (a == b ? space->lambda + 2 * space->mu : space->mu) * q[a] * q[b] + along[a]);
  return least;
}

/*
   A solid with the stretches F_a along the axes: its true stress sigma and stiffness c, with J = det F times those at rest as
   the unit. All is divided by rho c^2 = c_0000 + sigma_0, that of P waves along x.
*/
static PetscErrorCode FromSolid(const MpmSettings *settings, MpmScene *scene)
{
  const PetscInt           dim      = scene->layout.dim;
  const PetscReal          nu       = scene->scheme.space.poisson;
  const MpmMaterialNumbers material = {scene->law, (1 - 2 * nu) / (2 * (1 - nu)), nu / (1 - nu), 0, {0}};
  MpmSpace                *space    = &scene->scheme.space;
  PetscReal                F[MPM_MAX_DIM * MPM_MAX_DIM] = {0}, tau[MPM_MAX_STRESS], sigma[MPM_MAX_DIM] = {0}, M;
  const PetscReal         *from[MPM_MAX_DIM * MPM_MAX_DIM];
  PetscReal               *to[MPM_MAX_STRESS];

  PetscFunctionBegin;
  MpmSettingsRefuseIf(nu == 0.5, settings, "material",
                      "with poisson 0.5 the material is a fluid; allowed: gas, tait or polytropic");
  MpmSettingsRefuseIf(!scene->law->stretched, settings, "material",
                      "no linear scheme about a stretched state is known of it; allowed: with kinematics finite");
  for (PetscInt a = 0; a < dim; a++) F[(dim + 1) * a] = scene->stretch[a];
  for (PetscInt c = 0; c < dim * dim; c++) from[c] = &F[c];
  for (PetscInt c = 0; c < dim * (dim + 1) / 2; c++) to[c] = &tau[c];
  MpmMaterialStress(&material, dim, 1, from, to);
  scene->law->stretched(&material, dim, scene->stretch, &space->lambda, &space->mu, space->squares);
  for (PetscInt a = 0; a < dim; a++) sigma[a] = tau[MpmStressComponent(dim, a, a)];
  M = (space->lambda + 2 * space->mu) * space->squares[0] * space->squares[0] + sigma[0];
  MpmSettingsRefuseIf(!(LeastSpeed(space, dim, sigma) > 0) || !isfinite(M), settings, "stretch", slow);
  for (PetscInt a = 0; a < dim; a++) space->prestress[MpmStressComponent(dim, a, a)] = sigma[a] / M;
  space->lambda /= M;
  space->mu /= M;
  scene->wave_speed *= sqrt(M);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The principal values of a stress. */
static void Principal(PetscInt dim, const PetscReal stress[], PetscReal value[])
{
  double complex M[MPM_MOST_HERMITIAN][MPM_MOST_HERMITIAN], vector[MPM_MOST_HERMITIAN][MPM_MOST_HERMITIAN];

  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++) M[a][b] = stress[MpmStressComponent(dim, a, b)];
  MpmHermitianSolve(dim, M, value, vector);
}

static PetscBool IsHydrostatic(PetscInt dim, const PetscReal stress[])
{
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = a; b < dim; b++)
      if (stress[MpmStressComponent(dim, a, b)] != (a == b ? stress[0] : 0)) return PETSC_FALSE;
  return PETSC_TRUE;
}

/*
   A stress that is given itself. In more dimensions the stiffness beside it is isotropic with the scene's Poisson ratio,
   and such that P waves along x have the speed c: lambda + 2 mu + sigma0_xx = rho c^2.
*/
static PetscErrorCode FromStress(const MpmSettings *settings, MpmScene *scene)
{
  const PetscInt  dim = scene->layout.dim, all = dim * (dim + 1) / 2;
  MpmSpace       *space                  = &scene->scheme.space;
  const PetscReal nu                     = space->poisson;
  PetscReal       number[MPM_MAX_STRESS] = {0}, value[MPM_MAX_DIM];
  PetscInt        n;

  PetscFunctionBegin;
  if (MpmSettingsSource(settings, "prestress") == MPM_FROM_DEFAULT) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsReals(settings, "prestress", MPM_MAX_STRESS, &n, number));
  MpmSettingsRefuseIf(n != dim && n != all && !(n == 1 && number[0] == 0), settings, "prestress",
                      dim == 1   ? "allowed: one number"
                      : dim == 2 ? "allowed: two numbers, sigma0 along x and y, or three, xx,xy,yy"
                                 : "allowed: three numbers, sigma0 along x, y and z, or six, xx,xy,xz,yy,yz,zz");
  for (PetscInt i = 0; i < n; i++) space->prestress[n == all ? i : MpmStressComponent(dim, i, i)] = number[i];
  if (!MpmSceneHasPoisson(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < dim; a++) space->squares[a] = 1;
  space->lambda = (1 - space->prestress[0]) * nu / (1 - nu);
  space->mu     = (1 - space->prestress[0]) * (1 - 2 * nu) / (2 * (1 - nu));
  Principal(dim, space->prestress, value);
  MpmSettingsRefuseIf(nu == 0.5 && !IsHydrostatic(dim, space->prestress), settings, "prestress",
                      "with poisson 0.5 the material is a fluid, whose stress is the same in all directions; "
                      "allowed: equal numbers without shear, or poisson below 0.5");
  MpmSettingsRefuseIf(nu < 0.5 && !(LeastSpeed(space, dim, value) > 0), settings, "prestress", slow);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadLaw(const MpmSettings *settings, MpmScene *scene)
{
  PetscInt word;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "material", &word));
  scene->law = word < MPM_MATERIAL_KINDS ? &MpmLawLinear : MpmLaws[word - MPM_MATERIAL_KINDS + 1];
  MpmSettingsRefuseIf(scene->law->plastic, settings, "material",
                      "it flows, and a linear scheme is about a state that does not; allowed: with kinematics finite");
  PetscCall(MpmSettingsReadPlastic(settings, scene));
  if (scene->law == &MpmLawLinear)
    PetscCall(MpmSettingsRefuseUnless(settings, "stretch", "material",
                                      "allowed: only with material neo, svk, tait, gas or polytropic"));
  if (scene->law != &MpmLawNeo || scene->layout.dim > 1)
    PetscCall(MpmSettingsRefuseUnless(settings, "lame_ratio", "material",
                                      scene->law == &MpmLawNeo
                                          ? "poisson says it with dim 2 or 3; allowed: only with dim 1"
                                          : "allowed: only with material neo"));
  if (!(scene->law->exponent > 0))
    PetscCall(
        MpmSettingsRefuseUnless(settings, "exponent", "material", "allowed: only with material tait or polytropic"));
  if (scene->law == &MpmLawLinear) {
    PetscCall(FromStress(settings, scene));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (scene->law->exponent > 0 && !MpmSettingsGiven(settings, "exponent")) scene->exponent = scene->law->exponent;
  MpmSettingsRefuseIf(MpmSettingsSource(settings, "prestress") != MPM_FROM_DEFAULT, settings, "prestress",
                      "material and stretch give it; allowed: one of the two");
  if (MpmSceneHasPoisson(scene) && scene->law->solid)
    PetscCall(FromSolid(settings, scene));
  else
    PetscCall(FromVolume(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
