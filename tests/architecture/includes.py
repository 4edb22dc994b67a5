"""Who may include whom (docs/developer/architecture.md): judge() decides one #include line."""

import re

INCLUDE = re.compile(r'\s*#\s*include\s*(?P<quote>[<"])(?P<name>[^>"]+)[>"]')

# An area of core may include areas with a lower number, and itself.
LEVELS = {"base": 0, "math": 1, "image": 1, "sampling": 2, "radiometry": 2, "film": 2, "media": 3,
          "optics": 3, "solids": 3, "camera": 4, "scene": 5, "lightfield": 5, "render": 6, "measure": 6, "calibration": 6, "inverse": 7}
# Plain values of a scene, visible below their level to these areas.
PLAIN_VALUES = re.compile(r"scene/(scene|\w+_spec)\.h$")
SEE_PLAIN_VALUES = {"optics", "camera", "solids", "lightfield"}

POSIX = re.compile(r"(unistd|fcntl|errno|signal|poll|termios|dlfcn|spawn|malloc|sys/\w+)\.h$")
LIBRARIES = {
    "OpenEXR": re.compile(r"(OpenEXR/|Imath/|Imf|Iex|IlmThread|Imath|half\.h)"),
    "libpng": re.compile(r"png\.h$"),
    "libtiff": re.compile(r"tiffio\.h$"),
    "libjpeg": re.compile(r"jpeglib\.h$"),
    "zlib": re.compile(r"zlib\.h$"),
    "pugixml": re.compile(r"pugixml\.hpp$"),
    "HDF5": re.compile(r"hdf5\.h$"),
    "toml++": re.compile(r"toml\+\+/|toml\.hpp$"),
    "nlohmann-json": re.compile(r"nlohmann/"),
    "fmt": re.compile(r"fmt/"),
    "Eigen": re.compile(r"(unsupported/)?Eigen/"),
    "Embree": re.compile(r"embree3/"),
    "OpenVDB": re.compile(r"openvdb/|nanovdb/"),
    "TBB": re.compile(r"tbb/|oneapi/"),
    "CLI11": re.compile(r"CLI/"),
    "Cairo": re.compile(r"cairo"),
    "NLopt": re.compile(r"nlopt"),
    "VTK": re.compile(r"vtk(?!Plenoflame|_)|QVTK"),
    "Qt": re.compile(r"Q[A-Z]|Qt[A-Z]"),
    "GoogleTest": re.compile(r"g(test|mock)/"),
    "Google Benchmark": re.compile(r"benchmark/"),
    "pybind11": re.compile(r"pybind11/"),
    "MPI": re.compile(r"mpi\.h$"),
    "X11": re.compile(r"X11/"),
    "POSIX": POSIX,
}
STANDARD = re.compile(r"[a-z_0-9]+$")

CORE_SRC = {"OpenEXR", "libpng", "libtiff", "libjpeg", "zlib", "pugixml", "HDF5", "toml++", "nlohmann-json", "fmt", "Eigen", "Embree", "POSIX"}
VOLUMES_SRC = {"OpenVDB", "TBB", "fmt", "toml++", "nlohmann-json", "POSIX"}
CLI = {"Cairo", "CLI11", "nlohmann-json", "fmt", "POSIX"}
SHARED = {"Cairo", "NLopt", "nlohmann-json", "fmt", "POSIX"}
VTK_MODULE = {"VTK", "nlohmann-json", "X11"}
PYTHON = {"pybind11", "nlohmann-json"}
ANY = set(LIBRARIES)


def library_of(name):
    """The library that a system include belongs to; None for the standard library."""
    if STANDARD.match(name):
        return None
    for library, pattern in LIBRARIES.items():
        if library != "Qt" and library != "VTK" and pattern.match(name):
            return library
    for library in ("VTK", "Qt"):
        if LIBRARIES[library].match(name):
            return library
    return f"<{name}>"


def place_of(path):
    """The first two folders of a path."""
    return "/".join(path.parts[:2])


def allowed_libraries(path):
    """The libraries that a source file may include, from its place in the tree."""
    parts = path.parts
    place = place_of(path)
    if place == "core/include" or parts[0] == "examples":
        return set()
    if place == "core/src":
        return CORE_SRC
    if place == "volumes/include":
        return {"OpenVDB"} if path.name == "interop.h" else set()
    if place == "volumes/src":
        return VOLUMES_SRC
    if place == "app/cli":
        # Linked to the command, MPI would be loaded at every start.
        return {"MPI"} if parts[:3] == ("app", "cli", "mpi") else CLI
    if place == "app/shared":
        return SHARED
    if place == "app/vtk":
        return VTK_MODULE
    if place == "app/python":
        return PYTHON
    if place == "tests/core":
        return CORE_SRC | {"GoogleTest"}
    return ANY


def area_of(path):
    """The area of a file of core, or None."""
    parts = path.parts
    if parts[:3] == ("core", "include", "plenoflame") and len(parts) > 4:
        return parts[3]
    if parts[:2] == ("core", "src") and len(parts) > 3:
        return parts[2]
    return None


def judge_area(area, header):
    """header is AREA/FILE, relative to core/include/plenoflame or core/src."""
    target = header.split("/")[0]
    for name in (area, target):
        if name not in LEVELS:
            return f"unknown area {name} of core"
    if target == area or LEVELS[target] < LEVELS[area] or (area in SEE_PLAIN_VALUES and PLAIN_VALUES.match(header)):
        return None
    return f"area {area} (layer {LEVELS[area]}) may not see {header} (layer {LEVELS[target]})"


def judge_kernel(path, name, system):
    """A vector kernel sees nothing that could emit a weak symbol."""
    if system and name in ("cstddef", "cstdint"):
        return None  # types only
    if system or not re.search(r"(^|/)\w*kernel\w*(\.inl)?\.h$", name):
        return f"a kernel may not include {name}: only headers written for kernels"
    return None


def judge_front_end(root, path, name):
    """None, or what is wrong when a file outside of app/cli includes a header of the command's: front ends share
    app/shared, and nothing else of each other's."""
    if path.parts[0] != "app" or path.parts[1] == "cli":
        return None
    if "app/cli" in name or ((root / "app/cli" / name).is_file() and not (root / path.parent / name).is_file()):
        return f"{name} is the command's: what front ends share belongs in core, volumes or app/shared"
    return None


COMMAND_TARGET = re.compile(r"\bplenoflame_cli\b|SOURCE_DIR\}?/(app/)?cli\b|\.\./cli\b")


def judge_build(path, line):
    """None, or what is wrong when a CMake file of another front end builds parts of the command, or links them."""
    if path.parts[0] != "app" or path.parts[1] == "cli" or not COMMAND_TARGET.search(line):
        return None
    return "this builds or links the command's sources: what front ends share belongs in app/shared"


def judge(path, name, system):
    """None when the file at path may include name, otherwise what is wrong."""
    if re.search(r"kernel(_\w+)?(\.inl)?\.h$|\.inl\.h$", path.name) and path.parts[:2] == ("core", "src"):
        return judge_kernel(path, name, system)
    area = area_of(path)
    if name.startswith("plenoflame/"):
        if system:
            return f"project header {name} in angle brackets"
        header = name[len("plenoflame/"):]
        if header.startswith("volumes/"):
            if path.parts[0] == "core" or path.parts[:2] == ("tests", "core"):
                return f"core may not see {name}"
            return None
        return judge_area(area, header) if area else None
    if system:
        library = library_of(name)
        if library is None or library in allowed_libraries(path):
            return None
        return f"{library} may not be included here"
    if place_of(path) == "app/vtk" and library_of(name) == "VTK" and path.suffix == ".h":
        return None  # as VTK's own headers include their superclasses
    if library_of(name) in LIBRARIES:
        return f"{name} belongs to a library: use angle brackets"
    if path.parts[:2] == ("core", "include") or path.parts[:2] == ("volumes", "include"):
        return f"a public header may not see {name}: only plenoflame/..."
    if area and "/" in name:
        return judge_area(area, name)
    if name.startswith("../"):
        return f"{name} leaves its folder"
    return None
