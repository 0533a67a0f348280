/*
   TPIC, Taylor PIC: apic, but the affine part is the gradient of the new grid velocity by the gradients of the basis
   functions, C_p = sum_i v_i dphi_ip/dx. It is not the affine field that fits the nodes best. On hats the two are the
   same.

   Source: Nakamura, Matsumura and Mizutani 2023, Taylor particle-in-cell transfer and kernel correction for material
   point method.
*/
#include <mpmstab/transfer.h>

const MpmTransfer MpmTpic = {.name          = "tpic",
                             .summary       = "apic with the gradient of the basis functions; momentum schemes only",
                             .reference     = "Nakamura, Matsumura and Mizutani 2023",
                             .affine        = PETSC_TRUE,
                             .taylor        = PETSC_TRUE,
                             .filter        = MpmTransferFromGrid,
                             .filter_symbol = MpmTransferFromGridSymbol,
                             .null_factor   = MpmTransferForgets};
