"""plenoflame camera import: what export wrote for other tools comes back as the same camera, each value that no file has
is asked for, and damaged files are refused. Micro-images are compared by their centres, as both cameras have them.
"""

import json
import math
import os
import struct

import zipfile

import h5py

from command import CommandTest, main
from exr import write_light_field
from export_scenes import GLOWING_POINT, TILTED_ARRAY, TYPE

SCENE = """[camera.lens]
model = "ideal"
surfaces = []
focal_length = "50 mm"
diameter = "12.5 mm"
decentre = ["%g mm", "%g mm"]
tilt = ["%g deg", "%g deg"]
[camera.focus]
mode = "distance"
lens_distance = "56.7 mm"
""" + TILTED_ARRAY + GLOWING_POINT
FOCAL = {"a": 0.45, "b": 0.5057, "c": 0.58, "unfocused": 0.4}
OPTICS = ["--set", "camera.lens.focal_length=50mm", "--set", "camera.lens.f_number=4",
          "--set", "camera.focus.lens_distance=56.7mm", "--set", "camera.array.sensor_distance=0.4mm",
          "--set", "camera.sensor.pixel_pitch=2.5um"]
SIZE = ["--set", "camera.sensor.columns=400", "--set", "camera.sensor.rows=300"]

def focal(types):
    return [part for i, name in enumerate(types)
            for part in ("--set", "camera.array.types[%d].focal_length=%gmm" % (i, FOCAL[name]))]

def read_npy(data):
    header_size = struct.unpack("<H", data[8:10])[0]
    header = data[10:10 + header_size].decode("latin-1")
    code = {"<f8": "d", "<f4": "f", "<i4": "i"}[header.split("'descr': '")[1].split("'")[0]]
    body = data[10 + header_size:]
    return struct.unpack("<%d%s" % (len(body) // struct.calcsize(code), code), body)

class CameraImport(CommandTest):
    def scene(self, types="abc", lattice="hexagonal", rotation=0.3, decentre=(0, 0), tilt=(0, 0), array_tilt=(0, 0)):
        text = SCENE % (*decentre, *tilt, lattice, rotation, *array_tilt,
                        "".join(TYPE % (n, FOCAL[n]) for n in ([types] if types in FOCAL else types)))
        write_light_field(self.path("raw.exr"), [[1e-12] * 400] * 300, scene=text)

    def images(self, *options):
        """[(x, y, radius, focal length)] of the micro-images."""
        self.succeeds("export", "raw.exr", "--format", "npz", "--force", "--name", "n", "-o", "arrays", *options)
        with zipfile.ZipFile(self.path("arrays/n.npz")) as archive:
            arrays = {name[:-4]: read_npy(archive.read(name))
                      for name in ("centres.npy", "radius.npy", "type.npy")}
        xy = arrays["centres"]
        return [(xy[2 * i], xy[2 * i + 1], arrays["radius"][i], t) for i, t in enumerate(arrays["type"])]

    def compare(self, types, accuracy, tell_types=True):
        """The micro-images of camera.toml are those of the scene in raw.exr."""
        names = [types] if types in FOCAL else list(types)
        original = self.images()
        with open(self.path("camera.toml"), encoding="utf-8") as file:
            found = [line.split('"')[1] for line in file if line.startswith("focal_length")][1:]
        imported = self.images("--scene", "camera.toml")
        cells = {}
        for image in imported:
            cells.setdefault((int(image[0] // 50), int(image[1] // 50)), []).append(image)
        compared = 0
        for x, y, radius, kind in original:
            if not (40 < x < 360 and 40 < y < 260):
                continue
            near = min((other for i in (-1, 0, 1) for j in (-1, 0, 1)
                        for other in cells.get((int(x // 50) + i, int(y // 50) + j), [])),
                       key=lambda other: math.hypot(other[0] - x, other[1] - y))
            self.assertLess(math.hypot(near[0] - x, near[1] - y) / 32, accuracy)
            self.assertLess(abs(near[2] / radius - 1), 100 * accuracy)
            if tell_types:
                value, unit = found[near[3]].split()
                metres = float(value) * {"mm": 1e-3, "um": 1e-6}[unit]
                self.assertLess(abs(metres / (1e-3 * FOCAL[names[kind]]) - 1), 1e-9)
            compared += 1
        self.assertGreater(compared, 50)

    def export(self, form):
        self.succeeds("export", "raw.exr", "--format", form, "--name", "camera", "-o", "out")

    def test_libpleno_distortion_comes_back(self):
        keys = {"k1": -0.05, "k2": 0.3, "k3": -0.2, "p1": 0.001, "p2": -0.002}
        text = SCENE % (0, 0, 0, 0, "hexagonal", 0.3, 0, 0, "".join(TYPE % (n, FOCAL[n]) for n in "abc"))
        text = text.replace("[camera.focus]", "[camera.lens.distortion]\n%s\ndistance = \"450 mm\"\n[camera.focus]"
                            % "\n".join("%s = %g" % item for item in keys.items()))
        write_light_field(self.path("raw.exr"), [[1e-12] * 400] * 300, scene=text)
        self.export("libpleno")
        with open(self.path("out/camera.js"), encoding="utf-8") as file:
            written = json.load(file)
        # libpleno's image points in mm, whose plane is a thin lens' image of the plane that stays sharp.
        a = 1 / (1 / 50 - 1 / 450)
        self.assertLess(abs(written["distortions"]["radial"][0][0] * a**2 / keys["k1"] - 1), 1e-9)
        self.assertLess(abs(-written["distortions"]["tangential"][0][0] * a / keys["p2"] - 1), 1e-9)
        def moved(x, y, c):
            (k,), (p,) = c["radial"], c["tangential"]
            r2 = x * x + y * y
            f = 1 + k[0] * r2 + k[1] * r2**2 + k[2] * r2**3
            return (f * x + p[0] * (r2 + 2 * x * x) + 2 * p[1] * x * y,
                    f * y + p[1] * (r2 + 2 * y * y) + 2 * p[0] * x * y)
        for place in ((0.4, 0.3), (-0.5, 0.2)):
            back = moved(*moved(*place, written["distortions"]), written["distortions_inverse"])
            self.assertLess(math.dist(back, place), 1e-6 * math.hypot(*place))
        self.succeeds("camera", "import", "out/camera.js", "-o", "camera.toml")
        with open(self.path("camera.toml"), encoding="utf-8") as file:
            found = file.read().split("[camera.lens.distortion]")[1].split("[")[0]
        for key, value in keys.items():
            line = next(line for line in found.splitlines() if line.startswith(key + " "))
            self.assertLess(abs(float(line.split("=")[1]) / value - 1), 1e-9)

    def test_libpleno_projects_points_as_its_own_model(self):
        """A point's image by the file's numbers: thin lens, moved by the polynomials in mm, from there straight through the
        middle of a microlens. Rays of the camera, through the middle of their microlenses by a line through where they arrive.
        """
        f, pitch, pixel, width, height, array_z, sensor_z = 50.0, 0.1, 0.004, 500, 400, -58.0, -58.3
        radial, tangential = (3e-2, -2e-3, 1e-5), (1e-2, -5e-3)
        first, corner = (-2.6, -2.2), (-1.1, -0.7)
        turn = 0.01
        c, s = math.cos(turn), math.sin(turn)
        self.write("camera.js", json.dumps({
            "I": 1, "dist_focus": 450, "distortions": {"radial": [radial], "tangential": [tangential]},
            "main_lens": {"f": f, "aperture": 4},
            "sensor": {"width": width, "height": height, "scale": pixel, "pose": {"translation": [[*corner, sensor_z]]}},
            "mla": {"focal_lengths": [0.5], "mesh": {"geometry": 1, "width": 60, "height": 60, "pitch": [[pitch, pitch]], "pose": {
                "rotation": [[c, s, 0], [-s, c, 0], [0, 0, 1]], "translation": [[*first, array_z]]}}}}))
        def node(k, l):
            x, y = pitch * (k + (0.5 if l % 2 == 0 else 0)), pitch * l * math.sqrt(0.75)
            return first[0] + c * x - s * y, first[1] + s * x + c * y
        nodes = [node(k, l) for k in range(60) for l in range(60)]
        middle = [corner[0] + (width - 1) / 2 * pixel, corner[1] + (height - 1) / 2 * pixel]
        def image(x, y, z, moved):
            scale = -f / (z - f)
            x, y = scale * x, scale * y
            r2, (p, q) = x * x + y * y, tangential
            k = 1 + sum(a * r2 ** (i + 1) for i, a in enumerate(radial))
            if moved:
                x, y = k * x + p * (r2 + 2 * x * x) + 2 * q * x * y, k * y + q * (r2 + 2 * y * y) + 2 * p * x * y
            return x, y, scale * z
        def misses(point):
            """[(from the model, moved by the distortion)] in pixels, by microlens."""
            world = (point[2], middle[0] - point[0], middle[1] - point[1])
            self.succeeds("rays", "camera.toml", "--point", ", ".join("%.15g mm" % x for x in world), "--rays", "3000",
                          "--status", "reached", "-o", "rays.json")
            through = {}
            for ray in json.loads(self.read("rays.json"))["rays"]:
                if ray["pixel"][0] >= 0:
                    through.setdefault(tuple(ray["microlens"]), []).append(
                        [(-1e3 * v["position"][1] + middle[0], -1e3 * v["position"][2] + middle[1]) for v in ray["vertices"][2:4]])
            found = []
            for rays in through.values():
                if len(rays) < 10:
                    continue
                mean = [[sum(ray[i][j] for ray in rays) / len(rays) for j in (0, 1)] for i in (0, 1)]
                steps = [(ray[0][j] - mean[0][j], ray[1][j] - mean[1][j]) for ray in rays for j in (0, 1)]
                slope = sum(a * b for a, b in steps) / sum(a * a for a, _ in steps)
                lens = min(nodes, key=lambda n: math.dist(n, mean[0]))
                arrives = [mean[1][j] + slope * (lens[j] - mean[0][j]) for j in (0, 1)]
                places = []
                for moved in (True, False):
                    there = image(*point, moved)
                    t = (sensor_z - array_z) / (there[2] - array_z)
                    places.append([lens[j] + t * (there[j] - lens[j]) for j in (0, 1)])
                found.append((math.dist(arrives, places[0]) / pixel, math.dist(*places) / pixel))
            self.assertGreater(len(found), 1)
            return found
        # The map is exact for objects at dist_focus, or at the distance that is given.
        for distance, options in ((450, []), (300, ["--set", "camera.lens.distortion.distance=300mm"])):
            report = self.imported("camera.js", *options)
            self.assertIn("%d mm" % distance, "".join(report["notes"]))
            self.write("camera.toml", self.read("camera.toml").decode().replace("flames = []\n", "") + GLOWING_POINT.replace(
                "[[flames.layers]]", 'position = ["1 m", "0 m", "0 m"]\n[[flames.layers]]\nsemi_axes = ["1 mm", "1 mm", "1 mm"]'))
            worst = moved = 0
            for x, y in ((-5, 3), (4.5, 4)):
                for miss, effect in misses((x * distance / 450, y * distance / 450, distance)):
                    worst, moved = max(worst, miss), max(moved, effect)
            self.assertLess(worst / moved, 1e-9)
        self.fails(1, "camera", "import", "camera.js", "-o", "b.toml", "--set", "camera.lens.distortion.distance=40mm",
                   mentions=["within the focal length"])
        self.assertNotIn("b.toml", self.files())

    def imported(self, *arguments):
        return self.json_of("camera", "import", *arguments, "-o", "camera.toml")

    def test_libpleno_centres_are_those_of_its_own_model(self):
        """Micro-images' centres by the file's numbers, as libpleno projects them: nodes of the array, turned and moved by its pose,
        straight from the middle of the main lens to the sensor. Its pictures are turned by 180 degrees.
        """
        pitch, pixel, width, height, array_z, sensor_z = 0.1, 0.0025, 400, 300, -56.7, -57.1
        corner, first, about = (-0.31, -0.52), (-0.61, -0.75), (0.004, -0.006, 0.003)
        (cx, sx), (cy, sy), (cz, sz) = ((math.cos(a), math.sin(a)) for a in about)
        columns = ((cy * cz, cy * sz, -sy), (sx * sy * cz - cx * sz, sx * sy * sz + cx * cz, sx * cy),
                   (cx * sy * cz + sx * sz, cx * sy * sz - sx * cz, cx * cy))
        across, down = 16, 18
        self.write("camera.js", json.dumps({
            "I": 3, "dist_focus": 450, "main_lens": {"f": 50, "aperture": 4},
            "sensor": {"width": width, "height": height, "scale": pixel, "pose": {"translation": [[*corner, sensor_z]]}},
            "mla": {"focal_lengths": [0.58, 0.5, 0.55], "mesh": {
                "geometry": 1, "width": across, "height": down, "pitch": [[pitch, pitch]],
                "pose": {"rotation": columns, "translation": [[*first, array_z]]}}}}))
        expected = []
        for l in range(down):
            for k in range(across):
                x, y = pitch * (k + (0.5 if l % 2 == 0 else 0)), pitch * l * math.sqrt(0.75)
                node = [t + x * columns[0][i] + y * columns[1][i] for i, t in enumerate((*first, array_z))]
                u, v = ((sensor_z / node[2] * node[i] - corner[i]) / pixel for i in (0, 1))
                expected.append((width - 0.5 - u, height - 0.5 - v))
        self.imported("camera.js")
        self.scene()
        found = [(x, y) for x, y, _, _ in self.images("--scene", "camera.toml")]
        inside = [c for c in found if 20 < c[0] < width - 20 and 20 < c[1] < height - 20]
        self.assertGreater(len(inside), 50)
        worst = max(min(math.dist(c, e) for e in expected) for c in inside)
        self.assertLess(worst * pixel / pitch, 1e-6)
        # Each of its nodes has a micro-image, too.
        for e in expected:
            if 20 < e[0] < width - 20 and 20 < e[1] < height - 20:
                self.assertLess(min(math.dist(c, e) for c in found) * pixel / pitch, 1e-6)

    def test_libpleno(self):
        self.scene(decentre=(0.2, -0.1), tilt=(0.5, -0.8), array_tilt=(-0.3, 0.2))
        self.export("libpleno")
        report = self.imported("out/camera.js", "out/params.js")
        self.assertEqual(report["formats"], ["libpleno", "libpleno-parameters"])
        self.compare("abc", 1e-9)

    def test_libpleno_square(self):
        self.scene("b", "square", rotation=-2)
        self.export("libpleno")
        self.imported("out/camera.js")
        self.compare("b", 1e-9)

    def test_pip(self):
        self.scene("b", decentre=(0.2, -0.1))
        self.export("pip")
        self.imported("out/camera.xml", "--set", "camera.lens.f_number=4", *focal("b"))
        self.compare("b", 1e-6)

    def test_plenoptic_toolbox(self):
        self.scene()
        self.export("plenoptic-toolbox")
        self.imported("out/camera.xml", *OPTICS, *SIZE, *focal("abc"))
        self.compare("abc", 1e-6)

    def test_plenopticam(self):
        for lattice in ("hexagonal", "square"):
            self.scene("unfocused", lattice)
            self.succeeds("export", "raw.exr", "--format", "plenopticam", "--name", "camera", "--force", "-o", "out")
            self.imported("out/camera_white.json", *OPTICS, *SIZE, *focal(["unfocused"]))
            self.compare("unfocused", 1e-6)

    def test_plenoptomos(self):
        self.write("lab.ini", "[micro_lenses_array]\nz=400.0\n[micro_lens]\nphysical_size_s=300e-3\n"
                   "physical_size_t=310e-3\nf2=18.6\n[sensor]\npixel_size_x=6.45e-3\npixel_size_y=6.45e-3\nsize_x=200\n"
                   "size_y=100\nz=418.6\n[main_lens]\nf1=200.0\naperture=6.6\n")
        report = self.imported("lab.ini")
        self.assertLess(abs(report["object_distance"] / 0.4 - 1), 1e-12)
        with open(self.path("camera.toml"), encoding="utf-8") as file:
            text = file.read()
        # 6.6 as an f-number would make micro-images four times as wide as the lenses.
        for line in ('diameter = "6.6 mm"', 'pitch = "300 um"', 'pitch_y = "310 um"', 'lattice = "square"'):
            self.assertIn(line, text)

    def test_vox(self):
        # The file knows the distances and the pitch; its pixels are those of the views.
        beside = ["--set", 'camera.array.offset=10 um, -7 um', "--set", "camera.sensor.pixel_pitch=2.5um"]
        self.scene("unfocused", "square", rotation=0)
        self.export("plenoptomos")
        report = self.imported("out/camera.vox", *SIZE, *beside)
        self.assertEqual(report["formats"], ["vox"])
        self.compare("unfocused", 1e-6)
        # Nothing else is needed for a camera.
        self.imported("out/camera.vox")
        self.succeeds("render", "camera.toml", "--white", "--quiet", "-o", "white.exr")
        self.scene("b", rotation=0.3)
        self.succeeds("export", "raw.exr", "--format", "plenoptomos", "--name", "camera", "--force", "-o", "out")
        self.imported("out/camera.vox", *SIZE, *beside, "--set", "camera.array.lattice=hexagonal",
                      "--set", "camera.array.rotation=0.3deg")
        self.compare("b", 1e-6)

    def test_vox_of_the_tool(self):
        # As plenoptomos itself writes them: single precision, sizes as 0 that it does not know, an f-number.
        def write(name, change=None):
            with h5py.File(self.path(name), "w") as file:
                file.attrs["description"], file.attrs["version"] = "VoxelDataFormat", "v0"
                file["data/image"] = [[1.0]]
                file["data/image"].attrs["mode"] = "raw"
                camera = file.create_group("instrument/camera")
                values = {"micro_lens/size": [15, 15], "micro_lens/physical_size": [0.31, 0.3],
                          "micro_lens/micro_image_size": [0, 0], "micro_lens/f2": 18.6, "micro_lens/aperture": 0.3,
                          "micro_lenses_array/size": [10, 20], "micro_lenses_array/position": [0, 0, 400],
                          "main_lens/pixel_size": [1, 1], "main_lens/f1": 200, "main_lens/aperture": 30,
                          "sensor/size": [100, 200], "sensor/pixel_size": [0.0065, 0.00645],
                          "sensor/position": [0, 0, 418.6]}
                values.update(change or {})
                for path, value in values.items():
                    camera.create_dataset(path, data=value, dtype="i" if path.endswith("/size") else "f")
        write("lab.vox")
        self.imported("lab.vox")
        with open(self.path("camera.toml"), encoding="utf-8") as file:
            text = file.read()
        for key, expected in (("columns", 200), ("rows", 100)):
            self.assertIn(f"{key} = {expected}\n", text)
        for key, expected in (("pitch", 300e-6), ("pitch_y", 310e-6), ("pixel_pitch", 6.45e-6), ("diameter", 200e-3 / 30),
                              ("lens_distance", 0.4), ("sensor_distance", 18.6e-3)):
            value, unit = next(line for line in text.splitlines() if line.startswith(key + " = ")).split('"')[1].split()
            # Single precision, after the difference of two places.
            self.assertLess(abs(float(value) * {"mm": 1e-3, "um": 1e-6, "m": 1, "cm": 1e-2}[unit] / expected - 1), 1e-5, key)
        for change, mentions in (({"main_lens/f1": math.nan}, "main_lens/f1 is no finite"),
                                 ({"sensor/size": [1, 2, 3]}, "sensor/size is not 2 numbers"),
                                 ({"sensor/position": [0, 0, 300]}, "does not stand behind")):
            write("bad.vox", change)
            before = self.read("camera.toml")
            self.fails(1, "camera", "import", "bad.vox", "-o", "camera.toml", mentions=["bad.vox", mentions])
            self.assertEqual(self.read("camera.toml"), before)

    def test_lf_toolbox(self):
        for types, lattice, tolerance in (("b", "hexagonal", 1e-6), ("unfocused", "square", 1e-6)):
            self.scene(types, lattice, rotation=-1.5)
            self.succeeds("export", "raw.exr", "--format", "view-grid", "--name", "camera", "--force", "-o", "out")
            report = self.imported("out/views.json", *OPTICS, *SIZE, *focal([types]))
            self.assertEqual(report["formats"], ["lf-toolbox"])
            self.compare(types, tolerance)
        # That tool counts pixels from 1, from the top left, and shifts every second row.
        self.write("white.grid.json", json.dumps({"LensletGridModel": {
            "HSpacing": 33, "VSpacing": 33 * math.sqrt(0.75), "HOffset": 20.0, "VOffset": 15.5, "Rot": 0, "UMax": 11,
            "VMax": 10, "FirstPosShiftRow": 2, "Orientation": "horz"}}))
        self.imported("white.grid.json", *OPTICS, *SIZE, *focal(["b"]))
        centres = [image[:2] for image in self.images("--scene", "camera.toml")]
        for expected in ((19.5, 15), (19.5 + 33, 15), (19.5 + 16.5, 15 + 33 * math.sqrt(0.75))):
            self.assertLess(min(math.dist(expected, centre) for centre in centres) / 33, 1e-6)

    def test_whole_scenes_come_back(self):
        self.scene(decentre=(0.2, -0.1), tilt=(0.5, -0.8), array_tilt=(-0.3, 0.2))
        self.export("hdf5")
        report = self.imported("out/camera.h5")
        self.assertEqual(report["formats"], ["hdf5"])
        self.compare("abc", 1e-9)
        self.succeeds("export", "raw.exr", "--format", "npz", "--name", "camera", "-o", "npz")
        self.write("camera.toml", self.read("npz/camera.toml"))
        self.compare("abc", 1e-9)
        self.fails(1, "camera", "import", "out/camera.h5", "out/camera.h5", "-o", "b.toml", mentions=["alone"])
        with h5py.File(self.path("other.h5"), "w") as file:
            file["x"] = [1.0]
        self.fails(1, "camera", "import", "other.h5", "-o", "b.toml", mentions=["other.h5", "known are libpleno"])
        self.write("cut.h5", self.read("out/camera.h5")[:3000])
        self.fails(1, "camera", "import", "cut.h5", "-o", "b.toml", mentions=["cut.h5"])
        self.assertNotIn("b.toml", self.files())

    def test_missing_values_are_all_named(self):
        self.scene()
        self.export("plenoptic-toolbox")
        keys = ("camera.sensor.columns", "camera.lens.focal_length", "camera.array.sensor_distance",
                "camera.array.types[2].focal_length")
        self.fails(1, "camera", "import", "out/camera.xml", "-o", "camera.toml",
                   mentions=["%s=" % key for key in keys])
        self.assertFalse(os.path.exists(self.path("camera.toml")))

    def test_wrong_files(self):
        def refused(name, content, mentions):
            if content is not None:
                self.write(name, content)
            self.fails(1, "camera", "import", name, "-o", "c.toml", mentions=[mentions])

        refused("empty.js", "", "known are libpleno")
        refused("cut.js", '{"main_lens": {"f": 50},\n "mla": {', "cut.js:2")
        refused("cut.xml", "<RayCalibData>\n<offset>", "cut.xml")
        refused("none.js", None, "none.js")
        refused("lab.ini", "[micro_lenses_array]\nz=nan\n", "no number")
        self.assertFalse(os.path.exists(self.path("c.toml")))


if __name__ == "__main__":
    main()
