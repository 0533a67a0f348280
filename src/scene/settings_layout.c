/* Where particles start: how many in which cells, and where in them. */
#include <mpmstab/scene.h>

#define MOST_PARTICLES (PETSC_MAX_INT / 2)

/* With counts ppc is that of the fullest cell. */
static PetscErrorCode ReadCounts(const MpmSettings *settings, MpmScene *scene)
{
  MpmCounts *c = &scene->layout.counts;
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
    scene->layout.ppc = PetscMax(scene->layout.ppc, c->of[r]);
    c->before[r + 1]  = c->before[r] + c->of[r];
    c->voids          = c->voids || (!c->of[r] && r < scene->layout.grid.cells) ? PETSC_TRUE : PETSC_FALSE;
  }
  scene->layout.sites = scene->layout.grid.cells / c->n * c->before[c->n] + c->before[scene->layout.grid.cells % c->n];
  if (!scene->layout.sites)
    PetscCall(MpmSettingsRefuse(settings, "counts", "there is no particle; allowed: at least one"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsLayout(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(ReadCounts(settings, scene));
  if (scene->layout.sites > MOST_PARTICLES)
    PetscCall(MpmSettingsRefuse(settings,
                                MpmSettingsGiven(settings, "counts") ? "counts"
                                : MpmSettingsSource(settings, "ppc") ? "ppc"
                                                                     : "cells",
                                "cells times ppc is too large; allowed: at most 1073741823 particles"));
  scene->layout.particles  = scene->layout.sites;
  scene->layout.half_width = 0.5 / scene->layout.ppc;
  if (scene->layout.counts.n > 1 && scene->scheme.basis->wide)
    PetscCall(MpmSettingsRefuse(settings, "counts",
                                "particles of different width; allowed: with another basis than gimp, or ppc"));
  PetscCall(MpmSettingsFraction(settings, "offset", &scene->layout.offset));
  PetscCall(MpmSettingsReal(settings, "jitter", &scene->layout.jitter));
  PetscCall(MpmSettingsInteger(settings, "seed", &scene->layout.seed));
  PetscCall(MpmSettingsRange(settings, "cluster", scene->layout.cluster));
  if (!(scene->layout.cluster[0] >= 0 && scene->layout.cluster[1] <= 1))
    PetscCall(MpmSettingsRefuse(settings, "cluster", "allowed: a part lo,hi of a cell, 0 <= lo <= hi <= 1"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
