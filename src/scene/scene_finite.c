/*
   Finite deformation: which scenes can have it, and the material, stretch and gravity of one that does.

   The wave speed c of such a scene is that of the uniform stretch which it starts from, as about a prestress. So Courant
   number and drift mean the same as in the linear scheme about that state.
*/
#include "scene/settings.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const MpmKinematicsNames[] = {"linear", "finite", NULL};

static PetscBool HasMove(const MpmFormulation *f)
{
  PetscInt stresses = 0;

  for (PetscInt field = 0; f->particle_fields[field]; field++) {
    if (f->particle_ranks[field] == MPM_SCALAR) return PETSC_FALSE;
    stresses += f->particle_ranks[field] == MPM_TENSOR && !f->scratch[field];
  }
  return stresses == 1 && MpmFormulationHas(f, MPM_MOVE) && MpmFormulationHas(f, MPM_DRIFT) ? PETSC_TRUE : PETSC_FALSE;
}

/* Whether an operation is one of the two that set the stress of a stage to that of the state. */
static PetscBool SetsStage(const MpmFormulation *f, const MpmOp *op)
{
  if (!f->scratch[op->dst] || op->coefficient) return PETSC_FALSE;
  if (op->kind == MPM_SCALE) return op->factor == 0 && op[1].kind == MPM_ADD && op[1].dst == op->dst;
  return op->kind == MPM_ADD && op->factor == 1 && !f->scratch[op->src] && op[-1].kind == MPM_SCALE &&
                 op[-1].dst == op->dst
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/*
   Whether an operation reads or writes a stress of the particles otherwise than DIV and GRAD to and from a vector, and to
   set that of a stage.
*/
static PetscBool TouchesStress(const MpmFormulation *f, const MpmOp *op)
{
  const MpmRank *particle = f->particle_ranks, *node = f->node_ranks;
  MpmOpTraits    traits;

  if (op->kind == MPM_DIV) return particle[op->src] != MPM_TENSOR || node[op->dst] != MPM_VECTOR;
  if (op->kind == MPM_GRAD) return particle[op->dst] != MPM_TENSOR || node[op->src] != MPM_VECTOR;
  if (op->kind == MPM_FILTER || op->kind == MPM_FILTER_BEFORE || op->kind == MPM_FILTER_AFTER)
    return particle[op->dst] == MPM_TENSOR;
  if (op->kind >= MPM_OP_KINDS) return PETSC_FALSE;
  traits = MpmOpTraitsOf(op->kind);
  if (traits.dst == MPM_ON_PARTICLES && SetsStage(f, op)) return PETSC_FALSE;
  return (traits.dst == MPM_ON_PARTICLES && particle[op->dst] == MPM_TENSOR) ||
         (traits.src == MPM_ON_PARTICLES && particle[op->src] == MPM_TENSOR);
}

/* At finite deformation F takes the place of the stress, which there is only for the time of a DIV. */
static PetscBool LeavesStress(const MpmFormulation *f)
{
  MpmOp        room[MPM_MOST_TABLE_LINES];
  PetscInt     n;
  const MpmOp *ops;

  if (!HasMove(f)) return PETSC_FALSE;
  ops = MpmFormulationLines(f, NULL, NULL, room, &n);
  for (PetscInt o = 0; o < n; o++)
    if (TouchesStress(f, &ops[o])) return PETSC_FALSE;
  return PETSC_TRUE;
}

/*
   Whether a formulation has no IMPLICIT, or one of which the lines before it are those of the linear system: a force of a
   stress to which GRAD adds a part theta of the step, of a vector with the factor theta^2.
*/
static PetscBool HasSystem(const MpmFormulation *f)
{
  MpmOp        room[MPM_MOST_TABLE_LINES];
  PetscInt     n, solved = 0, grads = 0, divs = 0;
  PetscReal    theta = 0;
  const MpmOp *ops;

  if (!LeavesStress(f)) return PETSC_FALSE;
  ops = MpmFormulationLines(f, NULL, NULL, room, &n);
  for (PetscInt o = 0; o < n; o++) {
    const MpmOp *op = &ops[o];

    if (op->kind == MPM_GRAD && f->scratch[op->dst]) {
      theta = op->factor;
      grads += op->coefficient == MPM_COURANT;
    } else if (op->kind == MPM_DIV && f->scratch[op->src] && !solved)
      divs += op->coefficient == MPM_COURANT && op->factor == -1 && grads == 1;
    else if (op->kind == MPM_IMPLICIT) {
      solved++;
      if (divs != 1 || op->coefficient != MPM_COURANT_SQUARED || fabs(op->factor - theta * theta) > 1e-12)
        return PETSC_FALSE;
    }
  }
  return solved < 2 && (!solved || (grads == 1 && theta > 0)) ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmSettingsReadKinematics(const MpmSettings *settings, MpmScene *scene)
{
  PetscInt word;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "kinematics", &word));
  scene->scheme.space.finite = word ? PETSC_TRUE : PETSC_FALSE;
  if (!word) {
    PetscCall(MpmSettingsRefuseUnless(settings, "gravity", "kinematics", "allowed: only with kinematics finite"));
    PetscCall(MpmSettingsRefuseUnless(settings, "halvings", "kinematics", "allowed: only with kinematics finite"));
    PetscCall(PetscArrayzero(scene->gravity, MPM_MAX_DIM));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmSettingsRequire(settings, scene, "kinematics", HasMove,
                               "stress with a velocity that particles could move with"));
  PetscCall(MpmSettingsRequire(settings, scene, "kinematics", LeavesStress,
                               "stress that it takes to vectors by DIV and from vectors by GRAD alone"));
  PetscCall(MpmSettingsRequire(
      settings, scene, "kinematics", HasSystem,
      "IMPLICIT a_i theta^2 k^2 after one line GRAD, with the factor theta, and one MINUS_DIV of its stress"));
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    if (scene->gravity[a] != 0) scene->scheme.space.loaded = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
    PetscCall(MpmSettingsRefuseUnless(settings, "lame_ratio", rivals[i],
                                      "poisson, or bulk and shear, say it too with dim 2 or 3; allowed: one of them"));
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
   rho0 c^2 of P waves along x about the stretch F, in units of rho0 c0^2. Such a wave has dF = H F with H_xx alone, and the
   force d tau_xx - tau_xx H_xx.
*/
static PetscReal ModulusAlongX(const MpmMaterialNumbers *material, PetscInt dim, const PetscReal F[])
{
  PetscReal        dF[MPM_MOST_STRETCH] = {0}, tau[6], dtau[6], *to[6], *dto[6];
  const PetscReal *from[MPM_MOST_STRETCH], *dfrom[MPM_MOST_STRETCH];

  for (PetscInt a = 0; a < dim; a++) dF[a] = F[a];
  for (PetscInt c = 0; c < MpmMaterialComponents(material->law, dim); c++) {
    from[c]  = &F[c];
    dfrom[c] = &dF[c];
  }
  for (PetscInt c = 0; c < dim * (dim + 1) / 2; c++) {
    to[c]  = &tau[c];
    dto[c] = &dtau[c];
  }
  MpmMaterialStress(material, dim, 1, from, to);
  MpmMaterialTangent(material, dim, 1, from, dfrom, dto);
  return dtau[0] - tau[0];
}

/* The materials that read a number, as a list of words. */
static void ReadersOf(PetscInt number, size_t room, char text[])
{
  size_t used = (size_t)snprintf(text, room, "allowed: only with material ");
  int    n    = 0;

  for (const MpmLaw *const *law = MpmLaws; *law; law++)
    if ((*law)->plastic && (*law)->plastic->number[number].reads)
      used += (size_t)snprintf(text + used, room - used, "%s%s", n++ ? " or " : "", (*law)->name);
}

PetscErrorCode MpmSettingsReadPlastic(const MpmSettings *settings, MpmScene *scene)
{
  const MpmPlastic *law = scene->law->plastic;
  char              text[256];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < MPM_PLASTIC_NUMBERS; i++) {
    const char *name = MpmPlasticNames[i];

    ReadersOf(i, sizeof text, text);
    if (!law || !law->number[i].reads) PetscCall(MpmSettingsRefuseUnless(settings, name, "material", text));
    if (!law || !law->number[i].reads || MpmSettingsGiven(settings, name)) continue;
    scene->plastic[i] = law->number[i].usual;
  }
  for (PetscInt i = 0; i < MPM_PLASTIC_NUMBERS && law; i++)
    MpmSettingsRefuseIf(law->number[i].reads &&
                            !(scene->plastic[i] >= law->number[i].least && scene->plastic[i] <= law->number[i].most),
                        settings, MpmPlasticNames[i], "allowed with material %s: from %g to %g", scene->law->name,
                        (double)law->number[i].least, (double)law->number[i].most);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The steps of a formulation have one stage, so that a particle flows from the state of the step before. */
static PetscBool HasOneStage(const MpmFormulation *f)
{
  for (PetscInt field = 0; f->particle_fields[field]; field++)
    if (f->scratch[field] && f->particle_ranks[field] == MPM_TENSOR) return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscErrorCode MpmSettingsReadFiniteLaw(const MpmSettings *settings, MpmScene *scene)
{
  MpmSpace *space = &scene->scheme.space;
  PetscInt  word, dim                    = scene->layout.dim;
  PetscReal modulus, F[MPM_MOST_STRETCH] = {0};

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "material", &word));
  MpmSettingsRefuseIf(word > 0 && word < MPM_MATERIAL_KINDS, settings, "material",
                      "with kinematics finite all particles are of one material; allowed: uniform (linear in "
                      "the stretch), neo, svk, tait, gas, polytropic, mises, snow or sand");
  scene->law = word < MPM_MATERIAL_KINDS ? &MpmLawLinear : MpmLaws[word - MPM_MATERIAL_KINDS + 1];
  if (!scene->law->solid)
    PetscCall(MpmSettingsRefuseUnless(settings, "lame_ratio", "material", "it is a fluid; allowed: only with a solid"));
  if (!(scene->law->exponent > 0))
    PetscCall(
        MpmSettingsRefuseUnless(settings, "exponent", "material", "allowed: only with material tait or polytropic"));
  PetscCall(MpmSettingsRefuseUnless(settings, "prestress", "kinematics",
                                    "with kinematics finite material and stretch give it; allowed: one of the two"));
  PetscCall(PetscArrayzero(space->prestress, PETSC_STATIC_ARRAY_LENGTH(space->prestress)));
  if (scene->law->exponent > 0 && !MpmSettingsGiven(settings, "exponent")) scene->exponent = scene->law->exponent;
  if (scene->law->solid) PetscCall(SetRatio(settings, scene));
  space->material = MpmMaterialOfRatio(scene->law, scene->law->solid ? scene->lame_ratio : 0, scene->exponent);
  PetscCall(MpmSettingsReadPlastic(settings, scene));
  PetscCall(PetscArraycpy(space->material.plastic, scene->plastic, MPM_PLASTIC_NUMBERS));
  if (scene->law->plastic)
    PetscCall(MpmSettingsRequire(settings, scene, "material", HasOneStage, "steps of one stage, without IMPLICIT"));
  for (PetscInt c = dim * dim; c < MpmMaterialComponents(scene->law, dim); c++)
    (void)MpmMaterialInternal(scene->law, c - dim * dim, &F[c]);
  for (PetscInt a = 0; a < dim; a++) F[(dim + 1) * a] = space->stretch[a] = scene->stretch[a];
  modulus = ModulusAlongX(&space->material, dim, F);
  MpmSettingsRefuseIf(!(modulus > 0) || !isfinite(modulus), settings, "stretch",
                      "the material has no stiffness against more stretch there, so that waves have no speed; "
                      "allowed: a stretch with a stress that rises");
  space->stiffness = 1 / modulus;
  scene->wave_speed *= sqrt(modulus);
  PetscFunctionReturn(PETSC_SUCCESS);
}

const char *const MpmStepBoundNames[] = {"lanczos", "particle", "lone", NULL};

#define SAFETY 0.8      /* measured on runs that fail (examples/warnings) */
#define SAFETY_LESS 0.6 /* the same of transfers with an affine part, and of MLS-MPM's gradient */

PetscErrorCode MpmSettingsReadPace(const MpmSettings *settings, MpmScene *scene)
{
  const PetscBool less =
      scene->scheme.transfer->affine || scene->scheme.space.gradient == MPM_GRADIENT_MLS ? PETSC_TRUE : PETSC_FALSE;
  PetscBool moves = PETSC_FALSE;

  PetscFunctionBegin;
  if (!MpmSettingsIsAlso(settings, "courant")) {
    PetscCall(MpmSettingsRefuseUnless(settings, "safety", "courant", "allowed: only with courant auto"));
    PetscCall(MpmSettingsRefuseUnless(settings, "step_bound", "courant", "allowed: only with courant auto"));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  scene->safety = less ? SAFETY_LESS : SAFETY;
  if (MpmSettingsGiven(settings, "safety")) PetscCall(MpmSettingsReal(settings, "safety", &scene->safety));
  MpmSettingsRefuseIf(!scene->scheme.space.finite, settings, "courant",
                      "the speed of waves changes in a run with kinematics finite alone; allowed: a number, "
                      "or kinematics finite ('mpmstab critical' finds the largest stable number)");
  MpmSettingsRefuseIf(MpmFormulationHas(scene->scheme.formulation, MPM_IMPLICIT), settings, "courant",
                      "an implicit step has no limit that the speed of waves sets; allowed: a number");
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    if (scene->step.drift[a].value != 0) moves = PETSC_TRUE;
  if (moves && MpmSettingsGiven(settings, "drift") && MpmSettingsSource(settings, "drift") != MPM_FROM_DEFAULT)
    PetscCall(MpmSettingsRefuse(
        settings, "drift", "with courant auto no step is known of which it is the way; allowed: velocity or mach"));
  MpmSettingsRefuseIf(scene->stagger, settings, "stagger", "courant auto: steps differ; allowed: false");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The energy that does not rise is that of the particles alone, and of an affine part whose moment is known. */
static PetscErrorCode CheckRelax(const MpmSettings *settings, const MpmScene *scene)
{
  PetscFunctionBegin;
  if (!scene->scheme.numbers.rk_relax) PetscFunctionReturn(PETSC_SUCCESS);
  if (scene->scheme.space.loaded)
    PetscCall(MpmSettingsRefuse(settings, "rk_relax",
                                "a body force does work on the particles, so that their energy may rise; allowed: "
                                "without gravity and with data that have no body force"));
  if (scene->scheme.transfer->affine && scene->scheme.basis->moment == 0)
    PetscCall(MpmSettingsRefuse(settings, "rk_relax",
                                "the moment of the weights, and with it the energy of the affine part, depends on the "
                                "place with this basis; allowed: basis quadratic or cubic, or another transfer"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsCheckFinite(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  if (scene->scheme.space.move)
    PetscCall(MpmSettingsRequire(settings, scene, "move", MpmFormulationIsProjected, "second P2G of the velocity"));
  MpmSettingsRefuseIf(scene->scheme.transfer->same_as && MpmTransferFind(scene->scheme.transfer->same_as)->affine,
                      settings, "transfer",
                      "it moves particles with a velocity of its own, which is not here; allowed: aflip, "
                      "which is linearly the same, or another transfer");
  MpmSettingsRefuseIf(scene->initial == MPM_INITIAL_PULSE || scene->initial == MPM_INITIAL_STEP ||
                          scene->initial == MPM_INITIAL_EIGENMODE,
                      settings, "initial",
                      "allowed with kinematics finite: mode, random, manufactured, vortex, simple_wave, "
                      "shock_tube, collision or uniform");
  PetscCall(MpmSettingsReadSolution(settings, scene));
  PetscCall(CheckRelax(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
