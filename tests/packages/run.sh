#!/bin/bash
# Installs the packages of FOLDER into a fresh minimal Debian 12 and uses them there as somebody would who has never
# seen the project: renders, scripts, opens the desktop application, builds a C++ program. Wants root, mmdebstrap and
# the package registry.
#
#   tests/packages/run.sh FOLDER [PICTURES]
#
# PICTURES receives what was drawn there: the window of the desktop application, a scene, ParaView's.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[ $# -eq 1 ] || [ $# -eq 2 ] || { sed -n '6s/^# *//p' "$0" >&2; exit 2; }
packages=$(cd "$1" && pwd)
ls "$packages"/plenoflame_*.deb >/dev/null

. "$here/../bare/debian.sh"
bare_debian
root=$(mktemp -d "$cache/run.XXXXXX")
trap 'close_debian "$root"; rm -rf --one-file-system "$root"' EXIT
open_debian "$root" "$cache/debian"
inside=$root/system
mkdir -p "$inside/packages"
cp "$packages"/*.deb "$inside/packages"
cp "$here/first_use.sh" "$here/../install/consumer/core.cpp" "$inside/packages"
mkdir -p "$inside/packages/tree/tools" "$inside/packages/tree/docs/user"
cp "$here/../../tools/measure_tutorial.py" "$inside/packages/tree/tools"
cp "$here/../../docs/user/tutorial.md" "$inside/packages/tree/docs/user"
in_debian "$root" env HOME=/nonexistent bash /packages/first_use.sh
[ $# -lt 2 ] || { mkdir -p "$2" && cp "$inside"/first/windows/*.png "$inside"/first/*.png "$2"; }
