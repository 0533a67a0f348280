#!/usr/bin/python3
"""Checks scripts/release.sh, the files of scripts/packaging and the paper, as far as the tools are here.

check_packaging.py tarball|debian|conda|spack|container|names|paper. Status 77, with the reason, where the tool for a part is missing. Silent when
all is well.
"""
import ast
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import types

from checks import ROOT, check, text_of

SKIPPED = 77
FILES = os.path.join(ROOT, "scripts", "packaging")
LIMIT = "critical Courant number 0.755929\n"  # of examples/library/main.c


def skip(reason):
    print(f"check_packaging: {reason}")
    sys.exit(SKIPPED)


def done(command, cwd, status=0, **how):
    """What a command says on both streams; it must end with this status."""
    process = subprocess.run(command, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **how)
    check(process.returncode == status, f"{command}: status {process.returncode}\n{process.stdout[-4000:]}")
    return process.stdout


def clone(folder):
    """A clone of the last commit of this repository; a tarball has none."""
    if not os.path.exists(os.path.join(ROOT, ".git")):
        skip("this is no clone of the repository, of which release.sh makes the tarball")
    done(["git", "clone", "-q", "--no-local", "--depth", "1", f"file://{ROOT}", "clone"], folder)
    return os.path.join(folder, "clone")


def release(sources, status=0):
    return done(["scripts/release.sh", "tarball", "../out"], sources, status)


def check_tarball(folder):
    """The tarball has each file of the repository, the same bytes each time, and what must not be in one is refused."""
    sources = clone(folder)
    done(["git", "tag", "ORIG"], sources)
    tarball = release(sources).strip()
    first = open(tarball, "rb").read()
    with tarfile.open(tarball) as opened:
        members = {member.name.split("/", 1)[1] for member in opened.getmembers() if not member.isdir()}
    tracked = set(done(["git", "ls-files", "-z"], sources).split("\0")) - {""}
    check(members == tracked, f"the tarball differs from the repository in {sorted(members ^ tracked)}")
    release(sources)
    check(open(tarball, "rb").read() == first, "the same commit gave another tarball")

    new = os.path.join(sources, "src", "forgotten.c")
    open(new, "w").close()
    check("src/forgotten.c" in release(sources, 1), "a file that is not committed was not noticed")
    os.remove(new)
    for name, old, other, says in (("CITATION.cff", "\nversion: ", "\nversion: 9", "CITATION.cff does not say"),
                                   ("INSTALL.md", "# Installing", "# Installing in /" + "home/someone", "INSTALL.md:1:")):
        path = os.path.join(sources, name)
        text = text_of(path)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace(old, other, 1))
        who = ["-c", "user.name=a", "-c", "user.email=a"]
        done(["git", *who, "commit", "-q", "-a", "-m", "a"], sources)
        check(says in release(sources, 1), f"{name} with '{other}' was released")
        done(["git", "reset", "-q", "--hard", "ORIG"], sources)


def check_debian(folder):
    """Builds the packages without optimisation, and uses them from a fresh prefix and, where that can be made, in a clean Debian."""
    for tool in ("dpkg-buildpackage", "dh"):
        if not shutil.which(tool):
            skip(f"there is no {tool}, with which Debian packages are built (packages dpkg-dev and debhelper)")
    sources = clone(folder)
    shutil.copytree(os.path.join(sources, "scripts", "packaging", "debian"), os.path.join(sources, "debian"))
    environment = {name: value for name, value in os.environ.items() if name not in ("PETSC_DIR", "SLEPC_DIR", "PETSC_ARCH")}
    environment["DEB_BUILD_OPTIONS"] = f"noopt nocheck parallel={os.cpu_count() or 1}"
    done(["dpkg-buildpackage", "-us", "-uc", "-b"], sources, env=environment)
    packages = [name for name in os.listdir(folder) if name.endswith(".deb") and "-dbgsym_" not in name]
    check(sorted(name.split("_")[0] for name in packages) == ["libmpmstab-dev", "libmpmstab0.2", "mpmstab"], packages)
    use_packages(folder, packages, environment)
    if shutil.which("lintian"):
        done(["lintian", "--allow-root", "--fail-on", "error,warning", *packages], folder)
    if shutil.which("mmdebstrap") and not os.geteuid():
        missing = use_in_clean_system(folder, packages)
        if missing:
            print(f"check_packaging: the packages were used from a fresh prefix, but not from a clean Debian: {missing}")


PROJECT = """cmake_minimum_required(VERSION 3.22)
project(limit LANGUAGES C)
find_package(mpmstab 0.2 REQUIRED)
add_executable(limit ${EXAMPLES}/library/main.c)
target_link_libraries(limit PRIVATE mpmstab::mpmstab)
"""


def use_packages(folder, packages, environment):
    """Unpacks the packages in a fresh prefix, and uses program, manual page, completions and library from there."""
    root = os.path.join(folder, "root")
    for name in packages:
        done(["dpkg-deb", "-x", name, root], folder)
    library = os.path.dirname(next(os.path.join(where, "mpmstab.pc") for where, _, names in os.walk(root) if "mpmstab.pc" in names))
    library = os.path.dirname(library)
    for name in ("usr/bin/mpmstab", "usr/share/man/man1/mpmstab.1.gz", "usr/share/bash-completion/completions/mpmstab",
                 "usr/share/zsh/vendor-completions/_mpmstab", "usr/include/mpmstab/mpmstab.h", "usr/include/mpmstab_dt.h",
                 os.path.join(library, "cmake", "mpmstab", "mpmstabConfig.cmake"), os.path.join(library, "libmpmstab.so")):
        check(os.path.exists(os.path.join(root, name)), f"no package has {name}")
    environment.update(LD_LIBRARY_PATH=library, PKG_CONFIG_PATH=os.path.join(library, "pkgconfig"))
    done([os.path.join(root, "usr/bin/mpmstab"), "critical", "-formulation", "usl", "-expect_critical", "0.75592,0.75594"], folder,
         env=environment)
    done(["sh", "-e", "-c", "cc root/usr/share/mpmstab/examples/library/main.c -o limit $(pkg-config --cflags --libs mpmstab)"],
         folder, env=environment)
    said = done(["./limit"], folder, env=environment)
    check(said == LIMIT, f"the program that was compiled with the packages prints {said}")
    loop = os.path.join(root, "usr/share/mpmstab/examples/step-in-your-loop/loop.c")
    done(["cc", "-std=c99", f"-I{root}/usr/include", loop, "-o", "loop", "-lm"], folder)  # mpmstab_dt.h, without the library
    done(["./loop"], folder)
    use_config(folder, root, environment)
    use_texts(folder, root, environment)


def use_config(folder, root, environment):
    """A project of CMake finds the library of the packages, and no other one."""
    project = os.path.join(folder, "project")
    os.mkdir(project)
    with open(os.path.join(project, "CMakeLists.txt"), "w", encoding="utf-8") as file:
        file.write(PROJECT)
    environment = {name: value for name, value in environment.items() if name != "PKG_CONFIG_PATH"}
    usr = os.path.join(root, "usr")
    done(["cmake", "-S", ".", "-B", "build", f"-DCMAKE_PREFIX_PATH={usr}", f"-DEXAMPLES={usr}/share/mpmstab/examples"], project,
         env=environment)
    done(["cmake", "--build", "build"], project, env=environment)
    check(f"mpmstab_DIR:PATH={usr}" in text_of(os.path.join(project, "build", "CMakeCache.txt")), "CMake found another mpmstab")
    said = done(["build/limit"], project, env=environment)
    check(said == LIMIT, f"the program that CMake built with the packages prints {said}")


def use_texts(folder, root, environment):
    """The manual page is one for man, and the completions of bash complete a task and an option."""
    page = os.path.join(root, "usr/share/man/man1/mpmstab.1.gz")
    if shutil.which("man"):
        said = done(["man", "--warnings", "-l", page], folder, env=environment | {"MANPAGER": "cat", "LC_ALL": "C.UTF-8"})
        check("-formulation" in said and not re.search(r":\d+:.*warning", said), f"man shows {said[:400]}")
    script = os.path.join(root, "usr/share/bash-completion/completions/mpmstab")
    for words, wanted in (("cr", "critical"), ("critical -neigh", "-neighbourhood")):
        last = len(words.split())
        said = done(["bash", "-c", f"source {script}; COMP_WORDS=(mpmstab {words}); COMP_CWORD={last}; _mpmstab; echo ${{COMPREPLY[@]}}"],
                    folder, env=environment)
        check(said.strip() == wanted, f"'mpmstab {words}' is completed to {said}")


def use_in_clean_system(folder, packages):
    """Installs the packages with apt in a Debian that has nothing else, and uses program and library there. Returns why it cannot."""
    root = os.path.join(folder, "clean")
    made = subprocess.run(["mmdebstrap", "--quiet", "--variant=apt", "bookworm", root], capture_output=True, text=True, check=False)
    if made.returncode:
        return f"none can be fetched here: {made.stderr[-200:]}"
    for name in packages:
        shutil.copy(os.path.join(folder, name), root)
    debs = " ".join(f"/{name}" for name in packages)
    script = f"""apt-get install -qq -y --no-install-recommends {debs} gcc libc6-dev pkgconf >/dev/null 2>&1
        mpmstab critical -formulation usl -expect_critical 0.75592,0.75594 >/dev/null
        cc /usr/share/mpmstab/examples/library/main.c -o limit $(pkg-config --cflags --libs mpmstab)
        ./limit 2>/dev/null"""
    allowed = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "DEBIAN_FRONTEND": "noninteractive"}
    allowed |= {name: value for name, value in os.environ.items() if name.lower().endswith("_proxy")}
    fetch = "apt-get update -qq && apt-get install -qq -y --download-only gcc"  # mmdebstrap leaves no lists of packages
    reached = subprocess.run(["chroot", root, "sh", "-c", fetch], env=allowed, capture_output=True, text=True, check=False)
    if reached.returncode:
        return f"apt fetches nothing in one here: {reached.stderr[-200:]}"
    said = done(["chroot", root, "sh", "-e", "-c", script], folder, env=allowed)
    said = [line for line in said.splitlines() if "hwloc" not in line]  # this library misses /sys, which is not there
    check(said == LIMIT.splitlines(), f"in a clean Debian the program that was compiled with the packages prints {said}")
    return None


def check_conda(folder):
    """The recipe is YAML once its variables are put in, with what CMakeLists.txt looks for; the script is the shell's."""
    try:
        import yaml
    except ImportError:
        skip("there is no PyYAML, which reads the recipe")
    text = text_of(os.path.join(FILES, "conda", "meta.yaml"))
    version = re.search(r'set version = "(.*)"', text)[1]
    text = re.sub(r"^\{%.*%\}$", "", text, flags=re.M).replace("{{ version }}", version)
    recipe = yaml.safe_load(re.sub(r"\{\{ (\w+)\(\"(\w+)\"\) \}\}", r"\1-\2", text))
    check(recipe["package"] == {"name": "mpmstab", "version": version}, recipe["package"])
    needs = {line.split()[0] for line in recipe["requirements"]["host"]}
    check({"petsc", "slepc", "fftw", "hdf5", "jansson", "yaml", "libzip", "liblapack"} <= needs, f"the host has {needs}")
    check(os.path.exists(os.path.join(ROOT, recipe["about"]["license_file"])), "no file of the license")
    done(["sh", "-n", os.path.join(FILES, "conda", "build.sh")], folder)


def check_spack(_):
    """The recipe is Python, and with the words of Spack it names what CMakeLists.txt looks for and options that it has."""
    path = os.path.join(FILES, "spack", "package.py")
    ast.parse(text_of(path), path)
    said = []
    names = ["spack", "spack.package", "spack_repo", "spack_repo.builtin", "spack_repo.builtin.build_systems",
             "spack_repo.builtin.build_systems.cmake"]
    modules = {name: types.ModuleType(name) for name in names}
    words = modules["spack.package"]
    for word in ("version", "license", "variant", "depends_on"):
        setattr(words, word, lambda *given, word=word, **how: said.append((word, given[0])))
    modules[names[-1]].CMakePackage = type("CMakePackage", (), {"run_tests": False, "define": lambda self, name, value: name,
                                                   "define_from_variant": lambda self, name, variant: name})
    sys.modules.update(modules)
    recipe = {}
    exec(compile(text_of(path), path, "exec"), recipe)  # pylint: disable=exec-used
    needs = {re.split(r"[@+~]", name)[0] for word, name in said if word == "depends_on"}
    check({"petsc", "slepc", "fftw", "hdf5", "jansson", "libyaml", "libzip", "lapack", "mpi"} <= needs, f"it needs {needs}")
    options = text_of(os.path.join(ROOT, "CMakeLists.txt"))
    for option in recipe["Mpmstab"]().cmake_args():
        check(option in options, f"CMakeLists.txt has no {option}")


def check_container(folder):
    """Builds the image, which runs the program in both of its stages."""
    tools = [tool for tool in ("podman", "docker", "buildah") if shutil.which(tool)
             and not subprocess.run([tool, "info"], capture_output=True, check=False, timeout=60).returncode]
    if not tools:
        skip("none of podman, docker and buildah works here, with which the image is built")
    with open(os.path.join(FILES, "Containerfile"), encoding="utf-8") as file:
        base = re.search(r"^FROM (\S+)", file.read(), re.M)[1]
    if all(subprocess.run([tools[0], *words, base], capture_output=True, check=False).returncode
           for words in (["inspect", "--type", "image"], ["pull", "-q"])):
        skip(f"{tools[0]} is here, but the image {base} cannot be fetched")
    done([tools[0], "build", "-q", "-f", "scripts/packaging/Containerfile", "."], clone(folder))


def check_names(_):
    """Each file with a placeholder for a name or an address is in the table of what a person has to fill in."""
    told = text_of(os.path.join(FILES, "README.md"))
    found = subprocess.run(["grep", "-rlIE", r"example\.org|to be named|mpmstab[ -]developers", "CITATION.cff", "LICENSE", "README.md", "docs",
                            "scripts"], cwd=ROOT, capture_output=True, text=True, check=False).stdout.split()
    named = set(re.findall(r"`([\w./-]+)`", told.split("## What a person")[1].split("\n\n`ctest")[0]))
    left = {name for name in found if not name.endswith(("packaging/README.md", ".pyc"))}
    check({"CITATION.cff", "docs/paper/paper.md"} <= left and left <= named, f"not in the table of scripts/packaging/README.md: {left - named}")


def check_paper(_):
    """The paper has about 1000 words and the sources that it cites, and is made into a PDF where that is possible."""
    paper, sources = (text_of(os.path.join(ROOT, "docs", "paper", name)) for name in ("paper.md", "paper.bib"))
    body = re.sub(r"<!--.*?-->", "", paper.split("\n---\n", 1)[1])
    check(750 < len(body.split()) < 1250, f"the paper has {len(body.split())} words")
    cited, listed = set(re.findall(r"@(\w+)", body)), set(re.findall(r"^@\w+\{(\w+),", sources, re.M))
    check(cited == listed, f"cited or listed alone: {cited ^ listed}")
    made = subprocess.run(["scripts/paper.sh"], cwd=ROOT, capture_output=True, text=True, check=False)
    if made.returncode == SKIPPED:
        skip(made.stderr.strip())
    check(made.returncode == 0, made.stderr)
    with open(os.path.join(ROOT, made.stdout.strip()), "rb") as file:
        check(file.read(5) == b"%PDF-", "no PDF was made")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="mpmstab-packaging-") as place:
        globals()[f"check_{sys.argv[1]}"](place)
