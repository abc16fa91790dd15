#!/usr/bin/env python3
"""Measures how soon a stop is in force: values of docs/stopping.md.

    measure_stops.py [BUILD] [NAME ...]    all measurements, or those named, as lines of `name: value`

Needs the Python module (`./run python`) and a machine without other work. Uses streams and files with a prefix of this
process, and removes them. The campaign of requests measures the same beside other work.
"""

import math
import subprocess
import tempfile
import time
from pathlib import Path

from measured import PREFIX, PROGRAM, files, main, measurement, processes  # sets the path of the module splinecast

import splinecast

STREAM = f"{PREFIX}.stops"
COUNT = 300
PAUSE = 0.05  # s


def median_and_tail(times):
    """p50, p99 and the largest of some times in s."""
    times = sorted(times)
    p50, p99 = times[len(times) // 2], times[int(0.99 * len(times))]
    return f"p50 {1e3 * p50:.2f} ms, p99 {1e3 * p99:.2f} ms, largest {1e3 * times[-1]:.2f} ms of {len(times)}"


def motion(folder):
    """A file of a joint that swings for 90 s."""
    path = Path(folder) / "swing.csv"
    swing = (0.3 * (1 - math.cos(math.pi * i * 0.01)) for i in range(9000))
    path.write_text("t,x\n" + "".join(f"{i * 0.01:.2f},{x:.9f}\n" for i, x in enumerate(swing)), encoding="utf-8")
    return str(path)


def time_of_stop(stopper):
    """How long a stop takes until it is in force; then releases it."""
    begin = time.perf_counter()
    stopper.stop(wait=20)
    passed = time.perf_counter() - begin
    stopper.release(wait=20)
    time.sleep(PAUSE)
    return passed


def times_with(wanted):
    """Times of stops of new stoppers, and of those that the solver of `wanted` knows, with 5,000 other files."""
    new, known = [], []
    with tempfile.TemporaryDirectory() as folder:
        replay = [PROGRAM, "replay", motion(folder), "--stream", STREAM, "--on-error", "skip"]
        with files(5000), processes([[PROGRAM, "solve", wanted, "--quiet"], replay]):
            splinecast.Reader(STREAM, timeout=20)
            time.sleep(1)
            for i in range(COUNT):
                begin = time.perf_counter()
                with splinecast.Stopper(STREAM, f"new{i}") as stopper:
                    made = time.perf_counter() - begin
                    new.append(made + time_of_stop(stopper))
                    known.append(time_of_stop(stopper))
    subprocess.run([PROGRAM, "rm", "--now", STREAM], check=False, stdout=subprocess.DEVNULL)
    return f"new: {median_and_tail(new)}; known: {median_and_tail(known)}"


@measurement
def solver_of_one_stream():
    return times_with(STREAM)


@measurement
def solver_of_a_pattern():
    return times_with(f"{STREAM}*")


@measurement
def solver_of_a_pattern_that_the_files_match():
    return times_with(f"{PREFIX}*")


if __name__ == "__main__":
    main()
