/* Critical: the largest stable Courant number, and the mode that limits it. */
#pragma once
#include <mpmstab/step_bound.h>
#include <mpmstab/verdict.h>

/*E
   MpmWaveType - what particles do in a wave of the lattice, by the share of their motion that is along beta: MPM_WAVE_P
   along it, by more than MPM_WAVE_SHARE; MPM_WAVE_S across it; MPM_WAVE_MIXED both, or there are modes of both types.
   MPM_WAVE_NONE: the formulation has no vector, or there is one dimension.
E*/
typedef enum { MPM_WAVE_NONE, MPM_WAVE_P, MPM_WAVE_S, MPM_WAVE_MIXED } MpmWaveType;
extern const char *const MpmWaveTypeNames[];
#define MPM_WAVE_SHARE 0.9

#define MPM_CRITICAL_WINDOWS 8

/*S
   MpmCriticalWindow - Courant numbers between which growth is beyond the tolerance, below a limit. growth: the largest
   that was seen there, at Courant number at. from is 0 where the smallest of all grows.

   MpmCriticalWindows - n of them, and at how many Courant numbers growth was looked at; 0: windows were not looked for.
S*/
typedef struct {
  PetscReal from, to, growth, at;
} MpmCriticalWindow;

typedef struct {
  PetscInt          n, looked;
  MpmCriticalWindow window[MPM_CRITICAL_WINDOWS];
} MpmCriticalWindows;

/*S
   MpmCritical - the result of the task critical. Growth is per step, and counts as none up to 1 + tolerance.

   courant     - the largest Courant number up to which there is no growth, but for windows, or the limit of the closed
                 form where that is less. 0: there is no stable Courant number. Infinite: none that is unstable was
                 found. NaN: undecided.
   stable_at, unstable_at - there is no growth at stable_at, and growth at unstable_at
   beta        - the phase of the mode that grows first at unstable_at, in each direction; NaN: no mode does, or its
                 trace has no phase
   wave        - what particles do in that mode
   null_share  - the part of this mode in the null space of P2G, which is particle data that no node feels; NaN: not
                 known
   threshold   - below stable_at there is no growth at all, but for rounding and windows
   fading      - without a threshold, growth - 1 fades as the Courant number to this power, and the limit comes from
                 tolerance alone. At rest such a scheme has courant 0.
   moving      - growth at the scene's own Courant number if particles at rest drifted (MpmCriticalMoving); NaN: it was
                 not asked for
   disputed    - courant is undecided because search and closed form contradict each other
   rounding    - where it is not 0: the growth that rounding alone may make at the limit found. It is more than
                 tolerance, so that courant is undecided.
   doubtful    - under drift, a Courant number below the limit at which amplification factors could not be told apart,
                 so that a window of instability may have been missed there; infinite: there is none
   followed    - under drift, amplification factors were followed over all Courant numbers below the limit, so that no
                 window was stepped over; else windows were looked for in steps
   windows     - at rest, where no theorem says that what grows at a Courant number grows at all larger ones: windows of
                 growth below courant
   closed, closed_beta - limit and phases by the closed form; NaN without one
   cell        - the symbols that the closed form takes at closed_beta
   bound       - no layout of such particles at rest, jittered or with gaps, grows up to this Courant number; 0: no such
                 bound is known
   quiet       - under drift, the Courant number up to which no step raises the energy of the particles in any of the
                 layouts that are met, so that they cannot ring (docs/theory.md, section 12); 0: no such number is known
   no_theorem  - of a formulation that has such numbers: the condition that does not hold here; NULL: all hold
   cure, cured - of a scheme without such a number: the first formulation that has one with the same basis and transfer,
                 and this number; NULL: none is known
   phases      - where phases of two or three directions were sampled: so many in (0, pi] of each; else 0
   asked       - growth and verdict at the scene's own Courant number
   assembled   - the result comes from the eigenvalues of the assembled operator; else from the symbol
   order       - the number of unknowns of the assembled operator
   nodal       - the number of unknowns of the nodes' own operator, of which the eigenvalues were taken; 0 where they
                 are of the assembled one
   pencil      - courant is where the nodes' own operator, linear in a power of the Courant number, first has the
                 eigenvalue -1; growth at stable_at and unstable_at says the same
   leftmost    - there are too many unknowns for all eigenvalues: growth is that of the leftmost one, which decides
                 here, and is found by a Krylov space
   bounded, bounds - of an assembled operator whose case asks for bounds: they were looked for, and what they are
   each        - of an assembled operator whose case asks for it: rows of a number for each particle, by id: the bounds
                 lone and particle as Courant numbers, and the velocities along each direction in the mode that grows
                 first, the largest of them 1; NaN: not known. NULL: not asked for. Freed with PetscFree.
   mode_at     - the particle that is fastest in this mode; id MPM_NONE: not known
   too_large   - the layout has more unknowns than eigenvalues are sought of, and the leftmost does not decide or was
                 not found: there are bounds, and courant is NaN
   evaluations - the number of times that growth was computed
   seconds     - the time that the search took
S*/
typedef struct {
  PetscReal      courant, stable_at, unstable_at, doubtful, beta[MPM_MAX_DIM], null_share, fading, moving[2];
  PetscReal      closed, closed_beta[MPM_MAX_DIM], bound, quiet, cured, rounding, seconds;
  PetscBool      threshold, assembled, disputed, followed, pencil, leftmost, bounded, too_large;
  PetscInt       order, nodal, phases;
  MpmWaveType    wave;
  PetscInt64     evaluations;
  MpmCellSymbols cell;
  MpmFinding     asked;
  MpmStepBounds  bounds;
  PetscReal     *each;
  MpmDecider     mode_at;

  const char           *no_theorem;
  const MpmFormulation *cure;
  MpmCriticalWindows    windows;
} MpmCritical;

/*S
   MpmCriticalCase - the case whose limit is sought: a scheme on a layout, with the drift of step. The Courant number of
   step matters only where growth at it is asked for besides. Growth per step up to 1 + tolerance counts as none.
   all_particles: an assembled operator is solved as it is, although the nodes' own may have its eigenvalues. each:
   numbers of each particle are asked for. sweeps, chance: of the bounds of a layout that is not a lattice; chance 0:
   without them.
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  MpmStep          step;
  PetscReal        tolerance;
  PetscBool        all_particles, each;
  PetscInt         sweeps;
  PetscReal        chance;
} MpmCriticalCase;

/* Not collective. The case of a scene. */
static inline MpmCriticalCase MpmCriticalCaseOf(const MpmScene *scene, PetscReal tolerance)
{
  return (MpmCriticalCase){
      .layout = &scene->layout, .scheme = &scene->scheme, .step = scene->step, .tolerance = tolerance};
}

/* The Courant numbers between which a search looks, and the number of phases in (0, pi] that it begins with. */
#define MPM_CRITICAL_PHASES 160
#define MPM_CRITICAL_FROM 1e-4
#define MPM_CRITICAL_TO 64.0
#define MPM_CRITICAL_PRECISION 1e-10 /* relative width of a bracket by the symbol */
#define MPM_CRITICAL_DRIFT 8         /* steps a cell: the drift of MpmCritical's moving */

/*
   MpmCriticalFind - searches for the largest stable Courant number, from small ones upwards. With alone, asked and
   moving are left out on uniform layouts.

   Collective on PETSC_COMM_WORLD.

   On uniform layouts at rest it takes the least limit of the closed form over all phases, and confirms it with the
   symbol there and on a grid of phases.

   Under drift in one dimension windows of instability open where two amplification factors meet, and close again. So
   amplification factors are followed as the Courant number grows, and the places where two of them meet are solved for.

   Under drift in more dimensions, and for schemes without a closed form, it samples the symbol: the largest growth on a
   grid of phases, from which it goes on uphill, at a row of Courant numbers from small ones on. At rest it looks for
   windows of growth (MpmSearchScan) unless a theorem says that there are none. In two and three dimensions the row ends
   at the limit of the waves along the axes. These are the waves of one dimension, whose limit is found as above. A
   window of growth between the samples may be missed.

   On other layouts it uses all eigenvalues of the assembled operator, which needs SLEPc initialized. At rest it looks
   for windows (MpmSearchScan) unless a theorem says that there are none (MpmLeftmostDecides). Under drift the
   eigenvalues of small operators are followed in the same way; those of larger ones are taken in steps (see followed).

   Errors: refuses (PETSC_ERR_USER_INPUT) an operator whose order is too large for that.
*/
PetscErrorCode MpmCriticalFind(const MpmCriticalCase *of, PetscBool alone, MpmCritical *critical);

/*
   MpmCriticalMoving - growth per step of a lattice at a Courant number, if particles drift by 1/MPM_CRITICAL_DRIFT of a
   cell per step: along the first direction, and along all of them (NaN in one dimension).

   Not collective. evaluations: how many symbols were taken is added.
*/
PetscErrorCode MpmCriticalMoving(const MpmCriticalCase *of, PetscReal courant, PetscReal growth[2],
                                 PetscInt64 *evaluations);

/*
   MpmCriticalSurvey - the limit of every formulation, transfer and basis on a case's layout and with its drift, in
   place of its own scheme. Bases vary fastest. It calls row with each result as it comes.

   Collective on PETSC_COMM_WORLD.

   Errors: refuses (PETSC_ERR_USER_INPUT) layouts without a symbol.
*/
typedef PetscErrorCode (*MpmCriticalRow)(void *context, const MpmScheme *scheme, const MpmCritical *critical);
PetscErrorCode MpmCriticalSurvey(const MpmCriticalCase *of, MpmCriticalRow row, void *context);

/* Not collective. Sets closed, closed_beta and cell: the least limit of the closed form over all phases. */
PetscErrorCode MpmCriticalByClosedForm(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts,
                                       MpmCritical *critical);
