"""What the scripts measure_….py share: the build, the Python module, and a list of measurements.

A script runs as `measure_….py [BUILD] [NAME ...]`: all measurements, or those named, as lines of `name: value`.
"""

import contextlib
import os
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent.parent
args = sys.argv[1:]
BUILD = Path(args.pop(0)).resolve() if args and Path(args[0]).is_dir() else PROJECT / "build" / "release"
PROGRAM = str(BUILD / "bin" / "splinecast")
PREFIX = f"test.{os.getpid()}"  # of streams and files
sys.path.insert(0, str(BUILD / "python"))
measurements = {}


@contextlib.contextmanager
def processes(commands):
    """Runs commands until the end of the scope."""
    started = [subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for command in commands]
    try:
        yield started
    finally:
        for process in started:
            process.kill()
            process.wait()


@contextlib.contextmanager
def files(count):
    """Other files in shared memory."""
    paths = [f"/dev/shm/splinecast.{PREFIX}.other{i}.waypoints" for i in range(count)]
    for path in paths:
        Path(path).touch()
    try:
        yield
    finally:
        for path in paths:
            os.unlink(path)


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
