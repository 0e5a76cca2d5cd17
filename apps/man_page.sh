#!/bin/sh
# Writes the manual page of a program from its --help:  sh man_page.sh build/release/apps/jointgen > jointgen.1
set -eu
name=$(basename "$1")
version=$("$1" --version | sed "s/^$name //; s/+.*//")
"$1" --help | sed 's/\\/\\\\/g; s/-/\\-/g; s/^\./\\\&./' | awk -v name="$name" -v version="$version" '
  NR == 1 {
    sub(/^[^:]*: /, "")
    sub(/\.$/, "")
    printf ".TH \"%s\" 1 \"\" \"jointcreep %s\" \"User Commands\"\n.SH NAME\n%s \\- %s\n", name, version, name, tolower(substr($0, 1, 1)) substr($0, 2)
    next
  }
  /^usage: / { sub(/^usage: /, ""); print (usages++ ? ".br" : ".SH SYNOPSIS"); print; next }
  /^[A-Z][A-Za-z ]*:$/ {
    if (open) print ".fi"
    printf ".SH %s\n.nf\n", toupper(substr($0, 1, length($0) - 1))
    open = 1
    next
  }
  /^$/ { next }
  { print }
  END { if (open) print ".fi" }'
