"""What numpy, xarray and notebooks ask of a result."""

from __future__ import annotations

import base64
import html
import struct
import warnings
import zlib
from typing import TYPE_CHECKING

import numpy


if TYPE_CHECKING:
    from typing import Any

    from ._types import Array

_SIDE = 192  # pixels of a small picture
_UNITS = {"temperature": "K", "absorption": "1/m", "emission": "W/(m^3 sr)", "resolved": "", "resolved_absorption": ""}


class Shown:
    """Shows itself in a notebook: _summary() gives [(name, text)], _preview() the picture as small_picture() makes it,
    or None."""

    def _repr_html_(self) -> str:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the scene is only looked at
            picture, summary = self._preview(), list(self._summary())
        image = "" if picture is None else (
            f'<td style="vertical-align:top"><img alt="" style="width:{_SIDE}px;image-rendering:pixelated" '
            f'src="data:image/png;base64,{base64.b64encode(_png(picture)).decode()}"></td>')
        rows = "".join(f'<tr><td style="text-align:left">{html.escape(name)}</td>'
                       f'<td style="text-align:left">{html.escape(str(text))}</td></tr>' for name, text in summary)
        return (f'<table><tr>{image}<td style="vertical-align:top"><b>plenoflame.{type(self).__name__}</b>'
                f'<table>{rows}</table></td></tr></table>')


class AtHome(Shown):
    """Is an array, too: _values() gives it, _labelled(xarray) the same with coordinates."""

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        values = self._values()
        if copy is False and dtype is not None and numpy.dtype(dtype) != values.dtype:
            raise ValueError(f"{values.dtype} becomes {numpy.dtype(dtype)} by a copy alone; leave copy=False")
        return values.astype(values.dtype if dtype is None else dtype, copy=bool(copy))

    def to_xarray(self) -> Any:
        """The same for xarray, with coordinates in metres, units and names, so that .plot() is upright and labelled. Raises
        ImportError without xarray."""
        try:
            import xarray
        except ImportError:
            raise ImportError("to_xarray() needs xarray: apt install python3-xarray, or pip install xarray") from None
        return self._labelled(xarray)


def attribute(name, about, of="_data"):
    """A property: what the library's object gives."""
    return property(lambda self: getattr(getattr(self, of), name), doc=about)


def unit_of(field):
    """Of a field of a flame; all others are emission lines."""
    return _UNITS.get(field.removesuffix("_deviation"), "W/m^3")


def labelled(xarray, values, name, units, axes):
    """A DataArray. axes: {dimension: (coordinates, their name, their unit)}, in the array's order."""
    coordinates = {key: (key, numpy.asarray(places), {"long_name": about, **({"units": unit} if unit else {})})
                   for key, (places, about, unit) in axes.items()}
    return xarray.DataArray(values, coordinates, tuple(axes), name=name.replace(" ", "_"),
                            attrs={"long_name": name.replace("_", " "), "units": units})


def middles(count, step):
    """Places of so many pixels about their common middle."""
    return (numpy.arange(count) - (count - 1) / 2) * step


def span(values, unit):
    """The text of an array's range."""
    known = values[numpy.isfinite(values)]
    if known.size == 0:
        return "none"
    return f"{known.min():.4g} to {known.max():.4g} {unit}"


def small_picture(values, hot=False):
    """A picture (rows, columns) or (rows, columns, 3) as a small one of uint8 (rows, columns, 3): white is the largest value.
    hot: temperatures, of which 0 is none; black is the lowest."""
    values = numpy.nan_to_num(numpy.asarray(values, dtype=float), posinf=0, neginf=0)
    step = max(1, -(-max(values.shape[:2]) // _SIDE))
    rows, columns = (max(1, size // step) for size in values.shape[:2])
    values = values[:rows * step, :columns * step]
    if hot:
        values = values[::step, ::step]
        known = values[values > 0]
        low = 0.8 * known.min() if known.size else 0
        shade = numpy.clip((values - low) / ((values.max() - low) or 1), 0, 1)
        colours = numpy.stack([3 * shade, 3 * shade - 1, 3 * shade - 2], -1)
    else:
        blocks = (min(rows * step, values.shape[0]) // rows, min(columns * step, values.shape[1]) // columns)
        values = values.reshape(rows, blocks[0], columns, blocks[1], -1).mean((1, 3))
        colours = numpy.broadcast_to(numpy.clip(values / (values.max() or 1), 0, 1) ** (1 / 2.2), (*values.shape[:2], 3))
    return (255 * numpy.clip(colours, 0, 1) + 0.5).astype(numpy.uint8)


def _png(pixels):
    """The file of a picture of uint8 (rows, columns, 3)."""
    rows, columns, _ = pixels.shape
    lines = numpy.concatenate([numpy.zeros((rows, 1), numpy.uint8), pixels.reshape(rows, -1)], 1)  # 0: no filter

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(lines.tobytes())) + chunk(b"IEND", b""))
