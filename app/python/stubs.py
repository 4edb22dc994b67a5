"""Writes the type stubs (.pyi) of the Python package beside its sources, where it was built. They have what is annotated, with
the rows of the library's tables in place of **settings.

    stubs.py PACKAGE    the folder of the package, with its compiled module
"""

import ast
import importlib
import inspect
import pathlib
import sys
import unittest.mock


def stub_of_function(node, namespace):
    """Leaves its signature of a function, with what an `arguments_of` adds."""
    arguments = node.args
    arguments.defaults = [ast.Constant(...) for _ in arguments.defaults]
    arguments.kw_defaults = [value and ast.Constant(...) for value in arguments.kw_defaults]
    if any(ast.unparse(decorator).endswith(".arguments_of") for decorator in node.decorator_list):
        node.decorator_list, arguments.kwarg = [], None
        own = {argument.arg for argument in [*arguments.args, *arguments.kwonlyargs]}
        for parameter in reversed(inspect.signature(getattr(namespace(), node.name)).parameters.values()):
            if parameter.name not in own:
                arguments.kwonlyargs.insert(0, ast.arg(parameter.name, ast.parse(parameter.annotation, mode="eval").body))
                arguments.kw_defaults.insert(0, None if parameter.default is parameter.empty else ast.Constant(...))
    node.body = [ast.Expr(ast.Constant(...))]
    return node


def attributes_of(node):
    """Gives the annotated attributes that __init__ sets."""
    for child in node.body:
        if isinstance(child, ast.AnnAssign) and isinstance(child.target, ast.Attribute):
            yield ast.AnnAssign(ast.Name(child.target.attr), child.annotation, None, 1)


def stubs_of(body, namespace):
    """Gives the stubs of a module or class, which `namespace` returns."""
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            def own(name=node.name):
                return getattr(namespace(), name)
            node.body = list(stubs_of(node.body, own)) or [ast.Expr(ast.Constant(...))]
            node.decorator_list = []
            yield node
        elif isinstance(node, ast.FunctionDef) and node.returns is not None:
            yield from attributes_of(node)
            yield stub_of_function(node, namespace)
        elif isinstance(node, ast.AnnAssign) and isinstance(node.value, ast.Call):
            yield from ast.parse(f"@property\ndef {node.target.id}(self) -> {ast.unparse(node.annotation)}: ...").body
        elif isinstance(node, ast.AnnAssign):
            node.value = None
            yield node
        elif isinstance(node, ast.Assign) and isinstance(node.value, ast.Name):
            yield node


def imports_of(nodes):
    """Gives the names that statements import, each with its import."""
    for node in nodes:
        if isinstance(node, (ast.Import, ast.ImportFrom)) and getattr(node, "module", "") != "__future__":
            for alias in node.names:
                kind = ast.ImportFrom(node.module, [alias], node.level) if isinstance(node, ast.ImportFrom) else ast.Import([alias])
                yield alias.asname or alias.name, ast.unparse(kind)


def types_of(path):
    """Gives the names of `_types`, which the library's tables use in each module, each with its import."""
    for node in ast.parse(path.with_name("_types.py").read_text()).body:
        if isinstance(node, ast.Assign):
            yield node.targets[0].id, f"from ._types import {node.targets[0].id}"


def stub_of(path):
    """The text of a module's stub."""
    tree = ast.parse(path.read_text())
    if path.stem == "_types":
        return path.read_text()
    if path.stem == "__init__":
        names = [(node.level * "." + (node.module or ""), alias.name) for node in tree.body if isinstance(node, ast.ImportFrom)
                 for alias in node.names if not (alias.asname or "").startswith("_")]
        return "".join(f"from {module} import {name} as {name}\n" for module, name in [*names, (".", "vtk")]) + "__all__: list[str]\n"
    checking = [child for node in tree.body if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING" for child in node.body]
    body = [node for node in checking if isinstance(node, ast.Assign)]
    body += stubs_of(tree.body, lambda: importlib.import_module("plenoflame." + path.stem))
    text = "\n".join(map(ast.unparse, body))
    used = {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}
    imports = dict([*imports_of([*tree.body, *checking]), *types_of(path)])
    return "\n".join([line for name, line in imports.items() if name in used] + [text, ""])


def main():
    package = pathlib.Path(sys.argv[1]).resolve()
    sys.modules["numpy"] = unittest.mock.MagicMock()  # signatures do not need it
    sys.path.insert(0, str(package.parent))
    for path in sorted(package.glob("*.py")):
        if path.stem != "vtk":  # whose stub is written by hand
            path.with_suffix(".pyi").write_text(stub_of(path))


if __name__ == "__main__":
    main()
