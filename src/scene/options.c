/* The options: one line each, with default, range and help. */
#include "scene/material.h"
#include <mpmstab/scene.h>
#include <string.h>

static const char *FormulationWord(PetscInt i)
{
  return MpmFormulations[i] ? MpmFormulations[i]->name : NULL;
}

static const char *BasisWord(PetscInt i)
{
  return MpmBases[i] ? MpmBases[i]->name : NULL;
}

static const char *InitialWord(PetscInt i)
{
  return MpmInitialNames[i];
}

static const char *VerdictWord(PetscInt i)
{
  return MpmVerdictNames[i];
}

static const char *GrowthWord(PetscInt i)
{
  return MpmGrowthKindNames[i];
}

static const char *TransferWord(PetscInt i)
{
  return MpmTransfers[i] ? MpmTransfers[i]->name : NULL;
}

static const char *LayoutWord(PetscInt i)
{
  return i == 0 ? "uniform" : NULL;
}

static const char *MaterialWord(PetscInt i)
{
  return MpmMaterialNames[i];
}

static const char *EndWord(PetscInt i)
{
  return MpmEndNames[i];
}

static const char *AxisWord(PetscInt i)
{
  return MpmAxisNames[i];
}

/* clang-format off */
#define BETWEEN(a, b) .lo = a, .hi = b
#define ABOVE(a)      .lo = a, .hi = PETSC_MAX_REAL, .lo_open = PETSC_TRUE
#define NO_RANGE      .word = NULL
#define ANY           .lo = -PETSC_MAX_REAL, .hi = PETSC_MAX_REAL

const MpmOption MpmOptions[] = {
  {"formulation",  MPM_WORD,     "gas2",     "the scheme", .word = FormulationWord},
  {"basis",        MPM_WORD,     "linear",   "the grid's basis functions", .word = BasisWord},
  {"transfer",     MPM_WORD,     "flip",     "how particles are renewed", .word = TransferWord},
  {"xpic_order",   MPM_INTEGER,  "2",        "terms of transfer xpic; 1 is pic", BETWEEN(1, 1000)},
  {"blend_ratio",  MPM_REAL,     "0.95",     "share of flip in transfer blend, the rest is pic", BETWEEN(0, 1)},
  {"dim",          MPM_INTEGER,  "1",        "space dimensions", BETWEEN(1, 1)},
  {"cells",        MPM_INTEGER,  "64",       "cells of the grid", BETWEEN(1, 2147483646)},
  {"length",       MPM_REAL,     "1",        "length L of the domain", ABOVE(0)},
  {"ppc",          MPM_INTEGER,  "2",        "particles per cell", BETWEEN(1, 1000000), .rival = "counts"},
  {"counts",       MPM_LIST,     NULL,       "particles in the first cells, such as 1,4,0,2, repeated over the grid; instead of ppc", BETWEEN(0, 1000000), .rival = "ppc"},
  {"layout",       MPM_WORD,     "uniform",  "where particles start", .word = LayoutWord},
  {"offset",       MPM_FRACTION, "0.5",      "start of the first particle, in particle spacings", BETWEEN(0, 1 - PETSC_MACHINE_EPSILON / 2)},
  {"jitter",       MPM_REAL,     "0",        "random displacement, in particle spacings", BETWEEN(0, 1)},
  {"cluster",      MPM_RANGE,    "0,1",      "the part lo,hi of each cell that its particles are squeezed into", BETWEEN(0, 1)},
  {"seed",         MPM_INTEGER,  "1",        "seed of jitter and random data", BETWEEN(0, 9007199254740992)},
  {"fill",         MPM_RANGE,    NULL,       "cells lo,hi between which there are particles (default: all)", ANY},
  {"material",     MPM_WORD,     "uniform",  "momentum schemes: uniform, two (a second one in inclusion), or graded (from the first to the second)", .word = MaterialWord},
  {"density_ratio", MPM_REAL,    "1",        "density of the second material over the first's", BETWEEN(1e-15, 1e15)},
  {"stiffness_ratio", MPM_REAL,  "1",        "stiffness of the second material over the first's", BETWEEN(1e-15, 1e15)},
  {"inclusion",    MPM_RANGE,    NULL,       "cells lo,hi between which the second material is (default: the right half)", ANY},
  {"boundary",     MPM_ENDS,     "periodic", "the ends of the domain: periodic, or one or two of fixed, fixed_reaction, free", .word = EndWord},
  {"wave_speed",   MPM_REAL,     "1",        "wave speed c", ABOVE(0)},
  {"courant",      MPM_REAL,     "0.5",      "Courant number k = c dt / h", ABOVE(0), .rival = "dt"},
  {"dt",           MPM_REAL,     NULL,       "time step, instead of courant", ABOVE(0), .rival = "courant"},
  {"drift",        MPM_FRACTION, "0",        "cells a particle moves per step, U0 dt / h; a number or 1/8", BETWEEN(-1e6, 1e6), .rival = "velocity"},
  {"velocity",     MPM_REAL,     NULL,       "U0, instead of drift", ANY, .rival = "drift"},
  {"steps",        MPM_INTEGER,  "100",      "time steps", BETWEEN(1, 1e15), .rival = "time", .tasks = "run"},
  {"time",         MPM_REAL,     NULL,       "end of the run, instead of steps; rounded up to a whole step", ABOVE(0), .rival = "steps", .tasks = "run"},
  {"initial",      MPM_WORD,     "mode",     "initial data: mode, random, pulse, eigenmode or step", .word = InitialWord, .tasks = "run"},
  {"mode",         MPM_INTEGER,  "1",        "waves in the domain (between ends: number of the mode), with initial mode; number in mode_file, with eigenmode", BETWEEN(1, 2147483646), .tasks = "run"},
  {"mode_file",    MPM_PATH,     NULL,       "file of 'spectrum -output' with the eigenvector for initial eigenmode", NO_RANGE, .tasks = "run"},
  {"amplitude",    MPM_REAL,     "1",        "amplitude of the initial data", ABOVE(0), .tasks = "run"},
  {"stagger",      MPM_SWITCH,   "false",    "start the field updated first half a step early", NO_RANGE, .tasks = "run"},
  {"weights",      MPM_SWITCH,   "false",    "measure the slides' weights C1 and C2 at each sampled step", NO_RANGE, .tasks = "run"},
  {"source_term",  MPM_SWITCH,   "false",    "measure the slides' source term, sum_p (S^{t+1}_ip - S^t_ip) q_p, at each sampled step", NO_RANGE, .tasks = "run"},
  {"ringing",      MPM_SWITCH,   "false",    "measure the ringing content, the part of particle data that P2G does not see, at each sampled step", NO_RANGE, .tasks = "run"},
  {"tolerance",    MPM_REAL,     "1e-6",     "exponential growth per step above 1 + tolerance is unstable", ABOVE(0)},
  {"phases",       MPM_INTEGER,  NULL,       "phases in [0, 2 pi) at which the symbol is taken (default: cells)", BETWEEN(1, 2147483646), .tasks = "symbol, map"},
  {"map_axes",     MPM_ENDS,     "courant,drift", "what a map goes over: two of courant, drift, offset and ppc", .word = AxisWord, .tasks = "map"},
  {"map_courant",  MPM_SPAN,     "0.05,2.5", "Courant numbers lo,hi of a map", ABOVE(0), .tasks = "map"},
  {"map_drift",    MPM_SPAN,     "0,1/2",    "drifts lo,hi of a map; fractions", BETWEEN(-1e6, 1e6), .tasks = "map"},
  {"map_offset",   MPM_SPAN,     "0,1/2",    "offsets lo,hi of a map", BETWEEN(0, 1 - PETSC_MACHINE_EPSILON / 2), .tasks = "map"},
  {"map_ppc",      MPM_SPAN,     "1,8",      "particles per cell lo,hi of a map: every number between", BETWEEN(1, 512), .tasks = "map"},
  {"map_points",   MPM_LIST,     "50,33",    "points along the two axes of a map", BETWEEN(2, 100000), .tasks = "map"},
  {"modes",        MPM_INTEGER,  "8",        "leading eigenvectors that go to output", BETWEEN(0, 1000000), .tasks = "spectrum"},
  {"measure",      MPM_SWITCH,   "true",     "also march random data and measure growth", NO_RANGE, .tasks = "spectrum"},
  {"powers",       MPM_INTEGER,  NULL,       "steps n up to which norm(A^n) is taken", BETWEEN(1, 1000000), .tasks = "spectrum"},
  {"pseudospectrum", MPM_INTEGER, NULL,      "points along each side of a square at which the pseudospectrum is taken, and the Kreiss constant", BETWEEN(2, 1000), .tasks = "spectrum"},
  {"survey",       MPM_SWITCH,   "false",    "a table of the limits of all schemes at this layout", NO_RANGE, .tasks = "critical"},
  {"layouts",      MPM_INTEGER,  "100",      "random layouts: of seed and the seeds after it", BETWEEN(1, 1000000), .tasks = "ensemble"},
  {"output",       MPM_PATH,     NULL,       "HDF5 file: of run, particles and nodes, with an .xmf beside it; else spectrum, symbol or map", NO_RANGE, .tasks = "run, spectrum, symbol, map"},
  {"output_every", MPM_INTEGER,  NULL,       "steps between outputs (default: first and last)", BETWEEN(1, 1e15), .tasks = "run"},
  {"checkpoint",   MPM_PATH,     NULL,       "file that a run can be gone on from: at its end, on SIGTERM, and every checkpoint_every steps", NO_RANGE, .tasks = "run"},
  {"checkpoint_every", MPM_INTEGER, NULL,    "steps between checkpoints", BETWEEN(1, 1e15), .tasks = "run"},
  {"restart",      MPM_PATH,     NULL,       "checkpoint to go on from", NO_RANGE, .tasks = "run"},
  {"json",         MPM_PATH,     NULL,       "file for the result, as JSON", NO_RANGE},
  {"csv",          MPM_PATH,     NULL,       "CSV file: of run, the time series; of spectrum, the eigenvalues; of symbol, the curves; of critical, a row for each scheme; of ensemble, one for each layout; of map, one for each point", NO_RANGE},
  {"progress",     MPM_SWITCH,   NULL,       "progress line from the start (default: after 2 s on a terminal)", NO_RANGE},
  {"expect",       MPM_WORD,     NULL,       "fail unless the verdict is this: stable, unstable or undecided", .word = VerdictWord},
  {"expect_kind",  MPM_WORD,     NULL,       "fail unless growth is of this kind: bounded, linear or exponential", .word = GrowthWord, .tasks = "run"},
  {"expect_growth", MPM_RANGE,   NULL,       "fail unless measured growth lies in lo,hi", ANY, .tasks = "run"},
  {"expect_spectrum", MPM_RANGE, NULL,       "fail unless the growth of spectrum or symbol lies in lo,hi", ANY, .tasks = "spectrum, symbol"},
  {"expect_critical", MPM_RANGE, NULL,       "fail unless the critical Courant number lies in lo,hi", ANY, .tasks = "critical"},
  {"expect_share", MPM_RANGE,    NULL,       "fail unless the share of unstable layouts lies in lo,hi", ANY, .tasks = "ensemble"},
  {"expect_error", MPM_RANGE,    NULL,       "fail unless the largest l2 error lies in lo,hi", ANY, .tasks = "run"},
  {"expect_energy", MPM_RANGE,   NULL,       "fail unless final / initial energy lies in lo,hi", ANY, .tasks = "run"},
  {NULL},
};
/* clang-format on */

PetscInt MpmOptionIndex(const char name[])
{
  for (PetscInt i = 0; MpmOptions[i].name; i++)
    if (!strcmp(MpmOptions[i].name, name)) return i;
  return MPM_NOT_AN_OPTION;
}
