#!/usr/bin/env python3
"""Writes the reference of the Python package from its sources: signatures and docstrings, as Markdown.

    python_reference.py FOLDER    the folder app/python/plenoflame; the page goes to standard output

The package is read, not imported, so that neither VTK nor a build is needed. Standard library only.
"""

import ast
import inspect
import pathlib
import sys


def public_names(package):
    """Names of __all__, in its order."""
    for node in ast.parse((package / "__init__.py").read_text()).body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__":
            return ast.literal_eval(node.value)
    raise SystemExit(f"{package}/__init__.py has no __all__")


def definitions(package):
    """Classes and functions of the package's files by name."""
    found = {}
    for path in sorted(package.glob("*.py")):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
                found.setdefault(node.name, node)
    return found


def docstring(node):
    """The docstring; its indented blocks become code for Markdown as they are."""
    return inspect.cleandoc(ast.get_docstring(node) or "")


def signature(function, name):
    """name(arguments), without self."""
    arguments = function.args
    if arguments.args and arguments.args[0].arg in ("self", "cls"):
        arguments.args = arguments.args[1:]
    return f"{name}({ast.unparse(arguments)})"


def is_property(function):
    return any(ast.unparse(d) == "property" for d in function.decorator_list)


def members(node):
    """Public methods and properties of a class, each once."""
    seen = set()
    for child in node.body:
        if isinstance(child, ast.FunctionDef) and not child.name.startswith("_") and child.name not in seen:
            seen.add(child.name)
            yield child
        elif isinstance(child, ast.AnnAssign) and isinstance(child.value, ast.Call):  # a property that a helper makes
            name, about = (ast.literal_eval(argument) for argument in child.value.args[:2])
            yield ast.parse(f"@property\ndef {name}(self):\n    {about!r}").body[0]


def write_function(function, name, level):
    yield f"{'#' * level} `{name}`"
    yield "```python\n" + (name if is_property(function) else signature(function, name)) + "\n```"
    if docstring(function):
        yield docstring(function)


def write_class(node):
    yield f"## `{node.name}`"
    start = next((c for c in node.body if isinstance(c, ast.FunctionDef) and c.name == "__init__"), None)
    if start is not None and docstring(start):
        yield "```python\n" + signature(start, node.name) + "\n```"
    if docstring(node):
        yield docstring(node)
    if start is not None and docstring(start):
        yield docstring(start)
    for child in members(node):
        yield from write_function(child, child.name, 3)


def page(package):
    yield "# Python package"
    yield docstring(ast.parse((package / "__init__.py").read_text()))
    found = definitions(package)
    for name in public_names(package):
        node = found.get(name)
        if isinstance(node, ast.ClassDef):
            yield from write_class(node)
        elif node is not None:
            yield from write_function(node, name, 2)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    print("\n\n".join(page(pathlib.Path(sys.argv[1]))))


if __name__ == "__main__":
    main()
