#!/usr/bin/python3
"""jointcreep: the launcher; its package is where CMake says."""

import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = HERE / "@PACKAGE_FOLDER@"
sys.path[:0] = [str(PACKAGE), str(PACKAGE / "plots")]
sys.dont_write_bytecode = True

try:
    from jointcreep import command
except (ImportError, MemoryError, SystemError) as error:  # Python loses some errors for lack of memory
    if isinstance(error, ImportError) and "failed to map segment" not in str(error):
        raise
    sys.exit(print("jointcreep: out of memory", file=sys.stderr) or 5)

if __name__ == "__main__":
    sys.exit(command.main(sys.argv[1:], "@PROJECT_VERSION@", HERE))
