from typing import Any

library: Any
data: Any
vtk: Any

def need_vtk(what: str) -> Any: ...
