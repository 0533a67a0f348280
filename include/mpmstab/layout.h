/* Layout: the grid, the places of the particles at rest, and their materials. */
#pragma once
#include <mpmstab/boundary.h>
#include <mpmstab/formulation.h>
#include <mpmstab/fraction.h>

#define MPM_MAX_COUNTS 64

/*S
   MpmCounts - numbers of sites for particles in the cells, as a pattern that repeats over the grid.

   n      - the number of cells in the pattern; 1 when all cells have the same number
   of     - of[i]: the number of sites in cell i of the pattern
   before - before[i]: the number of sites in the cells of the pattern before cell i; before[n]: in all of them
   voids  - some cells have none
S*/
typedef struct {
  PetscInt   n, of[MPM_MAX_COUNTS];
  PetscInt64 before[MPM_MAX_COUNTS + 1];
  PetscBool  voids;
} MpmCounts;

/*S
   MpmMaterial - the materials of the particles.

   kind      - MPM_MATERIAL_UNIFORM: all are of the first material. MPM_MATERIAL_TWO: those that rest inside the
               inclusion are of the second. MPM_MATERIAL_GRADED: the ratios go as ratio^s, where s = x / L between ends
               and s = 1 - abs(2 x / L - 1) in a periodic domain.
   density, stiffness - of the second material over those of the first
   inclusion - the places between which the second material is, in cells
S*/
typedef enum { MPM_MATERIAL_UNIFORM, MPM_MATERIAL_TWO, MPM_MATERIAL_GRADED } MpmMaterialKind;

typedef struct {
  MpmMaterialKind kind;
  PetscReal       density, stiffness, inclusion[2];
} MpmMaterial;

/*S
   MpmLayout - a grid and the particles that rest in it. Lengths are in cells.

   Particle j of the n in cell i rests at i + (j + offset + jitter (r - 1/2)) / n, where r in [0,1) is hashed from seed
   and the number of the site; cluster then squeezes the places of a cell together. Sites fill all cells and are
   numbered cell by cell. Particles take a part of them.

   name       - the word of the option layout
   grid       - cells, nodes and ends
   counts     - the numbers of sites in the cells
   ppc        - the number of sites in the fullest cell
   sites      - the number of sites
   first      - the site of particle 0; particle id is at site first + id
   particles  - the number of particles
   seed       - jitter and random initial data are hashed from it
   offset, jitter - in particle spacings
   cluster    - the part of its cell that particles are spread over; all of it is 0, 1
   half_width - half of a particle's width
   material   - the materials of the particles
   varies     - varies[property]: particles differ in this property
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

/* Not collective. Whether there is a particle at every site, and a site in every cell. */
static inline PetscBool MpmLayoutIsFull(const MpmLayout *layout)
{
  return layout->particles == layout->sites && !layout->counts.voids ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. Whether all cells are alike and there are no ends, so that Fourier modes do not mix. */
PetscBool MpmLayoutIsUniform(const MpmLayout *layout);

/* Not collective. Gives every cell ppc particles, of width 1 / ppc. The layout's pattern must have one cell. */
void MpmLayoutSetPpc(MpmLayout *layout, PetscInt ppc);

/*
   Not collective. The property that multiplies what particles give or get in an operation, or MPM_NO_PROPERTY where it
   is the same for all particles.
*/
MpmProperty MpmLayoutWeight(const MpmLayout *layout, MpmOpKind kind);
