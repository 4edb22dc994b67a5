#!/bin/bash
# Installs what is missing, builds, and runs all tests.
#
#   ./test.sh            format check, release build with warnings as errors, core alone, and the tests
#                        again under AddressSanitizer + UndefinedBehaviorSanitizer and under ThreadSanitizer
#   ./test.sh --quick    format check, the release build and its tests only
#   ./test.sh --all      everything there is: also what takes minutes, and all of it under the sanitizers
#
#   ./test.sh --no-setup installs nothing (for machines without apt-get)
#   ./test.sh --minutes N  leaves out of the sanitizers what does not end within N minutes, and says so
#
# The last line is a summary like that of ctest; the status is 0 only if everything passed.
set -euo pipefail
cd "$(dirname "$0")"

quick=no
all=no
setup=yes
minutes=
while [ $# -gt 0 ]; do
  argument=$1
  shift
  case "$argument" in
    --quick) quick=yes ;;
    --all) all=yes ;;
    --minutes)
      minutes=${1:-}
      [[ "$minutes" =~ ^[0-9]+$ ]] || { echo "test.sh: --minutes wants a whole number" >&2; exit 2; }
      shift
      ;;
    --no-setup) setup=no ;;
    -h | --help) sed -n '2,11s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "test.sh: unknown option $argument (see --help)" >&2; exit 2 ;;
  esac
done

jobs=${PLENOFLAME_JOBS:-$(nproc)}
logs=build/logs
mkdir -p "$logs"
total=0
failed=0
broken=()
left_out=()
limited=no  # whether what runs now is ended when the time is up

say() { printf '\n=== %s (%d s)\n' "$1" "$SECONDS"; }

# in_time COMMAND...: with the time that is left now, where it is limited.
in_time() {
  local limit=()
  if [ "$limited" = yes ]; then
    limit=(timeout --signal=INT --kill-after=20 $((60 * minutes > SECONDS ? 60 * minutes - SECONDS : 1)))
  fi
  "${run[@]}" "${limit[@]}" "$@"
}

ended_by_timeout() { [ "$limited" = yes ] && { [ "$1" -eq 124 ] || [ "$1" -eq 137 ]; }; }

# stage NAME COMMAND...: what is not a CTest run counts as one test.
stage() {
  local name=$1
  shift
  say "$name"
  total=$((total + 1))
  local status=0
  "$@" || status=$?
  [ "$status" -ne 0 ] || return 0
  if ended_by_timeout "$status"; then
    total=$((total - 1))
    left_out+=("$name")
    return 1
  fi
  failed=$((failed + 1))
  broken+=("$name")
  return 1
}

# run_tests PRESET [ctest options]
run_tests() {
  local preset=$1 status=0 log="$logs/ctest-$1.log" line
  shift
  say "tests: $preset"
  # One more than processors: tests of programs and windows wait now and then. Programs that were not built are named
  # NAME_NOT_BUILT by CTest.
  in_time ctest --preset "$preset" -j $((jobs + 1)) --no-tests=error -E '_NOT_BUILT' "$@" | tee "$log" |
    grep -vE '^ +Start +[0-9]+:| +Passed +[0-9.]+ sec$' || status=${PIPESTATUS[0]}
  if ended_by_timeout "$status"; then
    local failures
    failures=$(grep -E ' Test +#[0-9]+: .*\*\*\*' "$log" | grep -cv '\*\*\*Skipped' || true)
    total=$((total + $(grep -cE ' Test +#[0-9]+: ' "$log" || true)))
    failed=$((failed + failures))
    [ "$failures" -eq 0 ] || broken+=("tests: $preset")
    left_out+=("the rest of tests: $preset")
    return
  fi
  line=$(grep -E '^[0-9]+% tests passed, [0-9]+ tests? failed out of [0-9]+' "$log" | tail -1 || true)
  if [[ "$line" =~ \ ([0-9]+)\ tests?\ failed\ out\ of\ ([0-9]+) ]]; then
    total=$((total + BASH_REMATCH[2]))
    failed=$((failed + BASH_REMATCH[1]))
    [ "${BASH_REMATCH[1]}" -eq 0 ] || broken+=("tests: $preset")
    [ "$status" -eq 0 ] || [ "${BASH_REMATCH[1]}" -gt 0 ] || status=2
  else
    status=2
  fi
  if [ "$status" -eq 2 ]; then  # ctest itself failed: nothing ran, or it broke off
    total=$((total + 1))
    failed=$((failed + 1))
    broken+=("tests: $preset (ctest ended early)")
  fi
}

# build PRESET LABELS [options of cmake --build]: without the programs of tests with LABELS ("slow|long").
build() {
  local preset=$1 without=${2//|/;}
  shift 2
  "${run[@]}" cmake --preset "$preset" -S . -DPLENOFLAME_COMPILE_TOGETHER=ON "-DPLENOFLAME_TESTS_LEFT_OUT=$without" >"$logs/configure-$preset.log" 2>&1 || {
    cat "$logs/configure-$preset.log"
    return 1
  }
  in_time cmake --build --preset "$preset" -j "$jobs" "$@" >"$logs/build-$preset.log" 2>&1 || {
    local status=$?
    ended_by_timeout "$status" || tail -n 200 "$logs/build-$preset.log"
    return "$status"
  }
  tail -n 1 "$logs/build-$preset.log"
}

# time_for NAME SHARE: whether a stage that takes SHARE percent of what all before it took still fits. What follows is limited.
time_for() {
  [ -n "$minutes" ] || return 0
  limited=yes
  [ $((SECONDS + SECONDS * $2 / 100)) -gt $((60 * minutes)) ] || return 0
  say "$1: left out, $minutes minutes would not suffice"
  left_out+=("$1")
  return 1
}

summary() {
  local percent=$((total > 0 ? 100 * (total - failed) / total : 0))
  [ ${#left_out[@]} -eq 0 ] || printf '\nLeft out for want of time: %s\n' "$(IFS=';' && echo "${left_out[*]}")"
  [ ${#broken[@]} -eq 0 ] || printf '\nFailed: %s\n' "$(IFS=';' && echo "${broken[*]}")"
  printf '\n%d%% tests passed, %d tests failed out of %d\n' "$percent" "$failed" "$total"
  [ "$failed" -eq 0 ] && [ "$total" -gt 0 ]
}

# The sanitizers leave out tests that take long, which ran in the release build already, and those that compare whole
# pictures statistically, whose code the tests of each part go through, too.
release_only='long'
asan_only='slow|long|meta|statistical'
tsan_only='slow|long|meta|fuzz|statistical'
# Only programs with threads: one thread has no races.
threaded=(base_test camera_test pupil_sampling_test lightfield_views_test render_test ray_paths_test forward_test measurement_test)
if [ "$all" = yes ]; then
  release_only='^$'
  asan_only='meta'
  tsan_only='meta'
  threaded=(all)
fi

run=()
export LSAN_OPTIONS="suppressions=$PWD/tests/lsan_suppressions.txt:print_suppressions=0"
# A length from a damaged file that no memory holds: HDF5 asks malloc for it, and deals with the refusal.
export ASAN_OPTIONS=allocator_may_return_null=1
if [ "$setup" = yes ]; then
  say "packages"
  tools/setup.sh core volumes cli vtk python desktop mpi tests site || exit 1
fi

stage "format" tools/format.sh --check || true
if stage "build: release" build release ""; then
  run_tests release -LE "$release_only"
fi
if [ "$quick" = no ]; then
  stage "build: core alone" build core-only "" || true
  if time_for "address and undefined-behaviour sanitizers" 50 &&
    stage "build: address and undefined-behaviour sanitizers" build asan "$asan_only"; then
    run_tests asan -LE "$asan_only"
  fi
  # GCC 12's ThreadSanitizer does not start where the kernel randomises addresses widely.
  if setarch "$(uname -m)" -R true 2>/dev/null; then run=(setarch "$(uname -m)" -R); fi
  if time_for "thread sanitizer" 50 &&
    stage "build: thread sanitizer" build tsan "$tsan_only" --target "${threaded[@]}"; then
    run_tests tsan -LE "$tsan_only"
  fi
fi
summary
