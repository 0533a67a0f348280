/* Program: the code of somebody else in the place of a scene. It is started, probed and judged here. */
#pragma once
#include "analysis/modes.h"
#include "probe/certificates.h"
#include "scene/request.h"
#include "symbol/blocks.h"

#define MPM_PROGRAM_WHY 256

/*S
   MpmProgram - a code, its base state, and what was found by probing it.

   request      - names the program or the plugin
   kind         - how it is probed; why: what stands against Bloch probing, empty if nothing does
   whole        - all particles are to be probed, even if cells are alike
   shell        - the operator of all particles is no matrix: its products are asked for
   alike        - a probe whose sizes of perturbations are taken again; NULL: they are chosen
   lattice      - the cells of the base state, for Bloch probing
   colours      - of the coloured probing that was done last
   certificates - what shows that the operator is right; unread: unknowns that are only integrated
   tolerance    - of the verdict; at least 1e-5 in single precision
   blocks       - of the lattice, when MpmProgramMatrix has probed them
   cells        - the same as a lattice of waves; fields is 0 where all eigenvalues are computed without
   columns      - the responses that an operator costs with one size, of two calls each; 0 of a shell, and until they
                  are known
   unit         - what the progress line counts
S*/
typedef struct MpmProgram_ {
  const MpmRequest *request;
  MpmStepper       *stepper;
  MpmProbe          probe;
  MpmProbeKind      kind;
  char              why[MPM_PROGRAM_WHY];
  PetscBool         whole, shell;
  const MpmProbe   *alike;
  MpmProbeLattice   lattice;
  MpmBlocks         blocks;
  MpmBlochCells     cells;
  MpmProbeColours   colours;
  MpmCertificates   certificates;
  MpmUnread         unread;
  PetscReal         tolerance;
  PetscInt          columns;
  char              unit[64];
} MpmProgram;

/*
   MpmProgramOpen - starts the code that a request names and sets its parameters.
   MpmProgramPrepare - looks at its base state and chooses how to probe it. longest: as MpmProbeBegin has it.
   MpmProgramForget - undoes MpmProgramPrepare, so that another state or other parameters can be looked at.

   Collective. Errors: PETSC_ERR_USER_INPUT when the code fails, or the wanted way of probing is not possible.
*/
PetscErrorCode MpmProgramOpen(const MpmRequest *request, MpmProgram *program);
PetscErrorCode MpmProgramPrepare(MpmProgram *program);
PetscErrorCode MpmProgramForget(MpmProgram *program);
PetscErrorCode MpmProgramClose(MpmProgram *program);

/*
   MpmProgramRebase - looks at a base state that was changed, whose cells are taken to be those of before. size: of
   perturbations; 0: as before. Collective.
*/
PetscErrorCode MpmProgramRebase(MpmProgram *program, PetscReal size);

/* Collective. Replaces the base state by the one after some steps. The program must not be prepared. */
PetscErrorCode MpmProgramAdvance(MpmProgram *program, PetscInt steps);

/*
   MpmProgramProbe - the operator with one size of perturbations, and with all unknowns: blocks where it is probed by
   Bloch, a shell, or a matrix. reach: what is felt farther away than should be; NaN where nothing is too far.
   MpmProgramNoise - an entry of the operator up to this is none. Not collective.

   MpmProgramOperator - the operator with both sizes, without unknowns that are only integrated (of a shell nothing is
   set apart); takes all certificates. other NULL: probes with one size and takes no certificate. MpmProgramMatrix -
   does the same; blocks become the matrix of all particles. MpmProgramCertify - the second half of it: given all and
   kept with one size, probes the operator with the other size, and takes all certificates but repeat. MpmProgramLattice
   - NULL, or the lattice whose waves tell the eigenvalues of that matrix.

   Collective. Free them with MpmProbedFree or MatDestroy.
*/
PetscErrorCode MpmProgramProbe(MpmProgram *program, PetscReal size, MpmProbed *probed, PetscReal *reach);
PetscReal      MpmProgramNoise(const MpmProgram *program);
PetscErrorCode MpmProgramOperator(MpmProgram *program, MpmProbed *one, MpmProbed *other);
PetscErrorCode MpmProgramCertify(MpmProgram *program, const MpmProbed *all, const MpmProbed *one, MpmProbed *other,
                                 PetscReal *reach);
PetscErrorCode MpmProgramMatrix(MpmProgram *program, Mat *one, Mat *other);
const MpmBlochCells *MpmProgramLattice(const MpmProgram *program);

/*
   MpmProgramJudge - a finding's verdict by MpmCertificatesJudge. What is set apart counts in its growth. Not
                     collective.
*/
PetscErrorCode MpmProgramJudge(const MpmProgram *program, PetscReal other, PetscReal condition, MpmFinding *finding);
