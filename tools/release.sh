#!/bin/bash
# Makes the packages of a release, checks them and writes their checksums.
#
#   tools/release.sh [--no-install-test] [--no-setup] [FOLDER]
#
# FOLDER (default: out/release) receives the .deb files, the relocatable archive and the sources as .tar.xz, and SHA256SUMS. Sources and packages are
# those of the tag v<version> if HEAD has it, otherwise of HEAD, and then it says so. --no-install-test leaves out
# tests/packages/run.sh, which installs the packages into a fresh Debian 12 (some minutes, and the package registry).
set -euo pipefail
cd "$(dirname "$0")/.."

install_test=yes
setup=yes
folder=out/release
for argument in "$@"; do
  case "$argument" in
    --no-install-test) install_test=no ;;
    --no-setup) setup=no ;;
    -h | --help) sed -n '2,9s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) echo "release.sh: unknown option $argument (see --help)" >&2; exit 2 ;;
    *) folder=$argument ;;
  esac
done

say() { printf '\n=== %s (%d s)\n' "$1" "$SECONDS"; }

version=$(sed -n 's/^project(plenoflame VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
if ! git rev-parse --verify -q HEAD >/dev/null 2>&1; then
  echo "release.sh: a release is made of commits, and this folder is no git repository that has some, or there is no git" >&2
  exit 1
fi
if ! git diff --quiet HEAD --; then
  echo "release.sh: there are changes that are not committed; a release is made of commits" >&2
  exit 1
fi
git describe --tags --exact-match --match "v$version" HEAD >/dev/null 2>&1 ||
  echo "release.sh: HEAD has no tag v$version: these packages are a trial" >&2

if [ "$setup" = yes ]; then
  say "packages"
  tools/setup.sh package || exit 1
fi

say "build"
mkdir -p build/logs "$folder"
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
{
  cmake --preset package -S . -DPLENOFLAME_COMPILE_TOGETHER=ON && cmake --build --preset package -j "${PLENOFLAME_JOBS:-$(nproc)}"
} >build/logs/package.log 2>&1 || {
  tail -n 50 build/logs/package.log
  echo "release.sh: the build failed; all of its output is in build/logs/package.log" >&2
  exit 1
}

say "Debian packages"
rm -f build/package/*.deb
(cd build/package && cpack >../logs/cpack.log 2>&1) || {
  tail -n 50 build/logs/cpack.log
  exit 1
}
rm -f "$folder"/*.deb "$folder"/*.tar.xz "$folder"/SHA256SUMS
cp build/package/*.deb "$folder"
git archive --format=tar --prefix="plenoflame-$version/" HEAD | xz -9 >"$folder/plenoflame-$version.tar.xz"

say "relocatable archive"
tools/archive.sh build/package "$folder"

say "lintian"
lintian --fail-on error --tag-display-limit 0 "$folder"/*.deb

if [ "$install_test" = yes ]; then
  say "installed into a fresh Debian 12"
  tests/packages/run.sh "$folder"
  tests/packages/archive.sh "$folder"/*-linux-*.tar.xz
fi

(cd "$folder" && sha256sum -- *.deb *.tar.xz >SHA256SUMS)
say "done"
cat "$folder/SHA256SUMS"
