/*
   Scene: one problem, its physics and its numerics, checked and never changed afterwards. What a task is to do with it
   (how many steps, which files, what must come out) is no part of it.
*/
#pragma once
#include <mpmstab/basis.h>
#include <mpmstab/errors.h>
#include <mpmstab/formulation.h>
#include <mpmstab/fraction.h>
#include <mpmstab/table.h>

#define MPM_MAX_COUNTS 64 /* cells after which the numbers of particles in counts repeat, at most */

/*S
   MpmCounts - how many particles there are in cells 0 .. n - 1; the pattern repeats over the grid.

   of[r] is the number in cell r, before[r] the number in the cells before it. n is 1 when every cell has as many. voids
   says that some cells of the grid have none.
S*/
typedef struct {
  PetscInt   n, of[MPM_MAX_COUNTS];
  PetscInt64 before[MPM_MAX_COUNTS + 1];
  PetscBool  voids;
} MpmCounts;

/*S
   MpmMaterial - what the particles are made of.

   density and stiffness are those of the second material over those of the first. inclusion holds the two ends, in
   cells, of the part of the domain that is of the second material (kind MPM_MATERIAL_TWO).
S*/
typedef enum { MPM_MATERIAL_UNIFORM, MPM_MATERIAL_TWO, MPM_MATERIAL_GRADED } MpmMaterialKind;

typedef struct {
  MpmMaterialKind kind;
  PetscReal       density, stiffness, inclusion[2];
} MpmMaterial;

/*S
   MpmScene - one problem. Length and time are in units of the user's choice; everything else follows from them
   (THEORY.md, section 1).

   formulation, basis, transfer - the scheme; numbers are the transfer's own, table is what the interpreters read
   ends                - what holds at the left and at the right end; boundary is the same as text
   cells, nodes        - of the whole grid; between walls there is one node more than cells
   length, cell_width  - of the domain and of a cell, in units of length
   wave_speed, dt      - c in length / time, and the time step
   courant             - the Courant number k = c dt / h
   drift               - cells that a particle moves per step, U0 dt / h
   sites               - places for particles in all cells; the first site that has a particle is first, and particle
                         id is at site first + id; particles is how many there are
   ppc                 - particles in the fullest cell; counts holds them cell by cell
   half_width          - of a particle, in cells
   offset, jitter      - place of a cell's first particle, and random displacement, in particle spacings; seed is that
                         of the random numbers
   cluster             - the part of its cell that the particles are squeezed into
   initial, mode, amplitude, stagger - the data that a run starts from: which, of which wave, how large, and whether
                         the field that is updated first starts half a step early
S*/
typedef struct {
  const MpmFormulation *formulation;
  const MpmBasis       *basis;
  const MpmTransfer    *transfer;
  MpmTransferNumbers    numbers;
  MpmTable             *table;
  MpmEnd                ends[2];
  const char           *layout;
  char                  boundary[64];
  PetscInt              dim, cells, nodes, ppc, mode;
  PetscInt64            sites, first, particles, seed;
  MpmCounts             counts;
  MpmMaterial           material;
  PetscReal             cluster[2], half_width, length, cell_width, wave_speed, courant, dt, jitter, amplitude;
  MpmFraction           offset, drift;
  MpmInitial            initial;
  PetscBool             stagger;
} MpmScene;

/*
   MpmSceneFromText - makes a scene from YAML text: the keys that 'mpmstab list options' prints, one 'key: value' a line
   or all in braces, such as "{formulation: usl, cells: 16, ppc: 2}".

   Collective on PETSC_COMM_WORLD: every rank gives the same text. What is not given has its default. The command line
   is not read. Keys that say what a task is to do (steps, output, tolerance) must exist, and their values are not
   looked at.

   Errors: PETSC_ERR_USER_INPUT, with a message that names the key, its value and what is allowed; *scene is then NULL.
*/
PetscErrorCode MpmSceneFromText(const char yaml[], MpmScene **scene);

/*
   MpmSceneFromFile - makes a scene from a YAML file, as MpmSceneFromText does from a text.

   Collective on PETSC_COMM_WORLD. The first rank reads the file.
*/
PetscErrorCode MpmSceneFromFile(const char path[], MpmScene **scene);

/* Not collective. Frees a scene and sets the pointer to NULL. */
PetscErrorCode MpmSceneDestroy(MpmScene **scene);

/* Not collective. Gives every cell ppc particles; what follows from that is set anew. */
void MpmSceneSetPpc(MpmScene *scene, PetscInt ppc);

/* Not collective. Whether particles move against the grid. */
static inline PetscBool MpmSceneDrifts(const MpmScene *scene)
{
  return scene->drift.value != 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. Whether the domain has no ends. */
static inline PetscBool MpmSceneIsPeriodic(const MpmScene *scene)
{
  return scene->ends[0] == MPM_PERIODIC ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. Whether every cell has its particles. */
static inline PetscBool MpmSceneIsFull(const MpmScene *scene)
{
  return scene->particles == scene->sites && !scene->counts.voids ? PETSC_TRUE : PETSC_FALSE;
}

/*
   MpmSceneCheckMemory - refuses work on a scene that needs more memory than there is.

   Collective. bytes: what the work takes on all ranks of comm; what: its name in the message.
*/
PetscErrorCode MpmSceneCheckMemory(MPI_Comm comm, const MpmScene *scene, PetscReal bytes, const char what[]);

/* Not collective. The grid's one direction: its cells, nodes and ends. */
static inline MpmDirection MpmSceneDirection(const MpmScene *scene)
{
  return (MpmDirection){.cells = scene->cells, .nodes = scene->nodes, .ends = {scene->ends[0], scene->ends[1]}};
}

/*
   MpmSceneHasExact - whether the exact solution of the scene's continuous problem is known.

   Not collective. It is known from some initial data, for particles that are all alike, in a domain that is filled from
   end to end, or for a bar from the left end to a free end inside the domain.
*/
PetscBool MpmSceneHasExact(const MpmScene *scene);

/* Not collective. The exact solution of the scene, for an amplitude of the caller's choice. */
MpmProfile MpmSceneProfile(const MpmScene *scene, PetscReal amplitude);

/* Not collective. The numbers of particles in the cells of the pattern, with commas between them. */
#define MPM_COUNTS_TEXT (8 * MPM_MAX_COUNTS)
PetscErrorCode MpmSceneCountsText(const MpmScene *scene, size_t room, char text[]);

/*
   MpmSceneExponent - the power of two that a run divides the state by at its start, so that its largest field is of
   order 1 whatever the scene's units are.

   Not collective. Values and errors that are printed are multiplied by it again.
*/
PetscInt MpmSceneExponent(const MpmScene *scene);
