#!/usr/bin/python3
"""Checks the job script of examples/slurm: bash and shellcheck read it, and it runs with an srun that stands for Slurm's.

check_slurm.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well. Without shellcheck all else is
checked.
"""
import os
import re
import shutil
import sys

from checks import ROOT, check, forks, loaded, text_of

MPIEXEC, MPMSTAB = sys.argv[1:]
FOLDER = os.path.join(ROOT, "examples", "slurm")
JOB = os.path.join(FOLDER, "job.sh")
SRUN = f'#!/bin/sh\nwhile case $1 in --*) true ;; *) false ;; esac; do shift; done\nexec {MPIEXEC} -q -n 2 "$@"\n'


def run(*command, **environment):
    path = os.pathsep.join((os.getcwd(), os.environ["PATH"]))
    return forks.run(command, capture_output=True, text=True, check=False, timeout=100,
                     env={**os.environ, "PATH": path, "MPMSTAB": MPMSTAB, **environment})


for reader in ([["bash", "-n"]] + ([["shellcheck"]] if shutil.which("shellcheck") else [])):
    done = run(*reader, JOB)
    check(done.returncode == 0, f"{' '.join(reader)}: {done.stdout}{done.stderr}")
asked = re.findall(r"^#SBATCH (--[\w-]+)", text_of(JOB), re.M) + re.findall(r"(--[\w-]+)=?\S* ", text_of(JOB).split("srun ")[1])
for option in re.findall(r"`(--[\w-]+)", text_of(os.path.join(FOLDER, "README.md"))):
    check(option in asked, f"README.md explains {option}, which job.sh does not give")

with open("srun", "w", encoding="ascii") as file:
    file.write(SRUN)
os.chmod("srun", 0o755)
with open("bar.yaml", "w", encoding="ascii") as file:
    file.write("formulation: usl\ncells: 16\nsteps: 40\n")
for left in ("bar-7.h5", "bar-7.json", "bar-7.csv"):
    if os.path.exists(left):
        os.remove(left)
done = run(JOB, SLURM_JOB_ID="7")
check(done.returncode == 2 and "allowed: sbatch job.sh SCENE.yaml" in done.stderr, f"without a scene: {done}")
done = run(JOB, "bar.yaml", "-courant", "0.3", SLURM_JOB_ID="7", EVERY="20")
check(done.returncode == 0 and "2 ranks" in done.stdout, f"the first run: {done}")
check("restarted_at_step" not in loaded("bar-7.json")["run"], "the first run resumes something")
check("MpmGridSum" in text_of("bar-7.csv"), "the log has no events")
done = run(JOB, "bar.yaml", "-courant", "0.3", "-steps", "60", SLURM_JOB_ID="7")
check(done.returncode == 0 and loaded("bar-7.json")["run"]["restarted_at_step"] == 40, f"the second run: {done}")
