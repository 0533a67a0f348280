#!/usr/bin/python3
"""A block of rubber flies through a periodic grid: MLS-MPM in the manner of mpm88, with three time steps.

mpm88.py [-o NAME.png] [--cells N] [--time T] [--courant K] [--mach M]

Nothing here is of mpmstab. The block fills the box, so that it meets no wall, and all of it moves with Mach number M. A wave
of 1/100 of the speed of sound and noise of 1e-6 are all that deforms it. A moving frame cannot change what it does, so
its energy in the frame that moves with it must not rise. The script prints this energy over what it was at the start:
its largest value and its last one. -o draws it over time.
"""
import argparse
import math

import numpy as np

PPC = 2  # particles a cell, along each direction
POISSON = 0.3
AMPLITUDE, NOISE = 1e-2, 1e-6  # velocities over c
STEPS = ("usl", "verlet", "rk4")


class Block:
    """Particles with position x (in cells), velocity v, affine velocity C and deformation gradient F. c = h = rho = 1."""

    def __init__(self, cells, mach, seed=1):
        rng = np.random.default_rng(seed)
        place = (np.arange(cells * PPC) + 0.5) / PPC
        self.cells = cells
        self.x = np.stack(np.meshgrid(place, place, indexing="ij"), -1).reshape(-1, 2)
        self.drift = mach * np.array([1, 0.5]) / math.hypot(1, 0.5)
        wave = np.sin(2 * np.pi * self.x / cells)
        self.v = self.drift + AMPLITUDE * wave + NOISE * rng.standard_normal(self.x.shape)
        self.v += self.drift - self.v.mean(axis=0)
        self.C = np.zeros((len(self.x), 2, 2))
        self.F = np.zeros((len(self.x), 2, 2)) + np.eye(2)
        self.m = self.volume = 1 / PPC ** 2
        self.lame = POISSON / (1 - POISSON)  # in units of the modulus of P waves, rho c^2
        self.mu = (1 - self.lame) / 2

    def find_weights(self):
        """Quadratic splines: the nine nodes of each particle, their weights and how far they are."""
        base = np.floor(self.x - 0.5)
        fx = self.x - base
        w = np.stack([0.5 * (1.5 - fx) ** 2, 0.75 - (fx - 1) ** 2, 0.5 * (fx - 0.5) ** 2])
        i, j = (a.ravel() for a in np.meshgrid(range(3), range(3), indexing="ij"))
        self.weight = w[i, :, 0] * w[j, :, 1]
        self.arm = np.stack([i, j], -1)[:, None, :] - fx
        node = (base + np.stack([i, j], -1)[:, None, :]).astype(int) % self.cells
        self.node = (node[..., 0] * self.cells + node[..., 1]).ravel()
        self.mass = self.scatter(self.m * self.weight)

    def scatter(self, values):
        return np.bincount(self.node, values.ravel(), minlength=self.cells ** 2)

    def p2g(self):
        """The nodal velocity that v and C of the particles make."""
        affine = self.v + np.einsum("pab,npb->npa", self.C, self.arm)
        return np.stack([self.scatter(self.m * self.weight * affine[..., a]) for a in (0, 1)], -1) / self.mass[:, None]

    def acceleration(self, F):
        """What the stress of a neo-Hookean solid does to the nodes."""
        J = np.linalg.det(F)
        tau = self.mu * (F @ np.swapaxes(F, 1, 2) - np.eye(2)) + self.lame * np.log(J)[:, None, None] * np.eye(2)
        pull = -4 * self.volume * np.einsum("pab,npb->npa", tau, self.arm)
        return np.stack([self.scatter(self.weight * pull[..., a]) for a in (0, 1)], -1) / self.mass[:, None]

    def gather(self, nodal):
        """The velocity of the particles, and its gradient, which is C."""
        at = nodal[self.node].reshape(9, -1, 2)
        return np.einsum("np,npa->pa", self.weight, at), 4 * np.einsum("np,npa,npb->pab", self.weight, at, self.arm)

    def energy(self):
        """In the frame that moves along: of v, of C, and of the strain."""
        b = np.einsum("pab,pab->p", self.F, self.F)
        log_j = np.log(np.linalg.det(self.F))
        strain = self.mu / 2 * (b - 2 - 2 * log_j) + self.lame / 2 * log_j ** 2
        return np.sum(self.m * (np.sum((self.v - self.drift) ** 2, axis=1) + np.sum(self.C ** 2, axis=(1, 2)) / 4) / 2
                      + self.volume * strain)

    def finish(self, nodal, dt):
        self.v, self.C = self.gather(nodal)
        self.x = (self.x + dt * self.v) % self.cells

    # ---- the three steps ----

    def usl(self, dt):
        y = self.p2g()
        y = y + dt * self.acceleration(self.F)
        L = self.gather(y)[1]
        self.F = self.F + dt * L @ self.F
        self.finish(y, dt)

    def verlet(self, dt):
        y = self.p2g()
        L = self.gather(y)[1]  # gathered anew: C of the last step would make it usl again
        self.F = self.F + dt / 2 * L @ self.F
        y = y + dt * self.acceleration(self.F)
        L = self.gather(y)[1]
        self.F = self.F + dt / 2 * L @ self.F
        self.finish(y, dt)

    def rk4(self, dt):
        start, F = self.p2g(), self.F
        y = start
        for share in (1 / 4, 1 / 3, 1 / 2, 1):
            a, L = self.acceleration(F), self.gather(y)[1]
            y, F = start + share * dt * a, self.F + share * dt * L @ F
        self.F = F
        self.finish(y, dt)


def run(step, cells, courant, mach, time):
    """Returns times and the energy over that of the start. It ends early where the energy is a hundred times as large."""
    block = Block(cells, mach)
    times, energies = [0.0], [block.energy()]
    while times[-1] < time and energies[-1] < 100 * energies[0]:
        block.find_weights()
        getattr(block, step)(courant)
        times.append(times[-1] + courant)
        energies.append(block.energy())
    return np.array(times), np.array(energies) / energies[0]


def draw(found, args):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib.figure import Figure
    figure = Figure(figsize=(5.2, 4), constrained_layout=True)
    axes = figure.subplots()
    for (step, (times, energies)), colour, line in zip(found.items(), ("#D55E00", "#0072B2", "#009E73"), ("-", "--", "-.")):
        axes.plot(times, energies, line, color=colour, linewidth=2, label=step)
    axes.set(yscale="log", ylim=(0.3, 100), yticks=[0.3, 1, 3, 10, 30, 100], yticklabels=["0.3", "1", "3", "10", "30", "100"])
    axes.set_xlabel("time, $h/c$", fontsize=13)
    axes.set_ylabel("energy over that of the start", fontsize=13)
    axes.set_title(f"MLS-MPM, {args.cells} x {args.cells} cells, 4 particles a cell,\n"
                   f"Mach {args.mach:g}, $k = c\\,\\Delta t/h$ = {args.courant:g}", fontsize=13)
    axes.grid(True, color="#dddddd")
    axes.tick_params(labelsize=12)
    axes.legend(fontsize=13)
    figure.savefig(args.output, dpi=150, metadata={"Software": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", metavar="NAME.png")
    parser.add_argument("--cells", type=int, default=16)
    parser.add_argument("--time", type=float, default=400)
    parser.add_argument("--courant", type=float, default=0.9)
    parser.add_argument("--mach", type=float, default=0.2)
    args = parser.parse_args()
    found = {step: run(step, args.cells, args.courant, args.mach, args.time) for step in STEPS}
    for step, (times, energies) in found.items():
        print(f"{step:<6} largest {energies.max():.6f}, at time {times[-1]:.0f} {energies[-1]:.4g}")
    if args.output:
        draw(found, args)


if __name__ == "__main__":
    main()
