#!/bin/bash
# Measures error against run time of the examples and writes docs/benchmarks.md.
#
#   tools/make_benchmarks.sh [COMMAND]     COMMAND: the plenoflame to measure; without, it is built
#
# Wants a machine that does nothing else. Results are kept in out/benchmarks; to compare with them
# later: plenoflame bench ... --compare out/benchmarks/NAME.json
set -euo pipefail
cd "$(dirname "$0")/.."

command=${1:-}
if [ -z "$command" ]; then
  cmake --preset release >/dev/null
  cmake --build --preset release --target plenoflame_command
  command=build/release/app/cli/plenoflame
fi

results=()
measure() { # NAME OPTION ...
  local name=$1
  shift
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
"$command" flame layered -o out/benchmarks/layered.vdb --voxel-size "0.234 mm"
sed 's|^preset = "paper-layered"|kind = "vdb"\nfile = "layered.vdb"|' examples/paper-flame-1m.toml \
  >out/benchmarks/paper-flame-1m-grid.toml
rm -f out/benchmarks/whole-*.json
whole "closed form, 16 samples, 1 thread" examples/paper-flame-1m.toml --samples 16 --threads 1
whole "closed form, 64 samples, 1 thread" examples/paper-flame-1m.toml --samples 64 --threads 1
whole "closed form, 64 samples, 2 threads" examples/paper-flame-1m.toml --samples 64 --threads 2
whole "closed form, to 1 %, 2 threads" examples/paper-flame-1m.toml --target-error 1% --threads 2
whole "closed form, 64 samples, no skipping, 2 threads" examples/paper-flame-1m.toml --samples 64 --threads 2 --no-skip
whole "grid, 16 samples, 1 thread" out/benchmarks/paper-flame-1m-grid.toml --samples 16 --threads 1
whole "grid, to 3 %, 2 threads" out/benchmarks/paper-flame-1m-grid.toml --target-error 3% --threads 2
python3 tools/benchmark_page.py "${results[@]}"
echo "written: docs/benchmarks.md"
