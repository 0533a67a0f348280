/* Transfers: how particles get their new values from the grid. A transfer's operations take the place of FILTER. */
#pragma once
#include <mpmstab/formulation.h>

typedef struct MpmTable_ MpmTable;

/*
   The numbers that a scheme may be given. Those of transfers: the order of xpic and fmpm, the share of flip in a blend,
   and that in the velocities of an affine flip. Those of formulations: the part of the strain that verlet takes after
   the force, the method of rk, where its stages are, whether particles move in each of them (MpmRkPlaces) and whether
   its steps are relaxed, theta of the implicit step and how often it may be halved, and the share of the new velocity
   in that which particles of verlet and rk move with.
*/
struct MpmSchemeNumbers_ {
  PetscInt  order;
  PetscReal ratio, affine_ratio;
  PetscReal share, move_share;
  PetscInt  rk;
  MpmRkOn   rk_on;
  PetscInt  rk_places;
  PetscBool rk_relax;
  PetscReal theta;
  PetscInt  halvings;
};

/*S
   MpmTransfer - a filter F of a particle field. It acts on the field q when g = P q is on the nodes. P is P2G and W is
   G2P.

   name, summary, reference - the word of the option transfer, a line about it, and its source
   option        - the option that the transfer reads, or NULL
   affine        - particles carry an affine velocity field
   taylor        - the affine field is made of the gradient of the basis functions (G2P_SLOPE), not fitted (G2P_AFFINE)
   same_as       - the name of the transfer that has the same linear operations, or NULL; a survey leaves it out
   filter        - appends the operations of F to a table; NULL: F is the identity. particle is the number of field q
                   and node that of g.
   filter_symbol - the filter symbol: the symbol of P F over that of P, as a function of alpha, the symbol of P W. The
                   filter multiplies P q of a Fourier mode q by it, and at alpha = 0 the null space of P2G, which is
                   particle data that no node feels. NULL: there is no closed form.
   sharpen       - appends operations that make of a node field the field that particles take in G2P and GRAD, in the
                   node register *sharp, a new one for MPM_NONE, or that of the last time; NULL: they take the node
                   field itself
   sharp_symbol  - the symbol of sharpen, as a function of alpha; NULL where sharpen is NULL
   mls_bound     - with gradient mls, a formulation's mls_bound is proved for this transfer
   leftmost      - a formulation's leftmost is proved for this transfer: F is a function of W P between W P and 1, or P
                   F with its affine part is symmetric in the masses and between 0 and 1
   step_bound    - a formulation's step_bound may hold for this transfer: F is between 0 and 1 in the masses
   quiet         - particles gain no more energy than the nodes, whatever the layout; with an affine part where D is the
                   same at all places (docs/theory.md, section 12)
   number        - the value of option; NULL where option is NULL
   nlines, lines - of a transfer as text: its operations, on nparticles and nnodes registers of its own, of which the
                   first is q and g. filter puts them into a table.
S*/
struct MpmTransfer_ {
  const char *name, *summary, *reference, *option;
  PetscBool   affine, taylor, mls_bound, leftmost, quiet, step_bound;
  const char *same_as;
  PetscErrorCode (*filter)(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node);
  PetscErrorCode (*sharpen)(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt node, PetscInt *sharp);
  PetscReal (*filter_symbol)(const MpmSchemeNumbers *numbers, PetscReal alpha);
  PetscReal (*sharp_symbol)(const MpmSchemeNumbers *numbers, PetscReal alpha);
  PetscReal (*number)(const MpmSchemeNumbers *numbers);
  PetscInt     nlines, nparticles, nnodes;
  const MpmOp *lines;
};

/* Not collective. All transfers, NULL-terminated. */
extern const MpmTransfer *const MpmTransfers[];

/* Not collective. The transfer of a name, or NULL when there is none. */
const MpmTransfer *MpmTransferFind(const char name[]);
