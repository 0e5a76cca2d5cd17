#!/bin/sh
# Checks of the C++ sources that take long:
#   1. the C++ tests with the address and undefined-behaviour sanitizers, among them short forms of the fuzzers;
#   2. scenes by programs with sanitizers, which have to give the bytes of the release programs;
#   3. some mutants of the laws of joints and rock, which the tests have to find.
# Needs `sh pipelines/setup.sh test`. The digest of the sources that pass is kept in pipelines/checked.txt: commit it with them.
#
#   sh pipelines/check.sh            the checks
#   sh pipelines/check.sh --changed  the checks, unless these sources have passed
#
# Some long tests are left out: they repeat, many hundred times, what the others of their folders do (ctest --preset asan has all).
set -eu
cd "$(dirname "$0")/.."
record=pipelines/checked.txt
case "$*" in
"" | --changed) ;;
*)
  echo "check.sh: unknown \"$*\"; expected nothing or --changed" >&2
  exit 2
  ;;
esac

digest="$(find CMakeLists.txt CMakePresets.json libs apps tests pipelines/reliability pipelines/check.sh -type f \
  \( -name '*.?pp' -o -name '*.py' -o -name '*.sh' -o -name '*.xz' -o -name 'CMake*' \) ! -path 'tests/pipeline/*' |
  LC_ALL=C sort | xargs sha256sum | sha256sum | cut -d ' ' -f 1)"
if [ "$*" = --changed ] && [ -f "$record" ] && [ "$(cat "$record")" = "$digest" ]; then
  echo "check.sh: these C++ sources have passed"
  exit 0
fi

cmake --preset asan
cmake --build --preset asan
repeats='back_analysis.truth_*:creep_curve.truth_*:creep_curve.intervals_*:instrument.truth_*:instrument.residuals_*'
repeats="$repeats:redundant.backward_keeps_*:redundant.the_error_estimate_*:*/relax_with.a_tall_stack_that_comes_to_rest_slowly_*"
repeats="$repeats:sensitivity.of_joints_that_slip_*:cost.number_of_zones_in_the_sections_of_data:SampleJoints.RefusesTooMany*"
GTEST_FILTER="-$repeats" ctest --preset asan -j "$(nproc)" -E '^(pipeline/.*|statistics/verdicts|sampling/acceptance|sampling/joint_statistics)$'

cmake --build --preset test # of the same version
ASAN_OPTIONS=detect_leaks=0 make -C pipelines/reliability compilers N=12 OUT=out/checks OPTIONS="--built $PWD/build/asan/apps"
make -C pipelines/reliability mutants N=8 OUT=out/checks OPTIONS="--only laws --target joint_tests --target rock_tests"
echo "$digest" >"$record"
