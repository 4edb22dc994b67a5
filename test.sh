#!/bin/bash
# Installs what is missing, builds, and runs the tests.
#
#   ./test.sh            format; each way to build, set up and configured in a bare Debian; release build with warnings as errors and
#                        its tests; unit and fuzz tests under AddressSanitizer + UndefinedBehaviorSanitizer; those of threads under
#                        ThreadSanitizer
#   ./test.sh --quick    format, the release build and its tests only
#   ./test.sh --all      everything there is: the above with tests at full length, those of threads in more programs, each header alone,
#                        core alone, Qt 6, each way built in a bare Debian, packages. It takes hours; a later run on the same tree
#                        leaves out what has passed.
#
#   ./test.sh --no-setup installs nothing (for machines without apt-get)
#
# The last line is a summary like that of ctest; the status is 0 only if everything passed. Tests that could not run are named above it.
set -euo pipefail
cd "$(dirname "$0")"

quick=no
all=no
setup=yes
for argument in "$@"; do
  case "$argument" in
    --quick) quick=yes ;;
    --all) all=yes ;;
    --no-setup) setup=no ;;
    -h | --help) sed -n '2,16s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "test.sh: unknown option $argument (see --help)" >&2; exit 2 ;;
  esac
done

jobs=${PLENOFLAME_JOBS:-$(nproc)}
logs=build/logs
mkdir -p "$logs"
total=0
failed=0
broken=()
skipped=()
# With --all, a file of what has passed on this very tree, which a run that was ended goes on from. Without git none is kept.
passed=/dev/null
before=0

recall() {
  local tree
  tree=$({ git rev-parse HEAD && git diff --binary HEAD && git ls-files -oz --exclude-standard | xargs -0r sha256sum; } 2>/dev/null |
    sha256sum) || return 0
  passed=build/passed
  [ "$(head -n 1 "$passed" 2>/dev/null)" = "$tree" ] || echo "$tree" >"$passed"
}

say() { printf '\n=== %s (%d s)\n' "$1" "$SECONDS"; }

is_passed() { grep -qxF "$1" "$passed"; }

# stage NAME COMMAND...: what is not a CTest run counts as one test. A status of 77 skips it.
stage() {
  local name=$1 status=0
  shift
  if is_passed "stage $name"; then
    before=$((before + 1))
    return 0
  fi
  say "$name"
  "$@" || status=$?
  if [ "$status" -eq 77 ]; then
    skipped+=("$name")
    return 0
  fi
  total=$((total + 1))
  if [ "$status" -eq 0 ]; then  # a build is soon found to be complete
    [[ "$name" = build:* ]] || echo "stage $name" >>"$passed"
    return 0
  fi
  failed=$((failed + 1))
  broken+=("$name")
  return 1
}

# What did not run in the tests of PRESET: whole tests, and parts of them (GoogleTest, unittest).
skipped_tests() {
  sed -nE -e 's/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: ([^ ]+) \.*\*\*\*Skipped.*/\1/p' -e 's/^\[  SKIPPED \] ([^ ,]+) \(.*/\1/p' \
    -e 's/.* \.\.\. skipped (.*)/\1/p' "$logs/ctest-$1.log" "build/$1/Testing/Temporary/LastTest.log" 2>/dev/null | sort -u
}

# run_tests PRESET [ctest options]
run_tests() {
  local preset=$1 status=0 log="$logs/ctest-$1.log" line each have
  shift
  mapfile -t have < <(sed -n "s/^$preset //p" "$passed")
  before=$((before + ${#have[@]}))
  while read -r each; do skipped+=("$each"); done < <(sed -n "s/^skipped $preset //p" "$passed")
  [ ${#have[@]} -eq 0 ] || set -- "$@" -E "^($(IFS='|' && echo "${have[*]}"))$"
  say "tests: $preset"
  # One more than processors: tests of programs and windows wait now and then.
  "${run[@]}" ctest --preset "$preset" -j $((jobs + 1)) --no-tests=error "$@" |
    tee "$log" >(sed -unE "s/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: ([^ ]+) \.* +Passed .*/$preset \1/p" >>"$passed") |
    grep -vE '^ +Start +[0-9]+:| +Passed +[0-9.]+ sec$' || status=${PIPESTATUS[0]}
  while read -r each; do
    [ -z "$each" ] || skipped+=("$each")
    [ -z "$each" ] || echo "skipped $preset $each" >>"$passed"
  done < <(skipped_tests "$preset")
  line=$(grep -E '^[0-9]+% tests passed, [0-9]+ tests? failed out of [0-9]+' "$log" | tail -1 || true)
  if [[ "$line" =~ \ ([0-9]+)\ tests?\ failed\ out\ of\ ([0-9]+) ]]; then
    total=$((total + BASH_REMATCH[2]))
    failed=$((failed + BASH_REMATCH[1]))
    [ "${BASH_REMATCH[1]}" -eq 0 ] || broken+=("tests: $preset")
    [ "$status" -eq 0 ] || [ "${BASH_REMATCH[1]}" -gt 0 ] || status=2
  elif [ "$status" -ne 8 ] || [ ${#have[@]} -eq 0 ]; then  # 8: none is left to run
    status=2
  fi
  if [ "$status" -eq 2 ]; then  # ctest itself failed: nothing ran, or it broke off
    total=$((total + 1))
    failed=$((failed + 1))
    broken+=("tests: $preset (ctest ended early)")
  fi
}

# build PRESET LABELS [TARGET...]: without the programs of tests with LABELS ("slow|long"); all of it, or TARGETs. TARGET objects: no
# library or program is linked.
build() {
  local preset=$1 without=${2//|/;} folder=${folder:-build/$1}
  shift 2
  "${run[@]}" cmake --preset "$preset" -B "$folder" "-DPLENOFLAME_TESTS_LEFT_OUT=$without" "${how[@]}" >"$logs/configure-${folder##*/}.log" 2>&1 || {
    cat "$logs/configure-${folder##*/}.log"
    return 1
  }
  [ "${1:-}" != objects ] || set -- $(ninja -C "$folder" -t targets all | sed -n 's/\.o: CXX_.*/.o/p')
  "${run[@]}" cmake --build "$folder" -j "$jobs" ${1:+--target "$@"} >"$logs/build-${folder##*/}.log" 2>&1 || {
    tail -n 200 "$logs/build-${folder##*/}.log"
    return 1
  }
  tail -n 1 "$logs/build-${folder##*/}.log"
}

# The run in a bare Debian, which was begun beside the build.
bare_run=
bare_passed=no
end_of_bare() {
  local status=0
  wait "$bare_run" || status=$?
  bare_run=
  [ "$status" -ne 0 ] || bare_passed=yes
  cat "$logs/bare.log"
  return "$status"
}
trap '[ -z "$bare_run" ] || kill "$bare_run"' EXIT

summary() {
  local percent=$((total > 0 ? 100 * (total - failed) / total : 0))
  [ "$before" -eq 0 ] || printf '\nNot run again: %d tests that have passed on this very tree.\n' "$before"
  [ ${#skipped[@]} -eq 0 ] || { printf '\nNot run here:\n' && printf '  %s\n' "${skipped[@]}" | sort -u; }
  [ ${#broken[@]} -eq 0 ] || printf '\nFailed: %s\n' "$(IFS=';' && echo "${broken[*]}")"
  printf '\n%d%% tests passed, %d tests failed out of %d (%d min)\n' "$percent" "$failed" "$total" $((SECONDS / 60))
  [ "$failed" -eq 0 ] && [ "$total" -gt 0 ]
}

# Unit and fuzz tests run under the sanitizers, all others in the release build; those of vector kernels, which depend on the
# instruction set, in both. Tests labelled long run with --all, in the release build.
release_without='unit|fuzz|long'
chosen=(-LE "$release_without")
asan_without='slow|statistical|long|meta'
how=(-DPLENOFLAME_COMPILE_TOGETHER=ON)
bare=()
packages=(release)
# One thread has no races: of each program the tests in which several work, or one is stopped by another.
threaded=(base render)
not_threaded='calibration;inverse'
races='*Thread*:*Stop*:*ParallelFor*:*Progress*'
if [ "$all" = yes ]; then
  release_without=fuzz  # some long tests are in programs of unit tests
  chosen=(-LE 'unit|fuzz|short')  # longer forms contain the short ones
  threaded=(base camera inverse lightfield render slow)
  not_threaded=
  bare=(--all)
  packages=(release package qt6 slurm)
  recall
fi

run=()
export LSAN_OPTIONS="suppressions=$PWD/tests/lsan_suppressions.txt:print_suppressions=0"
# A length from a damaged file that no memory holds: HDF5 asks malloc for it, and deals with the refusal.
export ASAN_OPTIONS=allocator_may_return_null=1
if [ "$setup" = yes ]; then
  say "packages"
  tools/setup.sh "${packages[@]}" || exit 1
fi

stage "format" tools/format.sh --check || true
# Much of its time the run in a bare Debian waits for packages: beside a build. It would change the times that tests measure.
begin_bare() {
  if is_passed "stage bare Debian"; then
    bare_passed=yes
    return 0
  fi
  tests/bare/run.sh "${bare[@]}" >"$logs/bare.log" 2>&1 &
  bare_run=$!
}
[ "$quick$all" != nono ] || begin_bare
built=no
if stage "build: release" build release "$release_without"; then built=yes; fi
if [ "$all" = yes ]; then
  begin_bare
  stage "build: core alone" build core-only "" || true
  # What developers build: file by file, and no precompiled header hides a missing include. Nothing is written: some objects wait for
  # libraries, which "true" makes. The cache would preprocess each file once more.
  how=(-DPLENOFLAME_COMPILE_TOGETHER=OFF -DPLENOFLAME_PRECOMPILE=OFF -DCMAKE_CXX_FLAGS_RELEASE=-fsyntax-only
    -DCMAKE_DISABLE_FIND_PACKAGE_Qt6=ON -DCMAKE_AR=/bin/true -DCMAKE_RANLIB=/bin/true -DCMAKE_CXX_LINKER_LAUNCHER=/bin/true)
  CCACHE_DISABLE=1 folder=build/file-by-file stage "file by file" build release "" objects || true
  how=(-DPLENOFLAME_COMPILE_TOGETHER=ON)
fi
if [ "$quick" = no ]; then
  stage "bare Debian" end_of_bare || true
  # There the others have run, except those of ParaView, which make a bare Debian of their own.
  [ "$all$bare_passed" != yesyes ] || chosen=(-L 'long|meta|paraview')
fi
[ "$built" = no ] || run_tests release "${chosen[@]}"
if [ "$quick" = no ]; then
  if stage "build: address and undefined-behaviour sanitizers" build asan "$asan_without"; then
    run_tests asan -LE "$asan_without"
  fi
fi
if [ "$quick" = no ]; then
  # GCC 12's ThreadSanitizer does not start where the kernel randomises addresses widely.
  if setarch "$(uname -m)" -R true 2>/dev/null; then run=(setarch "$(uname -m)" -R); fi
  how+=("-DPLENOFLAME_AREAS_LEFT_OUT=$not_threaded")
  if stage "build: thread sanitizer" build tsan "" "${threaded[@]/%/_test}"; then
    GTEST_FILTER=$races run_tests tsan -LE long -R "^($(IFS='|' && echo "${threaded[*]}"))[.]"
  fi
fi
summary
