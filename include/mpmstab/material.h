/*
   Materials at finite strain: the stress at a stretch, its differential, its energy, and how fast waves are there.

   Stresses and energies are in units of rho0 c0^2, speeds in units of c0, where rho0 is the density at rest and c0 the
   speed of P waves in the material at rest. F is the deformation gradient, dim x dim, row by row; with dim 2 the strain
   is plane. A symmetric tensor has its components in the order 00 01 02 11 12 22.

   A material that flows has a yield surface. Its F is the elastic part, and after it come its internal variables
   (MpmMaterialComponents): wherever F or dF is an argument, they are, too.
*/
#pragma once
#include <mpmstab/compat.h>

#define MPM_MOST_INTERNAL 3  /* the largest number of internal variables of the materials of a run, without e_out */
#define MPM_MOST_STRETCH 13  /* the largest number of components of F and of internal variables together */
#define MPM_MOST_MATERIALS 8 /* of one run */

typedef struct MpmLaw_       MpmLaw;
typedef struct MpmMaterials_ MpmMaterials;

/*E
   MpmPlasticNumber - the numbers of laws besides Lame's moduli and the exponent, most of materials that flow;
   MpmPlasticNames has the options of the same names.
E*/
typedef enum {
  MPM_YIELD,
  MPM_HARDENING,
  MPM_SATURATION,
  MPM_SATURATION_RATE,
  MPM_COMPRESSION_LIMIT,
  MPM_STRETCH_LIMIT,
  MPM_FRICTION_ANGLE,
  MPM_CONSISTENCY,
  MPM_FLOW_INDEX,
  MPM_PLASTIC_NUMBERS
} MpmPlasticNumber;
extern const char *const MpmPlasticNames[];

/*S
   MpmMaterialNumbers - a material.

   law        - its law
   mu, lambda - Lame's moduli at rest, of solids; lambda + 2 mu is 1 in the units of this header
   exponent   - n of fluids whose pressure is a power of density
   plastic    - the numbers that the law reads
   viscosity  - of a law with a viscous stress its largest viscosity, in units of rho c h; c is the speed of small waves
                where a run starts from, and rho c^2 their modulus
   artificial - the numbers C1 and C2 of the artificial viscosity, or 0
   several    - the materials of particles that are of several; law is then MpmLawSeveral. NULL: they are of this one
S*/
typedef struct {
  const MpmLaw       *law;
  PetscReal           mu, lambda, exponent, plastic[MPM_PLASTIC_NUMBERS], viscosity, artificial[2];
  const MpmMaterials *several;
} MpmMaterialNumbers;

/*S
   MpmMaterials - several materials of one run. Each particle has the internal variables of all of them, of which its
   own law reads its own, and after them the number of its material, which is an internal variable, too: 'material'.

   n, of    - the materials
   internal - the laws that have an internal variable of a name, each name once; slot[i]: which of them is that of
              material i
   outside  - one of the laws has the internal variable e_out
S*/
struct MpmMaterials_ {
  PetscInt           n, ninternal, slot[MPM_MOST_MATERIALS];
  PetscBool          outside;
  const MpmLaw      *internal[MPM_MOST_INTERNAL];
  MpmMaterialNumbers of[MPM_MOST_MATERIALS];
};

/*S
   MpmPlastic - how an isotropic material flows, in the logarithms e[0..2] of the principal elastic stretches, and one
   internal variable q.

   internal, start - the name of q, and where it begins
   outside  - with dim 1 and 2 the material flows out of the line or plane, too. The elastic strain there is then an
              internal variable, e_out; without it, it is 0.
   yield    - above 0 the material flows; 0 is the yield surface
   back     - from the trial values of e and q to those after the flow. slope (NULL: none): their derivatives by e and q
   stress   - the principal Kirchhoff stresses T, and slope (NULL: none): their derivatives by e and q
   energy   - the elastic energy
S*/
typedef struct {
  const char *internal;
  PetscReal   start;
  PetscBool   outside;
  PetscReal (*yield)(const MpmMaterialNumbers *, const PetscReal e[3], PetscReal q);
  void (*back)(const MpmMaterialNumbers *, PetscReal e[3], PetscReal *q, PetscReal slope[4][4]);
  void (*stress)(const MpmMaterialNumbers *, const PetscReal e[3], PetscReal q, PetscReal T[3], PetscReal slope[3][4]);
  PetscReal (*energy)(const MpmMaterialNumbers *, const PetscReal e[3], PetscReal q);
} MpmPlastic;

/*S
   MpmLaw - what the stress depends on: one file of src/scheme/material/, and a line of the list there.

   name      - the word of the option material
   solid     - the stress depends on Lame's moduli; else the material is a fluid, whose stress is a pressure
   exponent  - the default of the option exponent; 0: the law has none
   stress, tangent, energy - see MpmMaterialStress, MpmMaterialTangent and MpmMaterialEnergy
   modulus   - MpmMaterialModulus from the largest eigenvalue and the trace of B = F F^T, and J
   stretched - of a solid with the stretches F[a] along the axes, J times the stiffness that small strains about this
               state feel. It is isotropic, with lambda and mu, but for a factor q[a] for each index a. NULL where it
               has no such form: schemes that are linear about a stretched state then have no such material.
   number    - the numbers that the law reads (usual, or what an option says), and their range; others have reads false
   viscous   - adds the viscous stress of the velocity's gradient L, and its differential along dL sets dtau; see
               MpmMaterialViscous for the units. NULL: the law has none
   plastic   - how the material flows; NULL: it does not
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
  void (*viscous)(const MpmMaterialNumbers *, PetscReal unit, PetscInt dim, PetscInt n, const PetscReal *const L[],
                  PetscReal *const tau[]);
  void (*viscous_tangent)(const MpmMaterialNumbers *, PetscReal unit, PetscInt dim, PetscInt n,
                          const PetscReal *const L[], const PetscReal *const dL[], PetscReal *const dtau[]);
  struct {
    PetscBool reads;
    PetscReal usual, least, most;
  } number[MPM_PLASTIC_NUMBERS];
  const MpmPlastic *plastic;
};

/*
   The laws; MpmLaws lists all of them and ends with NULL. J is det F, B is F F^T, V is sqrt(B), E is (F^T F - I) / 2,
   and tau is the Kirchhoff stress, J times the true stress.

     MpmLawLinear     - linear in the stretch: tau = (2 mu (V - I) + lambda tr(V - I) I) V. With dim 1 the nominal
                        stress is
                        F - 1. It is the corotated material of Stomakhin et al. (2012), equation 1.
     MpmLawNeo        - compressible neo-Hookean: tau = mu (B - I) + lambda ln J I
     MpmLawSvk        - Saint Venant and Kirchhoff: tau = F (lambda tr E I + 2 mu E) F^T
     MpmLawTait       - a liquid: tau = -J p I with the pressure p = (J^-n - 1) / n
     MpmLawGas        - a gas at constant temperature: p = 1 / J
     MpmLawPolytropic - a gas whose pressure grows with a power of density: p = J^-n / n
     MpmLawHerschelBulkley - a liquid with the pressure of tait and a viscous stress: it flows where its shear is beyond
                             a yield stress

   Those that flow (plastic.c):

     MpmLawMises - metal: Hencky's solid, von Mises' yield stress with linear and Voce hardening
     MpmLawSnow  - snow: principal stretches within bounds, and moduli that grow as it is compressed for good
     MpmLawSand  - sand: Hencky's solid, no tension, and shear up to a part of the pressure
     MpmLawClay  - clay: Hencky's solid, modified Cam clay, whose yield surface grows as it loses volume
*/
extern const MpmLaw MpmLawLinear, MpmLawNeo, MpmLawSvk, MpmLawTait, MpmLawGas, MpmLawPolytropic, MpmLawMises,
    MpmLawHerschelBulkley, MpmLawSnow, MpmLawSand, MpmLawClay;
extern const MpmLaw        MpmLawSeveral; /* of several materials; it is not in the list */
extern const MpmLaw *const MpmLaws[];

/* Not collective. Whether a material has a stress of the velocity's gradient. */
static inline PetscBool MpmMaterialIsViscous(const MpmMaterialNumbers *m)
{
  return m->viscosity > 0 || m->artificial[0] > 0 || m->artificial[1] > 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. Lame's moduli of a solid from their ratio lambda / mu, in the units of this header. */
static inline MpmMaterialNumbers MpmMaterialOfRatio(const MpmLaw *law, PetscReal lambda_over_mu, PetscReal exponent)
{
  MpmMaterialNumbers m = {law, 1 / (2 + lambda_over_mu), lambda_over_mu / (2 + lambda_over_mu), exponent, {0}, 0, {0},
                          NULL};

  for (PetscInt i = 0; i < MPM_PLASTIC_NUMBERS; i++) m.plastic[i] = law->number[i].usual;
  return m;
}

/*
   MpmLawComponents      - the number of components of F, and of internal variables of a law after them
   MpmMaterialComponents - the same of a material, or of all materials of a run
   MpmMaterialInternal   - the name of internal variable i, and where it begins
   MpmMaterialFlows      - whether the material, or one of several, flows
   MpmMaterialAt         - the material of particle p of those whose arrays are F

   Not collective.
*/
static inline PetscInt MpmLawComponents(const MpmLaw *law, PetscInt dim)
{
  if (!law->plastic) return dim * dim;
  return dim * dim + (law->plastic->internal ? 1 : 0) + (law->plastic->outside && dim < 3 ? 1 : 0);
}
PetscInt    MpmMaterialComponents(const MpmMaterialNumbers *material, PetscInt dim);
const char *MpmMaterialInternal(const MpmMaterialNumbers *material, PetscInt dim, PetscInt i, PetscReal *start);
PetscBool   MpmMaterialFlows(const MpmMaterialNumbers *material);
const MpmMaterialNumbers *MpmMaterialAt(const MpmMaterialNumbers *material, PetscInt dim, const PetscReal *const F[],
                                        PetscInt p);

/*
   MpmMaterialsAdd - the number of a material among several, to which it is added where it is not one of them;
   MPM_MOST_MATERIALS: there are too many materials, or too many internal variables.

   Not collective.
*/
PetscInt MpmMaterialsAdd(MpmMaterials *materials, const MpmMaterialNumbers *material);

/*
   MpmMaterialReturn - lets n particles flow: from the trial value of F and their internal variables to those on the
   yield surface, where the trial value is beyond it.

   Not collective. Particles within the surface stay as they are, to the last bit. F: as in MpmMaterialStress.
*/
void MpmMaterialReturn(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, PetscReal *const F[]);

/*E
   MpmBranch - which derivative a particle has whose trial value is on the yield surface: that of one just beyond, or
   just within. OWN, for runs, is that of within: rounding does not decide.
E*/
typedef enum { MPM_BRANCH_OWN, MPM_BRANCH_LOADING, MPM_BRANCH_UNLOADING } MpmBranch;
extern const char *const MpmBranchNames[];

/*
   MpmMaterialReturnTangent - the differential of MpmMaterialReturn at the trial value F along dF: the consistent
   tangent of Simo and Taylor (1985), with that of the stress.

   Not collective. Returns how many particles stand on the yield surface, where the branch decides.
*/
PetscInt MpmMaterialReturnTangent(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, MpmBranch branch,
                                  const PetscReal *const F[], const PetscReal *const dF[], PetscReal *const after[]);

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
   MpmMaterialViscous - adds to tau what depends on the velocity's gradient L: the viscous stress of the law, and the
   artificial viscosity of von Neumann and Richtmyer (1950), in compression alone:

     tau += rho (C1 c_p tr D - C2 (tr D)^2) I   where tr D < 0, D = sym L,   c_p the speed of MpmMaterialModulus

   Not collective. L has dim * dim arrays, in units of c / h, with h the width of a cell. unit: rho c^2 / (rho0 c0^2).
   F: as in MpmMaterialStress. of: mass, volume and stiffness of the particles, each NULL where all are alike. Returns
   the largest C1 c_p rho + 2 C2 rho abs(tr D) of particles that are compressed, in units of rho c h: the viscosity that
   a small change of the volume's rate feels.
*/
PetscReal MpmMaterialViscous(const MpmMaterialNumbers *material, PetscReal unit, PetscInt dim, PetscInt n,
                             const PetscReal *const L[], const PetscReal *const F[], const PetscReal *const of[3],
                             PetscReal *const tau[]);

/*
   MpmMaterialModulus - rho0 c^2, where c is the speed of the fastest P waves along a principal direction of stretch:
   that in which the material is stretched most, but for those that flow. These are the waves in which it does not flow.

   Not collective. F has the numbers of MpmMaterialComponents. With dim 1 the modulus is F^2 dP/dF, where P is the
   nominal stress. It is not positive where such waves do not travel.
*/
PetscReal MpmMaterialModulus(const MpmMaterialNumbers *material, PetscInt dim, const PetscReal F[]);
