"""Renders a scene, its rays and its light field with VTK alone, without a window (under xvfb-run where there is no display).

    vtk_pipeline.py [SCENE.toml] [FOLDER]      writes FOLDER/pipeline.png
"""

import pathlib
import sys

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (what draws)
from plenoflame.vtk import (vtkPlenoflameCameraSource, vtkPlenoflameLightFieldSource, vtkPlenoflameRayPathSource,
                            vtkPlenoflameSceneReader)
from vtkmodules.vtkFiltersGeometry import vtkCompositeDataGeometryFilter
from vtkmodules.vtkImagingColor import vtkImageMapToWindowLevelColors
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (vtkActor, vtkImageActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkWindowToImageFilter)

here = pathlib.Path(__file__).resolve().parent
path = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else here.parent / "lenslets-30.toml")
folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ".")

scene = vtkPlenoflameSceneReader()
scene.SetFileName(str(path))
scene.Update()

camera = vtkPlenoflameCameraSource()
rays = vtkPlenoflameRayPathSource()
light_field = vtkPlenoflameLightFieldSource()
for source in (camera, rays, light_field):
    source.SetInputConnection(scene.GetOutputPort())
rays.AddPixel(scene.GetOutput().GetNumberOfColumns() // 2, scene.GetOutput().GetNumberOfRows() // 2)
rays.SetRaysPerPixel(32)
light_field.SetSamples(8)
light_field.Update()

# Left: the camera and the rays of its middle pixel.
left = vtkRenderer()
together = vtkCompositeDataGeometryFilter()
together.SetInputConnection(camera.GetOutputPort())
surfaces = vtkPolyDataMapper()
surfaces.SetInputConnection(together.GetOutputPort())
surfaces.ScalarVisibilityOff()
glass = vtkActor()
glass.SetMapper(surfaces)
glass.GetProperty().SetColor(0.3, 0.5, 0.8)
glass.GetProperty().SetOpacity(0.4)
lines = vtkPolyDataMapper()
lines.SetInputConnection(rays.GetOutputPort())
lines.SetScalarModeToUseCellFieldData()
lines.SelectColorArray("status")
lines.SetScalarRange(0, 3)
paths = vtkActor()
paths.SetMapper(lines)
for actor in (glass, paths):
    left.AddActor(actor)
left.SetViewport(0, 0, 0.5, 1)
left.SetBackground(1, 1, 1)
left.GetActiveCamera().SetPosition(-0.3, -1, 0.3)  # the optical axis is x, z is up
left.GetActiveCamera().SetViewUp(0, 0, 1)
rays.Update()
left.ResetCamera(rays.GetOutput().GetBounds())
left.GetActiveCamera().Zoom(1.2)

# Right: the raw picture, white at its largest flux.
right = vtkRenderer()
most = light_field.GetOutput().GetScalarRange()[1]
grey = vtkImageMapToWindowLevelColors()
grey.SetInputConnection(light_field.GetOutputPort())
grey.SetWindow(most)
grey.SetLevel(most / 2)
picture = vtkImageActor()
picture.GetMapper().SetInputConnection(grey.GetOutputPort())
right.AddActor(picture)
right.SetViewport(0.5, 0, 1, 1)
right.GetActiveCamera().ParallelProjectionOn()
grey.Update()
right.ResetCamera()

window = vtkRenderWindow()
window.SetOffScreenRendering(True)
window.SetSize(1000, 500)
for renderer in (left, right):
    window.AddRenderer(renderer)
window.Render()
grab = vtkWindowToImageFilter()
grab.SetInput(window)
writer = vtkPNGWriter()
writer.SetInputConnection(grab.GetOutputPort())
writer.SetFileName(str(folder / "pipeline.png"))
writer.Write()
print(folder / "pipeline.png")
