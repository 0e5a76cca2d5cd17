"""Sweeps the size of files, open files and the room of a disk, in N steps each, for each program.

A run gives the bytes of the run without a limit, or ends with a message, a code other than 0, and no file under the name of its
output, or the one from before. The disk is a small one in memory (tmpfs), which wants root or user namespaces.
"""

import resource
import shutil

from campaign import LONGEST, Campaign, contents, ended
from kills import OLD, files, jobs

MOST_FILES = 12  # more than any program opens at once
ON_DISK = ("sh", "-c", 'mount -t tmpfs -o size="$0" none "$1" && cp -a "$2"/. "$1" || exit 99; cd "$1" && shift 2 && "$@"; '
           'code=$?; rm -rf "$OLDPWD"/*; cp -a . "$OLDPWD"; exit $code')


def private_mounts():
    """What a command that mounts something for itself alone stands behind; nothing if that is not possible."""
    for options in ([], ["--propagation", "unchanged"], ["--map-root-user"]):  # the second within a chroot
        command = ["unshare", "--mount", *options]
        if ended([*command, "mount", "-t", "tmpfs", "none", "/mnt"], LONGEST).code == 0:
            return command
    return []


def outcome(job, done, folder, old):
    """What came of a run, and what is wrong with it."""
    found, new = files(folder), job.checkpoint
    if done.code == 0:
        return ("same bytes", "") if found == job.whole else ("other bytes", f"code 0, and {[*found]} are not as wanted")
    wanted = {**job.given, **old}
    if not isinstance(done.code, int) or done.code < 0:
        return "signal or hang", str(done)
    if not done.is_refusal(job.name.split()[0], range(1, 256)):
        return "no message", str(done)
    if {name: content for name, content in found.items() if name != new} != wanted:
        return "files left", f"{done}; {[*found]}"
    return "refused", str(done)


def pages(sizes):
    """What files of these sizes take on a disk in memory [bytes]."""
    page = resource.getpagesize()
    return sum(-(-size // page) * page for size in sizes)


def trials(campaign, job):
    """Limits, each as what it is called, its number, what sets it, and the room on the disk besides what is there. A disk
    with twice the room of what is written is enough, one with less room than that is not."""
    written = [len(content) for name, content in job.whole.items() if name not in job.given]
    largest, room = max(written) + 1, 2 * pages(written)
    for step in range(campaign.n):
        size = largest * step // max(1, campaign.n - 1)
        yield "size of files", size, lambda size=size: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)), None
        count = MOST_FILES * step // max(1, campaign.n - 1)
        yield "open files", count, lambda count=count: resource.setrlimit(resource.RLIMIT_NOFILE, (count, count)), None
        size = room * step // max(1, campaign.n - 1)
        yield "disk", size, lambda: None, size


def body(campaign):
    alone = private_mounts()
    for job in jobs(campaign.chain):
        folder = campaign.chain.new_folder()
        job.undisturbed(folder)
        for what, number, limit, disk in trials(campaign, job):
            folder = campaign.chain.new_folder()
            job.fill(folder)
            old = {name: OLD for name in job.outputs} if campaign.random(job.name, what, number).random() < 0.5 else {}
            for name, content in old.items():
                (folder / name).write_bytes(content)
            if disk is None:
                done = ended(job.command, LONGEST, limit, cwd=folder)
            else:
                mounted = campaign.chain.new_folder()
                disk += pages(map(len, contents(folder).values()))
                done = ended([*alone, *ON_DISK, disk, mounted, folder, *job.command], LONGEST, cwd=folder) if alone else None
            came, why = outcome(job, done, folder, old) if done else ("not possible", "")
            campaign.count(f"{what}, {job.name}", came, number, why, folder)
            shutil.rmtree(folder)


if __name__ == "__main__":
    OUTCOMES = ["same bytes", "refused", "not possible", "other bytes", "files left", "no message", "signal or hang"]
    Campaign("limits of", OUTCOMES, OUTCOMES[3:], 100).run(body)
