#!/bin/bash
# Makes the pictures of the documentation: docs/images/*.png from the example scenes.
#
#   tools/make_pictures.sh [PLENOFLAME]    default: build/release/app/cli/plenoflame
#
# The light fields stay in out/. Each picture: the whole sensor, reduced, and beside it a detail at one
# picture pixel per sensor pixel, where the micro-images can be seen. Packages: tools/setup.sh dev
set -euo pipefail
cd "$(dirname "$0")/.."
plenoflame=${1:-build/release/app/cli/plenoflame}
[ -x "$plenoflame" ] || {
  echo "make_pictures.sh: $plenoflame is missing: cmake --preset release && cmake --build --preset release" >&2
  exit 1
}
command -v convert >/dev/null || {
  echo "make_pictures.sh: convert is missing: tools/setup.sh dev" >&2
  exit 1
}
size=600
mkdir -p out docs/images

# picture SCENE DETAIL_X,DETAIL_Y: the detail's centre in parts of the sensor's width and height
picture() {
  local scene=$1 x=${2%,*} y=${2#*,} width height
  "$plenoflame" render "examples/$scene.toml" --samples 64 -o "out/$scene.exr"
  "$plenoflame" develop "out/$scene.exr" -o "out/$scene.png"
  read -r width height < <(identify -format '%w %h\n' "out/$scene.png")
  local left top
  left=$(awk -v p="$x" -v n="$width" -v s="$size" 'BEGIN {printf "%d", p * n - s / 2}')
  top=$(awk -v p="$y" -v n="$height" -v s="$size" 'BEGIN {printf "%d", p * n - s / 2}')
  convert \( "out/$scene.png" -resize "x$size" \) \
    \( "out/$scene.png" -crop "${size}x$size+$left+$top" +repage \) \
    -background black -gravity center +smush 8 -depth 8 -strip "docs/images/$scene.png"
  echo "docs/images/$scene.png"
}

picture paper-flame-1m 0.5,0.5
"$plenoflame" flame candle -o examples/candle.vdb
picture candle 0.5,0.5
