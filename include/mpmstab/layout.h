/* Layout: the grid, the particles in it at rest, and what they are made of. */
#pragma once
#include <mpmstab/boundary.h>
#include <mpmstab/formulation.h>
#include <mpmstab/fraction.h>

#define MPM_MAX_COUNTS 64

/*S
   MpmCounts - numbers of particles in cells 0 .. n - 1, repeated over the grid; before: in the cells before each of
   them. n = 1: as many in every cell. voids: some have none.
S*/
typedef struct {
  PetscInt   n, of[MPM_MAX_COUNTS];
  PetscInt64 before[MPM_MAX_COUNTS + 1];
  PetscBool  voids;
} MpmCounts;

/*S
   MpmMaterial - what particles are made of: density and stiffness of the second material over the first's, and the
   cells between which it is.
S*/
typedef enum { MPM_MATERIAL_UNIFORM, MPM_MATERIAL_TWO, MPM_MATERIAL_GRADED } MpmMaterialKind;

typedef struct {
  MpmMaterialKind kind;
  PetscReal       density, stiffness, inclusion[2];
} MpmMaterial;

/*S
   MpmLayout - a grid and the particles that rest in it. Lengths are in cells.

   Sites fill all cells, counts of them in each; particle id is at site first + id, and particles is how many there are.
   ppc is the number of sites in the fullest cell. offset and jitter are in particle spacings, and seed is what jitter
   and random initial data are hashed from. cluster is the part of its cell that particles are spread over. half_width
   is half of a particle's width. varies says in which properties particles differ. name is the option's word.
S*/
typedef struct {
  const char  *name;
  MpmDirection grid;
  MpmCounts    counts;
  PetscInt     ppc;
  PetscInt64   sites, first, particles, seed;
  MpmFraction  offset;
  PetscReal    jitter, cluster[2], half_width;
  MpmMaterial  material;
  PetscBool    varies[MPM_PROPERTIES];
} MpmLayout;

/* Not collective. Whether the domain has no ends. */
static inline PetscBool MpmLayoutIsPeriodic(const MpmLayout *layout)
{
  return layout->grid.ends[0] == MPM_PERIODIC ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. Whether every cell has its particles. */
static inline PetscBool MpmLayoutIsFull(const MpmLayout *layout)
{
  return layout->particles == layout->sites && !layout->counts.voids ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. Whether all cells are alike and there is no end, so that Fourier modes do not mix. */
PetscBool MpmLayoutIsUniform(const MpmLayout *layout);

/* Not collective. Gives every cell the same number of particles. */
void MpmLayoutSetPpc(MpmLayout *layout, PetscInt ppc);

/* Not collective. The property that an operation weighs particles with, or MPM_NO_PROPERTY where all have the same. */
MpmProperty MpmLayoutWeight(const MpmLayout *layout, MpmOpKind kind);
