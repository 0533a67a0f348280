/* Finite deformation: which scenes can have it, and what else it asks for; and how a run chooses its steps. */
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
   Whether an operation reads or writes a stress of the particles otherwise than DIV and GRAD to and from a vector, and
   to set that of a stage.
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
   Whether a formulation has no IMPLICIT, or one of which the lines before it are those of the linear system: a force of
   a stress to which GRAD adds a part theta of the step, of a vector with the factor theta^2.
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
    scene->watched = scene->scheme.space.finite && MpmSettingsSource(settings, "step_bound") != MPM_FROM_DEFAULT &&
                             MpmSettingsGiven(settings, "step_bound")
                         ? PETSC_TRUE
                         : PETSC_FALSE;
    MpmSettingsRefuseIf(scene->watched && MpmFormulationHas(scene->scheme.formulation, MPM_IMPLICIT), settings,
                        "step_bound",
                        "an implicit step has no limit that the speed of waves sets; allowed: without it");
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
  if (!scene->scheme.numbers.rk_relax) PetscFunctionReturn(PETSC_SUCCESS);
  /* the energy that does not rise is that of the particles alone, and of an affine part whose moment is known */
  MpmSettingsRefuseIf(
      scene->scheme.space.loaded, settings, "rk_relax",
      "a body force does work on the particles, so that their energy may rise; allowed: without gravity "
      "and with data that have no body force");
  MpmSettingsRefuseIf(scene->scheme.transfer->affine && scene->scheme.basis->moment == 0, settings, "rk_relax",
                      "the moment of the weights, and with it the energy of the affine part, depends on the place with "
                      "this basis; allowed: basis quadratic or cubic, or another transfer");
  PetscFunctionReturn(PETSC_SUCCESS);
}
