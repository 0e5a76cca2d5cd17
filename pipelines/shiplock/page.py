#!/usr/bin/python3
"""Puts the tables of out/shiplock into the page.

    page.py OUT docs/shiplock.md

Between the lines `<!-- NAME.md -->` and `<!-- end of NAME.md -->` of the page goes the content of OUT/NAME.md; a table that
is not there yet leaves what the page has.
"""

import pathlib
import re
import sys

from jointcreep import files


def with_tables(page, folder):
    def table(found):
        path = folder / found[1]
        return f"<!-- {found[1]} -->\n\n{path.read_text().strip()}\n\n<!-- end of {found[1]} -->" if path.exists() else found[0]

    return re.sub(r"<!-- ([\w/-]+\.md) -->\n.*?<!-- end of \1 -->", table, page, flags=re.DOTALL)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    folder, path = map(pathlib.Path, sys.argv[1:])
    page = with_tables(path.read_text(encoding="utf-8"), folder)
    files.write_text(path, page)


if __name__ == "__main__":
    main()
