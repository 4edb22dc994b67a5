#!/bin/bash
# Runs inside of a fresh Debian (run.sh): what a new user does with the installed packages, in LANG=C and a German
# locale, with a home folder that does not exist, first without and then with a display.
set -euo pipefail
apt=(apt-get -qq -o Dpkg::Use-Pty=0)
export DEBIAN_FRONTEND=noninteractive
say() { printf -- '--- %s (%d s)\n' "$1" "$SECONDS"; }
fail() { echo "first_use.sh: $1" >&2; exit 1; }
# refuses STATUS TEXT COMMAND...: it ends with the status, one line on standard error that has the text.
refuses() {
  local wanted=$1 text=$2 said status=0
  shift 2
  said=$("$@" 2>&1 >/dev/null) || status=$?
  [ "$status" -eq "$wanted" ] && [ "$(wc -l <<<"$said")" -eq 1 ] && [[ "$said" == *"$text"* ]] ||
    fail "$*: status $status, said: $said"
}

"${apt[@]}" update
say "the command alone"
"${apt[@]}" install -y --no-install-recommends /packages/plenoflame_*.deb >/dev/null
mkdir /first
cd /first
plenoflame --version
cat >scene.toml <<'TOML'
[camera]
preset = "lenslets-30"
TOML
plenoflame flame candle --voxel-size "2 mm" -o candle.vdb >/dev/null
refuses 1 plenoflame-vtk plenoflame picture scene.toml -o scene.png

say "documentation and examples"
"${apt[@]}" install -y --no-install-recommends /packages/plenoflame-doc_*.deb >/dev/null
examples=/usr/share/doc/plenoflame-doc/examples
plenoflame render "$examples/lenslets-30.toml" --samples 4 --window 100,100,80,80 --quiet -o a.exr >/dev/null
plenoflame develop a.exr -o a.png >/dev/null
plenoflame info a.exr >info.txt
LC_ALL=de_DE.UTF-8 plenoflame info a.exr | cmp - info.txt || fail "the locale changes what is printed"
test -s /usr/share/man/man1/plenoflame-render.1.gz
test -s /usr/share/bash-completion/completions/plenoflame
mkdir readonly
chmod 500 readonly
refuses 1 nowhere plenoflame render nowhere.toml -o readonly/a.exr

say "Python"
"${apt[@]}" install -y --no-install-recommends /packages/plenoflame-vtk_*.deb /packages/python3-plenoflame_*.deb >/dev/null
refuses 1 xvfb-run plenoflame picture "$examples/lenslets-30.toml" -o scene.png
python3 - "$examples/lenslets-30.toml" <<'PYTHON'
import sys
import plenoflame
field = plenoflame.Scene(sys.argv[1]).render(samples=1)
assert field.flux.max() > 0
PYTHON

say "desktop"
"${apt[@]}" install -y --no-install-recommends /packages/plenoflame-desktop_*.deb xvfb xauth libgl1-mesa-dri \
  shared-mime-info >/dev/null
refuses 1 display plenoflame-desktop "$examples/lenslets-30.toml"
xvfb-run -a plenoflame picture "$examples/lenslets-30.toml" -o scene.png >/dev/null
test -s scene.png
QT_QPA_PLATFORM=xcb xvfb-run -a -s "-screen 0 1600x1000x24" plenoflame-desktop "$examples/lenslets-30.toml" \
  --screenshot window.png
test -s window.png

say "C++"
"${apt[@]}" install -y --no-install-recommends /packages/libplenoflame-dev_*.deb g++ cmake make >/dev/null
mkdir consumer
cp /packages/core.cpp consumer/main.cpp
cat >consumer/CMakeLists.txt <<'CMAKE'
cmake_minimum_required(VERSION 3.25)
project(consumer LANGUAGES CXX)
find_package(plenoflame REQUIRED COMPONENTS core)
add_executable(consumer main.cpp)
target_link_libraries(consumer PRIVATE plenoflame::core)
CMAKE
cmake -S consumer -B consumer/build >/dev/null
cmake --build consumer/build >/dev/null
consumer/build/consumer /first

say "ParaView"
# Debian's ParaView has a VTK of its own, which excludes the one of python3-plenoflame.
"${apt[@]}" install -y --no-install-recommends /packages/plenoflame-paraview_*.deb >/dev/null
cat >paraview.py <<'PYTHON'
import glob
import runpy
runpy.run_path(glob.glob("/usr/lib/*/plenoflame/paraview/paper-flame.py")[0])
from paraview.simple import GetActiveView, SaveScreenshot
SaveScreenshot("paraview.png", GetActiveView())
PYTHON
xvfb-run -a -s "-noreset -screen 0 1280x1024x24" plenoflame-paraview --pvpython paraview.py
test -s paraview.png

say "removed again"
"${apt[@]}" purge -y 'plenoflame*' 'python3-plenoflame' 'libplenoflame-dev' >/dev/null
[ -z "$(find / -xdev -iname '*plenoflame*' -not -path '/packages/*' -not -path '/proc/*' -not -path '/var/*' -print -quit)" ] ||
  fail "something is left behind: $(find / -xdev -iname '*plenoflame*' -not -path '/packages/*' -not -path '/proc/*' -not -path '/var/*' | head -3)"
say "all well"
