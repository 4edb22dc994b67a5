"""Arguments, refused with the sentence that the command line has for its options."""

import math
import numbers
import os

import numpy

from . import _core
from ._run import Error

_MOST = 2 ** 31 - 1


def whole(name, value, low=0, high=_MOST):
    """A whole number from low to high."""
    if isinstance(value, numbers.Integral) and not isinstance(value, bool) and low <= value <= high:
        return int(value)
    raise Error(f"{name} takes a whole number from {low} to {high}, not {value!r}")


def threads(value):
    return whole("threads", value, 0, 4096)


def number(name, value, low=-math.inf, high=math.inf):
    """A finite number from low to high."""
    if isinstance(value, numbers.Real) and math.isfinite(value) and low <= value <= high:
        return float(value)
    if low == -math.inf:
        wanted = "a number"
    else:
        wanted = f"a number of at least {low:g}" if high == math.inf else f"a number from {low:g} to {high:g}"
    raise Error(f"{name} takes {wanted}, not {value!r}")


def several(name, values, count, what, kind=whole, **limits):
    """A sequence of so many numbers."""
    try:
        items = list(values)
    except TypeError:
        items = []
    if len(items) != count:
        raise Error(f"{name} takes {what}, not {values!r}")
    return [kind(name, item, **limits) for item in items]


def array(name, values, shape):
    """An array of this shape, or a single number for all of it."""
    values = numpy.asarray(values)
    if values.shape in (shape, ()):
        return values
    raise Error(f"{name} takes an array of the shape {shape}, not {values.shape}")


def choice(name, value, choices):
    """One of these words."""
    if value in choices:
        return value
    listed = ", ".join(repr(c) for c in choices if c is not None)
    raise Error(f"there is no {name} {value!r}; there are {listed}")


def seconds(name, value):
    """A time above 0 s: seconds, or a text with a unit. "auto" is 0."""
    if isinstance(value, str):
        if value == "auto":
            return 0.0
        try:
            value = _core.seconds(value)
        except _core.Failure as failure:
            raise Error(f"{name}: {failure}") from None
    value = number(name, value, 0)
    if value == 0:
        raise Error(f"{name} takes a time above 0 s, or 'auto'")
    return value


def names(name, values, what):
    """Texts: a sequence of them, or one text with commas."""
    if isinstance(values, str):
        values = values.split(",") if values else ()
    try:
        return [text(name, value) for value in values]
    except TypeError:
        raise Error(f"{name} takes {what}, not {values!r}") from None


def text(name, value):
    if isinstance(value, str):
        return value
    raise Error(f"{name} takes a text, not {value!r}")


def file(path, endings, hint=""):
    """The path of a file to write, with one of these endings."""
    try:
        name = os.fspath(path)
    except TypeError:
        raise Error(f"{path!r} is not the name of a file") from None
    if not str(name).endswith(endings):
        wanted = endings if isinstance(endings, str) else " or ".join(endings)
        raise Error(f"'{name}' must end in {wanted}{hint}")
    return str(name)
