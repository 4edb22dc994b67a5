"""plenoflame export: every format read back by its tool's own rules, on scenes with known answers.

A small sphere glows at a known place before a camera of ideal thin lenses, so that similar triangles say where its
image lies behind every microlens, and in every view. The readers here are written from the formats' descriptions.
"""

import configparser
import json
import math
import os
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np
from command import CommandTest, main
from exr import read_png, write_light_field
from export_scenes import D, FOCALS, FOCUSED, IMAGE, POINT, SCENE, STOP, UNFOCUSED, WINDOW, X, Y, Z


def linear(samples, most):
    """sRGB to light, IEC 61966-2-1."""
    v = np.asarray(samples, dtype=float) / most
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def grey(path):
    """The light in a picture; channels must agree."""
    width, height, bits, channels, rows, _ = read_png(path)
    values = np.asarray(rows, dtype=float).reshape(height, width, channels)
    for c in range(channels):
        assert (values[..., c] == values[..., 0]).all()
    return linear(values[..., 0], 2 ** bits - 1)


def centroid(image, x, y, radius):
    """Of the light within a radius of (x, y); pixels are centred on whole numbers."""
    columns, rows = np.meshgrid(np.arange(image.shape[1]), np.arange(image.shape[0]))
    light = np.where((columns - x) ** 2 + (rows - y) ** 2 < radius ** 2, image, 0)
    return np.array([(light * columns).sum(), (light * rows).sum()]) / light.sum()


class Focused:
    """Where the light of the point falls behind a microlens of the hexagonal camera."""

    pixel, gap, pitch = 2.5e-6, 0.4e-3, 80e-6

    def to_pixel(self, s):
        """Pixel of the window (centres on whole numbers) of a sensor point."""
        return np.array([200 - s[0] / self.pixel - 0.5 - WINDOW[0], 150 - s[1] / self.pixel - 0.5 - WINDOW[1]])

    def lens(self, q, r):
        v = self.pitch * np.array([q + r / 2, r * math.sqrt(0.75)])
        c, s = math.cos(0.03), math.sin(0.03)
        return np.array([c * v[0] - s * v[1] + 10e-6, s * v[0] + c * v[1] - 7e-6])

    def centre(self, q, r):
        """Of the micro-image."""
        return self.to_pixel(self.lens(q, r) * (1 + self.gap / D))

    def spot(self, q, r):
        c = self.lens(q, r)
        return self.to_pixel(c + (POINT - c) * self.gap / (IMAGE - D))

    def seeing(self):
        """Microlenses through whose whole aperture the main lens sends the point's light."""
        found = []
        for r in range(-9, 10):
            for q in range(-12, 13):
                on_stop = POINT + (self.lens(q, r) - POINT) * IMAGE / (IMAGE - D)
                if np.hypot(*on_stop) < 0.5 * STOP - 0.5 * self.pitch * IMAGE / (IMAGE - D) - 0.6e-3:
                    found.append((q, r))
        return found

    def nearest(self, x, y):
        """(q, r) of the microlens whose micro-image is at a pixel, and the distance."""
        best = min(((np.hypot(*(self.centre(q, r) - (x, y))), q, r) for r in range(-9, 10) for q in range(-12, 13)))
        return best[1], best[2], best[0]


class Export(CommandTest):
    _cache = {}

    def scene(self, camera, radius_mm):
        return SCENE % (Z, -X, -Y, radius_mm, radius_mm, radius_mm) + camera

    def rendered(self, name, camera, radius_mm, *options):
        """Renders once for all tests."""
        if name not in self._cache:
            self.write("scene.toml", self.scene(camera, radius_mm))
            self.succeeds("render", "scene.toml", "-o", "raw.exr", "--samples", "64", "--quiet", *options)
            self._cache[name] = self.read("raw.exr")
        self.write("raw.exr", self._cache[name])

    def focused(self):
        self.rendered("focused", FOCUSED % "hexagonal", 0.5, "--window", "%d,%d,%d,%d" % WINDOW)

    def unfocused(self):
        self.rendered("unfocused", UNFOCUSED, 2.2, "--truth")

    def export(self, name, *options):
        result = self.json_of("export", "raw.exr", "--format", name, "-o", name, *options)
        self.assertEqual(sorted(result["files"]), sorted(os.listdir(self.path(name))))
        return result

    def check_spots(self, image, centres):
        """centres: {(q, r): pixel} as the tool finds them. The spot behind each microlens must be where the point's
        light goes, measured from the centre that the tool takes."""
        geometry = Focused()
        seeing = geometry.seeing()
        self.assertGreaterEqual(len(seeing), 6)
        for lens in seeing:
            self.assertIn(lens, centres)
            expected = geometry.spot(*lens) - geometry.centre(*lens)
            spot = centroid(image, *geometry.spot(*lens), 9)
            error = np.hypot(*(spot - centres[lens] - expected))
            self.assertLess(error, 0.12, (lens, spot, centres[lens], expected))
        # Disparity: how the spot moves within the micro-images from lens to lens, over the lenses' pitch. At virtual
        # depth v = a / B it is 1 / |v|; seen from the main lens' axis the micro-images themselves spread by B / D.
        x = np.array([centres[lens] for lens in seeing])
        moved = np.array([centroid(image, *geometry.spot(*lens), 9) for lens in seeing]) - x
        x, moved = (x - x.mean(axis=0)).ravel(), (moved - moved.mean(axis=0)).ravel()
        gap = geometry.gap
        expected = -(gap / (IMAGE - D) + gap / D) / (1 + gap / D)
        self.assertLess(abs((x @ moved) / (x @ x) / expected - 1), 0.01)

    # PlenopticToolbox2.0
    def assert_timeless(self, file):
        """Equal runs make equal files: no object tells when it was made."""
        names = []
        file.visit(names.append)
        self.assertTrue(names)
        self.assertEqual({name: h5py.h5g.get_objinfo(file.id, name.encode()).mtime for name in names}, dict.fromkeys(names, 0))

    def test_plenoptic_toolbox(self):
        self.focused()
        self.export("plenoptic-toolbox")
        root = ElementTree.parse(self.path("plenoptic-toolbox/raw.xml")).getroot()
        self.assertEqual((root.tag, root.attrib["version"]), ("RayCalibData", "1.0"))

        def pair(parent, name):
            (node,) = parent.findall(name)
            return float(node.find("x").text), float(node.find("y").text)
        image = grey(self.path("plenoptic-toolbox/raw.png"))
        self.assertEqual(read_png(self.path("plenoptic-toolbox/raw.png"))[3], 3)
        x, y = pair(root, "offset")
        offset = np.array([-y, x])
        diameter, angle = float(root.find("diameter").text), float(root.find("rotation").text)
        bx, by = pair(root, "lens_base_x"), pair(root, "lens_base_y")
        pair(root, "sub_grid_base")
        lbx, lby = np.array([-bx[1], bx[0]]), -np.array([-by[1], by[0]]) + np.array([-bx[1], bx[0]])
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        middle = (np.array(image.shape) - 1) / 2
        ids = {}
        for i in range(3):
            (entry,) = [e for e in root.findall("lens_type") if e.attrib["id"] == str(i)]
            p = [int(v) for v in pair(entry, "offset")]
            ids[((-p[0] % 3) + p[1]) % 3] = i
            low, high = float(entry.find("depth_range/min").text), float(entry.find("depth_range/max").text)
            self.assertLess(low, high)
            self.assertGreaterEqual(low, 1)
        self.assertEqual(sorted(ids), [0, 1, 2])
        geometry, centres = Focused(), {}
        for c0 in range(-14, 15):
            for c1 in range(-16, 17):
                row, column = turn @ (diameter * (c0 * lby + c1 * lbx)) + offset + middle
                if not (0 <= row < image.shape[0] and 0 <= column < image.shape[1]):
                    continue
                q, r, distance = geometry.nearest(column, row)
                self.assertLess(distance, 0.15)
                centres[q, r] = np.array([column, row])
                self.assertEqual(ids[((-c0 % 3) + c1) % 3], (q - r) % 3)
        self.check_spots(image, centres)

    # libpleno
    def test_libpleno(self):
        self.focused()
        self.export("libpleno")

        def load(name):
            with open(self.path("libpleno/" + name), encoding="utf-8") as file:
                return json.load(file)
        camera, images, params = load("camera.js"), load("images.js"), load("params.js")
        self.assertEqual((camera["I"], camera["mode"]), (3, 2))  # f > B: Galilean
        for value, expected in ((camera["main_lens"]["f"], 50), (camera["main_lens"]["aperture"], 5),
                                (camera["sensor"]["scale"], 2.5e-3), (camera["dist_focus"], 1000),
                                (params["dC"], 0.08), (params["N"], 5)):
            self.assertLess(abs(value / expected - 1), 1e-6)
        mesh = camera["mia"]["mesh"]
        self.assertEqual(mesh["geometry"], 1)
        (u0, v0), = mesh["pose"]["translation"]
        turn, ((pitch, _),) = np.array(mesh["pose"]["rotation"]).T, mesh["pitch"]  # a list of columns
        mla = camera["mla"]["mesh"]
        image = grey(self.path("libpleno/" + images["images"][0]["path"]))
        geometry, centres = Focused(), {}
        width, height = mesh["width"], mesh["height"]
        self.assertEqual((mla["width"], mla["height"]), (width, height))
        self.assertLess(abs(mla["pose"]["translation"][0][2] / (-1e3 * D) - 1), 1e-9)

        def node(k, l, pitch, turn, origin):
            local = pitch * np.array([k + (0.5 if l % 2 == 0 else 0), l * math.sin(math.pi / 3)])
            return turn @ local + origin
        for l in range(height):
            for k in range(width):
                uv = node(k, l, pitch, turn, (u0, v0))  # pixels have their centres at whole numbers
                if not (0 <= uv[0] < image.shape[1] and 0 <= uv[1] < image.shape[0]):
                    continue
                q, r, distance = geometry.nearest(*uv)
                self.assertLess(distance, 0.15)
                centres[q, r] = uv
                kind = ((l % 2) + k) % 3
                self.assertLess(abs(camera["mla"]["focal_lengths"][kind] / FOCALS[(q - r) % 3] - 1), 1e-6)
                # The microlens itself, numbered from the other corner.
                t = np.array(mla["pose"]["rotation"]).T[:2, :2]
                lens = node(width - 1 - k, height - 1 - l, mla["pitch"][0][0], t, mla["pose"]["translation"][0][:2])
                self.assertLess(np.hypot(*(1e-3 * lens - geometry.lens(q, r))), 1e-9)
        self.check_spots(image, centres)
        # White images: the same micro-images, smaller at each step.
        self.assertEqual([w["frame"] for w in images["whites"]], [0, 1, 2, 3])
        light = [grey(self.path("libpleno/" + w["path"])) for w in images["whites"]]
        covered = [(white > 0.5).mean() for white in light]
        self.assertEqual(covered, sorted(covered, reverse=True))
        for i, white in enumerate(images["whites"]):
            self.assertLess(abs(white["fnumber"] / (5 * 2 ** (0.5 * i)) - 1), 1e-6)
            # m / N + q: in focus (q about 0 for type b) the radius of the stop's image.
        radius = params["m"] / params["N"] / params["scale"]
        self.assertLess(abs(radius / (0.4e-3 * 5e-3 / D / 2.5e-6) - 1), 1e-6)

    # PlenopticImageProcessing
    def test_pip(self):
        self.focused()
        self.export("pip")
        root = ElementTree.parse(self.path("pip/raw.xml")).getroot()
        self.assertEqual(root.tag, "opencv_storage")
        node = root.find("MlaDescription")

        def scalar(name):
            text = node.find(name).text
            self.assertTrue("." in text or "e" in text, (name, text))  # OpenCV: whole numbers are not real
            return float(text)

        def pair(name):
            return np.array([float(v) for v in node.find(name).text.split()])
        image = grey(self.path("pip/raw.png"))
        self.assertEqual(list(pair("SensorResPX")), [image.shape[1], image.shape[0]])
        angle, distance, scale = scalar("GridRotRAD"), scalar("MicroLensDistancePX"), scalar("MlaImageScale")
        centre, axis = pair("MlaCenterPX"), pair("MainPrincipalPointPX")
        self.assertLess(abs(distance / 32 - 1), 1e-6)
        self.assertLess(abs(scale / (1 + 0.4e-3 / D) - 1), 1e-4)
        self.assertLess(abs(scalar("MicroLensFocalLengthPX") / 160 - 1), 1e-6)
        self.assertLess(abs(scalar("MainLensFDistMM") / (1e3 * D) - 1), 1e-6)
        c, s = math.cos(-angle), math.sin(-angle)
        geometry, centres = Focused(), {}
        for j in range(-12, 13):
            for i in range(-20, 21):
                v = np.array([i + 0.5 * j, math.sqrt(0.75) * j])
                lens = distance * np.array([c * v[0] - s * v[1], s * v[0] + c * v[1]]) + centre
                at = scale * (lens - axis) + axis
                if not (0 <= at[0] < image.shape[1] and 0 <= at[1] < image.shape[0]):
                    continue
                q, r, error = geometry.nearest(*at)
                self.assertLess(error, 0.15)
                centres[q, r] = at
        self.check_spots(image, centres)

    # plenopticam
    def test_plenopticam(self):
        self.rendered("small", UNFOCUSED, 0.5)  # seen from a microlens it must lie within the stop
        self.export("plenopticam")
        with open(self.path("plenopticam/raw_white.json"), encoding="utf-8") as file:
            calibration = json.load(file)
        self.assertEqual(calibration["pat_type"], "rec")
        pitch = 20 * (1 + 0.5e-3 / D)
        for value in calibration["ptc_mean"]:
            self.assertLess(abs(value / pitch - 1), 1e-3)
        centres = calibration["mic_list"]
        self.assertEqual(len({(c[2], c[3]) for c in centres}), len(centres))
        self.assertEqual(min(c[2] for c in centres), 0)
        image, white = grey(self.path("plenopticam/raw.png")), grey(self.path("plenopticam/raw_white.png"))
        self.assertEqual(image.shape, white.shape)
        for row, column, lens_row, lens_column in centres[::37]:
            # The white spot is round about its centre, weighed within a circle that holds all of it and nothing of
            # its neighbours (the table of white light knows a sharp rim to half a pixel of 60 around it); rows and
            # columns count from the top left.
            self.assertLess(np.hypot(*(centroid(white, column, row, 10.6) - (column, row))), 0.05)
            base = centres[0]
            self.assertLess(abs(row - base[0] - pitch * (lens_row - base[2])), 1e-3)
            self.assertLess(abs(column - base[1] - pitch * (lens_column - base[3])), 1e-3)
        # The point's light behind a microlens comes from where the main image, seen from it, lies.
        lit = 0
        for row, column, _, _ in centres:
            lens = np.array([(299.5 - column) * 5e-6, (239.5 - row) * 5e-6]) / (1 + 0.5e-3 / D)
            stop = POINT + (lens - POINT) * IMAGE / (IMAGE - D)
            if np.hypot(*stop) > 2.5e-3:
                continue
            expected = stop * 0.5e-3 / D / 5e-6  # up the stop is up in the upright micro-image
            spot = centroid(image, column, row, 9) - (column, row)
            self.assertLess(np.hypot(*(spot - expected)), 0.35, (row, column))
            lit += 1
        self.assertGreaterEqual(lit, 2)

    def test_plenopticam_views(self):
        """Views as the tool makes them: one sample per microlens beside each centre of mic_list, between pixels, over that
        of the white image; the point comes out at its pixel of each and moves by its disparity."""
        self.unfocused()
        self.export("plenopticam")
        with open(self.path("plenopticam/raw_white.json"), encoding="utf-8") as file:
            centres = json.load(file)["mic_list"]
        image, white = grey(self.path("plenopticam/raw.png")), grey(self.path("plenopticam/raw_white.png"))

        def between(picture, x, y):
            i, j = int(math.floor(x)), int(math.floor(y))
            a, b = x - i, y - j
            return ((1 - b) * ((1 - a) * picture[j, i] + a * picture[j, i + 1]) +
                    b * ((1 - a) * picture[j + 1, i] + a * picture[j + 1, i + 1]))
        shape = tuple(int(max(c[k] for c in centres)) + 1 for k in (2, 3))

        def view(x, y):
            result = np.zeros(shape)
            for row, column, lens_row, lens_column in centres:
                result[int(lens_row), int(lens_column)] = (between(image, column + x, row + y) /
                                                           between(white, column + x, row + y))
            return result
        offsets = self.offsets(5)
        views = [[view(*offset) for offset in row] for row in offsets]
        self.check_views(views, offsets)
        self.check_disparity(views, 0.7 * STOP / 5 * (1 - D / IMAGE) / 100e-6)

    def check_views(self, views, offsets):
        """views[v][u]: pictures; offsets[v][u]: raw pixels from the micro-images' centres."""
        for v, row in enumerate(views):
            for u, view in enumerate(row):
                expected = self.view_point(view, offsets[v][u])
                light = centroid(view, *expected, 6)
                self.assertLess(np.hypot(*(light - expected)), 0.06, (v, u, light, expected))

    def disparity(self, views):
        """[view pixel] from one view to the next, to the right and down, measured."""
        n = len(views)
        places = [[centroid(views[v][u], *self.view_point(views[v][u], self.offsets(n)[v][u]), 6) for u in range(n)]
                  for v in range(n)]
        across = np.mean([np.polyfit(np.arange(n), [places[v][u][0] for u in range(n)], 1)[0] for v in range(n)])
        down = np.mean([np.polyfit(np.arange(n), [places[v][u][1] for v in range(n)], 1)[0] for u in range(n)])
        return np.array([across, down])

    def check_disparity(self, views, expected):
        """expected: [view pixel] per view, as the file's own figures say. A nearer point moves against the viewpoint:
        to the left as it goes right."""
        for value in self.disparity(views):
            self.assertLess(abs(-value / expected - 1), 0.02, (value, expected))

    def check_pinholes(self, views, offsets, focal, per_offset, plane, focus):
        """Views as pinhole cameras in a plane: [view pixel], [m per raw pixel], [m], [m]."""
        step = offsets[0][1][0] - offsets[0][0][0]
        self.check_disparity(views, focal * per_offset * step * (1 / (Z - plane) - 1 / (focus - plane)))

    def view_point(self, view, offset):
        """Pixel of the point in a view of the square camera."""
        stop = np.array(offset) * 5e-6 * D / 0.5e-3
        lens = stop + (POINT - stop) * D / IMAGE
        return np.array([(view.shape[1] - 1) / 2, (view.shape[0] - 1) / 2]) - lens / 100e-6

    def offsets(self, grid):
        radius = 0.5e-3 * 5e-3 / D / 5e-6
        places = [0.7 * radius * (2 * (i + 0.5) / grid - 1) for i in range(grid)]
        return [[(x, y) for x in places] for y in places]

    # HCI 4D light field benchmark
    def test_hci(self):
        self.unfocused()
        self.export("hci")
        parser = configparser.ConfigParser()
        parser.read(self.path("hci/parameters.cfg"))
        inner, outer, meta = parser["intrinsics"], parser["extrinsics"], parser["meta"]
        width, height = int(inner["image_resolution_x_px"]), int(inner["image_resolution_y_px"])
        nx, ny = int(outer["num_cams_x"]), int(outer["num_cams_y"])
        self.assertEqual((nx, ny), (9, 9))
        views = [[grey(self.path("hci/input_Cam%03d.png" % (v * nx + u))) for u in range(nx)] for v in range(ny)]
        self.assertEqual(views[0][0].shape, (height, width))
        self.check_views(views, self.offsets(9))
        # Disparity by the toolkit's relation, lengths in mm; distances from the cameras.
        baseline, focal = float(outer["baseline_mm"]), float(inner["focal_length_mm"])
        sensor, focus = float(inner["sensor_size_mm"]), 1e3 * float(outer["focus_distance_m"])
        beta = baseline * focal * max(width, height)
        disparity = (beta * focus / (1e3 * Z) - beta) / (focus * sensor)
        self.check_disparity(views, disparity)
        self.assertLess(abs(focus / 1000 - 1), 0.01)
        self.assertLess(float(meta["disp_min"]), disparity)
        self.assertGreater(float(meta["disp_max"]), disparity)
        self.assertEqual(float(meta["depth_map_scale"]), 1)
        # Ground truth of the middle view: emission-weighted distance from the cameras, 0 where nothing glows.
        depth, truth = (self.read_pfm("hci/gt_%s_lowres.pfm" % name) for name in ("depth", "disp"))
        self.assertEqual(depth.shape, (height, width))
        column, row = np.rint(self.view_point(views[4][4], (0, 0))).astype(int)
        self.assertLess(abs(depth[row, column] / Z - 1), 2e-3)
        self.assertLess(abs(truth[row, column] / disparity - 1), 0.01)
        self.assertEqual((depth[0, 0], truth[0, 0]), (0, 0))
        # A disparity of 0 is possible, so a mask says where there is one.
        np.testing.assert_array_equal(grey(self.path("hci/gt_mask_lowres.png")) > 0, depth > 0)
        self.assertEqual(meta["ground_truth"], "emission_weighted_mean_distance_of_the_centre_view")

    def read_pfm(self, name):
        """Grey: bottom row first, little endian for a negative scale."""
        kind, size, scale, data = self.read(name).split(b"\n", 3)
        self.assertEqual(kind, b"Pf")
        self.assertLess(float(scale), 0)
        width, height = (int(n) for n in size.split())
        return np.frombuffer(data, "<f4").reshape(height, width)[::-1]

    # LFToolbox
    def test_eslf(self):
        self.unfocused()
        self.export("eslf", "--grid", "5")
        image = grey(self.path("eslf/raw.eslf.png"))
        views = [[image[v::5, u::5] for u in range(5)] for v in range(5)]
        self.check_views(views, self.offsets(5))
        # The format has no figures of the camera: by similar triangles behind the main lens.
        step = 0.7 * STOP / 5
        self.check_disparity(views, step * (1 - D / IMAGE) / 100e-6)

    def test_view_grid(self):
        self.unfocused()
        self.export("view-grid", "--grid", "3")
        names = sorted(n for n in os.listdir(self.path("view-grid")) if n.endswith(".png"))
        with open(self.path("view-grid/views.json"), encoding="utf-8") as file:
            description = json.load(file)
        self.assertEqual((description["STSize"], description["Order"]), ([3, 3], "RowMajor"))
        self.assertEqual(read_png(self.path("view-grid/" + names[0]))[3], 3)  # LFReadGantryArray wants RGB
        views = [[grey(self.path("view-grid/" + names[3 * v + u])) for u in range(3)] for v in range(3)]
        self.check_views(views, self.offsets(3))
        model = description["LensletGridModel"]
        self.assertLess(abs(model["HSpacing"] / (20 * (1 + 0.5e-3 / D)) - 1), 1e-3)
        # LFToolbox counts pixels from 1: every centre is one of a microlens, and the first is the top left one.
        pitch = 20 * (1 + 0.5e-3 / D)
        for u, v in ((0, 0), (model["UMax"] - 1, model["VMax"] - 1)):
            x, y = (model["HOffset"] - 0.5 + u * pitch, model["VOffset"] - 0.5 + v * pitch)
            for place, middle, size in ((x, 300, 600), (y, 240, 480)):
                lens = (place - middle) / pitch + 0.5
                self.assertLess(abs(lens - round(lens)), 0.01)
                self.assertTrue(0 <= place < size and (place < pitch or place > size - pitch), (u, v, place))
        geometry = description["geometry"]
        self.assertLess(abs(geometry["focus_distance_m"] - 1), 0.01)
        offsets = [[description["views"][3 * v + u]["offset_px"] for u in range(3)] for v in range(3)]
        self.check_pinholes(views, offsets, geometry["focal_length_px"], geometry["viewpoint_per_offset_m"],
                            geometry["pinhole_plane_m"], geometry["focus_distance_m"])

    # Python
    def test_npz_and_hdf5(self):
        self.unfocused()
        self.export("npz")
        self.export("hdf5")
        with np.load(self.path("npz/raw.npz")) as archive:
            arrays = {name: archive[name] for name in archive.files}
        with h5py.File(self.path("hdf5/raw.h5"), "r") as file:
            self.assert_timeless(file)
            self.assertEqual(sorted(file), sorted(arrays))
            for name, values in arrays.items():
                np.testing.assert_array_equal(file[name][()], values)
                self.assertEqual(file[name].dtype, values.dtype)
            self.assertEqual(file["raw"].attrs["units"], "W")
            self.assertEqual(file["views"].attrs["axes"], "v:u:t:s")
            self.assertIn("[camera.lens]", file.attrs["scene"])
            # The npz file's own list of units says the same.
            units = json.loads(self.read("npz/raw.json"))
            self.assertEqual(sorted(units), sorted(arrays))
            for name, entry in units.items():
                self.assertEqual((entry["units"], entry["axes"]),
                                 (file[name].attrs.get("units", ""), file[name].attrs.get("axes", "")), name)
        for name, unit in (("truth.distance", "m"), ("truth.temperature", "K"), ("truth.optical_depth", ""),
                           ("white", "m^2 sr"), ("views", "W/(m^2 sr)"), ("centres", "pixel")):
            self.assertEqual(units[name]["units"], unit)
        self.assertEqual(arrays["raw"].shape, (480, 600))
        self.check_views(arrays["views"], arrays["offsets"])
        self.check_pinholes(arrays["views"], arrays["offsets"], float(arrays["focal_length"]),
                            float(arrays["viewpoint_per_offset"]), float(arrays["pinhole_plane"]),
                            float(arrays["focus_distance"]))
        self.assertLess(abs(float(arrays["focus_distance"]) - 1), 0.01)
        # The light is what the raw file holds, and every centre is that of a microlens.
        total = self.json_of("info", "raw.exr")
        lens = np.stack([arrays["lens"][:, 0] * 100e-6 + 50e-6, arrays["lens"][:, 1] * 100e-6 + 50e-6], axis=1)
        expected = np.array([300, 240]) - lens * (1 + 0.5e-3 / D) / 5e-6
        self.assertLess(np.abs(arrays["centres"] - expected).max(), 0.15)
        self.assertIsNotNone(total)

    def test_electrons_of_the_sensor(self):
        channel = '[[channels]]\nname = "red"\nkind = "band"\nwavelength = "650 nm"\nwidth = "10 nm"\n'
        self.write("red.toml", self.scene(FOCUSED % "hexagonal", 0.5) + channel)
        self.succeeds("render", "red.toml", "-o", "watt.exr", "--samples", "8", "--quiet",
                      "--window", "%d,%d,%d,%d" % WINDOW)
        self.succeeds("develop", "watt.exr", "--sensor", "-o", "raw.exr")
        self.export("npz", "--grid", "1")
        units = json.loads(self.read("npz/raw.json"))
        self.assertEqual((units["raw"]["units"], units["views"]["units"]), ("e-", "e-/(m^2 sr)"))
        with np.load(self.path("npz/raw.npz")) as archive:
            electrons = archive["raw"]
        # Whole electrons, as many as the file says; no watt.
        np.testing.assert_array_equal(electrons, np.round(electrons))
        total = self.json_of("info", "raw.exr")["channels"][0]["total"]
        self.assertLess(abs(electrons.sum(dtype=float) / total - 1), 1e-6)
        self.assertIn(" e- in ", self.succeeds("info", "raw.exr"))

    # plenoptomos
    def test_plenoptomos(self):
        self.unfocused()
        self.export("plenoptomos", "--grid", "5")
        with h5py.File(self.path("plenoptomos/raw.vox"), "r") as file:
            self.assert_timeless(file)
            self.assertEqual((file.attrs["description"], file.attrs["version"]), ("VoxelDataFormat", "v0"))
            image = file["data/image"]
            self.assertEqual((image.attrs["units"], image.attrs["axes"], image.attrs["mode"]),
                             ("counts", "v:u:t:s", "sub-aperture"))
            self.check_views(image[()], self.offsets(5))
            camera = file["instrument/camera"]
            size_vu, size_ts = camera["micro_lens/size"][()], camera["micro_lenses_array/size"][()]
            self.assertEqual(image.shape, (*size_vu, *size_ts))
            for path, expected in (("main_lens/f1", 50), ("micro_lens/f2", 0.5), ("main_lens/aperture", 10)):
                self.assertEqual(camera[path].attrs["units"], "mm")
                self.assertLess(abs(camera[path][()] / expected - 1), 1e-6)
            z_array, z_sensor = camera["micro_lenses_array/position"][2], camera["sensor/position"][2]
            self.assertLess(abs(z_array / (1e3 * D) - 1), 1e-6)
            self.assertLess(abs((z_sensor - z_array) / 0.5 - 1), 1e-3)
            # Pixels of u, v on the main lens are seen through a microlens from the sensor.
            step = camera["sensor/pixel_size"][()] / (z_sensor - z_array) * z_array
            np.testing.assert_allclose(camera["main_lens/pixel_size"][()], step, rtol=0.01)
            # Disparity from the instrument: a viewpoint s on the lens and the image of Z, seen on the array.
            imaged = 1 / (1 / camera["main_lens/f1"][()] - 1 / (1e3 * Z))
            moved = camera["main_lens/pixel_size"][0] * (1 - z_array / imaged)
            self.check_disparity(image[()], moved / camera["micro_lens/physical_size"][0])

    def test_refusals(self):
        self.write("square.toml", self.scene(FOCUSED % "square", 0.5))
        flux = [[1e-12] * 400] * 300
        write_light_field(self.path("raw.exr"), flux, scene=self.read("square.toml").decode())

        def refused(status, name, *options, mentions):
            self.fails(status, "export", "raw.exr", "--format", name, "-o", "out", *options, mentions=mentions)
            self.assertEqual(self.files(), ["raw.exr", "square.toml"])
        for name in ("plenoptic-toolbox", "pip", "libpleno"):
            refused(1, name, mentions="hexagonal")
        refused(1, "plenopticam", mentions=["unfocused", "plenoptic 1.0"])
        refused(2, "raytrix", mentions="--format")
        refused(2, "pip", "--grid", "3", mentions="--grid")
        refused(2, "npz", "--saturation", "-1 W", mentions="--saturation")
        refused(2, "npz", "--name", "a/b", mentions="--name")

    def test_folder_with_files(self):
        self.unfocused()
        self.export("npz", "--grid", "1")
        before = self.read("npz/raw.npz")
        self.fails(1, "export", "raw.exr", "--format", "npz", "-o", "npz", mentions=["'npz'", "--force"])
        self.assertEqual(self.read("npz/raw.npz"), before)
        self.succeeds("export", "raw.exr", "--format", "npz", "-o", "npz", "--grid", "2", "--force")
        self.assertNotEqual(self.read("npz/raw.npz"), before)

    def test_camera_from_a_scene_file(self):
        self.write("scene.toml", self.scene(UNFOCUSED, 2.2))
        write_light_field(self.path("raw.exr"), [[1e-12] * 600] * 480)
        self.fails(1, "export", "raw.exr", "--format", "npz", "-o", "npz", mentions=["raw.exr", "--scene"])
        self.export("npz", "--scene", "scene.toml", "--grid", "1")


if __name__ == "__main__":
    main()
