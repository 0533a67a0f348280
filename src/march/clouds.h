/*
   Passes in more than one dimension over particles that share no coordinate with one another, as in a jittered layout.
   The particles go through a pass in clouds, in the order that they are in, and the maps act on bundles of node fields
   (scheme/bundles.h).
*/
#pragma once
#include "march/rows.h"
#include "scheme/bundles.h"
#include "scheme/lines.h"

/* A map between a particle field and one of the fields of a bundle, with one of the products of weights. */
typedef struct {
  PetscInt    product, lane, particle;
  PetscReal   a;
  MpmProperty weight;
} MpmCloudMap;

#define MPM_SIDE 4 /* lanes beside one another that are set at once */

/*
   What a spread gives of numbers that the particles of a cloud have taken from nodes: lane l of a side gets a[l] times
   the number at from + (l ^ swap) in the memory of a cloud.
*/
typedef struct {
  PetscInt  product, side, from, swap;
  PetscReal a[MPM_SIDE];
} MpmCloudTerm;

/* The same for a map along two axes: the numbers, in the row plan, of the kinds of its weights along the directions. */
typedef struct {
  PetscInt    kind[MPM_MAX_DIM], lane, particle;
  PetscReal   a;
  MpmProperty weight;
} MpmCloudCross;

/*
   Maps of a step of a row plan that are of one bundle, with no more kinds than a map of a bundle can have: map[begin]
   to
   map[end - 1] of the plan, in the order of their products and lanes, cross[first_cross] to cross[end_cross - 1], and
   term[first_term] to term[end_term - 1] in the order of their products and sides.
   kind[0] to kind[nkinds - 1] are the numbers, in the row plan, of its kinds of weights beside phi_ip. products: where
   its products begin in the memory of a cloud.
*/
typedef struct {
  PetscInt     bundle, begin, end, first_cross, end_cross, first_term, end_term, nkinds, products;
  PetscInt     kind[MPM_BUNDLE_KINDS];
  MpmBundleMap run;
} MpmCloudPart;

/*
   Node fields that a pass reads, or sums to, as a bundle. begin: where it begins in the memory for bundles, per node.
*/
typedef struct {
  PetscInt  n, width, begin, node[MPM_BUNDLE];
  PetscBool sums;
} MpmCloudBundle;

/*S
   MpmCloudPlan - what a row plan needs besides, to be run on clouds. Step s of it has part[first[s]] to
   part[first[s + 1] - 1]; width is the sum of the widths of all bundles, and products the numbers of a cloud's
   particles for all products of all parts.

   composed - scratch fields are never stored: the spreads give what they are made of
S*/
struct MpmCloudPlan_ {
  PetscInt       nparts, nmaps, ncrosses, nterms, nbundles, width, products, first[2 * MPM_MAX_PASS_OPS + 1];
  PetscBool      composed;
  MpmCloudPart   part[2 * MPM_MAX_PASS_OPS];
  MpmCloudMap    map[2 * MPM_MAX_PASS_OPS];
  MpmCloudCross  cross[2 * MPM_MAX_PASS_OPS];
  MpmCloudTerm   term[2 * MPM_MAX_PASS_OPS];
  MpmCloudBundle bundle[2 * (MPM_MAX_FIELDS + 1)];
};

/* Not collective. Compiles what a row plan needs besides. Particle fields from nstate on are scratch fields. */
void MpmCloudPlanCompile(const MpmRowPlan *rows, const MpmBasis *basis, PetscInt dim, PetscInt nstate,
                         MpmCloudPlan *plan);

/* Not collective. The numbers that the bundles of a plan take. */
PetscInt MpmCloudsSize(const MpmGrid *grid, const MpmCloudPlan *plan);

/* Not collective. Takes all particles through the pass, with memory for its bundles. Sums are set, ghosts included. */
PetscErrorCode MpmCloudsRun(const MpmMarchArrays *arrays, const MpmCloudPlan *plan, PetscReal bundles[]);
