/*
   The colliders of a scene: a list of blocks, in a scene file or as the same text on the command line, such as

     [{shape: plane, point: [0.5, 0.1], normal: [0, 1], contact: separating, friction: 0.3}]
*/
#include "base/suggest.h"
#include "base/text.h"
#include "base/yaml.h"
#include "scene/settings.h"
#include <math.h>
#include <string.h>

#define MOST_WORDS 16

/* body: the one that is read; text: what has been read, as records have it. */
typedef struct {
  const MpmSettings *settings;
  const MpmScene    *scene;
  MpmColliders      *colliders;
  MpmCollider       *body;
  yaml_document_t   *document;
  MpmText            text;
} Reader;

/* Ends with a message that names the body by its number, the key, and why it cannot be. */
#define REFUSE(r, key, why)                                                                                            \
  PetscCall(MpmSettingsRefuse((r)->settings, "colliders", "%s of body %" PetscInt_FMT ": %s", key,                     \
                              (r)->colliders->n + 1, why))
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
  ierr = MpmSettingsRefuse(r->settings, "colliders", "%s of body %" PetscInt_FMT ": %s", key, r->colliders->n + 1,
                           why.text);
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

/* Finite numbers of a key, as many as the scene has directions or, where one, a single one. */
static PetscErrorCode ReadNumbers(Reader *r, const yaml_node_t *block, const char key[], PetscBool one,
                                  PetscReal value[])
{
  const PetscInt     n    = one ? 1 : r->scene->layout.dim;
  const yaml_node_t *node = Find(r, block, key);
  const PetscBool    list = node && node->type == YAML_SEQUENCE_NODE ? PETSC_TRUE : PETSC_FALSE;
  MpmFraction        number;
  char               why[64];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(why, sizeof why,
                          n > 1 ? "allowed: %" PetscInt_FMT " finite numbers [a, b]" : "allowed: a finite number", n));
  REFUSE_IF(!node || (list && node->data.sequence.items.top - node->data.sequence.items.start != n) || (!list && n > 1),
            r, key, why);
  PetscCall(MpmTextAdd(&r->text, ", %s: %s", key, n > 1 ? "[" : ""));
  for (PetscInt a = 0; a < n; a++) {
    const char *text = Scalar(list ? yaml_document_get_node(r->document, node->data.sequence.items.start[a]) : node);

    REFUSE_IF(!text || !MpmFractionParse(text, &number), r, key, why);
    value[a] = number.value;
    PetscCall(MpmTextAdd(&r->text, "%s%.15g", a ? ", " : "", value[a]));
  }
  if (n > 1) PetscCall(MpmTextAdd(&r->text, "]"));
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

    PetscCall(ReadNumbers(r, block, shape->key[k], holds == MPM_KEY_SIZE ? PETSC_TRUE : PETSC_FALSE, value));
    for (PetscInt a = 0; a < dim; a++) {
      REFUSE_IF((holds == MPM_KEY_SIZES || (holds == MPM_KEY_SIZE && a == 0)) && !(value[a] > 0), r, shape->key[k],
                "allowed: greater than 0");
      size = hypot(size, value[a]);
    }
    REFUSE_IF(holds == MPM_KEY_DIRECTION && !(size > 0), r, shape->key[k], "allowed: not all 0");
    for (PetscInt a = 0; a < dim; a++) value[a] /= holds == MPM_KEY_DIRECTION ? size : r->scene->cell_width;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses keys that a body of this shape does not have, and keys that are there twice. */
static PetscErrorCode CheckKeys(const Reader *r, const yaml_node_t *block)
{
  const char *names[MOST_WORDS] = {"shape", "contact", "friction", "velocity"};
  PetscInt    n                 = 4;

  PetscFunctionBegin;
  for (PetscInt k = 0; r->body->shape->key[k]; k++) names[n++] = r->body->shape->key[k];
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

/* A body at rest that contains no node would do nothing, and one that contains all leaves nothing to move. */
static PetscErrorCode CheckPlace(const Reader *r)
{
  const MpmLayout *l      = &r->scene->layout;
  PetscInt         inside = 0, nodes[MPM_MAX_DIM] = {1, 1, 1}, at[MPM_MAX_DIM];
  PetscReal        x[MPM_MAX_DIM], normal[MPM_MAX_DIM];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < l->dim; a++) {
    nodes[a] = l->grid[a].nodes;
    if (r->body->velocity[a] != 0) PetscFunctionReturn(PETSC_SUCCESS);
  }
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

static PetscErrorCode ReadBody(Reader *r, const yaml_node_t *block)
{
  const char *names[MOST_WORDS];
  PetscInt    n = 0, which;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(!block || block->type != YAML_MAPPING_NODE, r->settings, "colliders",
                      "allowed: blocks such as [{shape: plane, point: [0.5, 0.1], normal: [0, 1], contact: slip}]");
  MpmSettingsRefuseIf(r->colliders->n == MPM_MAX_COLLIDERS, r->settings, "colliders", "allowed: at most %d bodies",
                      MPM_MAX_COLLIDERS);
  r->body = &r->colliders->body[r->colliders->n];
  for (; MpmColliderShapes[n]; n++) names[n] = MpmColliderShapes[n]->name;
  PetscCall(ReadWord(r, block, "shape", n, names, &which));
  r->body->shape = MpmColliderShapes[which];
  for (n = 0; MpmContacts[n]; n++) names[n] = MpmContacts[n]->name;
  PetscCall(ReadWord(r, block, "contact", n, names, &which));
  r->body->contact = MpmContacts[which];
  PetscCall(CheckKeys(r, block));
  PetscCall(MpmTextAdd(&r->text, "%s{shape: %s, contact: %s", r->colliders->n ? ", " : "", r->body->shape->name,
                       r->body->contact->name));
  PetscCall(ReadShapeKeys(r, block));
  if (Find(r, block, "friction")) PetscCall(ReadNumbers(r, block, "friction", PETSC_TRUE, &r->body->friction));
  REFUSE_IF(r->body->friction < 0, r, "friction", "allowed: from 0");
  REFUSE_IF(r->body->friction > 0 && !r->body->contact->rubs, r, "friction",
            "nothing slides on it; allowed: with contact slip or separating");
  if (Find(r, block, "velocity")) {
    PetscCall(ReadNumbers(r, block, "velocity", PETSC_FALSE, r->body->velocity));
    REFUSE_IF(!r->scene->scheme.space.finite, r, "velocity", "allowed: only with kinematics finite");
  }
  for (PetscInt a = 0; a < r->scene->layout.dim; a++) {
    r->body->pace[a] = r->body->velocity[a] / r->scene->cell_width;
    r->body->velocity[a] /= r->scene->wave_speed;
  }
  PetscCall(MpmTextAdd(&r->text, "}"));
  PetscCall(CheckPlace(r));
  r->colliders->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The document is the text behind a key. */
static PetscErrorCode ReadBodies(void *context, yaml_document_t *document, const yaml_node_t *root)
{
  Reader            *r = (Reader *)context;
  const yaml_node_t *all;

  PetscFunctionBegin;
  r->document = document;
  all         = Find(r, root, "colliders");
  if (all && all->type == YAML_SEQUENCE_NODE)
    for (const yaml_node_item_t *item = all->data.sequence.items.start; item < all->data.sequence.items.top; item++)
      PetscCall(ReadBody(r, yaml_document_get_node(document, *item)));
  else
    PetscCall(ReadBody(r, all));
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
  Reader         r    = {.settings = settings, .scene = scene};
  MpmText        yaml = {NULL, 0};
  PetscErrorCode ierr;

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
  scene->layout.colliders      = r.colliders;
  scene->scheme.space.collides = PETSC_TRUE;
  PetscCall(MpmTextAdd(&yaml, "{colliders: %s}", MpmSettingsText(settings, "colliders")));
  ierr = MpmYamlReadText("colliders", "colliders", yaml.text, ReadBodies, &r);
  MpmTextFree(&yaml);
  if (!ierr) (void)snprintf(scene->colliders, sizeof scene->colliders, "%s", r.text.text);
  MpmSettingsRefuseIf(!ierr && strlen(r.text.text) >= sizeof scene->colliders, settings, "colliders",
                      "allowed: a text of at most %zu characters", sizeof scene->colliders - 1);
  MpmTextFree(&r.text);
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}
