"""Runs a rank and writes the largest resident size that it had, in kB, to FOLDER.

peak.py FOLDER PROGRAM ARGUMENT...
"""
import os
import resource
import subprocess
import sys

done = subprocess.run(sys.argv[2:], stdout=subprocess.DEVNULL, check=False)
with open(os.path.join(sys.argv[1], str(os.getpid())), "w", encoding="utf-8") as file:
    file.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
sys.exit(done.returncode)
