#!/bin/bash
# What release.sh says where it cannot begin: in a folder that is no repository, and without git.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/tools" "$folder/bin"
cp "$root/tools/release.sh" "$folder/tools"
cp "$root/CMakeLists.txt" "$folder"
for program in bash dirname sed; do ln -s "$(command -v "$program")" "$folder/bin"; done
for path in "$PATH" "$folder/bin"; do
  status=0
  said=$(GIT_CEILING_DIRECTORIES=$folder PATH=$path "$folder/tools/release.sh" --no-setup "$folder/out" 2>&1) || status=$?
  if [ "$status" -ne 1 ] || [[ "$said" != *"a release is made of commits, and this folder is no git repository"* ]]; then
    echo "refusals_test.sh: status $status, said: $said" >&2
    exit 1
  fi
done
