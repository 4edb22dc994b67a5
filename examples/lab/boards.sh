#!/bin/sh
# Renders a checkerboard in three poses into the current folder: board-1.tif to board-3.tif (docs/user/calibrations.md).
set -eu
here=$(dirname "$0")

# Number of the picture, distance [mm], three angles [deg].
pose() {
  cat "$here/board-camera.toml" - > pose.toml <<END
[[lights]]
kind = "environment"
radiance = "10 W/(m^2 sr)"
[[surfaces]]
name = "board"
shape = "plane"
position = ["$2 mm", "0 mm", "0 mm"]
rotation = ["$3 deg", "$4 deg", "$5 deg"]
extent = ["60 mm", "60 mm"]
[surfaces.material.texture]
kind = "checkerboard"
cell = "2.5 mm"
columns = 6
rows = 5
END
  plenoflame render pose.toml -o pose.exr --quiet
  plenoflame develop pose.exr --exposure auto -o board-$1.tif
}
pose 1 313 8 -102 10
pose 2 305 -20 -75 -25
pose 3 318 25 -70 5
