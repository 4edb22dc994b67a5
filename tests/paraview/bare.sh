#!/bin/bash
# Runs a script in the ParaView of a minimal Debian 12, with the plugin that was built here: Debian does not install ParaView beside the
# VTK of the build.
#
#   tests/paraview/bare.sh BUILD SCRIPT      BUILD: such as build/release
#
# The system stays in the cache (tests/bare/debian.sh). Ends with 77, which skips the test, where there is no root, mmdebstrap or overlay.
# PICTURE names the file that SCRIPT writes, below BUILD.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
tree=$(cd "$here/../.." && pwd)
build=$(realpath "$1")
. "$here/../bare/debian.sh"
skip() { echo "skipped: $1"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "a bare Debian is made by root"
command -v mmdebstrap >/dev/null || skip "there is no mmdebstrap (tools/setup.sh tests)"
has_overlays || skip "no overlay can be mounted in $cache"
bare_debian

root=$(mktemp -d "$cache/run.XXXXXX")
shared=()
leave() {
  local each
  for each in "${shared[@]}"; do umount --lazy "$root/system$each"; done
  shared=()
  close_debian "$root"
}
trap 'leave; rm -rf --one-file-system "$root"' EXIT
trap 'exit 1' INT TERM
enter() {  # LAYER...: with sources and build in their places
  local each
  open_debian "$root" "$cache/debian" "$@"
  for each in "$tree" "$build"; do
    mkdir -p "$root/system$each"
    mount --bind "$each" "$root/system$each" && shared=("$each" "${shared[@]}")
  done
}

layer=$cache/paraview-$("$tree/tools/setup.sh" --list python | sha256sum | cut -c1-16)
if [ ! -d "$layer" ]; then
  enter
  in_debian "$root" bash -c "'$tree/tools/setup.sh' python && apt-get -qq install -y --no-install-recommends paraview python3-paraview" >/dev/null
  leave
  rm -rf "$cache/paraview-"*
  mv "$root/written" "$layer"
  rm -rf --one-file-system "$root/work"
fi
enter "$layer"
in_debian "$root" env PLENOFLAME_PLUGIN="$build/paraview/Plenoflame.py" PLENOFLAME_COMMAND="$build/app/cli/plenoflame" PLENOFLAME_ROOT="$tree" \
  PICTURE="${PICTURE:-}" xvfb-run -a -s "-noreset -screen 0 1920x1080x24" "$build/paraview/plenoflame-paraview" --pvpython "$(realpath "$2")"
