#!/usr/bin/python3
"""Checks the first two commands of README.md, demo.sh and test.sh, as a newcomer runs them.

check_first_commands.py MPMSTAB, in a folder that may be filled. Silent when all is well.

The scripts run in a copy of the project. They find only the tools of the folder tools/, of which
some stand for others: cmake and ctest only say that they ran, apt-get writes a missing tool, and id says who one is.
"""
import fcntl
import glob
import os
import re
import shutil
import subprocess
import sys

from checks import ROOT, check, text_of

MPMSTAB = os.path.abspath(sys.argv[1])
COPY, TOOLS = os.path.abspath("copy"), os.path.abspath("tools")
# What the scripts call, and what they look for: on a system without apt-get, dpkg and sudo all is there.
CALLED = "sh sed cat true mkdir dirname basename ls grep tail getconf env flock id".split()
SOUGHT = ("cc make mpicc mpirun h5pcc git clang-format valgrind shellcheck chromium chromedriver c++ gfortran "
          "octave").split()
CMAKE = """#!/bin/sh
echo "$0 $*" >>called
case $1 in -S) exit ;; esac
echo '[ 10%] Building C object first'; echo '[ 11%] Building C object second'; echo '[ 50%] Building C object third'
"""
APT_GET = f"""#!/bin/sh
echo "apt-get $*" >>called
case "$*" in
*--assume-no*) echo 'Need to get 321 MB of archives.' && exit 1 ;;
*install*) [ ! -e refuse ] && printf '#!/bin/sh\\n' >'{TOOLS}/make' && /bin/chmod +x '{TOOLS}/make' ;;
esac
"""


def tool(name, text):
    path = os.path.join(TOOLS, name)
    if os.path.lexists(path):
        os.remove(path)
    if text:
        with open(path, "w", encoding="ascii") as file:
            file.write(text)
        os.chmod(path, 0o755)


def make():
    """Copies what the two commands need, and shares the program that is built."""
    for folder in (COPY, TOOLS):
        shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(os.path.join(ROOT, "scripts"), os.path.join(COPY, "scripts"))
    os.symlink(os.path.join(ROOT, "examples"), os.path.join(COPY, "examples"))
    os.makedirs(os.path.join(COPY, "build"))
    os.symlink(MPMSTAB, os.path.join(COPY, "build", "mpmstab"))
    os.makedirs(TOOLS)
    for name in CALLED:
        os.symlink(shutil.which(name), os.path.join(TOOLS, name))
    for name in SOUGHT:
        tool(name, "#!/bin/sh\n")
    tool("pkg-config", f'#!/bin/sh\nexec {shutil.which("pkg-config")} "$@"\n')
    tool("cmake", CMAKE)
    tool("ctest", '#!/bin/sh\necho "ctest $*"\n')
    tool("id", "#!/bin/sh\necho 1000\n")


def ran(name, *arguments, **environment):
    called = os.path.join(COPY, "called")
    if os.path.exists(called):
        os.remove(called)
    return subprocess.run([os.path.join(COPY, "scripts", name), *arguments], capture_output=True, text=True,
                          check=False, timeout=200, env={**os.environ, "PATH": TOOLS, **environment})


def called():
    path = os.path.join(COPY, "called")
    return text_of(path) if os.path.exists(path) else ""


def check_demo():
    """The demo answers what README.md quotes, and the tables are those of docs/slides.md."""
    first = ran("demo.sh")
    check(first.returncode == 0, f"demo.sh: {first}")
    readme, lines = text_of(os.path.join(ROOT, "README.md")), first.stdout.split("\n")
    block = re.search(r"\n\n((?:    .+\n)+)\n```\n((?:.+\n)+)```\n", readme)
    command = "$ " + " ".join(block.group(1).replace("\\\n", "").split())
    check(command in lines, f"demo.sh does not say that it runs README.md's '{command}'")
    quoted = [line for line in block.group(2).splitlines() if line != "..."]
    places = [lines.index(line) if line in lines else -1 for line in quoted]
    check(lines.index(command) < places[0] and -1 not in places and places == sorted(places),
          f"README.md quotes {quoted}, and demo.sh prints {lines}")
    check(len(lines) < 50 and "building, which takes" in lines[0] and lines[0].endswith(": 10% 50%"), f"{lines}")
    slides = text_of(os.path.join(COPY, "results", "slides.txt"))
    check(f"```\n{slides}```\n" in text_of(os.path.join(ROOT, "docs/slides.md")), f"docs/slides.md has other tables:\n{slides}")
    check(slides.split("\n\n", maxsplit=1)[0] in first.stdout, "the first table is not printed")
    named = re.findall(r"results/[\w-]+\.(?:png|txt)", first.stdout)
    check(len(named) == 5, f"{named} are the pictures and tables")
    for name in named:
        check(os.path.getsize(os.path.join(COPY, name)) > 500, f"there is no {name}")
    check(ran("demo.sh", "--help").returncode == 2 and not called(), "demo.sh --help does something")


def check_test():
    for given, passed in (((), " -LE nightly"), (("--all",), ""), (("-R", "unit_fraction"), " -R unit_fraction")):
        done = ran("test.sh", *given)
        check(done.returncode == 0 and done.stdout.endswith(f" --parallel 2{passed}\n"), f"test.sh {given}: {done}")


def check_refused(what, says, name="setup.sh", lines=1, **environment):
    done = ran(name, **environment)
    check(done.returncode == 1 and len(done.stderr.splitlines()) == lines, f"{what}: {done}")
    for words in says:
        check(words in done.stderr, f"{what}: not '{words}' in {done.stderr}")


def check_missing():
    """What is missing is named where one may not install it, and installed where one may."""
    tool("make", None)
    tool("octave", None)
    check_refused("no apt-get", ["Debian's names): make;", "INSTALL.md"])
    check_refused("no apt-get", ["Debian's names): make octave;"], "test.sh")
    tool("apt-get", APT_GET)
    asked = "run this: apt-get update && apt-get install --no-install-recommends make\n"
    check_refused("no sudo", [asked])
    check_refused("no sudo", [asked], "demo.sh")
    tool("sudo", "#!/bin/sh\nexit 1\n")
    check_refused("not a sudoer", [asked])
    check(not called(), f"without leave to: {called()}")
    tool("sudo", '#!/bin/sh\ncase $1 in -p) shift 2 ;; esac\nexec "$@"\n')
    tool("id", "#!/bin/sh\necho 0\n")
    with open(os.path.join(COPY, "refuse"), "w", encoding="ascii"):
        check_refused("apt-get fails", ["apt-get has not installed what is missing"])
    os.remove(os.path.join(COPY, "refuse"))
    for who in ("0", "1000"):
        tool("id", f"#!/bin/sh\necho {who}\n")
        tool("make", None)
        done = ran("setup.sh")
        check(done.returncode == 0 and "installing, which takes minutes: make\ndownload: 321 MB\n" in done.stdout,
              f"user {who}: {done}")
        check(re.search(r"apt-get .*update\n.*\n.*install make\n", called()), f"user {who}: {called()}")
    tool("cc", None)
    check_refused("apt-get does not help", ["still what they are for is missing or too old: gcc;"])
    tool("cc", "#!/bin/sh\n")


def check_own_petsc():
    """PETSc and SLEPc of PETSC_DIR are enough, and where they are not there, Debian's are not installed."""
    for name in ("apt-get", "sudo"):
        tool(name, None)
    real = shutil.which("pkg-config")
    tool("pkg-config", f'#!/bin/sh\ncase "$*" in *PETSc*|*SLEPc*) exit 1 ;; esac\nexec {real} "$@"\n')
    check_refused("no PETSc", ["Debian's names): petsc-dev slepc-dev;"])
    own = os.path.join(COPY, "petsc")
    check_refused("no PETSc there", [f"(PETSC_DIR '{own}', PETSC_ARCH 'arch',"], PETSC_DIR=own, PETSC_ARCH="arch")
    os.makedirs(os.path.join(own, "arch", "lib", "pkgconfig"))
    for name in ("PETSc", "SLEPc"):
        with open(os.path.join(own, "arch", "lib", "pkgconfig", f"{name}.pc"), "w", encoding="ascii"):
            pass
    done = ran("setup.sh", PETSC_DIR=own, PETSC_ARCH="arch")
    check(done.returncode == 0, f"with PETSC_DIR: {done}")
    tool("pkg-config", f'#!/bin/sh\nexec {real} "$@"\n')


def check_build_folder():
    """The build of another folder, one that fails, one that cannot be written, one in which a script is at work."""
    build = os.path.join(COPY, "build")
    cache = os.path.join(build, "CMakeCache.txt")
    for made_for, fits in (("/somewhere/else", False), (os.path.realpath(COPY), True)):
        with open(cache, "w", encoding="utf-8") as file:
            file.write(f"CMAKE_HOME_DIRECTORY:INTERNAL={made_for}\n")
        if fits:
            check(ran("setup.sh").returncode == 0, "with the cache of this folder")
        else:
            check_refused("another folder's build", [f"{build} was made for another folder, {made_for}; remove it"])
    for failing, says in (("-S", "CMake could not configure the build"), ("--build", "The build failed")):
        tool("cmake", f"#!/bin/sh\ncase $1 in {failing}) echo why && exit 1 ;; esac\n")
        check_refused(f"cmake {failing} fails", ["why\n", says, "build/setup.log", "INSTALL.md"],
                      lines=2 + (failing == "--build"))
    tool("cmake", CMAKE)
    with open(os.path.join(build, "setup.lock"), "a", encoding="ascii") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        with subprocess.Popen([os.path.join(COPY, "scripts", "setup.sh")], stdout=subprocess.PIPE, text=True,
                              env={**os.environ, "PATH": TOOLS}) as waiting:
            line = waiting.stdout.readline()
            check(line.startswith("waiting for another script, which installs"), f"beside another script: {line}")
            fcntl.flock(held, fcntl.LOCK_UN)
            waiting.stdout.read()
        check(waiting.returncode == 0, "after another script")
    spaced = COPY + " two"
    os.symlink(COPY, spaced)
    done = subprocess.run([os.path.join(spaced, "scripts", "setup.sh")], capture_output=True, text=True, check=False)
    check(done.returncode == 1 and done.stderr.endswith(f"move this one: {spaced}\n"), f"a space in the name: {done}")
    os.remove(spaced)
    shutil.rmtree(build)
    os.symlink("/proc/none", build)
    check_refused("a folder that cannot be written to", [f"{build} cannot be written to; copy the project"])


def check_shell():
    """All shell scripts are POSIX's, as far as shellcheck knows."""
    if shutil.which("shellcheck"):
        scripts = [*glob.glob(os.path.join(ROOT, "scripts", "*.sh")), os.path.join(ROOT, ".ci", "run")]
        done = subprocess.run(["shellcheck", "-x", *scripts], cwd=ROOT, capture_output=True, text=True, check=False)
        check(done.returncode == 0, done.stdout)


def main():
    make()
    for one in (check_demo, check_test, check_missing, check_own_petsc, check_build_folder, check_shell):
        one()


if __name__ == "__main__":
    main()
