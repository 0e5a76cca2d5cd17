"""What ends a command with a message."""

import errno
import mmap


class NotWanted(Exception):
    """A file or an option is not as expected: exit code 2."""


class NotDone(Exception):
    """Runs could not be made, though the study is right: exit code 4. The same command makes those that are missing."""


NEEDED = 400 * 2**20  # bytes of address space: OpenBLAS's buffer, and libraries that are loaded later


def lacks_memory(error):
    """Whether an exception says that there is too little memory; the loader of libraries says it in its own words."""
    return isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM or \
        isinstance(error, ImportError) and "failed to map segment" in str(error)


def have_linear_algebra():
    """Makes NumPy's linear algebra get its memory now. Without enough, OpenBLAS would ask for it again and again without an end, and
    other libraries may crash; here that is an OSError."""
    import numpy
    mmap.mmap(-1, NEEDED).close()
    numpy.linalg.solve(numpy.eye(1), numpy.ones(1))
