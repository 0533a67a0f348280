#!/usr/bin/python3
"""Checks that a program refuses bad input: it says its message once, on standard error, ends with status 2, without a
stack trace, and leaves nothing in its folder.

refuses.py MESSAGE COMMAND...
"""
import os
import subprocess
import sys
import tempfile

message, *command = sys.argv[1:]
with tempfile.TemporaryDirectory() as folder:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", check=False, timeout=60)
    left = os.listdir(folder)
times = sum(f"mpmstab: {message}" in line for line in done.stderr.splitlines())
if done.returncode != 2 or times != 1 or "PETSC ERROR" in done.stderr + done.stdout:
    sys.exit(f"status {done.returncode} (2 expected), message {times} times (1 expected):\nexpected: mpmstab: {message}\n"
             f"{done.stderr}{done.stdout}")
if left:
    sys.exit(f"left behind: {' '.join(left)}")
