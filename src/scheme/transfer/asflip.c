/*
   ASFLIP: aflip with a correction of positions, which lets particles separate more easily,

     x_p = x_p + dt (G2P w_i + b ratio (v_p - G2P v_i)),    b = 0 where a particle is compressed

   Velocities and affine parts are those of aflip. A linear step does not see the correction: it is proportional to the
   perturbation, and moves a particle in a velocity that is the same everywhere and a stress that is 0. What a
   perturbation of places changes is of second order. So in this program asflip is aflip.

   Source: Fei, Guo, Wu, Huang and Gao 2021.
*/
#include <mpmstab/transfer.h>

const MpmTransfer MpmAsflip = {.name      = "asflip",
                               .summary   = "aflip; a linear step does not see its correction of positions",
                               .reference = "Fei, Guo, Wu, Huang and Gao 2021",
                               .option    = "aflip_ratio",
                               .number    = MpmTransferAffineRatio,
                               .affine    = PETSC_TRUE,
                               .same_as   = "aflip",
                               .filter    = MpmTransferAffineFlip};
