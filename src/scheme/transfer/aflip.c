/*
   AFLIP: the velocities of flip with the affine part of apic. With v_i the velocity on the nodes, of P2G of velocity
   and affine part, and w_i = v_i + a_i the new one,

     v_p = G2P w_i + ratio (v_p - G2P v_i),    C_p = sum_i phi_ip w_i (x_i - x_p) / D_p

   ratio is the option aflip_ratio. With 1 velocities gain G2P a_i, and with 0 it is apic. A node has three numbers of a
   wave, P2G of the velocity and of the affine part and the increment, so there is no closed form of two amplification
   factors.

   Source: Fei, Guo, Wu, Huang and Gao 2021, who also call it AFLIP.
*/
#include <mpmstab/table.h>

PetscErrorCode MpmTransferAffineFlip(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscFunctionBegin;
  if (numbers->affine_ratio < 1) {
    PetscCall(MpmTableAppendOwn(table, (MpmOp)SCALE(particle, numbers->affine_ratio)));
    PetscCall(MpmTableAppendOwn(table, (MpmOp)G2P_TIMES(particle, node, 1 - numbers->affine_ratio, ONE)));
  }
  PetscCall(MpmTableAppendAffine(table, (MpmOp)SCALE(particle, 0)));
  PetscCall(MpmTableAppendAffine(table, (MpmOp)G2P(particle, node, ONE)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmTransferAffineRatio(const MpmSchemeNumbers *numbers)
{
  return numbers->affine_ratio;
}

const MpmTransfer MpmAflip = {.name      = "aflip",
                              .summary   = "velocities of flip with the affine field of apic; momentum schemes only",
                              .reference = "Fei, Guo, Wu, Huang and Gao 2021",
                              .option    = "aflip_ratio",
                              .number    = MpmTransferAffineRatio,
                              .affine    = PETSC_TRUE,
                              .filter    = MpmTransferAffineFlip};
