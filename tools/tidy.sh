#!/bin/bash
# Static analysis with clang-tidy (.clang-tidy) on the files of a build's compile_commands.json.
#
#   tools/tidy.sh [--all | FILE ...]   without arguments: the files that differ from the main branch
#
# Environment: BUILD (build/release): the build folder to take the compile commands from.
set -euo pipefail
cd "$(dirname "$0")/.."

build=${BUILD:-build/release}
tidy=$(command -v clang-tidy-14 || command -v clang-tidy || true)
if [ -z "$tidy" ]; then
  echo "tidy.sh: clang-tidy is missing: tools/setup.sh dev" >&2
  exit 1
fi
if [ ! -f "$build/compile_commands.json" ]; then
  echo "tidy.sh: $build/compile_commands.json is missing: cmake --preset release" >&2
  exit 1
fi
# Kernels are compiled through generated files; clang reads them with other vector flags than GCC.
known() { sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' "$build/compile_commands.json" | sort -u; }
case "${1:-}" in
  --all) mapfile -t files < <(known | grep -F "$PWD/" | grep -vF "$PWD/build/" || true) ;;
  '')
    base=$(git merge-base HEAD origin/main 2>/dev/null || git rev-parse HEAD)
    mapfile -t files < <({ git diff --name-only "$base"; git ls-files --others --exclude-standard; } |
      sed "s|^|$PWD/|" | sort -u | comm -12 - <(known))
    ;;
  -*) echo "tidy.sh: unknown option $1" >&2; exit 2 ;;
  *) files=("$@") ;;
esac
if [ ${#files[@]} -eq 0 ]; then
  echo "tidy.sh: no files to check"
  exit 0
fi
echo "tidy.sh: ${#files[@]} files"
# Warning options of GCC that clang does not know are no findings.
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "${PLENOFLAME_JOBS:-$(nproc)}" \
  "$tidy" -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
