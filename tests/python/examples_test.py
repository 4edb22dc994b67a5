"""Every example in examples/python runs, and makes the file that it names."""

import struct
import subprocess
import sys

import numpy
from package import ROOT, PackageTest, main
from picture_test import read_png
from vtkmodules.vtkIOXML import vtkXMLMultiBlockDataReader

import plenoflame


class Examples(PackageTest):
    def run_example(self, name, *arguments):
        result = subprocess.run([sys.executable, "-B", ROOT / "examples" / "python" / name, *arguments, self.folder],
                                capture_output=True, text=True, cwd=self.folder, timeout=250)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        return self.folder / result.stdout.strip()

    def small_scene(self):
        self.scene(60).save(self.folder / "small.toml")
        return self.folder / "small.toml"

    def size_of(self, path):
        data = path.read_bytes()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        return struct.unpack(">II", data[16:24])

    def test_render_and_plot(self):
        self.assertGreater(min(self.size_of(self.run_example("render_and_plot.py", self.small_scene()))), 300)

    def test_aperture_sweep(self):
        self.assertGreater(min(self.size_of(self.run_example("aperture_sweep.py", self.small_scene()))), 300)

    def test_rays_over_lens(self):
        self.assertGreater(min(self.size_of(self.run_example("rays_over_lens.py", self.small_scene()))), 300)

    def test_scene_picture(self):
        self.assertEqual(self.size_of(self.run_example("scene_picture.py", self.small_scene())), (1200, 800))

    def test_vtk_pipeline(self):
        """Rays left, of the status 0, which is red; the light field right, grey up to its largest flux."""
        picture = read_png(self.run_example("vtk_pipeline.py", self.small_scene()))
        self.assertEqual(picture.shape, (500, 1000, 3))
        self.assertGreater((picture[:, :500] == (255, 0, 0)).all(2).sum(), 200)
        self.assertTrue((picture[:, 500:] == picture[:, 500:, :1]).all())
        self.assertGreater(picture[:, 500:].max(), 250)
        self.assertGreater((picture[:, 500:] < 20).mean(), 0.5)

    def test_operator_vjp(self):
        """The descent goes down, which it does not with a wrong adjoint; and what it finds is not negative."""
        found = numpy.load(self.run_example("operator_vjp.py", self.small_scene()))
        self.assertLess(found["losses"][-1], 0.1 * found["losses"][0])
        self.assertEqual(found["emission"].shape, (8, 12))
        self.assertGreaterEqual(found["emission"].min(), 0)

    def test_turbulent_flame(self):
        """Sooting gas is hot, the air around is not, and both cameras of the scene see the flame."""
        voxels = plenoflame.read_flame(self.run_example("turbulent_flame.py", "4"))
        arrays = plenoflame.flame_arrays(voxels)[0]
        sooting = arrays["absorption"] > 0.1 * arrays["absorption"].max()
        self.assertGreater(arrays["temperature"][sooting].min(), 1500)
        self.assertLess(numpy.median(arrays["temperature"]), 400)
        (self.folder / "turbulent.toml").write_text((ROOT / "examples/python/turbulent.toml").read_text())
        scene = plenoflame.Scene(self.folder / "turbulent.toml")
        for name, window in (("r29", (3250, 2160, 60, 60)), ("plain", (400, 700, 60, 60))):
            field = scene.with_camera(name).render(samples=2, window=window)
            self.assertGreater(field["Y"].min(), 0)

    def test_for_paraview(self):
        reader = vtkXMLMultiBlockDataReader()
        reader.SetFileName(str(self.run_example("for_paraview.py", self.small_scene())))
        reader.Update()
        blocks = reader.GetOutput()
        names = [blocks.GetMetaData(i).Get(blocks.NAME()) for i in range(blocks.GetNumberOfBlocks())]
        self.assertEqual(names, ["camera", "flame", "rays", "light field"])
        self.assertGreater(blocks.GetBlock(2).GetNumberOfLines(), 10)
        # The light field in the file is still one: its views can be made.
        field = plenoflame.LightField.from_vtk(blocks.GetBlock(3))
        self.assertEqual(len(field.views(2)), 4)


if __name__ == "__main__":
    main()
