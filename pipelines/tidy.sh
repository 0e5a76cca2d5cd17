#!/bin/sh
# Runs clang-tidy on the C++ sources that a change touches; the packages are those of `setup.sh develop`.
#
#   sh pipelines/tidy.sh            the files of the last commit, the first twelve of them if there are more
#   sh pipelines/tidy.sh REVISION   all files changed since a revision
#
# It ends with code 1 where clang-tidy finds something to mend.
set -eu
cd "$(dirname "$0")/.."
if [ $# -gt 1 ]; then
  echo "tidy.sh: unknown \"$2\"; expected nothing or one revision" >&2
  exit 2
fi

changed() {
  git -c safe.directory="$PWD" diff --name-only --diff-filter=d "$1" -- 'apps/*.cpp' 'libs/*.cpp' 'tests/*.cpp' ':!tests/fuzz'
}
if [ $# = 1 ]; then
  files="$(changed "$1")"
else
  files="$(changed HEAD~1 | head -n 12)"
fi
if [ -z "$files" ]; then
  echo "tidy.sh: no C++ source is changed"
  exit 0
fi
# Commands of each file by itself, with the headers that precompiling hides.
cmake --preset test -B build/tidy -D JOINTCREEP_UNITY=OFF -D CMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null
cmake --build build/tidy --target version_header >/dev/null
echo "$files" | xargs -n 1 -P "$(nproc)" clang-tidy --quiet -p build/tidy
