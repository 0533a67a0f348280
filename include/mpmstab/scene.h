/* Scene: everything a task needs to know, checked and immutable. */
#pragma once
#include "base/progress.h"
#include <mpmstab/basis.h>
#include <mpmstab/formulation.h>
#include "scene/settings.h"
#include <mpmstab/table.h>
#include <mpmstab/verdict.h>

/*S
   MpmExpect - what a scene says must come out; has_* says which of them it says.
S*/
typedef struct {
  PetscBool     has_verdict, has_kind, has_growth, has_spectrum, has_error, has_energy, has_critical, has_share;
  MpmVerdict    verdict;
  MpmGrowthKind kind;
  PetscReal     growth[2], spectrum[2], error[2], energy[2], critical[2], share[2];
} MpmExpect;

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
   MpmAxis - what a map goes over along one of its axes: points equally spaced numbers, fractions where they have short
   terms.
S*/
typedef enum { MPM_AXIS_COURANT, MPM_AXIS_DRIFT, MPM_AXIS_OFFSET, MPM_AXIS_PPC } MpmAxisKind;
extern const char *const MpmAxisNames[];

typedef struct {
  MpmAxisKind kind;
  MpmFraction from, to;
  PetscInt    points;
} MpmAxis;

/*S
   MpmScene - one problem. Units: length and time are the user's, everything else follows THEORY.md, section 1:
   courant k = c dt / h, drift delta = U0 dt / h in cells per step, offset and jitter in particle spacings.

   table is what the readers read. nodes: of the whole grid, one more than cells between walls. Particle id is number
   first + id of a layout that fills all cells with sites; particles are those that there are. ppc: in the cells that
   have most. half_width: of a particle, in cells. cluster: the part of its cell that particles are spread over.
S*/
typedef struct {
  const MpmFormulation *formulation;
  const MpmBasis       *basis;
  const MpmTransfer    *transfer;
  MpmTransferNumbers    numbers;
  MpmTable             *table;
  MpmEnd                ends[2];
  const char           *task, *layout;
  char                  boundary[64];
  PetscInt              dim, cells, nodes, ppc, mode;
  PetscInt64            sites, first, particles, seed, steps, output_every, checkpoint_every;
  MpmCounts             counts;
  MpmMaterial           material;
  PetscReal       cluster[2], half_width, length, cell_width, wave_speed, courant, dt, jitter, amplitude, tolerance;
  MpmFraction     offset, drift;
  MpmInitial      initial;
  PetscBool       stagger, measure, survey, weights, source_term, ringing;
  MpmProgressWish progress;
  PetscInt        phases, modes, layouts, powers, pseudospectrum; /* powers, pseudospectrum 0: none */
  MpmAxis         axes[2];
  char            output[PETSC_MAX_PATH_LEN], xmf[PETSC_MAX_PATH_LEN]; /* "": none */
  char            json[PETSC_MAX_PATH_LEN], csv[PETSC_MAX_PATH_LEN], mode_file[PETSC_MAX_PATH_LEN];
  char            checkpoint[PETSC_MAX_PATH_LEN], restart[PETSC_MAX_PATH_LEN];
  MpmExpect       expect;
} MpmScene;

/*
   MpmSceneCreate - reads and checks a scene for a task: file (NULL: none), then command line.

   Collective on PETSC_COMM_WORLD. Refuses bad input with one message (see errors.h).
*/
PetscErrorCode MpmSceneCreate(const char task[], const char path[], MpmScene **scene);
PetscErrorCode MpmSceneDestroy(MpmScene **scene);

/*
   Collective. How particles are renewed, where they are, and what holds at the ends: refuses what does not exist, and
   makes the table. Called by MpmSceneCreate.
*/
PetscErrorCode MpmSettingsScheme(const MpmSettings *settings, MpmScene *scene);

/* Collective. Refuses an option, and says why, when the scene's formulation cannot; names those that can. */
PetscErrorCode MpmSettingsRequire(const MpmSettings *settings, const MpmScene *scene, const char option[],
                                  PetscBool (*can)(const MpmFormulation *), const char why[]);

/* Collective. How many particles there are in which cells, and where in them. Called by MpmSceneCreate. */
PetscErrorCode MpmSettingsLayout(const MpmSettings *settings, MpmScene *scene);

/* Not collective. As many particles in every cell. */
void MpmSceneSetPpc(MpmScene *scene, PetscInt ppc);

/* Collective. What must come out. Called by MpmSceneCreate, when initial data are known. */
PetscErrorCode MpmSettingsExpect(const MpmSettings *settings, const MpmScene *scene, MpmExpect *expect);

/* Collective. What a map goes over. Called by MpmSceneCreate for the task map. */
PetscErrorCode MpmSettingsAxes(const MpmSettings *settings, MpmScene *scene);

/* Collective. What particles are made of, once the table is there. Called by MpmSceneCreate. */
PetscErrorCode MpmSettingsMaterial(const MpmSettings *settings, MpmScene *scene);

/* Collective. The files a scene writes: each can be written, and no two are the same. Called by MpmSceneCreate. */
PetscErrorCode MpmSettingsFiles(const MpmSettings *settings, MpmScene *scene);

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

/* Collective. Refuses work on a scene that needs more memory than there is; see MpmMemoryCheck. */
PetscErrorCode MpmSceneCheckMemory(MPI_Comm comm, const MpmScene *scene, PetscReal bytes, const char what[]);

/* Not collective. The grid's one direction: its cells, nodes and ends. */
static inline MpmDirection MpmSceneDirection(const MpmScene *scene)
{
  return (MpmDirection){.cells = scene->cells, .nodes = scene->nodes, .ends = {scene->ends[0], scene->ends[1]}};
}

/*
   Not collective. Whether the solution of the scene's continuous problem is known: from such initial data, in a domain
   filled from end to end, or a bar from the left end to a free one somewhere inside.
*/
PetscBool MpmSceneHasExact(const MpmScene *scene);

/* Not collective. The exact solution of the scene, for an amplitude of the caller's choice. */
MpmProfile MpmSceneProfile(const MpmScene *scene, PetscReal amplitude);

/* Not collective. The numbers of particles in the cells that repeat, with commas between them. */
#define MPM_COUNTS_TEXT (8 * MPM_MAX_COUNTS)
PetscErrorCode MpmSceneCountsText(const MpmScene *scene, size_t room, char text[]);

/*
   Not collective. The power of two that the state is divided by at the start, so that its largest field is of
   order 1 whatever the scene's units are. Values and errors take it back.
*/
PetscInt MpmSceneExponent(const MpmScene *scene);
