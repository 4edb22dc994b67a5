#!/bin/bash
# Makes the relocatable archive of a release: command, desktop application and Python package with the libraries that they need.
#
#   tools/archive.sh [BUILD [FOLDER]]
#
# BUILD is a build tree with PLENOFLAME_PACKAGES (default: build/package); FOLDER (default: out/release) receives
# plenoflame-VERSION-linux-x86_64.tar.xz. All paths in it are relative to its folder. Packages: tools/setup.sh package
set -euo pipefail
[ $# -le 2 ] || { sed -n '4s/^# *//p' "$0" >&2; exit 2; }
root=$(cd "$(dirname "$0")/.." && pwd)
build=$(realpath "${1:-$root/build/package}")
folder=$(realpath -m "${2:-$root/out/release}")
command -v patchelf >/dev/null || { echo "archive.sh: patchelf is missing: tools/setup.sh package" >&2; exit 1; }
version=$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$build/CMakeCache.txt")
name=plenoflame-$version-linux-$(uname -m)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tree=$work/$name

for component in cli vtk desktop python doc archive; do
  cmake --install "$build" --prefix "$tree" --strip --component "$component" >/dev/null
done
# Every file finds the libraries beside it, whatever the environment says.
libraries=$(dirname "$(dirname "$(find "$tree" -name libplenoflame_vtk_commands.so)")")
while read -r file; do
  patchelf --force-rpath --set-rpath "\$ORIGIN/$(realpath --relative-to "$(dirname "$file")" "$libraries")" "$file"
done < <(find "$tree" -type f \( -name '*.so*' -o -path '*/bin/plenoflame*' \))
ln -s "$(realpath --relative-to "$tree" "$(dirname "$(dirname "$(find "$tree" -name '_core*.so')")")")" "$tree/python"
# The terms of the libraries that come along.
mapfile -t files < <(find "$libraries" -name '*.so*' -printf "/usr/lib/$(uname -m)-linux-gnu/%f\n/lib/$(uname -m)-linux-gnu/%f\n")
for package in $(dpkg-query -S "${files[@]}" 2>/dev/null | sed 's/[:,].*//' | sort -u); do
  install -D -m 644 "/usr/share/doc/$package/copyright" "$tree/share/doc/plenoflame/licenses/$package"
done

mkdir -p "$folder"
tar -C "$work" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@${SOURCE_DATE_EPOCH:-$(date +%s)}" -c "$name" |
  xz -T0 -6 >"$folder/$name.tar.xz"
echo "$folder/$name.tar.xz"
