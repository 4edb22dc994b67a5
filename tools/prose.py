#!/usr/bin/env python3
"""Counts sentences that are hard to read in pages and comments, and holds the counts to limits.

Usage: prose.py [--list] [--check] [--limits]

Prints one row for each folder, and the number of words of all pages. --list prints each finding with its file and line. --check
fails when a count is above its limit in LIMITS or a page is longer than LENGTHS, and says which limits can be lowered. --limits
prints the table LIMITS with today's counts. Code, tables, formulas and addresses are ignored.
"""

import argparse
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST_WORDS = 25
RULES = ("long", "opening", "diary", "gets", "glossary", "passive")
# Most findings of each folder, in the order of RULES. Limits only fall: lower one when its count has fallen.
LIMITS = {
    "README, CONTRIBUTING": (0, 0, 0, 0, 0, 0),
    "docs": (0, 0, 0, 0, 0, 0),
    "docs/benchmarks.md": (0, 0, 0, 0, 0, 0),
    "docs/developer": (0, 0, 0, 0, 0, 0),
    "docs/numerics.md": (0, 0, 0, 0, 0, 0),
    "docs/reference": (0, 0, 0, 0, 0, 0),
    "docs/theory": (0, 0, 0, 0, 0, 0),
    "docs/user": (0, 0, 0, 0, 0, 0),
    "docs/validation.md": (0, 0, 0, 0, 0, 0),
    "core (comments)": (0, 0, 0, 0, 0, 64),
    "volumes (comments)": (0, 0, 0, 0, 0, 6),
    "app (comments)": (0, 0, 0, 0, 0, 73),
}
# Most words of a page, by the beginning of its path: the first row that fits decides. None: a page of tables.
LENGTHS = (("docs/reconstruct.md", 1500), ("docs/theory/", 1500), ("docs/validation.md", None), ("docs/", 900))
GENERATED = ("docs/reference/", "docs/benchmarks.md", "docs/numerics.md", "docs/validation.md")
SOURCES = ("core", "volumes", "app")
OPENING = re.compile(r"^(Of|What|That of|Those|So many|As far|Whether|Where)\b")
DIARY = re.compile(r"\b(was tried|were tried|asked for|was asked|next time|not reached|fell short|falls short)\b", re.I)
GETS = re.compile(r"^what\b.*\bgets?\b", re.I)
PARTICIPLES = ("begun|bent|bound|bought|brought|broken|built|caught|chosen|cut|done|drawn|driven|fed|felt|forgotten|found|given|"
               "gone|held|hidden|hit|kept|known|laid|led|left|lit|lost|made|meant|met|paid|put|read|run|said|seen|sent|set|shown|"
               "split|spread|stood|swept|taken|told|thought|thrown|understood|woven|written")
PASSIVE = re.compile(rf"\b(?:is|are|was|were|be|been|being)\s+(?:not\s+|also\s+|then\s+|\w+ly\s+)?(?:\w{{2,}}ed|{PARTICIPLES})\b", re.I)
SENTENCE_END = re.compile(r"(?<=[.!?:;])[\"')*_]*\s+(?=[\"'(*_\[]*[A-Z])")


class Sentence:
    def __init__(self, line, text, heading=False):
        self.line, self.text, self.heading = line, text, heading
        self.words = sum(bool(re.search(r"\w", word)) for word in text.split())


def plain(text):
    """A line without markup: inline code and a formula become one word, a link its text, an address nothing."""
    text = re.sub(r"`[^`]*`|\$[^$]+\$", "Code", text)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"<!--.*?-->|<?\bhttps?://\S+", "", text)


def sentences(paragraph, first_line):
    """The sentences of a paragraph (its lines), each with the line on which it begins."""
    text = "\n".join(paragraph)
    begin = 0
    for end in [m.start() for m in SENTENCE_END.finditer(text)] + [len(text)]:
        part = text[begin:end]
        line = first_line + text[:begin + len(part) - len(part.lstrip("\"')*_ \n"))].count("\n")
        if part.strip():
            yield Sentence(line, " ".join(part.split()).lstrip("\"')*_ "))
        begin = end


def page_sentences(text):
    """Sentences and headings of a Markdown page."""
    paragraph, start, fence, comment = [], 0, False, False
    for number, line in enumerate(text.splitlines() + [""], 1):
        bare = line.strip()
        if bare.startswith("```") or bare.count("$$") == 1:
            fence, bare = not fence, ""
        elif bare.startswith("<!--") and "-->" not in bare:
            comment = True
        formula = line.startswith("    ") and not paragraph
        ignored = fence or comment or formula or not bare or bare.startswith(("|", "<!--", "$$"))
        item = re.match(r"([-*+]|\d+\.)\s+", bare)
        heading = re.match(r"#+\s+", bare)
        if paragraph and (ignored or item or heading):
            yield from sentences(paragraph, start)
            paragraph = []
        if comment:
            comment = "-->" not in bare
        elif heading and not ignored:
            yield Sentence(number, plain(bare[heading.end():]), heading=True)
        elif not ignored:
            start = start if paragraph else number
            paragraph.append(plain(bare[item.end():] if item else bare))


def comment_sentences(text, mark):
    """Sentences of a source file's comments; a comment on a line of code stands alone."""
    paragraph, start = [], 0
    whole, behind = (re.compile(before + mark + r"(?P<text>.*)") for before in (r"^\s*", r"\S\s+"))
    for number, line in enumerate(text.splitlines() + [""], 1):
        found = whole.match(line)
        comment = plain(found["text"]).strip() if found else ""
        item = re.match(r"([-*]|\d+\.|@\w+)\s+", comment)
        if paragraph and (not comment or item):
            yield from sentences(paragraph, start)
            paragraph = []
        if comment:
            start = start if paragraph else number
            paragraph.append(comment[item.end():] if item else comment)
        elif not found and (end := behind.search(line)):
            yield from sentences([plain(end["text"]).strip()], number)


def avoided_words(glossary):
    """{word: replacement} of the glossary's section "Words to avoid"."""
    section = glossary.partition("## Words to avoid")[2].partition("\n## ")[0]
    rows = [[cell.strip() for cell in row.strip("|").split("|")] for row in section.splitlines() if row.startswith("|")]
    return {word.strip(): row[1] for row in rows[2:] for word in row[0].split(",")}


def findings(sentence, avoided):
    """(rule, remark) of everything that is wrong with a sentence."""
    text = sentence.text
    if sentence.heading and GETS.search(text):
        yield "gets", "name the topic"
    if not sentence.heading and sentence.words > MOST_WORDS:
        yield "long", f"{sentence.words} words"
    if not sentence.heading and (opening := OPENING.match(text)) and not text.endswith("?"):
        yield "opening", f'begins with "{opening[0]}"'
    if len(passives := PASSIVE.findall(text)) > 1:
        yield "passive", f'"{passives[0]}" and "{passives[1]}"'
    if diary := DIARY.search(text):
        yield "diary", f'"{diary[0]}"'
    for word, better in avoided.items():
        if re.search(rf"\b{re.escape(word)}\b", text, re.I):
            yield "glossary", f'"{word}": say "{better}"'


def folder_of(path):
    """The row in which a file counts."""
    if path.startswith(SOURCES):
        return f"{path.split('/')[0]} (comments)"
    if path.startswith(GENERATED):
        return path if path.count("/") == 1 else "docs/reference"
    return path.rpartition("/")[0] or "README, CONTRIBUTING"


def pages_of(root):
    return [root / "README.md", root / "CONTRIBUTING.md", *sorted((root / "docs").rglob("*.md"))]


def texts(root):
    """(path, sentences) of every page and source."""
    for page in pages_of(root):
        yield page.relative_to(root).as_posix(), page_sentences(page.read_text())
    for folder in SOURCES:
        for path in sorted((root / folder).rglob("*")):
            mark = "///?<?" if path.suffix in (".h", ".cpp", ".cxx") else "#(?!!)" if path.suffix in (".py", ".txt", ".cmake") else None
            if mark:
                yield path.relative_to(root).as_posix(), comment_sentences(path.read_text(), mark)


def count(root, show):
    """{folder: {"words": n, rule: n}}, {page: words}; show is called with each finding."""
    avoided = avoided_words((root / "docs/developer/glossary.md").read_text())
    counts, pages = {}, {}
    for path, parts in texts(root):
        parts = list(parts)
        if path.endswith(".md"):
            pages[path] = sum(sentence.words for sentence in parts)
        row = counts.setdefault(folder_of(path), dict.fromkeys(("words", *RULES), 0))
        for sentence in parts:
            row["words"] += sentence.words
            # The glossary itself names the words to avoid.
            for rule, remark in findings(sentence, {} if path.endswith("glossary.md") else avoided):
                row[rule] += 1
                show(f"{path}:{sentence.line}: {rule}: {remark}: {sentence.text[:100]}")
    return counts, pages


def too_long(pages):
    """A line for each page that is longer than LENGTHS."""
    for path, words in pages.items():
        most = next((most for begin, most in LENGTHS if path.startswith(begin)), None)
        if most and words > most:
            yield f"{path}: {words} words, limit {most}: delete what repeats, or link"


def check(counts, limits):
    """True when no count is above its limit."""
    fits = True
    for folder, row in counts.items():
        for rule, limit in zip(RULES, limits.get(folder, (0,) * len(RULES))):
            if row[rule] > limit:
                fits = False
                print(f"{folder}: {rule}: {row[rule]}, limit {limit}: rewrite the new ones (tools/prose.py --list)")
            elif row[rule] < limit:
                print(f"{folder}: {rule}: {row[rule]}, limit {limit}: lower the limit in tools/prose.py")
    return fits


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for option in ("--list", "--check", "--limits"):
        parser.add_argument(option, action="store_true")
    options = parser.parse_args()
    counts, pages = count(ROOT, print if options.list else lambda line: None)
    if options.limits:
        print("\n".join(f'    "{folder}": ({", ".join(str(row[rule]) for rule in RULES)}),' for folder, row in counts.items()))
        return
    print(f"{'':30}" + "".join(f"{name:>10}" for name in ("words", *RULES)))
    for folder, row in counts.items():
        print(f"{folder:30}" + "".join(f"{n:10}" for n in row.values()))
    print(f"all pages, with tables, code and formulas: {sum(len(page.read_text().split()) for page in pages_of(ROOT))} words")
    if options.check:
        long_pages = list(too_long(pages))
        print("".join(line + "\n" for line in long_pages), end="")
        if not check(counts, LIMITS) or long_pages:
            sys.exit(1)


if __name__ == "__main__":
    main()
