"""What the scripts measure_….py share: the build, the Python module, and a list of measurements.

A script runs as `measure_….py [BUILD] [NAME ...]`: all measurements, or those named, as lines of `name: value`.
"""

import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent.parent
args = sys.argv[1:]
BUILD = Path(args.pop(0)).resolve() if args and Path(args[0]).is_dir() else PROJECT / "build" / "release"
PROGRAM = str(BUILD / "bin" / "splinecast")
sys.path.insert(0, str(BUILD / "python"))
measurements = {}


def measurement(function):
    """Adds a function without arguments to the list."""
    measurements[function.__name__] = function
    return function


def main():
    unknown = [name for name in args if name not in measurements]
    if unknown:
        sys.exit(f"there is no measurement {unknown[0]}; there are {', '.join(measurements)}")
    for name in args or measurements:
        print(f"{name}: {measurements[name]()}", flush=True)
