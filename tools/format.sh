#!/bin/bash
# Formats the C++ sources with clang-format 14 (.clang-format), or checks them.
#
#   tools/format.sh [--check] [FILE ...]    without files: all of the project
set -euo pipefail
cd "$(dirname "$0")/.."

mode=(-i)
if [ "${1:-}" = --check ]; then
  mode=(--dry-run --Werror)
  shift
fi
# Versions differ in what they make of the same settings: only 14 (Debian 12) counts.
formatter=
for candidate in clang-format-14 clang-format; do
  if command -v "$candidate" >/dev/null && "$candidate" --version | grep -q 'version 14\.'; then
    formatter=$candidate
    break
  fi
done
if [ -z "$formatter" ]; then
  echo "format.sh: clang-format 14 is missing (Debian package clang-format-14)" >&2
  exit 1
fi
files=("$@")
if [ ${#files[@]} -eq 0 ]; then
  folders=()
  for folder in core volumes app tests examples benchmarks; do
    [ ! -d "$folder" ] || folders+=("$folder")
  done
  mapfile -t files < <(find "${folders[@]}" -type f \
    \( -name '*.h' -o -name '*.cpp' -o -name '*.cxx' \) | sort)
fi
[ ${#files[@]} -eq 0 ] || "$formatter" "${mode[@]}" "${files[@]}"
