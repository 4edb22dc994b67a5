#!/bin/sh
# Simulates the raw pictures of a small camera into the current folder (docs/real-cameras.md): white, blackbody of 1700 K, four frames
# of a flame of 1800 K, and dark frames. The array is turned by 0.8 degrees and has another pitch than nominal.toml says.
set -eu
here=$(dirname "$0")
sed 's/^pitch.*/pitch = "127.4 um"\nrotation = "0.8 deg"\noffset = ["20 um", "0 um"]/' "$here/nominal.toml" > real.toml
cat real.toml - > blackbody.toml <<'EOF'
[[flames]]
position = ["0.5 m", "0 m", "0 m"]
[[flames.layers]]
semi_axes = ["80 mm", "80 mm", "80 mm"]
temperature = "1700 K"
absorption = "20000 1/m"
EOF
cat real.toml - > flame.toml <<'EOF'
[[flames]]
position = ["0.5 m", "0 m", "0 m"]
[[flames.layers]]
semi_axes = ["3 mm", "3 mm", "4.5 mm"]
temperature = "1800 K"
absorption = "60 1/m"
EOF
plenoflame render real.toml --white -o white.exr --quiet
plenoflame render blackbody.toml -o blackbody.exr --quiet
plenoflame render flame.toml -o flame.exr --quiet
plenoflame develop white.exr --exposure auto -o white.tif
plenoflame develop blackbody.exr --exposure "0.05 ms" -o blackbody.tif
plenoflame develop flame.exr --exposure "0.1 ms" --frames 4 -o flame.tif
plenoflame develop flame.exr --exposure "0.1 ms" --dark --frames 4 -o dark.tif
plenoflame develop blackbody.exr --exposure "0.05 ms" --dark -o dark-blackbody.tif
