"""Values of a scene: numbers with units, tables as dicts and lists."""

from __future__ import annotations

import json
import math
import re
from typing import TYPE_CHECKING

from ._run import Error


if TYPE_CHECKING:
    from typing import Any


class Quantity(float):
    """A number in SI units that knows its unit: `unit` ("m"), `text` ("100 um", as a scene file has it). Sums with
    quantities of the same unit and products with numbers keep it; all else gives plain numbers."""

    unit: str
    text: str

    def __new__(cls, value: float, unit: str, text: str | None = None) -> Quantity:
        quantity = super().__new__(cls, value)
        quantity.unit = unit
        quantity.text = text if text is not None else f"{float(value)!r} {unit}"
        return quantity

    def __getnewargs__(self):
        return float(self), self.unit, self.text

    def __repr__(self) -> str:
        return f"Quantity({float(self)!r}, {self.unit!r})"

    def __str__(self) -> str:
        return self.text

    def __mul__(self, other: Any) -> Any:
        product = float(self) * other
        return product if isinstance(other, Quantity) or not isinstance(product, float) else Quantity(product, self.unit)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        quotient = float(self) / other
        return quotient if isinstance(other, Quantity) or not isinstance(quotient, float) else Quantity(quotient, self.unit)

    def __neg__(self) -> Quantity:
        return Quantity(-float(self), self.unit)

    def __add__(self, other: Any) -> Any:
        total = float(self) + other
        return Quantity(total, self.unit) if isinstance(other, Quantity) and other.unit == self.unit else total

    def __sub__(self, other: Any) -> Any:
        return self + -other


def value_of(text):
    """A value of GetValueAsJson: bool, int, float, str, Quantity, or a tuple of numbers."""
    found = json.loads(text)
    value, unit = found["value"], found["unit"]
    if value is None:
        value = -math.inf if found["text"].startswith("-") else math.inf
    if not unit or isinstance(value, (str, bool)):
        return tuple(value) if isinstance(value, list) else value
    if isinstance(value, list):
        return tuple(Quantity(part, unit, own.strip()) for part, own in zip(value, found["text"].split(",")))
    return Quantity(value, unit, found["text"])


def text_of(value):
    """The text that a scene takes for a value."""
    if isinstance(value, str):
        return value
    if isinstance(value, Quantity):
        return value.text
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return ", ".join(map(text_of, value))
    if hasattr(value, "tolist"):  # of numpy
        return text_of(value.tolist())
    if isinstance(value, (int, float)):
        return repr(value)
    raise Error(f"a scene takes texts, numbers, true or false, not {value!r}")


def tree(path, leaves):
    """The dict or list below a path, of its leaves {full path: value}; nothing where there are none."""
    root = {}
    for key, value in leaves.items():
        names = re.findall(r"[^.\[\]]+|\[\d+\]", key[len(path):])
        place = root
        for name in names[:-1]:
            place = place.setdefault(name, {})
        place[names[-1]] = value
    return _lists(root)


def _lists(node):
    if not isinstance(node, dict):
        return node
    if node and all(name.startswith("[") for name in node):
        return [_lists(item) for item in node.values()]
    return {name: _lists(item) for name, item in node.items()}
