#!/usr/bin/python3
"""Draws the first picture of README.md: the fluid of mpm88.py with steps below and beyond the step that mpmstab finds.

picture.py NAME writes NAME.png and NAME.svg; picture.py --check marches only, and says what became of the particles.
"""
import os
import sys

import numpy as np

import mpm88
from mpmstab import dt as bound

HERE = os.path.dirname(os.path.abspath(__file__))
SHARES, TIME = (0.5, 0.95, 1.35), 0.36
AFTER = 30


def safe_step():
    """The largest step with which no layout of particles at rest grows: that of a lone particle (docs/theory.md, section 4)."""
    fluid = mpm88.Fluid(0)
    at = bound.Layout(fluid.x, fluid.volume0 * fluid.J, fluid.mass, h=mpm88.H, lame=mpm88.MODULUS, mu=0, gradient="mls")
    return 2 / at.lone().max() ** 0.5


def march(step):
    """Particles and speeds after TIME, or AFTER steps after a particle was lost, and whether none was. What is lost is put to
    the wall."""
    fluid, now, lost = mpm88.Fluid(mpm88.GRAVITY), 0.0, 0
    low, high = 1.6 * mpm88.H, 1 - 1.6 * mpm88.H
    while now < TIME and lost < AFTER:
        kept = fluid.x, fluid.v
        with np.errstate(all="ignore"):
            fluid.step(step)
        if not np.isfinite(fluid.x).all():
            fluid.x, fluid.v = kept
            break
        now += step
        lost += bool(lost or fluid.J.min() <= 0 or fluid.x.min() < low or fluid.x.max() > high)
        fluid.x, fluid.J = np.clip(fluid.x, low, high), np.clip(fluid.J, 0.1, 3) if lost else fluid.J
    return fluid.x, np.linalg.norm(fluid.v, axis=1), now, not lost


def draw(name, most, runs):
    sys.path.append(os.path.join(HERE, "..", "..", "scripts", "report"))
    import picture_style
    figure = picture_style.Figure(figsize=(7.2, 3.9), constrained_layout=True)
    grid = figure.subplot_mosaic([[str(share) for share in SHARES], ["line"] * 3], height_ratios=[2.3, 0.75])
    line = grid.pop("line")
    colours = ("#009E73", "#009E73", "#D55E00")
    for (share, (x, speed, _, whole)), colour in zip(runs.items(), colours):
        axes = grid[str(share)]
        axes.scatter(*x.T, c=np.minimum(speed, 4), s=5, cmap="cividis", vmin=0, vmax=4)
        axes.set(xlim=(0, 1), ylim=(0, 1), xticks=[], yticks=[], aspect="equal")
        for spine in axes.spines.values():
            spine.set(color=colour, linewidth=3)
        axes.set_title(f"{share * most * 1e3:.3g} ms  {'✓' if whole else '✗'}", color=colour, fontweight="bold", fontsize=12)
    line.axvspan(0, most * 1e3, color="#009E73", alpha=0.25)
    line.axvspan(most * 1e3, 1.5 * most * 1e3, color="#D55E00", alpha=0.25)
    line.axvline(most * 1e3, color="black", linewidth=2)
    line.text(most * 1e3 * 0.99, 0.62, f"mpmstab: {most * 1e3:.2f} ms", ha="right", fontsize=11, fontweight="bold")
    for share, colour in zip(SHARES, colours):
        line.plot(share * most * 1e3, 0.25, "v", color=colour, markersize=11)
    line.set(xlim=(0, 1.5 * most * 1e3), ylim=(0, 1), yticks=[], xlabel="time step (ms)")
    picture_style.save(figure, name)


def main():
    most = safe_step()
    runs = {share: march(share * most) for share in SHARES}
    for share, (_, speed, now, whole) in runs.items():
        print(f"{share} of {most:.6g} s: {'whole' if whole else 'broken'} after {now:.3g} s, largest speed {speed.max():.3g}")
    if sys.argv[1:] != ["--check"]:
        draw(sys.argv[1], most, runs)
    return 0 if [run[3] for run in runs.values()] == [True, True, False] else 3


if __name__ == "__main__":
    sys.exit(main())
