#!/bin/bash
# Measures error against run time of the examples and writes docs/benchmarks.md.
#
#   tools/make_benchmarks.sh [COMMAND]     COMMAND: the plenoflame to measure; without, it is built
#
# PARTS="lenslets-30 paper-flame-1m whole skipping colour memory" says what to measure, all of it unless set; PARTS=native
# builds once more with the compiler's options in NATIVE, which nothing that is shipped has, and compares. The other sections of the page stay as they are. Wants a machine that does nothing else (but for memory). Results are kept in out/benchmarks; to compare with them
# later: plenoflame bench ... --compare out/benchmarks/NAME.json
set -euo pipefail
cd "$(dirname "$0")/.."

command=${1:-}
if [ -z "$command" ]; then
  cmake --preset release >/dev/null
  cmake --build --preset release --target plenoflame_command
  command=build/release/app/cli/plenoflame
fi

parts=" ${PARTS:-lenslets-30 paper-flame-1m whole skipping colour memory} "
wanted() { [[ "$parts" == *" $1 "* ]]; }

results=()
measure() { # NAME OPTION ...
  local name=$1
  shift
  wanted "$name" || return 0
  "$command" bench "examples/$name.toml" -o "out/benchmarks/$name" "$@"
  cp "out/benchmarks/$name.png" "docs/images/benchmark-$name.png"
  results+=("out/benchmarks/$name.json")
}
mkdir -p out/benchmarks docs/images
measure lenslets-30 --samples 4,16,64,256,1024 --bundles 1e5,4e5,1.6e6 --reference-samples 16384 --repeat 5
# The middle of the flame. The forward estimator must light the whole image to light these pixels.
measure paper-flame-1m --window 1400,1400,200,200 --samples 4,16,64,256,1024 --bundles 1e6,4e6 \
  --reference-samples 16384 --repeat 5
# Whole images, one thread and all: NAME SCENE OPTION ... (three runs, the page takes the median)
whole() {
  local name=$1 scene=$2
  shift 2
  for run in 1 2 3; do
    "$command" render "$scene" -o out/benchmarks/whole.exr --seed "$run" --quiet \
      --stats "out/benchmarks/whole-$name-$run.json" "$@"
  done
}
if wanted whole; then
  rm -f out/benchmarks/whole-*.json
  "$command" flame layered -o out/benchmarks/layered.vdb --voxel-size "0.234 mm"
  sed 's|^preset = "paper-layered"|kind = "vdb"\nfile = "layered.vdb"|' examples/paper-flame-1m.toml \
    >out/benchmarks/paper-flame-1m-grid.toml
  whole "closed form, 16 samples, 1 thread" examples/paper-flame-1m.toml --samples 16 --threads 1
  whole "closed form, 64 samples, 1 thread" examples/paper-flame-1m.toml --samples 64 --threads 1
  whole "closed form, 64 samples, 2 threads" examples/paper-flame-1m.toml --samples 64 --threads 2
  whole "closed form, 256 samples, 1 thread" examples/paper-flame-1m.toml --samples 256 --threads 1
  whole "closed form, 256 samples, 2 threads" examples/paper-flame-1m.toml --samples 256 --threads 2
  whole "lenslets-30 (300 x 300 pixels), to 1 %, 1 thread" examples/lenslets-30.toml --target-error 1% --threads 1
  whole "lenslets-30 (300 x 300 pixels), to 1 %, 2 threads" examples/lenslets-30.toml --target-error 1% --threads 2
  whole "closed form, to 1 %, 2 threads" examples/paper-flame-1m.toml --target-error 1% --threads 2
  whole "closed form, 64 samples, no skipping, 2 threads" examples/paper-flame-1m.toml --samples 64 --threads 2 --no-skip
  whole "grid, 16 samples, 1 thread" out/benchmarks/paper-flame-1m-grid.toml --samples 16 --threads 1
  whole "grid, 16 samples, every ray integrated, 1 thread" out/benchmarks/paper-flame-1m-grid.toml --samples 16 --threads 1 --no-control-variate
  whole "grid, to 1 %, 2 threads" out/benchmarks/paper-flame-1m-grid.toml --target-error 1% --threads 2
fi
# Gain of skipping: each scene with and without, NAME SCENE SAMPLES OPTION ...
skipping() {
  local name=$1 scene=$2 samples=$3
  shift 3
  for run in 1 2 3; do
    "$command" render "$scene" -o out/benchmarks/skipped.exr --seed "$run" --quiet --samples "$samples" --threads 1 \
      --stats "out/benchmarks/skipping-$name-with-$run.json" "$@"
    "$command" render "$scene" -o out/benchmarks/all.exr --seed "$run" --quiet --samples "$samples" --threads 1 --no-skip \
      --stats "out/benchmarks/skipping-$name-without-$run.json" "$@"
    "$command" compare out/benchmarks/skipped.exr out/benchmarks/all.exr --json \
      >"out/benchmarks/skipping-$name-difference-$run.json"
  done
}
if wanted skipping; then
  rm -f out/benchmarks/skipping-*.json
  camera='camera.preset = "paper-plenoptic2"
camera.focus = { mode = "best", object_distance = "1 m", conjugate = "type2" }'
  for radius in 3 60; do
    cat >"out/benchmarks/sphere-$radius.toml" <<END
$camera
[[flames]]
kind = "layered"
position = ["1 m", "0 m", "0 m"]
[[flames.layers]]
semi_axes = ["$radius mm", "$radius mm", "$radius mm"]
temperature = "1800 K"
absorption = "20 1/m"
END
  done
  # The same without the blur of the main lens: what sees the sphere is what it fills.
  for radius in 3 60; do
    sed 's|^camera.focus|camera.lens.model = "ideal"\n&|' "out/benchmarks/sphere-$radius.toml" \
      >"out/benchmarks/sphere-$radius-ideal.toml"
  done
  for samples in 16 256; do
    skipping "beams: a sphere that fills 0.8 % of the sensor, ideal lens, $samples samples" out/benchmarks/sphere-3-ideal.toml $samples
    skipping "beams: a sphere that fills all of the sensor, ideal lens, $samples samples" out/benchmarks/sphere-60-ideal.toml $samples
    skipping "beams: a sphere that fills 0.8 % of the sensor, $samples samples" out/benchmarks/sphere-3.toml $samples
    skipping "beams: a sphere that fills all of the sensor, $samples samples" out/benchmarks/sphere-60.toml $samples
  done
  "$command" flame candle -o out/benchmarks/candle.vdb --voxel-size "0.25 mm"
  "$command" flame layered -o out/benchmarks/layered.vdb --voxel-size "0.234 mm"
  "$command" flame cylinder -o out/benchmarks/cylinder.vdb --voxel-size "2 mm"
  for flame in candle layered cylinder; do
    printf '%s\n[[flames]]\nkind = "vdb"\nfile = "%s.vdb"\nposition = ["1 m", "0 m", "-29 mm"]\n' \
      "$camera" "$flame" >"out/benchmarks/$flame.toml"
  done
  # A thousand times as much soot: black from outside.
  printf 'absorption.scale = 1000.0\n' >>out/benchmarks/cylinder.toml
  skipping "empty bricks: candle, every ray integrated" out/benchmarks/candle.toml 16 \
    --no-control-variate --window 1300,1300,400,400
  skipping "constant bricks: layers as a grid, every ray integrated" out/benchmarks/layered.toml 16 \
    --no-control-variate --window 1300,1300,400,400
  skipping "opaque tails: sooty cylinder, every ray integrated" out/benchmarks/cylinder.toml 16 \
    --no-control-variate --window 1300,1300,400,400
fi
# Cost of colours: the scenes in turn, five times.
if wanted colour; then
  rm -f out/benchmarks/colour-*.json
  folder=out/benchmarks
  sed '/^\[\[channels\]\]/,/^kind = /d' examples/paper-flame-1m.toml >$folder/no-channels.toml
  band() { printf '[[channels]]\nname = "%snm"\nkind = "band"\nwavelength = "%s nm"\nwidth = "10 nm"\n' "$1" "$1"; }
  named() { printf '[[channels]]\nname = "%s"\nkind = "named"\nresponse = "%s"\n' "$1" "$1"; }
  xyz() { named cie_x; named cie_y; named cie_z; }
  rgb() { named nikon_d5100_red; named nikon_d5100_green; named nikon_d5100_blue; }
  soot() { sed 's|^preset = "paper-layered"|&\nspectrum = { kind = "soot", reference = "650 nm" }|' $folder/no-channels.toml; }
  flint() {
    cat $folder/no-channels.toml
    for radius in 300 -300; do
      printf '[[camera.lens.surfaces]]\nradius = "%s mm"\ndiameter = "120 mm"\n' $radius
      if [ $radius = 300 ]; then printf 'thickness = "24.26 mm"\nglass = "N-BK7"\n'; else printf 'thickness = "0 mm"\nindex = 1\n'; fi
    done
    printf '[[camera.lens.surfaces]]\nradius = "inf"\nindex = 1\ndiameter = "100 mm"\nstop = true\n'
  }
  "$command" flame candle -o $folder/candle.vdb --voxel-size "0.25 mm"
  candle() {
    sed 's|^preset = "paper-layered"|kind = "vdb"\nfile = "candle.vdb"\nspectrum = { kind = "soot", reference = "650 nm" }|' \
      $folder/no-channels.toml
  }
  { cat $folder/no-channels.toml; band 650; } >$folder/mono.toml
  { cat $folder/no-channels.toml; band 450; band 550; band 650; } >$folder/three.toml
  { cat $folder/no-channels.toml; xyz; } >$folder/xyz.toml
  { soot; band 650; } >$folder/soot-mono.toml
  { soot; rgb; } >$folder/soot-rgb.toml
  { soot; xyz; } >$folder/soot-xyz.toml
  { candle; band 650; } >$folder/candle-mono.toml
  { candle; rgb; } >$folder/candle-rgb.toml
  { candle; xyz; } >$folder/candle-xyz.toml
  { flint; band 650; } >$folder/glass-mono.toml
  { flint; band 450; band 550; band 650; } >$folder/glass-three.toml
  for run in 1 2 3 4 5; do
    for scene in mono three xyz soot-mono soot-rgb soot-xyz candle-mono candle-rgb candle-xyz glass-mono glass-three; do
      "$command" render $folder/$scene.toml -o $folder/colour.exr --seed $run --quiet --threads 1 --window 1000,1000,1000,1000 \
        --stats "$folder/colour-$scene-$run.json"
    done
  done
fi
# Largest resident memory of a process of its own: NAME SCENE SAMPLES
memory() {
  "$command" render "$2" -o out/benchmarks/whole.exr --samples "$3" --quiet \
    --stats "out/benchmarks/memory-$1, $3 samples.json"
}
if wanted memory; then
  rm -f out/benchmarks/memory-*.json
  cat >out/benchmarks/raytrix-r29.toml <<'END'
camera.preset = "raytrix-r29"
camera.focus = { mode = "best", object_distance = "1 m", conjugate = "array" }
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
END
  memory "paper-flame-1m, 3000 x 3000 pixels" examples/paper-flame-1m.toml 2
  memory "paper-flame-1m, 3000 x 3000 pixels" examples/paper-flame-1m.toml 16
  memory "preset raytrix-r29 with that flame, 6576 x 4384 pixels" out/benchmarks/raytrix-r29.toml 2
  memory "preset raytrix-r29 with that flame, 6576 x 4384 pixels" out/benchmarks/raytrix-r29.toml 16
fi
# A build for this processor alone against the one that chooses among instruction sets as it starts, in turn.
native() { # NAME SCENE OPTION ...
  local name=$1 scene=$2
  shift 2
  for run in 1 2 3; do
    for kind in chosen native; do
      local program=$command
      if [ $kind = native ]; then program=build/native/app/cli/plenoflame; fi
      "$program" render "$scene" -o out/benchmarks/native.exr --seed "$run" --quiet --threads 1 \
        --stats "out/benchmarks/native-$name-$kind-$run.json" "$@"
    done
  done
}
if wanted native; then
  rm -f out/benchmarks/native-*.json
  cmake -S . -B build/native -G Ninja -DCMAKE_BUILD_TYPE=Release -DPLENOFLAME_WITH_VTK=OFF -DPLENOFLAME_WITH_DESKTOP=OFF \
    -DCMAKE_CXX_FLAGS="${NATIVE:?what makes the compiler build for this very processor}" >/dev/null
  cmake --build build/native --target plenoflame_command
  "$command" flame candle -o out/benchmarks/native-candle.vdb --voxel-size "0.25 mm"
  sed 's|^preset = "paper-layered"|kind = "vdb"\nfile = "native-candle.vdb"|' examples/paper-flame-1m.toml >out/benchmarks/native-candle.toml
  for samples in 16 64 256; do
    native "paper-flame-1m, $samples samples" examples/paper-flame-1m.toml --samples $samples
  done
  native "the same with a candle of voxels, 64 samples, 1000 x 1000 pixels" out/benchmarks/native-candle.toml --samples 64 --window 1000,1000,1000,1000
fi
# Only what was measured now, all of it: of a run that was interrupted something may be left.
python3 tools/benchmark_page.py out/benchmarks "$parts" "${results[@]}"
echo "written: docs/benchmarks.md"
