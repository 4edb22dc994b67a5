"""Arguments that are rows of the library's table of settings."""

import functools
import inspect
import os

from . import _check, _core
from ._arguments import refusal
from ._run import Error, errors_of
from ._values import Quantity, text_of

_Kind = _core.SettingKind
_TYPES = {_Kind.text: "Words", _Kind.word: "str", _Kind.whole: "int", _Kind.number: "float", _Kind.flag: "bool",
          _Kind.lengths: "Place", _Kind.sides: "str | Sequence[int]", _Kind.file: "Path"}  # of _types

_SHARED = {"threads": "0: one per processor",
           "progress": "True for a bar, or a function that is called with the fraction done; a true result stops it"}


def lengths(value, unit="m"):
    """A text, or numbers in metres, as a text with units."""
    if isinstance(value, (str, Quantity)):
        return text_of(value)
    if isinstance(value, (list, tuple)) or hasattr(value, "tolist"):
        return ", ".join(lengths(part, unit) for part in value)
    return f"{_check.number('a length', value)!r} {unit}"


def words(value):
    """A text, a number, or several of them with commas between."""
    if isinstance(value, (list, tuple)):
        return ",".join(words(part) for part in value)
    return text_of(value)


def _default(value, kind, repeated, required):
    if required:
        return inspect.Parameter.empty
    if repeated:
        return ()
    if kind == _Kind.flag:
        return False
    if not value:
        return None
    return int(value) if value.isdigit() else float(value) if kind == _Kind.number else value


class Settings:
    """The settings of a request: their names, defaults and texts."""

    def __init__(self, rows, **types):
        """rows: those of the library's table; types: of those that take more than their kind"""
        self._types = types
        self.rows = {name.replace("-", "_"): (name, text, _default(value, kind, repeated, required), kind, repeated, form)
                     for name, form, text, value, kind, repeated, required in rows}

    def arguments_of(self, function):
        """Decorates a function that takes them as **settings: it gets their signature, and their texts in its docstring."""
        keyword = inspect.Parameter.KEYWORD_ONLY
        kept = [p for p in inspect.signature(function).parameters.values() if p.kind is not p.VAR_KEYWORD]
        rows = [inspect.Parameter(name, keyword, default=row[2], annotation=self._type(name, *row[2:])) for name, row in self.rows.items()]
        signature = inspect.Signature([p for p in kept if p.kind is not keyword] + rows + [p for p in kept if p.kind is keyword])
        known = [name for name in signature.parameters if name != "self"]

        @functools.wraps(function)
        def checked(*arguments, **named):
            for name in named:
                if name not in known:
                    raise TypeError(refusal(function.__qualname__, name, known))
            signature.bind(*arguments, **named)  # TypeError where one is missing
            return function(*arguments, **named)

        del checked.__wrapped__  # whose signature is another one
        checked.__signature__ = signature
        indent = " " * (8 if "self" in signature.parameters else 4)
        texts = {name: row[1] for name, row in self.rows.items()} | {p.name: _SHARED[p.name] for p in kept if p.name in _SHARED}
        checked.__doc__ = function.__doc__.replace("{settings}", ("\n" + indent).join(map(": ".join, texts.items())))
        return checked

    def _type(self, name, default, kind, repeated, form):
        """Gives the type of a setting, as annotations have it."""
        own = _TYPES[_Kind.text if kind == _Kind.number and "," in form else kind]
        if repeated:
            own = {_Kind.file: "Files", _Kind.lengths: "str | Sequence[Place]"}.get(kind, own)
        return self._types.get(name, own) + (" | None" if default is None else "")

    def set(self, algorithm, given):
        """Gives an object of the library those that are not None or the defaults. Raises Error."""
        with errors_of():
            for name, value in given.items():
                own, _, default, kind, repeated, _ = self.rows[name]
                for one in ([value] if not repeated or isinstance(value, str) else value):
                    if one is not None and one is not default:
                        algorithm.set_option(own, _text(name, one, kind))


def _text(name, value, kind):
    """Gives the text that a row takes."""
    if kind == _Kind.flag:
        return str(bool(value)).lower()
    if kind == _Kind.file:
        return os.fspath(value)
    if kind == _Kind.lengths:
        return lengths(value)
    if kind == _Kind.sides and not isinstance(value, str):
        return "x".join(map(str, _check.several(name, value, 2, "two whole numbers")))
    if name in ("absorption", "constant") and not isinstance(value, str):
        return lengths(value, "1/m")
    return words(value)


def cameras_of(scene):
    """A scene for each of its cameras; of several scenes, one after the other."""
    from .scene import Scene
    scenes = scene if isinstance(scene, (list, tuple)) else [scene]
    found = []
    for one in scenes:
        if not isinstance(one, Scene):
            raise Error(f"scene takes a Scene, or a list of them, not {one!r}")
        chosen = [one.camera_name] if one.camera_name else one.cameras
        # Copies: what is changed of the scene afterwards plays no part.
        found += [one.with_camera(name) if name else one.copy() for name in chosen]
    if not found:
        raise Error("scene takes a Scene, or a list of them, not an empty list")
    return found
