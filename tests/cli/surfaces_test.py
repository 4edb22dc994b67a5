"""Surfaces and lights from the command line: what bad input gets, and where corners are."""

import csv
import io
import math
import os
import re

from command import CommandTest, main

CAMERA = """[camera]
preset = "r12"
[camera.sensor]
columns = 200
rows = 200
"""
LAMP = """[[lights]]
name = "lamp"
power = "1 W"
position = ["0 m", "1 m", "0 m"]
"""
MESH = """[[surfaces]]
name = "thing"
shape = "mesh"
file = "thing.obj"
"""
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


class Surfaces(CommandTest):
    def bad(self, surfaces, *mentions):
        self.write("a.toml", CAMERA + surfaces + LAMP)
        before = self.files()
        self.fails(1, "render", "a.toml", "-o", "a.exr", mentions=mentions)
        self.assertEqual(self.files(), before)

    def test_mesh_files(self):
        self.bad(MESH, "a.toml:6:", "thing", "thing.obj", "No such file")
        self.write("thing.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.bad(MESH, "a.toml:6:", "thing.obj")
        self.write("thing.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        self.bad(MESH, "a.toml:6:", "without area")
        good = "v 0 0 0\nv 1 0 0 # here\nv 0 1 0\n"
        for text, *mentions in [("v 0 0 0\nv 1 0 0x\nv 0 1 0\nf 1 2 3\n", "line 2", '"0x"'),
                                ("v 0 abc 1\n" + good + "f 2 3 4\n", "line 1", '"abc"'),
                                ("v 0 1\n" + good + "f 2 3 4\n", "line 1", "2 numbers"),
                                (good + "f 1 2\n", "line 4", "2 corners"),
                                (good + "f 1 2 4\n", "line 4", "no vertex 4 among 3"),
                                (good + "f 1 2 -4\n", "line 4", '"-4" is not the number of a vertex'),
                                (good + "f 1 \\\n2 x\n", "line 5", '"x"')]:
            self.write("thing.obj", text)
            self.bad(MESH, "a.toml:6:", "thing.obj", *mentions)
        self.write("thing.obj", "# nothing\n")
        self.bad(MESH, "a.toml:6:", "thing.obj")

    def test_broken_mesh_files(self):
        """Every kind of damage is an error with the place in the scene and the file's name; nothing is written."""
        def mesh(name, content):
            self.write(name, content)
            self.bad(MESH.replace("thing.obj", name), "a.toml:6:", name)
        mesh("thing.obj", b"")
        mesh("thing.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")  # no faces
        mesh("thing.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n")  # a corner that is not there
        mesh("thing.obj", "v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n")
        mesh("thing.obj", "v 0 0 0\nv 1 zero 0\nv 0 1 0\nf 1 2 3\n")
        mesh("thing.obj", bytes(range(256)) * 8)
        header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" \
                 "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        corners = "0 0 0\n1 0 0\n0 1 0\n"
        mesh("thing.ply", header[:60])
        mesh("thing.ply", header + "0 0 0\n1 0 0\n")  # cut off
        mesh("thing.ply", header + corners.replace("1 0", "nan 0", 1) + "3 0 1 2\n")
        mesh("thing.ply", header + corners + "3 0 1 9\n")
        mesh("thing.ply", "play" + header[3:] + corners + "3 0 1 2\n")
        mesh("thing.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n")
        mesh("thing.stl", b"\0" * 80 + (1000).to_bytes(4, "little") + b"\0" * 50)  # 999 triangles are missing
        mesh("thing.stl", "solid a\nendsolid a\n")
        mesh("thing.xyz", TRIANGLE)  # no format of meshes
        # Not a file, not to be read.
        os.remove(self.path("thing.obj"))
        os.mkdir(self.path("thing.obj"))
        self.bad(MESH, "a.toml:6:", "thing.obj")

    def test_faces_without_area_are_left_out_with_a_warning(self):
        self.write("thing.obj", TRIANGLE + "v 2 0 0\nf 1 2 4\n")
        self.assertIn("has 1 faces without area", self.warning_of(MESH + LAMP))

    def calls(self, scene):
        """Functions of Embree that a rendering calls: with lazy binding each is bound at its first call."""
        self.write("a.toml", scene)
        environment = dict(os.environ, LD_DEBUG="bindings")
        environment.pop("LD_BIND_NOW", None)
        result = self.run_command("render", "a.toml", "-o", "a.exr", "--samples", "2", "--window", "90,90,8,8",
                                  environment=environment)
        self.assertEqual(result.returncode, 0, result.stderr[-1000:])
        return set(re.findall(r"symbol `(rtc\w+)'", result.stderr))

    def test_without_surfaces_nothing_of_embree_is_called(self):
        flame = '[[flames]]\npreset = "paper-layered"\nposition = ["0.45 m", "0 m", "-29 mm"]\n'
        with_ball = self.calls(CAMERA + flame + '[[surfaces]]\nshape = "sphere"\nradius = "1 mm"\n'
                               'position = ["0.45 m", "0 m", "0 m"]\n')
        self.assertLessEqual({"rtcNewDevice", "rtcCommitScene", "rtcIntersect1"}, with_ball,
                             "symbols were bound before they were called: link without -z now for this test")
        self.assertEqual(self.calls(CAMERA + flame), set())

    def test_values(self):
        ball = "[[surfaces]]\nshape = \"sphere\"\nradius = \"1 cm\"\nposition = [\"1 m\", \"0 m\", \"0 m\"]\n"
        for value in ("1.01", "-0.1", "nan"):
            self.bad(ball + f"material.reflectivity = {value}\n", "a.toml:10:", "reflectivity")
        self.bad("[[surfaces]]\nshape = \"sphere\"\n", "a.toml:6:", "radius")
        self.bad(ball + "material.kind = \"blackbody\"\n", "temperature")
        self.bad(ball + "material.texture.kind = \"dots\"\n", "texture.cell")
        self.bad(ball + "material.texture.kind = \"image\"\nmaterial.texture.file = \"no.png\"\n", "no.png", "a.toml:6:")
        self.write("no.png", "PNG?")
        self.bad(ball + "material.texture.kind = \"image\"\nmaterial.texture.file = \"no.png\"\n", "no.png", "a.toml:6:")
        self.bad("[[lights]]\ndirection = [0, 0, 0]\n", "direction")

    def warning_of(self, scene):
        self.write("a.toml", CAMERA + scene)
        result = self.run_command("render", "a.toml", "-o", "a.exr", "--samples", "2", "--window", "90,90,8,8")
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stderr

    def test_inside_of_an_object(self):
        ball = "[[surfaces]]\nname = \"ball\"\nshape = \"sphere\"\nradius = \"20 cm\"\n"
        self.assertRegex(self.warning_of(ball + LAMP),
                         r"warning: a\.toml:\d+:\d+: the camera is inside of surface \"ball\", which hides everything else")
        # A flame outside of it would be hidden; a room around both hides nothing.
        flame = '[[flames]]\npreset = "paper-layered"\nposition = ["1 m", "0 m", "-29 mm"]\n'
        self.write("a.toml", CAMERA + ball + flame)
        self.fails(1, "render", "a.toml", "-o", "b.exr", "--samples", "2",
                   mentions=["a.toml:", 'the camera is inside of surface "ball", which hides flame "paper-layered"'])
        self.assertNotIn("b.exr", self.files())
        self.assertNotIn("inside", self.warning_of(ball.replace("20 cm", "2 m") + flame))
        ball += "position = [\"0 m\", \"1.1 m\", \"0 m\"]\n"
        text = self.warning_of(ball + LAMP)
        self.assertIn("light \"lamp\" is inside of surface \"ball\"", text)
        self.assertNotIn("camera", text)
        self.assertIn("nothing lights", self.warning_of(ball))

    def test_mesh_is_rendered(self):
        self.write("thing.obj", TRIANGLE)
        self.write("a.toml", CAMERA + MESH + "position = [\"0.45 m\", \"0 m\", \"0 m\"]\n"
                   "rotation = [\"0 deg\", \"-90 deg\", \"0 deg\"]\n" + LAMP)
        figures = self.json_of("render", "a.toml", "-o", "a.exr", "--samples", "4")
        self.assertGreater(figures["flux"], 0)
        self.assertIn("1 triangles", figures["surfaces"])

    def test_corners(self):
        """Against the pinhole: the mean over microlenses lies where the lens images the point."""
        self.write("a.toml", CAMERA.replace("[camera.sensor]", "[camera.array]\npresent = false\n[camera.focus]\n"
                                            "conjugate = \"sensor\"\n[camera.sensor]")
                   + """[[surfaces]]
shape = "plane"
position = ["450 mm", "0 m", "0 m"]
rotation = ["0 deg", "-90 deg", "0 deg"]
extent = ["20 mm", "20 mm"]
[surfaces.material.texture]
kind = "checkerboard"
cell = "1 mm"
columns = 5
rows = 4
""" + LAMP)
        figures = self.json_of("corners", "a.toml", "-o", "c.csv")
        self.assertEqual((figures["points"], figures["points_seen"], figures["images"]), (12, 12, 12))
        magnification = 1 / (450 / 50 - 1)  # a thin lens of 50 mm
        for row in csv.DictReader(io.StringIO(self.read("c.csv").decode())):
            # The plate's x is up in the world, its y to the left.
            self.assertTrue(math.isclose(float(row["z_m"]), (int(row["column"]) - 1.5) * 1e-3, rel_tol=1e-12))
            column = 100 - float(row["y_m"]) * magnification / 5.5e-6
            line = 100 - float(row["z_m"]) * magnification / 5.5e-6
            self.assertTrue(math.isclose(float(row["image_column"]), column, rel_tol=1e-9), row)
            self.assertTrue(math.isclose(float(row["image_row"]), line, rel_tol=1e-9), row)
            self.assertLess(float(row["spread_pixels"]), 1e-4)
        self.fails(1, "corners", self.no_pattern(), "-o", "d.csv", mentions="checkerboard")
        self.fails(2, "corners", "a.toml", "-o", "d.txt", mentions=".csv")
        self.assertNotIn("d.csv", self.files())

    def no_pattern(self):
        self.write("b.toml", CAMERA + LAMP)
        return "b.toml"


main()
