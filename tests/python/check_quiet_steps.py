#!/usr/bin/python3
"""Growth of the steps of examples/quiet-steps, by the symbol, is that of an independent program (data/growth-quiet.csv), and
verlet with last 0 and 1 is usf and usl. The energy of mpm88.py, which has nothing of the program, rises a hundredfold with usl,
and with verlet and rk4 never above that of the start. The scenes of the folder 'grows' grow with verlet, and not at rest.

check_quiet_steps.py; MPMSTAB names the program. Silent when all is well.
"""
import csv
import glob
import json
import os
import sys

from checks import ROOT, check, forks

MPMSTAB = os.environ["MPMSTAB"]
FOLDER = os.path.join(ROOT, "examples", "quiet-steps")


def growth(*words):
    done = forks.run([MPMSTAB, "symbol", *words, "-json", "quiet.json"], capture_output=True, text=True, timeout=60)
    check(done.returncode == 0, f"{words}: {done.stderr}")
    with open("quiet.json", encoding="utf-8") as file:
        return json.load(file)["growth"]


def words_of(row):
    words = ["-scheme", os.path.join(FOLDER, f"{row['scheme']}.yaml"), "-cells", ",".join([row["cells"]] * int(row["dim"]))]
    for name in ("dim", "basis", "ppc", "offset", "transfer", "gradient", "drift", "courant", "share"):
        words += [f"-{name.replace('share', 'last')}", row[name]] if row[name] else []
    return words + (["-poisson", row["poisson"]] if row["dim"] != "1" else [])


def check_grows():
    """The worst scenes of scripts/quiet_search.py, and the one with the smallest drift, grow as they say."""
    scenes = sorted(glob.glob(os.path.join(FOLDER, "grows", "*.yaml")))
    check(len(scenes) == 11, f"{len(scenes)} scenes")
    for scene in scenes:
        for words, status in ((), 0), (("-drift", "0"), 3):
            done = forks.run([MPMSTAB, "spectrum", scene, "-measure", "false", *words], capture_output=True, text=True, timeout=60)
            check(done.returncode == status, f"{scene} {words}: status {done.returncode}: {done.stderr}")


def check_mpm88():
    sys.dont_write_bytecode = True
    sys.path.append(FOLDER)
    import mpm88
    energy = {step: mpm88.run(step, cells=8, courant=0.9, mach=0.2, time=250)[1] for step in mpm88.STEPS}
    check(energy["usl"][-1] > 100, f"mpm88.py: energy with usl ends at {energy['usl'][-1]}")
    check(max(energy["verlet"]) <= 1, f"mpm88.py: energy with verlet comes to {max(energy['verlet'])}")
    rise = max(after - before for before, after in zip(energy["rk4"], energy["rk4"][1:]))
    check(rise <= 0, f"mpm88.py: a step of rk4 raises the energy by {rise} of that of the start")


def main():
    with open(os.path.join(ROOT, "tests", "data", "growth-quiet.csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    check(len(rows) == 40, f"{len(rows)} rows")
    for row in rows:
        found = growth(*words_of(row))
        check(abs(found - float(row["growth"])) <= 1e-9 * found, f"{row}: growth {found}")
    check_grows()
    check_mpm88()
    verlet = os.path.join(FOLDER, "verlet.yaml")
    for share, same in (("0", "usf"), ("1", "usl")):
        for words in ("-drift 1/8 -courant 0.9", "-transfer apic -basis quadratic -drift 1/5 -courant 1.5"):
            one, other = growth("-scheme", verlet, "-last", share, *words.split()), growth("-formulation", same, *words.split())
            check(abs(one - other) <= 1e-13 * other, f"verlet -last {share} {words}: {one}, {same}: {other}")
    with open(os.path.join(FOLDER, "rk4.yaml"), encoding="utf-8") as file:
        text = file.read()
    signed = text.replace("p = v + 1/4 G2P a_i", "p = v + -3/4 G2P a_i + G2P a_i")
    check(signed != text, "rk4.yaml has no such line")
    with open("signed.yaml", "w", encoding="utf-8") as file:
        file.write(signed)
    found = [growth(*words, "-courant", "2.5", "-drift", "1/8") for words in
             (("-scheme", "signed.yaml"), ("-scheme", os.path.join(FOLDER, "rk4.yaml")), ("-formulation", "rk"))]
    check(max(found) - min(found) <= 1e-12, f"a factor with a sign of its own, rk4 as text, and rk: {found}")


if __name__ == "__main__":
    main()
