"""Fuzzes what reads scenes, field data, measurements and HDF5 files, with sanitizers (libFuzzer, tests/fuzz).

Each reader gets N inputs, or S seconds of the processor. The corpus begins with the files of data and tests that it reads, and
with what earlier runs found (the archives in pipelines/reliability/corpus, which corpus.py makes), and is kept in OUT/corpus;
inputs that end a reader otherwise than by a refusal are kept in OUT/faults.
"""

import itertools
import os
import pathlib
import re
import resource
import shutil
import subprocess
import tempfile

from campaign import ROOT, Campaign
from corpus import LONGEST, MOST_MEMORY, unpack

RUN = 600  # s, after which what a target has done is counted, and it is started again
MOST_FAULTS = 20
LAST = 100000  # bytes of what a target says
SECONDS = "s of the processor"
SANITIZERS = ":".join(("allocator_may_return_null=1", "detect_leaks=0", "malloc_context_size=2", "max_malloc_fill_size=0",
                       "quarantine_size_mb=8", "allocator_release_to_os_interval_ms=-1"))  # the last four for speed
READERS = {  # and the longest input: short ones are read some thousand times a second
    "scene": (["data/**/*.toml", "tests/pipeline/**/*.toml"], 2048),
    "field_data": (["tests/pipeline/kinds/*.csv", "tests/pipeline/kinds/*.geojson", "tests/fuzz/*.csv"], 4096),
    "measurements": (["tests/fuzz/*.csv", "data/**/*.csv"], 4096),
    "store": ([], 262144),  # a small result has 110 kB
}


def begun(campaign, reader, corpus):
    """The corpus, with what is there to begin with."""
    corpus.mkdir(parents=True, exist_ok=True)
    unpack(ROOT / f"pipelines/reliability/corpus/{reader}.tar.xz", corpus)
    patterns, longest = READERS[reader]
    for path in (path for pattern in patterns for path in ROOT.glob(pattern)):
        content, name = path.read_bytes(), str(path.relative_to(ROOT)).replace("/", "-")
        for start in range(0, len(content), longest):  # a part of a scene may be a scene, too
            (corpus / f"{name}-{start}").write_bytes(content[start : start + longest])
    if reader == "store":
        chain, folder = campaign.chain, campaign.chain.new_folder()
        network = chain.run("jointgen", ROOT / "pipelines/reliability/small.toml", folder / "network.h5")
        joints = chain.run("strength-averaging", network, folder / "joints.h5")
        chain.run("demsolve", joints, folder / "result.h5", "--checkpoint", folder / "kept.h5", "--no-creep")
        for path in folder.iterdir():
            shutil.copy(path, corpus)


def fuzz(campaign, reader, fuzzers, seconds):
    """Runs a target, for RUN seconds at a time, until it has had its number; each fault ends it, and it is started again."""
    corpus, found = campaign.out / "corpus" / reader, campaign.out / "faults" / f"fuzz-{reader}"
    begun(campaign, reader, corpus)
    found.mkdir(parents=True, exist_ok=True)
    done, used, faults = 0, 0, 0
    for run in itertools.count():
        if (used >= seconds if seconds else done >= campaign.n) or faults == MOST_FAULTS:
            return
        amount = [f"-max_total_time={min(RUN, seconds - used + 1 if seconds else RUN)}"]
        amount += [] if seconds else [f"-runs={campaign.n - done}"]
        command = [fuzzers / f"{reader}_fuzz", corpus, *amount, f"-seed={1000 * campaign.seed + run}", f"-timeout={LONGEST}",
                   f"-rss_limit_mb={MOST_MEMORY}", f"-max_len={READERS[reader][1]}", f"-artifact_prefix={found}/",
                   "-detect_leaks=0", "-print_final_stats=1", "-verbosity=0"]
        with tempfile.TemporaryFile() as said:
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            code = subprocess.run([*map(str, command)], stdout=subprocess.DEVNULL, stderr=said,
                                  env=dict(os.environ, ASAN_OPTIONS=SANITIZERS), check=False).returncode
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            said.seek(-min(said.tell(), LAST), os.SEEK_END)
            last = said.read().decode(errors="replace")
        made = re.search(r"number_of_executed_units: +(\d+)", last)
        count = int(made[1]) if made else 0
        processor = round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        campaign.count(reader, SECONDS, run, f"{processor} s", times=processor)  # first: each count may write the table
        campaign.count(reader, "inputs read or refused", run, f"{count} inputs", times=count)
        done, used = done + max(count, 1), used + max(processor, 1)
        if code:
            faults += 1
            campaign.count(reader, "faults", run, "\n".join(last.splitlines()[-40:]))


def body(campaign):
    if campaign.options.seconds:
        campaign.about_n = f"{campaign.options.seconds} s each"
    for reader in campaign.options.readers:
        fuzz(campaign, reader, campaign.options.fuzzers.resolve(), campaign.options.seconds)


def options(parser):
    parser.add_argument("--fuzzers", type=pathlib.Path, required=True, help="folder of the fuzz targets")
    parser.add_argument("--readers", nargs="+", choices=READERS, default=list(READERS), help="only these")
    parser.add_argument("--seconds", type=int, help="of the processor for each reader, in place of a number")


if __name__ == "__main__":
    OUTCOMES = ["inputs read or refused", SECONDS, "faults"]
    Campaign("reader of", OUTCOMES, OUTCOMES[2:], 10**7, options).run(body)
