/* Transfers: how particles get their new values from the grid. A transfer's operations take the place of FILTER. */
#pragma once
#include <mpmstab/formulation.h>

typedef struct MpmTable_ MpmTable;

/* The numbers that a transfer may be given: the order of xpic, and the share of flip in a blend. */
typedef struct {
  PetscInt  order;
  PetscReal ratio;
} MpmTransferNumbers;

/*S
   MpmTransfer - a filter F of a particle field. It acts on the field q when g = P q is on the nodes. P is P2G and W is
   G2P.

   name, summary, reference - the word of the option transfer, a line about it, and its source
   option        - the option that the transfer reads, or NULL
   affine        - particles carry an affine velocity field
   filter        - appends the operations of F to a table; NULL: F is the identity. particle is the number of field q
                   and node that of g.
   filter_symbol - the filter symbol: the symbol of P F over that of P, as a function of alpha, the symbol of P W. The
                   filter multiplies P q of a Fourier mode q by it. NULL: there is no closed form.
   null_factor   - the number by which F multiplies the null space of P2G, which is particle data that no node feels.
                   NULL where filter_symbol is NULL.
   number        - the value of option; NULL where option is NULL
S*/
typedef struct {
  const char *name, *summary, *reference, *option;
  PetscBool   affine;
  PetscErrorCode (*filter)(MpmTable *table, const MpmTransferNumbers *numbers, PetscInt particle, PetscInt node);
  PetscReal (*filter_symbol)(const MpmTransferNumbers *numbers, PetscReal alpha);
  PetscReal (*null_factor)(const MpmTransferNumbers *numbers);
  PetscReal (*number)(const MpmTransferNumbers *numbers);
} MpmTransfer;

/* Not collective. All transfers, NULL-terminated. */
extern const MpmTransfer *const MpmTransfers[];

/* Not collective. The transfer of a name, or NULL when there is none. */
const MpmTransfer *MpmTransferFind(const char name[]);

/* Not collective. The null_factor of transfers that keep nothing of the null space of P2G. It is 0. */
PetscReal MpmTransferForgets(const MpmTransferNumbers *numbers);

/*
   MpmTransferFromGrid - appends F = W P, the filter of pic and of apic. MpmTableAppend adds apic's affine part.

   Not collective.
*/
PetscErrorCode MpmTransferFromGrid(MpmTable *table, const MpmTransferNumbers *numbers, PetscInt particle,
                                   PetscInt node);
