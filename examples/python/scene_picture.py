"""Draws flame, camera and rays in 3-D, without a window (under xvfb-run where there is no display).

    scene_picture.py [SCENE.toml] [FOLDER]      writes FOLDER/scene.png
"""

import pathlib
import sys

import plenoflame

here = pathlib.Path(__file__).resolve().parent
scene = plenoflame.Scene(sys.argv[1] if len(sys.argv) > 1 else here.parent / "lenslets-30.toml")
folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ".")

light_field = scene.render(samples=8)
rays = scene.rays(pixels=[(scene.columns // 2, scene.rows // 2)], rays=64, status="reached", most=300)
plenoflame.picture(scene, folder / "scene.png", rays=rays, light_field=light_field)
print(folder / "scene.png")
