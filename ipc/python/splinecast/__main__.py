"""Runs the program splinecast: the one beside this package, in its prefix, or in PATH."""

import os
import shutil
import sys
from pathlib import Path


def program() -> str:
    """Return the path of the program."""
    package = Path(__file__).resolve().parent
    # build/release/python/splinecast and PREFIX/lib/python3.N/dist-packages/splinecast
    for prefix in (package.parents[1], package.parents[3]):
        beside = prefix / "bin" / "splinecast"
        if os.access(beside, os.X_OK):
            return str(beside)
    in_path = shutil.which("splinecast")
    if in_path is None:
        sys.exit(f"splinecast: the program is not in {package.parents[1]}/bin, {package.parents[3]}/bin or PATH")
    return in_path


if __name__ == "__main__":
    path = program()
    os.execv(path, [path, *sys.argv[1:]])
