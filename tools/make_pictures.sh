#!/bin/bash
# Makes the pictures of docs/gallery.md: docs/images/*.png from the example scenes.
#
#   tools/make_pictures.sh [NAME ...]    only these scenes; without any, all
#
# PLENOFLAME names the command, build/release/app/cli/plenoflame unless set; SAMPLES the rays per pixel and
# microlens (64). The light fields stay in out/. Packages: tools/setup.sh dev
set -euo pipefail
cd "$(dirname "$0")/.."
plenoflame=${PLENOFLAME:-build/release/app/cli/plenoflame}
samples=${SAMPLES:-64}
[ -x "$plenoflame" ] || {
  echo "make_pictures.sh: $plenoflame is missing: cmake --preset release && cmake --build --preset release" >&2
  exit 1
}
command -v convert >/dev/null || {
  echo "make_pictures.sh: convert is missing: tools/setup.sh dev" >&2
  exit 1
}
wanted=" $* "
size=600 # of a panel
zoom=6   # picture pixels per sensor pixel in the last panel
shades=96 # of a picture, so that its file stays below 400 kB
mkdir -p out docs/images

chosen() { [ "$wanted" = "  " ] || [[ "$wanted" == *" $1 "* ]]; }

render() { # SCENE: out/SCENE.exr and .png
  "$plenoflame" render "examples/$1.toml" --samples "$samples" -o "out/$1.exr"
  "$plenoflame" develop "out/$1.exr" -o "out/$1.png"
}

# panel SCENE SIDE X,Y PERCENT: the square of SIDE pixels around X,Y (parts of the sensor's width and
# height), each pixel enlarged as a square; into out/panel-PERCENT.png
panel() {
  local picture=out/$1.png side=$2 x=${3%,*} y=${3#*,} width height left top
  read -r width height < <(identify -format '%w %h\n' "$picture")
  left=$(awk -v p="$x" -v n="$width" -v s="$side" 'BEGIN {printf "%d", p * n - s / 2}')
  top=$(awk -v p="$y" -v n="$height" -v s="$side" 'BEGIN {printf "%d", p * n - s / 2}')
  convert "$picture" -crop "${side}x$side+$left+$top" +repage -filter point -resize "$4%" "out/panel-$4.png"
}

join() { # SCENE PANEL ...
  local name=$1
  shift
  convert "$@" -background gray30 -gravity center +smush 8 +dither -colors "$shades" -strip "PNG8:docs/images/$name.png"
  echo "docs/images/$name.png"
}

# picture SCENE X,Y: the whole sensor, reduced; a detail pixel by pixel; its middle enlarged
picture() {
  chosen "$1" || return 0
  render "$1"
  convert "out/$1.png" -resize "x$size" out/panel-whole.png
  panel "$1" "$size" "$2" 100
  panel "$1" $((size / zoom)) "$2" $((100 * zoom))
  join "$1" out/panel-whole.png out/panel-100.png "out/panel-$((100 * zoom)).png"
}

if chosen overview; then PLENOFLAME=$plenoflame tools/make_overview.py; fi
if chosen planes; then PLENOFLAME=$plenoflame tools/draw_light_field.py; fi
if chosen reconstruction; then PLENOFLAME=$plenoflame tools/draw_reconstruction.py; fi
if chosen cameras; then PLENOFLAME=$plenoflame tools/draw_cameras.py; fi # minutes
if chosen error-time; then PLENOFLAME=$plenoflame tools/draw_error_time.py; fi # from docs/benchmarks.md
if chosen calibration; then PLENOFLAME=$plenoflame tools/draw_calibration.py; fi # needs the flame of the overview
if chosen calibration-steps; then PLENOFLAME=$plenoflame tools/draw_calibration_steps.py; fi
picture paper-flame-1m 0.53,0.5
if chosen candle; then "$plenoflame" flame candle -o examples/candle.vdb; fi
picture candle 0.57,0.5

if chosen candle-temperature; then PLENOFLAME=$plenoflame tools/draw_temperature.py; fi
for name in film filters tube shapes depth; do # of how-to pages; film: minutes
  if chosen "$name"; then PLENOFLAME=$plenoflame tools/draw_examples.py "$name"; fi
done
if chosen theory; then tools/theory_drawings.py; fi
if chosen pipeline; then tools/pipeline_drawing.py; fi

# The candle with its blue base in colour, in the light of CH* and in that of soot.
if chosen candle-blue; then
  "$plenoflame" flame candle --line "ch=10 kW/m^3" --line "c2_517=5 kW/m^3" -o examples/candle-blue.vdb
  "$plenoflame" render examples/candle-blue.toml --samples "$samples" -o out/candle-blue.exr
  "$plenoflame" develop out/candle-blue.exr --colour -o out/candle-blue.png
  for channel in CH soot; do
    "$plenoflame" develop out/candle-blue.exr --channel "$channel" -o "out/candle-$channel.png"
  done
  for name in blue CH soot; do
    convert "out/candle-$name.png" -filter point -resize 200% "out/candle-$name.png"
  done
  join candle-blue out/candle-blue.png out/candle-CH.png out/candle-soot.png
fi

# The raw picture of the tutorial, and views of it.
if chosen tutorial; then
  "$plenoflame" flame candle -o examples/candle.vdb
  render tutorial
  rm -rf out/tutorial-views
  "$plenoflame" views out/tutorial.exr --grid 3 -o out/tutorial-views
  convert out/tutorial.png -filter point -resize 300% out/panel-raw.png
  convert out/tutorial-views/contact.png -filter point -resize "x$(identify -format %h out/panel-raw.png)" out/panel-views.png
  join tutorial out/panel-raw.png out/panel-views.png
  PLENOFLAME=$plenoflame tools/draw_tutorial.py
fi

# A sensor of 600 x 600 pixels: whole, and a part of it enlarged; then what becomes of it.
if chosen paper-previous-60x60; then
  render paper-previous-60x60
  panel paper-previous-60x60 $((size / zoom)) 0.5,0.5 $((100 * zoom))
  join paper-previous-60x60 out/paper-previous-60x60.png "out/panel-$((100 * zoom)).png"
  rm -rf out/views
  "$plenoflame" views out/paper-previous-60x60.exr -o out/views --grid 9 --epipolar-row 30
  convert out/views/epipolar_row.png -filter point -resize '1000%' -depth 8 -strip docs/images/epipolar.png
  echo "docs/images/epipolar.png"
fi

# Pictures in 3-D (docs/scripting.md, docs/rays.md), and what the Python examples plot.
if chosen lenslets-30; then
  scene=examples/lenslets-30.toml
  "$plenoflame" render "$scene" --samples 64 -o out/lenslets-30.exr
  draw() { xvfb-run -a "$plenoflame" picture "$scene" "$@"; }
  draw --view array --image out/lenslets-30.exr --pixel 150,150 --rays 16 --no-axes --size 1200x640 -o out/picture-array.png
  mogrify -crop 1200x590+0+0 +repage out/picture-array.png # without the legend, which the rays meet
  join picture-array out/picture-array.png
  xvfb-run -a "$plenoflame" picture examples/paper-objects-5m.toml --view flame -o docs/images/picture-objects.png
  build=$(cd "$(dirname "$plenoflame")/../.." && pwd)
  packages=$(find "$build/lib" -type d -path '*/python3/dist-packages')
  for example in render_and_plot rays_over_lens; do
    PYTHONPATH=$packages /usr/bin/python3 "examples/python/$example.py" "$scene" out
  done
  cp out/render.png docs/images/scripting-render.png
  cp out/rays.png docs/images/scripting-rays.png
fi

# ParaView (docs/user/paraview.md), in a minimal Debian.
if chosen paraview; then
  build=$(cd "$(dirname "$plenoflame")/../.." && pwd)
  picture=$build/paraview.png
  PICTURE=$picture tests/paraview/bare.sh "$build" tools/draw_paraview.py
  convert "$picture" -strip +dither -colors 255 PNG8:docs/images/paraview.png
  rm "$picture"
  echo docs/images/paraview.png
fi

# Setups with shortened distances (docs/scripting.md, docs/user/cameras.md); they need the flame of the overview.
if chosen setups; then PLENOFLAME=$plenoflame xvfb-run -a tools/draw_setups.py; fi

# The paper's objects through three cameras, side by side.
if chosen paper-objects-5m; then
  for scene in paper-objects-5m-no-array paper-objects-5m-60x60 paper-objects-5m; do
    render "$scene"
    convert "out/$scene.png" -resize "x$size" "out/panel-$scene.png"
  done
  join paper-objects-5m out/panel-paper-objects-5m-no-array.png out/panel-paper-objects-5m-60x60.png \
    out/panel-paper-objects-5m.png
fi
picture paper-objects-r29 0.5,0.5
if chosen paper-objects-r29; then # views and planes of docs/light-fields.md
  raw=out/paper-objects-r29.exr
  rm -rf out/objects-views out/objects-planes out/objects-depth
  "$plenoflame" views "$raw" -o out/objects-views --grid 3
  convert out/objects-views/contact.png -filter point -resize 300% -depth 8 -strip docs/images/objects-views.png
  "$plenoflame" refocus "$raw" -o out/objects-planes --depths 1.3m:1.5m:2 --size 250
  convert out/objects-planes/*.png -filter point -resize 200% -background gray30 +smush 8 -depth 8 -strip \
    docs/images/objects-refocus.png
  echo "docs/images/objects-views.png docs/images/objects-refocus.png"
fi
if chosen burner; then "$plenoflame" flame candle -o examples/candle.vdb; fi
picture burner 0.5,0.45
if chosen smoke; then
  "$plenoflame" render examples/smoke.toml --samples $((8 * samples)) -o out/smoke.exr
  "$plenoflame" develop out/smoke.exr -o out/smoke.png
  rm -rf out/smoke-planes
  "$plenoflame" refocus out/smoke.exr -o out/smoke-planes --depths 1m:1.03m:2 --size 200
  convert out/smoke.png -filter point -resize 200% out/panel-smoke.png
  convert out/smoke-planes/*.png -filter point -resize x600 -background gray30 +smush 8 out/panel-planes.png
  join smoke out/panel-smoke.png out/panel-planes.png
fi
shades=48 picture calibration-plate 0.3,0.3

# The plots of docs/design.md and docs/user/lenses.md, made by their commands.
if chosen design; then
  "$plenoflame" design examples/paper-flame-1m.toml --solve index --plots out/design >/dev/null 2>&1
  printf '[camera.lens]\npreset = "double-gauss-100mm"\n' >out/lens.toml
  "$plenoflame" design out/lens.toml --field "14 deg" --plots out/design >/dev/null
  for plot in resolution microlens lens-spots lens-fields; do
    convert "out/design/$plot.png" -resize '1400x>' -depth 8 -strip "docs/images/design-$plot.png"
    echo "docs/images/design-$plot.png"
  done
fi

# The pictures of docs/desktop.md are made where the desktop application was built.
if chosen desktop && [ -x build/release/app/desktop/plenoflame-desktop ]; then tools/make_screenshots.sh; fi
