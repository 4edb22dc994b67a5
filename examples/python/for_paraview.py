"""Writes flame, camera, rays and light field for ParaView: open scene.vtm.

    for_paraview.py [SCENE.toml] [FOLDER]      writes FOLDER/scene.vtm and the folder scene beside it
"""

import pathlib
import sys

from vtkmodules.vtkCommonDataModel import vtkMultiBlockDataSet
from vtkmodules.vtkIOXML import vtkXMLMultiBlockDataWriter

import plenoflame

here = pathlib.Path(__file__).resolve().parent
scene = plenoflame.Scene(sys.argv[1] if len(sys.argv) > 1 else here.parent / "lenslets-30.toml")
folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ".")

rays = scene.rays(pixels=[(scene.columns // 2, scene.rows // 2)], rays=64, flame_samples=32)
blocks = {"camera": scene.camera(LevelOfDetail=1), "flame": scene.flame(96).to_vtk(), "rays": rays.to_vtk(),
          "light field": scene.render(samples=4).to_vtk()}
together = vtkMultiBlockDataSet()
for number, (name, data) in enumerate(blocks.items()):
    together.SetBlock(number, data)
    together.GetMetaData(number).Set(together.NAME(), name)
writer = vtkXMLMultiBlockDataWriter()
writer.SetFileName(str(folder / "scene.vtm"))
writer.SetInputData(together)
if not writer.Write():
    sys.exit(f"cannot write {folder / 'scene.vtm'}")
print(folder / "scene.vtm")
