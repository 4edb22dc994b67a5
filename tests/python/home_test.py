"""Results as arrays, with coordinates, in notebooks, pickled, and with a progress bar. References are numpy, closed forms,
and the places that scenes and flames state."""

import base64
import contextlib
import copy
import io
import pickle
import re
import struct
import sys
import unittest.mock
import warnings
import zlib

import matplotlib
import numpy
import xarray
from package import ROOT, PackageTest, main, needs_vtk

import plenoflame

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

PIXELS = 60
RINGS = {"unknowns": "rings", "grid": (5, 6), "rays": 4, "center": (1, 0, 0), "size": (0.02, 0.02, 0.06)}
QUICK = {"draws": 0, "probes": 0, "iterations": 5}


def png(page):
    """Pixels of the picture within a page, by zlib alone."""
    content = base64.b64decode(re.search(r"data:image/png;base64,([\w+/=]+)", page)[1])
    size, compressed, place = struct.unpack(">II", content[16:24]), b"", 8
    while place < len(content):
        length, = struct.unpack(">I", content[place:place + 4])
        kind, data = content[place + 4:place + 8], content[place + 8:place + 8 + length]
        assert zlib.crc32(kind + data) == struct.unpack(">I", content[place + 8 + length:place + 12 + length])[0]
        compressed += data if kind == b"IDAT" else b""
        place += 12 + length
    lines = numpy.frombuffer(zlib.decompress(compressed), numpy.uint8).reshape(size[1], 1 + 3 * size[0])
    assert not lines[:, 0].any()
    return lines[:, 1:].reshape(size[1], size[0], 3)


class Home(PackageTest):
    @classmethod
    def setUpClass(cls):
        cls.small = PackageTest.scene(cls, PIXELS)
        cls.field = cls.small.render(samples=8)
        two = cls.small.copy()
        two.insert("channels", 1)
        two["channels[1].name"] = "other"
        cls.two = two.render(samples=2, window=(30, 20, 25, 11))
        cls.views = cls.field.views(3)
        cls.sharp = cls.field.refocus(1.0)
        i, j, k = numpy.meshgrid(range(4), range(5), range(6), indexing="ij")
        cls.hot = 1000.0 + 100 * i + 10 * j + k
        cls.flame = plenoflame.flame_from_arrays(cls.hot, cls.hot / 100, spacing=(1e-3, 2e-3, 3e-3), origin=(0.5, -1, 2))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            cls.rings = plenoflame.reconstruct(cls.small, cls.field, absorption="scene", **RINGS, **QUICK)
            cls.voxels = plenoflame.reconstruct(cls.small, cls.field, grid=(4, 3, 2), rays=4, center=(1, 0, 0),
                                                size=(0.04, 0.03, 0.02), **QUICK)
        cls.operator = cls.small.operator(**RINGS)

    def test_version_is_the_projects(self):
        stated = re.search(r"^project\(plenoflame VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
        self.assertEqual(plenoflame.__version__, stated)

    def test_code_of_the_page_runs(self):
        """docs/scripting.md, with a smaller picture."""
        page = (ROOT / "docs" / "scripting.md").read_text().split("## NumPy, xarray and notebooks")[1]
        code = page.split("```python\n")[1].split("```")[0].replace('plenoflame.Scene("examples/lenslets-30.toml")', "small.copy()")
        with contextlib.redirect_stderr(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            exec(code, {"small": self.small})
        pyplot.close("all")

    # --- arrays

    def test_arrays_share_memory(self):
        for thing, own in ((self.field, self.field.flux), (self.views, self.views[1, 2]), (self.sharp, self.sharp.image),
                           (self.flame, self.flame["temperature"]), (self.rings, self.rings.temperature),
                           (self.voxels, self.voxels.emission)):
            self.assertTrue(numpy.shares_memory(numpy.asarray(thing), own), thing)
        changed = self.field.copy()
        numpy.asarray(changed)[3, 4] = 0.25
        self.assertEqual(changed.flux[3, 4], 0.25)

    def test_arrays_are_the_natural_ones(self):
        numpy.testing.assert_array_equal(self.field, self.field.flux)
        self.assertEqual(numpy.asarray(self.two).shape, (11, 25, 2))
        numpy.testing.assert_array_equal(numpy.asarray(self.two)[..., 1], self.two["other"])
        self.assertEqual(numpy.asarray(self.views).shape[:2], (3, 3))
        for row in range(3):
            for column in range(3):
                numpy.testing.assert_array_equal(numpy.asarray(self.views)[row, column], self.views[row, column])
        numpy.testing.assert_array_equal(self.flame, self.hot)
        upright = numpy.asarray(self.rings)
        self.assertEqual(upright.shape, (6, 5))
        for height in range(6):
            numpy.testing.assert_array_equal(upright[5 - height], self.rings.temperature[:, height])
        self.assertEqual(numpy.mean(self.sharp), numpy.mean(self.sharp.image))

    def test_type_and_copy(self):
        """As numpy 1.24 calls it, and as numpy 2 does."""
        self.assertEqual(numpy.asarray(self.field, dtype=float).dtype, float)
        self.assertEqual(self.field.__array__(dtype="int16").dtype, numpy.int16)
        self.assertFalse(numpy.shares_memory(numpy.array(self.field), self.field.flux))
        self.assertFalse(numpy.shares_memory(self.field.__array__(copy=True), self.field.flux))
        self.assertTrue(numpy.shares_memory(self.field.__array__(copy=False), self.field.flux))
        self.assertTrue(numpy.shares_memory(self.field.__array__(numpy.float32, copy=None), self.field.flux))
        with self.assertRaisesRegex(ValueError, "float32 becomes float64 by a copy"):
            self.field.__array__(float, copy=False)

    def test_flux_is_written_into_its_memory(self):
        changed = self.field.copy()
        flux = changed.flux
        changed.flux *= 0.5
        numpy.testing.assert_array_equal(flux, self.field.flux * numpy.float32(0.5))
        changed.error = 0
        self.assertFalse(changed.error.any())
        with self.assertRaisesRegex(plenoflame.Error, r"red_650nm takes an array of the shape \(60, 60\), not \(3, 4\)"):
            changed.flux = numpy.ones((3, 4))

    # --- xarray

    def labels(self, axes, *wanted):
        """Plots a DataArray; returns the axes, whose labels have these words and units."""
        found = axes.get_xlabel(), axes.get_ylabel()
        for text, words in zip(found, wanted):
            self.assertIn(words, " ".join(text.split()))
        self.assertLess(*axes.get_ylim())
        pyplot.close("all")

    def test_light_field_knows_its_pixels(self):
        found = self.two.to_xarray()
        self.assertEqual((found.dims, found.attrs["units"]), (("row", "column", "channel"), "W"))
        pitch = float(self.small["camera.sensor.pixel_pitch"])
        numpy.testing.assert_allclose(found.column, [(30 + n + 0.5 - PIXELS / 2) * pitch for n in range(25)], rtol=1e-9)
        numpy.testing.assert_allclose(found.row, [(PIXELS / 2 - 20 - n - 0.5) * pitch for n in range(11)], rtol=1e-9)
        numpy.testing.assert_array_equal(found.sel(channel="other"), self.two["other"])
        self.assertTrue(numpy.shares_memory(self.field.to_xarray().values, self.field.flux))
        self.labels(self.field.to_xarray().plot().axes, "x on the sensor [m]", "height on the sensor [m]")

    def test_views_know_their_places_on_the_lens(self):
        found = self.views.to_xarray()
        self.assertEqual((found.dims, found.attrs["units"]), (("u", "v", "y", "x"), "W/(m^2 sr)"))
        # The stop seen through the lens, by matrices of rays (height, slope).
        lens = self.small["camera.lens.surfaces"]
        path = numpy.eye(2)
        index = 1.0
        for surface in lens:
            path = numpy.array([[1, 0], [(index - surface["index"]) / surface["index"] / surface["radius"],
                                         index / surface["index"]]]) @ path
            path = numpy.array([[1, surface["thickness"]], [0, 1]]) @ path
            index = surface["index"]
        pupil = lens[2]["diameter"] / path[0, 0]
        numpy.testing.assert_allclose(1 + found.u, [1 - 0.7 * pupil / 3, 1, 1 + 0.7 * pupil / 3], rtol=1e-9)
        right, top = found.u.values.argmax(), found.v.values.argmax()
        numpy.testing.assert_array_equal(found.isel(u=right, v=top), self.views[0, 2])
        cell = float(self.small["camera.array.pitch"]) ** 2 * 3 ** 0.5 / 2  # of a hexagon [m^2]
        numpy.testing.assert_allclose([numpy.diff(found.x)[0], -numpy.diff(found.y)[0]], cell ** 0.5, rtol=1e-9)
        self.labels(found.isel(u=0, v=0).plot().axes, "x on the microlens array [m]", "height on the microlens array [m]")

    def test_refocused_pictures_lie_on_their_plane(self):
        found = self.sharp.to_xarray()
        numpy.testing.assert_array_equal(found.x, self.sharp.x)
        numpy.testing.assert_array_equal(found.y, -self.sharp.y)
        self.labels(found.plot().axes, "x on the plane in focus [m]", "height on the plane in focus [m]")

    def test_flames_have_the_coordinates_of_the_world(self):
        found = self.flame.to_xarray()
        self.assertEqual((found.temperature.dims, found.temperature.attrs["units"]), (("z", "y", "x"), "K"))
        for i, j, k in ((0, 0, 0), (3, 1, 5), (2, 4, 3)):
            place = {"x": 0.5 + 1e-3 * i, "y": -1 + 2e-3 * j, "z": 2 + 3e-3 * k}
            self.assertEqual(found.temperature.sel(place, method="nearest"), self.hot[i, j, k])
            numpy.testing.assert_allclose([found[axis][n] for axis, n in zip("xyz", (i, j, k))], list(place.values()), rtol=1e-12)
        self.labels(found.absorption.isel(y=0).plot().axes, "x [m]", "z [m]")
        self.assertEqual(found.absorption.attrs["units"], "1/m")

    def test_reconstructions_stand_upright(self):
        found = self.rings.to_xarray()
        numpy.testing.assert_allclose(found.r, [0, 2e-3, 4e-3, 6e-3, 8e-3], rtol=1e-9)
        numpy.testing.assert_allclose(found.z, [-0.025, -0.015, -0.005, 0.005, 0.015, 0.025], rtol=1e-9)
        numpy.testing.assert_array_equal(found.temperature, self.rings.temperature.T)
        self.labels(found.temperature.plot().axes, "distance from the axis [m]", "z [m]")
        found = self.voxels.to_xarray()
        numpy.testing.assert_allclose(found.x, [0.985, 0.995, 1.005, 1.015], rtol=1e-9)
        numpy.testing.assert_allclose(1 + found.y, [0.99, 1, 1.01], rtol=1e-9)
        numpy.testing.assert_allclose(found.z, [-0.005, 0.005], rtol=1e-9)
        numpy.testing.assert_array_equal(found.emission.transpose("x", "y", "z"), self.voxels.emission)
        self.assertEqual(found.emission.attrs["units"], "W/(m^3 sr)")

    def test_without_xarray_it_says_what_to_install(self):
        with unittest.mock.patch.dict(sys.modules, {"xarray": None}):
            with self.assertRaisesRegex(ImportError, "python3-xarray, or pip install xarray"):
                self.sharp.to_xarray()
        self.assertIsInstance(self.sharp.to_xarray(), xarray.DataArray)

    def test_scene_within_a_light_field_opens_no_file(self):
        """The lens of its text stands in a file that is not there: it is not looked for."""
        text = (f'[camera.sensor]\npixel_pitch = "1 mm"\ncolumns = {PIXELS}\nrows = {PIXELS}\n[camera.lens]\nfile = "/none.toml"\n'
                'model = "ideal"\nfocal_length = "50 mm"\ndiameter = "10 mm"\n[camera.focus]\nobject_distance = "1 m"\n')
        with self.assertRaisesRegex(plenoflame.Error, "none.toml"):
            plenoflame.Scene(text=text)
        field = plenoflame.read_light_field(self.saved(text))
        numpy.testing.assert_allclose(field.to_xarray().column[-1], (PIXELS / 2 - 0.5) * 1e-3, rtol=1e-9)

    def saved(self, text):
        """The light field in a file, with another scene's text of the same length."""
        self.field.save(self.folder / "a.exr")
        content = (self.folder / "a.exr").read_bytes()
        begin = content.index(b"[camera")
        size = len(self.field.scene_text.encode())
        self.assertEqual(content[begin:begin + size].decode(), self.field.scene_text)
        (self.folder / "b.exr").write_bytes(content[:begin] + text.encode().ljust(size, b"\n") + content[begin + size:])
        return self.folder / "b.exr"

    # --- notebooks

    def test_notebooks_show_a_picture_and_the_numbers(self):
        pages = {thing: thing._repr_html_() for thing in (self.small, self.field, self.views, self.sharp, self.flame, self.rings,
                                                          self.voxels)}
        for thing, page in pages.items():
            self.assertIn(f"<b>plenoflame.{type(thing).__name__}</b>", page)
            self.assertGreater(png(page).max(), 200)
            self.assertLess(len(page), 60000)
        self.assertIn("60 x 60 pixels", pages[self.small])
        self.assertIn(f"{self.field.flux.sum(dtype=float):.4g} W", pages[self.field])
        self.assertIn("1000 to 1345 K", pages[self.flame])
        self.assertIn("1 x 2 x 3 mm", pages[self.flame])
        self.assertIn("5 x 6, rings", pages[self.rings])

    def test_the_picture_is_upright(self):
        """One pixel of light near the upper right; a hot voxel at the top, at large x."""
        field = self.field.copy()
        field.flux = 0
        field.flux[5, 50] = 1
        picture = png(field._repr_html_())
        self.assertEqual([tuple(place) for place in numpy.argwhere(picture[..., 0])], [(5, 50)])
        hot = numpy.full((4, 5, 6), 300.0)
        hot[3, 2, 5] = 2000
        picture = png(plenoflame.flame_from_arrays(hot, hot, spacing=1e-3)._repr_html_())
        self.assertEqual(picture.shape, (6, 4, 3))
        self.assertEqual([tuple(place) for place in numpy.argwhere(picture[..., 2])], [(0, 3)])

    def test_a_scene_of_several_cameras_shows_its_flame(self):
        page = plenoflame.Scene(ROOT / "examples" / "three-cameras.toml")._repr_html_()
        self.assertIn("front, side, plain", page)
        self.assertGreater(png(page).max(), 200)

    def test_what_has_no_picture_shows_its_numbers(self):
        scene = self.small.copy()
        scene.remove("flames", 0)
        page = scene._repr_html_()
        self.assertNotIn("<img", page)
        self.assertIn("none", page)
        scene["channels[0].name"] = "<red>"
        self.assertIn("&lt;red&gt;", scene._repr_html_())

    # --- progress

    def progress_of(self, action):
        with contextlib.redirect_stderr(io.StringIO()) as shown:
            action()
        return shown.getvalue()

    def test_progress_is_text_or_tqdms_bar(self):
        runs = {"render": lambda: self.small.render(samples=2, progress=True),
                "operator": lambda: self.small.operator(progress=True, **RINGS),
                "flame": lambda: plenoflame.make_flame("candle", voxel_size="2 mm", progress=True)}
        for what, run in runs.items():
            self.assertRegex(self.progress_of(run), rf"{what}: 100 %\|")
            with unittest.mock.patch.dict(sys.modules, {"tqdm": None, "tqdm.auto": None}):
                self.assertEqual(self.progress_of(run), what + ":" + "".join(f" {n} %" for n in range(10, 101, 10)) + "\n")
        self.assertEqual(self.progress_of(lambda: self.small.render(samples=2, progress=False)), "")
        with self.assertRaisesRegex(plenoflame.Error, "progress takes True or a function"):
            self.small.render(samples=2, progress=3)

    def test_a_bar_ends_its_line_where_the_run_fails(self):
        with unittest.mock.patch.dict(sys.modules, {"tqdm": None, "tqdm.auto": None}):
            shown = self.progress_of(lambda: self.assertRaises(plenoflame.Error, self.field.refocus, -1, progress=True))
        self.assertRegex(shown, r"^refocus:.*\n$")

    # --- pickling

    def test_results_can_be_pickled(self):
        block = next(self.small.ray_blocks(2, radiance=True))
        stack = self.field.focus_stack([0.9, 1.0, 1.1])
        rays = self.small.rays(pixels=[(30, 30)], rays=4)
        for thing, read in ((self.views, numpy.asarray), (self.views, lambda v: v.sheet), (self.sharp, lambda s: s.y),
                            (stack, lambda s: s.planes[1]), (self.flame, numpy.asarray), (self.flame, lambda f: f.origin),
                            (rays, lambda r: r.points), (block, lambda b: b.radiance), (block, lambda b: b.anchor),
                            (self.field, lambda f: f.error)):
            for again in (pickle.loads(pickle.dumps(thing)), copy.deepcopy(thing)):
                numpy.testing.assert_array_equal(read(again), read(thing))

    def test_a_pickled_reconstruction_is_whole(self):
        again = pickle.loads(pickle.dumps(self.rings))
        for read in (lambda r: r.temperature, lambda r: r.places, lambda r: r.residuals[0], lambda r: r.explained[0],
                     lambda r: r.history, lambda r: r.flame["emission"]):
            numpy.testing.assert_array_equal(read(again), read(self.rings))
        self.assertEqual((again.report, again.complete, repr(again)), (self.rings.report, True, repr(self.rings)))
        self.rings.save(self.folder / "a.vdb")
        pickle.loads(pickle.dumps(again)).save(self.folder / "b.vdb")
        self.assertEqual((self.folder / "a.vdb").read_bytes(), (self.folder / "b.vdb").read_bytes())
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            start = [plenoflame.reconstruct(self.small, self.field, start=one, absorption="scene", **RINGS, **QUICK).emission
                     for one in (self.rings, again)]
        numpy.testing.assert_array_equal(*start)

    def test_a_pickled_operator_gives_the_same(self):
        x = numpy.arange(30.0)
        numpy.testing.assert_array_equal(pickle.loads(pickle.dumps(self.operator)) @ x, self.operator @ x)

    # --- operators

    def test_rows_are_the_inverse_of_image(self):
        rows = self.operator.rows(self.field)
        numpy.testing.assert_array_equal(rows, [self.field.flux[y, x] for x, y, _ in self.operator.pixels])
        numpy.testing.assert_array_equal(self.operator.rows(self.operator.image(rows)), rows)
        blocks = self.small.operator(bin=2, **RINGS)
        wanted = [self.field.flux[y:y + 2, x:x + 2].sum(dtype=float) for x, y, _ in blocks.pixels]
        numpy.testing.assert_allclose(blocks.rows(self.field), wanted, rtol=1e-12)
        # A block's row is what the operator gives for it.
        x = numpy.arange(30.0)
        numpy.testing.assert_allclose(blocks.rows(self.operator.image(self.operator @ x)), blocks @ x, rtol=1e-6)
        with self.assertRaisesRegex(plenoflame.Error, r"the shape \(60, 60\), not \(3, 4\)"):
            blocks.rows(numpy.ones((3, 4)))
        with self.assertRaisesRegex(plenoflame.Error, "a picture of each of 1 cameras, not 2"):
            blocks.rows([self.field, self.field])

    # --- errors

    def test_wrong_keywords_name_the_nearest_right_one(self):
        for sentence, action in (
                (r"Scene.render\(\) has no argument 'sample'; did you mean 'samples'\?", lambda: self.small.render(sample=2)),
                (r"reconstruct\(\) .* 'absorbtion'; did you mean 'absorption'\?",
                 lambda: plenoflame.reconstruct(self.small, self.field, absorbtion="scene")),
                (r"Scene\(\) has no argument 'txt'; did you mean 'text'\?", lambda: plenoflame.Scene(txt="")),
                (r"LightField.views\(\) .* 'q'; there are grid, spread", lambda: self.field.views(q=1)),
                (r"Operator.image\(\) .* 'camer'; did you mean 'camera'\?", lambda: self.operator.image([1], camer=0)),
                (r"merge\(\) .* 'picture'; did you mean 'pictures'\?", lambda: plenoflame.merge(picture=[])),
                (r"make_flame\(\) .* 'hight'; did you mean 'height'\?", lambda: plenoflame.make_flame("candle", hight=1))):
            with self.assertRaisesRegex(TypeError, sentence):
                action()

    @needs_vtk
    def test_properties_of_the_camera_are_keywords(self):
        with self.assertRaisesRegex(TypeError, r"Scene.camera\(\) .* 'LevelOfDetial'; did you mean 'LevelOfDetail'"):
            self.small.camera(LevelOfDetial=1)

    def test_operators_name_both_shapes(self):
        rows = self.operator.shape[0]
        for sentence, action in ((rf"x has the shape \(3,\), the operator \({rows}, 30\); x takes 30 numbers",
                                  lambda: self.operator @ numpy.ones(3)),
                                 (rf"y has the shape \(4,\), .* y takes {rows} numbers", lambda: self.operator.rmatvec(numpy.ones(4)))):
            with self.assertRaisesRegex(ValueError, sentence):
                action()

    def test_messages_name_no_option_of_the_command(self):
        with self.assertRaisesRegex(plenoflame.Error, r"\(grid\)") as caught:
            self.field.export(self.folder / "hci", "hci", grid=1)
        self.assertNotIn("--", str(caught.exception))
        with warnings.catch_warnings(record=True) as cautions:
            warnings.simplefilter("always")
            found = plenoflame.reconstruct(self.small, self.field, grid=(4, 3, 2), rays=4, **QUICK)
        texts = [str(caution.message) for caution in cautions] + [found.report, found.figures["warning"]]
        self.assertIn("unknowns='rings'", found.report)
        self.assertEqual([text for text in texts if "--" in text], [])
        self.assertEqual({caution.filename for caution in cautions}, {__file__})  # warnings point here


if __name__ == "__main__":
    main()
