"""What the tests of the Python module share: streams of their own, and child processes."""

import os
import signal
import subprocess
import sys
import time
import unittest

import numpy as np

import splinecast

#: Timeout of a wait for an event that must happen, long enough for a busy machine [s].
PATIENCE = 600.0

MS = 1_000_000
_count = 0


class StreamTest(unittest.TestCase):
    """A test with a stream, which it removes."""

    def setUp(self):
        global _count
        _count += 1
        self.name = f"test.{os.getpid()}.python-{_count}"
        self.addCleanup(self.remove)

    def remove(self):
        try:
            splinecast.remove(self.name)
        except splinecast.NoSuchStream:
            pass

    def recorded(self, dimensions=2, waypoints=20, **options):
        """A finished recorded stream, and a reader of it. Returns times, positions and reader."""
        times = np.arange(waypoints) * 100 * MS
        positions = np.sin(0.3 * np.arange(waypoints)[:, None] + np.arange(dimensions))
        with splinecast.Producer(self.name, dimensions=dimensions, clock="recorded", **options) as producer:
            producer.append_many(times, positions)
        with splinecast.Solver(self.name) as solver:
            self.assertTrue(solver.attach())
            solve(solver)
        return times, positions, splinecast.Reader(self.name)


def solve(solver):
    """Steps until all waypoints are consumed."""
    while solver.step().consumed:
        pass


def wait_for(condition):
    """Waits until a function returns something true. Returns that."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.002)
    raise AssertionError("what the test waits for did not happen")


def child(code, **how):
    """Starts a Python process that runs a program. It prints a line when it is ready."""
    return subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            **how)


def interrupt(process):
    """Sends SIGINT after the first line of a child. Returns its remaining output and messages."""
    process.stdout.readline()
    process.send_signal(signal.SIGINT)
    return process.communicate(timeout=PATIENCE)
