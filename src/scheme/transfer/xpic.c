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

static PetscErrorCode Filter(MpmTable *table, const MpmTransferNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscInt scratch, smoothed, term, sum = node;

  PetscFunctionBegin;
  if (numbers->order > 1) {
    PetscCall(MpmTableScratch(table, &scratch));
    PetscCall(MpmTableNode(table, node, &smoothed));
    PetscCall(MpmTableNode(table, node, &term));
    PetscCall(MpmTableNode(table, node, &sum));
    PetscCall(MpmTableAppend(table, (MpmOp)COPY(term, node)));
    PetscCall(MpmTableAppend(table, (MpmOp)COPY(sum, node)));
    for (PetscInt r = 1; r < numbers->order; r++) PetscCall(NextTerm(table, scratch, smoothed, term, sum));
  }
  PetscCall(MpmTransferFromGrid(table, numbers, particle, sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal FilterSymbol(const MpmTransferNumbers *numbers, PetscReal alpha)
{
  return 1 - pow(1 - alpha, (double)numbers->order);
}

static PetscReal Number(const MpmTransferNumbers *numbers)
{
  return (PetscReal)numbers->order;
}

const MpmTransfer MpmXpic = {.name          = "xpic",
                             .summary       = "pic with its smoothing taken back, to xpic_order terms",
                             .reference     = "Hammerquist and Nairn 2017",
                             .option        = "xpic_order",
                             .number        = Number,
                             .filter        = Filter,
                             .filter_symbol = FilterSymbol,
                             .null_factor   = MpmTransferForgets};
