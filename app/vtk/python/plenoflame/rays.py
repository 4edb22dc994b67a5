"""Paths of rays."""

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from ._run import Error, errors_of


class Rays:
    """Rays from the sensor to the scene. What docs/rays.md says about a .vtp file holds for `polydata`; its arrays are
    attributes, numpy views without a copy:

    per ray: pixel (n, 2), microlens (n, 2), type, status, ended_at, solid, wavelength (n, channels), weight, radiance (n,
    channels), optical_thickness; per vertex: points (m, 3), surface, refractive_index, distance, temperature,
    absorption. Ray i has the vertices offsets[i] to offsets[i + 1].
    """

    STATUSES = ("reached", "vignetted", "total internal reflection", "missed")

    def __init__(self, polydata):
        self.polydata = polydata

    def __len__(self):
        return self.polydata.GetNumberOfLines()

    def __repr__(self):
        return f"<plenoflame.Rays, {len(self)} rays, {self.polydata.GetNumberOfPoints()} vertices>"

    @property
    def points(self):
        """Vertices in the world [m]: (m, 3)."""
        return vtk_to_numpy(self.polydata.GetPoints().GetData())

    @property
    def offsets(self):
        """Where each ray's vertices begin, and the last one's end: (n + 1,)."""
        return vtk_to_numpy(self.polydata.GetLines().GetOffsetsArray())

    @property
    def surfaces(self):
        """Names of the surfaces, by number."""
        names = self.polydata.GetFieldData().GetAbstractArray("surfaces")
        return [names.GetValue(i) for i in range(names.GetNumberOfValues())]

    def __getattr__(self, name):
        if name.startswith("_") or name == "polydata":
            raise AttributeError(name)
        for data in (self.polydata.GetCellData(), self.polydata.GetPointData()):
            array = data.GetArray(name)
            if array is not None:
                values = vtk_to_numpy(array)
                return values.reshape(len(values), -1) if name in ("wavelength", "radiance") else values
        raise AttributeError(f"rays have no {name!r}")

    def path(self, i):
        """Vertices of ray i [m]: (k, 3)."""
        begin, end = self.offsets[i:i + 2]
        return self.points[begin:end]

    def save(self, path):
        """Writes the rays as .vtp, which ParaView opens."""
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(str(path))
        writer.SetInputData(self.polydata)
        with errors_of(writer):
            if not writer.Write():
                raise Error(f"cannot write '{path}'")
