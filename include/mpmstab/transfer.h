/* Transfers: how particles are renewed from the grid, as operations that take the place of FILTER in a table. */
#pragma once
#include <mpmstab/formulation.h>

typedef struct MpmTable_ MpmTable;

/* What a transfer may be given: the order of xpic, the share of flip in a blend. */
typedef struct {
  PetscInt  order;
  PetscReal ratio;
} MpmTransferNumbers;

/*S
   MpmTransfer - a transfer: the filter F that acts on a particle field q once g = P q is on the nodes (P = P2G, W =
   G2P).

   filter appends the operations of F to a table; NULL: F is the identity. filter_symbol is what F leaves of a Fourier mode as
   the grid sees it, the symbol of P F over that of P, in terms of alpha, the symbol of P W; NULL: there is no closed
   form. null_factor is the number that F multiplies the null space of P2G with: particle data that no node feels. It is
   NULL where filter_symbol is. affine: particles carry an affine velocity
   field. option: the one that it reads, NULL: none; number: what that is set to.
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

/* Not collective. Looks a transfer up by name; NULL when there is none. */
const MpmTransfer *MpmTransferFind(const char name[]);

/* Not collective. null_factor of transfers that keep nothing of the null space of P2G: 0. */
PetscReal MpmTransferForgets(const MpmTransferNumbers *numbers);

/* Not collective. F = W P, the filter of pic; apic's too, whose affine part follows by itself. */
PetscErrorCode MpmTransferFromGrid(MpmTable *table, const MpmTransferNumbers *numbers, PetscInt particle,
                                   PetscInt node);
