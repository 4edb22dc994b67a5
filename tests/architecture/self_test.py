#!/usr/bin/env python3
"""Feeds every rule of check.py a bad example and a good one, so that none can pass by looking away."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import check

HEADER = "core/include/plenoflame/{}.h"


class SourceRules(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)
        (self.root / "core").mkdir()

    def breaches(self, rule, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(text.encode("utf-8"))
        found = list(check.SOURCE_RULES[rule](self.root))
        file.unlink()
        return found

    def assert_bad(self, rule, path, text, line=1):
        found = self.breaches(rule, path, text)
        self.assertEqual(len(found), 1, f"{path}: {text!r}: {found}")
        self.assertTrue(found[0].startswith(f"{path}:{line}: "), found)

    def assert_good(self, rule, path, text):
        self.assertEqual(self.breaches(rule, path, text), [], f"{path}: {text!r}")

    def test_areas(self):
        for path, name in [
            (HEADER.format("math/ray"), "plenoflame/optics/surface.h"),      # upwards
            (HEADER.format("media/m"), "plenoflame/optics/surface.h"),       # sideways
            (HEADER.format("media/m"), "plenoflame/scene/scene.h"),          # plain values, but not for media
            (HEADER.format("optics/lens"), "plenoflame/scene/compile.h"),
            (HEADER.format("camera/c"), "plenoflame/scene/compile.h"),
            (HEADER.format("lightfield/views"), "plenoflame/render/render.h"),
            (HEADER.format("lightfield/views"), "plenoflame/scene/compile.h"),
            (HEADER.format("math/ray"), "plenoflame/volumes/flame.h"),
            (HEADER.format("math/ray"), "math/kernel_math.h"),               # internal header in a public one
            (HEADER.format("math/ray"), "plenoflame/nowhere/x.h"),
            ("core/src/math/vector.cpp", "plenoflame/media/medium.h"),
            ("core/src/math/vector.cpp", "optics/trace.h"),
            ("core/src/math/vector.cpp", "../optics/trace.h"),
        ]:
            self.assert_bad("includes", path, f'#include "{name}"\n')
        for path, name in [
            (HEADER.format("math/ray"), "plenoflame/base/error.h"),
            (HEADER.format("math/ray"), "plenoflame/math/vector.h"),
            (HEADER.format("camera/c"), "plenoflame/scene/scene.h"),
            (HEADER.format("lightfield/views"), "plenoflame/scene/scene.h"),
            (HEADER.format("render/render"), "plenoflame/scene/compile.h"),
            ("core/src/media/grid.cpp", "math/kernel_math.h"),
            ("volumes/src/grid.cpp", "plenoflame/media/medium.h"),
            ("app/cli/main.cpp", "plenoflame/render/render.h"),
        ]:
            self.assert_good("includes", path, f'#include "{name}"\n')

    def test_circles(self):
        other = self.root / "core/src/render/tracer/t.cpp"
        other.parent.mkdir(parents=True)
        (self.root / "core/src/render/run").mkdir()
        (self.root / "core/src/render/run/r.h").touch()
        other.with_suffix(".h").touch()
        other.write_text('#include "render/run/r.h"\n')
        self.assert_good("circles", "core/src/render/run/r.cpp", '#include "render/run/r.h"\n')
        self.assertEqual(len(self.breaches("circles", "core/src/render/run/r.cpp", '#include "render/tracer/t.h"\n')), 1)

    def test_libraries(self):
        for path, name in [
            (HEADER.format("image/exr"), "ImfOutputFile.h"), (HEADER.format("base/x"), "unistd.h"),
            (HEADER.format("math/x"), "Eigen/Dense"), (HEADER.format("scene/x"), "toml++/toml.h"),
            ("core/src/scene/x.cpp", "openvdb/openvdb.h"), ("core/src/scene/x.cpp", "nanovdb/NanoVDB.h"),
            ("core/src/scene/x.cpp", "vtkImageData.h"), ("core/src/scene/x.cpp", "QWidget"),
            ("core/src/scene/x.cpp", "CLI/CLI.hpp"), ("core/src/scene/x.cpp", "tbb/parallel_for.h"),
            ("core/src/scene/x.cpp", "plenoflame/base/error.h"), ("core/src/scene/x.cpp", "unknown.hpp"),
            ("volumes/include/plenoflame/volumes/flame.h", "openvdb/openvdb.h"),
            ("volumes/src/x.cpp", "vtkImageData.h"), ("volumes/src/x.cpp", "CLI/CLI.hpp"),
            ("app/cli/main.cpp", "openvdb/openvdb.h"), ("app/cli/main.cpp", "QString"),
            ("app/cli/main.cpp", "ImfOutputFile.h"), ("app/cli/ranks.cpp", "mpi.h"), ("core/src/base/x.cpp", "mpi.h"), ("app/vtk/vtkX.cxx", "QWidget"),
            ("app/vtk/vtkX.cxx", "openvdb/openvdb.h"), ("app/python/x.cpp", "vtkImageData.h"),
            ("tests/core/a/x_test.cpp", "openvdb/openvdb.h"),
        ]:
            self.assert_bad("includes", path, f"\n#  include <{name}>\n", line=2)
        for path, name in [
            (HEADER.format("math/x"), "array"), ("core/src/image/x.cpp", "ImfOutputFile.h"),
            ("core/src/image/x.cpp", "png.h"), ("core/src/scene/x.cpp", "toml++/toml.h"),
            ("volumes/include/plenoflame/volumes/interop.h", "openvdb/openvdb.h"),
            ("volumes/src/x.cpp", "nanovdb/NanoVDB.h"), ("app/cli/main.cpp", "CLI/CLI.hpp"), ("app/cli/mpi/x.cpp", "mpi.h"),
            ("app/vtk/vtkX.cxx", "vtkImageData.h"), ("app/python/x.cpp", "pybind11/numpy.h"),
            ("app/desktop/x.cpp", "QWidget"),
            ("tests/core/a/x_test.cpp", "gtest/gtest.h"), ("tests/volumes/x_test.cpp", "openvdb/openvdb.h"),
        ]:
            self.assert_good("includes", path, f"#include <{name}>\n")
        self.assert_bad("includes", "core/src/scene/x.cpp", '#include "openvdb/openvdb.h"\n')

    def test_front_ends_know_only_what_is_shared(self):
        for path, text in [
            ("app/cli/table.h", "#pragma once\n"), ("app/cli/commands/list.h", "#pragma once\n"),
            ("app/shared/report.h", "#pragma once\n"),
        ]:
            file = self.root / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        for name in ("table.h", "commands/list.h"):
            self.assert_bad("includes", "app/vtk/module/x.cxx", f'#include "{name}"\n')
            self.assert_bad("includes", "app/desktop/model/x.cpp", f'#include "{name}"\n')
            self.assert_bad("includes", "app/shared/x.cpp", f'#include "{name}"\n')
            self.assert_good("includes", "app/cli/x.cpp", f'#include "{name}"\n')
        self.assert_good("includes", "app/desktop/model/x.cpp", '#include "report.h"\n')
        for line in ('target_sources(VTK PRIVATE "${PROJECT_SOURCE_DIR}/app/cli/table.cpp")',
                     "target_link_libraries(plenoflame_desktop_model PUBLIC plenoflame_cli)"):
            self.assert_bad("includes", "app/vtk/module/CMakeLists.txt", line + "\n")
            self.assert_good("includes", "app/cli/CMakeLists.txt", line + "\n")
        self.assert_good("includes", "app/desktop/CMakeLists.txt",
                         'file(CREATE_LINK "${PROJECT_BINARY_DIR}/app/cli/plugins" plugins SYMBOLIC)\n')

    def test_kernels_include_nothing_else(self):
        kernel = "core/src/media/layered_kernel.inl.h"
        self.assert_bad("includes", kernel, "#include <cmath>\n")
        self.assert_bad("includes", kernel, '#include "plenoflame/math/vector.h"\n')
        self.assert_bad("includes", "core/src/math/kernel_math.h", "#include <algorithm>\n")
        self.assert_good("includes", kernel, '#include "math/kernel_math.h"\n')
        self.assert_good("includes", kernel, "#include <cstdint>\n")

    def test_ascii(self):
        self.assert_bad("ascii", "core/src/math/x.cpp", "int a;\n// 5 \u00b5m\n", line=2)
        self.assert_bad("ascii", "tests/x.py", "if True:\n\tpass\n", line=2)
        self.assert_bad("ascii", "core/CMakeLists.txt", "a()\r\n")
        self.assert_good("ascii", "docs/theory.md", "5 \u00b5m\n")
        self.assert_good("ascii", "core/src/math/x.cpp", "// 5 um\n")

    def test_length(self):
        self.assert_bad("length", "core/src/math/x.cpp", "\n" * 600, line=600)
        self.assert_good("length", "core/src/math/x.cpp", "\n" * 599)

    def test_paths(self):
        for folder in ("home", "tmp", "root", "Users"):
            self.assert_bad("paths", "docs/x.md", f"see /{folder}/me/flame.vdb\n")
        self.assert_bad("paths", "CMakeLists.txt", 'set(A "/' + 'work/main")\n')
        for text in ("https://example.org/home/x", "a/tmp/b", "${root}/tmp/x", "/usr/share/x"):
            self.assert_good("paths", "docs/x.md", text + "\n")

    def test_headers(self):
        self.assert_bad("headers", HEADER.format("math/x"), "int f();\n")
        self.assert_bad("headers", HEADER.format("math/x"), "#pragma once\nusing namespace std;\n", line=2)
        self.assert_good("headers", HEADER.format("math/x"), "#pragma once\n")
        self.assert_good("headers", "core/src/math/x_kernel.inl.h", "int f();\n")

    def test_flags(self):
        self.assert_bad("flags", "core/CMakeLists.txt", "add_compile_options(-ffast-" + "math)\n")
        self.assert_bad("flags", "cmake/x.cmake", "set(a -march=" + "native)\n")
        self.assert_good("flags", "cmake/x.cmake", "set(a -O3) # never -ffast-" + "math\n")

    def test_shell(self):
        self.assert_bad("shell", "tools/x.sh", "#!/bin/bash\nlist='Debian's checks'\n", 2)
        self.assert_bad("shell", ".ci/run", "#!/bin/bash\nif true\n", 3)
        self.assert_good("shell", "tools/x.sh", "#!/bin/bash\nlist='checks of Debian'\n")

    def test_parameters(self):
        for text in ("int f(int a, int b, int c, int d, int e, int f, int g);",
                     "int f(A a, const A& b, A* c, A&& d, A e[3], const A (&f)[2], int (*g)(int));",
                     "A::A(A, const A&, A*, const A* const, A&, unsigned char, long double a) : a_(a) {}",
                     "auto f = [&](const auto& a, auto... b, auto&& c, bool d, bool e, bool f, bool g) {};",
                     "f([](A<B<C>> a, A<B, C> b, A<1> c, int d, int e, int f, int g) {});",
                     "void operator()(int a = 1, A b = {2, 3}, A c = d(e, f), int d, int e, int f, int g);",
                     "int f(int a,  // b\n      int b, int c, int d, int e, int f,\n      int g);"):
            self.assert_bad("parameters", "core/src/math/x.cpp", "\n" + text + "\n", line=2)
        for text in ("int f(int a, int b, int c, int d, int e, int f);",
                     "int f(A<B, C, D> a, std::function<A(int, int, int)> b, A c = {1, 2, 3, 4});",
                     "return f(a, b[0], c * d, e.f, -g, h<i>(j, k), {l, m}, n ? o : p);",
                     "f(a * b, c & d, e * f, g && h, i * j, k * l, m * n);",
                     "int A::*f(a, b, c, d, e, f, g);", "// f(int a, int b, int c, int d, int e, int f, int g)",
                     '"f(int a, int b, int c, int d, int e, int f, int g)";',
                     "#define F(int a, int b, \\\n int c, int d, int e, int f, int g)"):
            self.assert_good("parameters", "core/src/math/x.cpp", text + "\n")
        seven = "int f(int a, int b, int c, int d, int e, int f, int g);\n"
        for path in ("core/src/a/x_kernel.inl.h", "core/src/a/x_kernel.h", "core/src/a/kernel_x.h", "core/src/a/x.inl.h"):
            self.assert_good("parameters", path, seven)
        self.assert_bad("parameters", "core/src/a/kernels.cpp", seven)
        self.assert_bad("parameters", "tests/x.h", seven)

    def test_messages(self):
        self.assert_bad("messages", "core/src/render/x.cpp", 'throw InputError("give a region (--region)");\n')
        self.assert_bad("messages", "volumes/src/x.cpp", 'f("without --half",\n')
        for text in ("// --region\n", 'f("a -- b");\n', "--count;\n", "f(x--, y);\n"):
            self.assert_good("messages", "core/src/render/x.cpp", text)
        self.assert_good("messages", "app/cli/x.cpp", 'f("--region");\n')

    def test_tolerances(self):
        test = "tests/core/math/x_test.cpp"
        for text in ("EXPECT_" + "NEAR(a, b, 1e-6);", "ASSERT_" + "NEAR(a, b, 1e-6);",
                     "EXPECT_THAT(a, DoubleNear(b, 1e-6));",
                     "EXPECT_LT(std::abs(f(a, b) - g[1]), 1e-9);", "EXPECT_GE(1e-9, fabs(a - b));",
                     "EXPECT_LE(std::fabs(a -\n    b),\n    1e-9f);",
                     "EXPECT_TRUE(std::abs(a - b) < 1e-9);"):
            self.assert_bad("tolerances", test, text + "\n")
        for text in ("EXPECT_TRUE(relative(a, b, 1e-12));", "EXPECT_LT(std::abs(a - b), 1e-9 * b);",
                     "EXPECT_LT(std::abs(a - b), 4 * error);", "EXPECT_LT(error, 1e-9);",
                     "EXPECT_LT(std::abs(a - b) / b, 1e-9);", "EXPECT_LE(std::abs(row - 4), 1);"):
            self.assert_good("tolerances", test, text + "\n")
        self.assert_bad("tolerances", "tests/cli/x_test.py", "self.assert" + "AlmostEqual(a, b)\n")
        self.assert_good("tolerances", "tests/support/approx.h", "// EXPECT_" + "NEAR\n")


class ObjectRules(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def breaches(self, rule, text, name="x.cpp.o"):
        folder = pathlib.Path(self.folder.name)
        (folder / "x.cpp").write_text(text)
        subprocess.run([os.environ.get("CXX", "c++"), "-std=c++20", "-fPIC", "-O2", "-c",
                        folder / "x.cpp", "-o", folder / name], check=True)
        return list(check.OBJECT_RULES[rule]([folder / name]))

    def test_globals(self):
        for text, name in [
            ("namespace a { int counter = 3; }", "a::counter"),
            ("namespace a { double total; }", "a::total"),
            ("static int hidden; int next() { return ++hidden; }", "hidden"),
            ("int next() { static int calls = 7; return ++calls; }", "next()::calls"),
            ("int next() { thread_local int calls = 7; return ++calls; }", "next()::calls"),
            ("namespace a { inline int shared = 4; int* f() { return &shared; } }", "a::shared"),
            ("extern int x; int* pointer = &x;", "pointer"),
        ]:
            found = self.breaches("globals", text)
            self.assertEqual(len(found), 1, f"{text}: {found}")
            self.assertIn(f"mutable global: {name} in ", found[0])
        for text in ("extern const double kTable[3]; const double kTable[3] = {1, 2, 3};",
                     "extern const char* const kNames[2]; const char* const kNames[2] = {\"a\", \"b\"};",
                     "struct A { virtual ~A(); virtual void f(); }; A::~A() {} void A::f() {}",
                     "void g(); void f() { try { g(); } catch (int) {} }"):
            self.assertEqual(self.breaches("globals", text), [], text)

    def test_kernels(self):
        weak = ("inline __attribute__((noinline)) int twice(int x) { return 2 * x; }\n"
                "namespace plenoflame::avx2 { int f(int x) { return twice(x); } }")
        found = self.breaches("kernels", weak, "trace_avx2.cpp.o")
        self.assertEqual(len(found), 1, found)
        self.assertIn("twice(int)", found[0])
        self.assertEqual(self.breaches("kernels", weak, "trace_baseline.cpp.o"), [])
        strong = "namespace plenoflame::avx512 { int f(int x) { return 2 * x; } }"
        self.assertEqual(self.breaches("kernels", strong, "trace_avx512.cpp.o"), [])
        self.assertEqual(len(self.breaches("kernels", strong, "trace_avx2.cpp.o")), 1)


if __name__ == "__main__":
    unittest.main()
