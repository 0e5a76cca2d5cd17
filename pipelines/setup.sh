#!/bin/sh
# Installs the Debian 12 packages that a purpose needs, and builds for it into build/release.
#
#   sh pipelines/setup.sh          the programs, and what draws pictures of their results
#   sh pipelines/setup.sh test     these and the tests
#   sh pipelines/setup.sh develop  programs and tests, and what formats and reads the sources
#   sh pipelines/setup.sh studies  programs and tests, and what studies need and pipelines compare with
#   sh pipelines/setup.sh exchange programs and tests, GDAL for jointexport, and readers of its files
#   sh pipelines/setup.sh fuzz     the fuzz targets, into build/fuzz
#   sh pipelines/setup.sh package  the programs, and a Debian package of them, build/release/*.deb
#   sh pipelines/setup.sh docs     the site of the pages in docs, into out/docs; no program
#
# A list of packages is a file of pipelines/packages, one name a line.
set -eu
cd "$(dirname "$0")/.."

if [ $# -gt 1 ]; then
  echo "setup.sh: unknown \"$2\"; expected nothing, test, develop, studies, exchange, fuzz, package or docs" >&2
  exit 2
fi
case "$PWD" in
*[[:space:]]*)
  echo "setup.sh: the path \"$PWD\" has a blank, which Make cannot take; expected a path without" >&2
  exit 2
  ;;
esac
purpose="${1:-run}"
case "$purpose" in
run) lists="run" preset="release" ;;
test) lists="run test" preset="test" ;;
develop | studies | exchange) lists="run test $purpose" preset="test" ;;
fuzz) lists="run test fuzz" preset="fuzz" ;;
package) lists="run package" preset="release" ;;
docs) lists="docs" preset="" ;;
*)
  echo "setup.sh: unknown purpose \"$purpose\"; expected nothing, test, develop, studies, exchange, fuzz, package or docs" >&2
  exit 2
  ;;
esac

missing=""
for list in $lists; do
  while read -r package || [ -n "$package" ]; do
    case "$package" in "" | "#"*) continue ;; esac
    case "$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null)" in
      *" installed") ;;
      *) missing="$missing $package" ;;
    esac
  done <"pipelines/packages/$list.txt"
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

if [ "$purpose" = docs ]; then
  exec make -C docs
fi
cmake --preset "$preset"
cmake --build --preset "$preset"
if [ "$purpose" = package ]; then
  cd build/release && cpack -G DEB
fi
