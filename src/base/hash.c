/* Random numbers from a seed and an id: splitmix64, its counter set by the id. */
#include "base/hash.h"

PetscReal MpmHash(PetscInt64 seed, PetscInt64 id)
{
  return (PetscReal)(MpmHashMix((uint64_t)seed + ((uint64_t)id + 1) * MPM_HASH_INCREMENT) >> 11) * 0x1p-53;
}
