/*
   Colliders: rigid bodies that act on nodal velocities, or push particles. The contact condition of a body makes P(y)
   of the velocity y, relative to the body, of a node inside it (docs/floors.md). Source: Stomakhin, Schroeder, Chai,
   Teran and Selle 2013, section 8
*/
#pragma once
#include <mpmstab/boundary.h>

#define MPM_MAX_COLLIDERS 8
#define MPM_COLLIDER_TIMES 16 /* the most times at which its velocity is given */
#define MPM_COLLIDER_KEYS 3   /* the largest number of keys that a shape has */

/*E
   MpmColliderKey - what a key of a shape holds: a place (in cells once it is read), a direction (of length 1), a
   positive length for each direction, one positive length, an angle between 0 and 90 degrees (in radians once it is
   read), or the name of a file with a signed distance.
E*/
typedef enum {
  MPM_KEY_PLACE,
  MPM_KEY_DIRECTION,
  MPM_KEY_SIZES,
  MPM_KEY_SIZE,
  MPM_KEY_ANGLE,
  MPM_KEY_FILE
} MpmColliderKey;

typedef struct MpmCollider_ MpmCollider;

/*S
   MpmDistance - a signed distance at the nodes of a grid: n along each direction, of which origin is the first, in
   cells of the scene, as are spacing and value. The last direction runs fastest.
S*/
typedef struct {
  PetscInt   n[MPM_MAX_DIM];
  PetscReal  origin[MPM_MAX_DIM], spacing[MPM_MAX_DIM];
  PetscReal *value;
} MpmDistance;

/*S
   MpmColliderShape - the shape of a body.

   key, holds - its keys in a scene, NULL after the last, and what they hold
   distance   - the signed distance of a place from the surface in cells, below 0 inside, and the direction in which it
                grows, which is outward. x has the place relative to that of the body at the start.
   extent     - the places between which it is, in cells; NULL: it has no end
S*/
typedef struct {
  const char    *name, *summary;
  const char    *key[MPM_COLLIDER_KEYS + 1];
  MpmColliderKey holds[MPM_COLLIDER_KEYS];
  PetscReal (*distance)(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[]);
  void (*extent)(const MpmCollider *body, PetscInt dim, PetscReal lo[], PetscReal hi[]);
} MpmColliderShape;

/*S
   MpmContact - a contact condition.

   rubs    - it can have friction
   linear  - without friction P is linear
   pushes  - instead, a particle at the depth d has the acceleration stiffness d along the normal (a penalty); project
             is NULL
   project - y = P(y), and slope = dP/dy, dim rows of dim numbers, of the branch that y is on
S*/
typedef struct {
  const char *name, *summary;
  PetscBool   rubs, linear, pushes;
  void (*project)(PetscReal friction, PetscInt dim, const PetscReal normal[], PetscReal y[], PetscReal slope[]);
} MpmContact;

/*S
   MpmCollider - a body. value: of its keys, in cells; friction: Coulomb's coefficient; velocity: at the times from 0
   on, in units of c, linear between two of them and constant after the last; pace: c in cells per unit of the scene's
   time; stiffness: of one that pushes, in (c / h)^2. grid: of a shape with MPM_KEY_FILE.
S*/
struct MpmCollider_ {
  const MpmColliderShape *shape;
  const MpmContact       *contact;
  PetscReal               value[MPM_COLLIDER_KEYS][MPM_MAX_DIM], friction, pace, stiffness;
  PetscInt                ntimes;
  PetscReal               time[MPM_COLLIDER_TIMES], velocity[MPM_COLLIDER_TIMES][MPM_MAX_DIM];
  MpmDistance            *grid;
};

/* The bodies of a scene. */
typedef struct {
  PetscInt    n;
  MpmCollider body[MPM_MAX_COLLIDERS];
} MpmColliders;

/* Not collective. The shapes and the conditions, NULL after the last. */
extern const MpmColliderShape *const MpmColliderShapes[];
extern const MpmContact *const       MpmContacts[];

/*
   Not collective. Whether all that the bodies do is linear in the velocity: they are at rest, and their conditions
   linear.
*/
PetscBool MpmCollidersAreLinear(const MpmColliders *colliders);

/* Not collective. Whether a body moves at some time. */
PetscBool MpmColliderMoves(const MpmCollider *body);

/* Not collective. How far a body has moved at a time, in cells, and its velocity then, in units of c. */
void MpmColliderMotion(const MpmCollider *body, PetscInt dim, PetscReal time, PetscReal way[], PetscReal velocity[]);

/*
   MpmCollidersPush      - adds to push what the bodies that push give a particle at x, in cells, as an acceleration in
                           units of c^2 / h, and returns its energy per mass in units of c^2. push: NULL for the energy
                           alone
   MpmCollidersStiffness - the sum of the stiffnesses of those bodies; 0: none pushes

   Not collective.
*/
PetscReal MpmCollidersPush(const MpmColliders *colliders, PetscInt dim, const PetscReal x[], PetscReal time,
                           PetscReal push[]);
PetscReal MpmCollidersStiffness(const MpmColliders *colliders);

/*
   MpmCollidersProject - what the bodies make of the velocity v of a node, one after the other.

   Not collective.

   Input Parameters:
+  x    - the place of the node, in cells
-  time - in the scene's unit

   Output Parameters:
+  v     - the new velocity, in units of c
-  slope - its derivative by the old one, dim rows of dim numbers

   Returns whether the node is inside a body. If it is in none, v and slope are left as they are.
*/
PetscBool MpmCollidersProject(const MpmColliders *colliders, PetscInt dim, const PetscReal x[], PetscReal time,
                              PetscReal v[], PetscReal slope[]);
