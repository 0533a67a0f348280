/* What a run is asked of its tangent, and whether its scheme has one. */
#include "scene/settings.h"

const char *const MpmTangentNames[] = {"none", "random", "mode", NULL};

/* Why the step of a scene has no tangent here, or NULL where it has one. */
static const char *WhyNot(const MpmScene *scene)
{
  if (!scene->scheme.space.finite) return "the step is linear, and is its own tangent; allowed: with kinematics finite";
  if (scene->scheme.space.local != 0)
    return "with local_damping the step has no derivative where a velocity is 0; allowed: without local_damping";
  if (scene->scheme.numbers.rk_relax)
    return "with rk_relax a step has a factor, which has no derivative where it comes to 1; allowed: without rk_relax";
  if (scene->scheme.numbers.rk_places == MPM_RK_STAGES && scene->body_force)
    return "with rk_places stages a body force is also that of other times than the step's; allowed: rk_places frozen";
  if (MpmTableHas(scene->scheme.table, MPM_SOLVE))
    return "transfer nullspace has a pseudoinverse, whose derivative is not known here; allowed: another transfer";
  if (MpmBasisIsAltered(scene->scheme.basis))
    return "with spline_ends modified or open the derivatives of its weights are not known here; allowed: spline_ends "
           "mirror";
  return NULL;
}

/* The task spectrum marches a scene of finite kinematics to the state that it looks at, and others not at all. */
static PetscErrorCode CheckSpectrum(const MpmSettings *settings, const MpmScene *scene)
{
  PetscFunctionBegin;
  if (scene->scheme.space.finite)
    PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_SCENE, "measure,nodal,neighbourhood,modes",
                                   "it is of a linear step; allowed: with kinematics linear"));
  else
    PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_COMMAND_LINE,
                                   "initial,mode,polarisation,amplitude,gravity,at_step",
                                   "the spectrum of a linear step does not depend on it; allowed: with task run, or "
                                   "with kinematics finite"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses more numbers of a state than PETSC_MAX_INT. Of each place there are a cell and a place in the cell. */
static PetscErrorCode CheckUnknowns(const MpmSettings *settings, const MpmScene *scene, const char option[])
{
  const PetscInt64 each = 2 * scene->layout.dim + scene->scheme.table->nstate;

  PetscFunctionBegin;
  if (scene->layout.particles <= PETSC_MAX_INT / each) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRefuse(
      settings, option, "too many particles for a tangent, %" PetscInt64_FMT "; allowed: at most %" PetscInt64_FMT,
      scene->layout.particles, PETSC_MAX_INT / each));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadTangent(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  const PetscBool frozen = strcmp(request->task, "spectrum") ? PETSC_FALSE : PETSC_TRUE;
  const char     *why    = WhyNot(scene);

  PetscFunctionBegin;
  MpmSettingsRefuseIf(request->tangent && why, settings, "tangent", "%s", why);
  if (request->tangent) PetscCall(CheckUnknowns(settings, scene, "tangent"));
  if (frozen) PetscCall(CheckSpectrum(settings, scene));
  MpmSettingsRefuseIf(frozen && why && scene->scheme.space.finite, settings, "kinematics", "%s", why);
  if (frozen && scene->scheme.space.finite) PetscCall(CheckUnknowns(settings, scene, "kinematics"));
  if (!request->tangent)
    PetscCall(MpmSettingsRefuseAny(settings, MPM_FROM_SCENE, "window,exponents,warn_above",
                                   "nothing reads it here; allowed: with tangent"));
  MpmSettingsRefuseIf((PetscInt64)request->exponents >
                          (scene->layout.dim + scene->scheme.table->nstate) * scene->layout.particles,
                      settings, "exponents", "allowed: no more than places and fields of all particles");
  PetscFunctionReturn(PETSC_SUCCESS);
}
