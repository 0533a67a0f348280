/*
   Transfer diagnostics: what particles and nodes lose and gain when fields go from one to the other. These are the
   three diagnostics that the slides' questions ask for. A run that does not ask for them allocates and computes none.
*/
#pragma once
#include "march/nodal_solve.h"
#include "scene/request.h"

/*S
   MpmTransferDiagnosticsSample - the diagnostics at one step. A number is NaN where it was not asked for, where there
   is nothing to divide by, or where the solve with P W does not converge.

   c1_mean, c1_min, c1_max: mean, least and largest over the nodes of the weight C1, the part of a node's P2G that comes
   from the particles of the cell at its left. With C2 = 1 - C1

     P2G GRAD f = C1 (f_i - f_{i-1}) + C2 (f_{i+1} - f_i)

   source: for each particle field, the change of the nodal field that the particles' next move makes by itself:

     norm over i of sum_p (S^{t+1}_ip - S^t_ip) q_p^t, divided by the norm of q_i^t

   ringing: for each particle field, the part in the null space of P2G, with norms over the particles weighted by mass.
   (Nodes feel a stress through its DIV, which may feel more of it than P2G does.)

     norm(q - W (P W)^{-1} P q) / norm(q)

   Source: Berzins, Kirby and Gritton 2013, 'Formulation 1 - Analysis'; Gritton and Berzins 2017 for the null space.
S*/
typedef struct {
  PetscReal c1_mean, c1_min, c1_max;
  PetscReal source[MPM_MAX_FIELDS], ringing[MPM_MAX_FIELDS];
} MpmTransferDiagnosticsSample;

/*S
   MpmTransferDiagnostics - what the diagnostics of a march need: node vectors, and the solve with P W.

   first, last: the diagnostics at the first and the last step measured. most: the largest of all steps (c1_min: the
   least).
S*/
typedef struct {
  MpmMarch                    *march;
  const MpmRequest            *request;                   /* which of them are measured */
  Vec                          node, other, inverse_mass; /* local vectors */
  MpmNodalSolve               *solve;                     /* NULL: the request does not ask for ringing */
  PetscBool                    measured;
  MpmTransferDiagnosticsSample first, last, most;
} MpmTransferDiagnostics;

/*
   MpmTransferDiagnosticsCreate - allocates what the request's diagnostics need; NULL unless it asks for weights,
   source_term or ringing.

   Collective. Refuses a source term where particles leave a rank's ghost layer within a step.
*/
PetscErrorCode MpmTransferDiagnosticsCreate(MpmMarch *march, const MpmRequest *request,
                                            MpmTransferDiagnostics **diagnostics);
PetscErrorCode MpmTransferDiagnosticsDestroy(MpmTransferDiagnostics **diagnostics);

/* Collective. Measures the diagnostics at the march's step. */
PetscErrorCode MpmTransferDiagnosticsMeasure(MpmTransferDiagnostics *diagnostics);
