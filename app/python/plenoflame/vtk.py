"""The classes of VTK pipelines: vtkPlenoflameSceneReader, vtkPlenoflameLightFieldSource and the others (docs/scripting.md).

    import plenoflame
    source = plenoflame.vtk.vtkPlenoflameLightFieldSource()
    source.SetInputDataObject(plenoflame.Scene("examples/lenslets-30.toml").to_vtk())

`import plenoflame` does not load it."""

try:
    from .vtkPlenoflame import *  # noqa: F403
    from .vtkPlenoflameImport import *  # noqa: F403
    from .vtkPlenoflameViews import *  # noqa: F403
except ImportError as _missing:
    raise ImportError("plenoflame.vtk needs VTK: install the package with it (Debian package python3-plenoflame-vtk; "
                      f"{_missing})") from None
