#!/usr/bin/python3
"""What share of the exact step the bounds of mpmstab.dt give on random layouts: the least of several. exact k is the least, too."""
import os
import sys

import numpy as np

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts", "python"))
from mpmstab import dt  # noqa: E402 (found by the line above)

CASES = (("quadratic", 1, 100, 4), ("quadratic", 2, 16, 4), ("quadratic", 3, 8, 1), ("cubic", 2, 16, 4), ("hats", 1, 100, 4),
         ("hats", 2, 16, 4))


def main():
    rng = np.random.default_rng(1)
    print("basis      dim  layout    exact k    lone   particle   5 sweeps   lanczos")
    for basis, dim, cells, many in CASES:
        for kind in ("jittered", "random"):
            shares, exact = [], []
            for seed in range(many):
                cell = np.stack(np.meshgrid(*[np.arange(2 * cells)] * dim, indexing="ij"), -1).reshape(-1, dim)
                x = (cell + rng.random(cell.shape)) / 2 if kind == "jittered" else cells * rng.random(cell.shape)
                lame, mu = (0.3 / 0.7, 0.2 / 0.7) if dim > 1 else (1, 0)
                at = dt.Layout(x, 1, 1, h=1, lame=lame, mu=mu, basis=basis, nodes=cells, periodic=True)
                least = at.lanczos(150, seed=seed)[1]
                found = at.lone().max(), at.particle()[0], at.particle(5)[0], at.lanczos(seed=seed)[0]
                shares.append([np.sqrt(least / omega2) for omega2 in found])
                exact.append(2 / np.sqrt(least))
            least = np.min(shares, axis=0)
            print(f"{basis:<10} {dim}    {kind:<8}  {min(exact):.3f}      " + "      ".join(f"{s:.2f}" for s in least))


if __name__ == "__main__":
    main()
