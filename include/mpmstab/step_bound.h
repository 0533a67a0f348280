/* Bounds of the largest stable step of the particles as they stand. */
#pragma once
#include <mpmstab/march.h>

#define MPM_STEP_BOUND_PRODUCTS 20

/*E
   MpmBoundKind - the bounds; MPM_BOUNDS all of them. MPM_BOUND_LOSS: what the loss by damping and viscosity depends on
E*/
typedef enum {
  MPM_BOUND_LONE     = 1,
  MPM_BOUND_PARTICLE = 2,
  MPM_BOUND_LANCZOS  = 4,
  MPM_BOUND_LOSS     = 8,
  MPM_BOUNDS         = 7
} MpmBoundKind;

/*S
   MpmStepBounds - Courant numbers up to which no state of the particles at rest, where they are, grows. M^-1 K is the
   operator of the nodes, K = sum_p V_p B_p^T C B_p with the moduli and volumes of now, M the lumped masses. lambda is
   its largest eigenvalue with k = 1, and each bound is factor / sqrt(of a bound of lambda).

   why_not  - why there is none; NULL: there is
   factor   - the formulation's step_bound
   lone     - as if each particle were alone: 0 where one has a slope at a node that it gives no mass to
   particle - with the nodal masses split between particles as V_p abs(grad S_ip); swept: the best after further sweeps
   lanczos  - by products with a random vector: it is above the limit with a probability of chance at most
   lone_at, particle_at - the particle that decides, and its place in cells; value: NULL, or by id room for lambda of
              each particle, of which a rank sets its own
   nodes    - the nodal unknowns
   products - how many were taken
   moduli   - NULL: those at rest; else E_p of each of this rank's particles, the square of its wave speed over c
   form     - of MPM_BOUND_LOSS: bounds of the largest eigenvalues of M^-1 sum_p V_p (tr D)^2 and M^-1 sum_p V_p D : D, where damping or
              viscosity depends on them: by products where lanczos was asked for, else as particle. The bounds are those
              without damping and viscosity: see MpmStepLoss
   kinds, sweeps, chance, seed - what was asked for; kinds: a sum of MpmBoundKind; seed: of the random vector

   Source: docs/theory.md, section 4.
S*/
typedef struct {
  PetscInt64 id;
  PetscReal  place[MPM_MAX_DIM], *value;
} MpmDecider;

typedef struct {
  const char *why_not;
  PetscReal   factor, lone, particle, swept, lanczos, chance;
  MpmDecider  lone_at, particle_at;
  PetscInt64  nodes, seed;
  PetscInt    products, sweeps, kinds;

  const PetscReal *moduli;
  PetscReal        form[2];
} MpmStepBounds;

/*
   MpmStepLoss     - the part of any velocity that damping and viscosity take at most in the time h / c. artificial: the
                     largest artificial viscosity at any particle (MpmMaterialViscous). A material's own viscosity, and
                     its slope where it thickens, are at most its largest one times 1, or times the power of the rate
   MpmStepWithLoss - the k with (k / limit)^2 + k loss / 2 = 1: a limit, with what the loss makes of it

   Not collective. Source: docs/floors.md.
*/
PetscReal MpmStepLoss(const MpmSpace *space, const PetscReal form[2], PetscReal artificial);
PetscReal MpmStepWithLoss(PetscReal limit, PetscReal loss);

/*
   MpmStepBoundsFind - the bounds for a march's particles at their present places.

   Collective on the march's ranks. The results do not depend on the ranks but for rounding.

   Input Parameters:
+  march  - a march; its state is not changed
-  bounds - with moduli, kinds, sweeps, chance and seed

   Output Parameter: bounds - the rest of it
*/
PetscErrorCode MpmStepBoundsFind(MpmMarch *march, MpmStepBounds *bounds);

/* Not collective. Why no bound is known for a scheme on a layout with a drift; NULL: one is. */
const char *MpmStepBoundWhyNot(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step);
