/* Hash: random numbers that are functions of a seed and an id, so they are the same on any number of ranks. */
#pragma once
#include <mpmstab/compat.h>
#include <stdint.h>

/* The increment of splitmix64's counter: 2^64 over the golden ratio, made odd. */
#define MPM_HASH_INCREMENT 0x9E3779B97F4A7C15u

/*
   MpmHashMix - splitmix64's output function: it spreads the bits of a counter over a 64-bit word.

   Not collective. Source: Steele, Lea and Flood 2014.
*/
static inline uint64_t MpmHashMix(uint64_t z)
{
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

/*
   MpmHash - a random number in [0,1) for a seed and a global id, such as that of a particle.

   Not collective. The number is the same on any number of ranks, since it depends on seed and id alone. docs/theory.md,
   section 1, fixes it.
*/
static inline PetscReal MpmHash(PetscInt64 seed, PetscInt64 id)
{
  return (PetscReal)(MpmHashMix((uint64_t)seed + ((uint64_t)id + 1) * MPM_HASH_INCREMENT) >> 11) * 0x1p-53;
}
