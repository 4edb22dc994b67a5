#!/bin/bash
# Line coverage of core, volumes and the command: builds the preset coverage, runs the tests, and
# writes a report to out/coverage/index.html. Packages: tools/setup.sh coverage
set -euo pipefail
cd "$(dirname "$0")/.."
jobs=${PLENOFLAME_JOBS:-$(nproc)}
command -v lcov >/dev/null || {
  echo "coverage.sh: lcov is missing: tools/setup.sh dev" >&2
  exit 1
}
cmake --preset coverage >/dev/null
cmake --build --preset coverage -j "$jobs"
find build/coverage -name '*.gcda' -delete
ctest --preset coverage -j "$jobs" -LE 'slow|meta'
mkdir -p out/coverage
lcov --quiet --capture --directory build/coverage --base-directory "$PWD" --no-external \
  --output-file build/coverage/all.info
lcov --quiet --extract build/coverage/all.info "$PWD/core/*" "$PWD/volumes/*" "$PWD/app/*" \
  --output-file build/coverage/coverage.info
genhtml --quiet --output-directory out/coverage build/coverage/coverage.info
lcov --summary build/coverage/coverage.info
echo "out/coverage/index.html"
