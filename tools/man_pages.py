#!/usr/bin/env python3
"""Makes manual pages from the help texts: plenoflame.1 and one page for each command.

    tools/man_pages.py COMMAND FOLDER [--date YYYY-MM-DD] [--version VERSION]

COMMAND: the built plenoflame; FOLDER receives plenoflame.1, plenoflame-render.1, ... The date stands at the foot of
each page (default: today, or that of SOURCE_DATE_EPOCH)."""

import argparse
import datetime
import os
import pathlib

import command_help

EXIT_STATUS = [("0", "success"), ("1", "the input or the machine is at fault"), ("2", "the command line is at fault"),
               ("130, 143", "stopped by a signal; what was finished is saved")]
FILES_TEXT = ("Scenes are TOML files, flames OpenVDB files, light fields OpenEXR files. Every file is written under a "
              "temporary name and renamed, so that an existing one is never left half-written.")


def escape(text):
    """Text as roff: backslashes, hyphens that are to be typed, and control characters at the line's start."""
    text = text.replace("\\", "\\(rs").replace("-", "\\-").replace("'", "\\(aq")
    return "\n".join("\\&" + line if line.startswith((".", "'")) else line for line in text.split("\n"))


def bold(text):
    return f"\\fB{escape(text)}\\fR"


def italic(text):
    return f"\\fI{escape(text)}\\fR" if text else ""


def definition(term, text):
    return f".TP\n{term}\n{escape(text)}\n"


def option_term(entry):
    flags = ", ".join(bold(flag) for flag in entry.flags())
    return f"{flags} {italic(entry.value())}".rstrip()


def page(each, version, date):
    name = "-".join(["plenoflame", *each.names])
    title = " ".join(["plenoflame", *each.names])
    description = each.description.rstrip(".")
    text = f'.TH "{name.upper()}" 1 "{date}" "plenoflame {version}" "Plenoflame"\n'
    text += f".SH NAME\n{escape(name)} \\- {escape(description[0].lower() + description[1:])}\n"
    rest = each.usage[len(title):].strip()
    text += f".SH SYNOPSIS\n{bold(title)} {italic(rest)}\n"
    text += f".SH DESCRIPTION\n{escape(description)}.\n"
    for title, items in each.sections.items():
        if title == "Subcommands":
            text += ".SH COMMANDS\n"
            for entry, below in zip(items, each.below):
                text += definition(bold(entry.words), entry.meaning)
                text += f"See {bold('-'.join(['plenoflame', *below.names]))}(1).\n"
        elif title == "Positionals":
            text += ".SH ARGUMENTS\n" + "".join(definition(italic(e.words), e.meaning) for e in items)
        else:
            text += f".SH {escape(title.upper())}\n" + "".join(definition(option_term(e), e.meaning) for e in items)
    text += ".SH EXIT STATUS\n" + "".join(definition(bold(code), meaning) for code, meaning in EXIT_STATUS)
    text += f".SH FILES\n{escape(FILES_TEXT)}\n"
    if each.example:
        text += f".SH EXAMPLES\n.nf\n{escape(each.example)}\n.fi\n"
    others = [["plenoflame"]] if each.names else []
    others += [["plenoflame", *below.names] for below in each.below]
    if others:
        text += ".SH SEE ALSO\n" + ",\n".join(f"{bold('-'.join(names))}(1)" for names in others) + "\n"
    return name, text


def default_date():
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    moment = datetime.datetime.fromtimestamp(int(epoch), datetime.timezone.utc) if epoch else datetime.datetime.now()
    return moment.strftime("%Y-%m-%d")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("command")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--date", default=default_date())
    parser.add_argument("--version", default="")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for each in command_help.walk(command_help.read(options.command)):
        name, text = page(each, options.version, options.date)
        (options.folder / f"{name}.1").write_text(text, encoding="ascii")


main()
