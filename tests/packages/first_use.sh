#!/bin/bash
# Runs inside of a fresh Debian (run.sh): what a new user does with the installed packages, in LANG=C and a German
# locale, with a home folder that does not exist, first without and then with a display. Pictures stay in /first.
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

install() { "${apt[@]}" install -y --no-install-recommends "$@" >/dev/null; }

"${apt[@]}" update
say "the command alone"
install /packages/plenoflame_*.deb
! dpkg-query -W 'libvtk9*' >/dev/null 2>&1 || fail "the command pulls VTK"
refuses 1 "package plenoflame-vtk" plenoflame picture /usr/share/plenoflame/examples/lenslets-30.toml -o scene.png

say "desktop and pictures"
install /packages/plenoflame-vtk_*.deb /packages/plenoflame-desktop_*.deb
mkdir /first
cd /first
plenoflame --version
cp -r /usr/share/plenoflame/examples .
scene=examples/lenslets-30.toml
plenoflame flame candle --voxel-size "2 mm" -o candle.vdb >/dev/null
refuses 1 display plenoflame picture "$scene" -o scene.png
refuses 1 display plenoflame-desktop "$scene"
test -s /usr/share/man/man1/plenoflame-render.1.gz
test -s /usr/share/bash-completion/completions/plenoflame

say "another language, no place to write"
plenoflame render "$scene" --samples 4 --window 100,100,80,80 --quiet -o a.exr >/dev/null
plenoflame info a.exr >info.txt
install locales python3
localedef -i de_DE -f UTF-8 de_DE.UTF-8
LC_ALL=de_DE.UTF-8 python3 -c 'import locale; locale.setlocale(locale.LC_ALL, ""); assert locale.localeconv()["decimal_point"] == ","'
export LC_ALL=de_DE.UTF-8
plenoflame info a.exr | cmp - info.txt || fail "the locale changes what is printed"
plenoflame render "$scene" --samples 4 --window 100,100,80,80 --quiet -o b.exr >/dev/null
plenoflame compare a.exr b.exr >/dev/null || fail "the locale changes what is rendered"
refuses 1 display plenoflame-desktop "$scene"
mkdir /nobody
chmod 755 /first
refuses 1 nowhere setpriv --reuid 65534 --regid 65534 --clear-groups plenoflame render nowhere.toml -o /nobody/a.exr
refuses 1 /nobody setpriv --reuid 65534 --regid 65534 --clear-groups plenoflame render "$scene" --samples 1 -o /nobody/a.exr
unset LC_ALL

say "the tutorial"
ln -s /usr/share/plenoflame/examples /packages/tree/examples
python3 /packages/tree/tools/measure_tutorial.py

say "desktop"
install xvfb xauth libgl1-mesa-dri shared-mime-info libglib2.0-bin
mkdir -p -m 1777 ../tmp/.X11-unix  # else only root starts an X server
on_display=(setpriv --reuid 65534 --regid 65534 --clear-groups env QT_QPA_PLATFORM=xcb xvfb-run -a -s "-screen 0 1600x1000x24")
mkdir -m 777 windows
"${on_display[@]}" plenoflame-desktop "$scene" --screenshot windows/window.png
test -s windows/window.png
printf 'a = 1\n' >other.toml
for each in "$scene x-plenoflame-scene" "other.toml toml" "a.exr x-plenoflame-light-field" "candle.vdb x-openvdb"; do
  gio info -a standard::content-type "${each% *}" | grep -q "application/${each#* }$" || fail "${each% *} is no application/${each#* }"
done

say "mpirun"
install openmpi-bin
mpi=(env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --oversubscribe -n 2)
rendered=(plenoflame render "$scene" --samples 4 --window 100,100,80,80 --quiet)
said=$("${mpi[@]}" "${rendered[@]}" -o c.exr 2>&1) && fail "mpirun without MPI"
[[ "$said" == *plenoflame-mpi* ]] || fail "mpirun without MPI says: $said"
install /packages/plenoflame-mpi_*.deb
"${mpi[@]}" "${rendered[@]}" -o c.exr >/dev/null
cmp a.exr c.exr || fail "two processes render something else"

say "Python without VTK"
install /packages/python3-plenoflame_*.deb
cat >script.py <<'PYTHON'
import sys
import numpy
import plenoflame
try:
    plenoflame.vtk
except plenoflame.Error as error:
    assert sys.argv[2] == "alone" and "python3-plenoflame-vtk" in str(error), error
else:
    assert sys.argv[2] == "vtk" and plenoflame.Scene(sys.argv[1]).to_vtk().GetListSize("flames") > 0
scene = plenoflame.Scene(sys.argv[1])
numpy.save(sys.argv[2] + ".npy", scene.render(samples=1, window=(100, 100, 40, 40)).flux)
assert scene.rays(pixels=[(150, 150)], rays=4).weight.sum() > 0
PYTHON
python3 script.py "$scene" alone
said=$(python3 -c 'import plenoflame; plenoflame.import_flame("a.vtu", constant=1)' 2>&1) && fail "an import without VTK"
[[ "$said" == *"Debian package python3-plenoflame-vtk"* ]] || fail "an import without VTK says: $said"

say "Python with VTK"
install /packages/python3-plenoflame-vtk_*.deb
python3 script.py "$scene" vtk
cmp alone.npy vtk.npy || fail "with VTK Python renders something else"
xvfb-run -a plenoflame picture "$scene" -o scene.png >/dev/null
test -s scene.png

say "documentation"
install /packages/plenoflame-doc_*.deb
test -s /usr/share/doc/plenoflame-doc/docs/user/tutorial.md
grep -q doc/plenoflame-doc/docs /usr/bin/plenoflame-desktop || fail "the desktop application looks for its help elsewhere"
test -s /usr/share/doc/plenoflame-doc/examples/candle.toml

say "C++"
install /packages/libplenoflame-dev_*.deb g++ cmake make
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
# Debian's ParaView has a VTK of its own, which excludes that of python3-plenoflame-vtk.
install /packages/plenoflame-paraview_*.deb
cat >paraview.py <<'PYTHON'
import glob
import runpy
state = runpy.run_path(glob.glob("/usr/lib/*/plenoflame/paraview/paper-flame.py")[0])
from paraview.simple import GetActiveView, SaveScreenshot
SaveScreenshot("paraview.png", GetActiveView())
PYTHON
xvfb-run -a -s "-noreset -screen 0 1280x1024x24" plenoflame-paraview --pvpython paraview.py
test -s paraview.png

say "removed again"
"${apt[@]}" purge -y 'plenoflame*' 'python3-plenoflame*' 'libplenoflame-dev' >/dev/null
left=$(find / -xdev -iname '*plenoflame*' -not -path '/packages/*' -not -path '/proc/*' -not -path '/var/cache/*' \
  -not -path '/var/log/*' -not -path '/first/*' -not -path '/tmp/*')
[ -z "$left" ] || fail "something is left behind: $left"
say "all well"
