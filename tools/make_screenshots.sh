#!/bin/bash
# Makes the pictures of docs/desktop.md: docs/images/desktop-*.png, of the desktop application as it starts.
#
#   tools/make_screenshots.sh [NAME ...]    only these; without any, all
#
# DESKTOP names the program, build/release/app/desktop/plenoflame-desktop unless set. Without a display it draws on
# one of xvfb-run. desktop-reconstruct.png is what the test `desktop_gui_test reconstruct` leaves in the folder PLENOFLAME_TOUR. Packages: tools/setup.sh desktop vtk dev
set -euo pipefail
cd "$(dirname "$0")/.."
desktop=${DESKTOP:-build/release/app/desktop/plenoflame-desktop}
[ -x "$desktop" ] || {
  echo "make_screenshots.sh: $desktop is missing: cmake --preset release && cmake --build --preset release" >&2
  exit 1
}
wanted=" $* "
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

shot() { # NAME [options and file]
  local name=$1
  shift
  [ "$wanted" = "  " ] || [[ "$wanted" == *" $name "* ]] || return 0
  xvfb-run -a -s "-noreset -screen 0 2560x1440x24" "$desktop" "$@" --screenshot "$folder/$name.png"
  convert "$folder/$name.png" -strip -define png:compression-level=9 "docs/images/$name.png"
  echo "docs/images/$name.png"
}

shot desktop-welcome --size 1366x768
shot desktop-pixel examples/paper-flame-1m.toml --size 1920x1080 --pixel 1500,1500 --panel Rays --dark
shot desktop-array examples/lenslets-30.toml --size 1366x768 --pixel 150,150 --part array --panel Rendering --dark
shot desktop-refocus examples/paper-flame-1m.toml --size 1366x768 --depth "1 m" --panel Design --part flame
shot desktop-small examples/lenslets-30.toml --size 1366x768 --pixel 150,150 --panel Rays --part flame --dark
if [ -f examples/candle.vdb ]; then
  shot desktop-medium examples/candle.toml --size 1920x1080 --panel Flame --part flame
else
  echo "make_screenshots.sh: desktop-medium was left out: plenoflame flame candle -o examples/candle.vdb" >&2
fi
shot desktop-camera examples/lenslets-30.toml --size 1920x1080 --part camera --dark
shot desktop-small-light examples/three-cameras.toml --size 1366x768
export QT_SCALE_FACTOR=2
shot desktop-large examples/lenslets-30.toml --size 1280x720 --part flame --dark
shot desktop-large-light examples/three-cameras.toml --size 1280x720 --part flame
