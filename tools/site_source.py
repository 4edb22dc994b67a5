#!/usr/bin/env python3
"""Prepares the documentation for MkDocs, and checks the site that it made.

    site_source.py prepare ROOT FOLDER    FOLDER/source with the pages, FOLDER/mkdocs.yml with the navigation
    site_source.py check SITE             every link and picture of the pages leads somewhere; prints those that do not

The navigation is docs/README.md: its headings are the sections, its lists the pages. Numbered lists below headings of the
third level are ways through the pages: a page of a way ends with links to the way's previous and next page, which replace those
of the navigation. Links of a page to sources and examples lead to copies of them. Standard library only.
"""

import html.parser
import json
import pathlib
import re
import shutil
import sys
import urllib.parse

LINK = re.compile(r"(!?\[(?:[^\]\\]|\\.)*\])\(([^)\s]+)\)")
SIZED_PICTURE = re.compile(r'<img src="([^"]+)" width="\d+" alt="([^"]+)">')
LIST_ITEM = re.compile(r"^( *)([-*]|\d+\.) ")
ENTRY = re.compile(r"^(?P<mark>-|\d+\.) \[(?P<title>[^\]]+)\]\((?P<path>[^)]+)\)")
# Pages at the top of the repository, by the names that they have on the site.
TOP_PAGES = {"docs/README.md": "index.md", "README.md": "overview.md", "CHANGELOG.md": "changelog.md",
             "CONTRIBUTING.md": "contributing.md"}


def site_path(path):
    """Where a file of the repository stands on the site: pages keep their place below docs/."""
    if path in TOP_PAGES:
        return TOP_PAGES[path]
    return path[len("docs/"):] if path.startswith("docs/") else f"files/{path}"


def relative(target, page):
    """A link from page to target, both paths of the site."""
    parts, here = target.split("/"), page.split("/")[:-1]
    while here and parts[:-1] and here[0] == parts[0]:
        here, parts = here[1:], parts[1:]
    return "/".join([".."] * len(here) + parts)


class Page:
    """One page on its way from the repository to the site."""

    def __init__(self, root, source):
        self.root, self.source, self.target = root, source, site_path(source)
        self.copies = set()  # files outside of docs that it links to

    def link(self, match):
        text, url = match.groups()
        if re.match(r"[a-z]+:|#", url):
            return match[0]
        address, mark, anchor = url.partition("#")
        path = (self.root / self.source).parent.joinpath(address).resolve()
        if not path.is_file() or self.root not in path.parents:
            raise SystemExit(f"{self.source}: {url} leads to no file")
        path = path.relative_to(self.root).as_posix()
        target = site_path(path)
        if target.startswith("files/"):
            self.copies.add(path)
        url = relative(target, self.target) + mark + anchor
        # A picture is a link to itself, so that it opens in its own size.
        return f"[{text}({url})]({url})" if text.startswith("!") else f"{text}({url})"

    def convert(self):
        """The page as Python-Markdown reads it: lists and tables follow an empty line, lists within lists are indented
        by four, links are those of the site."""
        parts, text, code, before = [], [], False, ""  # parts are lines with links set, text those since
        page = SIZED_PICTURE.sub(r"![\2](\1)", (self.root / self.source).read_text(encoding="utf-8"))
        for line in page.splitlines():
            fence = line.lstrip().startswith("```")
            if fence and not code:
                parts += LINK.sub(self.link, "\n".join(text)).split("\n") if text else []
                text = []
            elif not code:
                item, was_item = LIST_ITEM.match(line), LIST_ITEM.match(before)
                starts_table = line.startswith("|") and not before.startswith("|")
                # A line that continues an item is indented, so that text before a list is not.
                if (starts_table or (item and not was_item and not before.startswith(" "))) and before.strip():
                    text.append("")
                if item:
                    line = item[1] * 2 + line.lstrip()
            text.append(line)
            before = line
            if fence and code:
                parts += text
                text = []
            code = code != fence
        parts += LINK.sub(self.link, "\n".join(text)).split("\n") if text else []
        return "\n".join(parts) + "\n"


def listed(root, level, numbered):
    """[(heading, [(title, page of the site)])] of docs/README.md: headings of this level, with numbered or plain lists of pages."""
    found = []
    for line in (root / "docs/README.md").read_text(encoding="utf-8").splitlines():
        entry = ENTRY.match(line)
        if line.startswith("#"):
            mark, _, heading = line.partition(" ")
            found.append((heading.strip() if len(mark) == level else "", []))
        elif entry and found[-1][0] and (entry["mark"] != "-") == numbered:
            path = (root / "docs").joinpath(entry["path"]).resolve().relative_to(root).as_posix()
            found[-1][1].append((entry["title"], site_path(path)))
    return [section for section in found if section[1]]


def way_links(root):
    """{page of the site: lines with the previous and the next page of each way that it belongs to}"""
    found = {}
    for way, entries in listed(root, 3, numbered=True):
        steps = [("All ways", "index.md"), *entries, ("All pages", "index.md")]
        for k, (_, page) in enumerate(entries):
            (before, back), (after, on) = steps[k], steps[k + 2]
            found[page] = found.get(page, "") + (
                f"\n**{way}**, {k + 1} of {len(entries)}. Previous: [{before}]({relative(back, page)}). "
                f"Next: [{after}]({relative(on, page)}).\n{{: .way }}\n")
    return found


def prepare(root, folder):
    root = root.resolve()
    source = folder / "source"
    shutil.rmtree(source, ignore_errors=True)
    pages = [p.relative_to(root).as_posix() for p in sorted((root / "docs").rglob("*.md"))]
    copies = {p.relative_to(root).as_posix() for p in (root / "docs").rglob("*")
              if p.is_file() and p.suffix != ".md"}
    links = way_links(root)
    for name in dict.fromkeys([*TOP_PAGES, *pages]):
        page = Page(root, name)
        target = source / page.target
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(page.convert() + links.get(page.target, ""), encoding="utf-8")
        copies |= page.copies
    for name in sorted(copies):
        target = source / site_path(name)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(root / name, target)
    for name in ("site.css", "formulas.js"):
        shutil.copyfile(root / "packaging/site" / name, source / name)

    sections = listed(root, 2, numbered=False)
    known = {page for _, entries in sections for _, page in entries}
    missing = [p for p in pages if site_path(p) not in known and p not in TOP_PAGES]
    if missing:
        raise SystemExit(f"docs/README.md does not list {', '.join(missing)}")
    for section, entries in sections:
        if section == "Reference":
            entries += [("Python package", "reference/python.md"), ("C++ libraries", "reference/cpp.md")]
    nav = [{"Home": "index.md"}]
    nav += [{section: [{title: page} for title, page in entries]} for section, entries in sections]
    nav += [{"More": [{"Overview": "overview.md"}, {"Changes": "changelog.md"}, {"Contributing": "contributing.md"}]}]
    text = (root / "packaging/site/mkdocs.yml").read_text()
    text += f"docs_dir: source\nsite_dir: html\nnav: {json.dumps(nav)}\n"  # JSON is YAML
    (folder / "mkdocs.yml").write_text(text)


class Links(html.parser.HTMLParser):
    """Addresses that a page leads to, and the anchors that it has."""

    def __init__(self, text):
        super().__init__()
        self.addresses, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "src") and value:
                self.addresses.append(value)
            elif name in ("id", "name") and value:
                self.anchors.add(value)


def check(site):
    """Addresses of the site's own pages that lead nowhere, as lines of text. Doxygen's pages are only led to."""
    site = site.resolve()
    pages = {p: Links(p.read_text(encoding="utf-8")) for p in sorted(site.rglob("*.html"))
             if "doxygen" not in p.relative_to(site).parts and p.name != "404.html"}
    for page, links in pages.items():
        for address in links.addresses:
            url = urllib.parse.urlsplit(address)
            if url.scheme or url.netloc:
                continue
            target = (page.parent / urllib.parse.unquote(url.path)).resolve() if url.path else page
            target = target / "index.html" if target.is_dir() else target
            if not target.is_file():
                yield f"{page.relative_to(site)}: {address}: there is no such file"
            elif url.fragment and target in pages and urllib.parse.unquote(url.fragment) not in pages[target].anchors:
                yield f"{page.relative_to(site)}: {address}: the page has no such place"


def main():
    if len(sys.argv) == 4 and sys.argv[1] == "prepare":
        prepare(pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]))
    elif len(sys.argv) == 3 and sys.argv[1] == "check":
        broken = list(check(pathlib.Path(sys.argv[2])))
        print(*broken, sep="\n", end="\n" if broken else "")
        sys.exit(f"{len(broken)} broken links" if broken else 0)
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
