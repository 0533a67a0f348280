#!/usr/bin/python3
"""Growth of the steps of examples/quiet-steps, by the symbol, is that of an independent program (data/growth-quiet.csv), and
verlet with last 0 and 1 is usf and usl.

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
        words += [f"-{name.replace('share', 'last')}", row[name]] if row[name] else []
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
