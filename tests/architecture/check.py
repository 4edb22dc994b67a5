#!/usr/bin/env python3
"""Checks the rules of docs/developer/architecture.md on the source tree and on built objects.

    check.py ROOT RULE                 a rule on the sources (see SOURCE_RULES)
    check.py --objects LIST RULE       a rule on object files, named in LIST line by line

Prints each breach as FILE:LINE: MESSAGE and ends with status 1 if there is one. Standard library only.
"""

import argparse
import graphlib
import pathlib
import re
import subprocess
import sys

import includes

SOURCE_FOLDERS = ("core", "volumes", "app", "tests", "examples", "benchmarks", "cmake", "tools", ".ci")
CODE_SUFFIXES = {".h", ".cpp", ".cxx", ".py", ".sh", ".cmake"}
TEXT_SUFFIXES = CODE_SUFFIXES | {".toml", ".in", ".json", ".module", ".md", ".txt"}
MAX_LINES = 600


def files(root, suffixes, with_docs=False):
    """Source files below the project's folders and at the top, as paths relative to root."""
    found = [p for p in root.iterdir() if p.is_file()]
    for folder in SOURCE_FOLDERS + (("docs",) if with_docs else ()):
        found += [p for p in (root / folder).rglob("*") if p.is_file()]
    for path in sorted(found):
        relative = path.relative_to(root)
        if "__pycache__" in relative.parts:
            continue
        suffix = {"CMakeLists.txt": ".cmake", "run": ".sh"}.get(path.name, path.suffix)
        if suffix in suffixes:
            yield relative


def lines(root, path):
    return (root / path).read_text(encoding="utf-8", errors="surrogateescape").splitlines()


def check_includes(root):
    """Who may include whom: areas, layers, libraries, kernels."""
    for path in files(root, {".h", ".cpp", ".cxx"}):
        for number, line in enumerate(lines(root, path), 1):
            match = includes.INCLUDE.match(line)
            if match:
                message = (includes.judge(path, match["name"], match["quote"] == "<") or
                           includes.judge_front_end(root, path, match["name"]))
                if message:
                    yield f"{path}:{number}: {message}"
    for path in files(root, {".cmake"}):
        for number, line in enumerate(lines(root, path), 1):
            message = includes.judge_build(path, line)
            if message:
                yield f"{path}:{number}: {message}"


def check_circles(root):
    """Folders of core/src include each other in one direction."""
    source = root / "core" / "src"
    included, first = {}, {}
    for path in files(root, {".h", ".cpp"}):
        if not path.is_relative_to("core/src"):
            continue
        folder = path.parent.relative_to("core/src")
        for number, line in enumerate(lines(root, path), 1):
            match = includes.INCLUDE.match(line)
            if match and match["quote"] == '"' and (source / match["name"]).is_file():
                other = pathlib.PurePath(match["name"]).parent
                if other != folder:
                    included.setdefault(folder, set()).add(other)
                    first.setdefault((folder, other), f"{path}:{number}")
    try:
        graphlib.TopologicalSorter(included).prepare()
    except graphlib.CycleError as error:
        circle = error.args[1]
        yield f"{first[circle[1], circle[0]]}: folders include each other: {' < '.join(map(str, circle))}"


def check_ascii(root):
    """Sources are ASCII, without tabs or carriage returns."""
    for path in files(root, CODE_SUFFIXES | {".toml", ".in"}):
        for number, line in enumerate((root / path).read_bytes().split(b"\n"), 1):
            bad = sorted({c for c in line if c > 126 or c < 32})
            if bad:
                yield f"{path}:{number}: characters that are not printable ASCII: {bytes(bad)!r}"


def check_length(root):
    """A file that grows beyond a limit holds more than one thing."""
    for path in files(root, CODE_SUFFIXES):
        count = len(lines(root, path))
        if count >= MAX_LINES:
            yield f"{path}:{count}: {count} lines; split it (limit {MAX_LINES})"


# A path that exists on one person's machine only. Written so that it does not find itself.
MACHINE_PATH = re.compile(r"(?<![\w.}])/(?:home|root|Users|mnt|work|scratch|tmp)/[\w.]")


def check_paths(root):
    """Nothing names a folder of somebody's machine."""
    for path in files(root, TEXT_SUFFIXES, with_docs=True):
        for number, line in enumerate(lines(root, path), 1):
            match = MACHINE_PATH.search(line)
            if match:
                yield f"{path}:{number}: names a folder of one machine: {line.strip()[:80]}"


def check_headers(root):
    """Headers have #pragma once and leave their users' namespaces alone."""
    for path in files(root, {".h"}):
        text = lines(root, path)
        guarded = "#pragma once" in text or f"#ifndef {path.stem}_h" in text  # VTK's own way
        if not path.name.endswith(".inl.h") and not guarded:
            yield f"{path}:1: no #pragma once"
        for number, line in enumerate(text, 1):
            if re.match(r"\s*using\s+namespace\b", line):
                yield f"{path}:{number}: using namespace in a header"


OPTION = re.compile(r'"(?:[^"\\]|\\.)*(?<![\w-])--[a-z]')


def check_messages(root):
    """Core and volumes speak of values; options belong to the command."""
    for path in files(root, {".h", ".cpp"}):
        if path.parts[0] in ("core", "volumes"):
            for number, line in enumerate(lines(root, path), 1):
                if not line.lstrip().startswith("//") and OPTION.search(line):
                    yield f"{path}:{number}: names an option of the command: {line.strip()[:80]}"


UNSAFE_FLAGS = re.compile(r"-ffast-math|-Ofast|-ffinite-math-only|-funsafe-math-optimizations|"
                          r"-march=native")


def check_flags(root):
    """No flag that gives up NaN, infinity or reproducibility, or that builds for one machine."""
    for path in files(root, {".cmake", ".json", ".sh", ".in"}):
        for number, line in enumerate(lines(root, path), 1):
            match = UNSAFE_FLAGS.search(line.split("#")[0])
            if match:
                yield f"{path}:{number}: {match[0]}"


NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?[fFlL]?$", re.I)
DIFFERENCE = re.compile(r"(?:std::)?f?abs\s*\(", re.I)
COMPARISON = re.compile(r"\b(?:EXPECT|ASSERT)_(LT|LE|GT|GE|TRUE)\s*\(")


def arguments(text, start):
    """The arguments of the call whose opening bracket precedes start, split at its commas."""
    depth, begin, found = 0, start, []
    for i in range(start, len(text)):
        c = text[i]
        if c in "([{":
            depth += 1
        elif c in ")]}":
            if depth == 0:
                return found + [text[begin:i].strip()]
            depth -= 1
        elif c == "," and depth == 0:
            found.append(text[begin:i].strip())
            begin = i + 1
    return []


def is_difference(expression):
    """abs(a - b): the whole expression is a magnitude, and a difference or sum is inside."""
    match = DIFFERENCE.match(expression)
    return bool(match) and expression.endswith(")") and re.search(r"\s-\s", expression) is not None


def check_tolerances(root):
    """Tests compare by relative, ULP or k-standard-error tolerances (tests/support/approx.h)."""
    for path in files(root, {".h", ".cpp", ".cxx", ".py"}):
        if path.parts[0] != "tests" or path.parts[1] in ("support", "architecture"):
            continue
        text = "\n".join(lines(root, path))
        for match in re.finditer(r"\b(?:EXPECT|ASSERT)_NEAR\b|\b(?:Double|Float)Near\b|"
                                 r"\bassertAlmostEqual\b|\babs_tol\b", text):
            number = text.count("\n", 0, match.start()) + 1
            yield f"{path}:{number}: {match[0]} has an absolute tolerance"
        for match in COMPARISON.finditer(text):
            number = text.count("\n", 0, match.start()) + 1
            values = arguments(text, match.end())
            if match[1] == "TRUE" and len(values) == 1:
                values = re.split(r"<=?|>=?", values[0])
            values = [value.strip() for value in values]
            if match[1] in ("GT", "GE"):
                values.reverse()
            # Zero is not a tolerance; 1 and above are counts and positions.
            if (len(values) == 2 and is_difference(values[0]) and NUMBER.match(values[1])
                    and 0 < abs(float(values[1].rstrip("fFlL"))) < 1):
                yield f"{path}:{number}: a difference against the bare number {values[1]}"


MAX_PARAMETERS = 6
KERNEL_FILE = re.compile(r"kernel\w*\.h$|\.inl\.h$")  # their arguments are registers
# Comments, literals and directives hold no functions.
NO_CODE = re.compile(r"//[^\n]*|/\*.*?\*/|\bR\"(\w*)\(.*?\)\1\"|\"(?:\\.|[^\"\\\n])*\"|(?<!\w)'(?:\\.|[^'\\\n])+'|"
                     r"^[ \t]*#(?:\\\n|[^\n])*", re.S | re.M)
TEMPLATE_ARGUMENTS = re.compile(r"(?<=\w)(?<!operator)<[^<>;{}]*>")
# A type and a name, or a type that only a parameter can have. In the project's format T* is a pointer, a * b a product.
PARAMETER = re.compile(r"(?:(?:const|unsigned|long|struct|typename) )*[A-Za-z_][\w:]*(?: const)?"
                       r"(?:[&*]+(?: const)?(?:\.{3})? ?\w*|(?:\.{3})? \w+| \([&*]\w*\).*)(?:\[\w*\])*$")


def functions(text):
    """(line, count of parameters) of declarations, definitions and lambdas; the arguments of a call have no types."""
    def only_lines(match):
        return "\n" * match[0].count("\n")

    text = NO_CODE.sub(only_lines, text)
    while (shorter := TEMPLATE_ARGUMENTS.sub(only_lines, text)) != text:
        text = shorter
    for match in re.finditer(r"[\w\]>)]\(", text):
        parameters = [" ".join(p.split(" = ")[0].split()) for p in arguments(text, match.end())]
        if 2 * sum(PARAMETER.match(p) is not None for p in parameters) > len(parameters):
            yield text.count("\n", 0, match.start()) + 1, len(parameters)


def check_parameters(root):
    """Beyond a number, parameters are mistaken for each other: some of them are one value that has a name."""
    for path in files(root, {".h", ".cpp", ".cxx"}):
        if KERNEL_FILE.search(path.name):
            continue
        for number, count in functions("\n".join(lines(root, path))):
            if count > MAX_PARAMETERS:
                yield f"{path}:{number}: {count} parameters (limit {MAX_PARAMETERS})"


def check_shell(root):
    """Every shell script parses: one that does not ends the whole of test.sh before any test."""
    for path in files(root, {".sh"}):
        if not (root / path).read_bytes().startswith(b"#!"):
            continue
        shell = "bash" if b"bash" in (root / path).read_bytes().split(b"\n")[0] else "sh"
        result = subprocess.run([shell, "-n", str(root / path)], text=True, stderr=subprocess.PIPE)
        if result.returncode:
            match = re.search(r"line (\d+): (.*)", result.stderr)
            number, message = match.groups() if match else (1, result.stderr.strip())
            yield f"{path}:{number}: {message}"


SOURCE_RULES = {
    "includes": check_includes,
    "circles": check_circles,
    "ascii": check_ascii,
    "length": check_length,
    "paths": check_paths,
    "headers": check_headers,
    "messages": check_messages,
    "flags": check_flags,
    "tolerances": check_tolerances,
    "parameters": check_parameters,
    "shell": check_shell,
}

# Sections that a program can write to after it has been loaded. (.data.rel.ro becomes read-only.)
MUTABLE = re.compile(r"^(?:\.data|\.bss|\.tdata|\.tbss|\*COM\*)(?!\.rel\.ro)(?!\.rel\.local\.DW\.ref)")
SYMBOL = re.compile(r"^[0-9a-f]+ (?P<flags>.{7}) (?P<section>\S+)\t[0-9a-f]+\s+(?P<name>.+)$")


def symbols(path):
    """(flags, section, demangled name) of every symbol of an object file."""
    listing = subprocess.run(["objdump", "-t", "-C", str(path)], check=True, text=True,
                             stdout=subprocess.PIPE).stdout
    for line in listing.splitlines():
        match = SYMBOL.match(line)
        if match:
            name = re.sub(r"^(?:0x[0-9a-f]+|\.hidden|\.protected|\.internal) ", "", match["name"])
            yield match["flags"], match["section"], name.strip()


def allowed_globals():
    """Pattern and reason per line of allowed_globals.txt."""
    text = (pathlib.Path(__file__).parent / "allowed_globals.txt").read_text().splitlines()
    for line in text:
        if line.strip() and not line.startswith("#"):
            yield re.compile(line.split(" # ")[0].strip())


def check_globals(objects):
    """No variable outlives a call: what a function needs is passed in."""
    allowed = list(allowed_globals())
    for path in objects:
        for flags, section, name in symbols(path):
            if not MUTABLE.match(section) or "d" in flags:  # d: debugging and section symbols
                continue
            if not any(pattern.fullmatch(name) for pattern in allowed):
                yield f"{path.name}:1: mutable global: {name} in {section}"


def check_kernels(objects):
    """What is compiled for one instruction set lives in that namespace, so nothing else links it."""
    count = 0
    for path in objects:
        match = re.search(r"_(avx2|avx512)\.cpp\.o$", path.name)
        if not match:
            continue
        count += 1
        for flags, section, name in symbols(path):
            is_global = flags[0] in "gu!" or flags[1] == "w"
            if (is_global and section != "*UND*" and f"plenoflame::{match[1]}::" not in name
                    and not name.startswith("DW.ref.")):
                yield f"{path.name}:1: {name} could be linked into code for another processor"
    print(f"{count} kernel objects for extended instruction sets")


OBJECT_RULES = {"globals": check_globals, "kernels": check_kernels}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", nargs="?", type=pathlib.Path)
    parser.add_argument("rule", choices=[*SOURCE_RULES, *OBJECT_RULES])
    parser.add_argument("--objects", type=pathlib.Path)
    options = parser.parse_args()
    if options.rule in OBJECT_RULES:
        names = options.objects.read_text().split("\n")
        rule, subject = OBJECT_RULES[options.rule], [pathlib.Path(n) for n in names if n and not n.endswith(".gch")]
        if not subject:
            sys.exit(f"{options.objects} names no object files")
    else:
        rule, subject = SOURCE_RULES[options.rule], options.root
        if not (subject / "core").is_dir():
            sys.exit(f"{subject} is not the root of the sources")
    breaches = list(rule(subject))
    print("\n".join(breaches))
    print(f"{options.rule}: {len(breaches)} breaches")
    sys.exit(1 if breaches else 0)


if __name__ == "__main__":
    main()
