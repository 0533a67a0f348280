/*
   APIC: particles take values from the grid, and with them an affine velocity field C_p (x - x_p). P2G takes the
   velocity v_p + C_p (x_i - x_p) at node i, and

     C_p = sum_i phi_ip v_i (x_i - x_p) / D_p,    D_p = sum_i phi_ip (x_i - x_p)^2

   Source: Jiang, Schroeder, Selle, Teran and Stomakhin 2015.
*/
#include <mpmstab/transfer.h>

const MpmTransfer MpmApic = {.name = "apic",
                             .summary =
                                 "particles take values and an affine field from the grid; momentum schemes only",
                             .quiet         = PETSC_TRUE,
                             .reference     = "Jiang, Schroeder, Selle, Teran and Stomakhin 2015",
                             .affine        = PETSC_TRUE,
                             .mls_bound     = PETSC_TRUE,
                             .filter        = MpmTransferFromGrid,
                             .filter_symbol = MpmTransferFromGridSymbol,
                             .leftmost      = PETSC_TRUE,
                             .step_bound    = PETSC_TRUE,
                             .null_factor   = MpmTransferForgets};
