/*
   The table of fields: a line or two for each.

   A line has the option with its default, meaning and range, and then says where its value is. KEPT: in the scene, as
   it is given. ASKED: in the request, as it is given. MADE: in the scene, formed by scene.c. TEXT(f): the function f
   says it. SHOWN(f): records show it when f says so. IN(a, b, c, d) are its places among the attributes of HDF5 files,
   in JSON, in checkpoints, and among what mode files are compared by; 0: it is not there. A new field takes the first
   free place, one more than the largest. A field that decides what a run computes has a place in checkpoints.
*/
#include "scene/fields.h"
#include "base/suggest.h"
#include "scene/layout.h"
#include "scene/material.h"
#include <string.h>

/* clang-format off */

/* ---- words of options, and values that a scene keeps as something else ---- */

#define NAMES(function, list)  static const char *function(PetscInt i) { return list[i] ? list[i]->name : NULL; }
#define SAYS(function, word)   static const char *function(const MpmScene *s) { return word; }

NAMES(FormulationWord, MpmFormulations)
NAMES(BasisWord, MpmBases)
NAMES(TransferWord, MpmTransfers)

/* Distributions of a linear material, and then the laws but the linear one. */
static const char *MaterialWord(PetscInt i)
{
  const MpmLaw *law = i < MPM_MATERIAL_KINDS ? NULL : MpmLaws[i - MPM_MATERIAL_KINDS + 1];

  return i < MPM_MATERIAL_KINDS ? MpmMaterialNames[i] : law ? law->name : NULL;
}

SAYS(FormulationOf, s->scheme.formulation->name)
SAYS(BasisOf, s->scheme.basis->name)
SAYS(TransferOf, s->scheme.transfer->name)
SAYS(SplineEndsOf, MpmSplineEndNames[s->scheme.basis->spline_ends])
SAYS(RkOf, MpmRkWord(s->scheme.numbers.rk))
SAYS(RkOnOf, MpmRkOnNames[MpmRkIsOnNodes(&s->scheme.numbers, s->scheme.transfer) ? MPM_RK_NODES : MPM_RK_PARTICLES])
SAYS(KinematicsOf, MpmKinematicsNames[s->scheme.space.finite ? 1 : 0])
SAYS(ShapeOf, s->layout.shape ? s->layout.shape : MpmShapeNames[0])
SAYS(LayoutOf, s->layout.name)
SAYS(MaterialOf, s->law == &MpmLawLinear ? MpmMaterialNames[s->layout.material.kind] : s->law->name)

/* How many components a stress has. */
static PetscInt StressNumbers(const MpmScene *scene)
{
  return scene->layout.dim * (scene->layout.dim + 1) / 2;
}

/* ---- when a record shows a field: JSON leaves out what is the default ---- */

#define WHEN(function, condition) static PetscBool function(const MpmScene *s, MpmRecord in, const MpmField *f) { (void)s, (void)in, (void)f; return (condition) ? PETSC_TRUE : PETSC_FALSE; }

static PetscBool TransferReads(const MpmScene *s, const char option[])
{
  return s->scheme.transfer->option && !strcmp(s->scheme.transfer->option, option) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool IsCentred(const MpmLayout *layout)
{
  for (PetscInt a = 0; a < layout->dim; a++)
    if (layout->offset[a].value != 0.5) return PETSC_FALSE;
  return PETSC_TRUE;
}

WHEN(HasOrder, TransferReads(s, "xpic_order"))
WHEN(HasRatio, TransferReads(s, "blend_ratio"))
WHEN(HasAffineRatio, TransferReads(s, "aflip_ratio"))
WHEN(HasShare, MpmFormulationReads(s->scheme.formulation, "share"))
WHEN(HasTheta, MpmFormulationReads(s->scheme.formulation, "theta"))
WHEN(HasHalvings, MpmFormulationReads(s->scheme.formulation, "halvings") && s->scheme.space.finite)
WHEN(HasRk, MpmFormulationReads(s->scheme.formulation, "rk"))
WHEN(HasFilterTime, MpmSceneChoosesFilter(s))
WHEN(HasSplineEnds, MpmBasisIsAltered(s->scheme.basis))
/* files that were written before there was more than one dimension have neither of these two */
WHEN(HasDim, in == MPM_IN_FILE || in == MPM_IN_JSON || s->layout.dim > 1)
WHEN(HasGradient, in == MPM_IN_FILE || in == MPM_IN_JSON || s->scheme.space.gradient != MPM_GRADIENT_BASIS)
/* a checkpoint holds what each rank had, and is read so where the ranks have the same cells */
WHEN(HasBalance, s->layout.balance != MPM_BALANCE_AUTO)
WHEN(HasRanks, s->layout.ranks[0])
WHEN(HasPoisson, MpmSceneHasPoisson(s))
WHEN(HasDensity, s->density > 0)
WHEN(HasUnits, MpmSceneIsPhysical(s))
WHEN(HasSpeed, in != MPM_IN_JSON || MpmSceneIsPhysical(s))
/*
   with courant auto step and drift differ from step to step; a checkpoint compares the drift, as it says how fast
   particles start
*/
WHEN(HasOneStep, s->safety == 0)
WHEN(HasSafety, s->safety > 0)
WHEN(HasBound, s->safety > 0 || s->watched)
WHEN(HasDrift, in == MPM_IN_CHECKPOINT || s->safety == 0)
WHEN(HasTimeStep, s->safety == 0 && (in != MPM_IN_JSON || (MpmSceneIsPhysical(s) && MpmSceneHasStep(s))))
WHEN(HasPolarisation, MpmSceneHasPoisson(s) && s->initial == MPM_INITIAL_MODE)
/* files have always said uniform */
WHEN(HasLayout, in == MPM_IN_FILE || s->layout.given)
WHEN(HasOffset, in != MPM_IN_JSON || !IsCentred(&s->layout))
WHEN(HasJitter, in != MPM_IN_JSON || s->layout.jitter != 0)
/* the seed decides where particles are, and for a run also what random data it starts from */
WHEN(HasSeed, in == MPM_IN_FILE || s->layout.jitter != 0 || (s->layout.given && s->layout.given->random) || (in == MPM_IN_CHECKPOINT && s->initial == MPM_INITIAL_RANDOM))
WHEN(HasCounts, in != MPM_IN_JSON || s->layout.counts.n > 1)
WHEN(HasCluster, in != MPM_IN_JSON || s->layout.cluster[1] - s->layout.cluster[0] < 1)
WHEN(HasMaterial, in != MPM_IN_JSON || s->layout.material.kind != MPM_MATERIAL_UNIFORM)
WHEN(HasMaterialName, s->law != &MpmLawLinear || HasMaterial(s, in, f))
WHEN(HasInclusion, in == MPM_IN_FILE || in == MPM_IN_MODE_FILE || s->layout.material.kind == MPM_MATERIAL_TWO)
WHEN(HasPrestress, MpmSpaceIsPrestressed(&s->scheme.space))
WHEN(HasMove, s->scheme.space.displaced || s->scheme.space.finite)
WHEN(HasMoveShare, MpmFormulationReads(s->scheme.formulation, "move_share") && HasMove(s, in, f))
WHEN(HasRkPlaces, s->scheme.numbers.rk_places != MPM_RK_FROZEN)
WHEN(HasRelax, s->scheme.numbers.rk_relax)
WHEN(HasKinematics, s->scheme.space.finite)
WHEN(HasShape, s->layout.shape)
WHEN(HasGravity, s->gravity[0] != 0 || s->gravity[1] != 0 || s->gravity[2] != 0)
WHEN(HasStretch, s->law != &MpmLawLinear || s->scheme.space.finite)
WHEN(HasLameRatio, s->law == &MpmLawNeo || (s->scheme.space.finite && s->law->solid))
WHEN(HasExponent, s->law->exponent > 0)

WHEN(IsNotZero, *(const PetscReal *)((const char *)s + f->at) != 0)
WHEN(LawReads, s->law->number[(f->at - offsetof(MpmScene, plastic)) / sizeof s->plastic[0]].reads)

/* ---- the table ---- */

#define BETWEEN(a, b)      .lo = a, .hi = b
#define ABOVE(a)           .lo = a, .hi = PETSC_MAX_REAL, .lo_open = PETSC_TRUE
#define FROM(a)            .lo = a, .hi = PETSC_MAX_REAL
#define ANY                .lo = -PETSC_MAX_REAL, .hi = PETSC_MAX_REAL
#define NO_RANGE           .word = NULL
#define KEPT(kind, member) .value = MPM_##kind, .at = offsetof(MpmScene, member)
#define STRIDE(member)     sizeof(((MpmScene *)0)->member)
#define EACH(kind, member, element) KEPT(kind, member), .each = STRIDE(element)
#define MADE(kind, member) KEPT(kind, member), .by_hand = PETSC_TRUE
#define ASKED(kind, member) .value = MPM_##kind, .owner = MPM_OF_REQUEST, .at = offsetof(MpmRequest, member)
#define OF_MATRIX          .of_matrix = PETSC_TRUE
#define OF_CODE            OF_MATRIX, .with = "program or plugin"
#define READS              .file = MPM_FILE_READ
#define WRITES(of)         .file = MPM_FILE_WRITTEN, .endings = of
#define WORDS(names)       .words = names
#define SHOWN(function)    .shown = function
#define TEXT(function)     .value = MPM_AS_TEXT, .text = function, .by_hand = PETSC_TRUE
#define FILE_IN(member)    ASKED(AS_TEXT, member)
#define IN(file, json, checkpoint, mode_file) .place = {file, json, checkpoint, mode_file}

const MpmField MpmOptions[] = {
  {"formulation", MPM_WORD, "gas2", "the scheme",
   .word = FormulationWord, TEXT(FormulationOf), IN(1, 1, 1, 1)},
  {"scheme", MPM_PATH, NULL, "a scheme as text, instead of formulation: a YAML file, or a block of the scene (docs/theory.md, section 3)",
   NO_RANGE, MADE(AS_TEXT, scheme_hash), IN(59, 41, 47, 40), .json = "scheme.hash", READS},
  {"basis", MPM_WORD, "linear", "the grid's basis functions",
   .word = BasisWord, TEXT(BasisOf), IN(2, 2, 2, 2)},
  {"spline_ends", MPM_WORD, "mirror", "basis quadratic or cubic next to walls and free ends: mirror images, modified (the ghost node continues the last two nodes in a straight line), or open knot vectors",
   WORDS(MpmSplineEndNames), TEXT(SplineEndsOf), IN(57, 39, 46, 39), SHOWN(HasSplineEnds)},
  {"transfer", MPM_WORD, "flip", "how particles are renewed",
   .word = TransferWord, TEXT(TransferOf), IN(3, 3, 3, 3)},
  {"xpic_order", MPM_INTEGER, "2", "order of transfers xpic and fmpm, the terms of their sum; 1 is pic",
   BETWEEN(1, 1000), KEPT(AS_COUNT, scheme.numbers.order), .real = PETSC_TRUE, IN(31, 11, 4, 19), SHOWN(HasOrder)},
  {"blend_ratio", MPM_REAL, "0.95", "share of flip in transfer blend, the rest is pic",
   BETWEEN(0, 1), KEPT(AS_REAL, scheme.numbers.ratio), IN(32, 12, 5, 20), SHOWN(HasRatio)},
  {"aflip_ratio", MPM_REAL, "1", "share of flip in the velocities of transfers aflip and asflip, the rest is apic",
   BETWEEN(0, 1), KEPT(AS_REAL, scheme.numbers.affine_ratio), IN(52, 35, 42, 35), SHOWN(HasAffineRatio)},
  {"pic_filter", MPM_WORD, "after", "gas and elastic: a transfer that filters does so after nodes take the values of the particles (the textbook's pic), or before",
   WORDS(MpmFilterTimeNames), KEPT(AS_WORD, scheme.space.filter), IN(53, 36, 43, 36), SHOWN(HasFilterTime)},
  {"share", MPM_FRACTION, "1/2", "formulation verlet: the part of the strain that comes after the force; 0 is usf, 1 is usl",
   BETWEEN(0, 1), KEPT(AS_REAL, scheme.numbers.share), IN(89, 70, 64, 49), SHOWN(HasShare)},
  {"rk", MPM_WORD, "rk4", "formulation rk: the explicit Runge-Kutta method",
   .word = MpmRkWord, TEXT(RkOf), IN(90, 71, 65, 50), SHOWN(HasRk)},
  {"rk_on", MPM_WORD, "auto", "formulation rk: stages are on particles (a whole P2G and G2P each, transfer flip) or on nodes; auto: on particles with flip, else on nodes",
   WORDS(MpmRkOnNames), TEXT(RkOnOf), IN(91, 72, 66, 51), SHOWN(HasRk)},
  {"rk_places", MPM_WORD, "frozen", "formulation rk: where particles are during a step. frozen: where they were at its start; stages: with kinematics finite they move in each stage, and weights are made anew",
   WORDS(MpmRkPlacesNames), KEPT(AS_WORD, scheme.numbers.rk_places), IN(110, 93, 86, 60), SHOWN(HasRkPlaces)},
  {"theta", MPM_FRACTION, "1/2", "formulation implicit: the weight of the new velocity; 1/2 is the midpoint rule, 1 is backward Euler",
   BETWEEN(0, 1), KEPT(AS_REAL, scheme.numbers.theta), IN(92, 73, 67, 52), SHOWN(HasTheta)},
  {"halvings", MPM_INTEGER, "6", "formulation implicit with kinematics finite: how often a step is halved that does not converge, or that takes a particle a cell or further, before the run ends",
   BETWEEN(0, 30), .tasks = "run", KEPT(AS_COUNT, scheme.numbers.halvings), IN(95, 76, 0, 0), SHOWN(HasHalvings)},
  {"rk_relax", MPM_SWITCH, "false", "formulation rk with kinematics finite: a step whose increments would raise the energy of the particles takes so much less of them that it does not",
   .tasks = "run", KEPT(AS_SWITCH, scheme.numbers.rk_relax), IN(94, 75, 69, 0), SHOWN(HasRelax)},
  {"move_share", MPM_FRACTION, NULL, "formulations verlet and rk, with a prestress or kinematics finite: the share of the new velocity of the grid in that which particles move with, the rest is of the old one (default: verlet 1, rk 1/2)",
   BETWEEN(0, 1), KEPT(AS_REAL, scheme.numbers.move_share), IN(93, 74, 68, 53), SHOWN(HasMoveShare)},
  {"dim", MPM_INTEGER, "1", "space dimensions",
   BETWEEN(1, MPM_MAX_DIM), KEPT(AS_COUNT, layout.dim), IN(10, 5, 27, 22), SHOWN(HasDim)},
  {"gradient", MPM_WORD, "basis", "weights of gradient and divergence: of the basis, or mls (those of MLS-MPM, phi (x_i - x_p) / D)",
   WORDS(MpmGradientNames), KEPT(AS_WORD, scheme.space.gradient), IN(33, 22, 28, 23), SHOWN(HasGradient)},
  {"poisson", MPM_REAL, "0.3", "momentum schemes with dim 2 or 3: Poisson's ratio, plane strain with dim 2; 0.5 is a fluid with pressure only",
   BETWEEN(0, 0.5), .rival = "bulk,shear", KEPT(AS_REAL, scheme.space.poisson), IN(34, 23, 29, 24), SHOWN(HasPoisson)},
  {"cells", MPM_INTEGER, "64", "cells of the grid",
   BETWEEN(1, 2147483646), EACH(AS_COUNT, layout.grid[0].cells, layout.grid[0]), IN(11, 6, 7, 5)},
  {"length", MPM_REAL, "1", "length L of the domain",
   ABOVE(0), .rival = "cell_width", EACH(AS_REAL, length, length[0]), IN(16, 0, 19, 0)},
  {"cell_width", MPM_REAL, NULL, "width h of a cell, instead of length",
   ABOVE(0), .rival = "length", KEPT(AS_REAL, cell_width), IN(0, 26, 0, 0), SHOWN(HasUnits)},
  {"ppc", MPM_INTEGER, "2", "particles per cell, in each direction",
   BETWEEN(1, 1000000), .rival = "counts", MADE(AS_COUNT, layout.ppc[0]), .each = STRIDE(layout.ppc[0]), IN(12, 7, 0, 6)},
  {"counts", MPM_LIST, NULL, "particles in the first cells, such as 1,4,0,2, repeated over the grid; instead of ppc",
   BETWEEN(0, 1000000), .rival = "ppc", MADE(AS_COUNTS, layout.counts), IN(26, 16, 8, 7), SHOWN(HasCounts)},
  {"layout", MPM_PATH, "uniform", "where particles start: uniform (from offset, displaced by jitter), random (anywhere, hashed from seed), or a file: CSV with a header x[,y,z] and optional volume, mass, young, poisson, fixed, and a line for each particle, in the units of length; or the HDF5 file of -output, of which it is the last step",
   NO_RANGE, TEXT(LayoutOf), IN(4, 77, 70, 54), SHOWN(HasLayout), READS},
  {"offset", MPM_FRACTION, "0.5", "start of the first particle, in particle spacings",
   BETWEEN(0, 1 - PETSC_MACHINE_EPSILON / 2), EACH(AS_FRACTION, layout.offset, layout.offset[0]), IN(9, 13, 9, 13), SHOWN(HasOffset)},
  {"jitter", MPM_REAL, "0", "random displacement, in particle spacings; of a layout FILE in 1 / ppc of a cell",
   BETWEEN(0, 1), KEPT(AS_REAL, layout.jitter), IN(20, 14, 10, 14), SHOWN(HasJitter)},
  {"cluster", MPM_RANGE, "0,1", "the part lo,hi of each cell that its particles are squeezed into",
   BETWEEN(0, 1), KEPT(AS_RANGE, layout.cluster), IN(25, 17, 12, 8), SHOWN(HasCluster)},
  {"seed", MPM_INTEGER, "1", "seed of jitter and random data",
   BETWEEN(0, 9007199254740992), KEPT(AS_LONG, layout.seed), IN(14, 15, 11, 15), SHOWN(HasSeed)},
  {"fill", MPM_RANGE, NULL, "cells lo,hi between which there are particles (default: all)",
   ANY},
  {"shape", MPM_WORD, "box", "kinematics finite, dim 2 or 3: particles fill a box, two discs of radius L/5 at 1/5 and 4/5 of the domain, or a ring around its middle, of radii 3/4 and 5/4",
   WORDS(MpmShapeNames), .tasks = "run, spectrum", TEXT(ShapeOf), IN(87, 68, 62, 0), SHOWN(HasShape)},
  {"material", MPM_WORD, "uniform", "momentum schemes: uniform, two (a second one in inclusion), graded (from the first to the second); or, stretched by stretch, neo, svk, tait, gas or polytropic; with kinematics finite also mises, snow, sand or clay, which flow, and herschel_bulkley, a liquid",
   .word = MaterialWord, TEXT(MaterialOf), IN(27, 18, 15, 9), SHOWN(HasMaterialName), .json = "material.kind"},
  {"stretch", MPM_REAL, "1", "F0, how far the material is stretched along x, y and z in the state that the scheme is linear about, or starts from with kinematics finite; it gives prestress and the wave speed there",
   ABOVE(0), EACH(AS_REAL, stretch, stretch[0]), IN(76, 58, 49, 42), SHOWN(HasStretch), .json = "material.stretch"},
  {"lame_ratio", MPM_REAL, "0", "material neo, and all solids with kinematics finite: lambda / mu",
   FROM(0), KEPT(AS_REAL, lame_ratio), IN(77, 59, 50, 43), SHOWN(HasLameRatio), .json = "material.lame_ratio"},
  {"exponent", MPM_REAL, NULL, "material tait (7) and polytropic (1.4): the power of the density that pressure grows with",
   ABOVE(0), KEPT(AS_REAL, exponent), IN(78, 60, 51, 44), SHOWN(HasExponent), .json = "material.exponent"},
  {"yield", MPM_REAL, NULL, "material mises: the yield stress of the start, over rho0 c0^2 (0.005); clay: its preconsolidation pressure (0.01); herschel_bulkley: the shear stress below which it hardly flows (0)",
   FROM(0), KEPT(AS_REAL, plastic[MPM_YIELD]), IN(97, 79, 72, 0), SHOWN(LawReads), .json = "material.yield"},
  {"hardening", MPM_REAL, NULL, "material mises: growth of the yield stress per plastic strain, over rho0 c0^2 (0); snow and clay: of the logarithm of the moduli, or of the preconsolidation pressure, per plastic loss of volume (10)",
   FROM(0), KEPT(AS_REAL, plastic[MPM_HARDENING]), IN(98, 80, 73, 0), SHOWN(LawReads), .json = "material.hardening"},
  {"saturation", MPM_REAL, NULL, "material mises: what Voce's hardening adds to the yield stress in the end, over rho0 c0^2 (0)",
   FROM(0), KEPT(AS_REAL, plastic[MPM_SATURATION]), IN(99, 81, 74, 0), SHOWN(LawReads), .json = "material.saturation"},
  {"saturation_rate", MPM_REAL, NULL, "material mises: how fast Voce's hardening comes to it, per plastic strain (10)",
   FROM(0), KEPT(AS_REAL, plastic[MPM_SATURATION_RATE]), IN(100, 82, 75, 0), SHOWN(LawReads), .json = "material.saturation_rate"},
  {"compression_limit", MPM_REAL, NULL, "material snow: elastic compression along a principal axis beyond which it flows (0.025)",
   ABOVE(0), KEPT(AS_REAL, plastic[MPM_COMPRESSION_LIMIT]), IN(101, 83, 76, 0), SHOWN(LawReads), .json = "material.compression_limit"},
  {"stretch_limit", MPM_REAL, NULL, "material snow: elastic extension along a principal axis beyond which it flows (0.0075)",
   ABOVE(0), KEPT(AS_REAL, plastic[MPM_STRETCH_LIMIT]), IN(102, 84, 77, 0), SHOWN(LawReads), .json = "material.stretch_limit"},
  {"friction_angle", MPM_REAL, NULL, "material sand: the angle of internal friction, in degrees (35); clay: that of the critical state (25)",
   BETWEEN(0, 90), KEPT(AS_REAL, plastic[MPM_FRICTION_ANGLE]), IN(103, 85, 78, 0), SHOWN(LawReads), .json = "material.friction_angle"},
  {"consistency", MPM_REAL, NULL, "material herschel_bulkley: K of the shear stress yield + K rate^flow_index; in units of rho c^2 (h / c)^flow_index, in a scene in physical units pressure x time^flow_index (0)",
   FROM(0), KEPT(AS_REAL, plastic[MPM_CONSISTENCY]), IN(111, 94, 87, 0), SHOWN(LawReads), .json = "material.consistency"},
  {"flow_index", MPM_REAL, NULL, "material herschel_bulkley: the power of the shear rate: below 1 it thins as it flows, above 1 it thickens (1)",
   ABOVE(0), KEPT(AS_REAL, plastic[MPM_FLOW_INDEX]), IN(112, 95, 88, 0), SHOWN(LawReads), .json = "material.flow_index"},
  {"prestress", MPM_REAL, "0", "momentum schemes: sigma0 / (rho c^2), the stress of the state that the scheme is linear about; c is the speed of P waves along x there. With dim 2 along x,y or xx,xy,yy; with dim 3 along x,y,z or xx,xy,xz,yy,yz,zz",
   BETWEEN(-1e6, 1e6), MADE(AS_REAL, scheme.space.prestress), .each = STRIDE(scheme.space.prestress[0]), .numbers = StressNumbers, IN(79, 61, 52, 45), SHOWN(HasPrestress)},
  {"move", MPM_WORD, "grid", "with a prestress or kinematics finite: particles move with the new velocity of the grid, or with that of the second P2G (musl, usavg)",
   WORDS(MpmMoveNames), KEPT(AS_WORD, scheme.space.move), IN(80, 62, 53, 46), SHOWN(HasMove)},
  {"kinematics", MPM_WORD, "linear", "momentum schemes: linear, about a state; or finite, where particles carry the stretch F, move with the grid's velocity, and have the stress of material at F",
   WORDS(MpmKinematicsNames), TEXT(KinematicsOf), IN(81, 63, 56, 47), SHOWN(HasKinematics)},
  {"gravity", MPM_REAL, NULL, "kinematics finite: acceleration of gravity in each direction, in length / time^2, such as 0,-9.81",
   ANY, .tasks = "run, spectrum", EACH(AS_REAL, gravity, gravity[0]), IN(82, 64, 57, 48), SHOWN(HasGravity)},
  {"grid_damping", MPM_REAL, "0", "momentum schemes: alpha, the grid's velocity loses alpha dt of itself in a step; in units of c / h, in a scene in physical units per time",
   FROM(0), KEPT(AS_REAL, grid_damping), IN(104, 86, 79, 55), SHOWN(IsNotZero)},
  {"local_damping", MPM_REAL, "0", "momentum schemes: the part of the force on each node that is taken off against its velocity (Cundall), from 0 to 1",
   BETWEEN(0, 1), KEPT(AS_REAL, scheme.space.local), IN(108, 91, 84, 0), SHOWN(IsNotZero)},
  {"viscosity", MPM_REAL, "0", "momentum schemes: viscosity of a Kelvin-Voigt solid, in proportion to its stiffness; eta of P waves, in units of rho c h, in a scene in physical units pressure x time",
   FROM(0), KEPT(AS_REAL, viscosity), IN(105, 87, 80, 56), SHOWN(IsNotZero)},
  {"shear_viscosity", MPM_REAL, "0", "momentum schemes: viscosity of a Newtonian fluid without bulk viscosity, 2 eta times the deviator of the strain rate; in the units of viscosity. Of material herschel_bulkley the largest viscosity",
   FROM(0), KEPT(AS_REAL, shear_viscosity), IN(106, 88, 81, 57), SHOWN(IsNotZero)},
  {"bulk_viscosity", MPM_REAL, "0", "momentum schemes: viscosity against a change of volume, times the divergence of the velocity; in the units of viscosity",
   FROM(0), KEPT(AS_REAL, bulk_viscosity), IN(107, 89, 82, 58), SHOWN(IsNotZero)},
  {"artificial_linear", MPM_REAL, "0", "kinematics finite: C1 of the artificial viscosity of von Neumann and Richtmyer, which adds the pressure C1 rho c h abs(div v) where particles are compressed (0.2 in Uintah, 0.06 in MPM3D)",
   FROM(0), KEPT(AS_REAL, artificial[0]), IN(113, 96, 89, 0), SHOWN(IsNotZero)},
  {"artificial_quadratic", MPM_REAL, "0", "kinematics finite: C2 of the same, which adds C2 rho (h div v)^2 (2 in Uintah, 1.5 in MPM3D)",
   FROM(0), KEPT(AS_REAL, artificial[1]), IN(114, 97, 90, 0), SHOWN(IsNotZero)},
  {"density_ratio", MPM_REAL, "1", "density of the second material over the first's",
   BETWEEN(1e-15, 1e15), KEPT(AS_REAL, layout.material.density), IN(28, 19, 16, 10), SHOWN(HasMaterial), .json = "material.density_ratio"},
  {"stiffness_ratio", MPM_REAL, "1", "stiffness of the second material over the first's",
   BETWEEN(1e-15, 1e15), KEPT(AS_REAL, layout.material.stiffness), IN(29, 20, 17, 11), SHOWN(HasMaterial), .json = "material.stiffness_ratio"},
  {"inclusion", MPM_RANGE, NULL, "cells lo,hi between which the second material is (default: the right half)",
   ANY, EACH(AS_RANGE, layout.material.inclusion, layout.material.inclusion[0]), IN(30, 21, 18, 12), SHOWN(HasInclusion), .json = "material.inclusion"},
  {"colliders", MPM_BLOCKS, NULL, "momentum schemes but implicit: rigid bodies, as [{shape: plane, point: [0.5, 0.1], normal: [0, 1], contact: separating, friction: 0.3}]; shapes and contacts: mpmstab list colliders",
   NO_RANGE, .tasks = "run, spectrum, critical", MADE(AS_TEXT, colliders), IN(96, 78, 71, 59)},
  {"bodies", MPM_BLOCKS, NULL, "kinematics finite: the particles, as bodies by shape, each with material, velocity, density, young (of a fluid bulk) and ppc, or of a file: [{shape: sphere, center: [0.5, 0.8], radius: 0.1, velocity: [0, -2], material: sand}, {shape: file, path: rock.csv}]",
   NO_RANGE, .tasks = "run, spectrum", MADE(AS_TEXT, bodies), IN(109, 92, 85, 0)},
  {"boundary", MPM_ENDS, "periodic", "the ends of the domain: periodic, or one or two of fixed, fixed_reaction, free, symmetry; of several directions as periodic,fixed-free",
   WORDS(MpmEndNames), MADE(AS_TEXT, boundary), IN(5, 4, 6, 4)},
  {"wave_speed", MPM_REAL, "1", "wave speed c",
   ABOVE(0), .rival = "sound_speed,young,bulk,shear", KEPT(AS_REAL, wave_speed), IN(17, 25, 20, 0), SHOWN(HasSpeed)},
  {"sound_speed", MPM_REAL, NULL, "wave speed c (of pressure waves, with dim 2 or 3), instead of moduli; another word for wave_speed",
   ABOVE(0), .rival = "wave_speed,young,bulk,shear", KEPT(AS_REAL, wave_speed)},
  {"density", MPM_REAL, NULL, "density rho, with young, with bulk and shear, or beside the wave speed",
   ABOVE(0), KEPT(AS_REAL, density), IN(36, 24, 0, 0), SHOWN(HasDensity)},
  {"young", MPM_REAL, NULL, "Young's modulus E: c = sqrt(E / rho) of a bar with dim 1, else with poisson, plane strain with dim 2",
   ABOVE(0), .rival = "wave_speed,sound_speed,bulk,shear"},
  {"bulk", MPM_REAL, NULL, "bulk modulus K, with shear: c = sqrt((K + 4/3 G) / rho); Poisson's ratio follows",
   ABOVE(0), .rival = "wave_speed,sound_speed,young,poisson"},
  {"shear", MPM_REAL, NULL, "shear modulus G, with bulk; 0 is a fluid",
   FROM(0), .rival = "wave_speed,sound_speed,young,poisson"},
  {"courant", MPM_FRACTION, "0.5", "Courant number k = c dt / h; a number or 1/3; run with kinematics finite: auto, as large as the fastest waves at any particle allow",
   ABOVE(0), .also = "auto", .rival = "dt", KEPT(AS_REAL, step.courant), IN(18, 9, 21, 16), SHOWN(HasOneStep)},
  {"safety", MPM_REAL, NULL, "courant auto: part of the largest stable step that is taken (default: 0.8; 0.6 with an affine transfer or gradient mls)",
   BETWEEN(0.01, 1), .tasks = "run", MADE(AS_REAL, safety), IN(88, 69, 63, 0), SHOWN(HasSafety)},
  {"dt", MPM_REAL, NULL, "time step, instead of courant",
   ABOVE(0), .rival = "courant", KEPT(AS_REAL, dt), IN(19, 27, 0, 0), SHOWN(HasTimeStep)},
  {"step_bound", MPM_WORD, "lanczos", "kinematics finite: which bound of the time step is found for the particles as they stand. courant auto takes a part of it, and a step that is given is compared with it. lanczos is the sharpest: it is above the limit with the probability step_bound_chance at most, and is made anew when particles have moved, or when the bound particle has fallen. particle is proved. lone is proved, too, and takes each particle as if it were alone",
   WORDS(MpmStepBoundNames), .tasks = "run", KEPT(AS_WORD, step_bound), IN(0, 90, 83, 0), SHOWN(HasBound)},
  {"drift", MPM_FRACTION, "0", "cells a particle moves per step, U0 dt / h; a number or 1/8",
   BETWEEN(-1e6, 1e6), .rival = "velocity,mach", EACH(AS_FRACTION, step.drift, step.drift[0]), IN(8, 10, 22, 21), SHOWN(HasDrift), .exact = PETSC_TRUE},
  {"velocity", MPM_REAL, NULL, "U0, instead of drift",
   ANY, .rival = "drift,mach", .each = STRIDE(step.drift[0])},
  {"mach", MPM_FRACTION, NULL, "U0 / c, instead of drift, which is then M k; of critical: as the Courant number changes, so does the drift",
   BETWEEN(-1e6, 1e6), .rival = "drift,velocity", .each = STRIDE(step.drift[0])},
  {"steps", MPM_INTEGER, "100", "time steps",
   BETWEEN(1, 1e15), .rival = "time", .tasks = "run", ASKED(AS_LONG, steps), IN(15, 0, 0, 0)},
  {"balance", MPM_WORD, "auto", "how ranks share the grid: cells, as many for each; particles, as many for each at the start; auto: particles where they rest and a rank would have 1.25 times the mean",
   WORDS(MpmBalanceNames), .tasks = "run", KEPT(AS_WORD, layout.balance), IN(0, 0, 54, 0), SHOWN(HasBalance)},
  {"march", MPM_WORD, "fast", "how steps are run: fast, in passes over blocks of particles; plain, one operation after another. Both come to the same numbers but for rounding",
   WORDS(MpmMarchNames), .tasks = "run", KEPT(AS_WORD, layout.march)},
  {"ranks", MPM_INTEGER, NULL, "ranks along each direction, such as 4,1 for slabs; their product is the number of ranks (default: the fewest ghosts)",
   BETWEEN(1, 1000000), .tasks = "run", EACH(AS_COUNT, layout.ranks, layout.ranks[0]), IN(0, 0, 55, 0), SHOWN(HasRanks)},
  {"time", MPM_REAL, NULL, "end of the run, instead of steps; rounded up to a whole step",
   ABOVE(0), .rival = "steps", .tasks = "run"},
  {"initial", MPM_WORD, "mode", "initial data: mode, random, pulse, eigenmode or step; with kinematics finite mode, random, manufactured, vortex, simple_wave, shock_tube, collision or uniform",
   WORDS(MpmInitialNames), .tasks = "run, spectrum", KEPT(AS_WORD, initial), IN(6, 0, 23, 0)},
  {"mode", MPM_INTEGER, "1", "waves in the domain (between ends: number of the mode), with initial mode; of several directions as 1,-1, and one number is along x; number in mode_file, with eigenmode",
   BETWEEN(-2147483646, 2147483646), .tasks = "run, spectrum", MADE(AS_COUNT, mode[0]), .each = STRIDE(mode[0]), IN(13, 0, 24, 0)},
  {"polarisation", MPM_WORD, "p", "momentum schemes with dim 2 or 3, initial mode: p moves along the wave, s across it",
   WORDS(MpmPolarisationNames), .tasks = "run, spectrum", KEPT(AS_WORD, polarisation), IN(35, 0, 30, 0), SHOWN(HasPolarisation)},
  {"mode_file", MPM_PATH, NULL, "file of 'spectrum -output' with the eigenvector for initial eigenmode",
   NO_RANGE, FILE_IN(mode_file), .tasks = "run", READS},
  {"amplitude", MPM_REAL, "1", "amplitude of the initial data",
   ABOVE(0), .tasks = "run, spectrum", KEPT(AS_REAL, amplitude), IN(21, 0, 25, 0)},
  {"stagger", MPM_SWITCH, "false", "start the field updated first half a step early",
   .tasks = "run", KEPT(AS_SWITCH, stagger), IN(7, 0, 26, 0)},
  {"weights", MPM_SWITCH, "false", "measure the slides' weights C1 and C2 at each sampled step",
   .tasks = "run", ASKED(AS_SWITCH, weights)},
  {"source_term", MPM_SWITCH, "false", "measure the slides' source term, sum_p (S^{t+1}_ip - S^t_ip) q_p, at each sampled step",
   .tasks = "run", ASKED(AS_SWITCH, source_term)},
  {"ringing", MPM_SWITCH, "false", "measure the ringing content, the part of particle data in the null space of P2G, at each sampled step",
   .tasks = "run", ASKED(AS_SWITCH, ringing)},
  {"tolerance", MPM_REAL, "1e-6", "exponential growth per step above 1 + tolerance is unstable",
   ABOVE(0), ASKED(AS_REAL, tolerance), IN(22, 0, 0, 0), OF_MATRIX},
  {"phases", MPM_INTEGER, NULL, "phases in [0, 2 pi) at which the symbol is taken, in each direction (default: cells; of matrix_blocks, program and plugin 64, 32 or 16 in 1, 2 or 3 dimensions)",
   BETWEEN(1, 2147483646), .tasks = "symbol, map", ASKED(AS_COUNT, phases[0]), .each = sizeof(PetscInt), OF_MATRIX},
  {"refine", MPM_SWITCH, "false", "take growth also at more and more phases in (0, pi], until the largest stops moving",
   .tasks = "symbol, map", ASKED(AS_SWITCH, refine)},
  {"verbose", MPM_SWITCH, "false", "also print the symbols alpha, kappa and mu at the wave that sets the limit",
   .tasks = "critical", ASKED(AS_SWITCH, verbose)},
  {"damping", MPM_SWITCH, "false", "also how fast waves along x decay, and how far their frequency is off",
   .tasks = "symbol", ASKED(AS_SWITCH, damping)},
  {"damping_divisors", MPM_LIST, "1,2,4,8", "whole numbers: damping is found at the scene's time step divided by each of them",
   BETWEEN(1, 1000000), .tasks = "symbol"},
  {"map_axes", MPM_ENDS, "courant,drift", "what a map goes over: two of courant, drift, offset, ppc, poisson, drift_angle and mach, or two parameters that program or plugin names",
   WORDS(MpmAxisNames), .tasks = "map", OF_MATRIX},
  {"map_courant", MPM_SPAN, "0.05,2.5", "Courant numbers lo,hi of a map",
   ABOVE(0), .tasks = "map", OF_MATRIX},
  {"map_drift", MPM_SPAN, "0,1/2", "drifts lo,hi of a map; fractions",
   BETWEEN(-1e6, 1e6), .tasks = "map", OF_MATRIX},
  {"map_offset", MPM_SPAN, "0,1/2", "offsets lo,hi of a map",
   BETWEEN(0, 1 - PETSC_MACHINE_EPSILON / 2), .tasks = "map", OF_MATRIX},
  {"map_ppc", MPM_SPAN, "1,8", "particles per cell lo,hi of a map: every number between",
   BETWEEN(1, 512), .tasks = "map", OF_MATRIX},
  {"map_poisson", MPM_SPAN, "0,0.49", "Poisson's ratios lo,hi of a map",
   BETWEEN(0, 0.5), .tasks = "map", OF_MATRIX},
  {"map_drift_angle", MPM_SPAN, "0,90", "directions lo,hi of the drift in a map, in degrees from x to y",
   BETWEEN(0, 90), .tasks = "map", OF_MATRIX},
  {"map_mach", MPM_SPAN, "0.01,1", "U0 / c lo,hi of a map; fractions",
   ABOVE(0), .tasks = "map", OF_MATRIX},
  {"map_points", MPM_LIST, "50,33", "points along the two axes of a map",
   BETWEEN(2, 100000), .tasks = "map", OF_MATRIX},
  {"modes", MPM_INTEGER, "8", "leading eigenvectors that go to output",
   BETWEEN(0, 1000000), .tasks = "spectrum", ASKED(AS_COUNT, modes), OF_MATRIX},
  {"measure", MPM_SWITCH, "true", "also march random data and measure growth",
   .tasks = "spectrum", ASKED(AS_SWITCH, measure)},
  {"nodal", MPM_SWITCH, NULL, "at rest, take eigenvalues from the nodes' smaller operator and not from the particles' (default: where the particles have 500 unknowns or more)",
   .tasks = "spectrum, critical, ensemble", ASKED(AS_SWITCH, nodal)},
  {"powers", MPM_INTEGER, NULL, "steps n up to which norm(A^n) is taken",
   BETWEEN(1, 1000000), .tasks = "spectrum", ASKED(AS_COUNT, powers), OF_MATRIX},
  {"pseudospectrum", MPM_INTEGER, NULL, "points along each side of a square at which the pseudospectrum is taken, and the Kreiss constant",
   BETWEEN(2, 1000), .tasks = "spectrum", ASKED(AS_COUNT, pseudospectrum), OF_MATRIX},
  {"tangent", MPM_WORD, "none", "kinematics finite: follow small perturbations through the steps of the run, and say how they grow. random: they start from random numbers. mode: the first one starts from a velocity like that of the mode. The run warns where a perturbation can grow more than warn_above allows",
   WORDS(MpmTangentNames), .tasks = "run", ASKED(AS_WORD, tangent)},
  {"window", MPM_INTEGER, "320", "tangent: steps of a window; the largest growth of any perturbation from its beginning is found after 5 steps, 10, 20 and so on, and at its end",
   BETWEEN(1, 10000), .tasks = "run", ASKED(AS_COUNT, window)},
  {"exponents", MPM_INTEGER, "1", "tangent: perturbations that are followed, each orthogonal to those before it; their growth per step is listed",
   BETWEEN(1, 1000), .tasks = "run", ASKED(AS_COUNT, exponents)},
  {"warn_above", MPM_REAL, "5", "tangent: warn where a perturbation can grow more than this times 1 + c t / h",
   ABOVE(0), .tasks = "run", ASKED(AS_REAL, warn_above)},
  {"at_step", MPM_INTEGER, "0", "kinematics finite: eigenvalues of the tangent of the step after this step of the run",
   BETWEEN(0, 1000000000), .tasks = "spectrum", ASKED(AS_LONG, at_step)},
  {"matrix", MPM_PATH, NULL, "file with the matrix of anybody's step in place of a scene: Matrix Market, PETSc's binary, HDF5 or scipy's .npz",
   NO_RANGE, .tasks = "spectrum", FILE_IN(matrix), IN(61, 43, 0, 0), OF_MATRIX, READS},
  {"matrix_blocks", MPM_PATH, NULL, "HDF5 or .npz file with the blocks A_d of anybody's step on a lattice in place of a scene: arrays d and A; or a matrix that the hook has written, if all cells are alike",
   NO_RANGE, .tasks = "symbol", FILE_IN(matrix_blocks), IN(62, 44, 0, 0), OF_MATRIX, READS},
  {"program", MPM_PATH, NULL, "command of a code in place of a scene: mpmstab starts it, asks it for steps through its standard input and output, and builds its operator from them",
   NO_RANGE, .rival = "plugin", .tasks = "spectrum, symbol, critical, map", FILE_IN(program), IN(63, 45, 0, 0), OF_MATRIX},
  {"plugin", MPM_PATH, NULL, "shared library of a code in place of a scene, with the functions of mpmstab/plugin.h",
   NO_RANGE, .rival = "program", .tasks = "spectrum, symbol, critical, map", FILE_IN(plugin), IN(64, 46, 0, 0), OF_MATRIX, READS},
  {"program_set", MPM_PATH, NULL, "parameters of program or plugin that are set before the first step, such as dt=2e-4,E=400",
   NO_RANGE, .tasks = "spectrum, symbol, critical, map", FILE_IN(program_set), IN(65, 47, 0, 0), OF_CODE},
  {"program_base", MPM_PATH, NULL, "fields of program or plugin that are changed at all particles of its state, such as stress=-1e-3: a base state beside a switch",
   NO_RANGE, .tasks = "spectrum, symbol, critical, map", FILE_IN(program_base), OF_CODE},
  {"program_scene", MPM_PATH, NULL, "keys of a scene, such as cells=12,fill=3,9,ppc=2: program or plugin is given its particles, by place, volume and mass (of a code that takes scenes and describes no particles 10 cells each way)",
   NO_RANGE, .tasks = "spectrum, symbol, critical, map", FILE_IN(program_scene), OF_CODE},
  {"program_dt", MPM_PATH, NULL, "parameter of program or plugin that is its time step (default: dt)",
   NO_RANGE, FILE_IN(program_dt), .tasks = "critical, spectrum, symbol", OF_CODE},
  {"program_timeout", MPM_REAL, "60", "seconds in which program, or a function of plugin, must answer",
   ABOVE(0), .tasks = "spectrum, symbol, critical, map", ASKED(AS_REAL, program_timeout), OF_CODE},
  {"program_period", MPM_INTEGER, NULL, "steps after which a step of program or plugin that changes with its number repeats; they are probed together (default: what the code says, or below 16 what is found)",
   BETWEEN(1, 1000000), .tasks = "spectrum, symbol, critical, map", ASKED(AS_COUNT, program_period), OF_CODE},
  {"program_run", MPM_INTEGER, NULL, "steps that program or plugin is run, with random perturbations beside it: growth is measured, with its confidence interval, and no operator is built",
   BETWEEN(10, 1000000000), .tasks = "spectrum", ASKED(AS_COUNT, program_run), OF_CODE},
  {"probe", MPM_WORD, NULL, "how program or plugin is probed: bloch (one cell), coloured (particles that do not feel one another at a time) or matrix_free (every column, or products alone) (default: bloch where all cells are alike, coloured in other layouts, matrix_free where a step reaches the whole domain or particles have no places)",
   WORDS(MpmProbeNames), .tasks = "spectrum, symbol, critical, map", OF_CODE},
  {"compare", MPM_PATH, NULL, "keys of a scene, such as formulation=usl,transfer=apic,courant=0.5: the step of program or plugin is compared with that scheme, block by block; particles and dt are those of the code",
   NO_RANGE, .tasks = "spectrum, symbol", FILE_IN(compare), IN(67, 49, 0, 0), OF_CODE},
  {"at", MPM_PATH, NULL, "steps of program or plugin after which its state is probed, such as 0,100,200",
   NO_RANGE, .tasks = "spectrum", FILE_IN(at), IN(66, 48, 0, 0), OF_CODE},
  {"matrix_steps", MPM_INTEGER, NULL, "steps that the matrix or the blocks cover, so that growth is per step (default: what the file says, else 1)",
   BETWEEN(1, MPM_MATRIX_MOST_STEPS), .tasks = "spectrum, symbol", ASKED(AS_COUNT, matrix_steps), OF_MATRIX, .with = "matrix or matrix_blocks"},
  {"write_matrix", MPM_PATH, NULL, "file for the operator: .mtx (Matrix Market), .npz (scipy), .h5, .hdf5 or .petsc",
   NO_RANGE, FILE_IN(write_matrix), .tasks = "spectrum", OF_MATRIX, WRITES(".mtx, .npz, .h5, .hdf5 or .petsc")},
  {"write_blocks", MPM_PATH, NULL, "file for the blocks A_d, of which the symbol is sum_d A_d e^(-i beta.d): .npz, .h5 or .hdf5",
   NO_RANGE, FILE_IN(write_blocks), .tasks = "symbol", OF_MATRIX, WRITES(".npz, .h5 or .hdf5")},
  {"write_layout", MPM_PATH, NULL, "file for a layout, which -layout reads: .csv; of neighbourhood worst, the places of the worst layout that was found, in cells; with layout FILE or random, its particles with the bounds of each (lone, particle) and their velocities in the mode that grows first (mode_x)",
   NO_RANGE, FILE_IN(write_layout), .tasks = "critical", WRITES(".csv")},
  {"survey", MPM_SWITCH, "false", "a table of the limits of all schemes at this layout",
   .tasks = "critical", ASKED(AS_SWITCH, survey)},
  {"neighbourhood", MPM_WORDS, NULL, "where particles are: bulk, edge, corner, lone, random, disordered, worst, several of these with commas, or all, but for worst (default: bulk; of critical for a lattice in physical units all that is quick)",
   WORDS(MpmNeighbourhoodNames), .tasks = "critical, spectrum"},
  {"step_bound_chance", MPM_REAL, "1e-6", "layouts that are no lattice, and courant auto: the probability with which the bound lanczos may be above the limit",
   BETWEEN(1e-15, 0.5), .tasks = "critical, run", ASKED(AS_REAL, step_bound_chance)},
  {"step_bound_sweeps", MPM_INTEGER, "0", "layouts that are no lattice: sweeps that make the bound particle better",
   BETWEEN(0, 1000), .tasks = "critical", ASKED(AS_COUNT, step_bound_sweeps)},
  {"voids", MPM_REAL, "0.75", "neighbourhood random: share of the sites that have no particle",
   BETWEEN(0, 0.99), .tasks = "critical, spectrum", ASKED(AS_REAL, voids)},
  {"layouts", MPM_INTEGER, NULL, "random layouts: of seed and the seeds after it (default: 100 of ensemble, 20 of neighbourhoods random, disordered and worst)",
   BETWEEN(1, 1000000), .tasks = "ensemble, critical, spectrum", ASKED(AS_COUNT, layouts)},
  {"output", MPM_PATH, NULL, "HDF5 file: of run, particles and nodes, with an .xmf beside it; else spectrum, symbol or map",
   NO_RANGE, FILE_IN(output), .tasks = "run, spectrum, symbol, map", OF_MATRIX, WRITES(".h5 or .hdf5")},
  {"output_every", MPM_INTEGER, NULL, "steps between outputs (default: first and last)",
   BETWEEN(1, 1e15), .rival = "output_interval", .tasks = "run", ASKED(AS_LONG, output_every)},
  {"output_interval", MPM_REAL, NULL, "time between outputs, instead of output_every: one after the first step that ends at or after each multiple",
   ABOVE(0), .rival = "output_every", .tasks = "run", ASKED(AS_REAL, output_interval)},
  {"checkpoint", MPM_PATH, NULL, "file that a run can be gone on from: at its end, on SIGTERM, and every checkpoint_every steps",
   NO_RANGE, FILE_IN(checkpoint), .tasks = "run", WRITES(".h5 or .hdf5")},
  {"checkpoint_every", MPM_INTEGER, NULL, "steps between checkpoints",
   BETWEEN(1, 1e15), .tasks = "run", ASKED(AS_LONG, checkpoint_every)},
  {"restart", MPM_PATH, NULL, "checkpoint to go on from",
   NO_RANGE, FILE_IN(restart), .tasks = "run", READS},
  {"json", MPM_PATH, NULL, "file for the result, as JSON", NO_RANGE, FILE_IN(json), OF_MATRIX, WRITES(".json")},
  {"csv", MPM_PATH, NULL, "CSV file: of run, the time series; of spectrum, the eigenvalues; of symbol, the curves, or with damping a row for each wave and time step; of critical, a row for each scheme; of ensemble, one for each layout; of map, one for each point", NO_RANGE, FILE_IN(csv), OF_MATRIX, WRITES(".csv")},
  {"trust_scene", MPM_SWITCH, "false", "on the command line only: the scene may name a program or a plugin, which is run, and files to write in any folder",
   NO_RANGE, OF_MATRIX, .no_key = PETSC_TRUE},
  {"progress", MPM_SWITCH, NULL, "progress line from the start (default: after 2 s on a terminal)", NO_RANGE, OF_MATRIX},
  {"expect", MPM_WORD, NULL, "fail unless the verdict is this: stable, unstable or undecided",
   WORDS(MpmVerdictNames), ASKED(AS_WORD, expect.verdict), OF_MATRIX},
  {"expect_kind", MPM_WORD, NULL, "fail unless growth is of this kind: bounded, linear or exponential",
   WORDS(MpmGrowthKindNames), .tasks = "run", ASKED(AS_WORD, expect.kind)},
  {"expect_growth", MPM_RANGE, NULL, "fail unless measured growth lies in lo,hi",
   ANY, .tasks = "run", ASKED(AS_RANGE, expect.range[MPM_EXPECT_GROWTH])},
  {"expect_spectrum", MPM_RANGE, NULL, "fail unless the growth of spectrum or symbol lies in lo,hi",
   ANY, .tasks = "spectrum, symbol", ASKED(AS_RANGE, expect.range[MPM_EXPECT_SPECTRUM]), OF_MATRIX},
  {"expect_critical", MPM_RANGE, NULL, "fail unless the critical Courant number, or of program and plugin the critical dt, lies in lo,hi",
   ANY, .tasks = "critical", ASKED(AS_RANGE, expect.range[MPM_EXPECT_CRITICAL]), OF_MATRIX},
  {"expect_share", MPM_RANGE, NULL, "fail unless the share of unstable layouts lies in lo,hi",
   ANY, .tasks = "ensemble", ASKED(AS_RANGE, expect.range[MPM_EXPECT_SHARE])},
  {"expect_error", MPM_RANGE, NULL, "fail unless the largest l2 error lies in lo,hi",
   ANY, .tasks = "run", ASKED(AS_RANGE, expect.range[MPM_EXPECT_ERROR])},
  {"expect_energy", MPM_RANGE, NULL, "fail unless final / initial energy lies in lo,hi",
   ANY, .tasks = "run", ASKED(AS_RANGE, expect.range[MPM_EXPECT_ENERGY])},
  {NULL},
};

const MpmField MpmDerived[] = {
  {"first", MADE(AS_LONG, layout.first[0]), .each = STRIDE(layout.first[0]), IN(23, 0, 13, 17)},
  {"particles", MADE(AS_LONG, layout.particles), IN(24, 8, 14, 18)},
  {"parameters", MADE(AS_TEXT, parameters), IN(60, 42, 48, 41), .json = "scheme.parameters"},
  {NULL},
};
/* clang-format on */

PetscInt MpmOptionIndex(const char name[])
{
  for (PetscInt i = 0; MpmOptions[i].name; i++)
    if (!strcmp(MpmOptions[i].name, name)) return i;
  return MPM_NOT_AN_OPTION;
}

PetscBool MpmFieldIsOf(const MpmField *option, const char task[])
{
  const size_t length = strlen(task);

  for (const char *of = option->tasks; of && *of; of += strcspn(of, ", "), of += strspn(of, ", "))
    if (strcspn(of, ", ") == length && !strncmp(of, task, length)) return PETSC_TRUE;
  return option->tasks ? PETSC_FALSE : PETSC_TRUE;
}

const char *MpmOptionNear(const char name[])
{
  const char *names[MPM_MAX_OPTIONS];
  PetscInt    n = 0;

  for (; MpmOptions[n].name; n++) names[n] = MpmOptions[n].name;
  return MpmSuggest(name, n, names);
}
