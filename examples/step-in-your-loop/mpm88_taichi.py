#!/usr/bin/python3
"""A fluid like that of mpm88 falls into a box, in Taichi, with the step of its own particles.

mpm88_taichi.py [--share S] [--time T] [--still] [--check]

Before each step the kernel largest_step finds the step, by the bound of particles (`particle` in mpmstab.dt) for usl with apic
and the gradients of mls. Its pass over the particles is that of P2G, so that a code can have the two sums with its own P2G.
--still: without gravity. --check: says the bound of the start twice, by the kernel and by mpmstab.dt.
"""
import argparse
import os
import sys

import numpy as np
import taichi as ti

GRID, COUNT, MODULUS, DENSITY, GRAVITY = 32, 600, 400.0, 1.0, 9.8
H = 1 / GRID
VOLUME0 = 0.16 / COUNT
MASS = DENSITY * VOLUME0

ti.init(arch=ti.cpu, default_fp=ti.f64, log_level=ti.WARN)
vector, matrix = ti.types.vector(2, ti.f64), ti.types.matrix(2, 2, ti.f64)
x, v = vector.field(shape=COUNT), vector.field(shape=COUNT)
C, J = matrix.field(shape=COUNT), ti.field(ti.f64, COUNT)
grid_v, grid_m, grid_a = vector.field(shape=(GRID, GRID)), ti.field(ti.f64, (GRID, GRID)), ti.field(ti.f64, (GRID, GRID))


@ti.func
def weigh(at):
    base = ti.cast(ti.floor(at / H - 0.5), ti.i32)
    f = at / H - base
    return base, f, ti.Matrix.rows([0.5 * (1.5 - f) ** 2, 0.75 - (f - 1) ** 2, 0.5 * (f - 0.5) ** 2])


@ti.func
def largest_eigenvalue(G, lame, mu):
    """The largest eigenvalue of the stress of sym(. G): with the eigenvalues a, b of G that of
    [[(lame + 2 mu) a, lame sqrt(a b)], [lame sqrt(a b), (lame + 2 mu) b]]."""
    a_b, ab = G.trace(), G.determinant()
    apart = ti.max(a_b ** 2 - 4 * ab, 0.0)
    modulus = lame + 2 * mu
    return 0.5 * (modulus * a_b + ti.sqrt(modulus ** 2 * apart + 4 * lame ** 2 * ti.max(ab, 0.0)))


@ti.kernel
def largest_step(lame: ti.f64, mu: ti.f64) -> ti.f64:
    for i, j in grid_m:
        grid_m[i, j] = 0
        grid_a[i, j] = 0
    for p in x:
        base, f, w = weigh(x[p])
        for i, j in ti.static(ti.ndrange(3, 3)):
            weight = w[i, 0] * w[j, 1]
            slope = 4 / H * weight * (ti.Vector([i, j]) - f)
            grid_m[base + ti.Vector([i, j])] += MASS * weight
            grid_a[base + ti.Vector([i, j])] += VOLUME0 * J[p] * slope.norm()
    omega2, lone = 0.0, 0.0
    for p in x:
        base, f, w = weigh(x[p])
        G = ti.Matrix.zero(ti.f64, 2, 2)
        for i, j in ti.static(ti.ndrange(3, 3)):
            slope = 4 / H * w[i, 0] * w[j, 1] * (ti.Vector([i, j]) - f)
            if slope.norm() > 0:
                node = base + ti.Vector([i, j])
                G += slope.outer_product(slope) * (grid_a[node] / (grid_m[node] * slope.norm()))
        ti.atomic_max(omega2, largest_eigenvalue(G, lame, mu))
        # gradients of mls: the sum of S r r^T / D^2 is the identity over D
        ti.atomic_max(lone, VOLUME0 * J[p] / MASS * 4 / H ** 2 * (2 * lame + 2 * mu))
    return ti.sqrt(2 / omega2 + 2 / lone)


@ti.kernel
def step(dt: ti.f64, gravity: ti.f64) -> ti.f64:
    for i, j in grid_m:
        grid_v[i, j] = [0, 0]
        grid_m[i, j] = 0
    for p in x:
        base, f, w = weigh(x[p])
        stress = -dt * 4 * MODULUS * VOLUME0 * (J[p] - 1) / H ** 2
        affine = ti.Matrix([[stress, 0], [0, stress]]) + MASS * C[p]
        for i, j in ti.static(ti.ndrange(3, 3)):
            arm = (ti.Vector([i, j]) - f) * H
            weight = w[i, 0] * w[j, 1]
            grid_v[base + ti.Vector([i, j])] += weight * (MASS * v[p] + affine @ arm)
            grid_m[base + ti.Vector([i, j])] += weight * MASS
    for i, j in grid_m:
        if grid_m[i, j] > 0:
            grid_v[i, j] /= grid_m[i, j]
        grid_v[i, j].y -= dt * gravity
        for a in ti.static(range(2)):
            at = i if a == 0 else j
            if at < 3:
                grid_v[i, j][a] = ti.max(grid_v[i, j][a], 0)
            if at > GRID - 4:
                grid_v[i, j][a] = ti.min(grid_v[i, j][a], 0)
    fastest = 0.0
    for p in x:
        base, f, w = weigh(x[p])
        new_v, new_C = ti.Vector.zero(ti.f64, 2), ti.Matrix.zero(ti.f64, 2, 2)
        for i, j in ti.static(ti.ndrange(3, 3)):
            arm = (ti.Vector([i, j]) - f) * H
            at = w[i, 0] * w[j, 1] * grid_v[base + ti.Vector([i, j])]
            new_v += at
            new_C += 4 / H ** 2 * at.outer_product(arm)
        v[p], C[p] = new_v, new_C
        x[p] += dt * new_v
        J[p] *= 1 + dt * new_C.trace()
        ti.atomic_max(fastest, new_v.norm())
    return fastest


def start():
    rng = np.random.default_rng(1)
    x.from_numpy(rng.uniform(0.2, 0.6, (COUNT, 2)))
    v.from_numpy(1e-3 * rng.standard_normal((COUNT, 2)))
    C.fill(0)
    J.fill(1)


def run(share, time, gravity):
    """Returns steps, the first and the last step allowed, and the largest velocity; infinity where it breaks."""
    start()
    now, allowed, fastest = 0.0, [], 0.0
    while now < time:
        allowed.append(largest_step(MODULUS, 0.0))
        dt = share * allowed[-1]
        fast = step(dt, gravity)
        now, fastest = now + dt, max(fastest, fast)
        places = x.to_numpy()
        if not (fast < H / dt and J.to_numpy().min() > 0 and places.min() > 1.5 * H and places.max() < 1 - 1.5 * H):
            return len(allowed), allowed[0], allowed[-1], np.inf
    return len(allowed), allowed[0], allowed[-1], fastest


def check():
    """The bound of the start, with a modulus of shear too, by the kernel and by mpmstab.dt."""
    sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts", "python"))
    from mpmstab import dt
    start()
    J.from_numpy(np.linspace(0.5, 2, COUNT))
    for mu in (0.0, 150.0):
        same = dt.step(x.to_numpy(), VOLUME0 * J.to_numpy(), MASS, h=H, lame=MODULUS, mu=mu, bound="particle",
                       scheme="mls-mpm")
        print(repr(largest_step(MODULUS, mu)), repr(same.dt))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--share", type=float, default=0.95)
    parser.add_argument("--time", type=float, default=0.6)
    parser.add_argument("--still", action="store_true")
    parser.add_argument("--check", action="store_true")
    args = parser.parse_args()
    if args.check:
        return check()
    steps, first, last, fastest = run(args.share, args.time, 0.0 if args.still else GRAVITY)
    print(f"{steps} steps, largest step at first {first:.10g} s, at last {last:.10g} s")
    print(f"largest velocity {fastest:.3g}" if np.isfinite(fastest) else "it breaks")
    return sys.exit(0 if np.isfinite(fastest) else 3)


if __name__ == "__main__":
    main()
