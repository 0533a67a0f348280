/*
   The amplification factors of particles at rest without their null space: those of the nodal operator of one Bloch mode.
   In two dimensions it has four numbers for a vector and a stress, whatever the number of particles in a cell is.
*/
#pragma once
#include "operator/nodal.h"
#include "symbol/bloch.h"

/*S
   MpmBlochNodal - the nodal operator of a table as a polynomial in the Courant number, at the present phase.

   plan        - of the table
   beta        - the present phase; NaN for none yet
   coefficient - coefficient[j]: nimages x nimages by columns (MpmNodalRun)
   rest, all   - the amplification factors of the null space of P2G, particle data that no node feels: rest of them are
                 1, the others of all are factor; all is MPM_NONE where only the largest abs of them is known, factor
S*/
struct MpmBlochNodal_ {
  MpmNodalPlan    *plan;
  PetscReal        beta[MPM_MAX_DIM], factor;
  double complex **coefficient;
  PetscInt         rest, all;
};

/*
   MpmBlochCountNull - counts the amplification factors of the null space of P2G: those of fields without filter (rest),
   and of all. all is MPM_NONE where this is not known.

   Not collective. b is at rest.
*/
void MpmBlochCountNull(const MpmBloch *bloch, PetscInt *rest, PetscInt *all, PetscReal *factor);

/*
   MpmBlochNodalCreate - NULL where it does not apply: one dimension, whose matrices are small, particles that drift,
   tables without a plan, and layouts with so few particles that the nodes have more numbers than those (one particle with
   a pressure gives its nodes a vector).

   MpmBlochNodalFactors - the amplification factors of a phase but for the null space, plan->nimages of them. ok is false
   where the QR steps have not converged or the numbers leave the range of doubles, and nothing is then set.

   MpmBlochNodalGrowths - growth per step of a phase, with the null space and without it, which is NaN where it is not
   known; ok as above.

   Not collective.
*/
PetscErrorCode MpmBlochNodalCreate(const MpmBloch *bloch, MpmBlochNodal **nodal);
PetscErrorCode MpmBlochNodalDestroy(MpmBlochNodal **nodal);
PetscErrorCode MpmBlochNodalFactors(MpmBlochNodal *nodal, MpmBloch *bloch, PetscReal courant, const PetscReal beta[],
                                    double complex value[], PetscBool *ok);
PetscErrorCode MpmBlochNodalGrowths(MpmBlochNodal *nodal, MpmBloch *bloch, PetscReal courant, const PetscReal beta[],
                                    PetscReal *growth, PetscReal *without_null, PetscBool *ok);
