"""Attacks by scenes: random options, extreme values, broken YAML, and answers that must not contradict one another."""
import glob
import os

from checks import ROOT
from oracle import DONE, MISSED, Beside, judge, require, result

FORMULATIONS = ("gas1", "gas2", "elastic", "usl", "usf", "musl", "usavg")
TRANSFERS = ("flip", "pic", "blend", "xpic", "nullspace", "apic")
BASES = ("linear", "gimp", "quadratic", "cubic")
ENDS = ("periodic", "fixed", "fixed_reaction", "free", "fixed,free", "free,fixed")
TASKS = ("run", "spectrum", "symbol", "critical", "map", "ensemble")

# What a user may mean; a task with these takes seconds.
PLAUSIBLE = {
    "formulation": FORMULATIONS, "basis": BASES, "transfer": TRANSFERS, "boundary": ENDS,
    "xpic_order": ("1", "2", "5"), "blend_ratio": ("0", "0.5", "1"), "cells": ("1", "2", "3", "5", "8", "16", "33"),
    "length": ("1", "0.1", "3"), "ppc": ("1", "2", "3", "7"), "counts": ("1", "1,4,0,2", "0,3"),
    "offset": ("0", "1/3", "0.5", "0.999"), "jitter": ("0", "0.1", "0.4", "1"), "cluster": ("0,1", "0.2,0.3", "1,1"),
    "seed": ("0", "1", "77"), "fill": ("0,3", "1,2.5"), "material": ("uniform", "two", "graded"),
    "density_ratio": ("1", "0.1", "1e6"), "stiffness_ratio": ("1", "100", "1e-6"), "inclusion": ("0,2", "1,1.5"),
    "wave_speed": ("1", "340"), "courant": ("0.1", "0.5", "1", "1.9", "3"), "dt": ("0.01", "0.002"),
    "drift": ("0", "1/8", "-1/3", "0.3", "1"), "velocity": ("0", "0.25", "-1"), "steps": ("1", "7", "100"),
    "initial": ("mode", "random", "pulse", "step"), "mode": ("1", "2", "8"), "amplitude": ("1", "1e-6"),
    "stagger": ("true", "false"), "weights": ("true", "false"), "source_term": ("true", "false"),
    "ringing": ("true", "false"), "tolerance": ("1e-6", "1e-3", "1e-9"), "phases": ("1", "16", "100"),
    "map_axes": ("courant,drift", "drift,offset", "ppc,courant"), "map_courant": ("0.1,2",), "map_drift": ("0,1/4",),
    "map_offset": ("0,1/4",), "map_ppc": ("1,3",), "map_points": ("2,3", "5,4"), "modes": ("0", "3"),
    "measure": ("true", "false"), "powers": ("1", "9"), "pseudospectrum": ("2", "5"), "survey": ("false",),
    "layouts": ("1", "3"), "output": ("o.h5",), "output_every": ("1", "10"), "checkpoint": ("c.h5",),
    "checkpoint_every": ("1", "10"), "json": ("r.json",), "csv": ("r.csv",), "expect": ("stable", "unstable"),
    "expect_kind": ("bounded",), "expect_growth": ("0.9,1.1",), "expect_spectrum": ("0.9,1.1",),
    "expect_critical": ("0,9",), "expect_share": ("0,1",), "expect_error": ("0,1",), "expect_energy": ("0,9",),
}
# What nobody means.
EXTREME = ("0", "-1", "-0", "1e-300", "1e300", "5e-324", "1.7976931348623157e308", "1e155", "nan", "inf", "-inf", "1e999",
           "0x10", "2147483647", "-2147483649", "9223372036854775808", "9007199254740993", "", " ", "x" * 300, "1/0",
           "0/1", "1/3", "-1/7", "1/9973", "1e-17", "0.9999999999999999", "1.0000000000000002", "true", "1,2", "2,1",
           "0,0", "1,", ",", "1,2,3", "-", "1e", "%s%n%d", "\x1b[31mred", "\u00e9", "1\n2", "~", "[1, 2]", "{}")
# Of these every other number is work for hours, which is no fault.
WORK = ("cells", "ppc", "counts", "steps", "time", "layouts", "phases", "powers", "pseudospectrum", "map_points",
        "map_ppc", "map_drift", "xpic_order", "modes", "survey")
NO_WORK = ("0", "-1", "-0", "", " ", "nan", "1e999", "99999999999999999999", "x", "1,", "1/0", "8.5", "-9223372036854775809")

# What most options want beside them, and those that say the same.
NEEDS = {"output_every": ("output", "o.h5"), "checkpoint_every": ("checkpoint", "c.h5"), "xpic_order": ("transfer", "xpic"),
         "blend_ratio": ("transfer", "blend"), "density_ratio": ("material", "graded"), "inclusion": ("material", "two"),
         "stiffness_ratio": ("material", "two"), "material": ("formulation", "usl"), "jitter": ("offset", "0.5")}
RIVALS = (("ppc", "counts"), ("courant", "dt"), ("drift", "velocity"), ("steps", "time"), ("counts", "fill"))
# Options of the libraries, some of which do not exist or cannot be.
LIBRARY = ("-eps_nev 3", "-eps_type lapack", "-eps_type nosuch", "-eps_max_it 1", "-eps_nonsense 1", "-eps_ncv -7",
           "-st_type shift", "-st_type sinvert", "-st_shift 0.5", "-st_ksp_type gmres", "-svd_type cross", "-svd_nsv 0",
           "-nodal_ksp_max_it 1", "-nodal_pc_type nosuch", "-ksp_type cg", "-dm_nonsense 1", "-mat_type nosuch",
           "-vec_type cuda", "-mat_view nosuch", "-sf_type nosuch", "-options_left no", "-options_file nowhere",
           "-malloc_debug", "-skip_petscrc", "-eps_view", "-eps_monitor", "-da_grid_x 7", "-vecscatter_view",
           "-ds_method 99", "-bv_type nosuch", "-fp_trap")


def words_of(options):
    return [word for name, value in options.items() for word in (f"-{name}", value)]


def random_options(dice, share):
    """Some options with plausible values, or, this share of them, with extreme ones."""
    options = {name: dice.choice(PLAUSIBLE[name])
               for name in dice.sample(sorted(PLAUSIBLE), dice.choice((1, 3, 5, 8)))}
    options.setdefault("cells", dice.choice(PLAUSIBLE["cells"]))
    if dice.random() < 0.8:
        for one, other in RIVALS:
            if one in options:
                options.pop(other, None)
        for name in sorted(options.keys() & NEEDS.keys()):
            options[NEEDS[name][0]] = NEEDS[name][1]
    for name in options:
        if dice.random() < share and name not in ("output", "checkpoint", "json", "csv"):
            options[name] = dice.choice(NO_WORK if name in WORK else EXTREME)
    return options


def lighten(dice, task, options):
    """Takes out what together takes minutes: limits under drift, and long periods of large operators."""
    if task == "critical" and (options.get("drift", "0") != "0" or options.get("velocity", "0") != "0"):
        options["cells"] = dice.choice(("1", "2", "3"))
        options.pop("courant", None)
    if task == "map":
        options.setdefault("map_points", "3,2")
    if task == "ensemble":
        options.setdefault("layouts", "2")
    if options.get("survey", "false") != "false":
        options.pop("survey")


def random_command(dice, share):
    """A task with random options, and the files that it may write."""
    task = dice.choice(TASKS)
    options = random_options(dice, share)
    lighten(dice, task, options)
    if dice.random() < 0.8:  # else most are refused because another task reads the option
        options = {name: value for name, value in options.items() if reads(task, name)}
    asked = [options[name] for name in ("output", "checkpoint", "json", "csv") if name in options]
    return task, options, [*asked, "o.xmf"]


READ_BY = {"run": ("steps", "time", "initial", "mode", "amplitude", "stagger", "weights", "source_term", "ringing",
                   "output_every", "checkpoint", "checkpoint_every", "expect_kind", "expect_growth", "expect_error",
                   "expect_energy"),
           "symbol": ("phases", "expect_spectrum"), "spectrum": ("modes", "measure", "powers", "pseudospectrum",
                                                                 "expect_spectrum"),
           "map": ("phases", "map_axes", "map_courant", "map_drift", "map_offset", "map_ppc", "map_points"),
           "critical": ("survey", "expect_critical"), "ensemble": ("layouts", "expect_share")}


def reads(task, name):
    if name == "output":
        return task not in ("critical", "ensemble")
    return name in READ_BY[task] or not any(name in names for names in READ_BY.values())


def attack_options(dice, program):
    task, options, asked = random_command(dice, dice.choice((0, 0.1, 0.4)))
    beside = Beside()
    words = [task, *words_of(options)]
    if dice.random() < 0.05:
        words.insert(dice.randrange(len(words) + 1), dice.choice(("-courant", "--help", "-", "word", "-eps_nonsense", "-0")))
    if len(words) > 1 and dice.random() < 0.05:
        del words[dice.randrange(1, len(words))]
    if dice.random() < 0.15:
        words += dice.choice(LIBRARY).split()
    elsewhere = ""
    if dice.random() < 0.15:
        elsewhere = dice.choice((*LIBRARY, " ".join(words_of(random_options(dice, 0)))))
    ranks = dice.choice((1, 1, 1, 1, 1, 1, 1, 2, 3))
    done = judge(program.run(words, ranks, env={**os.environ, "PETSC_OPTIONS": elsewhere}))
    asked += elsewhere.split()
    beside.check(done, asked)
    if "json" in options and done.status in (DONE, MISSED) and os.path.exists("r.json"):
        result("r.json")


# Pieces of YAML and of what is none.
PIECES = (b"[", b"{", b"&a ", b"*a", b"!!str ", b"\t", b"\x00", b"---\n", b"...\n", b"- ", b": ", b"? ", b"|\n", b">\n", b"'",
          b'"', b"#", b"%YAML 9.9\n", b"<<: *a\n", b"\xff", b"\xef\xbb\xbf", b"expect: stable\n",
          b"expect:\n  growth: [1, 2]\n", b"\r\n")


def yaml_of(options):
    return "".join(f"{name}: {value}\n" for name, value in options.items())


def broken(dice, text):
    """Text with some of its bytes, lines or words changed."""
    data = bytearray(text.encode())
    for _ in range(dice.choice((1, 1, 1, 2, 9))):
        at = dice.randrange(len(data) + 1)
        how = dice.randrange(6)
        if how == 0 and data:
            data[at % len(data)] ^= 1 << dice.randrange(8)
        elif how == 1:
            data[at:at] = dice.choice(PIECES)
        elif how == 2:
            del data[at:at + dice.choice((1, 5, 50))]
        elif how == 3:
            data[at:at] = data[:dice.choice((5, 50))]
        elif how == 4:
            data[at:at] = bytes(dice.randrange(256) for _ in range(dice.choice((1, 4, 40))))
        else:
            del data[at:]
    return bytes(data)


def attack_yaml(dice, program):
    if dice.random() < 0.3:
        with open(dice.choice(sorted(glob.glob(os.path.join(ROOT, "examples", "*", "scene.yaml")))),
                  encoding="utf-8") as file:
            text = file.read()
    else:
        text = yaml_of({**random_scene(dice), **dice.choice(({}, random_options(dice, dice.choice((0, 0.2)))))})
    with open("scene.yaml", "wb") as file:
        file.write(broken(dice, text))
    beside = Beside()
    # numbers that a broken line has made large would be work for hours
    task, light = dice.choice((("run", ["-steps", "5"]), ("spectrum", ["-measure", "false"]), ("symbol", ["-phases", "9"])))
    done = judge(program.run([task, "scene.yaml", *light, "-cells", "12", "-drift", "0"], dice.choice((1, 1, 1, 1, 2))))
    if done.status not in (DONE, MISSED):
        beside.check(done, [])


def same(a, b, tolerance):
    return abs(a - b) <= tolerance * max(1, abs(a), abs(b))


def random_scene(dice):
    """A periodic scene whose particles are the same in every cell, so that the symbol, the spectrum and a run see it."""
    options = {"formulation": dice.choice(FORMULATIONS), "basis": dice.choice(BASES),
               "cells": dice.choice(("8", "9", "12", "16")), "ppc": dice.choice(("1", "2", "3")),
               "offset": dice.choice(("0", "0.5", "0.3", "1/3")), "courant": f"{dice.uniform(0.05, 2.4):.4f}",
               "drift": dice.choice(("0", "0", "1/2", "1/3", "-1/4", "2/5", "1"))}
    options["transfer"] = dice.choice(TRANSFERS[:5] if options["formulation"] in FORMULATIONS[:3] else TRANSFERS)
    return options


def attack_answers(dice, program):
    """Symbol, spectrum, run and limit of one scene."""
    options = random_scene(dice)
    words = words_of(options)
    found = {}
    for task, more in (("symbol", []), ("spectrum", ["-measure", "false"]),
                       ("run", ["-initial", "random", "-steps", "3000"])):
        done = judge(program.run([task, *words, *more, "-json", f"{task}.json"], dice.choice((1, 1, 1, 2))))
        if done.status != DONE:
            return
        found[task] = result(f"{task}.json")
        found[task]["done"] = done
    compare(found)
    if options["drift"] == "0" or dice.random() < 0.1:
        options["cells"] = "4"  # the limit is over all phases
        done = judge(program.run(["critical", *words_of(options), "-json", "critical.json"]))
        if done.status == DONE:
            compare_limit(found["symbol"], result("critical.json"), done)


def compare(found):
    symbol, spectrum, run = (found[task] for task in ("symbol", "spectrum", "run"))
    both = f"\n  {symbol['done']}\n  {spectrum['done']}"
    verdicts = {symbol["verdict"], spectrum["verdict"]}
    require(verdicts != {"stable", "unstable"}, f"symbol and spectrum contradict each other:{both}")
    if "growth" in symbol and "growth" in spectrum and "undecided" not in verdicts:
        unsure = symbol.get("uncertainty", 0) + spectrum.get("uncertainty", 0)
        require(same(symbol["growth"], spectrum["growth"], 1e-5 + 10 * unsure), f"growth is not the same:{both}")
    growth = spectrum.get("growth")
    if "undecided" in (spectrum["verdict"], run["verdict"]) or growth is None:
        return
    both = f"\n  {spectrum['done']}\n  {run['done']}"
    require(not (run["verdict"] == "unstable" and spectrum["verdict"] == "stable"), f"the run grows:{both}")
    require(not (run["verdict"] == "stable" and growth > 1.02), f"the run does not grow:{both}")
    measured = run.get("growth")
    if run["verdict"] == "unstable" and measured and growth > 1.02:
        require(same(measured, growth, 0.01), f"the run grows by {measured}:{both}")


def compare_limit(symbol, critical, done):
    """The limit is over all phases, of which the grid has some."""
    limit, courant = critical["critical"].get("critical_courant"), symbol["courant"]
    if symbol["verdict"] == "unstable":
        require(critical["verdict"] != "stable", f"{symbol['done']}\n  {done}")
        if limit is not None:
            require(limit < courant * (1 + 1e-6), f"a limit {limit} above growth:\n  {symbol['done']}\n  {done}")
    if limit is not None and critical["verdict"] == "stable" and symbol["drift"] == 0 and limit:
        require(courant <= limit * 1.001 or critical["critical"].get("threshold") is False or
                critical["critical"].get("stable_at", 0) > limit, f"stable above the limit {limit}:\n  {done}")


ATTACKS = {"options": attack_options, "yaml": attack_yaml, "answers": attack_answers}
