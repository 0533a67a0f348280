/*
   Materials at finite strain: the stress at a stretch, its differential, its energy, and how fast waves are there.

   Stresses and energies are in units of rho0 c0^2, speeds in units of c0, where rho0 is the density at rest and c0 the
   speed of P waves in the material at rest. F is the deformation gradient, dim x dim, row by row; with dim 2 the strain
   is plane. A symmetric tensor has its components in the order 00 01 02 11 12 22.
*/
#pragma once
#include <mpmstab/compat.h>

typedef struct MpmLaw_ MpmLaw;

/*S
   MpmMaterialNumbers - a material.

   law        - its law
   mu, lambda - Lame's moduli at rest, of solids; lambda + 2 mu is 1 in the units of this header
   exponent   - n of fluids whose pressure is a power of density
S*/
typedef struct {
  const MpmLaw *law;
  PetscReal     mu, lambda, exponent;
} MpmMaterialNumbers;

/*S
   MpmLaw - what the stress depends on: one file of src/scheme/material/, and a line of the list there.

   name      - the word of the option material
   solid     - the stress depends on Lame's moduli; else the material is a fluid, whose stress is a pressure
   exponent  - the default of the option exponent; 0: the law has none
   stress, tangent, energy - see MpmMaterialStress, MpmMaterialTangent and MpmMaterialEnergy
   modulus   - MpmMaterialModulus from the largest eigenvalue and the trace of B = F F^T, and J
   stretched - of a solid with the stretches F[a] along the axes, J times the stiffness that small strains about this state
               feel. It is isotropic, with lambda and mu, but for a factor q[a] for each index a. NULL where it has no such
               form: schemes that are linear about a stretched state then have no such material.
S*/
struct MpmLaw_ {
  const char *name;
  PetscBool   solid;
  PetscReal   exponent;
  void (*stress)(const MpmMaterialNumbers *, PetscInt dim, PetscInt n, const PetscReal *const F[],
                 PetscReal *const tau[]);
  void (*tangent)(const MpmMaterialNumbers *, PetscInt dim, PetscInt n, const PetscReal *const F[],
                  const PetscReal *const dF[], PetscReal *const dtau[]);
  void (*energy)(const MpmMaterialNumbers *, PetscInt dim, PetscInt n, const PetscReal *const F[], PetscReal psi[]);
  PetscReal (*modulus)(const MpmMaterialNumbers *, PetscInt dim, PetscReal largest, PetscReal trace, PetscReal J);
  void (*stretched)(const MpmMaterialNumbers *, PetscInt dim, const PetscReal F[], PetscReal *lambda, PetscReal *mu,
                    PetscReal q[]);
};

/*
   The laws; MpmLaws lists all of them and ends with NULL. J is det F, B is F F^T, V is sqrt(B), E is (F^T F - I) / 2, and tau
   is the Kirchhoff stress, J times the true stress.

     MpmLawLinear     - linear in the stretch: tau = (2 mu (V - I) + lambda tr(V - I) I) V. With dim 1 the nominal stress is
                        F - 1. It is the corotated material of Stomakhin et al. (2012), equation 1.
     MpmLawNeo        - compressible neo-Hookean: tau = mu (B - I) + lambda ln J I
     MpmLawSvk        - Saint Venant and Kirchhoff: tau = F (lambda tr E I + 2 mu E) F^T
     MpmLawTait       - a liquid: tau = -J p I with the pressure p = (J^-n - 1) / n
     MpmLawGas        - a gas at constant temperature: p = 1 / J
     MpmLawPolytropic - a gas whose pressure grows with a power of density: p = J^-n / n
*/
extern const MpmLaw        MpmLawLinear, MpmLawNeo, MpmLawSvk, MpmLawTait, MpmLawGas, MpmLawPolytropic;
extern const MpmLaw *const MpmLaws[];

/* Not collective. Lame's moduli of a solid from their ratio lambda / mu, in the units of this header. */
static inline MpmMaterialNumbers MpmMaterialOfRatio(const MpmLaw *law, PetscReal lambda_over_mu, PetscReal exponent)
{
  return (MpmMaterialNumbers){law, 1 / (2 + lambda_over_mu), lambda_over_mu / (2 + lambda_over_mu), exponent};
}

/*
   MpmMaterialStress - the Kirchhoff stress tau of n particles, tau = (d psi / d F) F^T.

   Not collective. F[dim * dim] and tau[dim * (dim + 1) / 2] are arrays of n numbers, one array for each component. The
   result is of use where det F > 0.
*/
void MpmMaterialStress(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, const PetscReal *const F[],
                       PetscReal *const tau[]);

/*
   MpmMaterialTangent - the differential of MpmMaterialStress at F along dF.

   Not collective. The arrays are those of MpmMaterialStress, and dF and dtau are as F and tau.
*/
void MpmMaterialTangent(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, const PetscReal *const F[],
                        const PetscReal *const dF[], PetscReal *const dtau[]);

/*
   MpmMaterialEnergy - the energy psi of n particles per volume at rest. It is 0 at F = I.

   Not collective. F is as in MpmMaterialStress, and psi has n numbers. Of gas and polytropic the energy has no least
   value, because their pressure is positive at any volume.
*/
void MpmMaterialEnergy(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, const PetscReal *const F[],
                       PetscReal psi[]);

/*
   MpmMaterialModulus - rho0 c^2, where c is the speed of P waves along the direction in which the material is stretched
   most. Of no principal direction of stretch the P waves are faster.

   Not collective. F has dim * dim numbers. With dim 1 the modulus is F^2 dP/dF, where P is the nominal stress. It is not
   positive where such waves do not travel.
*/
PetscReal MpmMaterialModulus(const MpmMaterialNumbers *material, PetscInt dim, const PetscReal F[]);

/* Not collective. The speed c of MpmMaterialModulus, in units of c0; 0 where such waves do not travel. */
PetscReal MpmMaterialSpeed(const MpmMaterialNumbers *material, PetscInt dim, const PetscReal F[]);
