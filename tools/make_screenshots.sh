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
  xvfb-run -a -s "-noreset -screen 0 1800x1100x24" "$desktop" --size 1500x900 "$@" --screenshot "$folder/$name.png"
  convert "$folder/$name.png" -strip -colors 255 "PNG8:docs/images/$name.png"
  echo "docs/images/$name.png"
}

shot desktop-welcome
shot desktop-pixel examples/paper-flame-1m.toml --pixel 1500,1500 --panel Rays
shot desktop-array examples/lenslets-30.toml --pixel 150,150 --part array --panel Rendering --dark
shot desktop-refocus examples/paper-previous-60x60.toml --depth "1 m" --panel Design
