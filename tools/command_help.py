"""What the command's --help texts say, as values: the one reader of them for the reference page, the manual pages
and the completions of shells."""

import dataclasses
import os
import re
import subprocess


@dataclasses.dataclass
class Entry:
    """A line of Options, Positionals or Subcommands: its words and what they mean."""

    words: str
    meaning: str

    def flags(self):
        """Spellings of an option: -o, --output."""
        return [word.strip(",") for word in self.words.split() if word.startswith("-")]

    def value(self):
        """The name that stands for an option's value in its help; empty for a switch."""
        return " ".join(word for word in self.words.split() if not word.startswith("-"))


@dataclasses.dataclass
class Help:
    """One command's help."""

    names: list  # ["flame", "import"]; empty: the program itself
    text: str
    sections: dict = dataclasses.field(default_factory=dict)  # "Options": [Entry]
    description: str = ""
    usage: str = ""
    example: str = ""
    below: list = dataclasses.field(default_factory=list)  # Help of each subcommand


def help_text(command, names):
    return subprocess.run([command, *names, "--help"], capture_output=True, text=True, check=True,
                          timeout=60, env={**os.environ, "COLUMNS": "96"}).stdout.rstrip("\n")


def entries(lines):
    """Entries of a section: words begin in column 2, meanings in a column further right or on the next line."""
    found = []
    for line in lines:
        if re.match(r"  \S", line):
            words, _, meaning = line[2:].partition("  ")
            found.append(Entry(words.strip(), meaning.strip()))
        elif found and line.strip():
            found[-1].meaning = (found[-1].meaning + " " + line.strip()).strip()
    return found


def parse(names, text):
    result = Help(names, text)
    head, *blocks = re.split(r"\n\n(?=[A-Z]\w*:\n)", text)
    description, _, usage = head.partition("Usage: ")
    result.description = " ".join(description.split())
    result.usage = usage.strip()
    for block in blocks:
        title, _, body = block.partition(":\n")
        if title == "Example":
            result.example = body.rstrip()
        else:
            result.sections[title] = entries(body.split("\n"))
    return result


def read(command, names=()):
    """Help of a command and of all below it."""
    result = parse(list(names), help_text(command, names))
    for entry in result.sections.get("Subcommands", []):
        result.below.append(read(command, [*names, entry.words]))
    return result


def walk(help_of_command):
    """The command and all below it, in order."""
    yield help_of_command
    for each in help_of_command.below:
        yield from walk(each)
