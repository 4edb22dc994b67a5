#!/usr/bin/env python3
"""Makes completions of the command line for bash, zsh and fish from the help texts.

    tools/completions.py COMMAND FOLDER

COMMAND: the built plenoflame; FOLDER receives plenoflame.bash, _plenoflame (zsh) and plenoflame.fish. Commands and
options are completed; after an option that takes a value, and for arguments, the names of files are."""

import pathlib
import sys

import command_help

HEAD = "Made from the help texts by tools/completions.py."


def options_of(each):
    return [entry for title, items in each.sections.items() if title not in ("Positionals", "Subcommands")
            for entry in items]


def bash(commands):
    cases = ""
    for each in commands:
        words = [flag for entry in options_of(each) for flag in entry.flags()] + [b.names[-1] for b in each.below]
        valued = [flag for entry in options_of(each) if entry.value() for flag in entry.flags()]
        cases += f"    '{' '.join(each.names)}')\n      words='{' '.join(words)}'\n"
        cases += f"      valued='{' '.join(valued)}' ;;\n"
    subcommands = {" ".join(each.names) for each in commands if each.names}
    names = "|".join(f"'{name}'" for name in sorted(subcommands))
    return f"""# bash completion of plenoflame. {HEAD}
_plenoflame() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} name='' longer word words='' valued=''
  COMPREPLY=()
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    longer=${{name:+$name }}$word
    case "$longer" in {names}) name=$longer ;; esac
  done
  case "$name" in
{cases}  esac
  if [[ " $valued " != *" $before "* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  fi
  if [[ $current != -* && ${{#COMPREPLY[@]}} -eq 0 ]]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
    compopt -o filenames 2>/dev/null
  fi
}}
complete -F _plenoflame plenoflame
"""


def zsh_quoted(text):
    """Text within the brackets of an _arguments specification, in single quotes."""
    for sign in "\\[]:":
        text = text.replace(sign, "\\" + sign)
    return text.replace("'", "'\\''")


def zsh_function(names):
    return "_".join(["_plenoflame", *names]).replace("-", "_")


def zsh(commands):
    text = f"#compdef plenoflame\n# {HEAD}\n"
    for each in commands:
        lines = []
        for entry in options_of(each):
            value = f":{zsh_quoted(entry.value())}:_files" if entry.value() else ""
            lines += [f"'*{flag}[{zsh_quoted(entry.meaning)}]{value}'" for flag in entry.flags()]
        if each.below:
            lines += ["'1:command:->command'", "'*::argument:->argument'"]
        else:
            lines += ["'*:file:_files'"]
        body = " \\\n    ".join(lines)
        text += f"\n{zsh_function(each.names)}() {{\n  local state line\n  _arguments -C \\\n    {body}\n"
        if each.below:
            described = "\n".join(f"      '{zsh_quoted(b.names[-1])}:{zsh_quoted(b.description)}'" for b in each.below)
            cases = "\n".join(f"      {b.names[-1]}) {zsh_function(b.names)} ;;" for b in each.below)
            text += (f"  case $state in\n  command)\n    local -a commands=(\n{described}\n    )\n"
                     "    _describe command commands || _files ;;\n"
                     f"  argument)\n    case $line[1] in\n{cases}\n      *) _files ;;\n    esac ;;\n  esac\n")
        text += "}\n"
    return text + '\n_plenoflame "$@"\n'


def fish_quoted(text):
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def fish(commands):
    text = f"# fish completion of plenoflame. {HEAD}\n"
    for each in commands:
        seen = "; and ".join(f"__fish_seen_subcommand_from {name}" for name in each.names)
        below = " ".join(b.names[-1] for b in each.below)
        free = f"not __fish_seen_subcommand_from {below}" if below else ""
        condition = fish_quoted("; and ".join(part for part in (seen, free) if part))
        for b in each.below:
            text += f"complete -c plenoflame -n {condition} -a {b.names[-1]} -d {fish_quoted(b.description)}\n"
        for entry in options_of(each):
            flags = " ".join(f"-l {f[2:]}" if f.startswith("--") else f"-s {f[1:]}" for f in entry.flags())
            wants = " -r" if entry.value() else ""
            text += f"complete -c plenoflame -n {condition} {flags}{wants} -d {fish_quoted(entry.meaning)}\n"
    return text


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    folder = pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    commands = list(command_help.walk(command_help.read(sys.argv[1])))
    for name, make in (("plenoflame.bash", bash), ("_plenoflame", zsh), ("plenoflame.fish", fish)):
        (folder / name).write_text(make(commands), encoding="ascii")


main()
