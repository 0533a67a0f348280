/*
   XPIC of order m:

     F = W sum_{r<m} (I - P W)^r P = I - (I - W P)^m

   Order 1 is pic, and large orders approach nullspace. Source: Hammerquist and Nairn 2017.
*/
#include <mpmstab/table.h>
#include <math.h>

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

PetscErrorCode MpmTransferSum(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt node, PetscInt *sum)
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

PetscErrorCode MpmTransferXpic(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscInt sum = MPM_NONE;

  PetscFunctionBegin;
  PetscCall(MpmTransferSum(table, numbers, node, &sum));
  PetscCall(MpmTransferFromGrid(table, numbers, particle, sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmTransferXpicSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  return 1 - pow(1 - alpha, (double)numbers->order);
}

PetscReal MpmTransferOrder(const MpmSchemeNumbers *numbers)
{
  return (PetscReal)numbers->order;
}

const MpmTransfer MpmXpic = {.name          = "xpic",
                             .quiet         = PETSC_TRUE,
                             .summary       = "pic with its smoothing taken back, to xpic_order terms",
                             .reference     = "Hammerquist and Nairn 2017",
                             .option        = "xpic_order",
                             .number        = MpmTransferOrder,
                             .filter        = MpmTransferXpic,
                             .filter_symbol = MpmTransferXpicSymbol,
                             .leftmost      = PETSC_TRUE,
                             .null_factor   = MpmTransferForgets};
