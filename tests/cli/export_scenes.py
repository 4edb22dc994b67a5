"""Cameras of ideal thin lenses before a small glowing sphere, for the tests of export."""

import numpy as np

F, STOP, FOCUS = 50e-3, 10e-3, 1.0     # main lens: focal length, diameter, distance of the plane imaged on the array
D = 1 / (1 / F - 1 / FOCUS)            # main lens to array
Z, X, Y = 0.6, 1.5e-3, -1.0e-3         # the sphere: depth, right, down
IMAGE = 1 / (1 / F - 1 / Z)            # where it is imaged, from the main lens
POINT = np.array([-X, -Y]) * IMAGE / Z  # its image, camera x, y: behind the array

LENS = """[camera.lens]
model = "ideal"
surfaces = []
focal_length = "50 mm"
diameter = "10 mm"
[camera.focus]
mode = "paraxial"
object_distance = "1 m"
conjugate = "array"
"""

SCENE = LENS + """[[flames]]
name = "point"
position = ["%g m", "%.9g m", "%.9g m"]
[[flames.layers]]
name = "sphere"
centre = ["0 m", "0 m", "0 m"]
semi_axes = ["%g mm", "%g mm", "%g mm"]
temperature = "1500 K"
absorption = "1 1/m"
"""

# %: lattice, rotation in degrees, two tilts, types
TILTED_ARRAY = """[camera.array]
lattice = "%s"
model = "ideal"
pitch = "80 um"
diameter = "80 um"
rotation = "%g deg"
offset = ["10 um", "-7 um"]
sensor_distance = "0.4 mm"
tilt = ["%g deg", "%g deg"]
%s
[camera.sensor]
columns = 400
rows = 300
pixel_pitch = "2.5 um"
"""
TYPE = """[[camera.array.types]]
name = "%s"
focal_length = "%g mm"
"""
GLOWING_POINT = """[[flames]]
name = "point"
[[flames.layers]]
name = "sphere"
temperature = "1500 K"
absorption = "1 1/m"
"""

FOCUSED = """[camera.array]
lattice = "%s"
model = "ideal"
pitch = "80 um"
diameter = "80 um"
rotation = "0.03 rad"
offset = ["10 um", "-7 um"]
sensor_distance = "0.4 mm"
[[camera.array.types]]
name = "a"
focal_length = "0.45 mm"
[[camera.array.types]]
name = "b"
focal_length = "0.5057 mm"
[[camera.array.types]]
name = "c"
focal_length = "0.58 mm"
[camera.sensor]
columns = 400
rows = 300
pixel_pitch = "2.5 um"
"""
FOCALS = [0.45, 0.5057, 0.58]
WINDOW = (21, 12, 360, 280)

UNFOCUSED = """[camera.array]
lattice = "square"
model = "ideal"
pitch = "100 um"
diameter = "100 um"
offset = ["50 um", "50 um"]
sensor_distance = "0.5 mm"
[[camera.array.types]]
name = "a"
focal_length = "0.5 mm"
[camera.sensor]
columns = 600
rows = 480
pixel_pitch = "5 um"
"""
