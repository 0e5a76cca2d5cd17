#!/usr/bin/python3
"""Puts the tables that make -C pipelines/accuracy has made into a page.

    page.py TABLES PAGE.md

Between the lines  <!-- table NAME -->  and  <!-- end -->  of the page comes what is in TABLES/NAME.md. Where there is
no such file the table stays, and is named.
"""

import re
import sys
from pathlib import Path


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: page.py TABLES PAGE.md")
    tables, page = Path(sys.argv[1]), Path(sys.argv[2])

    def filled(found):
        if not (tables / f"{found[2]}.md").exists():
            print(f"page.py: there is no {found[2]}.md in {tables}: that table of {page.name} stays", file=sys.stderr)
            return found[0]
        return f"{found[1]}{(tables / f'{found[2]}.md').read_text()}{found[3]}"

    page.write_text(re.sub(r"(?s)(<!-- table (\S+) -->\n).*?(<!-- end -->)", filled, page.read_text()))


if __name__ == "__main__":
    main()
