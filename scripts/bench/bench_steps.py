#!/usr/bin/python3
"""What steps that do not ring cost: marches of usl, musl, verlet and rk beside one another, in turn, with their best times.

k is the largest Courant number without growth of the lattice at rest (critical), and the last column the time c t / h that a
second of run time covers at this k, which is what a user pays for.
"""
import bench_runs
import program

STEPS = ("usl", "musl", "verlet", "rk -rk rk3", "rk -rk rk4", "rk -rk rk4 -rk_on nodes", "rk -rk kg5")
CELLS, MARCH = "256,256", 40


def options_of(step, **more):
    """The options of a step, such as 'rk -rk rk4', and others."""
    words = step.split()
    return {"formulation": words[0], **dict(zip((word[1:] for word in words[1::2]), words[2::2])), **more}


def main():
    args = bench_runs.parser(__doc__, 3).parse_args()
    print(f"2-D, {CELLS} cells, ppc 2, flip, jitter 0.9; ns a particle and step, and its ratio to usl")
    print(f"{'basis':9} {'drift':9} {'step':24} {'ns':>7} {'ratio':>6} {'k':>7} {'c t / h a second':>17}")
    for basis in ("linear", "quadratic"):
        limits = {step: bench_runs.result_of_run("critical", options_of(step, basis=basis))["critical"]["critical_courant"]
                  for step in STEPS}
        for drift in ("0", "0.03,0.01"):
            times = {step: [] for step in STEPS}
            for _ in range(args.repeats):
                for step in STEPS:
                    run = bench_runs.result_of_run("run", options_of(
                        step, dim=2, cells=CELLS, jitter=0.9, initial="random", courant=0.2, steps=MARCH, basis=basis, drift=drift))
                    times[step].append(run["run"]["ns_per_particle_step"])
                    seconds = 1e-9 * run["particles"]
            for step in STEPS:
                best = min(times[step])
                print(f"{basis:9} {drift:9} {step:24} {best:7.1f} {best / min(times['usl']):6.2f} {limits[step]:7.4f} "
                      f"{limits[step] / (best * seconds):17.1f}", flush=True)


if __name__ == "__main__":
    program.end_in_one_line(main)
