#!/usr/bin/python3
"""jointcreep: the launcher; its package is where CMake says."""

import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = HERE / "@PACKAGE_FOLDER@"
sys.path[:0] = [str(PACKAGE), str(PACKAGE / "plots")]
sys.dont_write_bytecode = True

from jointcreep import command  # noqa: E402

if __name__ == "__main__":
    sys.exit(command.main(sys.argv[1:], "@PROJECT_VERSION@", HERE))
