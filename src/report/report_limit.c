/*
   A limit of the Courant number as a time step of a scene in physical units, and how far the scene's own time step is
   from it.
*/
#include "report/report.h"
#include <mpmstab/critical.h>
#include <math.h>

#define NEAR_LIMIT 0.005 /* this near to the limit three digits of the ratio do not tell on which side a step is */

static void PrintGrowth(PetscReal tolerance, PetscReal growth)
{
  if (isinf(growth))
    MpmPrint(": growth per step is beyond the range of doubles");
  else if (growth > 1 + tolerance)
    MpmPrint(": it grows by a factor of %.6g per step", growth);
  else if (!isnan(growth))
    MpmPrint(", but growth is still within tolerance");
}

void MpmReportWindows(json_t *result, PetscInt blanks, PetscReal courant, const MpmCriticalWindows *windows)
{
  const PetscBool said = courant > 0 ? PETSC_TRUE : PETSC_FALSE;

  if (!windows->looked) return;
  MpmResultKeep(result, "%" PetscInt_FMT "{looked_at}", windows->looked);
  (void)MpmResultList(result, "windows");
  for (PetscInt i = 0; i < windows->n; i++) {
    const MpmCriticalWindow *w = &windows->window[i];

    if (said)
      MpmPrint("%*sbelow that there is growth from %.6g to %.6g, by a factor of up to %.9g per step, at %.6g\n",
               (int)blanks, "", w->from, w->to, w->growth, w->at);
    (void)json_array_append_new(MpmResultList(result, "windows"), json_pack("[f, f, f]", w->from, w->to, w->growth));
  }
  if (said)
    MpmPrint("%*s%sgrowth was looked at for %" PetscInt_FMT
             " Courant numbers; a window between two of them is missed\n",
             (int)blanks, "", windows->n ? "" : "below that there is no growth; ", windows->looked);
}

void MpmReportLimit(const MpmScene *scene, PetscReal tolerance, PetscReal courant, PetscReal growth, PetscBool windows)
{
  const PetscReal   limit = MpmSceneTimeStep(scene, courant), ratio = scene->step.courant / courant;
  const char *const name = MpmSceneDrifts(scene) ? "largest dt with growth within tolerance" : "largest stable dt";

  if (!MpmSceneIsPhysical(scene) || isnan(courant)) return;
  if (isinf(courant)) {
    MpmPrint("%s: none up to %.6g is unstable%s\n", name, MpmSceneTimeStep(scene, MPM_CRITICAL_TO),
             windows ? ", but for windows of growth" : "");
    return;
  }
  MpmPrint("%s: %.6g%s\n", name, limit, windows ? ", with windows of growth below it" : "");
  if (!MpmSceneHasStep(scene)) return;
  if (courant == 0)
    MpmPrint("dt %.6g is beyond it", scene->dt);
  else
    MpmPrint("dt %.6g is %.*g %s %.6g", scene->dt, fabs(ratio - 1) < NEAR_LIMIT ? 6 : 3, ratio,
             ratio <= 1 ? "of the limit" : "times the limit", limit);
  if (ratio > 1 || growth > 1 + tolerance) PrintGrowth(tolerance, growth);
  MpmPrint("\n");
}
