"""Types of arguments and results, for type checkers alone: modules import it under TYPE_CHECKING."""

from os import PathLike
from typing import Any, Callable, Mapping, Sequence

from numpy.typing import NDArray

Array = NDArray[Any]
Path = str | PathLike[str]
Place = str | Sequence[float]
Progress = bool | Callable[[float], Any]
Files = Path | Sequence[Path] | Mapping[Any, Path | Sequence[Path]]
Table = Path | Array
Value = str | bool | int | float | Sequence[str | bool | int | float]
Words = str | float | Sequence[str | float]
