/*
   Growth of a code's step at the parameters that are set, with a verdict; particles that carry a mode; what is beside a
   switch; growth by running.
*/
#pragma once
#include "analysis/spectrum.h"
#include "probe/program.h"

#define MPM_CARRIERS 3

/*S
   MpmCarriers - the n particles with the largest shares of the square of an eigenvector, whose numbers are in scales.

   particle, share - of each, the largest first; place: in the base state, dim numbers; dim is 0 if no field is the
                     place
   most            - the number of particles that together have 90% of the square; all: of all
S*/
typedef struct {
  PetscInt   n, dim;
  PetscInt64 particle[MPM_CARRIERS], most, all;
  PetscReal  share[MPM_CARRIERS], place[MPM_CARRIERS][MPM_MAX_DIM];
} MpmCarriers;

/* Collective. Of the first listed eigenvalue; n is 0 when there is none. */
PetscErrorCode MpmCarriersFind(const MpmProgram *program, const MpmSpectrum *spectrum, MpmCarriers *carriers);

/*
   MpmProgramJudgeSources - of the symbols with both sizes of perturbations: seeks the wave that grows most.
   MpmProgramJudgeWaves - of cells that are alike: probes the blocks of one, and seeks the wave that grows most.
   MpmProgramJudgeParticles - of any layout: probes the operator of all particles, and takes its spectral radius.

   Collective. The program must be prepared, for waves with Bloch probing. phases: at which the search begins, in each
   direction. beta: the phase of the wave. carriers: the particles that carry the mode.
*/
PetscErrorCode MpmProgramJudgeSources(const MpmProgram *program, const MpmSource source[2], const PetscInt phases[],
                                      PetscReal beta[], MpmFinding *finding);
PetscErrorCode MpmProgramJudgeWaves(MpmProgram *program, const PetscInt phases[], PetscReal beta[],
                                    MpmFinding *finding);
PetscErrorCode MpmProgramJudgeParticles(MpmProgram *program, PetscReal started, MpmFinding *finding,
                                        MpmCarriers *carriers);

/*
   Collective. Growth alone, with one size of perturbations: of all waves, or of all particles. The program must be
   prepared.
*/
PetscErrorCode MpmProgramGrowth(MpmProgram *program, PetscReal *growth);

/*
   MpmProgramJudgeSpectrum - the verdict on a spectrum of the program's operator, given the operator with the other size
   of perturbations and the certificates. Without all eigenvalues nothing is stable: at radius 1 those of largest
   magnitude are found late or not at all.

   Collective. Changes the finding of the spectrum.
*/
PetscErrorCode MpmProgramJudgeSpectrum(const MpmProgram *program, Mat other, MpmSpectrum *spectrum);

/*S
   MpmKinks - what is found where the certificate 'one side' fails.

   particles - that show it; all: there are so many. few: they are so few that both sides of the base state are two
               operators
   growth    - of these two, NaN where they were not computed; field: NULL, or else a field which, changed by amount of
               its units at all particles, leaves the switch; growth[0] is then that of this state
S*/
typedef struct {
  PetscInt64  particles, all;
  PetscBool   few;
  PetscReal   growth[2], amount;
  const char *field;
} MpmKinks;

/*
   MpmKinksFind - looks at the states beside the base state: of few switches at a random one and its opposite, else at
   those with one field changed.

   Collective. The program must have its certificates; afterwards it must be forgotten.
*/
PetscErrorCode MpmKinksFind(MpmProgram *program, MpmKinks *kinks);

/*S
   MpmProgramRun - what was measured.

   steps, perturbations - that were run. Perturbations are random, of all unknowns, and beside the base state. After
                  each request they are scaled to their first size, so that they stay small
   growth       - per step, over the second half of the steps that were run: the mean of the perturbations; NaN: there
                  were too few; low, high: limits around it: Student's t for 95%, and what the two last quarters differ
                  by
   factor       - by which they have grown in that half. Growth that is linear in time makes it 2
   ended        - the code had no answer to more steps
S*/
typedef struct {
  PetscInt  steps, perturbations;
  PetscReal growth, low, high, factor;
  PetscBool ended;
} MpmProgramRun;

/*
   MpmProgramRunFind - runs a code for about so many steps, and judges: growth by a factor that only an exponential
   makes is unstable, all else is undecided, since a run does not prove that nothing grows.

   Collective; the first rank runs it. The program must be prepared. Errors: PETSC_ERR_USER_INPUT when the code fails in
   the first steps.
*/
PetscErrorCode MpmProgramRunFind(MpmProgram *program, PetscInt steps, MpmProgramRun *run, MpmFinding *finding);
