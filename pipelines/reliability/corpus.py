#!/usr/bin/python3
"""Keeps the smallest set of inputs that reach as much of the readers as all that fuzz.py has found.

    corpus.py FUZZERS CORPUS ARCHIVES [READER ...]

merges CORPUS/READER by libFuzzer (-merge=1) with what ARCHIVES/READER.tar.xz had, and writes this archive anew. fuzz.py begins
with the archives.
"""

import os
import pathlib
import subprocess
import sys
import tarfile
import tempfile

from jointcreep import files

LONGEST = 20  # s, that one input may take
MOST_MEMORY = 4096  # MB; what a reader leaves behind where it cannot throw adds up
SANITIZERS = "allocator_may_return_null=1:detect_leaks=0"


def unpack(archive, folder):
    """The inputs of an archive, if there is one, into a folder."""
    if archive.exists():
        with tarfile.open(archive) as packed:
            for member in packed.getmembers():
                (folder / pathlib.Path(member.name).name).write_bytes(packed.extractfile(member).read())


def bare(member):
    """A file of an archive, as the same whoever packs it at whatever time."""
    member.mtime, member.uid, member.gid, member.uname, member.gname, member.mode = 0, 0, 0, "", "", 0o644
    return member


def merge(fuzzer, corpus, archive):
    """Writes the archive anew. Returns the number of its inputs and its size."""
    with tempfile.TemporaryDirectory(prefix="jointcreep-") as name:
        before, least = pathlib.Path(name, "before"), pathlib.Path(name, "least")
        before.mkdir()
        least.mkdir()
        unpack(archive, before)
        options = ["-merge=1", f"-timeout={LONGEST}", f"-rss_limit_mb={MOST_MEMORY}", "-max_len=262144"]
        done = subprocess.run([fuzzer, *options, least, before, corpus], check=False, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, env=dict(os.environ, ASAN_OPTIONS=SANITIZERS))
        paths = sorted(least.iterdir())
        if done.returncode or not paths:
            said = done.stderr[-500:].decode(errors="replace")
            raise SystemExit(f"corpus: {fuzzer} -merge=1 ended with exit code {done.returncode}: {said}")
        archive.parent.mkdir(parents=True, exist_ok=True)
        with files.replaced(archive) as partial, tarfile.open(partial, "w:xz", preset=9) as packed:
            for path in paths:
                packed.add(path, path.name, filter=bare)
        return len(paths), archive.stat().st_size


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__.split("\n")[2].strip())
    fuzzers, corpus, archives = map(pathlib.Path, sys.argv[1:4])
    for reader in sys.argv[4:] or sorted(path.name for path in corpus.iterdir()):
        number, size = merge((fuzzers / f"{reader}_fuzz").resolve(), corpus / reader, archives / f"{reader}.tar.xz")
        print(f"{reader}: {number} inputs, {size} bytes")


if __name__ == "__main__":
    main()
