"""The plugin in pvpython: readers, sources and filters, held against the command's files and closed forms. Run by run.py."""


import os
import pathlib
import subprocess
import tempfile

import numpy
from paraview.simple import Delete, LoadPlugin, OpenDataFile
from vtkmodules.util.numpy_support import vtk_to_numpy

ROOT = pathlib.Path(os.environ["PLENOFLAME_ROOT"])
folder = pathlib.Path(tempfile.mkdtemp(prefix="plenoflame-paraview-"))
scene = folder / "small.toml"
text = (ROOT / "examples/lenslets-30.toml").read_text()
scene.write_text(text)
SETTINGS = "camera.sensor.columns=80; camera.sensor.rows=80"

from paraview import simple

assert hasattr(simple, "PlenoflameScene"), "plenoflame-paraview starts ParaView with the plugin"
LoadPlugin(os.environ["PLENOFLAME_PLUGIN"], remote=False, ns=globals())  # once more, for its names here
import plenoflame
from plenoflame import _core


def command(*arguments):
    done = subprocess.run([os.environ["PLENOFLAME_COMMAND"], *map(str, arguments)], capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def of(source, port=0):
    """The data of a source's output."""
    source.UpdatePipeline()
    return source.GetClientSideObject().GetOutputDataObject(port)


def array(data, name):
    found = data.GetArray(name)
    assert found is not None, (name, [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())])
    return vtk_to_numpy(found)


def picture(image, name):
    columns, rows, _ = image.GetDimensions()
    return array(image.GetPointData(), name).reshape(rows, columns)[::-1]


def reference():
    small = plenoflame.Scene(scene)
    for setting in SETTINGS.split(";"):
        key, _, value = setting.partition("=")
        small[key.strip()] = value.strip()
    return small


def test_scene_has_camera_flame_and_rays():
    whole = PlenoflameScene(FileName=str(scene), Settings=SETTINGS, Pixel=[40, 41], Rays=8, FlameSamples=3, FlameResolution=24)
    camera = of(whole, 0)
    names = [camera.GetMetaData(i).Get(camera.NAME()) for i in range(camera.GetNumberOfBlocks())]
    assert names == ["lens surfaces", "lens edges", "stop", "microlenses", "array plate", "sensor"], names
    box = camera.GetBlock(5).GetBounds()
    sides = sorted(box[2 * k + 1] - box[2 * k] for k in range(3))
    scene_pitch = reference()["camera.sensor.pixel_pitch"]
    numpy.testing.assert_allclose(sides[1:], [80 * scene_pitch] * 2, rtol=1e-9)
    flame = of(whole, 1)
    assert max(flame.GetDimensions()) == 24, flame.GetDimensions()
    temperature = array(flame.GetPointData(), "temperature")
    assert 300 < temperature.max() < 3000, temperature.max()
    rays = of(whole, 2)
    command("rays", scene, "--set", "camera.sensor.columns=80", "--set", "camera.sensor.rows=80", "--pixel", "40,41", "--rays", 8,
            "--flame-samples", 3, "-o", "rays.vtp")
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(folder / "rays.vtp"))
    reader.Update()
    same = reader.GetOutput()
    assert rays.GetNumberOfLines() == same.GetNumberOfLines() > 0
    numpy.testing.assert_array_equal(array(rays.GetCellData(), "weight"), array(same.GetCellData(), "weight"))
    numpy.testing.assert_array_equal(vtk_to_numpy(rays.GetPoints().GetData()), vtk_to_numpy(same.GetPoints().GetData()))
    numpy.testing.assert_array_equal(array(rays.GetPointData(), "temperature"), array(same.GetPointData(), "temperature"))


def test_rays_of_points_and_pixels():
    rays = of(PlenoflameRays(SceneFile=str(scene), Settings=SETTINGS, UsePoint=1, Point=[1, 0, 0], Rays=16))
    start = vtk_to_numpy(rays.GetPoints().GetData())[0]
    numpy.testing.assert_array_equal(start, (1, 0, 0))
    assert rays.GetNumberOfLines() == 16


def test_light_field_is_that_of_the_command():
    command("render", scene, "--set", "camera.sensor.columns=80", "--set", "camera.sensor.rows=80", "--samples", 4, "-o", "a.exr")
    rendered = of(PlenoflameLightField(SceneFile=str(scene), Settings=SETTINGS, Samples=4))
    read = of(OpenDataFile(str(folder / "a.exr")))
    for name in ("red_650nm", "red_650nm.error"):
        numpy.testing.assert_array_equal(picture(rendered, name), picture(read, name))
    assert picture(read, "red_650nm").max() > 0
    assert rendered.GetOrigin() == read.GetOrigin() == (0.5, 0.5, 0)


def test_filters_give_the_pictures_of_the_library():
    source = PlenoflameLightField(SceneFile=str(scene), Settings=SETTINGS, Samples=4)
    field = reference().render(samples=4)
    sheet = of(PlenoflameViews(Input=source, Grid=3))
    numpy.testing.assert_array_equal(picture(sheet, "radiance"), field.views(3).sheet)
    one = of(PlenoflameViews(Input=source, Grid=3, View=[0, 2], WhiteCorrection=0, Resampling="nearest"))
    numpy.testing.assert_array_equal(picture(one, "flux"), field.views(3, white_correction=False, resampling="nearest")[0, 2])
    refocused = of(PlenoflameRefocus(Input=source, Depth=0.95, Width=30))
    sharp = field.refocus(0.95, width=30)
    numpy.testing.assert_array_equal(picture(refocused, "radiance"), sharp.image)
    numpy.testing.assert_allclose(refocused.GetSpacing()[:2], [sharp.pixel] * 2, rtol=1e-12)
    # Upright: the middle of the uppermost row of pixels is highest.
    top = refocused.GetOrigin()[1] + (refocused.GetDimensions()[1] - 1) * refocused.GetSpacing()[1]
    numpy.testing.assert_allclose(top, -sharp.y[0], rtol=1e-9)
    developed = of(PlenoflameDevelop(Input=source, Bits=10, Curve="linear"))
    numpy.testing.assert_array_equal(picture(developed, "digital_number"), field.develop(bits=10, curve="linear"))


def test_vdb_keeps_its_place():
    command("flame", "candle", "--voxel-size", "2 mm", "-o", "candle.vdb")
    image = of(OpenDataFile(str(folder / "candle.vdb")))
    arrays, spacing, origin, _ = plenoflame.flame_arrays(plenoflame.read_flame(folder / "candle.vdb"))
    numpy.testing.assert_allclose(image.GetSpacing(), spacing, rtol=1e-12)
    numpy.testing.assert_allclose(image.GetOrigin(), origin, rtol=1e-12)
    numpy.testing.assert_array_equal(array(image.GetPointData(), "temperature"), arrays["temperature"].ravel(order="F"))


def test_turned_voxels_keep_their_directions():
    """A quarter turn about z: the image's x axis is the world's y."""
    turned = _core.Voxels((2, 3, 4), (1, 2, 3), (1e-3, 2e-3, 3e-3), [(0, 1, 0), (-1, 0, 0), (0, 0, 1)])
    turned.add("temperature", numpy.arange(24.0).reshape(2, 3, 4))
    image = plenoflame.Flame(turned).to_vtk()
    at = [0.0] * 3
    image.TransformIndexToPhysicalPoint(1, 2, 3, at)
    numpy.testing.assert_allclose(at, (1 - 4e-3, 2 + 1e-3, 3 + 9e-3), rtol=1e-12)


def listed(source, name):
    """What the user may choose from for a property."""
    source.UpdatePipelineInformation()
    source.SMProxy.UpdatePropertyInformation()
    domain = source.GetProperty(name).SMProperty.FindDomain("vtkSMStringListDomain")
    return [domain.GetString(i) for i in range(domain.GetNumberOfStrings())]


def test_cameras_and_channels_are_lists():
    several = PlenoflameScene(FileName=str(ROOT / "examples/three-cameras.toml"))
    assert of(several, 2).GetNumberOfLines() > 0, "of the first camera"
    assert listed(several, "Camera") == ["front", "side", "plain"], listed(several, "Camera")
    colours = folder / "colours.toml"
    colours.write_text(text.replace("[render]", "\n".join(f'[[channels]]\nname = "at{nm}"\nkind = "line"\nwavelength = "{nm} nm"\n'
                                                         'width = "10 nm"\n' for nm in (500, 850)) + "[render]"))
    field = PlenoflameLightField(SceneFile=str(colours), Settings=SETTINGS, Samples=1)
    field.UpdatePipeline()
    names = plenoflame.Scene(colours).channels
    assert len(names) == 3
    for kind in (PlenoflameViews, PlenoflameRefocus, PlenoflameDevelop):
        filtered = kind(Input=field)
        filtered.UpdatePipeline()
        assert listed(filtered, "Channel") == names, (kind, listed(filtered, "Channel"))


def test_series_of_files_and_scenes_with_time_have_steps():
    heights = (20, 24, 28)
    for number, height in enumerate(heights, 1):
        command("flame", "candle", "--set", f"height={height} mm", "--voxel-size", "2 mm", "-o", f"run_{number}.vdb")
    reader = PlenoflameFlameReader(FileName=[str(folder / f"run_{number}.vdb") for number in (1, 2, 3)])
    reader.UpdatePipelineInformation()
    assert list(reader.TimestepValues) == [0, 1, 2], list(reader.TimestepValues)

    def sum_at(source, time, port=0):
        source.UpdatePipeline(time)
        return array(source.GetClientSideObject().GetOutputDataObject(port).GetPointData(), "absorption").sum()
    for number in (3, 1, 2):
        alone = plenoflame.flame_arrays(plenoflame.read_flame(folder / f"run_{number}.vdb"))[0]["absorption"].sum()
        numpy.testing.assert_allclose(sum_at(reader, number - 1), alone, rtol=1e-6)
    film = folder / "film.toml"
    film.write_text(text[:text.index("[[flames]]")] + '[[flames]]\nkind = "vdb"\nfile = "run_#.vdb"\nframe_rate = "100 Hz"\n'
                    'position = ["1 m", "0 m", "-16 mm"]\n' + text[text.index("[[channels]]"):])
    whole = PlenoflameScene(FileName=str(film), Settings=SETTINGS, FlameResolution=16, Rays=2)
    whole.UpdatePipelineInformation()
    numpy.testing.assert_allclose(list(whole.TimestepValues), [0, 0.01, 0.02], rtol=1e-12)
    seen = [sum_at(whole, time, 1) for time in (0, 0.01, 0.02, 0.015)]
    assert len(set(seen)) == 3 and seen[3] == seen[1], seen


def pixels(source, **look):
    """A picture of a source alone, on black."""
    view = simple.CreateView("RenderView")
    view.ViewSize = [200, 200]
    view.UseColorPaletteForBackground, view.Background, view.OrientationAxesVisibility = 0, (0, 0, 0), 0
    simple.Show(source, view, **look)
    simple.ResetCamera(view)
    file = folder / "view.png"
    simple.SaveScreenshot(str(file), view, ImageResolution=[200, 200])
    simple.Delete(view)
    from vtkmodules.vtkIOImage import vtkPNGReader
    reader = vtkPNGReader()
    reader.SetFileName(str(file))
    reader.Update()
    image = reader.GetOutput()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(200, 200, -1)[..., :3].astype(float)


def test_filters_and_rays_show_pictures():
    source = PlenoflameLightField(SceneFile=str(scene), Settings=SETTINGS, Samples=16)
    for shown in (PlenoflameViews(Input=source, Grid=3), PlenoflameRefocus(Input=source, Depth=0.98)):
        seen = pixels(shown)
        filled = (seen.max(axis=2) > 0).mean()
        assert filled > 0.2, filled
        assert len(numpy.unique(seen.reshape(-1, 3), axis=0)) > 20, "a flat square is no picture"
    command("rays", scene, "--pixel", "150,150", "--rays", 8, "-o", "opened.vtp")
    opened = OpenDataFile(str(folder / "opened.vtp"))
    assert of(opened).GetNumberOfLines() > 0
    assert (pixels(opened).max(axis=2) > 0).any()


def test_properties_are_those_of_the_schema():
    about = {path: description for path, description, _, _ in _core.schema()}
    field = PlenoflameLightField()
    for name, path in (("Samples", "render.samples"), ("Seed", "render.seed"), ("Estimator", "render.estimator")):
        said = field.GetProperty(name).SMProperty.GetDocumentation().GetDescription()
        assert about[path].split()[0] in said and path in said, said
    said = PlenoflameDevelop(Input=PlenoflameLightField(SceneFile=str(scene))).GetProperty("Saturation").SMProperty
    assert said.GetDocumentation().GetDescription().strip().startswith("[W] "), said


def test_bad_input_is_one_line_and_no_output():
    broken = folder / "broken.toml"
    broken.write_text(text.replace("[camera]", "[camera]\nlens_count = 3", 1))
    for source in (PlenoflameScene(FileName=str(broken)), PlenoflameScene(FileName=str(scene), Settings="camera.colour=red"),
                   PlenoflameScene(FileName=str(scene), Settings="nonsense"), PlenoflameRays(SceneFile=str(folder / "none.toml"), RandomPixels=1)):
        source.UpdatePipeline()
        assert source.GetDataInformation(0).GetNumberOfPoints() == 0
        Delete(source)


for name, test in list(globals().items()):
    if name.startswith("test_"):
        test()
        print(name, "passed", flush=True)
print("all of it passed")
