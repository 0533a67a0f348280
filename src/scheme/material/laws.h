/*
   A law is one file of this folder and a line of the list in registry.c. It says what happens at one particle; the
   loops over particles, for each number of dimensions, are here.
*/
#pragma once
#include "scheme/material/tensors.h"
#include <mpmstab/material.h>

/* What a law is at one particle. g is its function of J = det F, which comes from a loop of its own (LawOfVolume). */
typedef void (*StressAt)(const MpmMaterialNumbers *, PetscInt dim, const PetscReal F[], PetscReal g, PetscReal tau[]);
typedef void (*TangentAt)(const MpmMaterialNumbers *, PetscInt dim, const PetscReal F[], PetscReal g,
                          const PetscReal dF[], PetscReal dtau[]);
typedef PetscReal (*EnergyAt)(const MpmMaterialNumbers *, PetscInt dim, const PetscReal F[], PetscReal g);

/*
   Replaces J - 1 of n particles by the law's function g. Logarithms and powers are in a loop of their own, so that the
   loops around them work on several particles at once. A law without such a function has none.
*/
typedef void (*LawOfVolume)(const MpmMaterialNumbers *, PetscInt n, PetscReal g[]);

/* For laws that read J - 1 itself. */
static inline void VolumeAlone(const MpmMaterialNumbers *m, PetscInt n, PetscReal g[])
{
  (void)m;
  (void)n;
  (void)g;
}

#define MPM_LAW_BLOCK 64
#define TENSOR(dim) ((dim) * (dim))
#define SYMMETRIC(dim) ((dim) * ((dim) + 1) / 2)

/* The arrays of a tensor from particle begin on, as variables that the loop over particles need not look up. */
#define FROM(at, arrays)                                                                                               \
  EACH (c, TENSOR(dim)) at[c] = (arrays)[c] + begin;
#define LOAD(to, at)                                                                                                   \
  EACH (c, TENSOR(dim)) to[c] = at[c][p];

#define EACH_PARTICLE INDEPENDENT for (PetscInt p = 0; p < count; p++)
#define FOR_BLOCKS                                                                                                     \
  for (PetscInt begin = 0, count; count = PetscMin(n - begin, MPM_LAW_BLOCK), begin < n; begin += MPM_LAW_BLOCK)

/* The function g of a block of particles. */
INLINE void VolumeBlock(const MpmMaterialNumbers *m, LawOfVolume of_volume, PetscInt dim, PetscInt count,
                        const PetscReal *const F[], PetscReal g[])
{
  if (!of_volume) return;
  EACH_PARTICLE
  {
    PetscReal f[9];

    LOAD(f, F)
    g[p] = VolumeChange(dim, f);
  }
  of_volume(m, count, g);
}

/* Sets the stress of n particles, its differential or their energy: of stress, tangent and energy two are NULL. */
INLINE void LawLoop(const PetscInt dim, StressAt stress, TangentAt tangent, EnergyAt energy, LawOfVolume of_volume,
                    const MpmMaterialNumbers *m, PetscInt n, const PetscReal *const F[], const PetscReal *const dF[],
                    PetscReal *const out[])
{
  const MpmMaterialNumbers material = *m;
  const PetscInt           numbers  = energy ? 1 : SYMMETRIC(dim);

  FOR_BLOCKS
  {
    const PetscReal *from[9], *along[9];
    PetscReal       *to[6], g[MPM_LAW_BLOCK] = {0};

    FROM(from, F)
    FROM(along, tangent ? dF : F)
    EACH (c, numbers) to[c] = out[c] + begin;
    VolumeBlock(&material, of_volume, dim, count, from, g);
    EACH_PARTICLE
    {
      PetscReal f[9], df[9], t[6];

      LOAD(f, from)
      LOAD(df, along)
      if (stress) stress(&material, dim, f, g[p], t);
      if (tangent) tangent(&material, dim, f, g[p], df, t);
      if (energy) t[0] = energy(&material, dim, f, g[p]);
      EACH (c, numbers) to[c][p] = t[c];
    }
  }
}

/* Calls a loop with the number of dimensions as a constant. */
#define EACH_DIM(Loop, ...)                                                                                            \
  switch (dim) {                                                                                                       \
  case 1:                                                                                                              \
    Loop(1, __VA_ARGS__);                                                                                              \
    break;                                                                                                             \
  case 2:                                                                                                              \
    Loop(2, __VA_ARGS__);                                                                                              \
    break;                                                                                                             \
  default:                                                                                                             \
    Loop(3, __VA_ARGS__);                                                                                              \
  }

/*
   The functions Stress, Tangent and Energy of a law's file, from what the law is at one particle and its functions of J
   (NULL: it reads none there).
*/
#define LAW_OF_PARTICLES(stress_at, stress_g, tangent_at, tangent_g, energy_at, energy_g)                              \
  static void Stress(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],                \
                     PetscReal *const tau[])                                                                           \
  {                                                                                                                    \
    EACH_DIM(LawLoop, stress_at, NULL, NULL, stress_g, m, n, F, NULL, tau)                                             \
  }                                                                                                                    \
                                                                                                                       \
  static void Tangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],               \
                      const PetscReal *const dF[], PetscReal *const dtau[])                                            \
  {                                                                                                                    \
    EACH_DIM(LawLoop, NULL, tangent_at, NULL, tangent_g, m, n, F, dF, dtau)                                            \
  }                                                                                                                    \
                                                                                                                       \
  static void Energy(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],                \
                     PetscReal psi[])                                                                                  \
  {                                                                                                                    \
    EACH_DIM(LawLoop, NULL, NULL, energy_at, energy_g, m, n, F, NULL, (PetscReal *const[]){psi})                       \
  }

#define LAW_FUNCTIONS .stress = Stress, .tangent = Tangent, .energy = Energy, .modulus = Modulus
