# Sourced: what every build here needs, and its tests besides (Debian's names), and the function that installs what is
# missing.
# shellcheck shell=sh disable=SC2034 # used where this is sourced
common_packages="gcc libc6-dev make cmake pkg-config git libhdf5-openmpi-dev libopenmpi-dev openmpi-bin
                 libopenblas0-serial libfftw3-dev libyaml-dev libjansson-dev zlib1g-dev python3 python3-numpy python3-h5py
                 python3-matplotlib"
test_packages="clang-format valgrind shellcheck chromium chromium-driver python3-selenium python3-scipy python3-pip
               python3-nbclient python3-ipykernel python3-jsonschema python3-yaml g++ gfortran octave"

install_missing() {
  missing=
  for package; do
    case $(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true) in
    *"ok installed") ;;
    *) missing="$missing $package" ;;
    esac
  done
  [ -n "$missing" ] || return 0
  as_root=
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "there is no sudo; as root, install:$missing" >&2; exit 1; }
    as_root=sudo
  fi
  echo "installing:$missing"
  $as_root apt-get update -qq
  # shellcheck disable=SC2086 # a list of packages
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
}
