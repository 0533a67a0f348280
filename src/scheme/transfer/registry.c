/* The list of transfers. */
#include <mpmstab/transfer.h>
#include <string.h>

extern const MpmTransfer MpmFlip, MpmPic, MpmBlend, MpmXpic, MpmNullspace, MpmApic, MpmTpic, MpmAflip, MpmAsflip,
    MpmFmpm;

const MpmTransfer *const MpmTransfers[] = {&MpmFlip, &MpmPic,   &MpmBlend,  &MpmXpic, &MpmNullspace, &MpmApic,
                                           &MpmTpic, &MpmAflip, &MpmAsflip, &MpmFmpm, NULL};

const MpmTransfer *MpmTransferFind(const char name[])
{
  for (PetscInt t = 0; MpmTransfers[t]; t++)
    if (!strcmp(MpmTransfers[t]->name, name)) return MpmTransfers[t];
  return NULL;
}
