/*
   The bodies of particles of a scene: the option bodies. The particles of a body are those of the lattice of 1 / ppc of
   a cell whose places are inside, body by body, or those of a file.
*/
#include "base/memory.h"
#include "scene/blocks.h"
#include "scene/material.h"
#include <math.h>
#include <string.h>

#define MOST_BODIES 64
#define ON_SURFACE 1e-9 /* cells: a place nearer to a surface is not inside */

/*
   A body of particles. place: its shape, or file: its particles; from, end: the sites of its lattice between which it
   is; ratio: of its density, stiffness and volumes over the scene's; young: the Young's modulus of stiffness 1;
   velocity: in units of c. material: of its law, and its number among those of the run.
*/
struct MpmBody_ {
  MpmCollider place;
  MpmGiven   *file;
  PetscInt    ppc[MPM_MAX_DIM], from[MPM_MAX_DIM], end[MPM_MAX_DIM];
  PetscReal   ratio[MPM_PROPERTIES], young, velocity[MPM_MAX_DIM];
  PetscInt    number;

  MpmMaterialNumbers material;
};

/* A number above 0 of a body over that of the scene. */
static PetscErrorCode ReadRatio(MpmBlockReader *r, const yaml_node_t *block, const char key[], PetscReal scenes,
                                PetscReal *ratio)
{
  PetscReal value;

  PetscFunctionBegin;
  if (!MpmBlockFind(r, block, key)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmBlockReadNumbers(r, block, key, PETSC_TRUE, &value));
  *ratio = value / scenes;
  REFUSE_IF(!(value > 0) || !isnormal(*ratio), r, key,
            "allowed: greater than 0, and not out of range beside the scene's");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadPpc(MpmBlockReader *r, const yaml_node_t *block, MpmBody *body)
{
  const MpmLayout *l = &r->scene->layout;
  PetscReal        value;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(body->ppc, l->ppc, MPM_MAX_DIM));
  if (!MpmBlockFind(r, block, "ppc")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmBlockReadNumbers(r, block, "ppc", PETSC_TRUE, &value));
  REFUSE_IF(!(value >= 1 && value <= 1000 && value == floor(value)), r, "ppc",
            "allowed: a whole number from 1 to 1000");
  for (PetscInt a = 0; a < l->dim; a++) {
    body->ppc[a] = (PetscInt)value;
    body->ratio[MPM_VOLUME] *= (PetscReal)l->ppc[a] / body->ppc[a];
    REFUSE_IF(r->scene->scheme.basis->wide && body->ppc[a] != l->ppc[a], r, "ppc",
              "with basis gimp all particles have the width 1 / ppc of the scene; allowed: the scene's ppc");
    REFUSE_IF(l->grid[a].cells * (PetscReal)body->ppc[a] > PETSC_MAX_INT / 2, r, "ppc",
              "too many particles along a direction; allowed: fewer cells or ppc");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The law of a body, the scene's unless it is said. Words are those of the option material. */
static PetscErrorCode ReadLaw(MpmBlockReader *r, const yaml_node_t *block, const MpmLaw **law)
{
  const char *names[MPM_MOST_WORDS];
  PetscInt    n = 0, which;

  PetscFunctionBegin;
  *law = r->scene->law;
  if (!MpmBlockFind(r, block, "material")) PetscFunctionReturn(PETSC_SUCCESS);
  for (; MpmLaws[n]; n++)
    names[n] = MpmLaws[n] == &MpmLawLinear ? MpmMaterialNames[MPM_MATERIAL_UNIFORM] : MpmLaws[n]->name;
  PetscCall(MpmBlockReadWord(r, block, "material", n, names, &which));
  *law = MpmLaws[which];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The keys that bodies of a law have besides those of their shape. */
static PetscInt KeysOf(const MpmBlockReader *r, const MpmLaw *law, const char *names[])
{
  PetscInt n = 0;

  names[n++] = "shape";
  names[n++] = "velocity";
  names[n++] = "density";
  names[n++] = law->solid ? "young" : "bulk";
  names[n++] = r->body->shape ? "ppc" : "path";
  names[n++] = "material";
  if (law->solid && r->scene->layout.dim > 1) names[n++] = "poisson";
  if (law->exponent > 0) names[n++] = "exponent";
  for (PetscInt i = 0; i < MPM_PLASTIC_NUMBERS; i++)
    if (law->number[i].reads) names[n++] = MpmPlasticNames[i];
  return n;
}

static PetscErrorCode ReadPoisson(MpmBlockReader *r, const yaml_node_t *block, MpmBody *body)
{
  const MpmScene *scene = r->scene;
  PetscReal       nu    = scene->scheme.space.poisson;

  PetscFunctionBegin;
  REFUSE_IF(!scene->law->solid && scene->layout.dim > 1 && !MpmBlockFind(r, block, "poisson"), r, "poisson",
            "the scene's material is a fluid, and has none; allowed: a number from 0 to less than 0.5");
  if (MpmBlockFind(r, block, "poisson")) {
    PetscCall(MpmBlockReadNumbers(r, block, "poisson", PETSC_TRUE, &nu));
    REFUSE_IF(!(nu >= 0 && nu < 0.5), r, "poisson", "allowed: from 0 to less than 0.5");
    body->material = MpmMaterialOfRatio(body->material.law, 2 * nu / (1 - 2 * nu), body->material.exponent);
  }
  body->young = (scene->density > 0 ? scene->density : 1) * PetscSqr(scene->wave_speed) /
                MpmMaterialStiffness(scene->layout.dim, nu);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The material of a body: the scene's numbers, or of another law the usual ones, unless the body has its own. */
static PetscErrorCode ReadMaterial(MpmBlockReader *r, const yaml_node_t *block, const MpmLaw *law, MpmBody *body)
{
  const MpmScene *scene = r->scene;
  char            why[96];

  PetscFunctionBegin;
  if (MpmBlockFind(r, block, "material"))
    PetscCall(MpmTextAdd(&r->text, ", material: %s", MpmBlockScalar(MpmBlockFind(r, block, "material"))));
  body->material =
      MpmMaterialOfRatio(law, law->solid ? scene->lame_ratio : 0, law == scene->law ? scene->exponent : law->exponent);
  body->young = NAN;
  if (law->solid) PetscCall(ReadPoisson(r, block, body));
  if (MpmBlockFind(r, block, "exponent"))
    PetscCall(MpmBlockReadNumbers(r, block, "exponent", PETSC_TRUE, &body->material.exponent));
  REFUSE_IF(law->exponent > 0 && !(body->material.exponent > 0), r, "exponent", "allowed: greater than 0");
  for (PetscInt i = 0; i < MPM_PLASTIC_NUMBERS; i++) {
    PetscReal *number = &body->material.plastic[i];

    if (law == scene->law) *number = scene->plastic[i];
    if (!law->number[i].reads || !MpmBlockFind(r, block, MpmPlasticNames[i])) continue;
    PetscCall(MpmBlockReadNumbers(r, block, MpmPlasticNames[i], PETSC_TRUE, number));
    (void)snprintf(why, sizeof why, "allowed with material %s: from %g to %g", law->name, (double)law->number[i].least,
                   (double)law->number[i].most);
    REFUSE_IF(!(*number >= law->number[i].least && *number <= law->number[i].most), r, MpmPlasticNames[i], why);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The modulus of a body, over the scene's. A solid has Young's, and a fluid its bulk modulus. */
static PetscErrorCode ReadModulus(MpmBlockReader *r, const yaml_node_t *block, MpmBody *body)
{
  const MpmScene *scene = r->scene;
  const PetscBool solid = body->material.law->solid;
  const char     *key   = solid ? "young" : "bulk";
  PetscReal       unit[MPM_PROPERTIES];

  PetscFunctionBegin;
  MpmMaterialUnits(scene, unit);
  REFUSE_IF(solid != scene->law->solid && !MpmBlockFind(r, block, key), r, key,
            "the scene's material has no such modulus; allowed: greater than 0");
  if (solid && scene->law->solid) body->ratio[MPM_STIFFNESS] = unit[MPM_STIFFNESS] / body->young;
  PetscCall(ReadRatio(r, block, key,
                      solid ? body->young : (scene->density > 0 ? scene->density : 1) * PetscSqr(scene->wave_speed),
                      &body->ratio[MPM_STIFFNESS]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadBody(void *reader, const yaml_node_t *block)
{
  MpmBlockReader  *r                     = (MpmBlockReader *)reader;
  const MpmScene  *scene                 = r->scene;
  const MpmLayout *l                     = &scene->layout;
  const char      *names[MPM_MOST_WORDS] = {NULL};
  MpmBody         *body                  = &r->bodies[r->n];
  const MpmLaw    *law;
  const char      *path;
  char             where[64];

  PetscFunctionBegin;
  MpmSettingsRefuseIf(r->n == MOST_BODIES, r->settings, r->option, "allowed: at most %d bodies", MOST_BODIES);
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++) body->ratio[w] = 1;
  r->body = &body->place;
  PetscCall(MpmBlockReadShape(r, block, "file"));
  PetscCall(ReadLaw(r, block, &law));
  PetscCall(MpmBlockCheckKeys(r, block, KeysOf(r, law, names), names));
  PetscCall(MpmTextAdd(&r->text, "%s{shape: %s", r->n ? ", " : "", r->body->shape ? r->body->shape->name : "file"));
  if (r->body->shape) {
    PetscCall(MpmBlockReadShapeKeys(r, block));
    PetscCall(ReadPpc(r, block, body));
  } else {
    PetscCall(MpmBlockBeginFile(r, block, "allowed: the name of a CSV or HDF5 file of particles", sizeof where, where,
                                &path));
    PetscCall(MpmGivenRead(where, "", path, l->dim, &body->file));
    REFUSE_IF(body->file->has[MPM_GIVEN_POISSON - MPM_GIVEN_VOLUME] ||
                  body->file->has[MPM_GIVEN_FIXED - MPM_GIVEN_VOLUME],
              r, "path", "it has a column poisson or fixed; allowed: x, y, z, volume, mass and young");
  }
  PetscCall(ReadRatio(r, block, "density", scene->density > 0 ? scene->density : 1, &body->ratio[MPM_MASS]));
  PetscCall(ReadMaterial(r, block, law, body));
  PetscCall(ReadModulus(r, block, body));
  if (MpmBlockFind(r, block, "velocity"))
    PetscCall(MpmBlockReadNumbers(r, block, "velocity", PETSC_FALSE, body->velocity));
  for (PetscInt a = 0; a < l->dim; a++) body->velocity[a] /= scene->wave_speed;
  body->number = MpmMaterialsAdd(&r->materials, &body->material);
  REFUSE_IF(body->number == MPM_MOST_MATERIALS, r, "material",
            "too many; allowed: at most 8 materials, of which the laws that flow are three");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The lattice sites between which a body is, in each direction; their number is added to room. */
static PetscErrorCode FindSites(MpmBlockReader *r, MpmBody *body, PetscReal *room)
{
  const MpmLayout *l = &r->scene->layout;
  PetscReal        lo[MPM_MAX_DIM], hi[MPM_MAX_DIM];
  PetscReal        sites = body->file ? body->file->particles : 1;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < l->dim; a++) {
    lo[a] = 0;
    hi[a] = l->grid[a].cells;
  }
  if (!body->file && body->place.shape->extent) body->place.shape->extent(&body->place, l->dim, lo, hi);
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) body->end[a] = 1;
  for (PetscInt a = 0; a < l->dim && !body->file; a++) {
    REFUSE_IF((lo[a] < -ON_SURFACE && isfinite(lo[a]) && l->grid[a].ends[0] != MPM_SYMMETRY) ||
                  (hi[a] > l->grid[a].cells + ON_SURFACE && isfinite(hi[a]) && l->grid[a].ends[1] != MPM_SYMMETRY) ||
                  hi[a] <= 0 || lo[a] >= l->grid[a].cells,
              r, "shape", "it reaches beyond the grid; allowed: a body within it, or beyond an end of symmetry");
    body->from[a] = (PetscInt)floor(PetscMax(lo[a], 0) * body->ppc[a]);
    body->end[a]  = (PetscInt)ceil(PetscMin(hi[a], l->grid[a].cells) * body->ppc[a]);
    sites *= body->end[a] - body->from[a];
  }
  *room += sites;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses the particle at x of body r->n, which another body or a collider, of a number, contains. */
static PetscErrorCode RefusePlace(const MpmBlockReader *r, const PetscReal x[], const char other[], PetscInt number)
{
  char at[96] = "";

  PetscFunctionBegin;
  for (PetscInt a = 0; a < r->scene->layout.dim; a++)
    (void)snprintf(at + strlen(at), sizeof at - strlen(at), "%s%.6g", a ? ", " : "", x[a] * r->scene->cell_width);
  PetscCall(MpmSettingsRefuse(r->settings, r->option,
                              "%s of body %" PetscInt_FMT ": its particle at (%s) is inside %s %" PetscInt_FMT
                              "; allowed: where nothing else is",
                              r->bodies[r->n].file ? "path" : "shape", r->n + 1, at, other, number));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsInside(const MpmCollider *body, PetscInt dim, const PetscReal x[])
{
  PetscReal normal[MPM_MAX_DIM];

  return body->shape && body->shape->distance(body, dim, x, normal) < -ON_SURFACE ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Takes the particle at x into the layout, unless something else is there: a shape without an end, such as a half
   space, ends where a collider begins.
*/
static PetscErrorCode Take(MpmBlockReader *r, PetscInt bodies, const PetscReal x[], PetscBool *taken)
{
  const MpmLayout *l  = &r->scene->layout;
  const MpmBody   *of = &r->bodies[r->n];
  MpmGiven        *to = l->given;

  PetscFunctionBegin;
  *taken = PETSC_FALSE;
  for (PetscInt i = 0; l->colliders && i < l->colliders->n; i++) {
    if (!IsInside(&l->colliders->body[i], l->dim, x)) continue;
    if (l->colliders->body[i].contact->pushes) continue;
    if (!of->file && !of->place.shape->extent) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(RefusePlace(r, x, "collider", i + 1));
  }
  for (PetscInt i = 0; i < bodies; i++)
    if (i != r->n && IsInside(&r->bodies[i].place, l->dim, x)) PetscCall(RefusePlace(r, x, "body", i + 1));
  for (PetscInt a = 0; a < l->dim; a++) {
    to->column[a][to->particles]   = x[a];
    to->velocity[a][to->particles] = of->velocity[a];
  }
  *taken = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Gives the particle that was taken its properties, in units of one of the scene's material that fills 1 / ppc of a
   cell.
*/
static PetscErrorCode Weigh(const MpmBlockReader *r, PetscInt64 at, const PetscReal unit[])
{
  const MpmBody *of         = &r->bodies[r->n];
  MpmGiven      *to         = r->scene->layout.given;
  PetscReal      of_file[3] = {of->ratio[MPM_VOLUME], NAN, of->ratio[MPM_STIFFNESS]};

  PetscFunctionBegin;
  if (of->file && of->file->has[0]) of_file[0] = of->file->column[MPM_GIVEN_VOLUME][at] / unit[MPM_VOLUME];
  of_file[1] = of->ratio[MPM_MASS] * of_file[0];
  if (of->file && of->file->has[1]) of_file[1] = of->file->column[MPM_GIVEN_MASS][at] / unit[MPM_MASS];
  if (of->file && of->file->has[2]) of_file[2] = of->file->column[MPM_GIVEN_YOUNG][at] / of->young;
  REFUSE_IF(!isnormal(of_file[0]) || !isnormal(of_file[1]) || !isnormal(of_file[2]), r, "path",
            "a volume, mass or modulus is out of range beside the scene's; allowed: numbers of the scene's units");
  to->property[MPM_VOLUME][to->particles]    = of_file[0];
  to->property[MPM_MASS][to->particles]      = of_file[1];
  to->property[MPM_STIFFNESS][to->particles] = of_file[2];
  if (to->material) to->material[to->particles] = (unsigned char)of->number;
  to->particles++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Place(MpmBlockReader *r, PetscInt bodies, const PetscReal unit[])
{
  const MpmLayout *l      = &r->scene->layout;
  const MpmBody   *of     = &r->bodies[r->n];
  const PetscInt64 before = l->given->particles;
  PetscInt         at[MPM_MAX_DIM];
  PetscReal        x[MPM_MAX_DIM];
  PetscBool        taken;

  PetscFunctionBegin;
  for (PetscInt64 i = 0; of->file && i < of->file->particles; i++) {
    for (PetscInt a = 0; a < l->dim; a++) {
      x[a] = of->file->column[a][i] / r->scene->cell_width;
      REFUSE_IF(!(x[a] >= 0 && x[a] <= l->grid[a].cells), r, "path",
                "a particle is outside of the grid; allowed: within it");
    }
    PetscCall(Take(r, bodies, x, &taken));
    PetscCall(Weigh(r, i, unit));
  }
  for (at[2] = of->from[2]; at[2] < of->end[2] && !of->file; at[2]++)
    for (at[1] = of->from[1]; at[1] < of->end[1]; at[1]++)
      for (at[0] = of->from[0]; at[0] < of->end[0]; at[0]++) {
        for (PetscInt a = 0; a < l->dim; a++) x[a] = (at[a] + 0.5) / of->ppc[a];
        if (!IsInside(&of->place, l->dim, x)) continue;
        PetscCall(Take(r, bodies, x, &taken));
        if (taken) PetscCall(Weigh(r, 0, unit));
      }
  REFUSE_IF(l->given->particles == before, r, of->file ? "path" : "shape",
            "no particle is inside; allowed: a larger body, or more cells or ppc");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the scene the materials of its bodies, unless all are of its own. */
static PetscErrorCode SetMaterials(const MpmBlockReader *r, PetscReal room)
{
  MpmMaterialNumbers *material = &r->scene->scheme.space.material;
  MpmGiven           *given    = r->scene->layout.given;
  MpmMaterials        own      = {.n = 0};

  PetscFunctionBegin;
  (void)MpmMaterialsAdd(&own, material);
  if (r->materials.n == 1 && MpmMaterialsAdd(&own, &r->materials.of[0]) == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRequire(r->settings, r->scene, r->option, MpmFormulationHasOneStage,
                               "steps of one stage, without IMPLICIT, as several materials need"));
  for (PetscInt i = 0; i < r->materials.n; i++)
    MpmSettingsRefuseIf(r->materials.of[i].law->viscous, r->settings, r->option,
                        "material %s does not go with others; allowed: all bodies of the material of the scene",
                        r->materials.of[i].law->name);
  PetscCall(PetscMalloc1((size_t)room, &given->material));
  PetscCall(PetscNew(&given->materials));
  *given->materials = r->materials;
  material->law     = &MpmLawSeveral;
  material->several = given->materials;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PlaceAll(MpmBlockReader *r)
{
  MpmLayout     *l    = &r->scene->layout;
  const PetscInt n    = r->n;
  PetscReal      room = 0;
  PetscReal      unit[MPM_PROPERTIES];

  PetscFunctionBegin;
  MpmMaterialUnits(r->scene, unit);
  for (r->n = 0; r->n < n; r->n++) PetscCall(FindSites(r, &r->bodies[r->n], &room));
  PetscCall(MpmLayoutCheckMemory(PETSC_COMM_WORLD, l,
                                 room * (PetscReal)sizeof(PetscReal) * (2 * l->dim + 3) * MpmRanksOf(PETSC_COMM_WORLD),
                                 "a copy of the particles on each rank"));
  MpmSettingsRefuseIf(room > PETSC_MAX_INT / 2, r->settings, r->option,
                      "too many particles; allowed: fewer cells or ppc");
  PetscCall(PetscNew(&l->given));
  l->name = l->given->path;
  PetscCall(PetscStrncpy(l->given->path, r->option, sizeof l->given->path));
  l->given->of_bodies = n;
  for (PetscInt a = 0; a < l->dim; a++) {
    PetscCall(PetscMalloc1((size_t)room, &l->given->column[a]));
    PetscCall(PetscMalloc1((size_t)room, &l->given->velocity[a]));
  }
  for (PetscInt w = MPM_NO_PROPERTY + 1; w <= MPM_STIFFNESS; w++)
    PetscCall(PetscMalloc1((size_t)room, &l->given->property[w]));
  PetscCall(SetMaterials(r, room));
  for (r->n = 0; r->n < n; r->n++) PetscCall(Place(r, n, unit));
  for (PetscInt w = MPM_NO_PROPERTY + 1; w < MPM_PROPERTIES; w++) { /* what all particles have alike is not kept */
    for (PetscInt64 id = 0; l->given->property[w] && id < l->given->particles && !l->varies[w]; id++)
      if (l->given->property[w][id] != 1) l->varies[w] = PETSC_TRUE;
    if (!l->varies[w]) PetscCall(PetscFree(l->given->property[w]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bodies are at finite strain, each with its own velocity. */
static PetscErrorCode CheckBodies(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  MpmSettingsRefuseIf(!scene->scheme.space.finite, settings, "bodies", "allowed: with kinematics finite");
  GIVEN("drift,velocity,mach,layout", MPM_FROM_SCENE, PETSC_TRUE,
        "each of the bodies says it for itself; allowed: velocity, or shape: file, in bodies");
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    MpmSettingsRefuseIf(scene->stretch[a] != 1, settings, "stretch", "bodies begin without a stretch; allowed: 1");
  if (MpmSettingsSource(settings, "initial") == MPM_FROM_DEFAULT) scene->initial = MPM_INITIAL_UNIFORM;
  MpmSettingsRefuseIf(scene->initial != MPM_INITIAL_UNIFORM && scene->initial != MPM_INITIAL_RANDOM, settings,
                      "initial", "bodies have velocities of their own; allowed: uniform or random");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadBodies(const MpmSettings *settings, MpmScene *scene)
{
  MpmBlockReader r = {.settings = settings, .scene = scene, .option = "bodies", .read = ReadBody};
  PetscErrorCode ierr;

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, "bodies")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckBodies(settings, scene));
  PetscCall(PetscCalloc1(MOST_BODIES + 1, &r.bodies));
  ierr = MpmBlockReadAll(&r, sizeof scene->bodies, scene->bodies);
  if (!ierr) ierr = PlaceAll(&r);
  for (PetscInt b = 0; b < MOST_BODIES; b++) {
    PetscCall(MpmGivenDestroy(&r.bodies[b].file));
    PetscCall(MpmDistanceDestroy(&r.bodies[b].place.grid));
  }
  PetscCall(PetscFree(r.bodies));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}
