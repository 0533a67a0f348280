#!/usr/bin/python3
"""Checks scenes in physical units: the same steps give the same bits, and critical prints the limit as a time step.

check_units.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import math
import sys

from checks import ROOT, check, forks, loaded

PLANE = "-dim 2 -formulation usl -basis quadratic -transfer apic -gradient mls"
SMALL = f"{PLANE} -cells 8,4 -initial random -steps 60"  # cells an eighth wide: norms differ by powers of two
WIDTH = "-cell_width 0.0078125"
NUMBERS = f"{SMALL} -courant 0.512 -drift 1/8,-1/16 -poisson 0.2"
UNITS = f"{SMALL} -density 1 -young 360 -poisson 0.2 {WIDTH} -dt 0.0002 -velocity 4.8828125,-2.44140625"
LONE = "-cells 6 -ppc 1 -fill 3,4,3,4 -offset 0.3,0.2"
LONE_PAGE = "-cells 6 -ppc 1 -fill 3,4,3,4"


def run(words, ranks=1, status=0):
    """Runs the program with -json and returns its lines and the JSON object."""
    done = forks.run([sys.argv[1], "-n", str(ranks), sys.argv[2], *words.split(), "-json", "units.json"],
                     capture_output=True, text=True, check=False)
    check(done.returncode == status, f"{words}: status {done.returncode}: {done.stderr}")
    return done.stdout.splitlines(), loaded("units.json")


def check_same(ranks):
    """Courant number and drift, and dt and velocity with moduli: the run is the same; logarithms of its norms have other roundings."""
    (_, a), (lines, b) = run(f"run {NUMBERS}", ranks), run(f"run {UNITS}", ranks)
    growth = [of["run"]["growth_measured"] for of in (a, b)]
    check(math.isclose(*growth, rel_tol=1e-14), f"growth_measured on {ranks} ranks: {growth}")
    for key in ("steps", "growth_kind"):
        check(a["run"][key] == b["run"][key], f"{key} on {ranks} ranks: {a['run'][key]} and {b['run'][key]}")
    check(a["courant"] == b["courant"] == 0.512 and a["drift"] == b["drift"] == [0.125, -0.0625], "the steps differ")
    check(not {"density", "wave_speed", "cell_width", "dt"} & set(a), "units in a scene that has none")
    check((b["density"], b["wave_speed"], b["cell_width"], b["dt"]) == (1, 20, 0.0078125, 0.0002), "units differ")
    check("Courant number 0.512, dt 0.0002, drift 1/8,-1/16 cells per step, velocity (4.88281, -2.44141), " in lines[1],
          lines[1])
    check(lines[2] == "units of the scene: wave speed 20, cells 0.0078125 wide, density 1, Poisson's ratio 0.2", lines[2])


def check_limit(words, courant, last):
    """The last lines of critical, and critical_dt. The limits are those of the closed forms of docs/theory.md."""
    lines, found = run(f"critical {words}")
    limit, width, speed = found["critical"]["critical_courant"], found["cell_width"], found["wave_speed"]
    check(math.isclose(limit, courant, rel_tol=1e-6), f"{words}: {limit}, not {courant}")
    check(math.isclose(found["critical"]["critical_dt"], limit * width / speed, rel_tol=1e-15), f"{words}: critical_dt")
    check(lines[-1].startswith(last), f"{words}: {lines[-2:]}")
    return lines, found


def check_limits():
    fluid = f"{PLANE} -density 1 -bulk 400 -shear 0"
    lone = f"{fluid} {LONE}"
    dt = math.sqrt(0.5) / 20 / 128
    lines, found = check_limit(f"{lone} {WIDTH}", math.sqrt(0.5), f"largest stable dt: {dt:.6g}; layout, ppc 1,1, offset 0.3,0.2, in a part of the grid")
    check("verdict" not in found and "dt" not in found and not any("verdict" in line for line in lines),
          "a verdict at a step that nobody asked for")
    check("Courant number 0.5" not in lines[1] and "dt is 0.000390625 times the Courant number" in lines[2], lines[2])
    check(any(line.strip() == f"which is dt {dt:.6g}" for line in lines), "the bound of any layout as a time step")
    lines, _ = run(f"critical {lone} {WIDTH} -dt 0.0002763")
    ratio = 0.0002763 / dt
    check(lines[-1].startswith(f"dt 0.0002763 is {ratio:.6g} times the limit 0.000276214: it grows by"), lines[-1])
    lines, _ = run("critical -formulation usl -sound_speed 20 -dt 0.1 -drift 1/8 -cell_width 2 -basis quadratic "
                   "-neighbourhood bulk")
    check(lines[-2].startswith("largest dt with growth within tolerance: "), lines[-2])


def check_none():
    """A scheme that grows at every step."""
    lines, found = run("critical -formulation gas1 -sound_speed 20 -dt 0.1 -cell_width 2 -neighbourhood bulk")
    check(lines[-2] == "largest stable dt: 0; lattice, ppc 2, offset 0.5" and
          lines[-1] == f"dt 0.1 is beyond it: it grows by a factor of {found['growth']:.6g} per step", lines[-1])


BULK = "-neighbourhood bulk"
PAGES = (("mpm88", "", 0, "dt 0.0002 is 0.724 of the limit 0.000276214"),
         ("mpm88", BULK, 0, "dt 0.0002 is 0.392 of the limit 0.000510302"),
         ("mpm88", LONE_PAGE, 0, "dt 0.0002 is 0.724 of the limit 0.000276214"),
         ("mpm88", f"{LONE_PAGE} -dt 2.8e-4", 3, "dt 0.00028 is 1.01 times the limit 0.000276214: it grows by a factor of "),
         ("mpm88", f"{LONE_PAGE} -cell_width 0.005", 3,
          "dt 0.0002 is 1.13 times the limit 0.000176777: it grows by a factor of "),
         ("mpm99-jelly", BULK, 0, "dt 0.0001 is 0.179 of the limit 0.000559008"),
         ("mpmat-bar", "", 0, "dt 0.03125 is 0.264 of the limit 0.118317"),
         ("cb-geo-gimp", BULK, 0, "dt 0.001 is 0.192 of the limit 0.00519615"),
         ("cb-geo-gimp", f"{BULK} -density 1 -dt 0.01", 0, "dt 0.01 is 0.192 of the limit 0.0519615"))


def check_pages():
    """The commands of the pages of examples in physical units, and the growth that goes with a verdict."""
    for example, words, status, last in PAGES:
        lines, found = run(f"critical {ROOT}/examples/{example}/scene.yaml {words}", 1, status)
        check(lines[-1].startswith(last), f"{example} {words}: {lines[-1]}")
        check(example != "mpm99-jelly" or any(line.strip() == "which is dt 0.000382733" for line in lines), example)
        check(status == 0 or lines[-1] == f"{last}{found['growth']:.6g} per step", lines[-1])
    lines, found = run(f"symbol {ROOT}/examples/cb-geo-gimp/scene.yaml -drift 1/8,0 -cells 64", 1, 3)
    check("velocity (125, 0), " in lines[1] and abs(found["growth"] - 1.0055) < 5e-5, f"{found['growth']}")


def check_overrides():
    """The command line replaces what a scene says of the material in another way."""
    with open("scene.yaml", "w", encoding="utf-8") as file:
        file.write("dim: 2\nformulation: usl\ncells: 6\ndensity: 2\nyoung: 7.2\npoisson: 0.2\ncell_width: 0.25\nsteps: 5\n")
    for words, speed, poisson in (("", 2, 0.2), ("-young 28.8", 4, 0.2), ("-sound_speed 3", 3, 0.2),
                                  ("-bulk 8 -shear 0", 2, 0.5), ("-poisson 0", math.sqrt(3.6), 0)):
        _, found = run(f"run scene.yaml {words}")
        check(math.isclose(found["wave_speed"], speed, rel_tol=1e-15) and found["poisson"] == poisson, words)
    _, found = run("run scene.yaml -length 3")
    check(found["cell_width"] == 0.5, "length for cell_width")


def check_varied():
    """A map over the Courant number has no one time step."""
    lines, _ = run("map -sound_speed 3 -map_points 2,2 -map_drift 0,1/2")
    check("Courant number varied, drift varied cells per step, 1 rank" in lines[1], lines[1])
    check(lines[2] == "units of the scene: wave speed 3, cells 0.015625 wide; dt is 0.00520833 times the Courant number",
          lines[2])


for number in (1, 2, 3):
    check_same(number)
check_limits()
check_none()
check_pages()
check_overrides()
check_varied()
