#!/bin/bash
# Follows each documented way to build in a minimal Debian 12, where nothing is installed that a stranger would not have.
#
#   tests/bare/run.sh          set-up and configuration of each way
#   tests/bare/run.sh --all    and builds: ./demo.sh to its pictures, pip install, ./test.sh --quick
#
# The minimal system, what each way installs and the downloaded packages stay in ~/.cache/plenoflame/bare (XDG_CACHE_HOME).
# Ends with 77, which skips the test, where it cannot be done: it wants root, mmdebstrap, overlays and the package registry.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source_tree=$(cd "$here/../.." && pwd)
all=no
case "${1:-}" in
  "") ;;
  --all) all=yes ;;
  -h | --help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
  *) echo "run.sh: unknown option $1 (see --help)" >&2; exit 2 ;;
esac
. "$here/debian.sh"

skip() { echo "skipped: $1"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "a bare Debian is made by root"
command -v mmdebstrap >/dev/null || skip "there is no mmdebstrap (tools/setup.sh tests)"
say() { printf -- '--- %s (%d s)\n' "$1" "$SECONDS"; }
fail() { echo "tests/bare: $1" >&2; exit 1; }

root=
leave() { [ -z "$root" ] || { close_debian "$root" && rm -rf --one-file-system "$root"; }; }
trap leave EXIT
trap 'exit 1' INT TERM
has_overlays || skip "no overlay can be mounted in $cache"
bare_debian

place="/srv/a folder"  # a path with a blank
# enter NAME LAYER...: a system of its own in $root, with the sources (not what is built, and no .git) in $place.
enter() {
  leave
  root=$(mktemp -d "$cache/run.XXXXXX")
  open_debian "$root" "$cache/debian" "${@:2}"
  mkdir -p "$root/system$place" "$root/system/srv/scratch"
  chmod 1777 "$root/system/srv" "$root/system/srv/scratch"
  { tar -C "$source_tree" --warning=no-file-changed --exclude='./build*' --exclude=./out --exclude=./.git --exclude='*.vdb' -c . || [ $? -eq 1 ]; } | tar -C "$root/system$place" -x
  in_debian "$root" id somebody >/dev/null 2>&1 || in_debian "$root" useradd somebody 2>/dev/null
  in_debian "$root" chown -R somebody: "$place"
}
as() { in_debian "$root" setpriv --reuid "$1" --regid "$1" --clear-groups env HOME=/srv bash -c "cd '$place' && $2"; }
as_root() { in_debian "$root" bash -c "cd '$place' && $1"; }

say "without anything: the packages are listed"
enter nothing
said=$(as somebody "tools/setup.sh 2>&1" && echo done) || true
[[ "$said" == *"no sudo"*"apt-get install"* ]] || fail "set-up without root and sudo says: $said"

# way NAME COMMAND...: sets NAME up as root, and configures as another user.
declare -A layers
way() {
  local name=$1 layer
  say "$name"
  layer=$cache/$name-$("$source_tree/tools/setup.sh" --list "$name" | sha256sum | cut -c1-16)
  if [ ! -d "$layer" ]; then
    enter "$name"
    as_root "tools/setup.sh $name >/dev/null" || fail "tools/setup.sh $name"
    close_debian "$root"
    rm -rf "$root/written/srv" "$cache/$name"-*
    mv "$root/written" "$layer"
    rm -rf "$root" && root=
  fi
  layers[$name]=$layer
  enter "$name" "$layer"
  as somebody "tools/setup.sh $name" || fail "tools/setup.sh $name leaves something to be installed"
  as somebody "$2 >/srv/scratch/configured 2>&1" || { cat "$root/system/srv/scratch/configured"; fail "configuration of $name"; }
}

for preset in command python desktop release; do
  way "$preset" "cmake --preset $preset"
  if [ "$preset" = command ]; then
    say "one line for what is missing"
    as_root "dpkg --purge --force-depends libcli11-dev libembree-dev >/dev/null"
    said=$(as somebody "cmake --preset command -B /srv/scratch/missing 2>&1 >/dev/null" || true)
    [[ "$said" == *" missing: embree, CLI11. Install what this build needs: tools/setup.sh core cli"* ]] || fail "without packages CMake says: $said"
  fi
done
way wheel "python3 -m venv --system-site-packages /srv/scratch/venv && cmake -G Ninja -S . -B build/wheel -DBUILD_TESTING=OFF -DPLENOFLAME_WITH_CLI=OFF -DPLENOFLAME_WITH_PYTHON=ON"
[ "$all" = yes ] || { say "done"; exit 0; }

share_compiler_cache() {
  command -v ccache >/dev/null || return 0
  mkdir -p "$root/system/srv/ccache"
  mount --bind "$(ccache --get-config cache_dir)" "$root/system/srv/ccache"
  printf 'cache_dir = /srv/ccache\n' >"$root/system/etc/ccache.conf"
  chmod -R a+rwX "$root/system/srv/ccache"
}

say "pip install"
share_compiler_cache
as somebody "/srv/scratch/venv/bin/pip install --no-deps --no-build-isolation . >/srv/scratch/pip 2>&1" || { tail -30 "$root/system/srv/scratch/pip"; fail "pip install"; }
as somebody "cd /srv/scratch && /srv/scratch/venv/bin/python -c 'import plenoflame'" || fail "import plenoflame"

say "./demo.sh from nothing"
enter demo
share_compiler_cache
as_root "./demo.sh" || fail "demo.sh"
for picture in paper-flame-1m candle; do
  [ -s "$root/system$place/out/$picture.png" ] || fail "demo.sh made no $picture.png"
  cp "$root/system$place/out/$picture.png" "$cache"
done

say "./test.sh --quick"
share_compiler_cache
as_root "./test.sh --quick" || fail "test.sh"
say "done; the pictures of demo.sh are in $cache"
