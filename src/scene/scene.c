/*
   From settings to a scene: reads the fields in the order in which one needs another, forms the numbers that follow
   from them, and refuses what does not exist or does not go together.
*/
#include "base/text.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "scene/settings.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>

/*
   A scheme as text is taken over from the settings. A transfer of its own counts, unless a stronger source names another
   one.
*/
static PetscErrorCode ReadWords(MpmSettings *settings, MpmScene *scene)
{
  PetscInt i;

  PetscFunctionBegin;
  if (!settings->scheme) PetscCall(MpmSettingsWord(settings, "formulation", &i));
  if (!settings->scheme) scene->scheme.formulation = MpmFormulations[i];
  PetscCall(MpmSettingsWord(settings, "basis", &i));
  scene->scheme.basis = MpmBases[i];
  PetscCall(MpmBasisCheck(scene->scheme.basis));
  PetscCall(MpmSettingsWord(settings, "transfer", &i));
  scene->scheme.transfer = MpmTransfers[i];
  if (!settings->scheme) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmWrittenCompile(settings->scheme, 0, NULL, NULL, &scene->own));
  scene->scheme.formulation = scene->own;
  MpmWrittenHash(settings->scheme, scene->scheme_hash);
  PetscCall(MpmWrittenParametersText(settings->scheme, scene->parameters));
  scene->written = settings->scheme;
  if (settings->scheme == settings->inside)
    settings->inside = NULL;
  else
    settings->outside = NULL;
  if (!scene->own->transfer || MpmSettingsOverruled(settings, "scheme", "transfer")) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(MpmSettingsSource(settings, "transfer") == MpmSettingsSource(settings, "scheme"), settings,
                      "transfer", "the scheme has the transfer %.60s of its own; allowed: one of the two",
                      scene->own->transfer->name);
  scene->scheme.transfer = scene->own->transfer;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- scheme ---- */

/* clang-format off */
#define CAN(function, condition) static PetscBool function(const MpmFormulation *f) { return (condition) ? PETSC_TRUE : PETSC_FALSE; }
CAN(CanBeAffine, f->affine != MPM_NONE)
CAN(CanBeFree, f->free_ends)
CAN(CanDiffer, f->materials)
CAN(CanReact, MpmFormulationHas(f, MPM_REACT))
CAN(CanChooseFilter, MpmFormulationHas(f, MPM_FILTER_AFTER))
CAN(HasFilter, MpmFormulationHas(f, MPM_FILTER) || MpmFormulationHas(f, MPM_FILTER_BEFORE) || MpmFormulationHas(f, MPM_FILTER_AFTER))
CAN(HasImpose, MpmFormulationHas(f, MPM_IMPOSE))
CAN(HasGradient, MpmFormulationHas(f, MPM_GRAD))
/* the functions of open knot vectors are not equally far apart, so differences of their values are no Laplacian */
CAN(TakesNoDifferences, !MpmFormulationHas(f, MPM_LAP))
/* clang-format on */

PetscErrorCode MpmSettingsRequire(const MpmSettings *settings, const MpmScene *scene, const char option[],
                                  PetscBool (*can)(const MpmFormulation *), const char why[])
{
  char names[256] = "";

  PetscFunctionBegin;
  if (can(scene->scheme.formulation)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt f = 0; MpmFormulations[f]; f++) {
    if (!can(MpmFormulations[f])) continue;
    if (names[0]) MpmTextJoin(names, ", ", sizeof names);
    MpmTextJoin(names, MpmFormulations[f]->name, sizeof names);
  }
  PetscCall(MpmSettingsRefuse(settings, option, "%s has no %s; allowed: with formulation %s%s",
                              scene->scheme.formulation->name, why, names,
                              scene->written ? ", or a line for that in the scheme" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool TransferReads(PetscInt i, const char option[])
{
  return MpmTransfers[i]->option && !strcmp(MpmTransfers[i]->option, option) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool FormulationReads(PetscInt i, const char option[])
{
  return MpmFormulationReads(MpmFormulations[i], option);
}

/*
   Refuses a number that only some of the words of another option read, transfer or formulation, when the scene has
   another one. has: whether its own reads it.
*/
static PetscErrorCode CheckReads(const MpmSettings *settings, const char option[], const char of[], PetscBool has,
                                 PetscBool (*reads)(PetscInt, const char[]))
{
  const MpmField *words        = &MpmOptions[MpmOptionIndex(of)];
  char            message[128] = "";
  int             named        = 0;

  PetscFunctionBegin;
  if (has || MpmSettingsSource(settings, option) == MPM_FROM_DEFAULT || MpmSettingsOverruled(settings, option, of))
    PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; MpmFieldWord(words, i); i++) {
    if (!reads(i, option)) continue;
    if (named++) MpmTextJoin(message, " or ", sizeof message);
    MpmTextJoin(message, MpmFieldWord(words, i), sizeof message);
  }
  PetscCall(MpmSettingsRefuse(settings, option, "allowed: only with %s %s", of, message));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses the options of formulations and of transfers that the scene's own do not read. */
static PetscErrorCode CheckAllReads(const MpmSettings *settings, const MpmScheme *scheme)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (const char *const *option = MpmFormulations[f]->options; *option; option++)
      PetscCall(CheckReads(settings, *option, "formulation", MpmFormulationReads(scheme->formulation, *option),
                           FormulationReads));
  for (PetscInt t = 0; MpmTransfers[t]; t++) {
    const char *option = MpmTransfers[t]->option, *own = scheme->transfer->option;

    if (option)
      PetscCall(CheckReads(settings, option, "transfer", own && !strcmp(own, option) ? PETSC_TRUE : PETSC_FALSE,
                           TransferReads));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool MpmSceneChoosesFilter(const MpmScene *scene)
{
  return CanChooseFilter(scene->scheme.formulation) && scene->scheme.transfer->filter ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode ReadFilterTime(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  if (MpmSceneChoosesFilter(scene) || !MpmSettingsStands(settings, "pic_filter", "formulation,transfer"))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRequire(settings, scene, "pic_filter", CanChooseFilter, "choice, its filter acts after"));
  PetscCall(MpmSettingsRefuse(settings, "pic_filter", "flip has no filter; allowed: with another transfer"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadTransfer(const MpmSettings *settings, MpmScene *scene)
{
  MpmScheme      *scheme  = &scene->scheme;
  const PetscBool filters = scheme->transfer->filter || scheme->transfer->sharpen ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(CheckAllReads(settings, scheme));
  PetscCall(MpmSettingsFormulationNumbers(settings, scheme->formulation, filters, &scheme->numbers));
  if (scene->scheme.transfer->filter)
    PetscCall(MpmSettingsRequire(settings, scene, "transfer", HasFilter,
                                 "FILTER, which says where other transfers than flip act"));
  PetscCall(ReadFilterTime(settings, scene));
  if (scene->scheme.transfer->affine)
    PetscCall(MpmSettingsRequire(settings, scene, "transfer", CanBeAffine, "momentum to carry an affine velocity"));
  if (MpmSettingsOverruled(settings, "gradient", "formulation") && !HasGradient(scheme->formulation))
    scheme->space.gradient = MPM_GRADIENT_BASIS;
  if (scheme->space.gradient != MPM_GRADIENT_BASIS)
    PetscCall(MpmSettingsRequire(settings, scene, "gradient", HasGradient, "gradient"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void AppendWord(MpmScene *scene, const char between[], MpmEnd end)
{
  MpmTextJoin(scene->boundary, between, sizeof scene->boundary);
  MpmTextJoin(scene->boundary, MpmEndNames[end], sizeof scene->boundary);
}

/* Refuses ends of direction a that the formulation has no condition for, and particles that would leave there. */
static PetscErrorCode CheckEnds(const MpmSettings *settings, const MpmScene *scene, PetscInt a)
{
  const MpmLayout   *l      = &scene->layout;
  const MpmFraction *offset = &l->offset[a];

  PetscFunctionBegin;
  MpmSettingsRefuseIf((l->grid[a].ends[0] == MPM_PERIODIC) != (l->grid[a].ends[1] == MPM_PERIODIC), settings,
                      "boundary", "allowed: periodic at both ends or at none");
  for (int e = 0; e < 2; e++) {
    if (l->grid[a].ends[e] == MPM_FREE)
      PetscCall(MpmSettingsRequire(settings, scene, "boundary", CanBeFree,
                                   "condition for a free end (fixed: a wall reflects)"));
    if (MpmEndIsFixed(l->grid[a].ends[e]))
      PetscCall(
          MpmSettingsRequire(settings, scene, "boundary", HasImpose, "IMPOSE, so that nothing would hold at a wall"));
    if (l->grid[a].ends[e] == MPM_FIXED_REACTION)
      PetscCall(MpmSettingsRequire(settings, scene, "boundary", CanReact, "nodal increment that a wall could add to"));
  }
  if (l->grid[a].ends[0] == MPM_PERIODIC) PetscFunctionReturn(PETSC_SUCCESS);
  MpmCheckInput(scene->step.drift[a].value == 0 || scene->scheme.space.finite,
                "drift %g with boundary %s: particles would leave the domain; allowed: drift 0, or boundary periodic",
                scene->step.drift[a].value, scene->boundary);
  MpmCheckInput(
      offset->value >= l->jitter / 2 && offset->value + l->jitter / 2 <= 1,
      "jitter %g with offset %g and boundary %s: a particle may start beyond the end; allowed: offset - jitter/2 "
      ">= 0 and offset + jitter/2 <= 1",
      l->jitter, offset->value, scene->boundary);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the scene its splines next to walls. Call it when the ends are known. */
static PetscErrorCode ReadSplineEnds(const MpmSettings *settings, MpmScene *scene)
{
  const MpmLayout *l = &scene->layout;
  const MpmBasis  *basis;
  PetscInt         i;

  PetscFunctionBegin;
  if (MpmSettingsSource(settings, "spline_ends") == MPM_FROM_DEFAULT) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsWord(settings, "spline_ends", &i));
  basis = MpmBasisWithEnds(scene->scheme.basis, (MpmSplineEnds)i);
  STANDS("spline_ends", "basis", !MpmBasisWithEnds(scene->scheme.basis, MPM_SPLINES_OPEN),
         "allowed: only with basis quadratic or cubic");
  if (!MpmBasisWithEnds(scene->scheme.basis, MPM_SPLINES_OPEN)) PetscFunctionReturn(PETSC_SUCCESS);
  STANDS("spline_ends", "boundary", MpmLayoutIsPeriodic(l),
         "the domain is periodic and has no ends; allowed: only with another boundary");
  if (MpmLayoutIsPeriodic(l)) PetscFunctionReturn(PETSC_SUCCESS);
  if (basis->spline_ends == MPM_SPLINES_OPEN)
    PetscCall(MpmSettingsRequire(settings, scene, "spline_ends", TakesNoDifferences,
                                 "differences of nodal values with open knot vectors"));
  for (PetscInt a = 0; a < l->dim; a++)
    MpmSettingsRefuseIf(basis->spline_ends == MPM_SPLINES_OPEN && l->grid[a].cells < basis->wall_nodes, settings,
                        "spline_ends",
                        "the grid is too small for it; allowed: as many cells as the degree of the basis");
  scene->scheme.basis = basis;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadBoundary(const MpmSettings *settings, MpmScene *scene)
{
  MpmLayout *l = &scene->layout;
  PetscInt   end[MPM_MAX_DIM][2];

  PetscFunctionBegin;
  PetscCall(MpmSettingsRead(settings, "boundary", MPM_AS_ENDS, l->dim, sizeof end[0], end));
  for (PetscInt a = 0; a < l->dim; a++) {
    for (int e = 0; e < 2; e++) l->grid[a].ends[e] = scene->scheme.space.ends[a][e] = (MpmEnd)end[a][e];
    AppendWord(scene, a ? "," : "", l->grid[a].ends[0]);
    if (l->grid[a].ends[0] != MPM_PERIODIC) AppendWord(scene, l->dim == 1 ? "," : "-", l->grid[a].ends[1]);
  }
  PetscCall(ReadSplineEnds(settings, scene));
  for (PetscInt a = 0; a < l->dim; a++) {
    l->grid[a].nodes = l->grid[a].cells;
    if (l->grid[a].ends[0] != MPM_PERIODIC) l->grid[a].nodes += scene->scheme.basis->wall_nodes;
    PetscCall(CheckEnds(settings, scene, a));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps the particles between two places, which are given in cells and lie between two particles' widths. */
static PetscErrorCode ReadFill(const MpmSettings *settings, MpmScene *scene)
{
  MpmLayout *l = &scene->layout;
  PetscReal  range[MPM_MAX_DIM][2];

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, "fill") || l->counts.n > 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRead(settings, "fill", MPM_AS_RANGE, l->dim, sizeof range[0], range));
  l->particles = 1;
  for (PetscInt a = 0; a < l->dim; a++) {
    const PetscReal first = range[a][0] * l->ppc[a], end = range[a][1] * l->ppc[a];

    MpmSettingsRefuseIf(!(first >= 0 && end <= (PetscReal)l->grid[a].cells * l->ppc[a] && end > first) ||
                            fabs(first - round(first)) > 1e-9 || fabs(end - round(end)) > 1e-9,
                        settings, "fill",
                        "allowed: cells lo,hi within 0 and cells, each a multiple of 1 / ppc, lo < hi");
    l->first[a] = (PetscInt64)round(first);
    l->row[a]   = (PetscInt64)round(end) - l->first[a];
    l->particles *= l->row[a];
  }
  MpmSettingsRefuseIf(!l->particles, settings, "fill",
                      "there is no particle between them; allowed: cells lo,hi at least 1 / ppc apart");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- material ---- */

static PetscErrorCode ReadRatios(const MpmSettings *settings, MpmScene *scene)
{
  const MpmLayout *l = &scene->layout;
  MpmMaterial     *m = &scene->layout.material;

  PetscFunctionBegin;
  PetscCall(MpmSettingsRequire(settings, scene, "material", CanDiffer, "density and stiffness of each particle"));
  for (PetscInt a = 0; a < l->dim; a++) {
    PetscReal *inclusion = m->inclusion[a];

    if (m->kind != MPM_MATERIAL_TWO || !MpmSettingsGiven(settings, "inclusion")) {
      inclusion[0] = a ? 0 : l->grid[a].cells / 2.0;
      inclusion[1] = l->grid[a].cells;
    }
    MpmSettingsRefuseIf(!(inclusion[0] >= 0 && inclusion[0] < inclusion[1] && inclusion[1] <= l->grid[a].cells),
                        settings, "inclusion", "allowed: cells lo,hi within 0 and cells, lo < hi");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadMaterial(const MpmSettings *settings, MpmScene *scene)
{
  PetscBool *varies = scene->layout.varies;
  PetscInt   i;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "material", &i));
  scene->layout.material.kind = i < MPM_MATERIAL_KINDS ? (MpmMaterialKind)i : MPM_MATERIAL_UNIFORM;
  if (scene->layout.material.kind != MPM_MATERIAL_UNIFORM)
    PetscCall(ReadRatios(settings, scene));
  else
    scene->layout.material = (MpmMaterial){.kind = MPM_MATERIAL_UNIFORM, .density = 1, .stiffness = 1};
  if (scene->layout.given) {
    if (scene->layout.given->has[1] || scene->layout.given->has[2] || scene->layout.varies[MPM_MOBILITY])
      PetscCall(MpmSettingsRequire(settings, scene, "layout", CanDiffer, "density and stiffness of each particle"));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  varies[MPM_VOLUME]    = scene->layout.counts.n > 1 ? PETSC_TRUE : PETSC_FALSE;
  varies[MPM_MASS]      = varies[MPM_VOLUME] || scene->layout.material.density != 1 ? PETSC_TRUE : PETSC_FALSE;
  varies[MPM_STIFFNESS] = scene->layout.material.stiffness != 1 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what does not go together ---- */

/* clang-format off */
static PetscErrorCode CheckRules(const MpmSettings *settings, const MpmScene *s)
{
  PetscFunctionBegin;
  STANDS("gravity,halvings,artificial_linear,artificial_quadratic", "kinematics", !s->scheme.space.finite, "allowed: only with kinematics finite");
  STANDS("stretch", "material", !s->scheme.space.finite && s->law == &MpmLawLinear, "allowed: only with material neo, svk, tait, gas or polytropic");
  STANDS("lame_ratio", "material", s->scheme.space.finite && !s->law->solid, "it is a fluid; allowed: only with a solid");
  STANDS("lame_ratio", "material", !s->scheme.space.finite && s->law != &MpmLawNeo, "allowed: only with material neo");
  STANDS("lame_ratio", "material", !s->scheme.space.finite && s->law == &MpmLawNeo && s->layout.dim > 1, "poisson says it with dim 2 or 3; allowed: only with dim 1");
  STANDS("exponent", "material", !(s->law->exponent > 0), "allowed: only with material tait, polytropic or herschel_bulkley");
  STANDS("prestress", "kinematics", s->scheme.space.finite, "with kinematics finite material and stretch give it; allowed: one of the two");
  STANDS("cluster", "dim", s->layout.dim > 1, "allowed: only with dim 1");
  STANDS("fill", "counts", s->layout.counts.n > 1, "allowed: with ppc (counts may be 0 where there is nothing)");
  STANDS("shape", "kinematics,dim", !s->scheme.space.finite || s->layout.dim == 1, "allowed: with kinematics finite and dim 2 or 3");
  STANDS("poisson", "dim,formulation", !MpmSceneHasPoisson(s), "allowed: only with dim 2 or 3, and a formulation with a stress (usl, usf, musl, usavg)");
  STANDS("safety", "courant", s->safety == 0, "allowed: only with courant auto");
  STANDS("step_bound", "kinematics", !s->scheme.space.finite, "allowed: only with kinematics finite ('mpmstab critical' finds the bounds of a linear step)");
  STANDS("density_ratio,stiffness_ratio", "material", s->layout.material.kind == MPM_MATERIAL_UNIFORM, "allowed: only with material two or graded");
  STANDS("inclusion", "material", s->layout.material.kind != MPM_MATERIAL_TWO, "allowed: only with material two");
  PetscFunctionReturn(PETSC_SUCCESS);
}
/* clang-format on */

/* ---- sizes ---- */

/* Refuses units in which the amplitude of a field is out of the range of doubles. */
static PetscErrorCode CheckSizes(const MpmSettings *settings, const MpmScene *scene)
{
  static const char *const given[] = {"wave_speed", "amplitude", "length", "sound_speed", "density",
                                      "young",      "bulk",      "shear",  "cell_width"};
  const char *const        blamed  = MpmSettingsFarthest(settings, PETSC_STATIC_ARRAY_LENGTH(given), given);
  const MpmProfile         profile = MpmSceneProfile(scene, scene->amplitude);

  PetscFunctionBegin;
  if (!scene->scheme.formulation->wave || !profile.nwaves) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt r = 0; r < scene->scheme.table->nstate; r++)
    if (!isnormal(scene->scheme.formulation->wave->amplitude(&profile, scene->scheme.table->field[r])))
      PetscCall(MpmSettingsRefuse(
          settings, blamed,
          strcmp(blamed, "wave_speed")
              ? "a field's amplitude is out of range with it; allowed: a number nearer to 1"
              : "a field's amplitude is out of range with it; allowed: a speed nearer to length / time"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The order matters: what is read later needs what was read before. */
static PetscErrorCode ReadProblem(MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(MpmSettingsReadScheme(settings));
  PetscCall(MpmSettingsReadFields(settings, MPM_OF_SCENE, &scene->layout.dim, scene));
  PetscCall(ReadWords(settings, scene));
  PetscCall(MpmSettingsReadGiven(settings, scene));
  PetscCall(MpmSettingsReadWaveSpeed(settings, scene));
  PetscCall(MpmSettingsReadKinematics(settings, scene));
  PetscCall(MpmSettingsReadLaw(settings, scene));
  PetscCall(MpmSettingsReadGrid(settings, scene));
  PetscCall(ReadTransfer(settings, scene));
  PetscCall(ReadBoundary(settings, scene));
  PetscCall(MpmSettingsReadColliders(settings, scene));
  PetscCall(MpmSettingsReadBodies(settings, scene));
  PetscCall(ReadFill(settings, scene));
  PetscCall(MpmSettingsReadShape(settings, scene));
  PetscCall(MpmSettingsPlaceGiven(settings, scene));
  PetscCall(MpmSettingsReadPace(settings, scene));
  PetscCall(ReadMaterial(settings, scene));
  PetscCall(CheckRules(settings, scene));
  if (scene->scheme.space.finite)
    PetscCall(MpmSettingsCheckFinite(settings, scene));
  else
    PetscCall(MpmSettingsReadPrestress(settings, scene));
  PetscCall(MpmSettingsReadDamping(settings, scene));
  PetscCall(MpmTableCreate(scene->scheme.formulation, scene->scheme.transfer, &scene->scheme.numbers,
                           &scene->scheme.space, &scene->scheme.table));
  PetscCall(MpmSettingsReadInitial(settings, scene));
  PetscCall(CheckSizes(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneDestroy(MpmScene **scene)
{
  PetscFunctionBegin;
  if (*scene) {
    PetscCall(MpmTableDestroy(&(*scene)->scheme.table));
    PetscCall(PetscFree((*scene)->layout.spans));
    PetscCall(MpmGivenDestroy(&(*scene)->layout.given));
    PetscCall(MpmSettingsForgetColliders(&(*scene)->layout.colliders));
    PetscCall(MpmWrittenFormulationDestroy(&(*scene)->own));
    PetscCall(MpmWrittenDestroy(&(*scene)->written));
  }
  PetscCall(PetscFree(*scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- scene and request ---- */

static PetscErrorCode ReadBoth(MpmSettings *settings, MpmScene **scene, MpmRequest *request)
{
  PetscBool matrix;

  PetscFunctionBegin;
  PetscCall(MpmSettingsCheckTrust(settings));
  PetscCall(MpmSettingsNameMatrix(settings, request->task, &matrix));
  if (matrix) {
    PetscCall(MpmSceneDestroy(scene));
    PetscCall(MpmSettingsReadScheme(settings));
    PetscCall(MpmSettingsReadMatrixRequest(settings, request));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ReadProblem(settings, *scene));
  PetscCall(MpmSettingsReadRequest(settings, *scene, request));
  /* who asks for a limit means that of a scheme; the default's would be taken for an answer */
  MpmCheckInput(strcmp(request->task, "critical") || settings->scene[0] || request->survey ||
                    MpmSettingsSource(settings, "formulation") != MPM_FROM_DEFAULT ||
                    MpmSettingsGiven(settings, "scheme"),
                "critical: of which scheme? allowed: with a formulation, as in 'mpmstab critical usl' or 'mpmstab "
                "critical musl -basis quadratic'; 'mpmstab list formulations' shows them, -survey compares them");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Makes a scene from a file, or from text that messages call by a name, and with a request from the command line, too.
   A refusal frees what there is, since a program such as the fuzzer reads one scene after another.
*/
static PetscErrorCode Make(const char path[], const char name[], const char yaml[], MpmRequest *request,
                           MpmScene **scene)
{
  MpmSettings   *settings = NULL;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(PetscNew(scene));
  (*scene)->law = &MpmLawLinear;
  ierr          = MpmSettingsCreate(&settings);
  if (!ierr && path) ierr = MpmSettingsReadScene(settings, path);
  if (!ierr && yaml) ierr = MpmSettingsReadText(settings, name, yaml);
  if (!ierr && request) ierr = MpmSettingsReadCommandLine(settings);
  if (!ierr) ierr = request ? ReadBoth(settings, scene, request) : ReadProblem(settings, *scene);
  PetscCall(MpmSettingsDestroy(&settings));
  if (ierr) PetscCall(MpmSceneDestroy(scene));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneCreate(const char task[], const char path[], MpmScene **scene, MpmRequest *request)
{
  MpmRequest unwanted;

  PetscFunctionBegin;
  if (!request) request = &unwanted;
  *request = (MpmRequest){.task = task};
  PetscCall(Make(path, NULL, NULL, request, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneFromNamedText(const char name[], const char yaml[], MpmScene **scene)
{
  return Make(NULL, name, yaml, NULL, scene);
}

PetscErrorCode MpmSceneFromText(const char yaml[], MpmScene **scene)
{
  return Make(NULL, "text", yaml, NULL, scene);
}

PetscErrorCode MpmSceneFromFile(const char path[], MpmScene **scene)
{
  return Make(path, NULL, NULL, NULL, scene);
}
