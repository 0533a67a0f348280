/* Where particles start: how many in which cells, and where in them. */
#include <mpmstab/scene.h>

#define MOST_PARTICLES (PETSC_MAX_INT / 2)

void MpmSceneSetPpc(MpmScene *scene, PetscInt ppc)
{
  scene->ppc              = ppc;
  scene->half_width       = 0.5 / ppc;
  scene->counts.of[0]     = ppc;
  scene->counts.before[1] = ppc;
  scene->sites = scene->particles = (PetscInt64)scene->cells * ppc;
}

/* With counts ppc is that of the fullest cell. */
static PetscErrorCode ReadCounts(const MpmSettings *settings, MpmScene *scene)
{
  MpmCounts *c = &scene->counts;
  PetscInt64 ppc;

  PetscFunctionBegin;
  if (MpmSettingsGiven(settings, "counts"))
    PetscCall(MpmSettingsList(settings, "counts", MPM_MAX_COUNTS, &c->n, c->of));
  else {
    PetscCall(MpmSettingsInteger(settings, "ppc", &ppc));
    c->n     = 1;
    c->of[0] = (PetscInt)ppc;
  }
  for (PetscInt r = 0; r < c->n; r++) {
    scene->ppc       = PetscMax(scene->ppc, c->of[r]);
    c->before[r + 1] = c->before[r] + c->of[r];
    c->voids         = c->voids || (!c->of[r] && r < scene->cells) ? PETSC_TRUE : PETSC_FALSE;
  }
  scene->sites = scene->cells / c->n * c->before[c->n] + c->before[scene->cells % c->n];
  if (!scene->sites) PetscCall(MpmSettingsRefuse(settings, "counts", "there is no particle; allowed: at least one"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsLayout(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(ReadCounts(settings, scene));
  if (scene->sites > MOST_PARTICLES)
    PetscCall(MpmSettingsRefuse(settings,
                                MpmSettingsGiven(settings, "counts") ? "counts"
                                : MpmSettingsSource(settings, "ppc") ? "ppc"
                                                                     : "cells",
                                "cells times ppc is too large; allowed: at most 1073741823 particles"));
  scene->particles  = scene->sites;
  scene->half_width = 0.5 / scene->ppc;
  if (scene->counts.n > 1 && scene->basis->wide)
    PetscCall(MpmSettingsRefuse(settings, "counts",
                                "particles of different width; allowed: with another basis than gimp, or ppc"));
  PetscCall(MpmSettingsFraction(settings, "offset", &scene->offset));
  PetscCall(MpmSettingsReal(settings, "jitter", &scene->jitter));
  PetscCall(MpmSettingsInteger(settings, "seed", &scene->seed));
  PetscCall(MpmSettingsRange(settings, "cluster", scene->cluster));
  if (!(scene->cluster[0] >= 0 && scene->cluster[1] <= 1))
    PetscCall(MpmSettingsRefuse(settings, "cluster", "allowed: a part lo,hi of a cell, 0 <= lo <= hi <= 1"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
