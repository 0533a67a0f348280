/* Lists of blocks (blocks.h), and the rigid bodies of a scene: the option colliders. */
#include "base/hash.h"
#include "base/suggest.h"
#include "scene/blocks.h"
#include <math.h>
#include <string.h>

const char *MpmBlockScalar(const yaml_node_t *node)
{
  return node && node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : NULL;
}

const yaml_node_t *MpmBlockFind(const MpmBlockReader *r, const yaml_node_t *block, const char key[])
{
  for (const yaml_node_pair_t *pair = block->data.mapping.pairs.start; pair < block->data.mapping.pairs.top; pair++) {
    const char *name = MpmBlockScalar(yaml_document_get_node(r->document, pair->key));

    if (name && !strcmp(name, key)) return yaml_document_get_node(r->document, pair->value);
  }
  return NULL;
}

/* Refuses a word that is in no list, and names those that are. */
static PetscErrorCode RefuseWord(const MpmBlockReader *r, const char key[], const char word[], PetscInt n,
                                 const char *const names[])
{
  MpmText        why = {NULL, 0};
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(MpmSuggestAdd(&why, word, n, names));
  ierr =
      MpmSettingsRefuse(r->settings, r->option, "%s of body %" PetscInt_FMT ": allowed: %s", key, r->n + 1, why.text);
  MpmTextFree(&why);
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlockReadWord(const MpmBlockReader *r, const yaml_node_t *block, const char key[], PetscInt n,
                                const char *const names[], PetscInt *which)
{
  const char *word = MpmBlockScalar(MpmBlockFind(r, block, key));

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
static PetscErrorCode ReadList(MpmBlockReader *r, const yaml_node_t *node, const char key[], PetscInt n,
                               PetscReal value[])
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
    const char *text =
        MpmBlockScalar(list ? yaml_document_get_node(r->document, node->data.sequence.items.start[a]) : node);

    REFUSE_IF(!text || !MpmFractionParse(text, &number), r, key, why);
    value[a] = number.value;
    PetscCall(MpmTextAdd(&r->text, "%s%.15g", a ? ", " : "", value[a]));
  }
  if (n > 1) PetscCall(MpmTextAdd(&r->text, "]"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlockReadNumbers(MpmBlockReader *r, const yaml_node_t *block, const char key[], PetscBool one,
                                   PetscReal value[])
{
  PetscFunctionBegin;
  PetscCall(MpmTextAdd(&r->text, ", %s: ", key));
  PetscCall(ReadList(r, MpmBlockFind(r, block, key), key, one ? 1 : r->scene->layout.dim, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The velocity of a rigid body: one for all times, or rows of a time and the velocity then. */
static PetscErrorCode ReadMotion(MpmBlockReader *r, const yaml_node_t *node)
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

PetscErrorCode MpmBlockBeginFile(MpmBlockReader *r, const yaml_node_t *block, const char allowed[], size_t room,
                                 char where[], const char **path)
{
  PetscFunctionBegin;
  *path = MpmBlockScalar(MpmBlockFind(r, block, "path"));
  REFUSE_IF(!*path || !**path || strlen(*path) >= PETSC_MAX_PATH_LEN, r, "path", allowed);
  (void)snprintf(where, room, "%s: path of body %" PetscInt_FMT ":", r->option, r->n + 1);
  PetscCall(MpmTextAdd(&r->text, ", path: %s", *path));
  PetscCall(MpmTextAdd(r->settings->files, "%s\n", *path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlockReadShapeKeys(MpmBlockReader *r, const yaml_node_t *block)
{
  const MpmColliderShape *shape = r->body->shape;
  const PetscInt          dim   = r->scene->layout.dim;
  const char             *path;
  char                    where[64];

  PetscFunctionBegin;
  for (PetscInt k = 0; shape->key[k]; k++) {
    const MpmColliderKey holds = shape->holds[k];
    PetscReal           *value = r->body->value[k], size = 0;

    if (holds == MPM_KEY_FILE) {
      PetscCall(MpmBlockBeginFile(r, block, "allowed: the name of an HDF5 file with a signed distance", sizeof where,
                                  where, &path));
      PetscCall(MpmDistanceRead(where, path, dim, r->scene->cell_width, &r->body->grid));
      continue;
    }
    PetscCall(MpmBlockReadNumbers(r, block, shape->key[k], holds >= MPM_KEY_SIZE ? PETSC_TRUE : PETSC_FALSE, value));
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

PetscErrorCode MpmBlockCheckKeys(const MpmBlockReader *r, const yaml_node_t *block, PetscInt n, const char *names[])
{
  PetscFunctionBegin;
  for (PetscInt k = 0; r->body->shape && r->body->shape->key[k]; k++) names[n++] = r->body->shape->key[k];
  for (const yaml_node_pair_t *pair = block->data.mapping.pairs.start; pair < block->data.mapping.pairs.top; pair++) {
    const char *name = MpmBlockScalar(yaml_document_get_node(r->document, pair->key));
    PetscInt    i    = 0;

    while (name && i < n && strcmp(name, names[i])) i++;
    if (!name || i == n) PetscCall(RefuseWord(r, name ? name : "a key", name, n, names));
    REFUSE_IF(MpmBlockFind(r, block, name) != yaml_document_get_node(r->document, pair->value), r, name,
              "it is given a second time; allowed: once");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlockReadShape(MpmBlockReader *r, const yaml_node_t *block, const char more[])
{
  const char *names[MPM_MOST_WORDS];
  PetscInt    n = 0, which;

  PetscFunctionBegin;
  for (; MpmColliderShapes[n]; n++) names[n] = MpmColliderShapes[n]->name;
  if (more) names[n] = more;
  PetscCall(MpmBlockReadWord(r, block, "shape", n + (more ? 1 : 0), names, &which));
  r->body->shape = MpmColliderShapes[which];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A body at rest that contains no node would do nothing, and one that contains all leaves nothing to move. */
static PetscErrorCode CheckPlace(const MpmBlockReader *r)
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
  REFUSE_IF(!inside, r, "shape",
            "it contains no node of the grid; allowed: a body that does, as large as a cell at least");
  REFUSE_IF(inside == nodes[0] * nodes[1] * nodes[2], r, "shape",
            "it contains all nodes of the grid; allowed: a part of them (the normal of a plane points away from it)");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The stiffness of a body that pushes, per mass, so 1 / time^2; in units of (c / h)^2 when it is read. */
static PetscErrorCode ReadPush(MpmBlockReader *r, const yaml_node_t *block)
{
  MpmScene *scene = r->scene;
  char      why[256];

  PetscFunctionBegin;
  REFUSE_IF(MpmFormulationReads(scene->scheme.formulation, "rk"), r, "contact",
            "penalty is not in the stages of a step; allowed: with another formulation than rk");
  PetscCall(MpmBlockReadNumbers(r, block, "stiffness", PETSC_TRUE, &r->body->stiffness));
  REFUSE_IF(!(r->body->stiffness > 0), r, "stiffness", "allowed: greater than 0");
  r->body->stiffness *= PetscSqr(scene->cell_width / scene->wave_speed);
  (void)snprintf(
      why, sizeof why,
      "penalty needs places, which a linear step has not; allowed: with kinematics finite. The limit k of the step "
      "is 1 / k^2 = 1 / k0^2 + s / 4, k0 without it, s = %.6g (docs/floors.md)",
      (double)r->body->stiffness);
  REFUSE_IF(!scene->scheme.space.finite, r, "contact", why);
  scene->scheme.space.loaded = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadCollider(void *reader, const yaml_node_t *block)
{
  MpmBlockReader *r                     = (MpmBlockReader *)reader;
  const char     *names[MPM_MOST_WORDS] = {"shape", "contact", "velocity", NULL}, *contacts[MPM_MOST_WORDS];
  PetscInt        n                     = 0, which;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(r->n == MPM_MAX_COLLIDERS, r->settings, "colliders", "allowed: at most %d bodies",
                      MPM_MAX_COLLIDERS);
  r->body = &r->colliders->body[r->n];
  PetscCall(MpmBlockReadShape(r, block, NULL));
  for (; MpmContacts[n]; n++) contacts[n] = MpmContacts[n]->name;
  PetscCall(MpmBlockReadWord(r, block, "contact", n, contacts, &which));
  r->body->contact = MpmContacts[which];
  names[3]         = r->body->contact->pushes ? "stiffness" : "friction";
  PetscCall(MpmBlockCheckKeys(r, block, 4, names));
  PetscCall(MpmTextAdd(&r->text, "%s{shape: %s, contact: %s", r->n ? ", " : "", r->body->shape->name,
                       r->body->contact->name));
  PetscCall(MpmBlockReadShapeKeys(r, block));
  if (MpmBlockFind(r, block, "friction"))
    PetscCall(MpmBlockReadNumbers(r, block, "friction", PETSC_TRUE, &r->body->friction));
  REFUSE_IF(r->body->friction < 0, r, "friction", "allowed: from 0");
  REFUSE_IF(r->body->friction > 0 && !r->body->contact->rubs, r, "friction",
            "nothing slides on it; allowed: with contact slip or separating");
  if (MpmBlockFind(r, block, "velocity")) PetscCall(ReadMotion(r, MpmBlockFind(r, block, "velocity")));
  if (r->body->contact->pushes)
    PetscCall(ReadPush(r, block));
  else
    r->scene->scheme.space.collides = PETSC_TRUE;
  PetscCall(CheckPlace(r));
  r->colliders->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- lists of blocks ---- */

static PetscErrorCode ReadBlock(MpmBlockReader *r, const yaml_node_t *block)
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
  MpmBlockReader    *r = (MpmBlockReader *)context;
  const yaml_node_t *all;

  PetscFunctionBegin;
  r->document = document;
  all         = MpmBlockFind(r, root, r->option);
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

PetscErrorCode MpmBlockReadAll(MpmBlockReader *r, size_t room, char record[])
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
    if (ops[o].kind == MPM_REACT && f->node_ranks[ops[o].src] == MPM_VECTOR && f->affine != MPM_NONE) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode MpmSettingsReadColliders(const MpmSettings *settings, MpmScene *scene)
{
  MpmBlockReader r = {.settings = settings, .scene = scene, .option = "colliders", .read = ReadCollider};

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, "colliders")) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(
      MpmFormulationHas(scene->scheme.formulation, MPM_IMPLICIT), settings, "colliders",
      "a step with IMPLICIT solves for the velocities of all nodes at once, and colliders are not in its "
      "equations; allowed: an explicit formulation, such as usl or musl");
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
  PetscCall(MpmBlockReadAll(&r, sizeof scene->colliders, scene->colliders));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsForgetColliders(const MpmColliders **colliders)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; *colliders && i < (*colliders)->n; i++) {
    MpmDistance *grid = (*colliders)->body[i].grid;

    PetscCall(MpmDistanceDestroy(&grid));
  }
  PetscCall(PetscFree(*colliders));
  PetscFunctionReturn(PETSC_SUCCESS);
}
