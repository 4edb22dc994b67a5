#!/usr/bin/env python3
"""Makes docs/reference/commands.md from the help texts of the command, or checks that it is up to date.

    tools/command_reference.py COMMAND [--check]      COMMAND: the built plenoflame, with all its parts

An option with the same text in several commands is explained once, at the top of the page; the commands name it.
"""

import collections
import pathlib
import re
import sys
import textwrap

import command_help

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "reference" / "commands.md"
WIDTH = 96
COLUMN = 26  # where meanings begin

INTRODUCTION = """# Commands

<!-- Generated from the help texts by tools/command_reference.py; edit those. -->

This page has all commands and options. `--help` prints those of one command, `plenoflame --version` the version. A default
stands in parentheses. `SCENE` is a scene file (.toml), `RAW` a light field (.exr) written by `render`.

- Exit status: 0 on success, 1 for an error in a file or of the machine, 2 for an error in the command line.
- An error is one line on standard error: `plenoflame: error: ...`.
- Results go to standard output, as JSON in SI units with `--json`. Progress goes to standard error if that is a terminal.
- A file is written under a temporary name and renamed, so an existing file is never left half-written.
"""

# One text for options that commands explain in different words: (text here, the texts of the help). The text of the help stands
# in full, so that a changed one appears on the page again.
ALIKE = (
    ("Print the results as JSON",
     ("Print the figures as JSON", "Print what was written as JSON", "Print the report as JSON")),
    ("Camera of the scene ([[cameras]]); may be repeated for render, sweep, operator and reconstruct; the other commands need it "
     "if the scene has several",
     ("Use only this camera of the scene ([[cameras]]); may be repeated",
      "Name of the scene's camera ([[cameras]]); needed if the scene has several",
      "With --scene: name of the camera, if the scene has several")),
    ("Make only part K of N, in OUT-part-K-of-N.exr (sweep: DIR-part-K-of-N; operator: rows, .npz or .h5); 'plenoflame merge' "
     "joins them to exactly the whole; 'auto/N' takes K from SLURM_ARRAY_TASK_ID, 'auto' also takes N from the job array",
     ("Render only part K of N, into OUT-part-K-of-N.exr; 'plenoflame merge' joins them to exactly the whole picture; 'auto/N' "
      "takes K from SLURM_ARRAY_TASK_ID, 'auto' also takes N from the job array",
      "Make only part K of N, in DIR-part-K-of-N; 'plenoflame merge' joins them to exactly the whole set; 'auto/N' takes K from "
      "SLURM_ARRAY_TASK_ID, 'auto' also takes N from the job array",
      "Make only the rows of the Kth of N parts, which merge puts together (.npz, .h5); 'auto/N' takes K from "
      "SLURM_ARRAY_TASK_ID, 'auto' also takes N from the job array")),
    ("Only W x H pixels of the sensor from column X, row Y",
     ("Render only W x H pixels of the sensor from column X, row Y: X,Y,W,H", "Only W x H pixels from column X, row Y",
      "Only W x H pixels of the sensor from column X, row Y: X,Y,W,H", "Measure only W x H pixels from column X, row Y: X,Y,W,H")),
    ("Channel; without it, the first",
     ("Channel to develop; without it, the first", "Channel; without it, the first")),
    ("All rays of this pixel: column and row, from the top left; repeatable",
     ("All rays of this pixel: column and row, from the top left; repeatable", "Draw this pixel's rays; may be repeated")),
    ("All rays through this microlens; repeatable",
     ("All rays through this microlens; repeatable",
      "Draw this microlens' rays; may be repeated")),
    ('Rays from this point of the world, e.g. "1 m, 0 m, 5 mm"; repeatable',
     ('Rays from this point of the world, e.g. "1 m, 0 m, 5 mm"; repeatable',
      "Draw rays from this point of the world towards the camera; may be repeated")),
    ("All rays of N different pixels drawn at random",
     ("All rays of N different pixels drawn at random", "Draw the rays of N pixels drawn at random")),
    ("The chief ray of every microlens", ("The chief ray of every microlens", "Draw the chief ray of every microlens")),
    ("No progress and no notes; warnings remain", ("No progress on the terminal",)),
    ("Write the pictures as EXR as well", ("Write the views as EXR as well", "Write radiances as EXR as well")),
    ("Dark frames of the same exposure; calibrate radiometry: TIME=FILE, those of this exposure; import: NAME=FILE, here and in the "
     "options below, of this channel alone",
     ("Dark frames of the same exposure; NAME=FILE: of that channel alone, as in the options below",
      "Dark frames of the same exposure", "Dark frames; TIME=FILE: of that exposure")),
    ("Flat field: the bare sensor, evenly lit", ("Flat field: the bare sensor, evenly lit, as in import",)),
    ("Dark frames of this picture (those of --dark)",
     ("Its dark frames (those of --dark)", "Dark frames of the white picture (those of --dark)")),
    ("Seed of the rays (default: the scene's)", ("Seed (default: the scene's)",)),
    ("Length of its sides, \"40 mm, 40 mm, 60 mm\"; without it, those of the scene's flames",
     ("Its sides, \"40 mm, 40 mm, 60 mm\"; without it, those of the scene's flames",)),
)

# Arguments whose meaning the introduction tells.
PLAIN = {"SCENE": "Scene file (.toml)", "RAW": "Light field (.exr) written by render"}

# Shared options: the headings under which they stand, in this order. All others are explained in each command.
GROUPS = {
    "Common options": ("--set KEY=VALUE", "--camera NAME", "--which NAME", "--frame N", "--time TIME", "--window X,Y,W,H",
                       "--part K/N", "--seed N", "--threads N", "--quiet", "--json"),
    "Choice of rays": ("--pixel X,Y", "--microlens Q,R", "--point X,Y,Z", "--random N", "--chief"),
    "Raw files of a camera": ("--size WxH", "--bits N", "--endian ORDER", "--skip N", "--shift N", "--turn DEGREES", "--mirror",
                              "--dark FILE ...", "--flat FILE ...", "--flat-dark FILE ...", "--white-dark FILE ...",
                              "--camera CAMERA.toml"),
    "Views and channels": ("--channel NAME", "--scene SCENE.toml", "--spread S", "--resampling NAME", "--force", "--exr"),
    "Unknowns and rows": ("--unknowns KIND", "--grid N[,N,N]", "--center X,Y,Z", "--size X,Y,Z", "--axis X,Y,Z", "--basis KIND",
                          "--absorption WHICH", "--rays N", "--bin N|micro-image|view", "--cells N"),
}


def anchor(heading):
    return heading.lower().replace(" ", "-")


def name_of(option):
    return option.flags()[-1]


def options_of(each):
    """The options with the texts of ALIKE; every command has --help."""
    same = {text: ours for ours, texts in ALIKE for text in texts}
    return [command_help.Entry(option.words, same.get(option.meaning, option.meaning))
            for option in each.sections.get("Options", []) if name_of(option) != "--help"]


def shared_options(commands):
    """{(words, meaning): group} of options with one text in several commands, in the order of GROUPS; of a name with several
    meanings the most frequent one."""
    counts = collections.Counter((option.words, option.meaning) for each in commands for option in options_of(each))
    shared = {}
    for group, names in GROUPS.items():
        for name in names:
            times, key = max((times, key) for key, times in counts.items() if key[0] == name)
            if times > 1:
                shared[key] = group
    return shared


def lines_of(words, meaning):
    """An entry as the help prints it."""
    indent = " " * COLUMN
    text = textwrap.fill(meaning, WIDTH, initial_indent=indent, subsequent_indent=indent, break_long_words=False,
                         break_on_hyphens=False)
    head = f"  {words}"
    return head + text[len(head):] if len(head) < COLUMN - 1 else f"{head}\n{text}"


def block(lines):
    return "```text\n" + "\n".join(lines) + "\n```\n"


def arguments(each):
    """The positionals, written as in the usage line: [SCENE], FILES..."""
    forms = {re.sub(r"\W", "", word): word for word in each.usage.split()}
    for entry in each.sections.get("Positionals", []):
        # Choices with meanings, in columns: "Which flame: layered    three ellipsoids candle     ..."
        if PLAIN.get(entry.words) == entry.meaning:
            yield f"  {forms.get(entry.words, entry.words)}"
            continue
        meaning, *choices = re.split(r" (\w+)   *", entry.meaning)
        meaning += " " * bool(choices) + "; ".join(f"{word} ({text})" for word, text in zip(choices[::2], choices[1::2]))
        yield lines_of(forms.get(entry.words, entry.words), meaning)


def links(named, shared):
    """A link to each group, with the options of it that the command has."""
    for group in GROUPS:
        members = [key for key in shared if shared[key] == group]
        has, lacks = ([f"`{name_of(command_help.Entry(*key))}`" for key in members if (key in named) == wanted]
                      for wanted in (True, False))
        if has:
            text = ", ".join(has) if len(lacks) > 2 else "all but " + ", ".join(lacks) if lacks else "all"
            yield f"[{group}](#{anchor(group)}): {text}"


def section(each, shared):
    title = " ".join(["plenoflame", *each.names])
    text = f"\n{'#' * (1 + len(each.names))} {title}\n\n"
    named = set()
    own = list(arguments(each))
    for option in options_of(each):
        if (option.words, option.meaning) in shared:
            named.add((option.words, option.meaning))
        else:
            own.append(lines_of(option.words, option.meaning))
    text += block(["\n\n".join(filter(None, [each.description, "\n".join(own), each.example]))])
    if named:
        text += "\n" + "; ".join(links(named, shared)) + "\n"
    return text


def page_of(command):
    """The shared options, then one section per command, and one per command within it."""
    commands = list(command_help.walk(command_help.read(command)))[1:]
    shared = shared_options(commands)
    page = INTRODUCTION
    for group in GROUPS:
        lines = [lines_of(*key) for key in shared if shared[key] == group]
        page += f"\n## {group}\n\n{block(lines)}"
    for each in commands:
        page += section(each, shared)
    return page


def main():
    arguments_given = [a for a in sys.argv[1:] if a != "--check"]
    if len(arguments_given) != 1:
        sys.exit(__doc__.strip())
    page = page_of(arguments_given[0])
    if "--check" not in sys.argv:
        PAGE.write_text(page)
        return
    if not PAGE.exists() or PAGE.read_text() != page:
        sys.exit(f"docs/reference/commands.md is not up to date: run tools/command_reference.py {arguments_given[0]}"
                 " and commit the page")


main()
