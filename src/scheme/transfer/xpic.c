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

PetscErrorCode MpmTransferSum(MpmTable *table, const MpmTransferNumbers *numbers, PetscInt node, PetscInt *sum)
{
  PetscInt scratch, smoothed, term;

  PetscFunctionBegin;
  *sum = node;
  if (numbers->order == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmTableScratch(table, &scratch));
  PetscCall(MpmTableNode(table, node, &smoothed));
  PetscCall(MpmTableNode(table, node, &term));
  PetscCall(MpmTableNode(table, node, sum));
  PetscCall(MpmTableAppend(table, (MpmOp)COPY(term, node)));
  PetscCall(MpmTableAppend(table, (MpmOp)COPY(*sum, node)));
  for (PetscInt r = 1; r < numbers->order; r++) PetscCall(NextTerm(table, scratch, smoothed, term, *sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTransferXpic(MpmTable *table, const MpmTransferNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscInt sum;

  PetscFunctionBegin;
  PetscCall(MpmTransferSum(table, numbers, node, &sum));
  PetscCall(MpmTransferFromGrid(table, numbers, particle, sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmTransferXpicSymbol(const MpmTransferNumbers *numbers, PetscReal alpha)
{
  return 1 - pow(1 - alpha, (double)numbers->order);
}

PetscReal MpmTransferOrder(const MpmTransferNumbers *numbers)
{
  return (PetscReal)numbers->order;
}

const MpmTransfer MpmXpic = {.name          = "xpic",
                             .summary       = "pic with its smoothing taken back, to xpic_order terms",
                             .reference     = "Hammerquist and Nairn 2017",
                             .option        = "xpic_order",
                             .number        = MpmTransferOrder,
                             .filter        = MpmTransferXpic,
                             .filter_symbol = MpmTransferXpicSymbol,
                             .leftmost      = PETSC_TRUE,
                             .null_factor   = MpmTransferForgets};
