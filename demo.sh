#!/bin/bash
# Installs what is missing, builds Plenoflame and renders the paper's flame and a candle into out/.
#
#   ./demo.sh [--no-setup]    --no-setup installs nothing (for machines without apt-get)
set -euo pipefail
cd "$(dirname "$0")"

setup=yes
for argument in "$@"; do
  case "$argument" in
    --no-setup) setup=no ;;
    -h | --help) sed -n '2,4s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "demo.sh: unknown option $argument (see --help)" >&2; exit 2 ;;
  esac
done

say() { printf '\n=== %s\n' "$1"; }

if [ "$setup" = yes ]; then
  say "packages"
  tools/setup.sh command || exit 1
fi

say "build"
mkdir -p build/logs out
{
  cmake --preset command && cmake --build --preset command -j "${PLENOFLAME_JOBS:-$(nproc)}"
} >build/logs/demo.log 2>&1 || {
  tail -n 50 build/logs/demo.log
  echo "demo.sh: the build failed; all of its output is in build/logs/demo.log" >&2
  exit 1
}
plenoflame=build/command/app/cli/plenoflame

pictures=()
# picture SCENE "what it shows": renders examples/SCENE.toml and develops it for display.
picture() {
  say "$2"
  "$plenoflame" render "examples/$1.toml" -o "out/$1.exr"
  "$plenoflame" develop "out/$1.exr" -o "out/$1.png"
  pictures+=("$(printf '%-28s %s' "out/$1.png" "$2")")
}

picture paper-flame-1m "the paper's layered flame, 1 m from its multi-focus plenoptic camera"
"$plenoflame" flame candle -o examples/candle.vdb  # where examples/candle.toml expects it
picture candle "a candle flame from OpenVDB grids"

say "pictures (and beside each, as .exr, the light field in watt per pixel)"
printf '%s\n' "${pictures[@]}"
say "to go on (README.md)"
echo "export PATH=\"$PWD/build/command/app/cli:\$PATH\" && plenoflame --help"
