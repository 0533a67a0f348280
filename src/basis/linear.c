/* The hat function: phi = 1 - abs(x - x_i) / h. Source: the classical MPM (Sulsky, Chen and Schreyer 1994). */
#include <mpmstab/basis.h>

const MpmBasis MpmLinear = {.name        = "linear",
                            .summary     = "hat functions, one cell to either side of a node",
                            .reference   = "Sulsky, Chen and Schreyer 1994",
                            .reach_left  = 0,
                            .reach_right = 1,
                            .slope_sum   = 2,
                            .hat         = PETSC_TRUE,
                            .p2g_mass    = MpmHatP2GMass,
                            .kernel      = {[MPM_P2G]        = MpmHatP2G,
                                            [MPM_P2G_AFFINE] = MpmHatP2GAffine,
                                            [MPM_DIV]        = MpmHatDiv,
                                            [MPM_G2P]        = MpmHatG2P,
                                            [MPM_G2P_AFFINE] = MpmHatGrad, /* phi (x_i - x_p) / D is -1 and 1 */
                                            [MPM_GRAD]       = MpmHatGrad}};
