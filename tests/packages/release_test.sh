#!/bin/bash
# The whole of a release, in a copy of this repository with a tag of its own: packages, lintian, a fresh Debian that
# installs and uses them, checksums. Ends with 77, which skips the test, where that cannot be done.
#
#   tests/packages/release_test.sh FOLDER
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
[ $# -eq 1 ] || { sed -n '5s/^# *//p' "$0" >&2; exit 2; }
skip() { echo "skipped: $1"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "a fresh Debian is made by root"
for program in mmdebstrap lintian git dpkg-shlibdeps; do
  command -v "$program" >/dev/null || skip "there is no $program (tools/setup.sh package)"
done
git -C "$root" rev-parse --verify -q HEAD >/dev/null || skip "there is no repository"

mkdir -p "$1"
folder=$(cd "$1" && pwd)
rm -rf "$folder/release"
if [ -d "$folder/source" ]; then  # its build tree is kept
  git -C "$folder/source" fetch -q origin HEAD
  git -C "$folder/source" checkout -q --force --detach FETCH_HEAD
else
  git clone -q "$root" "$folder/source"
fi
cd "$folder/source"
version=$(sed -n 's/^project(plenoflame VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
git tag --force "v$version" >/dev/null
said=$(tools/release.sh --no-setup "$folder/release" 2>&1) || { echo "$said"; exit 1; }
echo "$said"
if grep -q "a trial" <<<"$said"; then
  echo "release_test.sh: a tagged commit is called a trial" >&2
  exit 1
fi
cd "$folder/release"
sha256sum --check --quiet SHA256SUMS
[ "$(wc -l <SHA256SUMS)" -eq "$(find . -name '*.deb' -o -name '*.tar.xz' | wc -l)" ]
# Something that nobody built is noticed.
echo >>"plenoflame-$version.tar.xz"
if sha256sum --check --status SHA256SUMS; then
  echo "release_test.sh: the checksums do not notice a changed file" >&2
  exit 1
fi
