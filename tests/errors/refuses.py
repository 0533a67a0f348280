#!/usr/bin/python3
"""Checks that a program refuses bad input: it says its message once, on standard error, ends with status 2, without a
stack trace, and leaves nothing in its folder.

refuses.py MESSAGE COMMAND...
refuses.py --list FILE (--topic TOPIC | --name NAME) COMMAND...

FILE has one refusal a line: topic, name, message and the words that follow COMMAND, with tabs between.
"""
import argparse
import os
import sys
import tempfile

sys.path.append(os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "support"))
import forks  # short commands, without loading the libraries of mpmstab for each


def fault(message, command):
    """Returns what is wrong with a refusal, or None."""
    with tempfile.TemporaryDirectory() as folder:
        done = forks.run(command, cwd=folder, capture_output=True, text=True, errors="replace", check=False,
                         timeout=60)
        left = os.listdir(folder)
    lines = done.stderr.splitlines()
    times = sum(f"mpmstab: {message}" in line for line in lines)
    if done.returncode != 2 or times != 1 or "PETSC ERROR" in done.stderr + done.stdout:
        return (f"status {done.returncode} (2 expected), message {times} times (1 expected) in {len(lines)} lines:\n"
                f"expected: mpmstab: {message}\n{done.stderr}{done.stdout}")
    return f"left behind: {' '.join(left)}" if left else None


def refusals(path, topic, name):
    """Returns the names, messages and words of a topic, or of one name."""
    with open(path, encoding="utf-8") as file:
        rows = [line.rstrip("\n").split("\t") for line in file]
    names = [row[1] for row in rows]
    for twice in {n for n in names if names.count(n) > 1}:
        sys.exit(f"refuses: {path}: two refusals have the name {twice}; allowed: one")
    wanted = [row[1:] for row in rows if topic in (None, row[0]) and name in (None, row[1])]
    return wanted or sys.exit(f"refuses: {path} has no refusal of topic {topic or '(any)'} and name {name or '(any)'}")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--list")
    parser.add_argument("--topic")
    parser.add_argument("--name")
    parser.add_argument("command", nargs=argparse.REMAINDER)
    arguments = parser.parse_args()
    if not arguments.list:
        wanted, command = [("", arguments.command[0])], arguments.command[1:]
    else:
        wanted, command = refusals(arguments.list, arguments.topic, arguments.name), arguments.command
    failed = False
    for name, message, *words in wanted:
        wrong = fault(message, [*command, *words])
        if wrong:
            print(f"{name}: {wrong}" if name else wrong)
            failed = True
    sys.exit(failed)


if __name__ == "__main__":
    main()
