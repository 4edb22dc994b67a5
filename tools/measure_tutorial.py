#!/usr/bin/python3
"""Follows docs/user/tutorial.md to its end, in a new folder, and measures each step.

    tools/measure_tutorial.py [COMMAND] [--keep FOLDER] [--write]

COMMAND: the program plenoflame (build/release/app/cli/plenoflame, else the one in PATH). --keep FOLDER leaves there what the
tutorial makes; --write puts the times into the tutorial, between its marks. Steps in which only a person acts are
left out. Wall time depends on what else the machine does; processor time hardly.
"""

import argparse
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "user" / "tutorial.md"
BEGIN, END = "<!-- times: tools/measure_tutorial.py --write -->\n", "<!-- end of times -->\n"


def steps(page):
    """[(title, [commands])] of the sections that have commands of plenoflame."""
    found = []
    for section in re.split(r"^## ", page, flags=re.MULTILINE)[1:]:
        commands = []
        for block in re.findall(r"^```sh\n(.*?)^```", section, flags=re.MULTILINE | re.DOTALL):
            commands += re.sub(r"\\\n\s*", " ", block).strip().splitlines()
        commands = [command for command in commands if command.startswith("plenoflame ")]
        if commands:
            found.append((section.splitlines()[0], commands))
    return found


def processor():
    with open("/proc/cpuinfo") as file:
        return next((line.split(":")[1].strip() for line in file if line.startswith("model name")), "an unknown processor")


def seconds(value):
    return f"{value:.1f} s" if value < 9.95 else f"{value:.0f} s"


def measure(command, folder):
    """[(title, wall, processor)] in seconds."""
    environment = {**os.environ, "PATH": f"{command.parent}:{os.environ['PATH']}"}
    rows = []
    for title, commands in steps(PAGE.read_text()):
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        for line in commands:
            done = subprocess.run(["/bin/sh", "-c", line], cwd=folder, env=environment, capture_output=True, text=True)
            if done.returncode:
                sys.exit(f"measure_tutorial.py: {line}\n{done.stderr}")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        rows.append((title, time.monotonic() - start, used))
        print(f"{seconds(rows[-1][1]):>8} {seconds(used):>8}  {title}", file=sys.stderr)
    return rows


def table(rows):
    lines = ["| step | time | processor time |", "|---|---|---|"]
    lines += [f"| {title} | {seconds(wall)} | {seconds(used)} |" for title, wall, used in rows]
    lines.append(f"| all | {seconds(sum(row[1] for row in rows))} | {seconds(sum(row[2] for row in rows))} |")
    return "\n".join(lines) + "\n"


def sentence(rows):
    """What the tutorial says of its times."""
    step, longest, _ = max(rows, key=lambda row: row[1])
    return (f"The commands take {seconds(sum(row[1] for row in rows))} ({seconds(sum(row[2] for row in rows))} of the processor), of which "
            f"{seconds(longest)} for step {step.split('.')[0]}, on {os.cpu_count()} processors ({processor()}).\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    built = ROOT / "build/release/app/cli/plenoflame"
    parser.add_argument("command", nargs="?", default=built if built.exists() else shutil.which("plenoflame"))
    parser.add_argument("--keep")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if not options.command or not os.access(options.command, os.X_OK):
        sys.exit("measure_tutorial.py: there is no command plenoflame; build it, or say where it is")
    with tempfile.TemporaryDirectory(prefix="plenoflame-tutorial-") as temporary:
        folder = pathlib.Path(options.keep or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copytree(ROOT / "examples", folder / "examples", dirs_exist_ok=True)
        rows = measure(pathlib.Path(options.command).resolve(), folder)
    print(table(rows), end="")
    if options.write:
        page = PAGE.read_text()
        begin, end = page.index(BEGIN) + len(BEGIN), page.index(END)
        PAGE.write_text(page[:begin] + sentence(rows) + page[end:])


if __name__ == "__main__":
    main()
