#!/usr/bin/python3
"""jointcreep: the launcher; its package is where CMake says."""

import errno
import os
import sys

sys.dont_write_bytecode = True
command = None

try:
    import pathlib

    HERE = pathlib.Path(__file__).resolve().parent
    PACKAGE = HERE / "@PACKAGE_FOLDER@"
    sys.path[:0] = [str(PACKAGE), str(PACKAGE / "plots")]

    from jointcreep import command
except KeyboardInterrupt:
    os._exit(130)
except (ImportError, MemoryError, OSError, SystemError) as error:  # Python loses some errors for lack of memory
    if isinstance(error, ImportError) and "failed to map segment" not in str(error) or \
            isinstance(error, OSError) and error.errno != errno.ENOMEM:
        raise

if not command:  # here, where the exception is gone with what it held
    os.write(2, b"jointcreep: out of memory\n")
    os._exit(5)

if __name__ == "__main__":
    sys.exit(command.main(sys.argv[1:], "@PROJECT_VERSION@", HERE))
