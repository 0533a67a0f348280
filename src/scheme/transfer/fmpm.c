/*
   FMPM of order m. P2G divides by the lumped mass of a node. The full mass matrix would divide by P W besides, with P =
   P2G and W = G2P, and FMPM does so approximately: whatever particles take from the grid, they take of

     B g = sum_{r<m} (I - P W)^r g,    which approaches (P W)^{-1} g

   instead of the node field g. So velocities become v_p = W B (v_i + a_i), nothing of the old v_p is kept, and stresses
   are updated from GRAD B of the nodal velocity. Order 1 is pic. xpic of the same order has the same filter F = W B P
   of the old velocity, but takes the increment a_i and the gradient as they are.

   Source: Nairn and Hammerquist 2021. That the gradients take B too is read in the author's program, NairnMPM,
   UpdateStrainsFirstTask.cpp.
*/
#include <mpmstab/transfer.h>
#include <math.h>

static PetscReal SharpSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  PetscReal sum = 0;

  for (PetscInt r = 0; r < numbers->order; r++) sum += pow(1 - alpha, (double)r);
  return sum;
}

const MpmTransfer MpmFmpm = {.name      = "fmpm",
                             .quiet     = PETSC_TRUE,
                             .summary   = "particles take values by xpic_order terms of the full mass matrix's inverse",
                             .reference = "Nairn and Hammerquist 2021",
                             .option    = "xpic_order",
                             .number    = MpmTransferOrder,
                             .filter    = MpmTransferXpic,
                             .sharpen   = MpmTransferSum,
                             .filter_symbol = MpmTransferXpicSymbol,
                             .sharp_symbol  = SharpSymbol,
                             .null_factor   = MpmTransferForgets};
