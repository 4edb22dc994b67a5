#!/usr/bin/env python3
"""Makes docs/reference/commands.md from the help texts of the command, or checks that it is up to date.

    tools/command_reference.py COMMAND [--check]      COMMAND: the built plenoflame, with all its parts
"""

import pathlib
import sys

import command_help

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "reference" / "commands.md"

INTRODUCTION = """# Commands

<!-- Generated from the help texts by tools/command_reference.py; edit those. -->

Exit status: 0 on success, 1 when the input or the machine is at fault, 2 when the command line is. An error is
one line on standard error that begins with `plenoflame: error:`; figures go to standard output, as JSON in SI units
with `--json`. Files are written under a temporary name and renamed: an existing file is never left half-written.
Progress is drawn on standard error if that is a terminal.
"""


def page_of(command):
    """One section per command, and one per command within it."""
    page = INTRODUCTION
    for each in command_help.walk(command_help.read(command)):
        level = "##" if len(each.names) < 2 else "###"
        page += f"\n{level} {' '.join(['plenoflame', *each.names])}\n\n```text\n{each.text}\n```\n"
    return page


def main():
    arguments = [a for a in sys.argv[1:] if a != "--check"]
    if len(arguments) != 1:
        sys.exit(__doc__.strip())
    page = page_of(arguments[0])
    if "--check" not in sys.argv:
        PAGE.write_text(page)
        return
    if not PAGE.exists() or PAGE.read_text() != page:
        sys.exit(f"docs/reference/commands.md is not up to date: run tools/command_reference.py {arguments[0]}"
                 " and commit the page")


main()
