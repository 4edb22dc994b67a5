#!/bin/bash
# Installs the Debian packages that Plenoflame is built and tested with, as far as they are missing.
#
#   tools/setup.sh [PRESET | GROUP ...]   what a preset of CMake needs, or groups as listed below; without any: command
#   tools/setup.sh --list [PRESET | GROUP ...]   prints the packages and why each is needed, installs nothing
#
# Uses apt-get as root, or through sudo. Where it may not install, it lists what is missing and
# ends with status 1. Nothing is downloaded when everything is there.
set -euo pipefail

# preset      groups that its options need (tests/architecture compares them with CMakePresets.json)
presets='
command       core volumes cli
python        core volumes cli vtk pybind
desktop       core volumes cli vtk qt
release       core volumes cli vtk pybind qt mpi tests site
package       core volumes cli vtk pybind qt mpi packaging
wheel         core volumes pybind
debug         core volumes cli tests
coverage      core volumes cli tests dev
asan          core volumes tests
tsan          core tests
'

# group       package                  what for
packages='
core          g++                      C++20 compiler
core          cmake                    build system
core          ninja-build              build tool
core          ccache                   compiles nothing twice across the build configurations
core          libopenexr-dev           light-field images (EXR)
core          libimath-dev             half floats and boxes of OpenEXR
core          libpng-dev               developed pictures
core          libtiff-dev              sensor frames (TIFF)
core          libjpeg-dev              pictures of cameras that were saved as JPEG
core          zlib1g-dev               compression of PNG and EXR, npz exports
core          libpugixml-dev           exports as XML
core          libhdf5-dev              exports as HDF5
core          libfmt-dev               formatted messages
core          libtomlplusplus-dev      scene files with positions in messages
core          nlohmann-json3-dev       statistics and figures as JSON
core          libeigen3-dev            small dense linear algebra
core          libembree-dev            surfaces: ray tracing
core          libtbb-dev               threads of Embree and OpenVDB
volumes       libopenvdb-dev           flames as OpenVDB grids
volumes       libboost-iostreams-dev   delayed loading of OpenVDB (its find module asks for it)
volumes       libblosc-dev             compression of OpenVDB files
cli           libcli11-dev             command line
cli           libcairo2-dev            plots (bench)
cli           libnlopt-dev             optimiser (optimize)
cli           pkg-config               finds Cairo
cli           fonts-dejavu-core        text in plots
mpi           libopenmpi-dev           work shared by processes (mpirun), as VTK of Debian has it
mpi           openmpi-bin              mpirun
vtk           libvtk9-dev              3-D pictures, ray paths, flames from simulations
vtk           python3-vtk9             Python package
vtk           python3-dev              wraps the VTK module for Python
vtk           python3-numpy            images as arrays
vtk           libgl-dev                OpenGL headers that VTK asks for
vtk           libx11-dev               tells whether there is a display
vtk           xvfb                     pictures without a display
vtk           xauth                    xvfb-run
vtk           libgl1-mesa-dri          software rendering
vtk           python3-matplotlib       examples in Python
pybind        pybind11-dev             Python package without VTK (pip install .)
pybind        libnlopt-dev             its optimiser
pybind        python3-dev              Python package without VTK (pip install .)
pybind        python3-numpy            arrays of the Python package
pybind        python3-pip              pip install .
pybind        python3-venv             pip install . into a folder of its own
qt            qtbase5-dev              desktop application: windows
qt            libvtk9-qt-dev           desktop application: 3-D views in windows
qt            libqt5svg5               desktop application: its icon
qt6           qt6-base-dev             desktop application: compiled against Qt 6, too (tests/desktop_qt6)
qt6           libqt6opengl6-dev        the same
tests         libgtest-dev             unit tests
tests         python3                  tests of the architecture and of the documentation
tests         python3-numpy            reads exports as Python users do
tests         python3-h5py             the same for HDF5
tests         python3-scipy            solvers that ours are held against
tests         python3-xarray           Python results with coordinates
tests         python3-tqdm             progress bars of the Python package
tests         python3-matplotlib       plots of the Python results
tests         python3-nbconvert        runs the notebooks
tests         python3-ipykernel        the same
tests         binutils                 nm: tests for symbols that must not exist
tests         clang-format-14          format check
tests         git                      tests of releases; --version names the commit
tests         man-db                   tests of manual pages
tests         zsh                      tests of completions
tests         fish                     the same
tests         mypy                     tests of the types of the Python package
tests         desktop-file-utils       test of the entry of the desktop application in menus
tests         openbox                  tests of the window under a window manager
tests         ffmpeg                   tests of films
tests         mmdebstrap               a bare Debian that follows each way to build (tests/bare)
slurm         slurm-wlm                test of a job array (tests/cli/slurm_test.py)
slurm         munge                    the same
bench         libbenchmark-dev         micro-benchmarks
packaging     dpkg-dev                 packages: which libraries they depend on (tools/release.sh)
packaging     lintian                  packages: checks of Debian packages
packaging     patchelf                 archive: libraries are found beside each other
packaging     mmdebstrap               packages: a fresh Debian to install them into
packaging     xz-utils                 packages: the sources
site          mkdocs                   documentation as a site (tools/site.sh)
site          mkdocs-material          its appearance and search
site          libjs-katex              formulas of the site
site          doxygen                  reference of the C++ libraries
dev           clang-tidy-14            static analysis (tools/tidy.sh)
dev           lcov                     coverage report
dev           imagemagick              pictures of the documentation (tools/make_pictures.sh)
dev           git                      changed files in tools/tidy.sh
'

list_only=no
groups=()
for argument in "$@"; do
  case "$argument" in
    --list) list_only=yes ;;
    -h | --help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) echo "setup.sh: unknown option $argument (see --help)" >&2; exit 2 ;;
    *) groups+=("$argument") ;;
  esac
done
[ ${#groups[@]} -gt 0 ] || groups=(command)

names() { awk 'NF {print $1}' <<<"$1" | sort -u | tr '\n' ' '; }
known=" $(names "$packages")"
expanded=()
for group in "${groups[@]}"; do
  of_preset=$(awk -v preset="$group" '$1 == preset {$1 = ""; print}' <<<"$presets")
  for each in ${of_preset:-$group}; do
    [[ " ${expanded[*]} " == *" $each "* ]] || expanded+=("$each")
  done
done

wanted=()
for group in "${expanded[@]}"; do
  if [[ "$known" != *" $group "* ]]; then
    echo "setup.sh: $group is neither a preset ($(names "$presets")) nor a group ($(names "$packages"))" >&2
    exit 2
  fi
  if [ "$list_only" = yes ]; then
    awk -v group="$group" '$1 == group' <<<"$packages"
  fi
  while read -r package; do
    [[ " ${wanted[*]} " == *" $package "* ]] || wanted+=("$package")
  done < <(awk -v group="$group" '$1 == group {print $2}' <<<"$packages")
done
[ "$list_only" = no ] || exit 0

missing=()
if ! command -v dpkg-query >/dev/null; then
  missing=("${wanted[@]}")
else
  for package in "${wanted[@]}"; do
    status=$(dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null || true)
    grep -qx installed <<<"$status" || missing+=("$package")
  done
fi
[ ${#missing[@]} -gt 0 ] || exit 0

give_up() {
  {
    echo "setup.sh: $1 These packages are missing (Debian 12 names):"
    printf '  %s\n' "${missing[@]}"
    echo "Install them, for example as root: apt-get install --no-install-recommends ${missing[*]}"
  } >&2
  exit 1
}

command -v apt-get >/dev/null || give_up "there is no apt-get here."
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || give_up "installing needs root, and there is no sudo."
  if sudo -n true 2>/dev/null; then
    as_root=(sudo -n)
  elif [ -t 0 ] && [ -t 2 ]; then
    as_root=(sudo)  # asks for the password
  else
    give_up "installing needs root, and sudo wants a password."
  fi
fi

echo "Installing: ${missing[*]}"
# A fresh machine may still be running its first automatic update: wait for its lock.
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300
  -o Acquire::Retries=3)
"${apt[@]}" update || give_up "the package lists could not be fetched."
"${apt[@]}" install -y --no-install-recommends "${missing[@]}" >/dev/null ||
  give_up "apt-get could not install everything."
