/* The state that a linear scheme is about, from a material and its stretch or from a stress; damping and viscosity. */
#include "linalg/small_eigen.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "scene/settings.h"
#include <math.h>

/*
   The state that a scheme is linear about: its stress sigma0, its stiffness and its wave speed, from a material and a
   stretch, or from the stress itself.

   With P(F) the nominal stress of a material at the stretch F, small waves travel with c^2 = F^2 P'(F) / rho0 in the
   stretched state of one dimension, and s0 = P / (F P'). A fluid feels the change of its volume alone, J = det F in the
   place of F. A solid in more dimensions has the stretches F_a along the axes (docs/theory.md, section 9).
*/

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

  PetscFunctionBegin;
  MpmSettingsRefuseIf(MpmSceneHasPoisson(scene) && scene->scheme.space.poisson != 0.5, settings, "material",
                      "it is a fluid, with a pressure alone; allowed: with poisson 0.5, or neo or svk");
  for (PetscInt a = 0; a < scene->layout.dim; a++) J *= scene->stretch[a];
  modulus = MpmMaterialModulus(&numbers, 1, &J);
  MpmMaterialOne(&numbers, 1, &J, NULL, &tau, NULL);
  MpmSettingsRefuseIf(!(modulus > 0) || !isfinite(tau / modulus), settings, "stretch", stiff);
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    scene->scheme.space.prestress[MpmStressComponent(scene->layout.dim, a, a)] = tau / modulus;
  scene->wave_speed *= sqrt(modulus);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The largest of the wave speeds' squares that are below 0, over rho c^2, or any positive number: of P and of S waves.
*/
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
   A solid with the stretches F_a along the axes: its true stress sigma and stiffness c, with J = det F times those at
   rest as the unit. All is divided by rho c^2 = c_0000 + sigma_0, that of P waves along x.
*/
static PetscErrorCode FromSolid(const MpmSettings *settings, MpmScene *scene)
{
  const PetscInt           dim      = scene->layout.dim;
  const PetscReal          nu       = scene->scheme.space.poisson;
  const MpmMaterialNumbers material = {scene->law, (1 - 2 * nu) / (2 * (1 - nu)), nu / (1 - nu), 0, {0}, 0, {0}, NULL};
  MpmSpace                *space    = &scene->scheme.space;
  PetscReal                F[MPM_MAX_DIM * MPM_MAX_DIM] = {0}, tau[MPM_MAX_STRESS], sigma[MPM_MAX_DIM] = {0}, M;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(nu == 0.5, settings, "material",
                      "with poisson 0.5 the material is a fluid; allowed: gas, tait or polytropic");
  MpmSettingsRefuseIf(!scene->law->stretched, settings, "material",
                      "no linear scheme about a stretched state is known of it; allowed: with kinematics finite");
  for (PetscInt a = 0; a < dim; a++) F[(dim + 1) * a] = scene->stretch[a];
  MpmMaterialOne(&material, dim, F, NULL, tau, NULL);
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
   A stress that is given itself. In more dimensions the stiffness beside it is isotropic with the scene's Poisson
   ratio, and such that P waves along x have the speed c: lambda + 2 mu + sigma0_xx = rho c^2.
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

/*
   At finite deformation the wave speed c is that of the uniform stretch which a run starts from, as about a prestress.
   So Courant number and drift mean the same as in the linear scheme about that state.
*/

/*
   lambda / mu of a solid: with dim 1 the option lame_ratio, else it follows from Poisson's ratio unless lame_ratio is
   given. The scene has the one that follows from the other, too.
*/
static PetscErrorCode SetRatio(const MpmSettings *settings, MpmScene *scene)
{
  static const char *const rivals[] = {"poisson", "bulk", "shear"};
  const PetscReal          nu       = scene->scheme.space.poisson;
  PetscBool                given    = MpmSettingsSource(settings, "lame_ratio") != MPM_FROM_DEFAULT;

  PetscFunctionBegin;
  if (scene->layout.dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(rivals) && given; i++) {
    if (MpmSettingsSource(settings, rivals[i]) == MPM_FROM_DEFAULT) continue;
    STANDS("lame_ratio", rivals[i], PETSC_TRUE,
           "poisson, or bulk and shear, say it too with dim 2 or 3; allowed: one of them");
    given = PETSC_FALSE;
  }
  if (given) {
    scene->scheme.space.poisson = scene->lame_ratio / (2 * (1 + scene->lame_ratio));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  MpmSettingsRefuseIf(nu == 0.5, settings, "poisson",
                      "a solid at finite deformation resists a change of its shape; allowed: less than 0.5, "
                      "or material tait, gas or polytropic");
  scene->lame_ratio = 2 * nu / (1 - 2 * nu);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   rho0 c^2 of P waves along x about the stretch F, in units of rho0 c0^2. Such a wave has dF = H F with H_xx alone, and
   the force d tau_xx - tau_xx H_xx.
*/
static PetscReal ModulusAlongX(const MpmMaterialNumbers *material, PetscInt dim, const PetscReal F[])
{
  PetscReal dF[MPM_MOST_STRETCH] = {0}, tau[6], dtau[6];

  for (PetscInt a = 0; a < dim; a++) dF[a] = F[a];
  MpmMaterialOne(material, dim, F, dF, tau, dtau);
  return dtau[0] - tau[0];
}

/* The materials that read a number, as a list of words. */
static void ReadersOf(PetscInt number, size_t room, char text[])
{
  size_t used = (size_t)snprintf(text, room, "allowed: only with material ");
  int    n    = 0;

  for (const MpmLaw *const *law = MpmLaws; *law; law++)
    if ((*law)->number[number].reads)
      used += (size_t)snprintf(text + used, room - used, "%s%s", n++ ? " or " : "", (*law)->name);
}

static PetscErrorCode ReadPlastic(const MpmSettings *settings, MpmScene *scene)
{
  const MpmLaw *law = scene->law;
  char          text[256];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < MPM_PLASTIC_NUMBERS; i++) {
    const char *name = MpmPlasticNames[i];

    ReadersOf(i, sizeof text, text);
    STANDS(name, "material", !law->number[i].reads, text);
    if (!law->number[i].reads || MpmSettingsGiven(settings, name)) continue;
    scene->plastic[i] = law->number[i].usual;
  }
  for (PetscInt i = 0; i < MPM_PLASTIC_NUMBERS; i++)
    MpmSettingsRefuseIf(law->number[i].reads &&
                            !(scene->plastic[i] >= law->number[i].least && scene->plastic[i] <= law->number[i].most),
                        settings, MpmPlasticNames[i], "allowed with material %s: from %g to %g", scene->law->name,
                        (double)law->number[i].least, (double)law->number[i].most);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool MpmFormulationHasOneStage(const MpmFormulation *f)
{
  for (PetscInt field = 0; f->particle_fields[field]; field++)
    if (f->scratch[field] && f->particle_ranks[field] == MPM_TENSOR) return PETSC_FALSE;
  return PETSC_TRUE;
}

static PetscErrorCode FromFinite(const MpmSettings *settings, MpmScene *scene)
{
  MpmSpace      *space               = &scene->scheme.space;
  const PetscInt dim                 = scene->layout.dim;
  PetscReal      F[MPM_MOST_STRETCH] = {0}, modulus;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(space->prestress, PETSC_STATIC_ARRAY_LENGTH(space->prestress)));
  if (scene->law->solid) PetscCall(SetRatio(settings, scene));
  space->material = MpmMaterialOfRatio(scene->law, scene->law->solid ? scene->lame_ratio : 0, scene->exponent);
  PetscCall(PetscArraycpy(space->material.plastic, scene->plastic, MPM_PLASTIC_NUMBERS));
  if (scene->law->plastic)
    PetscCall(MpmSettingsRequire(settings, scene, "material", MpmFormulationHasOneStage,
                                 "steps of one stage, without IMPLICIT"));
  for (PetscInt c = dim * dim; c < MpmMaterialComponents(&space->material, dim); c++)
    (void)MpmMaterialInternal(&space->material, dim, c - dim * dim, &F[c]);
  for (PetscInt a = 0; a < dim; a++) F[(dim + 1) * a] = space->stretch[a] = scene->stretch[a];
  modulus = ModulusAlongX(&space->material, dim, F);
  MpmSettingsRefuseIf(!(modulus > 0) || !isfinite(modulus), settings, "stretch", stiff);
  space->stiffness = 1 / modulus;
  scene->wave_speed *= sqrt(modulus);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadLaw(const MpmSettings *settings, MpmScene *scene)
{
  const PetscBool finite = scene->scheme.space.finite;
  PetscInt        word;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "material", &word));
  MpmSettingsRefuseIf(finite && word > 0 && word < MPM_MATERIAL_KINDS, settings, "material",
                      "with kinematics finite all particles are of one material; allowed: uniform (linear in "
                      "the stretch), neo, svk, tait, gas, polytropic, mises, snow, sand, clay or herschel_bulkley");
  scene->law = word < MPM_MATERIAL_KINDS ? &MpmLawLinear : MpmLaws[word - MPM_MATERIAL_KINDS + 1];
  MpmSettingsRefuseIf(!finite && (scene->law->plastic || scene->law->viscous), settings, "material",
                      "it flows, and a linear scheme is about a state that does not; allowed: with kinematics finite");
  PetscCall(ReadPlastic(settings, scene));
  if (scene->law->exponent > 0 && !MpmSettingsGiven(settings, "exponent")) scene->exponent = scene->law->exponent;
  MpmSettingsRefuseIf(!finite && scene->law != &MpmLawLinear &&
                          MpmSettingsSource(settings, "prestress") != MPM_FROM_DEFAULT,
                      settings, "prestress", "material and stretch give it; allowed: one of the two");
  if (finite)
    PetscCall(FromFinite(settings, scene));
  else if (scene->law == &MpmLawLinear)
    PetscCall(FromStress(settings, scene));
  else if (MpmSceneHasPoisson(scene) && scene->law->solid)
    PetscCall(FromSolid(settings, scene));
  else
    PetscCall(FromVolume(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   What a stretched state asks of a scene: that it is an equilibrium, and that the force has a derivative at each
   particle.
*/

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
   meets a node. The slopes of hats have a jump themselves, on a node; in one dimension nothing depends on them
   elsewhere. The weights of mls have none.
*/
static PetscErrorCode CheckTies(const MpmSettings *settings, const MpmScene *scene)
{
  const MpmLayout *l     = &scene->layout;
  const MpmSpace  *space = &scene->scheme.space;
  const MpmBasis  *basis = scene->scheme.basis;
  PetscBool        has, loaded;

  PetscFunctionBegin;
  if (!space->displaced || (space->curved && (basis->smooth || space->gradient == MPM_GRADIENT_MLS)))
    PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < l->dim; a++) {
    loaded = PETSC_FALSE; /* second derivatives of a direction are in the force if there is a stress across it */
    for (PetscInt b = 0; b < space->dim; b++)
      if (MpmSpacePrestress(space, a, b) != 0) loaded = PETSC_TRUE;
    if (space->curved && !loaded) continue;
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
  MpmSpace *space = &scene->scheme.space;

  PetscFunctionBegin;
  space->curved    = scene->scheme.basis->weights[MPM_CURVE] ? PETSC_TRUE : PETSC_FALSE;
  space->displaced = MpmSpaceIsPrestressed(space) && (space->curved || space->dim > 1) ? PETSC_TRUE : PETSC_FALSE;
  STANDS("move,move_share", "basis", !space->displaced,
         "nothing depends on it here; allowed: with a prestress, and with dim 1 another basis than linear");
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

/* ---- damping and viscosity, in the units of a step: c / h, and rho c h ---- */

static PetscBool HasForce(const MpmFormulation *f)
{
  MpmOp        room[MPM_MOST_TABLE_LINES];
  PetscInt     n;
  const MpmOp *ops   = MpmFormulationLines(f, NULL, NULL, room, &n);
  PetscBool    force = PETSC_FALSE;

  for (PetscInt o = 0; o < n; o++) {
    if (ops[o].kind == MPM_IMPLICIT) return PETSC_FALSE;
    if (ops[o].kind == MPM_DIV && f->particle_ranks[ops[o].src] == MPM_TENSOR) force = PETSC_TRUE;
  }
  return force;
}

static PetscErrorCode Check(const MpmSettings *settings, const MpmScene *scene, const char option[], PetscReal value)
{
  PetscFunctionBegin;
  if (value == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRequire(settings, scene, option, HasForce, "explicit force of a stress that it could join"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A viscosity in units of rho c h. */
static PetscErrorCode Scaled(const MpmSettings *settings, const MpmScene *scene, const char option[], PetscReal *value)
{
  PetscFunctionBegin;
  PetscCall(Check(settings, scene, option, *value));
  MpmSettingsRefuseIf(*value != 0 && scene->layout.dim > 1 && MpmSpaceIsPrestressed(&scene->scheme.space), settings,
                      option, "allowed: with dim 1, without a prestress, or with kinematics finite");
  if (*value == 0 || !MpmSceneIsPhysical(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(!(scene->density > 0), settings, option,
                      "in physical units a viscosity needs the density; allowed: with density");
  *value /= scene->density * scene->wave_speed * scene->cell_width;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   What a stress of the velocity's gradient depends on, in units of the step: largest is the largest viscosity of a law
   that has one.
*/
static PetscErrorCode ReadViscous(const MpmSettings *settings, MpmScene *scene, PetscReal largest)
{
  MpmMaterialNumbers *m    = &scene->scheme.space.material;
  const PetscReal     rate = scene->wave_speed / scene->cell_width, index = scene->plastic[MPM_FLOW_INDEX];

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(m->artificial, scene->artificial, 2));
  PetscCall(Check(settings, scene, "artificial_linear", m->artificial[0]));
  PetscCall(Check(settings, scene, "artificial_quadratic", m->artificial[1]));
  if (!scene->law->viscous) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(!(largest > 0), settings, "material",
                      "below its yield stress it has its largest viscosity; allowed: with shear_viscosity above 0");
  m->viscosity = largest;
  if (MpmSceneIsPhysical(scene))
    m->plastic[MPM_CONSISTENCY] *= pow(rate, index) / (scene->density * PetscSqr(scene->wave_speed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadDamping(const MpmSettings *settings, MpmScene *scene)
{
  MpmSpace       *space = &scene->scheme.space;
  const PetscReal nu    = space->finite && !scene->law->solid ? 0.5 : space->poisson,
                  mu    = scene->layout.dim == 1 ? 0 : (1 - 2 * nu) / (2 * (1 - nu));
  PetscReal solid = scene->viscosity, fluid = scene->shear_viscosity, bulk = scene->bulk_viscosity;

  PetscFunctionBegin;
  PetscCall(Check(settings, scene, "grid_damping", scene->grid_damping));
  PetscCall(Check(settings, scene, "local_damping", space->local));
  PetscCall(Scaled(settings, scene, "viscosity", &solid));
  PetscCall(Scaled(settings, scene, "shear_viscosity", &fluid));
  PetscCall(Scaled(settings, scene, "bulk_viscosity", &bulk));
  PetscCall(ReadViscous(settings, scene, fluid));
  if (scene->law->viscous) fluid = 0;
  space->damping      = scene->grid_damping * (MpmSceneIsPhysical(scene) ? scene->cell_width / scene->wave_speed : 1);
  space->viscous[0]   = solid * (1 - 2 * mu) - 2 * fluid / 3 + bulk;
  space->viscous[1]   = solid * mu + fluid;
  space->proportional = (fluid == 0 && bulk == 0) || scene->layout.dim == 1 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
