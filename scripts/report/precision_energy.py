"""Energy over long runs at finite strain, without the energy of the uniform motion: a table, and a picture over time.

A neo-Hookean block of 8 cells a direction (periodic) carries one wave and moves with Mach 1/10 to t = 300 h / c. Its
energy is that of the particles, kinetic and strain. Steps are compared at equal cost too: usl at k = 0.15 costs about what rk4
costs at 0.6 and kg5 at 0.75.
"""
import csv
import math
import os
import tempfile

from matplotlib.figure import Figure

import picture_style as style
from precision_study import SCHEMES, TRANSFERS
from program import launch

END, CELLS, MACH = 300, 8, 0.1
STEPS = (("usl", 0.15), ("usl", 0.6), ("musl", 0.6), ("usavg", 0.6), ("verlet", 0.6), ("rk4", 0.6), ("rk4", 1.2), ("kg5", 0.75))
BLOCK = {"kinematics": "finite", "material": "neo", "basis": "quadratic", "mode": "1,0", "amplitude": 0.3, "dim": 2}
SCENES = {  # what differs from the block
    "small strain": {"kinematics": "linear"},
    "shear wave": {"polarisation": "s"},
    "a = 0.001": {"amplitude": 1e-3},
    "a = 0.1": {"amplitude": 0.1},
    "a = 0.3": {},
    "oblique": {"mode": "1,1"},
    "disordered": {"jitter": 0.4},
    "hats": {"basis": "linear"},
    "cubic": {"basis": "cubic"},
    "3-D": {"dim": 3, "mode": "1,1,1"},
}
DRAWN = "a = 0.3"


def energies(scheme, courant, transfer="flip", more=()):
    """Returns times and energies over the first, or the program's message if it refuses."""
    given = {**BLOCK, **SCHEMES[scheme], **dict(more), **TRANSFERS[transfer], "courant": courant, "time": END}
    given.pop("stagger", None)
    linear = given["kinematics"] == "linear"
    if linear:
        given.pop("material")
    dim = int(given["dim"])
    given.update(cells=",".join([str(CELLS)] * dim), length=",".join([str(CELLS)] * dim), mach=",".join([str(MACH)] + ["0"] * (dim - 1)))
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "energy.csv")
        _, found, said = launch("run", None, {**given, "csv": path})
        if "run" not in found:
            return [], [], said.removeprefix("mpmstab: ")
        with open(path, encoding="utf-8") as file:
            rows = [(float(row["time"]), float(row["energy"] or "nan")) for row in csv.DictReader(file)]
    moving = 0 if linear else CELLS**dim * MACH**2 / 2
    first = rows[0][1] - moving
    return [time for time, _ in rows], [(energy - moving) / first for _, energy in rows], ""


def entry(values):
    """Returns the largest energy and that at the end."""
    if not values:
        return "-"
    if not all(map(math.isfinite, values)) or max(values) > 100:
        return "grows"
    return f"{max(values):.3f}; {values[-1]:.3f}"


def lines_of(first, rows, entry_of):
    lines = [f"| {first} | {' | '.join(f'{scheme} {courant:g}' for scheme, courant in STEPS)} |", "|---" * (1 + len(STEPS)) + "|"]
    return lines + [f"| {name} | {' | '.join(entry_of(name, *step) for step in STEPS)} |" for name in rows]


def tables():
    """Returns the two tables: of the scenes with flip, and of the transfers in one scene."""
    def scene(name, scheme, courant):
        return entry(energies(scheme, courant, "flip", SCENES[name].items())[1])

    def transfer(name, scheme, courant):
        return entry(energies(scheme, courant, name, SCENES[DRAWN].items())[1])
    return lines_of("flip", SCENES, scene) + [""] + lines_of("a = 0.3", TRANSFERS, transfer)


def draw():
    """Draws energy over time of the schemes in one scene."""
    figure = Figure(figsize=(4.6, 4.4), constrained_layout=True)
    axes = figure.add_subplot()
    kinds = ("-", "--", "-.", ":")
    colours = (*style.COLOURS, "#000000", style.GREY)
    for number, (scheme, courant) in enumerate(STEPS):
        times, values, _ = energies(scheme, courant, "flip", SCENES[DRAWN].items())
        if values:
            axes.plot(times, values, color=colours[number], linestyle=kinds[number % 4], linewidth=1.6,
                      label=f"{scheme}, k = {courant:g}: {values[-1]:.3f} left")
    axes.axhline(1, color="0.7", linewidth=0.8, zorder=0)
    axes.set_xlim(0, END)
    axes.set_ylim(0, 2.05)
    axes.set_xlabel("time, in h / c (a period of the wave is 8)")
    axes.set_ylabel("energy of the wave over its first")
    axes.set_title("2-D neo-Hookean block, P wave, velocity 0.3 c,\nMach 1/10, 8 x 8 cells, ppc 2 x 2, quadratic, flip", fontsize=10)
    style.legend_below(axes, fontsize=8, columnspacing=0.8)
    return figure
