#!/usr/bin/python3
"""Breaks the program in some forty places, one at a time, and says which test of every day notices it.

mutations.py FOLDER [NAME...]: FOLDER is a clone of this repository with a build folder 'build', which this script
changes. For each line of MUTATIONS (or those of these names) it writes the mutation into the source, builds, runs the
tests of every day until one fails, and puts the source back. It prints a row 'name,seconds,first test that failed', and
ends with status 1 if a mutation was not noticed.
"""
import pathlib
import re
import subprocess
import sys
import time

FORMULATION, BASIS, TRANSFER = "src/scheme/formulation/", "src/scheme/basis/", "src/scheme/transfers.c"
MUTATIONS = [  # name, file, what stands there, what is put in its place
    ("usl: half a strain", FORMULATION + "usl.c", "GRAD(S, V_I, COURANT),      /* 5.", "HALF_GRAD(S, V_I, COURANT), /* 5."),
    ("usf: half a strain", FORMULATION + "usf.c", "GRAD(S, V_I, COURANT),      /* 2.", "HALF_GRAD(S, V_I, COURANT), /* 2."),
    ("musl: half a strain", FORMULATION + "musl.c", "GRAD(S, V_I, COURANT),      /* 6.", "HALF_GRAD(S, V_I, COURANT), /* 6."),
    ("usavg: one and a half strains", FORMULATION + "usavg.c", "HALF_GRAD(S, V_I, COURANT), /* 2.", "GRAD(S, V_I, COURANT), /* 2."),
    ("verlet: shares by 1e-6", FORMULATION + "verlet.c", "strain          = numbers->share;", "strain          = 1.000001 * numbers->share;"),
    ("rk4: a coefficient by 1e-6", FORMULATION + "rk.c", "{1. / 4, 1. / 3, 1. / 2, 1}", "{1. / 4, 1.000001 / 3, 1. / 2, 1}"),
    ("implicit: the matrix by 1e-6", FORMULATION + "implicit.c", "IMPLICIT(A_I, theta * theta,", "IMPLICIT(A_I, 1.000001 * theta * theta,"),
    ("gas1: no Courant number", FORMULATION + "gas1.c", "GRAD(R, U_I, COURANT)", "GRAD(R, U_I, ONE)"),
    ("gas2: no Courant number", FORMULATION + "gas2.c", "GRAD(U, R_I, COURANT)", "GRAD(U, R_I, ONE)"),
    ("elastic: increment times k", FORMULATION + "elastic.c", "G2P(W, A_I, ONE)", "G2P(W, A_I, COURANT)"),
    ("linear: weight by 1e-9", BASIS + "linear.c", "phi[1] = xi;", "phi[1] = xi * (1 + 1e-9);"),
    ("gimp: weight by 1e-6", BASIS + "gimp.c", "/ (4 * l);", "/ (4.000004 * l);"),
    ("quadratic: weight by 1e-9", BASIS + "splines.h", "0.75 - d * d;", "0.75 - d * d * (1 + 1e-9);"),
    ("cubic: slope by 1e-6", BASIS + "splines.h", "-2 * xi + 1.5 * xi * xi", "-2 * xi + 1.500001 * xi * xi"),
    ("open ends: weight by 1e-6", BASIS + "cubic_open.c", "1.5 * w[step]", "1.500001 * w[step]"),
    ("modified ends: sign", BASIS + "modified.h", "w[2 * step] -= w[0];", "w[2 * step] += w[0];"),
    ("pic: factor by 1e-9", TRANSFER, "AppendShare(table, 0,", "AppendShare(table, -1e-9,"),
    ("blend: share by 1e-6", TRANSFER, "AppendShare(table, numbers->ratio,", "AppendShare(table, numbers->ratio + 1e-6,"),
    ("xpic: term by 1e-6", TRANSFER, "smoothed, -1)", "smoothed, -1.000001)"),
    ("fmpm: symbol of one term less", TRANSFER, "r < numbers->order; r++) sum", "r < numbers->order - 1; r++) sum"),
    ("aflip: share by 1e-6", TRANSFER, "1 - numbers->affine_ratio, ONE", "1.000001 - numbers->affine_ratio, ONE"),
    ("tpic: no gradient of the functions", TRANSFER, ".taylor    = PETSC_TRUE,", ""),
    ("nullspace: symbol by 1e-6", TRANSFER, "return alpha > 0 ? 1 : 0;", "return alpha > 0 ? 0.999999 : 0;"),
    ("halo: lost sums of other ranks", "src/march/grid.c", "+= h->others[n * l + f]", "+= 0 * h->others[n * l + f]"),
    ("symbol: growth of the least rank", "src/symbol/symbol.c", "&s->growth, 1, MPIU_REAL, MPI_MAX",
     "&s->growth, 1, MPIU_REAL, MPI_MIN"),
    ("march: particles do not migrate", "src/march/march.c", "if (most + 1 > march->slack)", "if (most > march->slack + 100)"),
    ("wall: mirror image one node off", "src/scheme/maps.c", "-node : 2 * last - node;", "-node : 2 * last - node + 1;"),
    ("bloch: phase in the wrong direction", "src/symbol/bloch.c", "angle -= beta[a]", "angle += beta[a]"),
    ("growth: of the period, not of a step", "src/base/verdict.c", "* exponent) / period);", "* exponent));"),
    ("verdict: defective pairs are stable", "src/base/verdict.c", "f->defective_error <= f->tolerance ? MPM_STABLE : MPM_UNDECIDED", "MPM_STABLE"),
    ("refusal of particles beyond the end is gone", "src/scene/scene.c", "offset->value >= l->jitter / 2 &&", "offset->value >= 0 &&"),
    ("units: Young's modulus without Poisson's ratio", "src/scene/scene_grid.c", "*stiffness *= MpmMaterialStiffness(scene->layout.dim, nu);", ""),
    ("neo: modulus at a stretch", "src/scheme/material/neo.c", "m->mu * (largest + 1)", "m->mu * (2 * largest)"),
    ("svk: tangent without its second part", "src/scheme/material/svk.c", "AddPushed(dim, dF, S, F, dtau);", ""),
    ("mises: hardening by 1e-3", "src/scheme/material/mises.c", "+ k[MPM_HARDENING] * q", "+ 1.001 * k[MPM_HARDENING] * q"),
    ("clay: friction by 1e-2", "src/scheme/material/clay.c", "/ (3 - sine))", "/ (3 - 1.01 * sine))"),
    ("gravity by 1e-6", "src/march/finite.c", "unit * (scene->gravity[a]", "unit * (1.000001 * scene->gravity[a]"),
    ("errors: l2 over the volume", "src/march/diagnostics.c", "sqrt(sums[1] / volume)", "sqrt(sums[1]) / volume"),
    ("critical: corners are edges", "src/analysis/patch.c", "kind == MPM_AT_CORNER ? 2 : 1", "1"),
    ("critical: Mach number by 1e-6", "src/analysis/critical_mach.c", "= MpmMachCourant(mach, part).value",
     "= 1.000001 * MpmMachCourant(mach, part).value"),
    ("energy: not halved", "src/march/diagnostics.c", "terms ? sums[1] / 2 : NAN", "terms ? sums[1] : NAN"),
    ("checkpoint: one step ahead", "src/io/checkpoint.c", "[MPM_AT_STEP]     = march->step,", "[MPM_AT_STEP]     = march->step + 1,"),
    ("ensemble: undecided layouts count", "src/analysis/ensemble.c", "(PetscReal)e->unstable / e->n", "(PetscReal)(e->unstable + e->undecided) / e->n"),
    ("random numbers: another seed", "src/base/hash.h", "((uint64_t)id + 1) *", "((uint64_t)id + 2) *"),
]
STAGES = ["unit", "core", "parallel", "cli", "docs"]  # the cheap ones first


def find_first_failure(folder):
    """The name of the first test of every day that fails, or ''."""
    for label in STAGES:
        done = subprocess.run(["ctest", "--test-dir", "build", "-L", label, "--stop-on-failure", "--parallel", "2"],
                              cwd=folder, capture_output=True, text=True)
        failed = re.search(r"^\s*\d+ - (\S+) \((?:Failed|Timeout|SEGFAULT|Subprocess aborted)", done.stdout, re.M)
        if failed:
            return failed[1]
    return ""


def try_mutation(folder, file, old, new):
    path = folder / file
    kept = path.read_text(encoding="utf-8")
    if old not in kept:
        sys.exit(f"mutations.py: {file} has no '{old}'")
    path.write_text(kept.replace(old, new, 1), encoding="utf-8")
    try:
        built = subprocess.run(["cmake", "--build", "build", "--parallel", "2"], cwd=folder, capture_output=True, text=True)
        return "(does not build)" if built.returncode else find_first_failure(folder)
    finally:
        path.write_text(kept, encoding="utf-8")


def main():
    folder, names = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2:]
    unseen = 0
    for name, file, old, new in MUTATIONS:
        if names and name not in names:
            continue
        begin = time.monotonic()
        failed = try_mutation(folder, file, old, new)
        unseen += not failed
        print(f"{name},{time.monotonic() - begin:.0f},{failed or '(no test)'}", flush=True)
    return 1 if unseen else 0


if __name__ == "__main__":
    sys.exit(main())
