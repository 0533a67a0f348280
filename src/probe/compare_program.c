/*
   The option compare has keys of a scene, as formulation=usl,transfer=apic,courant=0.5. What it leaves open is taken
   from the code: dimension, particles in a cell and their offset, drift, and with a wave speed or moduli the time step
   and the width of a cell.
*/
#include "probe/compare_program.h"
#include "analysis/waves.h"
#include "base/progress.h"
#include "probe/program_scene.h"
#include "scene/settings.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>

#define CELLS 16      /* of the scene, whose blocks do not depend on them */
#define OFFSETS 10000 /* largest denominator of an offset */

/* ---- the scene ---- */

/* Whether the option says a key. */
static PetscBool Says(const char text[], const char key[])
{
  return MpmKeysSay(text, (const char *const[]){key, NULL});
}

/* The place in its cell of a particle of the first cell. A place just below a face is on it. */
static PetscReal PlaceIn(const MpmProgram *p, PetscInt site, PetscInt a)
{
  const MpmStepper *s  = p->stepper;
  const PetscReal   at = s->base[p->lattice.particle[site] * s->width + s->fields[s->place].first + a] / s->cell_width;

  return PetscMax(at - floor(at + p->probe.near), 0);
}

/* How many different places there are along a direction, and the first of them. */
static PetscInt CountPlaces(const MpmProgram *p, PetscInt a, PetscReal *first)
{
  PetscInt count = 0;

  *first = 1;
  for (PetscInt k = 0; k < p->lattice.sites; k++) {
    PetscBool seen = PETSC_FALSE;

    for (PetscInt l = 0; l < k; l++)
      if (PetscAbsReal(PlaceIn(p, k, a) - PlaceIn(p, l, a)) <= p->probe.near) seen = PETSC_TRUE;
    count += !seen;
    *first = PetscMin(*first, PlaceIn(p, k, a));
  }
  return count;
}

/* Particles in a cell, and their offset, of places. Of cells alone as many in each direction, where that fits. */
static PetscErrorCode AddParticles(const MpmProgram *p, const char text[], MpmText *yaml)
{
  static const char *const counts[] = {"ppc", "counts", NULL};
  const MpmStepper        *s        = p->stepper;
  const PetscInt           root     = (PetscInt)lround(pow(p->lattice.sites, 1.0 / s->dim));
  MpmText                  ppc = {NULL, 0}, offset = {NULL, 0};

  PetscFunctionBegin;
  for (PetscInt a = 0; a < s->dim; a++) {
    PetscReal   first   = 0.5 / root;
    PetscInt    count   = s->place == MPM_NONE ? root : CountPlaces(p, a, &first);
    MpmFraction near    = MpmFractionNearest(first * count, OFFSETS);
    const char *between = a ? "," : "";

    PetscCall(MpmTextAdd(&ppc, "%s%" PetscInt_FMT, between, count));
    if (PetscAbsReal(near.value - first * count) <= p->probe.near * count)
      PetscCall(MpmTextAdd(&offset, "%s%" PetscInt64_FMT "/%" PetscInt64_FMT, between, near.num, near.den));
    else
      PetscCall(MpmTextAdd(&offset, "%s%.17g", between, (double)(first * count)));
  }
  if (!MpmKeysSay(text, counts)) PetscCall(MpmTextAdd(yaml, "ppc: %s\n", ppc.text));
  if (!Says(text, "offset")) PetscCall(MpmTextAdd(yaml, "offset: %s\n", offset.text));
  MpmTextFree(&ppc);
  MpmTextFree(&offset);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The time step, if a Courant number is not given and waves have a speed; and the drift. */
static PetscErrorCode AddStep(const MpmProgram *p, const char text[], MpmText *yaml)
{
  static const char *const speeds[] = {"wave_speed", "sound_speed", "young", "bulk", NULL};
  static const char *const widths[] = {"length", "cell_width", NULL};
  static const char *const moves[]  = {"drift", "velocity", "mach", NULL};
  const MpmStepper        *s        = p->stepper;
  const char              *name     = p->request->program_dt[0] ? p->request->program_dt : "dt";
  PetscReal                dt       = NAN;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->nparameters; i++)
    if (!strcmp(s->parameters[i].name, name)) dt = s->parameters[i].now;
  MpmCheckInput(
      Says(text, "courant") || MpmKeysSay(text, speeds),
      "-compare %.200s: how far waves go in a step is not known; allowed: with courant, or with wave_speed, or "
      "with young and density, in the code's units",
      text);
  if (!MpmKeysSay(text, widths) && MpmKeysSay(text, speeds))
    PetscCall(MpmTextAdd(yaml, "cell_width: %.17g\n", (double)s->cell_width));
  if (!Says(text, "courant") && !Says(text, "dt")) {
    MpmCheckInput(dt > 0,
                  "-compare %.200s: the code has no parameter %s above 0, which would be its time step; allowed: "
                  "with courant or dt",
                  text, name);
    PetscCall(MpmTextAdd(yaml, "dt: %.17g\n", (double)dt));
  }
  if (MpmKeysSay(text, moves)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < s->dim; a++)
    PetscCall(
        MpmTextAdd(yaml, "%s%" PetscInt_FMT "/%" PetscInt_FMT, a ? "," : "drift: ", p->probe.shift[a], p->probe.steps));
  PetscCall(MpmTextAdd(yaml, "\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MakeScene(const MpmProgram *p, MpmScene **scene)
{
  const char *text = p->request->compare;
  MpmText     yaml = {NULL, 0};

  PetscFunctionBegin;
  PetscCall(MpmKeysAdd("compare", text, &yaml));
  if (!Says(text, "dim")) PetscCall(MpmTextAdd(&yaml, "dim: %" PetscInt_FMT "\n", p->stepper->dim));
  if (!Says(text, "cells")) PetscCall(MpmTextAdd(&yaml, "cells: %d\n", CELLS));
  PetscCall(AddParticles(p, text, &yaml));
  PetscCall(AddStep(p, text, &yaml));
  PetscCall(MpmSceneFromNamedText("-compare", yaml.text, scene));
  MpmTextFree(&yaml);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the two sides ---- */

static PetscErrorCode OwnSide(const MpmScene *scene, const MpmBlocks *blocks, MpmMatchSide *side)
{
  const MpmTable *t = scene->scheme.table;

  PetscFunctionBegin;
  *side = (MpmMatchSide){.blocks = blocks, .sites = blocks->size / t->nstate, .width = t->nstate};
  PetscCall(PetscMalloc1(side->sites, &side->site));
  for (PetscInt k = 0; k < side->sites; k++) side->site[k] = k;
  for (PetscInt r = 0; r < t->nstate; r++) {
    MpmMatchField *field = &side->fields[PetscMax(side->nfields - 1, 0)];
    const PetscInt of    = t->field[r];

    if (r == 0 || of != t->field[r - 1]) {
      field = &side->fields[side->nfields++];
      (void)snprintf(field->name, PetscMin(strcspn(t->fields[r], "_") + 1, sizeof field->name), "%s", t->fields[r]);
      field->first = r;
      if (of == MPM_NONE)
        field->kind = MPM_MATCH_MATRIX;
      else if (scene->scheme.formulation->particle_ranks[of] == MPM_TENSOR)
        field->kind = MPM_MATCH_TENSOR;
    }
    field->size++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The site of ours at which a particle of the code is, or MPM_NONE. */
static PetscInt SiteOf(const MpmProgram *p, const MpmLayout *layout, PetscInt k)
{
  PetscInt site = 0;

  if (p->stepper->place == MPM_NONE) return k;
  for (PetscInt a = p->stepper->dim - 1; a >= 0; a--) {
    const PetscReal j = PlaceIn(p, k, a) * layout->ppc[a] - layout->offset[a].value;

    if (PetscAbsReal(j - rint(j)) > p->probe.near * layout->ppc[a] || rint(j) < 0 || rint(j) >= layout->ppc[a])
      return MPM_NONE;
    site = site * layout->ppc[a] + (PetscInt)rint(j);
  }
  return site;
}

/* Their sites in the order of ours. */
static PetscErrorCode TheirSites(const MpmProgram *p, const MpmScene *scene, MpmMatchSide *side)
{
  const MpmStepper *s   = p->stepper;
  PetscInt          ppc = 1, all = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < scene->layout.dim; a++) ppc *= scene->layout.ppc[a];
  *side = (MpmMatchSide){.sites = p->lattice.sites};
  PetscCall(PetscCalloc1(side->sites, &side->site));
  for (PetscInt k = 0; k < side->sites; k++) {
    const PetscInt site = ppc == side->sites && s->dim == scene->layout.dim ? SiteOf(p, &scene->layout, k) : MPM_NONE;

    if (site != MPM_NONE) side->site[site] = k;
    all += site != MPM_NONE;
  }
  MpmCheckInput(all == side->sites,
                "-compare %.200s: the %" PetscInt_FMT
                " particles in a cell of the code are not where those of this scene "
                "are; allowed: ppc and offset of the code, or a code whose particles are equally spaced",
                p->request->compare, side->sites);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Their operator, and its fields without the numbers that are set apart. */
static void TheirFields(const MpmProgram *p, const MpmBlocks *blocks, MpmMatchSide *side)
{
  const MpmStepper *s = p->stepper;

  side->blocks = blocks;
  side->width  = p->unread.n;
  for (PetscInt f = 0; f < s->nfields && side->nfields < MPM_MATCH_WIDTH; f++) {
    MpmMatchField *field = &side->fields[side->nfields];

    for (PetscInt c = 0; c < s->fields[f].size; c++) field->size += !p->unread.apart[s->fields[f].first + c];
    if (!field->size) continue;
    (void)snprintf(field->name, sizeof field->name, "%s", s->fields[f].name);
    if (side->nfields) field->first = field[-1].first + field[-1].size;
    side->nfields++;
  }
}

/* ---- the comparison ---- */

static PetscErrorCode GrowthOf(const MpmBlocks *blocks, PetscReal *growth)
{
  static const PetscInt phases[MPM_MAX_DIM] = {16, 16, 16};
  PetscReal             beta[MPM_MAX_DIM];
  MpmSource             source;
  MpmSourceGrowth       at;

  PetscFunctionBegin;
  PetscCall(MpmBlocksSource(blocks, "compare", &source));
  PetscCall(MpmWorstPhase(PETSC_COMM_WORLD, &source, phases, beta, &at));
  *growth = at.growth;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compares the code with one more scheme, and lists it if it is the same. */
static PetscErrorCode TryScheme(MpmCompareProgram *c, const MpmScheme *scheme, MpmMatch *match)
{
  const MpmScene *scene = c->scene;
  MpmScene        like  = *scene;
  MpmBlocks       blocks;
  MpmMatchSide    side;

  PetscFunctionBegin;
  like.scheme = *scheme;
  PetscCall(MpmTableBlocks(PETSC_COMM_WORLD, &scene->layout, scheme, &scene->step, "compare", &blocks));
  PetscCall(OwnSide(&like, &blocks, &side));
  PetscCall(MpmMatchFind(&side, &c->theirs, c->bound, match));
  if (match->fits && match->differ <= c->bound && c->nsame < MPM_COMPARE_SAME)
    (void)snprintf(c->same_as[c->nsame++], sizeof c->same_as[0], "formulation=%s,transfer=%s,basis=%s",
                   scheme->formulation->name, scheme->transfer->name, scheme->basis->name);
  PetscCall(PetscFree(side.site));
  PetscCall(MpmBlocksFree(&blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   What else the code could be: formulations and transfers that keep as many numbers, and in one dimension every basis.
*/
static PetscErrorCode Seek(MpmCompareProgram *c)
{
  MpmScheme   scheme = c->scene->scheme;
  MpmMatch   *match;
  MpmProgress progress;
  PetscInt    tried = 0;

  PetscFunctionBegin;
  PetscCall(PetscNew(&match));
  PetscCall(MpmProgressBegin("schemes compared", &progress));
  for (PetscInt b = 0; MpmBases[b]; b++)
    for (PetscInt f = 0; MpmFormulations[f]; f++)
      for (PetscInt t = 0; MpmTransfers[t]; t++) {
        if (!MpmSchemeCombines(MpmFormulations[f], MpmTransfers[t])) continue;
        if (c->scene->layout.dim > 1 && MpmBases[b] != c->scene->scheme.basis) continue;
        scheme.formulation = MpmFormulations[f];
        scheme.transfer    = MpmTransfers[t];
        scheme.basis       = MpmBases[b];
        PetscCall(MpmTableCreate(scheme.formulation, scheme.transfer, &scheme.numbers, &scheme.space, &scheme.table));
        if (scheme.table->nstate == c->theirs.width) PetscCall(TryScheme(c, &scheme, match));
        PetscCall(MpmTableDestroy(&scheme.table));
        PetscCall(MpmProgressUpdate(&progress, ++tried, 0));
      }
  PetscCall(MpmProgressEnd(&progress));
  PetscCall(PetscFree(match));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCompareProgramBegin(const MpmProgram *p, MpmCompareProgram *c)
{
  const MpmScene *scene;

  PetscFunctionBegin;
  MpmCheckInput(!p->why[0],
                "-compare: only cells that are alike can be compared, and of the code they are not (%s); "
                "allowed: without compare",
                p->why);
  *c = (MpmCompareProgram){.bound = p->tolerance};
  PetscCall(MakeScene(p, &c->scene));
  scene = c->scene;
  PetscCall(TheirSites(p, scene, &c->theirs));
  PetscCall(MpmTableBlocks(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, "compare", &c->blocks));
  MpmCheckInput(c->blocks.period == p->probe.steps,
                "-compare: the operator of the code is of %" PetscInt_FMT " steps, that of the scene of %" PetscInt_FMT
                "; allowed: a scene with the drift of the code",
                p->probe.steps, c->blocks.period);
  PetscCall(OwnSide(scene, &c->blocks, &c->own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCompareProgramFind(const MpmProgram *p, const MpmBlocks *blocks, PetscReal growth,
                                     MpmCompareProgram *c)
{
  PetscFunctionBegin;
  TheirFields(p, blocks, &c->theirs);
  PetscCall(PetscNew(&c->match));
  PetscCall(MpmMatchFind(&c->own, &c->theirs, c->bound, c->match));
  c->same = (c->match->fits ? c->match->differ : c->match->factors) <= c->bound ? PETSC_TRUE : PETSC_FALSE;
  if (!c->same) PetscCall(Seek(c));
  PetscCall(GrowthOf(&c->blocks, &c->growth));
  c->code = growth;
  if (isnan(growth)) PetscCall(GrowthOf(blocks, &c->code));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCompareProgramDestroy(MpmCompareProgram *c)
{
  PetscFunctionBegin;
  PetscCall(MpmSceneDestroy(&c->scene));
  PetscCall(MpmBlocksFree(&c->blocks));
  PetscCall(PetscFree(c->own.site));
  PetscCall(PetscFree(c->theirs.site));
  PetscCall(PetscFree(c->match));
  PetscFunctionReturn(PETSC_SUCCESS);
}
