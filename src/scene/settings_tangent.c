/* What a run is asked of its tangent, and whether its scheme has one. */
#include "scene/settings.h"

const char *const MpmTangentNames[] = {"none", "random", "mode", NULL};

/* Why the step of a scene has no tangent here, or NULL where it has one. */
static const char *WhyNot(const MpmScene *scene)
{
  if (!scene->scheme.space.finite) return "the step is linear, and is its own tangent; allowed: with kinematics finite";
  if (MpmTableSolves(scene->scheme.table))
    return "transfer nullspace has a pseudoinverse, whose derivative is not known here; allowed: another transfer";
  if (MpmBasisIsAltered(scene->scheme.basis))
    return "with spline_ends modified or open the derivatives of its weights are not known here; allowed: spline_ends "
           "mirror";
  return NULL;
}

/* The task spectrum marches a scene of finite kinematics to the state that it looks at, and others not at all. */
static PetscErrorCode CheckSpectrum(const MpmSettings *settings, const MpmScene *scene)
{
  static const char *const linear[] = {"measure", "nodal", "neighbourhood", "modes"}, *const states[] = {
                                                                                          "initial",      "mode",
                                                                                          "polarisation", "amplitude",
                                                                                          "gravity",      "at_step"};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(linear) && scene->scheme.space.finite; i++)
    if (MpmSettingsSource(settings, linear[i]) != MPM_FROM_DEFAULT)
      PetscCall(MpmSettingsRefuse(settings, linear[i], "it is of a linear step; allowed: with kinematics linear"));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(states) && !scene->scheme.space.finite; i++)
    if (MpmSettingsSource(settings, states[i]) == MPM_FROM_COMMAND_LINE)
      PetscCall(
          MpmSettingsRefuse(settings, states[i],
                            "the spectrum of a linear step does not depend on it; allowed: with task run, or with "
                            "kinematics finite"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses more numbers of a state than PETSC_MAX_INT. Of each place there are a cell and a place in the cell. */
static PetscErrorCode CheckUnknowns(const MpmSettings *settings, const MpmScene *scene, const char option[])
{
  const PetscInt64 each = 2 * scene->layout.dim + scene->scheme.table->nstate;
  char             why[128];

  PetscFunctionBegin;
  if (scene->layout.particles <= PETSC_MAX_INT / each) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(why, sizeof why,
                          "too many particles for a tangent, %" PetscInt64_FMT "; allowed: at most %" PetscInt64_FMT,
                          scene->layout.particles, PETSC_MAX_INT / each));
  PetscCall(MpmSettingsRefuse(settings, option, why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadTangent(const MpmSettings *settings, const MpmScene *scene, MpmRequest *request)
{
  static const char *const options[] = {"window", "exponents", "warn_above"};
  const PetscBool          frozen    = strcmp(request->task, "spectrum") ? PETSC_FALSE : PETSC_TRUE;
  const char              *why       = WhyNot(scene);
  PetscInt                 word;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "tangent", &word));
  request->tangent = (MpmTangentKind)word;
  if (request->tangent && why) PetscCall(MpmSettingsRefuse(settings, "tangent", why));
  if (request->tangent) PetscCall(CheckUnknowns(settings, scene, "tangent"));
  if (frozen) PetscCall(CheckSpectrum(settings, scene));
  if (frozen && why && scene->scheme.space.finite) PetscCall(MpmSettingsRefuse(settings, "kinematics", why));
  if (frozen && scene->scheme.space.finite) PetscCall(CheckUnknowns(settings, scene, "kinematics"));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(options) && !request->tangent; i++)
    if (MpmSettingsSource(settings, options[i]) != MPM_FROM_DEFAULT)
      PetscCall(MpmSettingsRefuse(settings, options[i], "nothing reads it here; allowed: with tangent"));
  if ((PetscInt64)request->exponents > (scene->layout.dim + scene->scheme.table->nstate) * scene->layout.particles)
    PetscCall(MpmSettingsRefuse(settings, "exponents", "allowed: no more than places and fields of all particles"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
