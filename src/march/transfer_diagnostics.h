/*
   Exchange: what particles and nodes lose and gain when fields go from one to the other; the three diagnostics that the
   slides' questions ask for. Nothing of this exists in a run that does not ask.
*/
#pragma once
#include "march/march_private.h"
#include "scene/request.h"

/*S
   MpmTransferDiagnosticsSample - the diagnostics at one step; NaN where they were not asked for, there is nothing to
   divide by, or the solve with P W does not converge.

   c1_*: the weight C1 of the left cell's particles in a node's P2G (C2 = 1 - C1): P2G GRAD f = C1 (f_i - f_{i-1}) +
   C2 (f_{i+1} - f_i); mean, least and largest of all nodes. For each particle field: source, the norm over the nodes of
   sum_p (S^{t+1}_ip - S^t_ip) q_p^t, what the move that follows does to the nodes by itself, over that of q_i^t;
   ringing, norm(q - W (P W)^{-1} P q) / norm(q) over the particles by mass: the part that P2G does not see (of a
   stress nodes see DIV, and may see more).

   Source: Berzins, Kirby and Gritton 2013, 'Formulation 1 - Analysis'; Gritton and Berzins 2017 for the null space.
S*/
typedef struct {
  PetscReal c1_mean, c1_min, c1_max;
  PetscReal source[MPM_MAX_FIELDS], ringing[MPM_MAX_FIELDS];
} MpmTransferDiagnosticsSample;

/*S
   MpmTransferDiagnostics - what the diagnostics of a march need: node vectors, and the solve with P W. first, last: at
   the first and the last step measured; most: the largest of all (c1_min: the least).
S*/
typedef struct {
  MpmMarch                    *march;
  const MpmRequest            *request;                   /* which of them are measured */
  Vec                          node, other, inverse_mass; /* local vectors */
  MpmNodalSolve               *solve;                     /* NULL: no ringing asked for */
  PetscBool                    measured;
  MpmTransferDiagnosticsSample first, last, most;
} MpmTransferDiagnostics;

/*
   MpmTransferDiagnosticsCreate - NULL unless the request asks for weights, source_term or ringing.

   Collective. Refuses a source term where particles leave a rank's ghost layer within a step.
*/
PetscErrorCode MpmTransferDiagnosticsCreate(MpmMarch *march, const MpmRequest *request,
                                            MpmTransferDiagnostics **exchange);
PetscErrorCode MpmTransferDiagnosticsDestroy(MpmTransferDiagnostics **exchange);

/* Collective. The diagnostics at the march's step. */
PetscErrorCode MpmTransferDiagnosticsMeasure(MpmTransferDiagnostics *exchange);
