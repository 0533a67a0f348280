/*
   Lists of blocks, in a scene file or as the same text on the command line, such as

     [{shape: plane, point: [0.5, 0.1], normal: [0, 1], contact: separating, friction: 0.3}]
     [{shape: sphere, center: [0.5, 0.8], radius: 0.1, velocity: [0, -2], density: 900, young: 1e5}]

   They are of rigid bodies (colliders) and of bodies of particles (bodies). Both have the shapes of colliders.
*/
#pragma once
#include "base/text.h"
#include "base/yaml.h"
#include "scene/layout.h"
#include "scene/settings.h"

#define MPM_MOST_WORDS 24

typedef struct MpmBody_ MpmBody; /* settings_bodies.c has it */

/*
   option: what is read, colliders or bodies, of which n have been read. body: the rigid one that is read, or the place
   of the one of particles; text: what has been read, as records have it.
*/
typedef struct {
  const MpmSettings *settings;
  MpmScene          *scene;
  const char        *option;
  PetscInt           n;
  PetscErrorCode (*read)(void *reader, const yaml_node_t *block);
  MpmColliders    *colliders;
  MpmCollider     *body;
  MpmBody         *bodies;
  MpmMaterials     materials;
  yaml_document_t *document;
  MpmText          text;
} MpmBlockReader;

/* Ends with a message that names the body by its number, the key, and why it cannot be. */
#define REFUSE(r, key, why)                                                                                            \
  PetscCall(MpmSettingsRefuse((r)->settings, (r)->option, "%s of body %" PetscInt_FMT ": %s", key, (r)->n + 1, why))
#define REFUSE_IF(condition, r, key, why)                                                                              \
  do {                                                                                                                 \
    if (condition) REFUSE(r, key, why);                                                                                \
  } while (0)

/* Not collective. The text of a node, and the node of a key of a block; NULL: it has none. */
const char        *MpmBlockScalar(const yaml_node_t *node);
const yaml_node_t *MpmBlockFind(const MpmBlockReader *r, const yaml_node_t *block, const char key[]);

/*
   MpmBlockReadWord      - which of the names a key's word is
   MpmBlockReadNumbers   - finite numbers of a key, as many as the scene has directions or, where one, a single one
   MpmBlockReadShape     - the shape of a block; more: another word than those of the shapes, NULL: none
   MpmBlockCheckKeys     - refuses keys that a body of this shape does not have, and keys that are there twice. names:
                           room for those of all shapes, of which n are there, and those of the shape, which are added
   MpmBlockReadShapeKeys - the keys of its shape
   MpmBlockBeginFile     - begins a file that a key of a body names: where messages say that it is named. Outputs must
                           not overwrite it
   MpmBlockReadAll       - reads the list. record: room for the text that records have

   Collective. They refuse what is not allowed.
*/
PetscErrorCode MpmBlockReadWord(const MpmBlockReader *r, const yaml_node_t *block, const char key[], PetscInt n,
                                const char *const names[], PetscInt *which);
PetscErrorCode MpmBlockReadNumbers(MpmBlockReader *r, const yaml_node_t *block, const char key[], PetscBool one,
                                   PetscReal value[]);
PetscErrorCode MpmBlockReadShape(MpmBlockReader *r, const yaml_node_t *block, const char more[]);
PetscErrorCode MpmBlockCheckKeys(const MpmBlockReader *r, const yaml_node_t *block, PetscInt n, const char *names[]);
PetscErrorCode MpmBlockReadShapeKeys(MpmBlockReader *r, const yaml_node_t *block);
PetscErrorCode MpmBlockBeginFile(MpmBlockReader *r, const yaml_node_t *block, const char allowed[], size_t room,
                                 char where[], const char **path);
PetscErrorCode MpmBlockReadAll(MpmBlockReader *r, size_t room, char record[]);
