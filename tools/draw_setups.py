#!/usr/bin/python3
"""Draws setups in 3-D with long empty distances shortened: docs/images/picture-scene.png and ring-of-six.png.

    xvfb-run -a tools/draw_setups.py [NAME ...]     scene, ring; without any, both

Lens, microlenses, sensor, rays and flame come from the scenes in examples/. Only lengths along the optical axis are shortened,
in the ranges that are marked with two slanted lines. Needs the Python package with VTK, and
what drawing.py says.
"""

import re
import sys

from drawing import ROOT, turbulent_flame

try:
    import numpy
    import plenoflame
    import vtkmodules.vtkRenderingFreeType  # noqa: F401  (text)
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (the window)
    import vtkmodules.vtkRenderingVolumeOpenGL2  # noqa: F401  (the flame)
    from matplotlib import font_manager
    from PIL import Image
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPiecewiseFunction, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals, vtkTubeFilter
    from vtkmodules.vtkFiltersSources import vtkPlaneSource
    from vtkmodules.vtkRenderingCore import (vtkActor, vtkBillboardTextActor3D, vtkLight, vtkPolyDataMapper, vtkRenderer,
                                             vtkRenderWindow, vtkTextActor, vtkTexture, vtkVolume, vtkVolumeProperty, vtkWindowToImageFilter)
    from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
except ImportError as missing:
    sys.exit(f"draw_setups.py: {missing}: tools/setup.sh python vtk dev, and cmake --build build/release")

FONT = font_manager.findfont("DejaVu Sans")
TYPES = ((0.34, 0.71, 0.91), (0.94, 0.63, 0.10), (0.10, 0.72, 0.50))  # of microlenses and their rays
BACKGROUND, INK = (0.035, 0.04, 0.05), (0.92, 0.93, 0.95)


def example(name, position, scale):
    """A scene of examples/ with the turbulent flame at this scale, its foot at `position`."""
    text = (ROOT / "examples" / name).read_text()
    flame = f'kind = "vdb"\nfile = "{turbulent_flame(ROOT / "out/overview")}"\nscale = {scale}'
    text = re.sub(r'preset = "paper-layered"\nposition = .*', f"{flame}\nposition = {position}", text)
    return plenoflame.Scene(text=text)


class Axis:
    """An optical axis with shortened ranges: [(begin, end, length)] in m along `direction` from `origin`."""

    def __init__(self, origin, direction, ranges):
        self.origin, self.direction = numpy.array(origin, float), numpy.array(direction, float)
        self.direction /= numpy.linalg.norm(self.direction)
        self.corners = sorted(c for begin, end, _ in ranges for c in (begin, end))
        self.ranges = ranges

    def along(self, points):
        return (numpy.asarray(points, float) - self.origin) @ self.direction

    def drawn(self, s):
        """Places along the axis as drawn: the first range's far end stays where it is."""
        moved = numpy.zeros_like(s)
        for begin, end, length in self.ranges:
            moved += (end - begin - length) * numpy.clip((end - s) / (end - begin), 0, 1)
        return s + moved

    def place(self, points):
        s = self.along(points)
        return numpy.asarray(points, float) + numpy.outer(self.drawn(s) - s, self.direction)

    def bend(self, path):
        """The path with further vertices where a shortened range begins or ends, as drawn."""
        path = numpy.asarray(path, float)
        s, vertices = self.along(path), [path[0]]
        for k in range(len(path) - 1):
            inner = [(c - s[k]) / (s[k + 1] - s[k]) for c in self.corners if (c - s[k]) * (c - s[k + 1]) < 0]
            vertices += [path[k] + t * (path[k + 1] - path[k]) for t in sorted(inner)] + [path[k + 1]]
        return self.place(vertices)


class Drawing:
    def __init__(self, width, height):
        self.renderer = vtkRenderer()
        self.renderer.SetBackground(*BACKGROUND)
        self.renderer.SetUseDepthPeeling(True)
        self.renderer.SetMaximumNumberOfPeels(12)
        self.window = vtkRenderWindow()
        self.window.SetOffScreenRendering(True)
        self.window.SetAlphaBitPlanes(True)
        self.window.SetMultiSamples(0)
        self.window.SetSize(width, height)
        self.window.AddRenderer(self.renderer)

    def light(self, place, strength):
        light = vtkLight()
        light.SetLightTypeToSceneLight()
        light.SetPosition(*place)
        light.SetIntensity(strength)
        self.renderer.AddLight(light)

    def mesh(self, data, colour, opacity=1.0, specular=0.0, smooth=False, ambient=0.1):
        mapper = vtkPolyDataMapper()
        if smooth:
            normals = vtkPolyDataNormals()
            normals.SetInputData(data)
            normals.SetFeatureAngle(40)
            mapper.SetInputConnection(normals.GetOutputPort())
        else:
            mapper.SetInputData(data)
        mapper.SetScalarVisibility(colour is None)
        actor = vtkActor()
        actor.SetMapper(mapper)
        look = actor.GetProperty()
        if colour is not None:
            look.SetColor(*colour)
        look.SetOpacity(opacity)
        look.SetAmbient(ambient)
        look.SetDiffuse(0.8)
        look.SetSpecular(specular)
        look.SetSpecularPower(50)
        self.renderer.AddActor(actor)
        return actor

    def line(self, points, colour, radius, opacity=1.0):
        """A tube along the points."""
        data = lines_of([points])
        tube = vtkTubeFilter()
        tube.SetInputData(data)
        tube.SetRadius(radius)
        tube.SetNumberOfSides(8)
        tube.Update()
        self.mesh(tube.GetOutput(), colour, opacity, ambient=0.7)

    def text(self, place, words, size=34, colour=INK):
        actor = vtkBillboardTextActor3D()
        actor.SetInput(words)
        actor.SetPosition(*place)
        style = actor.GetTextProperty()
        style_text(style, size, colour)
        style.SetJustificationToCentered()
        style.SetVerticalJustificationToCentered()
        self.renderer.AddActor(actor)

    def legend(self):
        """What the colours of the rays mean, at the top left."""
        for k, colour in enumerate(TYPES):
            actor = vtkTextActor()
            actor.SetInput(f"rays through microlenses of type {k + 1}")
            actor.SetPosition(30, self.window.GetSize()[1] - 60 - 44 * k)
            style_text(actor.GetTextProperty(), 30, colour)
            self.renderer.AddActor2D(actor)

    def flame(self, scene, gain, exposure, resolution=160):
        """The flame in the colours of glowing soot. Its absorption is multiplied by `gain`, so that it hides what is behind it."""
        voxels = scene.flame(resolution)
        arrays, spacing, origin, _ = plenoflame.flame_arrays(voxels)
        temperature, absorption = (numpy.asarray(arrays[name], float) for name in ("temperature", "absorption"))
        light = numpy.exp(-1.4388e-2 / numpy.array([610e-9, 549e-9, 468e-9])
                          * (1 / numpy.maximum(temperature, 300)[..., None] - 1 / exposure))
        light *= 1.5 * numpy.array([1.0, 0.33, 0.04])  # a black body of 1900 K in linear sRGB
        colours = numpy.empty(temperature.shape + (4,), numpy.uint8)
        colours[..., :3] = 255 * numpy.clip(light, 0, 1) ** (1 / 2.2)
        colours[..., 3] = 255 * (1 - numpy.exp(-absorption * gain * max(spacing)))
        image = vtkImageData()
        image.SetDimensions(temperature.shape)
        image.SetSpacing(spacing)
        image.SetOrigin(origin)
        image.GetPointData().SetScalars(numpy_to_vtk(colours.transpose(2, 1, 0, 3).reshape(-1, 4).copy(), deep=True))
        mapper = vtkFixedPointVolumeRayCastMapper()
        mapper.SetInputData(image)
        mapper.SetSampleDistance(0.5 * min(spacing))
        mapper.SetAutoAdjustSampleDistances(False)
        opacity = vtkPiecewiseFunction()
        opacity.AddPoint(0, 0)
        opacity.AddPoint(255, 1)
        look = vtkVolumeProperty()
        look.IndependentComponentsOff()
        look.SetScalarOpacity(opacity)
        look.SetScalarOpacityUnitDistance(max(spacing))
        look.SetInterpolationTypeToLinear()
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(look)
        self.renderer.AddVolume(volume)

    def camera(self, scene, axis, shown=False, stop=True):
        """Glass, stop, microlenses by type and sensor of the scene's camera; `shown`: a picture lies on the sensor."""
        blocks = scene.camera()
        for i in range(blocks.GetNumberOfBlocks()):
            name, data = blocks.GetMetaData(i).Get(blocks.NAME()), vtkPolyData()
            if not blocks.GetBlock(i).GetNumberOfPoints():
                continue
            data.DeepCopy(blocks.GetBlock(i))
            data.GetPoints().SetData(numpy_to_vtk(axis.place(vtk_to_numpy(data.GetPoints().GetData())), deep=True))
            if name.startswith("lens"):
                self.mesh(data, (0.62, 0.80, 0.95), 0.30, 1.0, True, 0.3)
            elif name == "stop" and stop:
                self.mesh(data, (0.45, 0.47, 0.50), 0.6, 0.3, ambient=0.25)
            elif name == "microlenses":
                types = vtk_to_numpy(data.GetCellData().GetArray("type"))
                data.GetCellData().SetScalars(numpy_to_vtk((255 * numpy.array(TYPES)[types]).astype(numpy.uint8), deep=True))
                self.mesh(data, None, 0.5, 0.6, True)
            elif name == "sensor" and not shown:
                self.mesh(data, (0.55, 0.57, 0.60), ambient=0.4)

    def sensor_image(self, scene, axis, picture):
        """Lays a developed raw picture (rows, columns; 0 to 1) on the sensor."""
        def pixel(x, y):
            return axis.place(scene.rays(pixels=[(x, y)], rays=2).path(0)[:1])[0]
        last = (scene.columns - 1, scene.rows - 1)
        plane = vtkPlaneSource()
        plane.SetOrigin(*pixel(0, last[1]))
        plane.SetPoint1(*pixel(*last))
        plane.SetPoint2(*pixel(0, 0))
        image = vtkImageData()
        image.SetDimensions(picture.shape[1], picture.shape[0], 1)
        warm = numpy.clip(picture[::-1, :, None] * numpy.array([1.0, 0.72, 0.36]), 0, 1)
        image.GetPointData().SetScalars(numpy_to_vtk((255 * warm).astype(numpy.uint8).reshape(-1, 3), deep=True))
        texture = vtkTexture()
        texture.SetInputData(image)
        mapper = vtkPolyDataMapper()
        mapper.SetInputConnection(plane.GetOutputPort())
        actor = vtkActor()
        actor.SetMapper(mapper)
        actor.SetTexture(texture)
        actor.GetProperty().SetLighting(False)
        self.renderer.AddActor(actor)

    def rays(self, rays, axis, radius, opacity):
        for i in range(len(rays)):
            self.line(axis.bend(rays.path(i)), TYPES[rays.type[i]], radius, opacity)

    def distance(self, axis, begin, end, across, words):
        """A line beside the axis between two places of it, with two slanted lines, and the true distance below."""
        from_, to = (axis.place([axis.origin + s * axis.direction])[0] + across for s in (begin, end))
        step, upward = (to - from_) / numpy.linalg.norm(to - from_), numpy.array([0, 0, 1.0])
        middle, size = 0.5 * (from_ + to), 0.004
        for ends in ((from_, middle - size / 2 * step), (middle + size / 2 * step, to), (from_ - size * upward, from_ + size * upward),
                     (to - size * upward, to + size * upward)):
            self.line(ends, INK, 0.0003)
        for side in (-1, 1):
            slant = size * (upward + 0.35 * step)
            self.line([middle + side * size / 2 * step - slant, middle + side * size / 2 * step + slant], INK, 0.0003)
        self.text(middle - 0.008 * upward, words)

    def look(self, eye, target, height, up=(0, 0, 1)):
        """A parallel projection that is `height` metres high."""
        camera = self.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetParallelScale(height / 2)
        camera.SetPosition(*(numpy.array(target) + numpy.array(eye)))
        camera.SetFocalPoint(*target)
        camera.SetViewUp(*up)
        self.renderer.ResetCameraClippingRange()

    def save(self, name):
        self.window.Render()
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        grab.Update()
        image = grab.GetOutput()
        columns, rows, _ = image.GetDimensions()
        pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, -1)[::-1, :, :3]
        target = ROOT / "docs/images" / name
        picture = Image.fromarray(numpy.ascontiguousarray(pixels))
        picture.quantize(palette=picture.quantize(256), dither=Image.Dither.FLOYDSTEINBERG).save(target, optimize=True)
        print(target)


def style_text(style, size, colour):
    style.SetFontFamily(4)  # VTK_FONT_FILE
    style.SetFontFile(FONT)
    style.SetFontSize(size)
    style.SetColor(*colour)


def lines_of(paths):
    points, lines = vtkPoints(), vtkCellArray()
    for path in paths:
        lines.InsertNextCell(len(path))
        for vertex in path:
            lines.InsertCellPoint(points.InsertNextPoint(*vertex))
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetLines(lines)
    return data


def behind(scene, kind, column, row):
    """A pixel near this one whose rays all pass through a microlens of this type and reach the flame."""
    pitch = scene.columns // 30
    near = [(x, y) for y in range(row, row + 2 * pitch, pitch // 2) for x in range(column, column + 3 * pitch, pitch // 2)]
    found = {pixel: scene.rays(pixels=[pixel], rays=8, status="reached") for pixel in near}
    return next(pixel for pixel, rays in found.items() if len(rays) == 8 and (rays.type == kind).all())


def draw_scene():
    """One camera: the rays of three neighbouring pixels, each behind a microlens of another type."""
    scene = example("lenslets-30.toml", '["1 m", "0 mm", "-52 mm"]', 0.35)
    axis = Axis((0, 0, 0), (1, 0, 0), [(-0.4464, -0.0243, 0.13), (0.0005, 0.97, 0.12)])
    drawing = Drawing(1800, 1020)
    drawing.light((-0.3, -1, 1.2), 0.9)
    drawing.light((1.2, -0.6, 0.2), 0.5)
    drawing.camera(scene, axis, shown=True)
    drawing.sensor_image(scene, axis, scene.render(samples=16, threads=1).develop() / 2 ** 14)
    pixels = [behind(scene, kind, 150, row) for kind, row in enumerate((70, 150, 230))]
    drawing.rays(scene.rays(pixels=pixels, rays=16, status="reached"), axis, 0.00028, 0.75)
    drawing.flame(scene, 25.0, 1900)
    below = numpy.array([0, 0, -0.066])
    drawing.distance(axis, -0.4493, -0.0243, below, "425 mm")
    drawing.distance(axis, 0, 1, below, "1 m")
    for s, z, words in ((-0.4463, 0.027, "microlenses\nand sensor"), (-0.012, 0.082, "stop and main lens"), (1, 0.062, "flame")):
        drawing.text(axis.place([(s, 0, z)])[0], words)
    drawing.legend()
    drawing.look((0.35, -1, 0.30), (0.85, 0, 0.003), 0.192)
    drawing.save("picture-scene.png")


def draw_ring():
    """Six cameras around a flame, with the rays of two points of the flame."""
    drawing = Drawing(1900, 1110)
    drawing.light((0, 0, 2), 0.9)
    drawing.light((-1, -2, 1), 0.5)
    ring = example("ring-of-six.toml", '["0 mm", "0 mm", "-70 mm"]', 0.5)
    for k, name in enumerate(ring.cameras):
        scene = ring.with_camera(name)
        position = [float(x) for x in numpy.array([value for value in scene[f"cameras[{k}].position"]], float)]
        axis = Axis((0, 0, 0), [-x for x in position], [(-1.4464, -1.0243, 0.09), (-0.9995, -0.04, 0.20)])
        drawing.camera(scene, axis, stop=False)
        drawing.text(axis.place([axis.origin - 1.478 * axis.direction])[0], name)
        drawing.rays(scene.rays(points=[(0, 0, 0.012), (0, 0, -0.012)], rays=10, status="reached"), axis, 0.0004, 0.7)
    drawing.flame(scene, 25.0, 1900)
    drawing.legend()
    drawing.look((0.35, -1, 0.70), (0.005, 0, 0.002), 0.485)
    drawing.save("ring-of-six.png")


if __name__ == "__main__":
    drawings = {"scene": draw_scene, "ring": draw_ring}
    for wanted in sys.argv[1:] or drawings:
        drawings[wanted]()
