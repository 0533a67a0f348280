#!/usr/bin/python3
"""Files of nonlinear runs: restarts, other ranks, and runs that end because a particle fails.

check_finite.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import csv
import json
import os
import sys
import tempfile

import h5py
import numpy as np

from checks import check, forks, on_ranks

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../scripts/python"))
from mpmstab import dt  # noqa: E402

MPMSTAB = sys.argv[-1]
WAVES = ("-kinematics finite -formulation musl -material neo -stretch 1.3 -basis quadratic -courant 0.5 -cells 12 "
         "-initial random -amplitude 0.01 -mach 0.7 -steps 60").split()
# beyond the largest stable time step
BREAKS = ("-kinematics finite -formulation usl -material neo -basis quadratic -courant 1.5 -cells 12 "
          "-initial random -amplitude 0.05 -steps 300").split()


def run(ranks, *words):
    return on_ranks(ranks, MPMSTAB, "run", *words)


def done(ranks, *words):
    process = run(ranks, *words)
    check(process.returncode == 0, f"{' '.join(words)}: status {process.returncode}: {process.stderr}")
    return process.stdout


def arrays(path, only=""):
    """The arrays of a file by their names, those of a checkpoint's state or of an output's last step."""
    found = {}
    with h5py.File(path) as file:
        step = max((key for key in file if key.startswith("step_")), default=None)
        (file[step + "/particles"] if step else file).visititems(
            lambda name, item: found.update({name: item[...]}) if hasattr(item, "shape") else None)
    return {name: values for name, values in found.items() if only in name}


def check_restart(ranks, dim):
    """A run that ends and resumes has the state of one that does not end, to the last bit on as many ranks."""
    scene = [*WAVES, "-dim", str(dim)]
    done(ranks, *scene, "-checkpoint", "whole.h5", "-output", "whole_fields.h5")
    shorter = [word if word != "60" else "33" for word in scene]
    done(ranks, *shorter, "-checkpoint", "part.h5")
    done(ranks, *scene, "-restart", "part.h5", "-checkpoint", "resumed.h5")
    whole, resumed = arrays("whole.h5"), arrays("resumed.h5")
    for name, values in whole.items():
        if not name.startswith(("series", "csv")):
            check(np.array_equal(values, resumed[name]), f"{ranks} ranks, dim {dim}: {name} is another after a restart")
    done(3, *scene, "-restart", "part.h5", "-output", "other_fields.h5")
    whole, other = arrays("whole_fields.h5"), arrays("other_fields.h5")
    for name, values in whole.items():
        apart = np.abs(values - other[name])
        check(np.minimum(apart, np.abs(apart - 1)).max() < 1e-11,
              f"{ranks} ranks, dim {dim}: {name} is off by {apart.max():.2e} on three")


def check_failure(ranks, dim):
    """The message names the particle, and the checkpoint is of the step before. From there the run fails at once."""
    scene = [*BREAKS, "-dim", str(dim), "-json", "none.json"]
    for every in ("7", "1000"):
        process = run(ranks, *scene, "-checkpoint", "last.h5", "-checkpoint_every", every)
        said = process.stderr.strip()
        check(process.returncode == 1 and len(said.splitlines()) == 1,
              f"{ranks} ranks, dim {dim}: status {process.returncode}: {said}")
        for word in (": particle ", " at x = ", " with the stretch F = ", "; the checkpoint has the state of step "):
            check(word in said, f"no '{word}' in: {said}")
        check(not os.path.exists("none.json"), "a run that fails has no result")
        step = int(said.split("step ")[1].split(":")[0])
        with h5py.File("last.h5") as file:
            check(file["where"][0] == step - 1, f"the checkpoint is of step {file['where'][0]}, not {step - 1}")
        last = forks.run([MPMSTAB, "spectrum", *(word for word in BREAKS if word not in ("-steps", "300")), "-dim", str(dim), "-at_step",
                          str(step - 1)], capture_output=True, text=True, check=False)
        check(last.returncode == 0 and "the run ends in this step" in last.stdout and "nan" not in last.stdout,
              f"the tangent of the step in which a particle fails: {last.stdout}")
        again = run(ranks, *scene, "-restart", "last.h5")
        check(again.returncode == 1 and again.stderr.strip() == said.split("; the checkpoint")[0],
              f"from the last whole state: {again.stderr}")


PACED = ("-kinematics finite -formulation usl -material neo -basis quadratic -courant auto -cells 16 -initial mode "
         "-amplitude 0.6").split()
LEVEL = 2 ** (1 / 16)  # steps are rounded down to such a power


def result(ranks, *words):
    done(ranks, *words, "-json", "result.json")
    with open("result.json", encoding="utf-8") as file:
        return json.load(file)


def limit_of(*words):
    process = forks.run([MPMSTAB, "critical", *words, "-json", "critical.json"], capture_output=True, text=True, check=False)
    check(process.returncode == 0, process.stderr)
    with open("critical.json", encoding="utf-8") as file:
        return json.load(file)["critical"]["critical_courant"]


def check_chosen_steps():
    """Each step is a part of a bound of the layout of now with the moduli of now, which the Python package finds, too."""
    for bound in ("lone", "particle", "lanczos"):
        run_of = result(1, *PACED, "-time", "0.5", "-csv", "paced.csv", "-output", "paced.h5", "-output_every", "1", "-step_bound", bound)
        auto = run_of["run"]["courant_auto"]
        check("courant" not in run_of and "drift" not in run_of, "numbers that differ from step to step")
        check(auto["safety"] == 0.8 and (bound != "particle" or auto["limited_by"] == bound), f"{bound}: {auto}")
        check(abs(run_of["run"]["time"] - 0.5) < 1e-14 and auto["changes"] > 3 and auto["dt_least"] < 0.9 * auto["dt_largest"],
              f"{run_of['run']}")
        check(auto["dt_least"] < auto["dt_mean"] < auto["dt_largest"], f"{auto}")
        smallest = []
        with open("paced.csv", encoding="utf-8") as file, h5py.File("paced.h5") as fields:
            rows, groups = list(csv.DictReader(file)), sorted(key for key in fields if key.startswith("step_"))
            check(len(rows) == len(groups) == run_of["run"]["steps"] + 1, f"{len(rows)} rows, {len(groups)} steps")
            for row, before, group in zip(rows[1:-2], groups, groups[1:]):  # the last two fill what is left
                at = fields[before]["particles"]
                moduli = (at["f"][...] ** 2 + 1) / 2
                took = fields[group].attrs["time"] - fields[before].attrs["time"]
                check(abs(float(row["fastest_wave"]) / np.sqrt(moduli.max()) - 1) < 1e-12 and abs(float(row["dt"]) / took - 1) < 1e-9, f"{row}")
                found = dt.step(at["coordinates"][...][:, :1], 1 / 32, 1 / 32, h=1 / 16, lame=moduli, mu=0, scheme="usl", basis="quadratic",
                                nodes=16, origin=0, periodic=True, bound=bound, products=60)
                smallest.append((round(took, 12), found.particle, 16 * found.dt))
                if bound == "lanczos":  # not above the exact one, and not far below it
                    most = np.sqrt(2 / found.omega2_least)
                    check(0.75 * most * 0.8 <= took <= most * 0.8 * (1 + 1e-5), f"{row}: dt {took}, {most}")
                    continue
                most = 0.8 * found.dt
                check(most / LEVEL * (1 - 1e-5) <= took <= most * (1 + 1e-5), f"{bound}: {row}: dt {took}, at most {most}")
        if bound != "lanczos":
            took, particle, number = smallest[auto["decided"]["step"] - 1]
            check(auto["decided"]["id"] in (particle, 31 - particle), f"{auto['decided']}, {smallest}")  # the bar is symmetric
            check(took == min(smallest)[0] and abs(auto["decided"]["number"] / number - 1) < 1e-9, f"{auto['decided']}, {smallest}")


def check_without_bound():
    """Of xpic no bound is known: K is that of particles at rest, or of one that is alone where some may come to be alone."""
    scheme = "-formulation usl -transfer xpic -basis quadratic".split()
    known = limit_of(*scheme)
    auto = result(1, "-kinematics", "finite", *scheme, "-material", "neo", "-cells", "8", "-courant", "auto", "-initial", "uniform",
                  "-steps", "2")["run"]["courant_auto"]
    check(auto["limited_by"] == "bulk" and abs(auto["limit"] - known) < 2e-6 and "no bound is known" in auto["no_bound"],
          f"{auto}, in the bulk {known}")


# a block of 36 particles that moves over the grid: a particle that is alone comes to a node
MOVING = ("-kinematics finite -formulation usl -material neo -basis linear -dim 2 -lame_ratio 1 -cells 10 -fill 3,6 -ppc 2 "
          "-jitter 0.8 -initial random -amplitude 1e-6 -velocity 0.1 -steps 60").split()


def check_lives():
    """With the whole bound noise does not grow; at 1.1 of the exact limit the run fails, and so it does with the first certificate."""
    for basis in ("quadratic", "linear"):
        layout = f"-formulation usl -basis {basis} -dim 2 -cells 6 -ppc 2 -jitter 0.9".split()
        rests = [*layout, *"-kinematics finite -material neo -lame_ratio 1 -initial random -amplitude 1e-9 -steps 300".split()]
        exact = limit_of(*layout, "-poisson", "0.25")
        fails = run(1, *rests, "-courant", repr(1.1 * exact))
        check(fails.returncode == 1, f"{basis}: 1.1 of {exact}: {fails.stdout}")
        lives = result(1, *rests, "-courant", "auto", "-safety", "1")
        check(lives["verdict"] == "stable" and lives["run"]["courant_auto"]["certificates"] == 1, f"{basis}: {lives}")
        check(0.8 * exact < lives["run"]["courant_auto"]["limit"] <= exact, f"{basis}: {lives['run']['courant_auto']}, {exact}")
    moves = [result(ranks, *MOVING, "-courant", "auto", "-safety", "1")["run"] for ranks in (1, 3)]
    for auto in (one["courant_auto"] for one in moves):
        check(auto["certificates"] > 1 and auto["dt_least"] < 0.5 * auto["dt_largest"], f"{auto}")
        for name, number in auto.items():
            check(number == moves[0]["courant_auto"][name] or name == "decided", f"{name} on other ranks: {auto}")
        check(auto["decided"]["id"] == moves[0]["courant_auto"]["decided"]["id"], f"on other ranks: {auto}")
    check(abs(moves[0]["energy"]["final"] / moves[0]["energy"]["initial"] - 1) < 1e-6, f"{moves[0]['energy']}")
    fails = run(1, *MOVING, "-courant", repr(moves[0]["courant_auto"]["first_limit"]))
    check(fails.returncode == 1, f"with the first certificate alone: {fails.stdout}")


def check_none_chosen():
    """A run that ends in one step has chosen none by waves or motion: there is no least and no largest of such steps."""
    auto = result(1, *PACED, "-time", "0.001")["run"]["courant_auto"]
    check(auto["steps"] == {"waves": 0, "motion": 0, "end": 1} and "dt_least" not in auto and "dt_largest" not in auto, f"{auto}")
    said = done(1, *PACED, "-time", "0.001")
    check("\ndt: every step is what is left to the end\n" in said, said)


def check_alike():
    """Waves in an isothermal gas have one speed. So the steps that are chosen are those of a Courant number."""
    scene = ("-kinematics finite -formulation usl -basis quadratic -material gas -cells 12 -initial mode -amplitude 1e-3 "
             "-steps 40").split()
    auto = result(1, *scene, "-courant", "auto", "-output", "auto.h5")["run"]["courant_auto"]
    done(1, *scene, "-courant", repr(auto["first_limit"] * 0.8), "-output", "number.h5")
    check(auto["changes"] == 0, f"{auto}")
    one, other = arrays("auto.h5"), arrays("number.h5")
    for name, values in one.items():
        check(np.abs(values - other[name]).max() < 1e-12, f"{name} differs by {np.abs(values - other[name]).max()}")


def check_chosen_restart(ranks, dim):
    """A run that resumes chooses the same steps, and ends at the same time with the same bits."""
    scene = [*PACED, "-dim", str(dim), "-mach", "0.4"]
    done(ranks, *scene, "-time", "0.4", "-checkpoint", "whole.h5", "-output", "whole_fields.h5")
    done(ranks, *scene, "-steps", "4", "-checkpoint", "part.h5")
    done(ranks, *scene, "-time", "0.4", "-restart", "part.h5", "-checkpoint", "resumed.h5")
    whole, resumed = arrays("whole.h5"), arrays("resumed.h5")
    for name, values in whole.items():
        if not name.startswith(("series", "csv")):
            check(np.array_equal(values, resumed[name]), f"{ranks} ranks, dim {dim}: {name} is another after a restart")
    done(3, *scene, "-time", "0.4", "-restart", "part.h5", "-output", "other_fields.h5")
    whole, other = arrays("whole_fields.h5"), arrays("other_fields.h5")
    for name, values in whole.items():
        apart = np.abs(values - other[name])
        check(np.minimum(apart, np.abs(apart - 1)).max() < 1e-11, f"dim {dim}: {name} is off by {apart.max():.2e} on three")
    said = done(ranks, *scene, "-time", "0.4", "-restart", "resumed.h5")
    check("nothing is left to march" in said, said)
    process = run(ranks, *scene, "-time", "0.1", "-restart", "resumed.h5")
    check(process.returncode == 2 and "is at time 0.4 of 0.1" in process.stderr, process.stderr)


def check_failure_beside_tangents():
    """The last whole state is marched once more, and says nothing of its tangents a second time, nor of where it begins."""
    scene = [*BREAKS, "-checkpoint", "last.h5"]
    process = run(1, *scene, "-tangent", "random", "-warn_above", "0.01")
    warnings = [line for line in process.stdout.splitlines() if line.startswith("warning at step")]
    check(process.returncode == 1 and warnings and len(set(warnings)) == len(warnings), f"tangent: {process.stdout}")
    again = run(1, *scene, "-restart", "last.h5")
    check(again.returncode == 1 and "nothing is left to march" not in again.stdout, f"from the last step: {again.stdout}")


WRITTEN = "-scheme scheme.yaml -kinematics finite -material neo -basis cubic -cells 8 -initial uniform -steps 3".split()


def write_scheme(fields, *more):
    """usl as text, with more lines before the last one."""
    lines = ["v_i = P2G v", "a_i = -k DIV s", "v_i += a_i", "v += G2P a_i", "s += k STRESS GRAD v_i", "MOVE v_i", *more, "DRIFT"]
    nodes = "v_i: vector, a_i: vector" + (", s_i: stress" if any("s_i" in line for line in more) else "")
    with open("scheme.yaml", "w", encoding="utf-8") as file:
        file.write(f"scheme:\n  name: own\n  particles: {{{fields}}}\n  nodes: {{{nodes}}}\n"
                   "  step:\n" + "".join(f"    - {line}\n" for line in lines))


def check_written():
    """Lines of a written scheme that have no meaning where F takes the place of the stress are refused."""
    for more, why in ((["s_i = P2G s", "s += G2P s_i"], "own has no stress that it takes to vectors by DIV and from vectors by GRAD alone"),
                      (["s = 0.5 s"], "own has no stress that it takes to vectors"),
                      (["MOVE v_i"] * 4, "scheme.yaml:2: scheme own: more than 4 lines MOVE")):
        write_scheme("v: vector, s: stress", *more)
        process = run(1, *WRITTEN)
        check(process.returncode == 2 and why in process.stderr and len(process.stderr.splitlines()) == 1,
              f"{more}: status {process.returncode}: {process.stderr}")


def check_order_of_fields():
    """The mode of the tangent is a velocity, in whatever order a written scheme has its fields."""
    growth = []
    for fields in ("v: vector, s: stress", "s: stress, v: vector"):
        write_scheme(fields)
        done(1, *WRITTEN, "-tangent", "mode", "-json", "own.json")
        with open("own.json", encoding="utf-8") as file:
            growth.append(json.load(file)["run"]["tangent"]["growth"][0])
    check(abs(growth[0] - growth[1]) < 1e-12, f"growth of the mode with v first and with s first: {growth}")


def check_refusals():
    for task, words, why in (("symbol", "-kinematics finite -formulation usl", "this task needs a linear step"),
                             ("critical", "-kinematics finite -formulation usl", "this task needs a linear step"),
                             ("run", "-kinematics finite -formulation gas2", "gas2 has no stress with a velocity that particles could move with"),
                             ("run", "-gravity 1 -formulation usl", "only with kinematics finite"),
                             ("run", "-kinematics finite -formulation usl -material two", "of one material"),
                             ("run", "-kinematics finite -formulation usl -prestress 0.5", "material and stretch give it"),
                             ("run", "-kinematics finite -formulation usl -transfer asflip", "a velocity of its own"),
                             ("run", "-kinematics finite -formulation usl -initial pulse", "mode, random, manufactured"),
                             ("run", "-kinematics finite -formulation usl -ringing", "are of the linear step"),
                             ("run", "-kinematics finite -formulation usl -material svk -stretch 0.5", "no stiffness"),
                             ("run", "-kinematics finite -formulation usl -dim 2 -poisson 0.5", "less than 0.5"),
                             ("run", "-kinematics finite -formulation usl -move projected", "no second P2G"),
                             ("run", "-formulation usl -courant auto", "kinematics finite alone"),
                             ("spectrum", "-kinematics finite -formulation usl -courant auto", "with this task: a number"),
                             ("run", "-kinematics finite -formulation usl -courant automatic", "greater than 0, or auto"),
                             ("run", "-kinematics finite -formulation usl -courant auto -drift 1/8", "velocity or mach"),
                             ("run", "-kinematics finite -formulation usl -courant auto -stagger", "steps differ"),
                             ("run", "-kinematics finite -formulation usl -safety 0.5", "only with courant auto"),
                             ("run", "-kinematics finite -formulation usl -courant auto -initial manufactured -amplitude 0.01",
                              "with time in the place of steps")):
        process = forks.run([MPMSTAB, task, *words.split()], capture_output=True, text=True, check=False)
        check(process.returncode == 2 and why in process.stderr and len(process.stderr.splitlines()) == 1,
              f"{task} {words}: status {process.returncode}: {process.stderr}")


def check_ratio():
    """What lambda / mu the material has is said, whether it is given or follows from Poisson's ratio."""
    scene = "-kinematics finite -formulation usl -material neo -dim 2 -cells 4 -initial uniform".split()
    for words, ratio, nu in (([], 1.5, 0.3), (["-poisson", "0.25"], 1, 0.25), (["-lame_ratio", "1"], 1, 0.25), (["-lame_ratio", "0"], 0, 0)):
        done(1, *scene, *words, "-steps", "1", "-json", "ratio.json")
        with open("ratio.json", encoding="utf-8") as file:
            found = json.load(file)
        check(abs(found["material"]["lame_ratio"] - ratio) < 1e-15 and abs(found["poisson"] - nu) < 1e-15, f"{words}: {found['material']}")
    process = run(1, *scene, "-lame_ratio", "1", "-poisson", "0.3", "-steps", "2")
    check(process.returncode == 2 and "-lame_ratio 1: poisson, or bulk and shear, say it too" in process.stderr, f"both: {process.stderr}")


def check_energy():
    """A uniform state has the same energy with whatever particles in its cells, and after a restart the same first one."""
    scene = "-kinematics finite -formulation usl -material neo -stretch 1.2 -drift 1/8 -cells 8 -initial uniform".split()
    energy = []
    for words in ("-ppc 2 -steps 4", "-counts 1,3 -steps 2 -checkpoint energy.h5", "-counts 1,3 -steps 4 -restart energy.h5"):
        done(1, *scene, *words.split(), "-json", "energy.json")
        with open("energy.json", encoding="utf-8") as file:
            energy.append(json.load(file)["run"]["energy"]["initial"])
    check(max(energy) - min(energy) < 1e-12 * max(energy) and energy[0] > 0, f"energies {energy}")


def check_columns():
    """A run that resumes without its tangents has other columns."""
    scene = "-kinematics finite -formulation usl -basis cubic -cells 8 -initial uniform -csv rows.csv".split()
    done(1, *scene, "-tangent", "random", "-steps", "3", "-checkpoint", "rows.h5")
    process = run(1, *scene, "-restart", "rows.h5", "-steps", "5")
    check(process.returncode == 2 and "weights, source_term, ringing and tangent as before" in process.stderr, f"columns: {process.stderr}")


def check_json():
    """What a nonlinear run says of itself; growth is that of noise alone. The body force of a solution is no gravity."""
    check("gravity" not in done(1, *"-kinematics finite -formulation usl -initial manufactured -amplitude 0.01 -steps 1".split()),
          "gravity without gravity")
    done(1, *WAVES, "-json", "noise.json")
    done(1, *[word if word != "random" else "mode" for word in WAVES], "-json", "wave.json", "-expect", "undecided")
    with open("noise.json", encoding="utf-8") as noise, open("wave.json", encoding="utf-8") as wave:
        noise, wave = json.load(noise), json.load(wave)
    check(noise["kinematics"] == "finite" and noise["material"]["kind"] == "neo", f"JSON: {noise}")
    check("growth_measured" not in wave["run"] and wave["run"]["energy"]["final"] > 0, f"JSON: {wave}")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    check_refusals()
    check_json()
    check_chosen_steps()
    check_without_bound()
    check_lives()
    check_none_chosen()
    check_alike()
    check_chosen_restart(1, 1)
    check_chosen_restart(2, 2)
    check_ratio()
    check_columns()
    check_energy()
    check_restart(1, 1)
    check_restart(2, 2)
    check_failure(1, 1)
    check_failure(2, 2)
    check_failure_beside_tangents()
    check_written()
    check_order_of_fields()
