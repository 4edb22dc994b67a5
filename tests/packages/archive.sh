#!/bin/bash
# Unpacks the relocatable archive (tools/archive.sh) in fresh minimal Debians 12 and 13 that have none of its packages, and uses
# command, Python package and desktop application there. Wants root, mmdebstrap and the package registry.
#
#   tests/packages/archive.sh ARCHIVE [PICTURES]
#
# PICTURES receives what was drawn in the last one.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[ $# -eq 1 ] || [ $# -eq 2 ] || { sed -n '5s/^# *//p' "$0" >&2; exit 2; }
archive=$(realpath "$1")
say() { printf -- '--- %s (%d s)\n' "$1" "$SECONDS"; }
fail() { echo "archive.sh: $1" >&2; exit 1; }

. "$here/../bare/debian.sh"
root=
leave() { [ -z "$root" ] || { close_debian "$root" && rm -rf --one-file-system "$root"; }; }
trap leave EXIT
for release in debian trixie; do
  say "$release"
  leave
  bare_debian ${release#debian}
  root=$(mktemp -d "$cache/run.XXXXXX")
  open_debian "$root" "$cache/$release"
  # A folder that nobody built for, with a space.
  tar -C "$root/system/srv" -xf "$archive"
  mv "$root"/system/srv/plenoflame-* "$root/system/srv/my flames"
  in=(in_debian "$root")
  install() { "${in[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 install -y --no-install-recommends "$@" >/dev/null; }
  programs="/srv/my flames/bin"
  scene="/srv/my flames/share/plenoflame/examples/lenslets-30.toml"

  say "no library of the system but those of glibc and GCC"
  while read -r file; do
    lost=$("${in[@]}" ldd "$file" | grep -v "/srv/my flames/" |
      grep -vE 'statically linked|linux-vdso|ld-linux|/lib(c|m|dl|rt|pthread|resolv|stdc\+\+|gcc_s)\.so' || true)
    [ -z "$lost" ] || fail "$file: $lost"
  done < <(cd "$root/system" && find "srv/my flames" -type f \( -name '*.so*' -o -path '*/bin/plenoflame*' \) | sed 's|^|/|')

  say "command"
  "${in[@]}" "$programs/plenoflame" --version
  "${in[@]}" "$programs/plenoflame" render "$scene" --samples 4 --quiet -o /srv/a.exr
  "${in[@]}" "$programs/plenoflame" flame candle --voxel-size "2 mm" -o /srv/candle.vdb
  "${in[@]}" "$programs/plenoflame-desktop" --help | grep -q Usage || fail "the desktop application does not start"
  said=$("${in[@]}" "$programs/plenoflame" picture "$scene" -o /srv/a.png 2>&1) && fail "a picture without a display"
  [[ "$said" == *display* ]] || fail "a picture without a display says: $said"

  "${in[@]}" apt-get -qq update
  if [ "$release" = debian ]; then
    say "Python"
    install python3 python3-numpy
    "${in[@]}" env PYTHONPATH="/srv/my flames/python" python3 -c "
import numpy, plenoflame
flux = plenoflame.Scene('$scene').render(samples=4).flux
there = plenoflame.read_light_field('/srv/a.exr').flux
assert flux.sum() > 0 and numpy.array_equal(flux, there), 'Python renders something else'
print(plenoflame.__version__, plenoflame.__file__)"
  fi  # Debian 13 has another Python

  say "pictures, with the system's display and graphics driver"
  install xvfb xauth libgl1-mesa-dri libglx-mesa0 fonts-dejavu-core
  display=("${in[@]}" env QT_QPA_PLATFORM=xcb xvfb-run -a -s "-screen 0 1600x1000x24")
  "${display[@]}" "$programs/plenoflame" picture "$scene" -o /srv/scene.png
  "${display[@]}" "$programs/plenoflame-desktop" "$scene" --screenshot /srv/window.png
  [ -s "$root/system/srv/scene.png" ] && [ -s "$root/system/srv/window.png" ] || fail "a picture is missing"
  [ $# -lt 2 ] || { mkdir -p "$2" && cp "$root"/system/srv/*.png "$2"; }
done
say "all well"
