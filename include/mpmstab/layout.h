/* Layout: the grid, the places of the particles at rest, and their materials. */
#pragma once
#include <mpmstab/boundary.h>
#include <mpmstab/collider.h>
#include <mpmstab/formulation.h>
#include <mpmstab/fraction.h>
#include <mpmstab/material.h>

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
               and s = 1 - abs(2 x / L - 1) in a periodic domain; x is the place in direction 0.
               MPM_MATERIAL_WAVE: the ratios go as ratio^sin(2 pi x / L), as in the gas of initial data simple_wave.
   density, stiffness - of the second material over those of the first
   inclusion - the box in which the second material is: for each direction two places, in cells
S*/
typedef enum { MPM_MATERIAL_UNIFORM, MPM_MATERIAL_TWO, MPM_MATERIAL_GRADED, MPM_MATERIAL_WAVE } MpmMaterialKind;
#define MPM_MATERIAL_KINDS 3 /* that the option material names */

typedef struct {
  MpmMaterialKind kind;
  PetscReal       density, stiffness, inclusion[MPM_MAX_DIM][2];
} MpmMaterial;

/*E
   MpmBalance - how the cells are shared among ranks.

   MPM_BALANCE_AUTO      - as particles where some rank would have 1.25 times the mean otherwise, and none move; else as
                           cells
   MPM_BALANCE_CELLS     - each rank has as many cells
   MPM_BALANCE_PARTICLES - each rank has as many particles at the start
E*/
typedef enum { MPM_BALANCE_AUTO, MPM_BALANCE_CELLS, MPM_BALANCE_PARTICLES } MpmBalance;
extern const char *const MpmBalanceNames[];

/*E
   MpmMarchWay - how a march is run.

   MPM_MARCH_FAST  - operations are joined to passes, in which blocks of particles stay in the cache
   MPM_MARCH_PLAIN - one operation after another. It comes to the same numbers but for rounding.
E*/
typedef enum { MPM_MARCH_FAST, MPM_MARCH_PLAIN } MpmMarchWay;
extern const char *const MpmMarchNames[];

/*S
   MpmSpan - particles at sites that follow one another along direction 0, where particles do not fill a box: the number
   of the first in the box, and its id. Spans are in the order of both, and end where the id of the next one begins.
S*/
typedef struct {
  PetscInt64 box, id;
} MpmSpan;

/*S
   MpmGiven - particles whose places a CSV or HDF5 file gives, or random numbers. Particle id of a file is that of line
   id + 2; every rank has all of them.

   path      - the file; of_steps: it is field output, whose last step is taken
   random    - the places are random; path is the word for it
   particles - how many there are
   column    - column[a]: the places along direction a, in cells; the others are those of the file, while it is read
   property  - their properties (MpmProperty), NULL: not there, so all have 1
   before    - before[a][c]: the number of particles before cell c along direction a
   has       - whether the file has volumes, masses, young, poisson and fixed
   unused    - the names of columns that nothing reads
   density   - the least and the largest mass over volume, over the scene's density
   of_bodies - of how many bodies they are; 0: they are not of the option bodies, which is path then
   velocity  - of particles of bodies along each direction, in units of c; else NULL
   material, materials - of particles of bodies of several materials, and these materials; NULL: all are of the scene's
S*/
#define MPM_GIVEN_COLUMNS 8
#define MPM_GIVEN_SAID 5
typedef struct {
  char       path[1024], unused[256];
  PetscInt64 particles, *before[MPM_MAX_DIM];
  PetscReal *column[MPM_GIVEN_COLUMNS], *property[MPM_PROPERTIES], density[2];
  PetscBool  has[MPM_GIVEN_SAID], random, of_steps;
  PetscInt   of_bodies;
  PetscReal *velocity[MPM_MAX_DIM];

  unsigned char *material;
  MpmMaterials  *materials;
} MpmGiven;

/*S
   MpmLayout - a grid and the particles that rest in it. Lengths are in cells. Arrays have one entry for each direction.

   In each direction, particle j of the n in cell i rests at i + (j + offset + jitter (r - 1/2)) / n, where r in [0,1)
   is hashed from seed and the number of the site; cluster then squeezes the places of a cell together. The particles of
   a cell are on the grid that is the product of those of the directions. Particles of a file are displaced by jitter
   (r - 1/2) / n cells, with r hashed from seed and id.

   Sites fill all cells. In one dimension they are numbered cell by cell. In more, a site has a number in each
   direction, and its number is that of its place in the box of all sites, direction 0 first. Particles take the sites
   of a box, and are numbered in the same way.

   name       - the word of the option layout
   dim        - the number of space dimensions
   grid       - cells, nodes and ends
   counts     - the numbers of sites in the cells, in one dimension
   ppc        - the number of sites of the fullest cell, in each direction
   sites      - the number of sites
   first      - the first site that has a particle, in each direction. In one dimension particle id is at site
                first + id.
   row        - the number of particles in each direction; particles is their product, but with spans
   shape, spans, nspans - the word of the option shape, and the particles of the box that are in it; spans is NULL where
                all are
   particles  - the number of particles
   seed       - jitter and random initial data are hashed from it
   offset, jitter - in particle spacings
   cluster    - the part of its cell that particles are spread over, in one dimension; all of it is 0, 1
   half_width - half of a particle's width
   material   - the materials of the particles
   varies     - varies[property]: particles differ in this property
   balance    - how the cells are shared among ranks
   march      - how a march is run
   ranks      - the number of ranks along each direction; 0: those with the fewest ghosts
   given      - the particles of a file, which take the place of those at sites; NULL: none
   colliders  - the rigid bodies; NULL: none
S*/
typedef struct {
  const char  *name;
  PetscInt     dim;
  MpmDirection grid[MPM_MAX_DIM];
  MpmCounts    counts;
  PetscInt     ppc[MPM_MAX_DIM];
  PetscInt64   sites, first[MPM_MAX_DIM], row[MPM_MAX_DIM], particles, seed;
  MpmFraction  offset[MPM_MAX_DIM];
  PetscReal    jitter, cluster[2], half_width[MPM_MAX_DIM];
  MpmMaterial  material;
  PetscBool    varies[MPM_PROPERTIES];
  MpmBalance   balance;
  MpmMarchWay  march;
  PetscInt     ranks[MPM_MAX_DIM];
  const char  *shape;
  PetscInt64   nspans;
  MpmSpan     *spans;
  MpmGiven    *given;

  const MpmColliders *colliders;
} MpmLayout;

/*
   Not collective. The numbers of cells and nodes of the grid, and of the sites in the fullest cell, over all
   directions.
*/
static inline PetscInt64 MpmLayoutCells(const MpmLayout *layout)
{
  PetscInt64 cells = 1;

  for (PetscInt a = 0; a < layout->dim; a++) cells *= layout->grid[a].cells;
  return cells;
}
static inline PetscInt64 MpmLayoutNodes(const MpmLayout *layout)
{
  PetscInt64 nodes = 1;

  for (PetscInt a = 0; a < layout->dim; a++) nodes *= layout->grid[a].nodes;
  return nodes;
}
static inline PetscInt MpmLayoutPpc(const MpmLayout *layout)
{
  PetscInt ppc = 1;

  for (PetscInt a = 0; a < layout->dim; a++) ppc *= layout->ppc[a];
  return ppc;
}

/*
   Not collective. The number of particles of a line along direction a that rest in the cells before a cell, without
   jitter.
*/
PetscInt64 MpmLayoutParticlesBefore(const MpmLayout *layout, PetscInt a, PetscInt cell);

/* Not collective. Whether the domain has no ends. */
static inline PetscBool MpmLayoutIsPeriodic(const MpmLayout *layout)
{
  for (PetscInt a = 0; a < layout->dim; a++)
    if (layout->grid[a].ends[0] != MPM_PERIODIC) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Not collective. Whether there is a particle at every site, and a site in every cell. */
static inline PetscBool MpmLayoutIsFull(const MpmLayout *layout)
{
  return !layout->given && layout->particles == layout->sites && !layout->counts.voids ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. Whether particles share no coordinate, so that they are in no lines. */
static inline PetscBool MpmLayoutIsScattered(const MpmLayout *layout)
{
  return layout->given || layout->jitter != 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. Whether all cells are alike and there are no ends, so that Fourier modes do not mix. */
PetscBool MpmLayoutIsUniform(const MpmLayout *layout);

/*
   Not collective. Gives every cell ppc particles in each direction, of width 1 / ppc. The layout's pattern must have
   one cell.
*/
void MpmLayoutSetPpc(MpmLayout *layout, PetscInt ppc);

/*
   Not collective. The property that multiplies what particles give or get in an operation, or MPM_NO_PROPERTY where it
   is the same for all particles. side: that of the operation.
*/
MpmProperty MpmLayoutWeight(const MpmLayout *layout, MpmOpKind kind, PetscInt side);
