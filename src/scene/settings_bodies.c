/*
   The rigid bodies of a scene (colliders) and those of particles (bodies): lists of blocks, in a scene file or as the same
   text on the command line, such as

     [{shape: plane, point: [0.5, 0.1], normal: [0, 1], contact: separating, friction: 0.3}]
     [{shape: sphere, center: [0.5, 0.8], radius: 0.1, velocity: [0, -2], density: 900, young: 1e5}]

   Both have the shapes of colliders. The particles of a body are those of the lattice of 1 / ppc of a cell whose places are
   inside, body by body, or those of a file.
*/
#include "base/hash.h"
#include "base/memory.h"
#include "base/suggest.h"
#include "base/text.h"
#include "base/yaml.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "scene/settings.h"
#include <math.h>
#include <string.h>

#define MOST_WORDS 16
#define MOST_BODIES 64
#define ON_SURFACE 1e-9 /* cells: a place nearer to a surface is not inside */

/*
   A body of particles. place: its shape, or file: its particles; from, end: the sites of its lattice between which it is;
   ratio: of its density, stiffness and volumes over the scene's; velocity: in units of c.
*/
typedef struct {
  MpmCollider place;
  MpmGiven   *file;
  PetscInt    ppc[MPM_MAX_DIM], from[MPM_MAX_DIM], end[MPM_MAX_DIM];
  PetscReal   ratio[MPM_PROPERTIES], velocity[MPM_MAX_DIM];
} Body;

/*
   option: what is read, colliders or bodies, of which n have been read. body: the rigid one that is read, or the place of
   the one of particles; text: what has been read, as records have it.
*/
typedef struct {
  const MpmSettings *settings;
  MpmScene          *scene;
  const char        *option;
  PetscInt           n;
  PetscErrorCode (*read)(void *reader, const yaml_node_t *block);
  MpmColliders    *colliders;
  MpmCollider     *body;
  Body            *bodies;
  yaml_document_t *document;
  MpmText          text;
} Reader;

/* Ends with a message that names the body by its number, the key, and why it cannot be. */
#define REFUSE(r, key, why)                                                                                            \
  PetscCall(MpmSettingsRefuse((r)->settings, (r)->option, "%s of body %" PetscInt_FMT ": %s", key, (r)->n + 1, why))
#define REFUSE_IF(condition, r, key, why)                                                                              \
  do {                                                                                                                 \
    if (condition) REFUSE(r, key, why);                                                                                \
  } while (0)

static const char *Scalar(const yaml_node_t *node)
{
  return node && node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : NULL;
}

/* The node of a key of a block, or NULL. */
static const yaml_node_t *Find(const Reader *r, const yaml_node_t *block, const char key[])
{
  for (const yaml_node_pair_t *pair = block->data.mapping.pairs.start; pair < block->data.mapping.pairs.top; pair++) {
    const char *name = Scalar(yaml_document_get_node(r->document, pair->key));

    if (name && !strcmp(name, key)) return yaml_document_get_node(r->document, pair->value);
  }
  return NULL;
}

/* Refuses a word that is in no list, and names those that are. */
static PetscErrorCode RefuseWord(const Reader *r, const char key[], const char word[], PetscInt n,
                                 const char *const names[])
{
  const char    *near = word ? MpmSuggest(word, n, names) : NULL;
  MpmText        why  = {NULL, 0};
  PetscErrorCode ierr;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++)
    PetscCall(MpmTextAdd(&why, "%s%s", i == 0 ? "allowed: " : i == n - 1 ? " or " : ", ", names[i]));
  if (near) PetscCall(MpmTextAdd(&why, "; did you mean %s?", near));
  ierr = MpmSettingsRefuse(r->settings, r->option, "%s of body %" PetscInt_FMT ": %s", key, r->n + 1, why.text);
  MpmTextFree(&why);
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of the names a key's word is. */
static PetscErrorCode ReadWord(const Reader *r, const yaml_node_t *block, const char key[], PetscInt n,
                               const char *const names[], PetscInt *which)
{
  const char *word = Scalar(Find(r, block, key));

  PetscFunctionBegin;
  for (*which = 0; word && *which < n; ++*which)
    if (!strcmp(word, names[*which])) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(RefuseWord(r, key, word, n, names));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt ItemsOf(const yaml_node_t *node)
{
  return node && node->type == YAML_SEQUENCE_NODE
             ? (PetscInt)(node->data.sequence.items.top - node->data.sequence.items.start)
             : 0;
}

/* n finite numbers of a node of a key: a list, or where n is 1 also a number. */
static PetscErrorCode ReadList(Reader *r, const yaml_node_t *node, const char key[], PetscInt n, PetscReal value[])
{
  const PetscBool list = node && node->type == YAML_SEQUENCE_NODE ? PETSC_TRUE : PETSC_FALSE;
  MpmFraction     number;
  char            why[64];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(why, sizeof why,
                          n > 1 ? "allowed: %" PetscInt_FMT " finite numbers [a, b]" : "allowed: a finite number", n));
  REFUSE_IF(!node || (list && ItemsOf(node) != n) || (!list && n > 1), r, key, why);
  if (n > 1) PetscCall(MpmTextAdd(&r->text, "["));
  for (PetscInt a = 0; a < n; a++) {
    const char *text = Scalar(list ? yaml_document_get_node(r->document, node->data.sequence.items.start[a]) : node);

    REFUSE_IF(!text || !MpmFractionParse(text, &number), r, key, why);
    value[a] = number.value;
    PetscCall(MpmTextAdd(&r->text, "%s%.15g", a ? ", " : "", value[a]));
  }
  if (n > 1) PetscCall(MpmTextAdd(&r->text, "]"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finite numbers of a key, as many as the scene has directions or, where one, a single one. */
static PetscErrorCode ReadNumbers(Reader *r, const yaml_node_t *block, const char key[], PetscBool one,
                                  PetscReal value[])
{
  PetscFunctionBegin;
  PetscCall(MpmTextAdd(&r->text, ", %s: ", key));
  PetscCall(ReadList(r, Find(r, block, key), key, one ? 1 : r->scene->layout.dim, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The velocity of a rigid body: one for all times, or rows of a time and the velocity then. */
static PetscErrorCode ReadMotion(Reader *r, const yaml_node_t *node)
{
  const PetscInt     dim = r->scene->layout.dim, rows = ItemsOf(node);
  const yaml_node_t *first = rows ? yaml_document_get_node(r->document, node->data.sequence.items.start[0]) : NULL;
  const PetscBool    table = first && first->type == YAML_SEQUENCE_NODE ? PETSC_TRUE : PETSC_FALSE;
  MpmCollider       *body  = r->body;

  PetscFunctionBegin;
  REFUSE_IF(!r->scene->scheme.space.finite, r, "velocity", "allowed: only with kinematics finite");
  REFUSE_IF(rows > MPM_COLLIDER_TIMES, r, "velocity", "too many times; allowed: at most 16");
  PetscCall(MpmTextAdd(&r->text, ", velocity: %s", table ? "[" : ""));
  body->pace   = r->scene->wave_speed / r->scene->cell_width;
  body->ntimes = table ? rows : 1;
  for (PetscInt k = 0; k < body->ntimes; k++) {
    PetscReal row[1 + MPM_MAX_DIM] = {0};

    if (k) PetscCall(MpmTextAdd(&r->text, ", "));
    if (table)
      PetscCall(ReadList(r, yaml_document_get_node(r->document, node->data.sequence.items.start[k]), "velocity",
                         dim + 1, row));
    else
      PetscCall(ReadList(r, node, "velocity", dim, row + 1));
    REFUSE_IF(k ? !(row[0] > body->time[k - 1]) : row[0] != 0, r, "velocity",
              "allowed: rows [time, velocity] whose times begin with 0 and rise");
    body->time[k] = row[0];
    for (PetscInt a = 0; a < dim; a++) body->velocity[k][a] = row[1 + a] / r->scene->wave_speed;
  }
  if (table) PetscCall(MpmTextAdd(&r->text, "]"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadShapeKeys(Reader *r, const yaml_node_t *block)
{
  const MpmColliderShape *shape = r->body->shape;
  const PetscInt          dim   = r->scene->layout.dim;

  PetscFunctionBegin;
  for (PetscInt k = 0; shape->key[k]; k++) {
    const MpmColliderKey holds = shape->holds[k];
    PetscReal           *value = r->body->value[k], size = 0;

    PetscCall(ReadNumbers(r, block, shape->key[k], holds >= MPM_KEY_SIZE ? PETSC_TRUE : PETSC_FALSE, value));
    if (holds == MPM_KEY_ANGLE) {
      REFUSE_IF(!(value[0] > 0 && value[0] < 90), r, shape->key[k],
                "allowed: degrees, greater than 0 and less than 90");
      value[0] *= PETSC_PI / 180;
      continue;
    }
    for (PetscInt a = 0; a < dim; a++) {
      REFUSE_IF((holds == MPM_KEY_SIZES || (holds == MPM_KEY_SIZE && a == 0)) && !(value[a] > 0), r, shape->key[k],
                "allowed: greater than 0");
      size = hypot(size, value[a]);
    }
    REFUSE_IF(holds == MPM_KEY_DIRECTION && !(size > 0), r, shape->key[k], "allowed: not all 0");
    for (PetscInt a = 0; a < dim; a++) value[a] /= holds == MPM_KEY_DIRECTION ? size : r->scene->cell_width;
    for (PetscInt a = 0, same = 0; k && holds == MPM_KEY_PLACE && a < dim; a++) {
      same += value[a] == r->body->value[k - 1][a];
      REFUSE_IF(same == dim, r, shape->key[k], "allowed: another place than that of the key before");
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses keys that a body of this shape does not have, and keys that are there twice. names: those of all shapes. */
static PetscErrorCode CheckKeys(const Reader *r, const yaml_node_t *block, PetscInt n, const char *names[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; r->body->shape && r->body->shape->key[k]; k++) names[n++] = r->body->shape->key[k];
  for (const yaml_node_pair_t *pair = block->data.mapping.pairs.start; pair < block->data.mapping.pairs.top; pair++) {
    const char *name = Scalar(yaml_document_get_node(r->document, pair->key));
    PetscInt    i    = 0;

    while (name && i < n && strcmp(name, names[i])) i++;
    if (!name || i == n) PetscCall(RefuseWord(r, name ? name : "a key", name, n, names));
    REFUSE_IF(Find(r, block, name) != yaml_document_get_node(r->document, pair->value), r, name,
              "it is given a second time; allowed: once");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The shape of a block; more: another word than those of the shapes, NULL: none. */
static PetscErrorCode ReadShape(Reader *r, const yaml_node_t *block, const char more[])
{
  const char *names[MOST_WORDS];
  PetscInt    n = 0, which;

  PetscFunctionBegin;
  for (; MpmColliderShapes[n]; n++) names[n] = MpmColliderShapes[n]->name;
  if (more) names[n] = more;
  PetscCall(ReadWord(r, block, "shape", n + (more ? 1 : 0), names, &which));
  r->body->shape = MpmColliderShapes[which];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body at rest that contains no node would do nothing, and one that contains all leaves nothing to move. */
static PetscErrorCode CheckPlace(const Reader *r)
{
  const MpmLayout *l      = &r->scene->layout;
  PetscInt         inside = 0, nodes[MPM_MAX_DIM] = {1, 1, 1}, at[MPM_MAX_DIM];
  PetscReal        x[MPM_MAX_DIM], normal[MPM_MAX_DIM];

  PetscFunctionBegin;
  if (MpmColliderMoves(r->body)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < l->dim; a++) nodes[a] = l->grid[a].nodes;
  for (at[2] = 0; at[2] < nodes[2]; at[2]++)
    for (at[1] = 0; at[1] < nodes[1]; at[1]++)
      for (at[0] = 0; at[0] < nodes[0]; at[0]++) {
        for (PetscInt a = 0; a < l->dim; a++) x[a] = at[a];
        inside += r->body->shape->distance(r->body, l->dim, x, normal) <= 0;
      }
  REFUSE_IF(!inside, r, "place",
            "it contains no node of the grid; allowed: a body that does, as large as a cell at least");
  REFUSE_IF(inside == nodes[0] * nodes[1] * nodes[2], r, "place",
            "it contains all nodes of the grid; allowed: a part of them (the normal of a plane points away from it)");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stiffness of a body that pushes, per mass, so 1 / time^2; in units of (c / h)^2 when it is read. */
static PetscErrorCode ReadPush(Reader *r, const yaml_node_t *block)
{
  MpmScene *scene = r->scene;

  PetscFunctionBegin;
  REFUSE_IF(!scene->scheme.space.finite, r, "contact", "penalty needs places; allowed: only with kinematics finite");
  REFUSE_IF(MpmFormulationReads(scene->scheme.formulation, "rk"), r, "contact",
            "penalty is not in the stages of a step; allowed: with another formulation than rk");
  PetscCall(ReadNumbers(r, block, "stiffness", PETSC_TRUE, &r->body->stiffness));
  REFUSE_IF(!(r->body->stiffness > 0), r, "stiffness", "allowed: greater than 0");
  r->body->stiffness *= PetscSqr(scene->cell_width / scene->wave_speed);
  scene->scheme.space.loaded = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadCollider(void *reader, const yaml_node_t *block)
{
  Reader     *r                 = (Reader *)reader;
  const char *names[MOST_WORDS] = {"shape", "contact", "velocity", NULL}, *contacts[MOST_WORDS];
  PetscInt    n                 = 0, which;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(r->n == MPM_MAX_COLLIDERS, r->settings, "colliders", "allowed: at most %d bodies",
                      MPM_MAX_COLLIDERS);
  r->body = &r->colliders->body[r->n];
  PetscCall(ReadShape(r, block, NULL));
  for (; MpmContacts[n]; n++) contacts[n] = MpmContacts[n]->name;
  PetscCall(ReadWord(r, block, "contact", n, contacts, &which));
  r->body->contact = MpmContacts[which];
  names[3]         = r->body->contact->pushes ? "stiffness" : "friction";
  PetscCall(CheckKeys(r, block, 4, names));
  PetscCall(MpmTextAdd(&r->text, "%s{shape: %s, contact: %s", r->n ? ", " : "", r->body->shape->name,
                       r->body->contact->name));
  PetscCall(ReadShapeKeys(r, block));
  if (Find(r, block, "friction")) PetscCall(ReadNumbers(r, block, "friction", PETSC_TRUE, &r->body->friction));
  REFUSE_IF(r->body->friction < 0, r, "friction", "allowed: from 0");
  REFUSE_IF(r->body->friction > 0 && !r->body->contact->rubs, r, "friction",
            "nothing slides on it; allowed: with contact slip or separating");
  if (Find(r, block, "velocity")) PetscCall(ReadMotion(r, Find(r, block, "velocity")));
  if (r->body->contact->pushes)
    PetscCall(ReadPush(r, block));
  else
    r->scene->scheme.space.collides = PETSC_TRUE;
  PetscCall(CheckPlace(r));
  r->colliders->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- lists of blocks ---- */

static PetscErrorCode ReadBlock(Reader *r, const yaml_node_t *block)
{
  PetscFunctionBegin;
  MpmSettingsRefuseIf(!block || block->type != YAML_MAPPING_NODE, r->settings, r->option,
                      "allowed: blocks such as [{shape: sphere, center: [0.5, 0.5], radius: 0.2, %s}]",
                      r->colliders ? "contact: slip" : "velocity: [0, -1]");
  PetscCall(r->read(r, block));
  PetscCall(MpmTextAdd(&r->text, "}"));
  r->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The document is the text behind a key. */
static PetscErrorCode ReadBlocks(void *context, yaml_document_t *document, const yaml_node_t *root)
{
  Reader            *r = (Reader *)context;
  const yaml_node_t *all;

  PetscFunctionBegin;
  r->document = document;
  all         = Find(r, root, r->option);
  if (all && all->type == YAML_SEQUENCE_NODE)
    for (const yaml_node_item_t *item = all->data.sequence.items.start; item < all->data.sequence.items.top; item++)
      PetscCall(ReadBlock(r, yaml_document_get_node(document, *item)));
  else
    PetscCall(ReadBlock(r, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Records have the text; of a longer one its beginning, and a hash that tells it from others. */
static void Record(const MpmText *text, size_t room, char record[])
{
  uint64_t hash = 0;

  (void)snprintf(record, room, "%s", text->text);
  if (strlen(text->text) < room) return;
  for (const char *c = text->text; *c; c++) hash = MpmHashMix(hash + (unsigned char)*c + MPM_HASH_INCREMENT);
  (void)snprintf(record + room - 32, 32, " ... (hash %016llx)", (unsigned long long)hash);
}

static PetscErrorCode ReadAll(Reader *r, size_t room, char record[])
{
  MpmText        yaml = {NULL, 0};
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(MpmTextAdd(&yaml, "{%s: %s}", r->option, MpmSettingsText(r->settings, r->option)));
  ierr = MpmYamlReadText(r->option, r->option, yaml.text, ReadBlocks, r);
  MpmTextFree(&yaml);
  if (!ierr) Record(&r->text, room, record);
  MpmTextFree(&r->text);
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a step has velocities of the grid, whose increments particles get. */
static PetscBool HasContact(const MpmFormulation *f)
{
  MpmOp        room[MPM_MOST_TABLE_LINES];
  PetscInt     n;
  const MpmOp *ops = MpmFormulationLines(f, NULL, NULL, room, &n);

  for (PetscInt o = 0; o < n; o++)
    if (ops[o].kind == MPM_IMPLICIT) return PETSC_FALSE;
  for (PetscInt o = 0; o < n; o++)
    if (ops[o].kind == MPM_REACT && f->node_ranks[ops[o].src] == MPM_VECTOR && f->affine != MPM_NONE) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode MpmSettingsReadColliders(const MpmSettings *settings, MpmScene *scene)
{
  Reader r = {.settings = settings, .scene = scene, .option = "colliders", .read = ReadCollider};

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, "colliders")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRequire(settings, scene, "colliders", HasContact,
                               "explicit step with increments of the velocity that a body could change"));
  MpmSettingsRefuseIf(scene->scheme.numbers.rk_relax, settings, "rk_relax", "not with colliders; allowed: false");
  MpmSettingsRefuseIf(scene->scheme.basis->wall_nodes > 1, settings, "colliders",
                      "open splines have no nodes at places; allowed: without spline_ends open");
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    MpmSettingsRefuseIf(scene->step.drift[a].value != 0 && !scene->scheme.space.finite, settings, "colliders",
                        "particles drift past it; allowed: drift 0, or kinematics finite");
  PetscCall(PetscNew(&r.colliders));
  scene->layout.colliders = r.colliders;
  PetscCall(ReadAll(&r, sizeof scene->colliders, scene->colliders));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- bodies of particles ---- */

/* A number above 0 of a body over that of the scene. */
static PetscErrorCode ReadRatio(Reader *r, const yaml_node_t *block, const char key[], PetscReal scenes,
                                PetscReal *ratio)
{
  PetscReal value;

  PetscFunctionBegin;
  if (!Find(r, block, key)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ReadNumbers(r, block, key, PETSC_TRUE, &value));
  *ratio = value / scenes;
  REFUSE_IF(!(value > 0) || !isnormal(*ratio), r, key,
            "allowed: greater than 0, and not out of range beside the scene's");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadPpc(Reader *r, const yaml_node_t *block, Body *body)
{
  const MpmLayout *l = &r->scene->layout;
  PetscReal        value;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(body->ppc, l->ppc, MPM_MAX_DIM));
  if (!Find(r, block, "ppc")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ReadNumbers(r, block, "ppc", PETSC_TRUE, &value));
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

static PetscErrorCode ReadFile(Reader *r, const yaml_node_t *block, Body *body)
{
  const char *path = Scalar(Find(r, block, "path"));

  PetscFunctionBegin;
  REFUSE_IF(!path || !*path || strlen(path) >= sizeof body->file->path, r, "path",
            "allowed: the name of a CSV or HDF5 file of particles");
  PetscCall(MpmTextAdd(&r->text, ", path: %s", path));
  PetscCall(MpmGivenRead(path, r->scene->layout.dim, &body->file));
  REFUSE_IF(body->file->has[MPM_GIVEN_POISSON - MPM_GIVEN_VOLUME] ||
                body->file->has[MPM_GIVEN_FIXED - MPM_GIVEN_VOLUME],
            r, "path", "it has a column poisson or fixed; allowed: x, y, z, volume, mass and young");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadBody(void *reader, const yaml_node_t *block)
{
  Reader          *r                 = (Reader *)reader;
  const MpmScene  *scene             = r->scene;
  const MpmLayout *l                 = &scene->layout;
  const char      *modulus           = scene->law->solid ? "young" : "bulk";
  const char      *names[MOST_WORDS] = {"shape", "velocity", "density", modulus, "ppc"};
  Body            *body              = &r->bodies[r->n];
  PetscReal        unit[MPM_PROPERTIES];

  PetscFunctionBegin;
  MpmSettingsRefuseIf(r->n == MOST_BODIES, r->settings, r->option, "allowed: at most %d bodies", MOST_BODIES);
  MpmMaterialUnits(scene, unit);
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++) body->ratio[w] = 1;
  r->body = &body->place;
  PetscCall(ReadShape(r, block, "file"));
  if (!r->body->shape) names[4] = "path";
  PetscCall(CheckKeys(r, block, 5, names));
  PetscCall(MpmTextAdd(&r->text, "%s{shape: %s", r->n ? ", " : "", r->body->shape ? r->body->shape->name : "file"));
  if (r->body->shape) {
    PetscCall(ReadShapeKeys(r, block));
    PetscCall(ReadPpc(r, block, body));
  } else
    PetscCall(ReadFile(r, block, body));
  PetscCall(ReadRatio(r, block, "density", scene->density > 0 ? scene->density : 1, &body->ratio[MPM_MASS]));
  PetscCall(ReadRatio(r, block, modulus,
                      scene->law->solid ? unit[MPM_STIFFNESS]
                                        : (scene->density > 0 ? scene->density : 1) * PetscSqr(scene->wave_speed),
                      &body->ratio[MPM_STIFFNESS]));
  if (Find(r, block, "velocity")) PetscCall(ReadNumbers(r, block, "velocity", PETSC_FALSE, body->velocity));
  for (PetscInt a = 0; a < l->dim; a++) body->velocity[a] /= scene->wave_speed;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The lattice sites between which a body is, in each direction; their number is added to room. */
static PetscErrorCode FindSites(Reader *r, Body *body, PetscReal *room)
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
    REFUSE_IF((lo[a] < -ON_SURFACE && l->grid[a].ends[0] != MPM_SYMMETRY) ||
                  (hi[a] > l->grid[a].cells + ON_SURFACE && l->grid[a].ends[1] != MPM_SYMMETRY) || hi[a] <= 0 ||
                  lo[a] >= l->grid[a].cells,
              r, "place", "it reaches beyond the grid; allowed: a body within it, or beyond an end of symmetry");
    body->from[a] = (PetscInt)floor(PetscMax(lo[a], 0) * body->ppc[a]);
    body->end[a]  = (PetscInt)ceil(PetscMin(hi[a], l->grid[a].cells) * body->ppc[a]);
    sites *= body->end[a] - body->from[a];
  }
  *room += sites;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses the particle at x of body r->n, which another body or a collider, of a number, contains. */
static PetscErrorCode RefusePlace(const Reader *r, const PetscReal x[], const char other[], PetscInt number)
{
  char at[96] = "";

  PetscFunctionBegin;
  for (PetscInt a = 0; a < r->scene->layout.dim; a++)
    (void)snprintf(at + strlen(at), sizeof at - strlen(at), "%s%.6g", a ? ", " : "", x[a] * r->scene->cell_width);
  PetscCall(MpmSettingsRefuse(r->settings, r->option,
                              "place of body %" PetscInt_FMT ": its particle at (%s) is inside %s %" PetscInt_FMT
                              "; allowed: where nothing else is",
                              r->n + 1, at, other, number));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsInside(const MpmCollider *body, PetscInt dim, const PetscReal x[])
{
  PetscReal normal[MPM_MAX_DIM];

  return body->shape && body->shape->distance(body, dim, x, normal) < -ON_SURFACE ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Takes the particle at x into the layout, unless something else is there: a shape without an end, such as a half space, ends
   where a collider begins.
*/
static PetscErrorCode Take(Reader *r, PetscInt bodies, const PetscReal x[], PetscBool *taken)
{
  const MpmLayout *l  = &r->scene->layout;
  const Body      *of = &r->bodies[r->n];
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

/* Gives the particle that was taken its properties, in units of one of the scene's material that fills 1 / ppc of a cell. */
static PetscErrorCode Weigh(const Reader *r, PetscInt64 at, const PetscReal unit[])
{
  const Body *of         = &r->bodies[r->n];
  MpmGiven   *to         = r->scene->layout.given;
  PetscReal   of_file[3] = {of->ratio[MPM_VOLUME], NAN, of->ratio[MPM_STIFFNESS]};

  PetscFunctionBegin;
  if (of->file && of->file->has[0]) of_file[0] = of->file->column[MPM_GIVEN_VOLUME][at] / unit[MPM_VOLUME];
  of_file[1] = of->ratio[MPM_MASS] * of_file[0];
  if (of->file && of->file->has[1]) of_file[1] = of->file->column[MPM_GIVEN_MASS][at] / unit[MPM_MASS];
  if (of->file && of->file->has[2]) of_file[2] = of->file->column[MPM_GIVEN_YOUNG][at] / unit[MPM_STIFFNESS];
  REFUSE_IF(!isnormal(of_file[0]) || !isnormal(of_file[1]) || !isnormal(of_file[2]), r, "path",
            "a volume, mass or modulus is out of range beside the scene's; allowed: numbers of the scene's units");
  to->property[MPM_VOLUME][to->particles]    = of_file[0];
  to->property[MPM_MASS][to->particles]      = of_file[1];
  to->property[MPM_STIFFNESS][to->particles] = of_file[2];
  to->particles++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Place(Reader *r, PetscInt bodies, const PetscReal unit[])
{
  const MpmLayout *l      = &r->scene->layout;
  const Body      *of     = &r->bodies[r->n];
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
  REFUSE_IF(l->given->particles == before, r, "place",
            "no particle is inside; allowed: a larger body, or more cells or ppc");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Properties that all particles have alike are not kept. */
static PetscErrorCode KeepDifferent(MpmLayout *l)
{
  MpmGiven *given = l->given;

  PetscFunctionBegin;
  for (PetscInt w = MPM_NO_PROPERTY + 1; w < MPM_PROPERTIES; w++) {
    for (PetscInt64 id = 0; given->property[w] && id < given->particles && !l->varies[w]; id++)
      if (given->property[w][id] != 1) l->varies[w] = PETSC_TRUE;
    if (!l->varies[w]) PetscCall(PetscFree(given->property[w]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PlaceAll(Reader *r)
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
  for (PetscInt w = MPM_NO_PROPERTY + 1; w < MPM_PROPERTIES; w++)
    if (w != MPM_MOBILITY) PetscCall(PetscMalloc1((size_t)room, &l->given->property[w]));
  for (r->n = 0; r->n < n; r->n++) PetscCall(Place(r, n, unit));
  PetscCall(KeepDifferent(l));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bodies are at finite strain, each with its own velocity. */
static PetscErrorCode CheckBodies(const MpmSettings *settings, MpmScene *scene)
{
  static const char *const of_all[] = {"drift", "velocity", "mach", "layout"};

  PetscFunctionBegin;
  MpmSettingsRefuseIf(!scene->scheme.space.finite, settings, "bodies", "allowed: with kinematics finite");
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(of_all); i++)
    MpmSettingsRefuseIf(MpmSettingsSource(settings, of_all[i]) != MPM_FROM_DEFAULT, settings, of_all[i],
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
  Reader         r = {.settings = settings, .scene = scene, .option = "bodies", .read = ReadBody};
  PetscErrorCode ierr;

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, "bodies")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckBodies(settings, scene));
  PetscCall(PetscCalloc1(MOST_BODIES + 1, &r.bodies));
  ierr = ReadAll(&r, sizeof scene->bodies, scene->bodies);
  if (!ierr) ierr = PlaceAll(&r);
  for (PetscInt b = 0; b < MOST_BODIES; b++) PetscCall(MpmGivenDestroy(&r.bodies[b].file));
  PetscCall(PetscFree(r.bodies));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}
