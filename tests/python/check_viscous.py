#!/usr/bin/python3
"""Runs of viscous liquids and of artificial viscosity: exact flows, a shock, steps that live and steps that do not, other ranks.

check_viscous.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import os
import sys

import numpy as np

from checks import ROOT, check, check_one_line, check_same_runs, forks, loaded, on_ranks, particles, text_of

MPMSTAB = sys.argv[-1]
SHOCK = "-kinematics finite -formulation musl -basis quadratic -ppc 4 -material gas -initial shock_tube -boundary fixed -courant 0.2 -time 0.15"
COLLISION = ("-kinematics finite -formulation musl -basis quadratic -ppc 2 -material gas -initial collision -mach 0.5 -boundary fixed "
             "-cells 64 -courant auto")
UINTAH = "-artificial_linear 0.2 -artificial_quadratic 2"
EXAMPLE = os.path.join(ROOT, "examples", "channel-flow")


def run(words, ranks=1, task="run"):
    return on_ranks(ranks, MPMSTAB, task, *words.split(), *(("-json", "found.json") if task == "run" else ()))


def found(words, ranks=1):
    process = run(words, ranks)
    check(process.returncode == 0, f"{words}: status {process.returncode}: {process.stderr}")
    return loaded("found.json")["run"]


def rate(stress, limit, consistency, index, largest):
    """The shear rate of a stress: that of the largest viscosity, or that of the law where it flows."""
    rigid = stress / largest
    flows = np.maximum((stress - limit) / consistency, 0) ** (1 / index)
    return np.where(limit + consistency * rigid ** index > stress, rigid, flows)


def poiseuille(cells, limit, consistency, index, largest, options):
    """
    The mean error of the velocity of a flow between two walls by a force along them, over the largest velocity. Its shear stress
    is g (1/2 - y), so that with a yield stress a plug in the middle moves as a whole. The numbers are in units of rho, c and the width.
    """
    g, h = 0.02, 1 / cells
    found(f"-kinematics finite -formulation musl -dim 2 -cells 4,{cells} -length {4 * h},1 -ppc 2 -basis quadratic -boundary "
          f"periodic,fixed -material herschel_bulkley -initial uniform -gravity {g},0 -shear_viscosity {largest / h} -yield {limit} "
          f"-consistency {consistency / h ** index} -flow_index {index} -time 30 -output flow.h5 {options}")
    flow = particles("flow.h5")
    s = np.linspace(0, 0.5, 20001)
    slope = rate(g * s, limit, consistency, index, largest)
    below = np.concatenate([[0], np.cumsum((slope[1:] + slope[:-1]) / 2 * np.diff(s))])
    exact = below[-1] - np.interp(abs(flow["coordinates"][:, 1] - 0.5), s, below)
    return np.mean(abs(flow["v_x"] - exact)) / below[-1]


def start_up(cells):
    """The same of the example channel-flow, in which a Newtonian liquid is still faster and faster: a sum over waves between the walls."""
    g, viscosity, time = 0.02, 0.05, 2
    process = on_ranks(1, MPMSTAB, "run", os.path.join(EXAMPLE, "scene.yaml"), "-cells", f"4,{cells}", "-length", f"{4 / cells},1",
                       "-shear_viscosity", str(viscosity * cells), "-output", "flow.h5")
    check(process.returncode == 0, f"channel-flow: {process.stderr}")
    flow = particles("flow.h5")
    n = np.pi * np.arange(1, 200, 2)[:, None]
    exact = (4 * g / (viscosity * n ** 3) * np.sin(n * flow["coordinates"][:, 1]) * -np.expm1(-viscosity * n ** 2 * time)).sum(0)
    return np.mean(abs(flow["v_x"] - exact)) / exact.max()


def check_flows():
    """Order 2 of the parabola, of its start, and of a plug between thin layers that shear."""
    for name, numbers, options, error in (("newtonian", (0, 0.05, 1, 0.5), "-courant 0.2", 0.009),
                                          ("bingham", (0.004, 0.05, 1, 0.5), "-courant 0.2", 0.016),
                                          ("herschel_bulkley", (0.004, 0.03, 0.5, 0.5), "-courant auto", 0.017)):
        coarse, fine = (poiseuille(cells, *numbers, options) for cells in (8, 16))
        check(fine < error and coarse / fine > 2.8, f"{name}: errors {coarse}, {fine}")
    errors = [start_up(cells) for cells in (8, 16, 32)]
    check(errors[0] / errors[1] > 3.5 and errors[1] / errors[2] > 3.5, f"channel-flow: errors {errors}")
    page = text_of(os.path.join(EXAMPLE, "README.md"))
    for cells, error in zip((8, 16, 32), errors):
        check(f"| {cells} | {error:.4f} |" in page, f"the page of channel-flow does not have the error {error:.4f}")


def check_newtonian():
    """Without a yield stress, and with the power 1, the law is a Newtonian liquid: tait with shear_viscosity."""
    for dim, cells in ((1, "16"), (2, "8,6"), (3, "5,4,4")):
        scene = (f"-kinematics finite -formulation musl -dim {dim} -cells {cells} -basis quadratic -initial random -amplitude 0.01 -courant "
                 "0.2 -steps 30")
        found(f"{scene} -material tait -shear_viscosity 0.3 -output tait.h5")
        found(f"{scene} -material herschel_bulkley -shear_viscosity 2 -consistency 0.3 -output same.h5")
        tait, same = particles("tait.h5"), particles("same.h5")
        for field, values in tait.items():
            check(np.abs(values - same[field]).max() < 1e-13, f"dim {dim}: {field} differs by {np.abs(values - same[field]).max()}")


def check_shock():
    """An artificial viscosity takes the oscillations off a shock tube, whose exact solution has order 1 in the mean, and energy."""
    error = {}
    for words in ("", UINTAH, "-artificial_linear 0.06 -artificial_quadratic 1.5"):
        error[words] = [found(f"{SHOCK} -cells {cells} {words}")["error"]["v"]["l1"] for cells in (64, 128, 256)]
    for words, e in error.items():
        check(not words or (e[2] < 0.45 * error[""][2] and e[0] / e[1] > 1.5 and e[1] / e[2] > 1.65), f"shock: {error}")
    ends = [found(f"{COLLISION} {words} -time 0.3")["energy"]["final"] for words in ("", UINTAH)]
    check(ends[1] < 0.9 * ends[0], f"energies at the end of a collision: {ends}")


def noh(velocity, words):
    """Two streams of gas meet: of the shock to the left its speed, the density and velocity behind it, and how the densities scatter."""
    fronts = []
    for time in ("0.06", "0.1"):
        found(f"-kinematics finite -formulation usl -transfer apic -gradient mls -basis quadratic -ppc 4 -material gas -initial collision -mach "
              f"{velocity} -boundary fixed -cells 256 -courant 0.1 -time {time} {words} -output noh.h5")
        gas = particles("noh.h5")
        order = np.argsort(gas["coordinates"][:, 0])
        x, v, density = gas["coordinates"][order, 0], gas["v"][order], 1 / gas["f"][order]
        left = (x > 0.25) & (x < 0.5)
        fronts.append(np.interp(-velocity / 2, -v[left], x[left]))
    behind = (x > fronts[1] + 0.3 * (0.5 - fronts[1])) & (x < 0.5 - 0.3 * (0.5 - fronts[1]))
    return (fronts[0] - fronts[1]) / 0.04, np.median(density[behind]), np.median(v[behind]), np.std(density[behind]) / np.mean(density[behind])


def check_jump():
    """
    Noh's problem in a gas at constant temperature, p = rho: gas of the velocity V and the density 1 comes to rest at a shock. In the
    stream the shock has the speed S, and mass and momentum jump by rho (S - V) = S and rho - 1 = S V: S^2 - S V = 1 and rho = S^2.
    """
    scatters = []
    for velocity in (0.5, 2):
        speed = velocity / 2 + np.hypot(velocity / 2, 1)
        way, density, rest, scatter = noh(velocity, UINTAH)
        for what, off in (("speed of the shock", way / (speed - velocity) - 1), ("density", density / speed ** 2 - 1), ("velocity", rest / speed),
                          ("jump of the mass", density * way / (way + velocity) - 1),
                          ("jump of the momentum", (density - 1) / ((way + velocity) * velocity) - 1)):
            check(abs(off) < 0.01, f"two streams of {velocity} c: the {what} is off by {off}")
        scatters.append((scatter, noh(velocity, "")[3]))
    (slow, slow_bare), (fast, fast_bare) = scatters
    says = f"scatter by {100 * slow:.1f} and {100 * fast:.0f} %, without the viscosity by {100 * slow_bare:.1f} and {100 * fast_bare:.0f} %"
    check(says in " ".join(text_of(os.path.join(ROOT, "docs", "floors.md")).split()), f"docs/floors.md does not say: {says}")


def check_steps():
    """
    The limit of the linear step with the largest viscosity is that of the liquid, below its yield stress too: 0.97 of it lives, and
    1.1 dies. The artificial viscosity shortens the step of courant auto; a number that leaves it out dies.
    """
    lattice = "-dim 2 -basis quadratic -cells 8,8 -ppc 2 -shear_viscosity 8"
    for scheme, liquid in (("musl", "tait"), ("usl", "herschel_bulkley -yield 1")):
        process = forks.run([MPMSTAB, "critical", *f"{lattice} -formulation {scheme} -poisson 0.5 -json limit.json".split()],
                            capture_output=True, text=True, check=False)
        check(process.returncode == 0, process.stderr)
        limit = loaded("limit.json")["critical"]["critical_courant"]
        scene = f"-kinematics finite -formulation {scheme} {lattice} -material {liquid} -initial random -amplitude 1e-9 -steps 1500"
        lives, dies = (run(f"{scene} -courant {factor * limit}") for factor in (0.97, 1.1))
        check("verdict: stable" in lives.stdout, f"{scheme}, {liquid}: 0.97 of {limit}: {lives.stdout}{lives.stderr}")
        check("verdict: unstable" in dies.stdout or dies.returncode == 1, f"{scheme}, {liquid}: 1.1 of {limit}: {dies.stdout}")
    found(f"{COLLISION} -artificial_linear 2 -time 1")
    process = run(f"{COLLISION.replace('auto', '1.2')} -artificial_linear 2 -time 1")
    check(process.returncode == 1, f"a collision with the step of no viscosity: {process.stdout}")


def check_ranks():
    """A run that resumes is one that does not end; other ranks and the plain march have the same particles."""
    flow = ("-kinematics finite -formulation {} -basis quadratic -dim 2 -cells 12,6 -initial random -amplitude 0.02 -mach 0.3,0 -courant 0.1 "
            "-material herschel_bulkley -shear_viscosity 1 -yield 0.001 -consistency 0.1 -flow_index 0.6 " + UINTAH)
    for scene in (flow.format("usl"), flow.format("musl"), flow.format("rk -rk_on nodes"), f"{COLLISION} {UINTAH}"):
        check_same_runs(lambda ranks, *words: found(" ".join(words), ranks), scene, scene)


def check_refusals():
    finite = "-kinematics finite -formulation musl"
    for words, why in (("-formulation usl -material herschel_bulkley", "it flows, and a linear scheme"),
                       (f"{finite} -material herschel_bulkley", "allowed: with shear_viscosity above 0"),
                       (f"{finite} -material herschel_bulkley -shear_viscosity 1 -flow_index 0", "-flow_index 0: "),
                       (f"{finite} -material tait -consistency 1", "-consistency 1: allowed: only with material herschel_bulkley"),
                       ("-formulation usl -artificial_linear 0.2", "-artificial_linear 0.2: allowed: only with kinematics finite"),
                       (f"{finite} -artificial_linear nan", "-artificial_linear nan: "),
                       ("-kinematics finite -formulation implicit -artificial_linear 0.2", "no explicit force"),
                       (f"{finite} -artificial_quadratic 2 -tangent random", "acts in compression alone"),
                       ("-kinematics finite -formulation usl -artificial_linear 1 -courant auto",
                        "courant auto: with damping or viscosity no bound is proved for this scheme")):
        check_one_line(run(words), words, why)


check_flows()
check_newtonian()
check_shock()
check_jump()
check_steps()
check_ranks()
check_refusals()
