#!/usr/bin/python3
"""Follows the README of examples/library: installs into a new prefix, compiles its program there, and runs it.

library.py README.md BUILD PREFIX: BUILD is a build folder of this project. PREFIX is emptied first, and stays for the
tests that need an installed tree. What the program prints, on one rank and on two, must be what the README says and
what the installed program mpmstab finds; bad input must end it with status 2 and one line.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys


def fail(message):
    sys.exit(f"library.py: {message}")


def blocks_of(page):
    """The code blocks of a page: the word after the opening fence, and the text."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", page, re.M | re.S)


def run(command, where, environment, status=0):
    done = subprocess.run(command, cwd=where, env=environment, capture_output=True, text=True)
    if done.returncode != status:
        fail(f"{command}: exit status {done.returncode} instead of {status}\n{done.stdout}{done.stderr}")
    return done


def check_package(prefix, environment):
    """mpmstab.pc must not choose a processor, and must know the version that the program knows."""
    said = {what: run(["pkg-config", f"--{what}", "mpmstab"], prefix, environment).stdout.strip()
            for what in ("cflags", "libs", "modversion")}
    if "-march" in said["cflags"] + said["libs"]:
        fail(f"mpmstab.pc has a flag that chooses a processor: {said}")
    printed = run([str(prefix / "bin" / "mpmstab"), "list", "versions"], prefix, environment).stdout
    version = re.search(r"^ *mpmstab +([\d.]+)$", printed, re.M)[1]
    if version != said["modversion"]:
        fail(f"mpmstab.pc says version {said['modversion']}, the program {version}")


def check_find_package(prefix, environment):
    """A CMake project finds the installed library, and does not where it asks for a later version."""
    project = prefix / "project"
    project.mkdir()
    for version, status in (("0.999", 1), ("0.2", 0)):
        (project / "CMakeLists.txt").write_text(f"""cmake_minimum_required(VERSION 3.22)
project(limit LANGUAGES C)
find_package(mpmstab {version} REQUIRED)
add_executable(limit {prefix}/share/mpmstab/examples/library/main.c)
target_link_libraries(limit PRIVATE mpmstab::mpmstab)
""", encoding="utf-8")
        run(["cmake", "-S", ".", "-B", f"build-{version}", f"-DCMAKE_PREFIX_PATH={prefix}"], project, environment, status)
    environment = {name: value for name, value in environment.items() if name != "PKG_CONFIG_PATH"}
    run(["cmake", "--build", "build-0.2"], project, environment)
    printed = run(["build-0.2/limit"], project, environment).stdout
    if printed != "critical Courant number 0.755929\n":
        fail(f"the program that CMake built prints {printed!r}")


def main():
    readme, build, prefix = (pathlib.Path(word).resolve() for word in sys.argv[1:])
    shutil.rmtree(prefix, ignore_errors=True)
    prefix.mkdir(parents=True)
    (prefix / "build").symlink_to(build)
    (_, commands), (_, expected), (_, scheme), (_, of_scheme) = blocks_of(readme.read_text(encoding="utf-8"))
    first, rest = commands.split("\n", 1)
    if not first.startswith("PREFIX="):
        fail(f"{readme}: the first command no longer sets PREFIX: {first}")
    environment = os.environ | {"PREFIX": str(prefix)}
    printed = run(["sh", "-e", "-c", rest], prefix, environment).stdout.splitlines()
    printed = [line for line in printed if not line.startswith("-- ")]  # what 'cmake --install' says
    if printed != 2 * expected.splitlines():
        fail(f"{readme} says that each run prints {expected!r}; they printed {printed}")

    environment["PKG_CONFIG_PATH"] = f"{prefix}/lib/pkgconfig:{os.environ.get('PKG_CONFIG_PATH', '')}"
    printed_of_scheme = run(["sh", "-e", "-c", scheme], prefix, environment).stdout.splitlines()
    if printed_of_scheme != 2 * of_scheme.splitlines():
        fail(f"{readme} says that each run of the second program prints {of_scheme!r}; they printed {printed_of_scheme}")
    check_package(prefix, environment)
    check_find_package(prefix, environment)
    run(["bin/mpmstab", "critical", "-formulation", "usl", "-json", "limit.json"], prefix, environment)
    limit = json.loads((prefix / "limit.json").read_text(encoding="utf-8"))["critical"]["critical_courant"]
    if f"critical Courant number {limit:.6g}" != printed[0] or abs(limit / (4 / 7) ** 0.5 - 1) > 2e-6:
        fail(f"mpmstab finds {limit}, the program printed {printed[0]!r}; the closed form is sqrt(4/7)")
    (prefix / "bad.yaml").write_text("ppc: 0\n", encoding="utf-8")
    for launch in ([], ["mpirun", "-q", "-n", "2"]):
        said = run([*launch, "./limit", "bad.yaml"], prefix, environment, status=2).stderr.splitlines()
        if len(said) != 1 or "bad.yaml:1: ppc" not in said[0]:
            fail(f"a refusal is one line that names file and key: {said}")


if __name__ == "__main__":
    main()
