#!/usr/bin/env python3
"""Compares the calls of the Python module with the same calls in C++.

    overhead.py BENCH [--blocks N]      BENCH: build/release/bin/splinecast_bench

Needs the module in PYTHONPATH. Runs N blocks (25). Each block measures every row once in C++ and once in Python, one
directly after the other, because the speed of the machine changes more slowly than a block. Prints the medians of the
times, and of the differences and ratios within a block:

    sample        one sample of 7 dimensions, times 1 ms apart, knots about 10 ms apart
    append        one waypoint of 7 dimensions as a float64 array, into a ring that a solver in the same thread empties
                  outside of the measured time
    sample_many   1,000 times of 7 dimensions in one call, 2 ms apart

A time in Python includes the loop of `timeit` around the call.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import timeit

import numpy as np

import splinecast

DIMENSIONS = 7
KNOTS = 4096
HORIZON = 1000
BATCH = 512
ROWS = {"sample": ("^sample/dims:7$", 1), "append": ("^producer_append/dims:7/", BATCH),
        "sample_many": ("^horizon/dims:7/times:1000$", 1)}
TARGETS = {"sample": "at most 1.5 µs more", "append": "at most 2 µs more", "sample_many": "at most 1.3 times"}


def waypoints():
    """Times [ns] and positions of a smooth motion at 100 Hz with jitter: those of bench/harness/bench_stream.cpp."""
    i = np.arange(KNOTS)
    intervals = 9_000_000 + i * 7919 % 2_000_000
    times = np.concatenate([[0], np.cumsum(intervals)[:-1]])
    positions = np.sin(2e-9 * times[:, None] + np.arange(DIMENSIONS))
    return times, positions


def in_cpp(bench, row):
    """Seconds per call in C++."""
    pattern, calls = ROWS[row]
    printed = subprocess.run([bench, f"--benchmark_filter={pattern}", "--benchmark_min_time=0.1",
                              "--benchmark_format=json"], check=True, stdout=subprocess.PIPE).stdout
    runs = json.loads(printed)["benchmarks"]
    assert len(runs) == 1 and runs[0]["time_unit"] == "ns", runs
    return runs[0]["real_time"] * 1e-9 / calls


class Stream:
    """A recorded stream of this process, with a solver in the same thread; removed at the end."""

    def __init__(self, name):
        self.name = f"bench.{os.getpid()}.{name}"
        self.producer = splinecast.Producer(self.name, dimensions=DIMENSIONS, clock="recorded", start="natural")
        self.solver = splinecast.Solver(self.name, wake=False, capacity=KNOTS)
        assert self.solver.attach()

    def drain(self):
        """Consumes everything that the ring has."""
        while self.solver.step().consumed > 0:
            pass

    def remove(self):
        """Closes both roles and removes the stream."""
        self.producer.close()
        self.solver.close()
        splinecast.remove(self.name)


def solved():
    """A finished stream of all waypoints."""
    stream = Stream("solved")
    times, positions = waypoints()
    for i in range(0, KNOTS, BATCH):
        stream.producer.append_many(times[i:i + BATCH], positions[i:i + BATCH])
        stream.drain()
    stream.producer.finish("natural")
    stream.drain()
    return stream


class Sample:
    """Samples 1 ms apart."""

    def __init__(self, stream):
        self.reader = splinecast.Reader(stream.name)
        self.state = splinecast.State(DIMENSIONS)
        last = self.reader.progress().newest
        self.times = list(range(0, last, 1_000_000))

    def seconds(self):
        """Seconds per call."""
        sample, state = self.reader.sample, self.state

        def loop():
            for t in self.times:
                sample(t, state)
        took = timeit.timeit(loop, number=1)
        assert state.status.has_values
        return took / len(self.times)


class SampleMany:
    """Horizons of 1,000 times, 2 ms apart; the next one begins 1 ms later."""

    def __init__(self, stream):
        self.reader = splinecast.Reader(stream.name)
        even = np.arange(0, self.reader.progress().newest - 1_000_000, 2_000_000)
        self.horizons = [(even, even + 1_000_000)[i % 2][i // 2:i // 2 + HORIZON] for i in range(1000)]
        self.block = self.reader.sample_many(self.horizons[0])

    def seconds(self):
        """Seconds per call."""
        sample_many, block, horizons = self.reader.sample_many, self.block, self.horizons

        def loop():
            for horizon in horizons:
                sample_many(horizon, block)
        took = timeit.timeit(loop, number=1)
        assert block.revision > 0 and (block.status <= splinecast.SampleStatus.REVISED).all()
        return took / len(horizons)


class Append:
    """Batches of waypoints, each a float64 array, into a stream that has no end."""

    def __init__(self):
        self.stream = Stream("append")
        times, positions = waypoints()
        self.times, self.rows = times[:BATCH].tolist(), list(positions[:BATCH])
        self.next = 0

    def seconds(self):
        """Seconds per call."""
        append, took, batches = self.stream.producer.append, 0.0, 20
        for _ in range(batches):
            pairs = [(self.next + t, x) for t, x in zip(self.times, self.rows)]
            self.next = pairs[-1][0] + 10_000_000

            def loop(pairs=pairs):
                for t, x in pairs:
                    append(t, x)
            took += timeit.timeit(loop, number=1)
            self.stream.drain()
        return took / (batches * BATCH)


def measure(bench, blocks):
    """(seconds in C++, seconds in Python) of each block, by row."""
    stream, append = solved(), Append()
    cases = {"sample": Sample(stream), "append": append, "sample_many": SampleMany(stream)}
    found = {row: [] for row in cases}
    try:
        for block in range(-1, blocks):  # the first one warms up
            for row, case in cases.items():
                pair = in_cpp(bench, row), case.seconds()
                if block >= 0:
                    found[row].append(pair)
    finally:
        stream.remove()
        append.stream.remove()
    return found


def main():
    """Prints a table of medians."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bench")
    parser.add_argument("--blocks", type=int, default=25)
    options = parser.parse_args()
    found = measure(options.bench, options.blocks)
    print(f"medians of {options.blocks} blocks\n"
          f"{'call':12} {'C++ µs':>9} {'Python µs':>10} {'difference µs':>14} {'ratio':>7}   target")
    for row, pairs in found.items():
        cpp, python = (statistics.median(side) * 1e6 for side in zip(*pairs))
        difference = statistics.median(p - c for c, p in pairs) * 1e6
        ratio = statistics.median(p / c for c, p in pairs)
        print(f"{row:12} {cpp:9.3f} {python:10.3f} {difference:14.3f} {ratio:7.2f}   {TARGETS[row]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
