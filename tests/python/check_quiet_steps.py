#!/usr/bin/python3
"""Growth of the steps of examples/quiet-steps, by the symbol, is that of an independent program (data/growth-quiet.csv), and
verlet with share 0 and 1 is usf and usl.

check_quiet_steps.py; MPMSTAB names the program. Silent when all is well.
"""
import csv
import json
import os
import subprocess

from checks import ROOT, check

MPMSTAB = os.environ["MPMSTAB"]
FOLDER = os.path.join(ROOT, "examples", "quiet-steps")


def growth(*words):
    done = subprocess.run([MPMSTAB, "symbol", *words, "-json", "quiet.json"], capture_output=True, text=True, timeout=60)
    check(done.returncode == 0, f"{words}: {done.stderr}")
    with open("quiet.json", encoding="utf-8") as file:
        return json.load(file)["growth"]


def words_of(row):
    words = ["-scheme", os.path.join(FOLDER, f"{row['scheme']}.yaml"), "-cells", ",".join([row["cells"]] * int(row["dim"]))]
    for name in ("dim", "basis", "ppc", "offset", "transfer", "gradient", "drift", "courant", "share"):
        words += [f"-{name}", row[name]] if row[name] else []
    return words + (["-poisson", row["poisson"]] if row["dim"] != "1" else [])


def main():
    with open(os.path.join(ROOT, "tests", "data", "growth-quiet.csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    check(len(rows) == 40, f"{len(rows)} rows")
    for row in rows:
        found = growth(*words_of(row))
        check(abs(found - float(row["growth"])) <= 1e-9 * found, f"{row}: growth {found}")
    verlet = os.path.join(FOLDER, "verlet.yaml")
    for share, same in (("0", "usf"), ("1", "usl")):
        for words in ("-drift 1/8 -courant 0.9", "-transfer apic -basis quadratic -drift 1/5 -courant 1.5"):
            one, other = growth("-scheme", verlet, "-share", share, *words.split()), growth("-formulation", same, *words.split())
            check(abs(one - other) <= 1e-13 * other, f"verlet -share {share} {words}: {one}, {same}: {other}")


if __name__ == "__main__":
    main()
