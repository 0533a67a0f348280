/*
   The transfers. P is P2G and W is G2P; g = P q is the node field of the particle field q that a filter F acts on.

   flip, pic, blend  F = s + (1 - s) W P. flip has s = 1, so that particles gain the grid's increments, pic s = 0, and
                     blend the option blend_ratio. Brackbill and Ruppel 1986; Harlow 1964; Zhu and Bridson 2005, also
                     Stomakhin et al. 2013, where 0.95 is used

   xpic              of order m: F = W sum_{r<m} (I - P W)^r P = I - (I - W P)^m. Order 1 is pic, and large orders
                     approach nullspace. Hammerquist and Nairn 2017

   fmpm              of order m. P2G divides by the lumped mass of a node. The full mass matrix would divide by P W
                     besides, and FMPM does so approximately: whatever particles take from the grid, they take of

                       B g = sum_{r<m} (I - P W)^r g,    which approaches (P W)^{-1} g

                     instead of the node field g. So velocities become v_p = W B (v_i + a_i), nothing of the old v_p is
                     kept, and stresses are updated from GRAD B of the nodal velocity. xpic of the same order has the
                     same filter, but takes the increment a_i and the gradient as they are. Nairn and Hammerquist 2021;
                     that the gradients take B too is read in the author's program, NairnMPM,
                     UpdateStrainsFirstTask.cpp

   nullspace         F = W (P W)^{-1} P takes the null space of P2G out, which is particle data that no node feels. It
                     is the projection with all nodes and particles of the grid at once. Gritton and Berzins (2017)
                     filter cell by cell: they take from the particles of each cell the part that the cell's own nodes
                     do not feel.

   apic              pic, and an affine velocity field C_p (x - x_p): P2G takes v_p + C_p (x_i - x_p) at node i, and

                       C_p = sum_i phi_ip v_i (x_i - x_p) / D_p,    D_p = sum_i phi_ip (x_i - x_p)^2

                     Jiang, Schroeder, Selle, Teran and Stomakhin 2015

   tpic              Taylor PIC: apic with C_p = sum_i v_i dphi_ip/dx, which is not the affine field that fits the nodes
                     best. On hats the two are the same. Nakamura, Matsumura and Mizutani 2023, Taylor particle-in-cell
                     transfer and kernel correction for material point method

   aflip             the velocities of flip with the affine part of apic. With v_i the velocity on the nodes, of P2G of
                     velocity and affine part, and w_i = v_i + a_i the new one,

                       v_p = G2P w_i + ratio (v_p - G2P v_i),    C_p = sum_i phi_ip w_i (x_i - x_p) / D_p

                     With a ratio of 1 velocities gain G2P a_i, and with 0 it is apic. A node has three numbers of a
                     wave, P2G of the velocity and of the affine part and the increment, so there is no closed form of
                     two amplification factors. Fei, Guo, Wu, Huang and Gao 2021

   asflip            aflip with a correction of positions, which lets particles separate more easily,

                       x_p = x_p + dt (G2P w_i + b ratio (v_p - G2P v_i)),    b = 0 where a particle is compressed

                     A linear step does not see the correction: it is proportional to the perturbation, and moves a
                     particle in a velocity that is the same everywhere and a stress that is 0. What a perturbation of
                     places changes is of second order. So in this program asflip is aflip. Fei et al. 2021
*/
#include <mpmstab/table.h>
#include <math.h>
#include <string.h>

/* ---- filters ---- */

/* s + (1 - s) W P. MpmTableAppend adds what belongs to an affine part. */
static PetscErrorCode AppendShare(MpmTable *table, PetscReal s, PetscInt particle, PetscInt node)
{
  PetscFunctionBegin;
  PetscCall(MpmTableAppend(table, (MpmOp)SCALE(particle, s)));
  PetscCall(MpmTableAppend(table, (MpmOp)G2P_TIMES(particle, node, 1 - s, ONE)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Blend(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscFunctionBegin;
  PetscCall(AppendShare(table, numbers->ratio, particle, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FromGrid(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscFunctionBegin;
  (void)numbers;
  PetscCall(AppendShare(table, 0, particle, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AffineFlip(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
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

static PetscErrorCode Nullspace(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscInt solution;

  PetscFunctionBegin;
  PetscCall(MpmTableNode(table, node, &solution));
  PetscCall(MpmTableAppend(table, (MpmOp)SOLVE(solution, node)));
  PetscCall(FromGrid(table, numbers, particle, solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* term -= P W term, with W term in the field scratch and P W term in smoothed; sum += term. */
static PetscErrorCode NextTerm(MpmTable *table, PetscInt scratch, PetscInt smoothed, PetscInt term, PetscInt sum)
{
  PetscFunctionBegin;
  PetscCall(MpmTableAppend(table, (MpmOp)SCALE(scratch, 0)));
  PetscCall(MpmTableAppend(table, (MpmOp)G2P(scratch, term, ONE)));
  PetscCall(MpmTableAppend(table, (MpmOp)P2G(smoothed, scratch)));
  PetscCall(MpmTableImpose(table, smoothed));
  PetscCall(MpmTableAppend(table, (MpmOp)ADD_TIMES(term, smoothed, -1)));
  PetscCall(MpmTableAppend(table, (MpmOp)ADD(sum, term)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The registers of a sum. They are those of an earlier sum of the same node field, if there is one. */
static PetscErrorCode Registers(MpmTable *table, PetscInt node, PetscInt *scratch, PetscInt *smoothed, PetscInt *term,
                                PetscInt *sum)
{
  PetscFunctionBegin;
  if (*sum == MPM_NONE) {
    PetscCall(MpmTableScratch(table, scratch));
    PetscCall(MpmTableNode(table, node, smoothed));
    PetscCall(MpmTableNode(table, node, term));
    PetscCall(MpmTableNode(table, node, sum));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *term     = *sum - 1;
  *smoothed = *sum - 2;
  for (PetscInt o = 0; o < table->nops; o++)
    if (table->ops[o].kind == MPM_G2P && table->ops[o].src == *term) *scratch = table->ops[o].dst;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B of a node field. With m = 1 it is the field itself. */
static PetscErrorCode Sum(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt node, PetscInt *sum)
{
  PetscInt scratch = MPM_NONE, smoothed, term;

  PetscFunctionBegin;
  if (numbers->order == 1) {
    *sum = node;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(Registers(table, node, &scratch, &smoothed, &term, sum));
  PetscCall(MpmTableAppend(table, (MpmOp)COPY(term, node)));
  PetscCall(MpmTableAppend(table, (MpmOp)COPY(*sum, node)));
  for (PetscInt r = 1; r < numbers->order; r++) PetscCall(NextTerm(table, scratch, smoothed, term, *sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Xpic(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscInt sum = MPM_NONE;

  PetscFunctionBegin;
  PetscCall(Sum(table, numbers, node, &sum));
  PetscCall(FromGrid(table, numbers, particle, sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- symbols, as functions of alpha, that of P W. With an affine part alpha has that of both parts. ---- */

static PetscReal FlipSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  (void)numbers, (void)alpha;
  return 1;
}

static PetscReal FromGridSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  (void)numbers;
  return alpha;
}

static PetscReal BlendSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  return numbers->ratio + (1 - numbers->ratio) * alpha;
}

static PetscReal XpicSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  return 1 - pow(1 - alpha, (double)numbers->order);
}

static PetscReal NullspaceSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  (void)numbers;
  return alpha > 0 ? 1 : 0;
}

static PetscReal SharpSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  PetscReal sum = 0;

  for (PetscInt r = 0; r < numbers->order; r++) sum += pow(1 - alpha, (double)r);
  return sum;
}

/* ---- values of options ---- */

static PetscReal Ratio(const MpmSchemeNumbers *numbers)
{
  return numbers->ratio;
}

static PetscReal AffineRatio(const MpmSchemeNumbers *numbers)
{
  return numbers->affine_ratio;
}

static PetscReal Order(const MpmSchemeNumbers *numbers)
{
  return (PetscReal)numbers->order;
}

/* ---- the list ---- */

/* What is proved of a filter between W P and 1, and of apic. */
#define PROVED .quiet = PETSC_TRUE, .leftmost = PETSC_TRUE, .step_bound = PETSC_TRUE

static const MpmTransfer flip = {.name          = "flip",
                                 .summary       = "particles gain increments from the grid",
                                 .reference     = "Brackbill and Ruppel 1986",
                                 .filter_symbol = FlipSymbol,
                                 PROVED};

static const MpmTransfer pic = {.name          = "pic",
                                .summary       = "particles take values from the grid",
                                .reference     = "Harlow 1964",
                                .filter        = FromGrid,
                                .filter_symbol = FromGridSymbol,
                                PROVED};

static const MpmTransfer blend = {.name          = "blend",
                                  .summary       = "blend_ratio of flip, the rest of pic",
                                  .reference     = "Zhu and Bridson 2005",
                                  .option        = "blend_ratio",
                                  .number        = Ratio,
                                  .filter        = Blend,
                                  .filter_symbol = BlendSymbol,
                                  PROVED};

static const MpmTransfer xpic = {.name          = "xpic",
                                 .summary       = "pic with its smoothing taken back, to xpic_order terms",
                                 .reference     = "Hammerquist and Nairn 2017",
                                 .option        = "xpic_order",
                                 .number        = Order,
                                 .filter        = Xpic,
                                 .filter_symbol = XpicSymbol,
                                 .quiet         = PETSC_TRUE,
                                 .leftmost      = PETSC_TRUE};

static const MpmTransfer nullspace = {
    .name          = "nullspace",
    .summary       = "flip without the null space of P2G (data that no node feels), of the whole grid at once",
    .reference     = "after Gritton and Berzins 2017",
    .filter        = Nullspace,
    .filter_symbol = NullspaceSymbol};

static const MpmTransfer apic = {.name = "apic",
                                 .summary =
                                     "particles take values and an affine field from the grid; momentum schemes only",
                                 .reference     = "Jiang, Schroeder, Selle, Teran and Stomakhin 2015",
                                 .affine        = PETSC_TRUE,
                                 .mls_bound     = PETSC_TRUE,
                                 .filter        = FromGrid,
                                 .filter_symbol = FromGridSymbol,
                                 PROVED};

static const MpmTransfer tpic = {.name      = "tpic",
                                 .summary   = "apic with the gradient of the basis functions; momentum schemes only",
                                 .reference = "Nakamura, Matsumura and Mizutani 2023",
                                 .affine    = PETSC_TRUE,
                                 .taylor    = PETSC_TRUE,
                                 .filter    = FromGrid,
                                 .filter_symbol = FromGridSymbol};

static const MpmTransfer aflip = {.name    = "aflip",
                                  .summary = "velocities of flip with the affine field of apic; momentum schemes only",
                                  .reference = "Fei, Guo, Wu, Huang and Gao 2021",
                                  .option    = "aflip_ratio",
                                  .number    = AffineRatio,
                                  .affine    = PETSC_TRUE,
                                  .filter    = AffineFlip};

static const MpmTransfer asflip = {.name      = "asflip",
                                   .summary   = "aflip; a linear step does not see its correction of positions",
                                   .reference = "Fei, Guo, Wu, Huang and Gao 2021",
                                   .option    = "aflip_ratio",
                                   .number    = AffineRatio,
                                   .affine    = PETSC_TRUE,
                                   .same_as   = "aflip",
                                   .filter    = AffineFlip};

static const MpmTransfer fmpm = {.name = "fmpm",
                                 .summary =
                                     "particles take values by xpic_order terms of the full mass matrix's inverse",
                                 .reference     = "Nairn and Hammerquist 2021",
                                 .option        = "xpic_order",
                                 .number        = Order,
                                 .filter        = Xpic,
                                 .sharpen       = Sum,
                                 .filter_symbol = XpicSymbol,
                                 .sharp_symbol  = SharpSymbol,
                                 .quiet         = PETSC_TRUE};

const MpmTransfer *const MpmTransfers[] = {&flip, &pic,   &blend,  &xpic, &nullspace, &apic,
                                           &tpic, &aflip, &asflip, &fmpm, NULL};

const MpmTransfer *MpmTransferFind(const char name[])
{
  for (PetscInt t = 0; MpmTransfers[t]; t++)
    if (!strcmp(MpmTransfers[t]->name, name)) return MpmTransfers[t];
  return NULL;
}
