"""The compiled half of the package: that of VTK where it is there, else the one that needs no VTK.

`library.X()` makes a vtkPlenoflameX, or what stands for it without VTK and has the same setters. `data` knows what they
give: vtkImageData and its like, or plain arrays."""

import importlib.util
import types

from ._run import Error

try:
    from . import vtkPlenoflame as vtk
except ImportError as _missing:
    try:
        from . import _core as library
    except ImportError:
        raise _missing from None
    vtk = None
    # If the half with VTK was built and could not be loaded, the message gives the reason.
    _why = f" ({_missing})" if importlib.util.find_spec(__package__ + ".vtkPlenoflame") else ""
    from . import _plain_data as data
else:
    from . import _vtk_data as data

    library = types.SimpleNamespace(**{name[len("vtkPlenoflame"):]: kind for name, kind in vars(vtk).items()
                                       if name.startswith("vtkPlenoflame")})


def need_vtk(what):
    """Refuses what only VTK can do. Raises Error."""
    if vtk is None:
        raise Error(f"{what} needs VTK: install the package with it (Debian package python3-plenoflame-vtk)"
                    + _why)
    return vtk
