#!/usr/bin/env python3
"""Runs the commands that the documentation shows.

    run_blocks.py --command PLENOFLAME --root ROOT [FILE.md ...]   without files: README.md and docs/

A fenced block of language sh is run when the line before it is a comment of the form

    <!-- run -->
    <!-- run: render --window 1400,1400,64,64 --samples 2; flame --voxel-size 2mm -->

The second form makes it small enough for a test: the options are given to every `plenoflame render`
(or `plenoflame flame`) of the block, in place of those that it has of the same name. The blocks of
one file share a folder, with a copy of examples/, and run in order; `plenoflame` is the command just
built. A line `$ command` runs the command; other lines of such a block are its output
and are not run. Standard library only.
"""

import argparse
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

MARK = re.compile(r"^<!--\s*run\s*(?::(?P<options>.*))?-->$")
TIME_LIMIT = 400  # seconds for one block: the machine may be busy


class Block:
    def __init__(self, path, line, options, text):
        self.path, self.line, self.options, self.text = path, line, options, text


def parse_options(text):
    """'render --samples 2; flame --half' -> {'render': [['--samples', '2']], 'flame': [['--half']]}."""
    options = {}
    for part in (text or "").split(";"):
        words = shlex.split(part)
        if not words:
            continue
        groups = options.setdefault(words[0], [])
        for word in words[1:]:
            if word.startswith("-") and not re.match(r"-[\d.]", word):
                groups.append([word])
            elif groups:
                groups[-1].append(word)
            else:
                raise ValueError(f"{word!r} is not an option of {words[0]}")
    return options


def blocks(path, text):
    """The marked blocks of a page, in order; a mark that no sh block follows is an error."""
    lines = text.splitlines()
    found, i = [], 0
    while i < len(lines):
        match = MARK.match(lines[i].strip())
        i += 1
        if not match:
            continue
        if i == len(lines) or lines[i].strip() != "```sh":
            raise ValueError(f"{path}:{i}: no ```sh block follows the mark")
        begin = i + 1
        end = next((k for k in range(begin, len(lines)) if lines[k].strip() == "```"), None)
        if end is None:
            raise ValueError(f"{path}:{begin}: the block does not end")
        body = lines[begin:end]
        if any(line.startswith("$ ") for line in body):
            body = [line[2:] for line in body if line.startswith("$ ")]
        found.append(Block(path, begin + 1, parse_options(match["options"]), "\n".join(body)))
        i = end
    return found


def with_options(arguments, options):
    """The arguments of a call of plenoflame with the options of its subcommand set."""
    groups = options.get(arguments[0], []) if arguments else []
    kept, i = [], 0
    while i < len(arguments):
        name = arguments[i].split("=")[0]
        group = next((group for group in groups if group[0] == name), None)
        if group is None:
            kept.append(arguments[i])
            i += 1
        else:
            i += 1 if "=" in arguments[i] else len(group)
    return kept + [word for group in groups for word in group]


def write_command(folder, command, options):
    """A program named plenoflame that calls the real one with the block's options."""
    path = folder / "plenoflame"
    path.write_text(f"#!{sys.executable}\n"
                    f"import os, sys\nsys.path.insert(0, {str(pathlib.Path(__file__).parent)!r})\n"
                    f"sys.dont_write_bytecode = True\n"
                    f"from run_blocks import with_options\n"
                    f"arguments = with_options(sys.argv[1:], {options!r})\n"
                    f"os.execv({str(command)!r}, ['plenoflame'] + arguments)\n")
    path.chmod(0o755)


def run(page_blocks, command, root):
    """Runs the blocks of one page; returns the failures as text."""
    failures = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        tools, work = folder / "bin", folder / "work"
        tools.mkdir()
        work.mkdir()
        if (root / "examples").is_dir():
            shutil.copytree(root / "examples", work / "examples")
        environment = dict(os.environ, PATH=f"{tools}{os.pathsep}{os.environ['PATH']}")
        for block in page_blocks:
            write_command(tools, command, block.options)
            try:
                result = subprocess.run(["bash", "-euo", "pipefail", "-c", block.text], cwd=work,
                                        env=environment, stdin=subprocess.DEVNULL, text=True,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        timeout=TIME_LIMIT)
            except subprocess.TimeoutExpired:
                failures.append(f"{block.path}:{block.line}: longer than {TIME_LIMIT} s\n{block.text}")
                break
            if result.returncode != 0:
                failures.append(f"{block.path}:{block.line}: status {result.returncode}\n"
                                f"{block.text}\n{result.stdout}")
                break  # what follows may need what this block should have made
    return failures


LINK = re.compile(r"\[[^\]]*\]\((?P<target>[^)\s]+)(?:\s+\"[^\"]*\")?\)")


def broken_links(path, text, root):
    """Links to files of the project that do not exist."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip().startswith("```"):
            fenced = not fenced
        if fenced:
            continue
        for match in LINK.finditer(re.sub(r"`[^`]*`", "", line)):
            target = match["target"].split("#")[0]
            if target and not re.match(r"[a-z]+:", target) and not (root / path.parent / target).exists():
                yield f"{path}:{number}: no such file: {target}"


def pages(root):
    found = sorted(root.glob("*.md")) + sorted((root / "docs").rglob("*.md"))
    return [page.relative_to(root) for page in found]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=pathlib.Path, required=True)
    parser.add_argument("--command", type=pathlib.Path)
    parser.add_argument("--links", action="store_true", help="check links, run nothing")
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    root = options.root.resolve()
    failures, count = [], 0
    for page in options.files or pages(root):
        text = (root / page).read_text(encoding="utf-8")
        if options.links:
            failures += broken_links(page, text, root)
            continue
        try:
            page_blocks = blocks(page, text)
        except ValueError as error:
            failures.append(str(error))
            continue
        count += len(page_blocks)
        failures += run(page_blocks, options.command.resolve(), root)
    print("\n".join(failures))
    print(f"{len(failures)} failures" + ("" if options.links else f", {count} blocks"))
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
