#!/usr/bin/python3
"""How long a study takes on one core and on two, and how much of that is not the programs'.

    pace.py PROGRAMS OUT [--runs 1000]

The overhead is the wall time on one core over the time of the programs, less 1: the time that jointcreep waits for them, in
times.csv; and the same of processor time, which other work on the machine changes less. The time of a study ends with its answers and
pictures, which take the same for any number of runs.
"""

import resource
import time

import jointcreep
import slope


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main():
    arguments = slope.options(__doc__)
    seconds, programs, processor, folders = {}, {}, {}, {}
    for jobs in (1, 2):
        file, folders[jobs] = slope.written(arguments, f"pace-{jobs}")
        begin, processor_before = time.monotonic(), processor_seconds()
        slope.made(arguments, file, folders[jobs], jobs)
        seconds[jobs] = time.monotonic() - begin
        processor[jobs] = processor_seconds() - processor_before
        times = jointcreep.read(folders[jobs]).times
        programs[jobs] = times["program_seconds"].sum()
        processor[jobs] /= times["processor_seconds"].sum()
        begin = time.monotonic()
        slope.made(arguments, file, folders[jobs], jobs)  # all runs are there
        answers = time.monotonic() - begin
        print(f"{jobs} at a time: {seconds[jobs]:.1f} s for {arguments.runs} runs; programs {programs[jobs]:.1f} s; "
              f"answers alone {answers:.1f} s", flush=True)
    print(f"two cores: {seconds[1] / seconds[2]:.2f} times the pace; overhead {100 * (seconds[1] / programs[1] - 1):.1f} percent, "
          f"of processor time {100 * (processor[1] - 1):.1f} percent; differing: {', '.join(slope.differing(folders[1], folders[2])) or 'nothing'}")


if __name__ == "__main__":
    main()
