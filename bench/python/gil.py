#!/usr/bin/env python3
"""Measures how regularly a Python thread samples at 1 kHz beside threads that hold the GIL.

    gil.py [--seconds S]

Needs the module in PYTHONPATH. Prints percentiles of the period between two samples of a Python thread with a tick of
1 ms, for S seconds (10) each:

    alone       no other thread
    loop        beside a thread in a loop of pure Python, which offers the GIL every 5 ms (sys.getswitchinterval)
    call        beside a thread that calls a C function that holds the GIL for 50 ms, and then pauses for 50 ms
    process     as `loop`, but the other thread is in another process
"""

import argparse
import ctypes
import os
import subprocess
import sys
import threading
import time

import numpy as np

import splinecast

TICK = 1_000_000  # ns
HOLD = 0.05  # s
PERCENTILES = (50, 90, 99, 99.9, 100)


def in_a_loop(is_over):
    """Pure Python."""
    count = 0
    while not is_over():
        count += 1


def in_calls(is_over):
    """Calls of 50 ms, which hold the GIL as those of an extension module do, with pauses of 50 ms."""
    hold_gil = ctypes.PyDLL(None).usleep  # PyDLL: without releasing the GIL
    while not is_over():
        hold_gil(int(HOLD * 1e6))
        time.sleep(HOLD)


def periods_of(reader, seconds):
    """Periods between consecutive samples [ns] of a loop with a tick of 1 ms. Ticks that it misses are left out."""
    state, at = splinecast.State(reader.dimensions), []
    begin = now = time.monotonic_ns()
    while now - begin < seconds * 1e9:
        tick = begin + ((now - begin) // TICK + 1) * TICK
        time.sleep((tick - now) * 1e-9)
        reader.sample(tick, state)
        now = time.monotonic_ns()
        at.append(now)
    return np.diff(at)


def beside(work, reader, seconds):
    """The periods while another thread does this work."""
    over = threading.Event()
    thread = threading.Thread(target=work, args=(over.is_set,))
    thread.start()
    try:
        return periods_of(reader, seconds)
    finally:
        over.set()
        thread.join()


def beside_process(reader, seconds):
    """The periods while another process runs pure Python."""
    other = subprocess.Popen([sys.executable, __file__, "--loop"])
    try:
        return periods_of(reader, seconds)
    finally:
        other.terminate()
        other.wait()


def precise_sleep():
    """Sets the timer slack of this thread to 1 ns: else each sleep is up to 50 µs longer."""
    ctypes.CDLL(None).prctl(29, 1, 0, 0, 0)  # PR_SET_TIMERSLACK


def main():
    """Prints a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--loop", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.loop:
        parent = os.getppid()
        in_a_loop(lambda: os.getppid() != parent)  # also ends if the parent is killed
    precise_sleep()
    stream = f"bench.{os.getpid()}.gil"
    with splinecast.Solver(stream) as solver, splinecast.Producer(stream, dimensions=7, clock="recorded") as producer:
        solver.attach()
        producer.append_many(range(0, 100_000_000, 10_000_000), np.zeros((10, 7)))
        solver.step()
        reader = splinecast.Reader(stream)
        cases = {"alone": lambda: periods_of(reader, options.seconds),
                 "loop": lambda: beside(in_a_loop, reader, options.seconds),
                 "call": lambda: beside(in_calls, reader, options.seconds),
                 "process": lambda: beside_process(reader, options.seconds)}
        print("period [ms] " + " ".join(f"{p:>7g} %" for p in PERCENTILES))
        for name, measure in cases.items():
            print(f"{name:11} " + " ".join(f"{p:9.2f}" for p in np.percentile(measure(), PERCENTILES) * 1e-6))
    splinecast.remove(stream)


if __name__ == "__main__":
    main()
