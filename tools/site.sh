#!/bin/bash
# Builds the documentation as a site: MkDocs for the pages, Doxygen for the C++ libraries. A link that leads nowhere
# ends it with status 1.
#
#   tools/site.sh [--serve [PORT]] [FOLDER]
#
# FOLDER (default: build/site) receives html/, to be put on a server or opened from there (then without search, which
# browsers allow servers only). --serve shows it at http://localhost:8000 (or PORT) until Ctrl-C. tools/setup.sh site installs what it needs.
set -euo pipefail
cd "$(dirname "$0")/.."

port=
folder=build/site
while [ $# -gt 0 ]; do
  case "$1" in
    --serve)
      port=8000
      if [[ "${2:-}" =~ ^[0-9]+$ ]]; then port=$2; shift; fi
      ;;
    -h | --help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
    -*) echo "site.sh: unknown option $1 (see --help)" >&2; exit 2 ;;
    *) folder=$1 ;;
  esac
  shift
done
for program in mkdocs doxygen python3; do
  command -v "$program" >/dev/null ||
    { echo "site.sh: $program is missing: tools/setup.sh site installs it" >&2; exit 1; }
done
katex=/usr/share/javascript/katex
[ -e "$katex/katex.min.js" ] || { echo "site.sh: $katex is missing: tools/setup.sh site installs it" >&2; exit 1; }

version=$(sed -n 's/^project(plenoflame VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
mkdir -p "$folder"
tools/site_source.py prepare . "$folder"
# KaTeX becomes a part of the site, so that formulas need no network.
mkdir -p "$folder/source/katex/contrib"
cp -rL "$katex"/{katex.min.css,katex.min.js,fonts} "$folder/source/katex"
cp -L "$katex/contrib/auto-render.js" "$folder/source/katex/contrib"
rm -f "$folder"/source/katex/fonts/*.ttf "$folder"/source/katex/fonts/*.woff  # browsers take the .woff2
reference=$folder/source/reference
tools/python_reference.py app/python/plenoflame >"$reference/python.md"
cat >"$reference/cpp.md" <<TEXT
# C++ libraries

Programs that find the package \`plenoflame\` with CMake ([how](../user/install.md)) link \`plenoflame::core\` and
\`plenoflame::volumes\`. [Every class and function](doxygen/index.html) has its own page, made from the headers.
TEXT
{ cat packaging/site/Doxyfile; printf 'OUTPUT_DIRECTORY = %s\nPROJECT_NUMBER = %s\n' "$reference" "$version"; } |
  doxygen - 2>"$folder/doxygen.log" || { cat "$folder/doxygen.log" >&2; exit 1; }
mkdocs build --quiet --strict -f "$folder/mkdocs.yml"
tools/site_source.py check "$folder/html"
echo "$folder/html/index.html"
[ -z "$port" ] || exec python3 -m http.server --directory "$folder/html" "$port"
