#!/bin/bash
# Makes the thumbnails of the desktop's welcome page: app/desktop/resources/thumb-*.png, a small picture of each example. Flames
# that an example reads are made first, by the commands at its head.
#
#   tools/make_thumbnails.sh [EXAMPLE ...]    only these; without any, all
#
# COMMAND names the program, build/release/app/cli/plenoflame unless set. Packages: tools/setup.sh cli dev
set -euo pipefail
cd "$(dirname "$0")/.."
command=${COMMAND:-build/release/app/cli/plenoflame}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
[ $# -gt 0 ] || set -- $(ls examples/*.toml | sed 's#.*/\(.*\)\.toml#\1#')
for name in "$@"; do
  sed -n 's/^#  *plenoflame \(flame .*\)/\1/p' "examples/$name.toml" | while read -r flame; do eval "'$command' $flame" >/dev/null; done
  "$command" render "examples/$name.toml" --samples 8 --quiet -o "$folder/out.exr"
  # The first of several cameras stands for the scene.
  picture=$(ls -tr "$folder"/out*.exr | head -1)
  "$command" develop "$picture" --curve display -o "$folder/out.png" >/dev/null
  # In the colours in which the window shows it.
  convert "$folder/out.png" -resize 96x96^ -gravity center -extent 96x96 -depth 8 -auto-level \
    \( xc:'#000004' xc:'#57106e' xc:'#bc3754' xc:'#f98e09' xc:'#fcffa4' +append -resize 256x1! \) -clut \
    -strip +dither -colors 64 "PNG8:app/desktop/resources/thumb-$name.png"
  echo "app/desktop/resources/thumb-$name.png"
  rm -f "$folder"/out*
done
