"""Fuzzes what reads scenes, field data, measurements and HDF5 files, with sanitizers (libFuzzer, tests/fuzz).

Each reader gets N inputs, or S seconds. The corpus begins with the files of data and tests that it reads, and is kept in
OUT/corpus; inputs that end a reader otherwise than by a refusal are kept in OUT/faults.
"""

import os
import pathlib
import re
import shutil
import subprocess

from campaign import ROOT, Campaign

LONGEST = 20  # s, that one input may take
MOST_MEMORY = 4096  # MB; what a reader leaves behind where it cannot throw adds up
READERS = {  # and the longest input: short ones are read some thousand times a second
    "scene": (["data/**/*.toml", "tests/pipeline/**/*.toml"], 2048),
    "field_data": (["tests/pipeline/kinds/*.csv", "tests/pipeline/kinds/*.geojson", "tests/fuzz/*.csv"], 4096),
    "measurements": (["tests/fuzz/*.csv", "data/**/*.csv"], 4096),
    "store": ([], 65536),
}


def begun(campaign, reader, corpus):
    """The corpus, with what is there to begin with."""
    corpus.mkdir(parents=True, exist_ok=True)
    patterns, longest = READERS[reader]
    for path in (path for pattern in patterns for path in ROOT.glob(pattern)):
        (corpus / path.name).write_bytes(path.read_bytes()[:longest])  # a part of a scene may be a scene, too
    if reader == "store":
        chain, folder = campaign.chain, campaign.chain.new_folder()
        network = chain.run("jointgen", ROOT / "pipelines/reliability/small.toml", folder / "network.h5")
        joints = chain.run("strength-averaging", network, folder / "joints.h5")
        chain.run("demsolve", joints, folder / "result.h5", "--checkpoint", folder / "kept.h5", "--no-creep")
        for path in folder.iterdir():
            shutil.copy(path, corpus)


def fuzz(campaign, reader, fuzzers, seconds):
    """Runs a target until it has had its number; each fault ends it, and it is started again."""
    corpus, found = campaign.out / "corpus" / reader, campaign.out / "faults" / f"fuzz-{reader}"
    begun(campaign, reader, corpus)
    found.mkdir(parents=True, exist_ok=True)
    left, faults = campaign.n, 0
    while left > 0 and faults < 20:
        amount = f"-max_total_time={seconds}" if seconds else f"-runs={left}"
        command = [fuzzers / f"{reader}_fuzz", corpus, amount, f"-seed={campaign.seed + faults}", f"-timeout={LONGEST}",
                   f"-rss_limit_mb={MOST_MEMORY}", f"-max_len={READERS[reader][1]}", f"-artifact_prefix={found}/",
                   "-detect_leaks=0", "-print_final_stats=1", "-verbosity=0"]
        environment = dict(os.environ, ASAN_OPTIONS="allocator_may_return_null=1")
        done = subprocess.run([*map(str, command)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                              errors="replace", env=environment)
        made = re.search(r"number_of_executed_units: +(\d+)", done.stderr)
        count = int(made[1]) if made else 0
        campaign.count(reader, "inputs read or refused", what=f"{count} inputs", times=count)
        if done.returncode:
            faults += 1
            campaign.count(reader, "faults", faults, "\n".join(done.stderr.splitlines()[-40:]))
        left -= max(count, 1)
        if seconds:
            break


def body(campaign):
    if campaign.options.seconds:
        campaign.about_n = f"{campaign.options.seconds} s each"
    for reader in campaign.options.readers:
        fuzz(campaign, reader, campaign.options.fuzzers.resolve(), campaign.options.seconds)


def options(parser):
    parser.add_argument("--fuzzers", type=pathlib.Path, required=True, help="folder of the fuzz targets")
    parser.add_argument("--readers", nargs="+", choices=READERS, default=list(READERS), help="only these")
    parser.add_argument("--seconds", type=int, help="time for each reader, in place of a number")


if __name__ == "__main__":
    OUTCOMES = ["inputs read or refused", "faults"]
    Campaign("reader of", OUTCOMES, OUTCOMES[1:], 10**7, options).run(body)
