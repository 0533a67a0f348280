#!/usr/bin/python3
"""The table of public codes: 'list codes'. Its options and names must be the program's, the limits those that its
commands print, and docs/limits.md must have it as printed.

MPMSTAB names the program. Silent when all is well.
"""
import math
import os
import re

from checks import ROOT, check, forks, text_of

MPMSTAB = os.environ["MPMSTAB"]
MLS_MPM = "-formulation usl -transfer apic -gradient mls -basis quadratic"


def printed(*words):
    done = forks.run([MPMSTAB, *words], capture_output=True, text=True, check=False, timeout=60)
    check(done.returncode == 0, f"{' '.join(words)}: status {done.returncode}: {done.stderr}")
    return done.stdout


def names_of(what):
    return {line.split()[0] for line in printed("list", what).splitlines()[1:]}


def read_table(text):
    """Returns the codes by name: a code has its own line, its rows (option, here, file) and the line of its limit."""
    codes = {}
    for line in text.splitlines():
        if not line.startswith(" "):
            continue  # the head of the list
        indent, words = len(line) - len(line.lstrip()), line.strip()
        if indent == 2:
            name, source = words.split(": ", 1)
            check(name not in codes, f"{name} comes twice")
            code = codes[name] = {"source": source, "rows": [], "defaults": [], "limit": None, "lines": 0}
        elif indent == 4 and words.startswith("limit "):
            code["limit"] = words
        elif indent == 4 and words == "only read, not run":
            pass
        elif indent == 4 and words.startswith("by default: "):
            code["defaults"].append(re.fullmatch(r"by default: (damping|viscosity|time step) +(\S.*) \((.+\.\w+)(:\d+)?\)", words).groups())
        elif indent == 4 and words.startswith("run here: "):
            check(os.path.exists(os.path.join(ROOT, words.split(": ")[1])), f"{name}: no page {words}")
        elif indent == 4:
            file = words
        else:
            check(indent == 6 and re.match(r"\S.{43} \S", words), f"not an option and what it is here: {line}")
            code["rows"].append((words[:44].rstrip(), words[45:], file))
        code["lines"] += 1
    return codes


def check_words(codes):
    """Every option of this program that the table names exists, and so does the scheme after it."""
    options = names_of("options")
    values = {f"-{option}": names_of(option) for option in ("formulation", "transfer", "basis", "boundary")}
    values["-gradient"] = {"basis", "mls"}
    values["-spline_ends"] = {"mirror", "modified", "open"}
    seen = set()
    for name, code in codes.items():
        for option, here, _ in code["rows"]:
            words = re.split(r"[ ;:,]+", here)
            for word, value in zip(words, words[1:] + [""]):
                if re.match(r"-[a-z]", word):
                    check(word[1:] in options, f"{name}, {option}: no option {word}")
                if word in values:
                    check(value in values[word], f"{name}, {option}: no {word[1:]} {value}")
                    seen.add(value)
            check(here.startswith(("-", "none", "not read")) or option.startswith(("alpha", "cfl_", "dt", "\"dt\"",
                  "\"critical", "default_dt", "dtime", "timestep", "TimeStep")), f"{name}, {option}: {here}")
    check({"usl", "usf", "musl", "usavg", "flip", "pic", "blend", "xpic", "apic", "mls", "linear", "gimp", "quadratic",
           "cubic"} <= seen, f"schemes that the table names: {sorted(seen)}")


def check_sources(codes):
    """Each code names its repository and commit, each row a file; a code fits a screen."""
    check(f"{len(codes)} public codes" in text_of(os.path.join(ROOT, "README.md")), f"README.md: not {len(codes)} codes")
    for name, code in codes.items():
        check(re.fullmatch(r"[\w.-]+/[\w.-]+, commit [0-9a-f]{7,10}( of 20\d\d-\d\d-\d\d)?", code["source"]),
              f"{name}: {code['source']}")
        check(code["rows"] and all(re.search(r"\.\w+$", file) for _, _, file in code["rows"]), f"{name}: files")
        files = [file for _, _, file in code["rows"]]
        once = [file for i, file in enumerate(files) if i == 0 or file != files[i - 1]]
        check(len(once) == len(set(once)), f"{name}: the rows of a file are apart")
        check(code["lines"] <= 27, f"{name}: {code['lines']} lines")
        kinds = [kind for kind, *_ in code["defaults"]]
        check(kinds == ["damping", "viscosity", "time step"], f"{name}: defaults {kinds}")
        for kind, said, file, line in code["defaults"]:  # what is not there has no line, and a variable that a text of another commit sets has a name
            check(line or said.startswith("none in the files") or re.search(r": \w+, at [0-9a-f]{7}$", said), f"{name}, {kind}: {said}, {file}")


def check_limits(codes):
    """The command beside a limit prints it. Each command runs once."""
    found = {}
    for name, code in codes.items():
        if code["limit"]:
            limit, command = re.fullmatch(r"limit of a lattice ([\d.]+): mpmstab (critical .*)", code["limit"]).groups()
            if command not in found:
                found[command] = printed(*command.split())
            check(f"critical Courant number: {limit}, for particles at rest" in found[command],
                  f"{name}: limit {limit}, but {command} prints\n{found[command]}")
    check(len(found) > 5, f"{len(found)} commands")


def check_page(page):
    """The page's table of what codes run: limits for 1, 2 and 4 particles a cell, and at drift 1/8."""
    table = re.findall(r"^\| [^`|]+: `([^`]+)` \| ([\d. /]+) \| ([\d.]+) \|", page, flags=re.MULTILINE)
    check(len(table) == 10, f"{len(table)} rows that codes run")
    for scheme, at_rest, drifting in table:
        for limit, *words in (*zip(at_rest.split(" / "), *zip(*(("-ppc", n) for n in "124"))),
                              (drifting, "-drift", "1/8")):
            found = float(re.search(r"(?:Courant number|tolerance): ([\d.]+)",
                                    printed("critical", *scheme.split(), *words)).group(1))
            digits = len(limit.split(".")[1])
            check(f"{found:.{digits}f}" == limit, f"{scheme} {' '.join(words)}: {limit}, but {found} is printed")


def check_steps(codes):
    """c dt / h of the examples, from Young's modulus, Poisson's ratio, density, dt and cells that their files have."""
    def solid(young, poisson, density):
        return math.sqrt(young * (1 - poisson) / (1 + poisson) / (1 - 2 * poisson) / density)

    for code, file, speed, dt, cells in (
            ("Taichi, examples", "mpm88.py", math.sqrt(400), 2e-4, 128),
            ("Taichi, examples", "mpm99.py", solid(0.3 * 1e3, 0.2, 1), 1e-4, 128),
            ("Taichi, examples", "mpm128.py", solid(0.3 * 5e3, 0.2, 1), 1e-4, 128),
            ("Taichi, examples", "mpm3d.py", math.sqrt(400), 4e-4, 32),
            ("taichi_elements", "mpm_solver.py", solid(0.3 * 1e6, 0.2, 1000), 2e-2, 1),
            ("taichi_mpm", "explained.cpp", solid(1e4, 0.2, 1), 1e-4, 80),
            ("mls-mpm.js", "mls-mpm.js", solid(1e4, 0.2, 1), 1e-4, 80),
            ("DiffTaichi", "diffmpm.py", math.sqrt(30), 1e-3, 128),  # lambda = mu = 10, density 1
            ("DiffTaichi", "diffmpm3d.py", math.sqrt(30), 2e-3, 64)):
        says = [here for _, here, path in codes[code]["rows"] if path.endswith(file)]
        check(any(f"c dt / h = {speed * dt * cells:.3f}" in here for here in says), f"{code}, {file}: {says}")


def check_examples(codes):
    """What was wrong here before: a code's own words may name another scheme than they say."""
    for code, option, here in (("Taichi, examples", "mpm3d_ggui", MLS_MPM),
                               ("Karamelo", "scheme(usl), method(ulmpm, MLS, ...)",
                                "-formulation usl -transfer apic -gradient mls"),
                               ("NairnMPM", "MPMMethod 3 (USL)", "-formulation musl: it extrapolates again"),
                               ("CB-Geo", "\"mpm_scheme\": anything else, or none", "-formulation usf")):
        check((option, here) in [row[:2] for row in codes[code]["rows"]], f"{code}, {option}: not {here}")


def main():
    text = printed("list", "codes")
    page = text_of(os.path.join(ROOT, "docs/limits.md"))
    check(f"```\n{text}```\n" in page, "docs/limits.md does not have it as printed")
    codes = read_table(text)
    check_words(codes)
    check_sources(codes)
    check_limits(codes)
    check_page(page)
    check_steps(codes)
    check_examples(codes)


main()
