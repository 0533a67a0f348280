/* Growth of a code's step at the parameters that are set, with its certificates and a verdict. */
#pragma once
#include "probe/carriers.h"
#include "probe/program.h"

/*
   MpmProgramJudgeWaves - of cells that are alike: probes the blocks of one, and seeks the wave that grows most.
   MpmProgramJudgeParticles - of any layout: probes the operator of all particles, and takes its spectral radius.

   Collective. The program must be prepared, for waves with Bloch probing. phases: at which the search begins, in each
   direction. beta: the phase of the wave. carriers: the particles that carry the mode.
*/
PetscErrorCode MpmProgramJudgeWaves(MpmProgram *program, const PetscInt phases[], PetscReal beta[],
                                    MpmFinding *finding);
PetscErrorCode MpmProgramJudgeParticles(MpmProgram *program, PetscReal started, MpmFinding *finding,
                                        MpmCarriers *carriers);

/* Collective. Growth alone, with one size of perturbations: of all waves, or of all particles. The program must be prepared. */
PetscErrorCode MpmProgramGrowth(MpmProgram *program, PetscReal *growth);

/*
   MpmProgramJudgeSpectrum - the verdict on a spectrum of the program's operator, given the operator with the other size of
   perturbations and the certificates. Without all eigenvalues nothing is stable: at radius 1 those of largest magnitude
   are found late or not at all.

   Collective. Changes the finding of the spectrum.
*/
PetscErrorCode MpmProgramJudgeSpectrum(const MpmProgram *program, Mat other, MpmSpectrum *spectrum);
