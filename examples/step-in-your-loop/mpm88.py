#!/usr/bin/python3
"""A fluid like that of mpm88 falls into a box, in numpy, with the step of its own particles.

mpm88.py [--share S] [--time T] [--still] [--layout NAME.csv]

Each step is S (at first 0.95) of the largest step of the particles as they stand. A new certificate is made when the fastest
particle may have moved a tenth of a cell. --still: without gravity, so that the particles stay where they are. --layout
writes the particles of the start.
"""
import argparse
import os
import sys

import numpy as np

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts", "python"))
from mpmstab import dt as bound  # noqa: E402 (found by the line above)

GRID, H, MODULUS, DENSITY, GRAVITY = 32, 1 / 32, 400.0, 1.0, 9.8
NINE = np.stack(np.meshgrid(range(3), range(3), indexing="ij"), -1).reshape(9, 1, 2)


class Fluid:
    def __init__(self, gravity, seed=1):
        rng = np.random.default_rng(seed)
        self.x = rng.uniform(0.2, 0.6, (600, 2))
        self.v = 1e-3 * rng.standard_normal(self.x.shape)
        self.C = np.zeros((600, 2, 2))
        self.J = np.ones(600)
        self.volume0 = 0.16 / 600
        self.mass = DENSITY * self.volume0
        self.gravity = gravity

    def largest_step(self, seed):
        """The pressure is -MODULUS (J - 1). Its modulus and the volume of now are MODULUS and volume0 J. A wall only takes
        freedom away, so that it need not be named."""
        return bound.step(self.x, self.volume0 * self.J, self.mass, h=H, lame=MODULUS, mu=0, basis="quadratic",
                          scheme="mls-mpm", seed=seed).dt

    def step(self, dt):
        base = np.floor(self.x / H - 0.5).astype(int)
        f = self.x / H - base
        w = np.stack([(1.5 - f) ** 2 / 2, 0.75 - (f - 1) ** 2, (f - 0.5) ** 2 / 2])
        weight = w[NINE[:, 0, 0], :, 0] * w[NINE[:, 0, 1], :, 1]
        arm = (NINE - f) * H
        node = ((base + NINE) @ [GRID, 1]).ravel()
        push = -dt * self.volume0 * MODULUS * (self.J - 1) * 4 / H ** 2
        affine = push[:, None, None] * np.eye(2) + self.mass * self.C
        given = self.mass * self.v + np.einsum("pab,npb->npa", affine, arm)
        mass = np.bincount(node, (self.mass * weight).ravel(), GRID ** 2)
        v = np.stack([np.bincount(node, (weight * given[..., a]).ravel(), GRID ** 2) for a in (0, 1)], -1)
        v /= np.where(mass > 0, mass, 1)[:, None]
        v[:, 1] -= dt * self.gravity
        at = np.indices((GRID, GRID)).reshape(2, -1).T
        v = np.where(at < 3, np.maximum(v, 0), np.where(at > GRID - 4, np.minimum(v, 0), v))
        near = v[node].reshape(9, -1, 2)
        self.v = np.einsum("np,npa->pa", weight, near)
        self.C = 4 / H ** 2 * np.einsum("np,npa,npb->pab", weight, near, arm)
        self.x = self.x + dt * self.v
        self.J = self.J * (1 + dt * np.einsum("paa->p", self.C))


def run(share, time, gravity=GRAVITY):
    """Returns steps, the first and the last bound, and the largest velocity. It ends early where a particle is lost."""
    fluid = Fluid(gravity)
    now, steps, moved, bounds, fastest = 0.0, 0, np.inf, [], 0.0
    while now < time:
        if moved > 0.1 * H:
            bounds.append(fluid.largest_step(seed=len(bounds)))
            dt, moved = share * bounds[-1], 0.0
        fluid.step(dt)
        now, steps = now + dt, steps + 1
        fast = np.abs(fluid.v).max()
        moved, fastest = moved + dt * fast, max(fastest, fast)
        if not (fast < H / dt and fluid.J.min() > 0 and fluid.x.min() > 1.5 * H and fluid.x.max() < 1 - 1.5 * H):
            fastest = np.inf
            break
    return steps, bounds, fastest


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--share", type=float, default=0.95)
    parser.add_argument("--time", type=float, default=0.6)
    parser.add_argument("--still", action="store_true")
    parser.add_argument("--layout", metavar="NAME.csv")
    args = parser.parse_args()
    if args.layout:
        fluid = Fluid(0)
        columns = np.column_stack([fluid.x, fluid.volume0 * fluid.J, np.full(len(fluid.x), fluid.mass)])
        np.savetxt(args.layout, columns, "%.17g", ",", header="x,y,volume,mass", comments="")
    steps, bounds, fastest = run(args.share, args.time, 0 if args.still else GRAVITY)
    print(f"{steps} steps, {len(bounds)} certificates, largest step at first {bounds[0]:.10g} s, at last {bounds[-1]:.10g} s")
    print(f"largest velocity {fastest:.3g}" if np.isfinite(fastest) else "it breaks")
    sys.exit(0 if np.isfinite(fastest) else 3)


if __name__ == "__main__":
    main()
