"""Operators and reconstructions, with SciPy and the renderer as references."""

import gc
import os
import shutil
import signal
import subprocess
import sys
import threading
import unittest.mock

import numpy
import scipy.optimize
import scipy.sparse.linalg
from package import ROOT, PackageTest, main

import plenoflame


class Reconstruct(PackageTest):
    """A sphere of layers through a small camera: rings about its middle."""

    RINGS = {"unknowns": "rings", "grid": (5, 6), "rays": 8}

    @classmethod
    def setUpClass(cls):
        cls.scene_once = PackageTest.scene(cls, 60)
        cls.picture_once = cls.scene_once.render(64, seed=5)
        cls.operator_once = cls.scene_once.operator(**cls.RINGS)

    def setUp(self):
        super().setUp()
        self.small, self.picture, self.operator = self.scene_once, self.picture_once, self.operator_once

    def test_block_is_that_of_the_flame_unless_it_cuts_the_pictures_light(self):
        shutil.copy(ROOT / "examples" / "reconstruct-front.toml", self.folder)
        self.command("flame", "candle", "-o", "candle.vdb")
        candle = plenoflame.Scene(os.path.join(self.folder, "reconstruct-front.toml"))
        picture = candle.render(32)
        few = {"unknowns": "rings", "grid": (4, 5), "rays": 4, "draws": 0, "probes": 0}
        self.assertNotIn("block", plenoflame.reconstruct(candle, picture, **few).figures)
        stray = picture.copy()
        flux = numpy.asarray(stray)
        flux += 0.05 * flux.mean()  # 5 % of the light, the same everywhere
        self.assertNotIn("block", plenoflame.reconstruct(candle, stray, **few).figures)
        # The scene's flame stands beside that of the picture.
        candle["flames[0].position"] = "1 m, 8 mm, -16 mm"
        found = plenoflame.reconstruct(candle, picture, **few).figures["block"]
        self.assertLess(abs(found["center"][1]), 0.1 * found["size"][1])
        self.assertGreater(found["size"][1], 10.8e-3)  # the candle is as wide
        # A block that is asked for is taken.
        with self.assertWarnsRegex(RuntimeWarning, "The block cuts the flame"):
            asked = plenoflame.reconstruct(candle, picture, **few, center=(1, 0.004, 0), size=(0.012, 0.012, 0.04))
        self.assertNotIn("block", asked.figures)

    def test_directions_are_transposes_of_each_other_and_of_the_matrix(self):
        fresh = self.small.operator(**self.RINGS)
        generator = numpy.random.default_rng(1)
        x, y = generator.random(fresh.shape[1]), generator.random(fresh.shape[0])
        forward, back = fresh @ x, fresh.rmatvec(y)
        self.assertLess(abs(forward @ y / (x @ back) - 1), 1e-12)
        self.assertLess(numpy.abs(fresh.T @ y - back).max(), 1e-15 * back.max())
        matrix = fresh.matrix
        self.assertEqual(matrix.dtype, numpy.float32)
        self.assertTrue(matrix.has_sorted_indices and matrix.has_canonical_format)
        # Single precision, and another program's product.
        self.assertLess(numpy.linalg.norm(matrix @ x - forward), 1e-6 * numpy.linalg.norm(forward))
        self.assertLess(numpy.linalg.norm(matrix.T @ y - back), 1e-6 * numpy.linalg.norm(back))
        self.assertLess(numpy.linalg.norm(fresh @ x - matrix.astype(float) @ x), 1e-13 * numpy.linalg.norm(forward))
        self.assertLess(abs(fresh.matrix_bytes / (8 * matrix.nnz) - 1), 0.3)

    def test_matrix_is_the_librarys_memory_and_outlives_it(self):
        operator = self.small.operator(**self.RINGS)
        matrix = operator.matrix
        self.assertIs(operator.matrix, matrix)
        for mine, theirs in ((matrix.data, operator._algorithm.values),
                             (matrix.indices, operator._algorithm.column_indices)):
            self.assertTrue(numpy.shares_memory(mine, theirs))
        with self.assertRaises(ValueError):
            matrix.data[0] = 1
        copy = matrix.copy()
        copy.data[0] *= 1  # a copy can be written to
        del operator
        gc.collect()
        scrap = [numpy.ones(matrix.nnz, dtype=numpy.float32) for _ in range(20)]  # would be put where memory was freed
        self.assertEqual((matrix != copy).nnz, 0)
        del scrap

    def test_product_is_the_rendered_picture(self):
        """Samples of a constant emission make the picture that the renderer makes of a flame that has it."""
        shape, step, origin = (9, 8, 7), 2e-3, (0.992, -7e-3, -6e-3)
        generator = numpy.random.default_rng(2)
        glow = generator.random(shape).astype(numpy.float32)  # W/m^3 into the line
        scene = self.small.copy()
        while scene.list_size("flames"):
            scene.remove("flames", 0)
        scene["channels[0].wavelength"] = "431 nm"
        scene["channels[0].width"] = "30 nm"
        zero = numpy.zeros(shape, dtype=numpy.float32)
        flame = plenoflame.flame_from_arrays(zero + 300, zero, spacing=step, origin=origin, **{"CH*": glow})
        plenoflame.write_flame(self.folder / "glow.vdb", flame)
        (self.folder / "glow.toml").write_text(
            scene.text + '\n[[flames]]\nkind = "vdb"\nfile = "glow.vdb"\n[[flames.lines]]\nkind = "ch"\n')
        scene.add_flame(flame, lines=["ch"])
        operator = scene.operator(grid=shape, center=[o + step * (n - 1) / 2 for o, n in zip(origin, shape)],
                                  size=[step * n for n in shape], rays=8, seed=3)
        self.assertEqual(operator.grid_shape, shape)
        self.assertLess(numpy.abs(operator.places[1] - operator.places[0] - [0, 0, step]).max(), 1e-12)
        # All of the line, which is narrow, lies in the channel; a sample is per steradian.
        product = operator.image(operator @ glow.ravel()) / (4 * numpy.pi)
        # The renderer's integrals along the same rays, in double precision.
        traced = numpy.zeros(product.shape)
        for block in scene.ray_blocks(8, seed=3, precision="double", radiance=True):
            numpy.add.at(traced, (block.pixel[:, 1], block.pixel[:, 0]), block.etendue * block.radiance[:, 0])
        self.assertGreater(numpy.count_nonzero(traced), 1000)
        numpy.testing.assert_allclose(product, traced, rtol=1e-6)
        # Its picture, in single precision: the same rays, so well within their errors.
        subprocess.run([os.environ["PLENOFLAME_COMMAND"], "render", "glow.toml", "--samples", "8", "--seed", "3", "-o", "glow.exr",
                        "--no-control-variate", "--quiet"], cwd=self.folder, check=True)
        rendered = plenoflame.read_light_field(self.folder / "glow.exr")
        known = rendered.error > 0
        self.assertLess((numpy.abs(product - rendered.flux)[known] / rendered.error[known]).max(), 0.5)

    def test_scipys_solvers_find_what_ours_do(self):
        operator = self.small.operator(unknowns="rings", grid=(3, 4), rays=8)
        data = self.picture.flux[operator.pixels[:, 1], operator.pixels[:, 0]].astype(float)
        scale = numpy.linalg.norm(operator.matrix.data)
        dense = operator.matrix.toarray().astype(float)
        exact = numpy.linalg.lstsq(dense / scale, data / data.max(), rcond=None)[0]
        found = scipy.sparse.linalg.lsqr(operator * (1 / scale), data / data.max(), atol=1e-14, btol=1e-14, iter_lim=2000)[0]
        self.assertLess(numpy.linalg.norm(found - exact), 1e-6 * numpy.linalg.norm(exact))
        # Without noise but that of --noise, which is the same for all pixels, ours is the least-squares problem. The field is
        # handed out at the places of the unknowns, a twelfth of second differences nearer to their neighbours.
        plain = self.picture.copy()
        plain.error[:] = 0
        ours = plenoflame.reconstruct(self.small, plain, unknowns="rings", grid=(3, 4), rays=8, solver="nnls", strength=0,
                                      all_voxels=True, draws=0, probes=0, noise=1, seed=int(self.small["render.seed"]))
        samples = (scipy.optimize.nnls(dense / scale, data / data.max())[0] * data.max() / scale).reshape(3, 4)
        expected = samples.copy()
        expected[:2] += (numpy.vstack([samples[1], samples[0]]) - 2 * samples[:2] + samples[1:]) / 12
        expected[:, 1:3] += (expected[:, :2] - 2 * expected[:, 1:3] + expected[:, 2:]) / 12
        expected = expected.ravel()
        # The error of the rays weighs rows apart from each other by its square, (some per cent)^2 beside the noise of 1.
        self.assertLess(numpy.linalg.norm(ours.emission.ravel() - expected), 1e-3 * numpy.linalg.norm(expected))

    def test_a_reconstruction_is_what_the_command_finds(self):
        found = plenoflame.reconstruct(self.small, self.picture, absorption="scene", truth=True, draws=2, probes=2, **self.RINGS)
        self.small.save(self.folder / "scene.toml")
        self.picture.save(self.folder / "picture.exr")
        figures = self.figures("reconstruct", "scene.toml", "--images", "picture.exr", "--absorption", "scene", "--truth",
                               "--draws", "2", "--probes", "2", "--unknowns", "rings", "--grid", "5,6", "--rays", "8", "-o",
                               "found.vdb", "--quiet")
        for name in ("strength", "chi_squared", "truth_emission_error", "history", "mean_temperature_K"):
            self.assertEqual(found.figures[name], figures[name], name)
        self.assertEqual(found.history[-1], found.figures["history"][-1])
        self.assertEqual(found.shape, (5, 6))
        self.assertEqual(found.temperature.shape, found.temperature_deviation.shape)
        self.assertTrue(found.complete)
        self.assertIsNone(found.absorption_deviation)
        self.assertTrue(0 <= found.resolved.min() <= found.resolved.max() <= 1)
        explained = found.explained[0]
        self.assertEqual(explained.shape, self.picture.flux.shape)
        seen = explained != 0
        self.assertLess(numpy.abs(found.residuals[0] + explained - self.picture.flux)[seen].max(),
                        1e-5 * self.picture.flux.max())
        # A flame like any other, in memory and as the file that the command writes.
        found.save(self.folder / "mine.vdb")
        for grid in ("temperature", "emission", "resolved"):
            mine, theirs = (plenoflame.read_flame(self.folder / name, grid=grid) for name in ("mine.vdb", "found.vdb"))
            numpy.testing.assert_array_equal(*(plenoflame.flame_arrays(image)[0][grid] for image in (mine, theirs)))
        again = self.small.copy()
        again.remove("flames", 0)
        again.add_flame(found.flame)
        self.assertGreater(again.render(2).flux.max(), 0.2 * self.picture.flux.max())
        # And the start of the next, which begins where this one has ended, within what its last iterations do.
        more = plenoflame.reconstruct(self.small, self.picture, absorption="scene", start=found, strength=found.figures["strength"],
                                      draws=0, probes=0, **self.RINGS)
        self.assertLess(abs(more.history[0] / found.history[-1] - 1), 1e-3)

    def test_an_error_of_the_absorption_is_in_the_deviations(self):
        """The references are reconstructions with other absorptions."""
        # A factor of 1.1 changes temperatures and emissions by 0.8 and 2 to 9 %. Voxels of one camera reach the bound of 0 elsewhere
        # if the absorption is another one, which deviations ignore.
        rings = {"temperature": 0.001, "emission": 0.01}
        voxels = {"unknowns": "voxels", "grid": (3, 5, 6), "rays": 8, "form": "rays"}
        for find, grid, shares in (("emission", self.RINGS, rings), ("temperature", self.RINGS, rings),
                                   ("emission", voxels, {"temperature": 0.003})):
            def found(absorption, find=find, grid=grid, **more):
                return plenoflame.reconstruct(self.small, self.picture, **grid, find=find, strength=1e-4, iterations=2000,
                                              draws=4, probes=0, absorption=absorption, **more)

            less, exact, more = found(8 / 1.05), found(8), found(8 * 1.05)
            known = found(8, absorption_error=0.1)
            lit = exact.emission > 0.3 * exact.emission.max()
            for name, share in shares.items():
                with self.subTest(find=find, unknowns=grid["unknowns"], quantity=name):
                    slope = (getattr(more, name) - getattr(less, name)) / (2 * numpy.log(1.05))
                    stated, without = (getattr(one, name + "_deviation") for one in (known, exact))
                    part = numpy.sqrt(numpy.maximum(stated**2 - without**2, 0))
                    wrong = numpy.abs(part - 0.1 * numpy.abs(slope)) / getattr(exact, name)
                    # A deviation of a temperature is not that of a slope where the light errs by more than itself.
                    some = lit & (known.emission_deviation < exact.emission)
                    self.assertGreater(some.sum(), 0.5 * lit.sum())
                    self.assertLess(wrong[some].max(), share, (part[some], slope[some]))
            self.assertIn("known to 10 %", known.report)

    def test_several_cameras(self):
        text = self.small.text.replace("[camera]\nname = \"\"", "[[cameras]]\nname = \"front\"", 1).replace(
            "[camera.", "[cameras.").replace("[[camera.", "[[cameras.")
        text += "\n[[cameras]]\nname = \"side\"\nlike = \"front\"\nposition = [\"1 m\", \"1 m\", \"0 m\"]\nlook_direction = [0, -1, 0]\n"
        scene = plenoflame.Scene(text=text, name=str(self.folder / "two.toml"))
        operator = scene.operator(**self.RINGS)
        x = numpy.random.default_rng(3).random(operator.shape[1])
        own = operator.pixels[:, 2] == 0
        front = scene.with_camera("front").operator(**self.RINGS)
        numpy.testing.assert_array_equal(operator.pixels[own], front.pixels)
        numpy.testing.assert_array_equal((operator @ x)[own], front @ x)
        self.assertGreater(operator.image(operator @ x, camera=1).max(), 0)
        pictures = {"side": scene.with_camera("side").render(16), "front": self.picture}
        found, listed = (plenoflame.reconstruct(scene, images, draws=0, probes=0, **self.RINGS)
                         for images in (pictures, [pictures["front"], pictures["side"]]))
        numpy.testing.assert_array_equal(found.emission, listed.emission)
        self.assertEqual(len(found.residuals), 2)
        with self.assertRaisesRegex(plenoflame.Error, "the cameras are 'front', 'side'"):
            plenoflame.reconstruct(scene, {"back": self.picture})
        # A single one has its name, too.
        alone = plenoflame.reconstruct(scene.with_camera("front"), {"front": self.picture}, draws=0, probes=0, **self.RINGS)
        self.assertIn("emission", repr(alone))

    # Draws of noise would go on for hours: the run ends by itself in no case.
    ENDLESS = {"draws": 100000, **RINGS}

    def test_progress_ends_it_with_what_is_there(self):
        fractions = []

        def progress(fraction):
            fractions.append(fraction)
            return fraction > 0.3
        found = plenoflame.reconstruct(self.small, self.picture, progress=progress, **self.ENDLESS)
        self.assertFalse(found.complete)
        self.assertIn("stopped early", repr(found))
        self.assertGreater(found.emission.max(), 0)
        self.assertEqual(fractions, sorted(fractions))
        with self.assertRaisesRegex(plenoflame.Error, "before there was a result"):
            plenoflame.reconstruct(self.small, self.picture, progress=lambda _: True, **self.ENDLESS)
        self.assertRaises(ZeroDivisionError, plenoflame.reconstruct, self.small, self.picture, progress=lambda _: 1 / 0,
                          **self.ENDLESS)

    def test_ctrl_c_keeps_what_was_reached(self):
        def progress(fraction):
            if fraction > 0.3:
                os.kill(os.getpid(), signal.SIGINT)
        with self.assertRaises(KeyboardInterrupt) as caught:
            plenoflame.reconstruct(self.small, self.picture, progress=progress, **self.ENDLESS)
        found = caught.exception.reconstruction
        self.assertFalse(found.complete)
        self.assertGreater(found.emission.max(), 0)

    def test_other_threads_go_on(self):
        ticks, ended = [], threading.Event()

        def tick():
            while not ended.wait(0.001):
                ticks.append(1)
        thread = threading.Thread(target=tick)
        thread.start()
        before = len(ticks)
        self.operator @ numpy.ones(self.operator.shape[1])
        plenoflame.reconstruct(self.small, self.picture, draws=0, probes=0, **self.RINGS)
        inside = len(ticks) - before
        ended.set()
        thread.join()
        self.assertGreater(inside, 5)

    def test_scipy_is_needed_for_operators_alone(self):
        hidden = {name: None for name in ("plenoflame.operators", "scipy", "scipy.sparse", "scipy.sparse.linalg")}
        with unittest.mock.patch.dict(sys.modules, hidden):
            with self.assertRaisesRegex(plenoflame.Error, r"operator\(\) needs SciPy"):
                self.small.operator(**self.RINGS)
            plenoflame.reconstruct(self.small, self.picture, draws=0, probes=0, **self.RINGS)

    def test_an_operator_serves_several_pictures(self):
        settings = {**self.RINGS, "rays": 4, "seed": 5, "center": (1, 0, 0), "size": (0.06, 0.06, 0.08)}
        quick = {"draws": 0, "probes": 0, "strength": 1e-3, "iterations": 8}
        operator = self.small.operator(**settings)
        plain = plenoflame.reconstruct(self.small, self.picture, **quick, **settings)
        for stored in (False, True):
            if stored:
                self.assertGreater(operator.matrix.nnz, 0)
            found = plenoflame.reconstruct(self.small, self.picture, operator=operator, **quick)
            self.assertEqual(found.shape, plain.shape)
            numpy.testing.assert_allclose(found.emission, plain.emission, rtol=1e-4, atol=1e-4 * plain.emission.max())
        for sentence, arguments in (("rays is that of the operator, 4, not 16", {"rays": 16}),
                                    ("operator is for find='emission'", {"find": "both"}),
                                    ("rows of the matrix", {"operator": self.small.operator(**settings), "solver": "mart"})):
            with self.assertRaisesRegex(plenoflame.Error, sentence):
                plenoflame.reconstruct(self.small, self.picture, **{"operator": operator, **arguments})
        with self.assertRaisesRegex(plenoflame.Error, "operator takes one of Scene.operator"):
            plenoflame.reconstruct(self.small, self.picture, operator=3)

    def test_every_bad_argument_has_the_commands_sentence(self):
        def refuses(sentence, **arguments):
            with self.assertRaisesRegex(plenoflame.Error, sentence) as caught:
                plenoflame.reconstruct(self.small, self.picture, **{**self.RINGS, **arguments})
            self.assertNotIn("--", str(caught.exception))
        refuses("unknowns: 'ring' is not one of voxels, rings, layers; did you mean 'rings'", unknowns="ring")
        refuses("grid must be the rings and heights", grid=4)
        refuses("smoothing: 3 numbers for 2 axes of rings", smoothing=(1, 2, 3))
        refuses("solver='sirt' has no penalty", solver="sirt", strength=1)
        refuses("memory=0 leaves no room for the stored matrix", solver="mart", memory=0)
        refuses("absorption: '1000000000 1/m' is beyond every flame", absorption=1e9)
        refuses("noise: 2 is not a number from 0 to 1", noise=2)
        refuses("rays takes a whole number", rays=1)
        refuses("bin: the sensor .* has 60 x 60 pixels", bin=61)
        refuses("find='temperature' needs absorption", find="temperature")
        refuses("absorption_ratios is for find='both'", absorption_ratios=0.7)
        refuses("no channel", channel="blue")
        refuses("lies outside of all pictures", center=(1, 1, 0), size=(0.01, 0.01, 0.01))
        refuses("earlier result has 30 unknowns, not 12", grid=(3, 4), start=plenoflame.reconstruct(
            self.small, self.picture, draws=0, probes=0, **self.RINGS))
        dark = self.picture.copy()
        dark.flux[10, 20] = numpy.nan
        with self.assertRaisesRegex(plenoflame.Error, "not finite in pixel 20,10"):
            plenoflame.reconstruct(self.small, dark)
        other = self.scene(64)
        with self.assertRaisesRegex(plenoflame.Error, "60 x 60 pixels, the scene's has 64 x 64"):
            plenoflame.reconstruct(other, self.picture)
        for images in ([], [self.picture] * 2, 3, [None]):
            self.assertRaises(plenoflame.Error, plenoflame.reconstruct, self.small, images)
        self.assertRaises(plenoflame.Error, plenoflame.reconstruct, "scene.toml", self.picture)
        for arguments in ({"grid": (4, 5)}, {"absorption": "8 mm"}, {"rays": "many"}, {"axis": "fit", "unknowns": "rings"},
                          {"axis": (0, 0, 1)}, {"threads": -1}, {"basis": "linear"}):
            self.assertRaises(plenoflame.Error, self.small.operator, **arguments)
        with self.assertRaisesRegex(ValueError, "dimension mismatch"):
            self.operator @ numpy.ones(3)
        self.assertRaises(plenoflame.Error, self.operator.image, numpy.ones(3))


if __name__ == "__main__":
    main()
