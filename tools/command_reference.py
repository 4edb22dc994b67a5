#!/usr/bin/env python3
"""Makes docs/reference/commands.md from the help texts of the command, or checks that it is up to date.

    tools/command_reference.py COMMAND [--check]      COMMAND: the built plenoflame, with all its parts
"""

import pathlib
import re
import subprocess
import sys

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "reference" / "commands.md"

INTRODUCTION = """# Commands

<!-- Generated from the help texts by tools/command_reference.py; edit those. -->

Exit status: 0 on success, 1 when the input or the machine is at fault, 2 when the command line is. An error is
one line on standard error that begins with `plenoflame: error:`; figures go to standard output, as JSON in SI units
with `--json`. Files are written under a temporary name and renamed: an existing file is never left half-written.
Progress is drawn on standard error if that is a terminal.
"""


def help_of(*arguments):
    return subprocess.run([*arguments, "--help"], capture_output=True, text=True, check=True,
                          timeout=60).stdout.rstrip("\n")


def commands(text):
    """Names below 'Subcommands:' of a help text."""
    return re.findall(r"^  (\w[\w-]*)", text.partition("Subcommands:\n")[2].partition("\n\n")[0], re.MULTILINE)


def sections(command, names):
    """One section per command, and one per command within it."""
    text = help_of(command, *names)
    below = commands(text)
    page = [f"\n{'##' if len(names) < 2 else '###'} {' '.join(['plenoflame', *names])}\n\n```text\n{text}\n```\n"]
    for name in below:
        page += sections(command, [*names, name])
    return page


def main():
    arguments = [a for a in sys.argv[1:] if a != "--check"]
    if len(arguments) != 1:
        sys.exit(__doc__.strip())
    page = INTRODUCTION + "".join(sections(arguments[0], []))
    if "--check" not in sys.argv:
        PAGE.write_text(page)
        return
    if not PAGE.exists() or PAGE.read_text() != page:
        sys.exit(f"docs/reference/commands.md is not up to date: run tools/command_reference.py {arguments[0]}"
                 " and commit the page")


main()
