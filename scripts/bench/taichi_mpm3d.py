#!/usr/bin/python3
"""Times a step of MLS-MPM in three dimensions as Taichi's example mpm3d has it, in double precision, on the processor.

taichi_mpm3d.py CELLS STEPS THREADS prints ns per particle and step. Two particles a cell in each direction fill all cells
but three at each side. A particle has place, velocity, affine matrix and volume: a fluid, with less to do than a solid.
"""
import json
import sys
import time

import numpy
import taichi as ti

CELLS, STEPS, THREADS = (int(word) for word in sys.argv[1:])
PPC, MARGIN = 2, 3
DX, DT, STIFFNESS = 1 / CELLS, 2e-5, 400.0
VOLUME = (DX / PPC) ** 3

ti.init(arch=ti.cpu, default_fp=ti.f64, cpu_max_num_threads=THREADS, log_level=ti.ERROR)
along = (numpy.arange(PPC * (CELLS - 2 * MARGIN)) + 0.51) / PPC + MARGIN
places = numpy.stack(numpy.meshgrid(along, along, along, indexing="ij"), axis=-1).reshape(-1, 3) * DX
N = len(places)
x, v = ti.Vector.field(3, float, N), ti.Vector.field(3, float, N)
C, J = ti.Matrix.field(3, 3, float, N), ti.field(float, N)
grid_v, grid_m = ti.Vector.field(3, float, (CELLS,) * 3), ti.field(float, (CELLS,) * 3)


@ti.kernel
def step():
    for i in ti.grouped(grid_m):
        grid_v[i] = ti.zero(grid_v[i])
        grid_m[i] = 0
    for p in x:
        base = int(x[p] / DX - 0.5)
        fx = x[p] / DX - base
        w = [0.5 * (1.5 - fx) ** 2, 0.75 - (fx - 1) ** 2, 0.5 * (fx - 0.5) ** 2]
        stress = -DT * 4 * STIFFNESS * VOLUME * (J[p] - 1) / DX ** 2
        affine = ti.Matrix.identity(float, 3) * stress + VOLUME * C[p]
        for offset in ti.static(ti.grouped(ti.ndrange(3, 3, 3))):
            dpos = (offset - fx) * DX
            weight = w[offset[0]][0] * w[offset[1]][1] * w[offset[2]][2]
            grid_v[base + offset] += weight * (VOLUME * v[p] + affine @ dpos)
            grid_m[base + offset] += weight * VOLUME
    for i in ti.grouped(grid_m):
        if grid_m[i] > 0:
            grid_v[i] /= grid_m[i]
        for a in ti.static(range(3)):
            if i[a] < MARGIN and grid_v[i][a] < 0 or i[a] > CELLS - MARGIN and grid_v[i][a] > 0:
                grid_v[i][a] = 0
    for p in x:
        base = int(x[p] / DX - 0.5)
        fx = x[p] / DX - base
        w = [0.5 * (1.5 - fx) ** 2, 0.75 - (fx - 1) ** 2, 0.5 * (fx - 0.5) ** 2]
        new_v, new_c = ti.zero(v[p]), ti.zero(C[p])
        for offset in ti.static(ti.grouped(ti.ndrange(3, 3, 3))):
            dpos = (offset - fx) * DX
            weight = w[offset[0]][0] * w[offset[1]][1] * w[offset[2]][2]
            node = grid_v[base + offset]
            new_v += weight * node
            new_c += 4 * weight * node.outer_product(dpos) / DX ** 2
        v[p] = new_v
        x[p] += DT * v[p]
        J[p] *= 1 + DT * new_c.trace()
        C[p] = new_c


x.from_numpy(places)
v.from_numpy(0.1 * numpy.sin(2 * numpy.pi * places))
J.fill(1)
step()  # compiles it
ti.sync()
begin = time.perf_counter()
for _ in range(STEPS):
    step()
ti.sync()
seconds = time.perf_counter() - begin
speed = float(numpy.abs(v.to_numpy()).max())
if not 0 < speed < 1:
    sys.exit(f"taichi_mpm3d: the largest velocity is {speed}")
print(json.dumps({"ns_per_particle_step": 1e9 * seconds / STEPS / N, "particles": N}))
