"""The type stubs (.pyi), which the build makes, say what the package has: all that is public, with its parameters, defaults and types."""

import ast
import functools
import importlib
import inspect
import os
import pathlib
import subprocess

from package import ROOT, PackageTest, main

import plenoflame

FOLDER = pathlib.Path(plenoflame.__file__).parent


def parameters(function):
    """[(name, kind, has a default)] of a function in a stub."""
    arguments = function.args
    positional = [*arguments.posonlyargs, *arguments.args]
    defaults = [False] * (len(positional) - len(arguments.defaults)) + [True] * len(arguments.defaults)
    kinds = inspect.Parameter
    found = [(a.arg, kinds.POSITIONAL_OR_KEYWORD, d) for a, d in zip(positional, defaults)]
    if arguments.vararg:
        found.append((arguments.vararg.arg, kinds.VAR_POSITIONAL, False))
    found += [(a.arg, kinds.KEYWORD_ONLY, d is not None) for a, d in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    if arguments.kwarg:
        found.append((arguments.kwarg.arg, kinds.VAR_KEYWORD, False))
    return found


def own(namespace, module):
    """Functions and classes that a module or class defines itself."""
    found = {}
    for name, value in vars(namespace).items():
        function = value.fget if isinstance(value, property) else getattr(value, "func", value)  # of a cached property
        function = function.__func__ if isinstance(function, staticmethod) else function
        is_own = (inspect.isfunction(function) or inspect.isclass(function)) and function.__module__ == module
        if is_own or isinstance(value, property):  # which a helper may make
            found[name] = function
    return found


PUBLIC = {*plenoflame.__all__, "Operator"}


class Stubs(PackageTest):
    def compare(self, body, namespace, module, place):
        stub = {node.name: node for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))
                and not any(ast.unparse(d).endswith(".setter") for d in node.decorator_list)}
        real = own(namespace, module)
        public = {name for name in real if not name.startswith("_") and (name in PUBLIC or inspect.isclass(namespace))}
        self.assertLessEqual(public, set(stub), place)
        self.assertLessEqual(set(stub), set(real), place)
        for name, node in stub.items():
            if not inspect.isclass(namespace) and name not in PUBLIC:
                continue
            if isinstance(node, ast.ClassDef):
                self.assertTrue(inspect.isclass(real[name]), name)
                self.compare(node.body, real[name], module, f"{place}.{name}")
                continue
            signature = inspect.signature(getattr(real[name], "__wrapped__", real[name]))
            expected = [(p.name, p.kind, p.default is not p.empty) for p in signature.parameters.values()]
            self.assertEqual(parameters(node), expected, f"{place}.{name}")
            self.assertIsNotNone(node.returns, f"{place}.{name} has no result type")
            for argument in [*node.args.args, *node.args.kwonlyargs]:
                self.assertTrue(argument.annotation or argument.arg in ("self", "cls"), f"{place}.{name}: {argument.arg} has no type")

    def test_stubs_are_the_package(self):
        names = sorted(path.stem for path in FOLDER.glob("*.pyi"))
        self.assertEqual(names, sorted(path.stem for path in FOLDER.glob("*.py")))
        for name in names:
            if name in ("__init__", "vtk", "_vtk", "_types"):
                continue
            tree = ast.parse((FOLDER / (name + ".pyi")).read_text())
            module = importlib.import_module("plenoflame." + name)
            self.compare(tree.body, module, module.__name__, name)

    def test_properties_have_types(self):
        """All of them: those that have a function of their own, and those that are given by the library's object."""
        for name in PUBLIC:
            kind = importlib.import_module("plenoflame.operators").Operator if name == "Operator" else getattr(plenoflame, name)
            if not inspect.isclass(kind):
                continue
            stub = FOLDER / (kind.__module__.rpartition(".")[2] + ".pyi")
            (node,) = [node for node in ast.parse(stub.read_text()).body if isinstance(node, ast.ClassDef) and node.name == name] or [None]
            typed = {child.target.id if isinstance(child, ast.AnnAssign) else getattr(child, "name", "") for child in node.body}
            properties = {key for key, value in vars(kind).items() if isinstance(value, (property, functools.cached_property))}
            self.assertLessEqual(properties, typed, name)

    def test_a_setting_has_the_type_of_its_kind(self):
        """Of each kind one, as the page of the command has it."""
        text = (FOLDER / "reconstruction.pyi").read_text() + (FOLDER / "raw.pyi").read_text()
        for argument in ("unknowns: str=...", "center: Place | None=...", "noise: float=...", "iterations: int=...", "all_voxels: bool=...",
                         "strength: float | None=...", "start: Reconstruction | Path | None=...", "dark: Files=...",
                         "board: str | Sequence[int],", "absorption: Words | None=...", "smoothing: Words | None=...", "spread: str | Sequence[Place]=...",
                         "basis: str | None=...", "bin: int | str=...", "refine: str | Sequence[str] | None=..."):
            self.assertIn(argument, text)

    def test_package_names(self):
        tree = ast.parse((FOLDER / "__init__.pyi").read_text())
        named = {alias.asname for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names if alias.asname}
        self.assertEqual(named, {"vtk", *plenoflame.__all__})

    def test_arrays_of_rays(self):
        """Attributes of Rays are arrays of the data."""
        tree = ast.parse((FOLDER / "rays.pyi").read_text())
        (rays,) = [node for node in tree.body if isinstance(node, ast.ClassDef)]
        named = {node.target.id for node in rays.body if isinstance(node, ast.AnnAssign)} - {"STATUSES"}
        self.assertEqual(named, set(self.scene().rays(pixels=[(40, 40)], rays=2)._data["arrays"]))

    def test_examples_are_typed(self):
        """mypy needs the stubs alone, not the package. It tells nothing of errors in stubs that PYTHONPATH has, too."""
        examples = sorted((ROOT / "examples" / "python").glob("*.py"))
        self.assertGreater(len(examples), 5)
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        run = subprocess.run(["mypy", "--strict", "--ignore-missing-imports", "--allow-subclassing-any", "--cache-dir", self.folder,
                              *examples, *FOLDER.glob("*.pyi")], capture_output=True, text=True, cwd=self.folder,
                             env={**environment, "MYPYPATH": str(FOLDER.parent)})
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)

    def test_marked_as_typed(self):
        self.assertTrue((FOLDER / "py.typed").exists())


if __name__ == "__main__":
    main()
