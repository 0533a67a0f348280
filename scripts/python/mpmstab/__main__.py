"""python3 -m mpmstab audit ...: what this package does without the program."""
import sys

from . import audit

if sys.argv[1:2] != ["audit"]:
    sys.exit("python3 -m mpmstab: allowed: audit. The tasks of the program are functions: mpmstab.critical(...)")
sys.exit(audit.main(sys.argv[2:]))
