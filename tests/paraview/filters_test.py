"""The plugin's filters in VTK's own pipeline, without ParaView: what they announce is what they give, which ParaView shows no
more of. Ends with 77, which skips the test, where VTK's Python modules are not installed."""

import os
import sys
import types
import unittest

try:
    from vtkmodules.util import vtkAlgorithm
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline, vtkTrivialProducer
except ImportError as error:
    print(f"skipped: {error} (apt-get install python3-vtk9)")
    sys.exit(77)


class Decorators:
    """ParaView's decorators, which make XML of classes: here they change nothing."""

    def __getattr__(self, _name):
        return lambda *_arguments, **_named: lambda decorated: decorated


WHOLE = vtkStreamingDemandDrivenPipeline.WHOLE_EXTENT()
vtkAlgorithm.smproxy = vtkAlgorithm.smproperty = vtkAlgorithm.smdomain = vtkAlgorithm.smhint = Decorators()
sys.modules["paraview"] = types.SimpleNamespace(__version__="5.11.0")
sys.modules["paraview.util"] = types.ModuleType("paraview.util")
sys.modules["paraview.util.vtkAlgorithm"] = vtkAlgorithm
sys.path[:0] = [os.path.dirname(os.environ["PLENOFLAME_PLUGIN"])]
import Plenoflame as plugin  # noqa: E402
import plenoflame  # noqa: E402

SMALL = (("camera.sensor.columns", 80), ("camera.sensor.rows", 64))


def reference():
    scene = plenoflame.Scene(os.path.join(os.environ["PLENOFLAME_ROOT"], "examples", "lenslets-30.toml"))
    for key, value in SMALL:
        scene[key] = value
    return scene


class Filters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.field = reference().render(samples=2)

    def source(self):
        """A light field's reader, of which nothing is asked yet."""
        producer = vtkTrivialProducer()
        producer.SetOutput(self.field.to_vtk())
        return producer

    def announced(self, algorithm, port=0):
        algorithm.UpdateInformation()
        extent = algorithm.GetOutputInformation(port).Get(WHOLE)
        return tuple(extent[2 * k + 1] - extent[2 * k] + 1 for k in range(3))

    def check(self, filtered, size):
        source = self.source()
        filtered.SetInputConnection(0, source.GetOutputPort())
        self.assertEqual(self.announced(filtered), size)
        filtered.Update()
        self.assertEqual(filtered.GetOutputDataObject(0).GetDimensions(), size)
        return filtered

    def test_each_filter_announces_its_picture(self):
        rows, columns = self.field.views(3).sheet.shape
        views = plugin.PlenoflameViews()
        views.SetGrid(3)
        self.check(views, (columns, rows, 1))
        rows, columns = self.field.refocus(0.95, width=30).image.shape
        refocus = plugin.PlenoflameRefocus()
        refocus.SetDepth(0.95)
        refocus.SetWidth(30)
        self.check(refocus, (columns, rows, 1))
        refocus.SetWidth(20)  # another picture of the same light field
        self.assertEqual(self.announced(refocus)[0], 20)
        refocus.Update()
        self.assertEqual(refocus.GetOutputDataObject(0).GetDimensions()[0], 20)
        self.check(plugin.PlenoflameDevelop(), (80, 64, 1))

    def test_a_scene_has_rays_of_the_middle_pixel(self):
        scene = plugin.PlenoflameScene()
        scene.SetFileName(os.path.join(os.environ["PLENOFLAME_ROOT"], "examples", "lenslets-30.toml"))
        scene.SetSettings("; ".join(f"{key}={value}" for key, value in SMALL))
        scene.SetResolution(8)
        scene.Update()
        rays = scene.GetOutputDataObject(2)
        self.assertGreater(rays.GetNumberOfLines(), 0)
        pixels = rays.GetCellData().GetArray("pixel")
        self.assertEqual({pixels.GetTuple2(i) for i in range(rays.GetNumberOfLines())}, {(40.0, 32.0)})


if __name__ == "__main__":
    unittest.main()
