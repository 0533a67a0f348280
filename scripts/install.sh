# Sourced: what every build here needs, and its tests besides (Debian's names), and functions that look for it, install
# what is missing and keep scripts apart that run at the same time.
# shellcheck shell=sh disable=SC2034 # used where this is sourced
common_packages="gcc libc6-dev make cmake pkg-config libhdf5-openmpi-dev libopenmpi-dev openmpi-bin
                 libopenblas0-serial libfftw3-dev libyaml-dev libjansson-dev libzip-dev python3 python3-numpy
                 python3-h5py python3-matplotlib"
test_packages="git clang-format valgrind shellcheck chromium chromium-driver python3-selenium python3-scipy python3-pip
               python3-nbclient python3-ipykernel python3-jsonschema python3-yaml g++ gfortran octave"

give_up() {
  echo "$*" >&2
  exit 1
}

runs() { command -v "$1" >/dev/null 2>&1; }

python() { # Debian's has the modules
  if [ -x /usr/bin/python3 ]; then /usr/bin/python3 "$@"; else python3 "$@"; fi
}

module() { python -c "import importlib.util as u, sys; sys.exit(not u.find_spec('$1'))" 2>/dev/null; }

library() { pkg-config --exists "$1" 2>/dev/null; }

own() { # NAME: is its file for pkg-config where CMakeLists.txt looks first? CMake then looks at its version.
  for folder in "${PETSC_DIR:-/dev/null}" "${SLEPC_DIR:-/dev/null}"; do
    [ ! -e "$folder/${PETSC_ARCH:-}/lib/pkgconfig/$1.pc" ] && [ ! -e "$folder/lib/pkgconfig/$1.pc" ] || return 0
  done
  return 1
}

there() { # PACKAGE: is what this package of Debian gives there, from Debian or from elsewhere?
  case $1 in
  gcc) runs cc || runs gcc ;;
  g++) runs c++ || runs g++ ;;
  make | cmake | pkg-config | git | clang-format | valgrind | shellcheck | chromium | gfortran | octave | clang)
    runs "$1"
    ;;
  chromium-driver) runs chromedriver ;;
  openmpi-bin) runs mpirun ;;
  libopenmpi-dev) runs mpicc ;;
  libhdf5-openmpi-dev) library hdf5-openmpi || runs h5pcc ;;
  petsc-dev) own PETSc || library 'PETSc >= 3.18' ;;
  slepc-dev) own SLEPc || library 'SLEPc >= 3.18' ;;
  libfftw3-dev) library fftw3 ;;
  libyaml-dev) library 'yaml-0.1 >= 0.2' ;;
  libjansson-dev) library 'jansson >= 2.9' ;;
  libzip-dev) library 'libzip >= 1.5' ;;
  python3) python -c '' 2>/dev/null ;;
  python3-*) module "${1#python3-}" ;;
  libopenblas0-serial) ! runs dpkg-query || ls /usr/lib/*/openblas*/liblapack.so.3 >/dev/null 2>&1 ;;
  *) # elsewhere the compiler and CMake say what they lack
    ! runs dpkg-query || dpkg-query -W -f='${Status}' "$1" 2>/dev/null | grep -q 'ok installed'
    ;;
  esac
}

find_missing() { # PACKAGE...: leaves those that are not there in $missing
  missing=
  for package; do
    there "$package" || missing="$missing $package"
  done
}

install_missing() { # PACKAGE...
  find_missing "$@"
  [ -n "$missing" ] || return 0
  case "${PETSC_DIR:-}${SLEPC_DIR:-} $missing " in
  /*" petsc-dev "* | /*" slepc-dev "*)
    give_up "PETSC_DIR or SLEPC_DIR is set, and PETSc or SLEPc is not there (PETSC_DIR '${PETSC_DIR:-}', PETSC_ARCH" \
      "'${PETSC_ARCH:-}', SLEPC_DIR '${SLEPC_DIR:-}'); build it there, or unset these for Debian's."
    ;;
  esac
  runs apt-get ||
    give_up "No apt-get is here to install what is missing (Debian's names):$missing; INSTALL.md says what is needed."
  as_root=
  if [ "$(id -u)" -ne 0 ]; then
    { runs sudo && sudo -p 'your password, to install what is missing: ' true 2>/dev/null; } ||
      give_up "You are not root, and cannot use sudo; have an administrator run this: apt-get update &&" \
      "apt-get install --no-install-recommends$missing"
    as_root=sudo
  fi
  echo "installing, which takes minutes:$missing"
  quietly="-qq -o DPkg::Lock::Timeout=600"
  # shellcheck disable=SC2086 # lists of words
  {
    $as_root apt-get $quietly update
    $as_root env LC_ALL=C apt-get --assume-no --no-install-recommends install $missing 2>/dev/null |
      sed -n 's/^Need to get \(.*\) of archives.*/download: \1/p; s/^After[^,]*, \(.*\) of add.*/on disk: \1/p'
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get $quietly -y --no-install-recommends install $missing >/dev/null
  } || give_up "apt-get has not installed what is missing, and says why above; INSTALL.md says what is needed."
  find_missing "$@"
  [ -z "$missing" ] ||
    give_up "These are installed, and still what they are for is missing or too old:$missing; see INSTALL.md."
}

alone() { # LOCK WHAT: waits for another script that holds this lock, and holds it until this script ends
  (mkdir -p "$(dirname "$1")" && : >>"$1") 2>/dev/null ||
    give_up "$PWD/$(dirname "$1") cannot be written to; copy the project to a folder of your own and start there."
  exec 9>>"$1"
  ! runs flock || flock -n 9 || { echo "waiting for another script, $2" && flock 9; }
}
