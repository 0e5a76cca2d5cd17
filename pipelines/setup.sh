#!/bin/sh
# Installs what jointcreep is built and tested with (Debian 12 packages), and builds it into build/release.
set -eu
cd "$(dirname "$0")/.."

packages="
  g++ cmake ninja-build make git ca-certificates pkg-config
  libeigen3-dev libcgal-dev libboost-dev libboost-program-options-dev libhdf5-dev libssl-dev zlib1g-dev
  libtomlplusplus-dev nlohmann-json3-dev librandom123-dev libsuitesparse-dev libopenblas0-serial
  googletest libgtest-dev librapidcheck-dev groff-base
  python3 python3-h5py python3-matplotlib python3-numpy"

missing=""
for package in $packages; do
  case "$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null)" in
    *" installed") ;;
    *) missing="$missing $package" ;;
  esac
done
if [ -n "$missing" ]; then
  as_root=""
  if [ "$(id -u)" != 0 ]; then
    as_root="sudo"
    if ! command -v sudo >/dev/null; then
      echo "setup.sh: only root can install the missing packages:$missing" >&2
      exit 1
    fi
  fi
  $as_root apt-get update
  # shellcheck disable=SC2086  # a list of words is wanted
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing
fi

cmake --preset release
cmake --build --preset release
