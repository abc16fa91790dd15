#!/usr/bin/env python3
"""A policy at 30 Hz whose chunks of 8 actions arrive 26 to 146 ms late, and a C++ controller at 1 kHz.

    2_policy.py [STREAM] [--seconds S] [--seed N] [--recorder PROGRAM] [--out FOLDER]

Each chunk replaces the future of the curve. Three processes: this one, `splinecast solve`, and the controller
(examples/9_recorder.cpp). Writes recorded.csv, what the controller sampled, and chunks.npz, the chunks as they arrived,
to FOLDER (default: the current one). 3_chunks_naive.py draws them.
"""

import argparse
import heapq
import shutil
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import splinecast

RATE = 30  # chunks per second
ACTIONS = 8  # of a chunk, 1 / RATE apart
LATE, SPREAD = 0.086, 0.060  # s: from the observation to the arrival of the chunk
BLEND = 0.080  # s: least duration of the transition onto a chunk
JOINTS = 7
HOME = np.zeros(JOINTS)


@dataclass(order=True)
class Chunk:
    """Actions that the policy computed from an observation."""

    arrival: float  # s, CLOCK_MONOTONIC
    observed: float
    times: np.ndarray
    actions: np.ndarray  # [time][joint]


class Policy:
    """A stand-in for a learned policy: consecutive chunks disagree, as those of a noisy policy do."""

    def __init__(self, begin, seed):
        self.begin = begin
        self.random = np.random.default_rng(seed)

    def infer(self, observed):
        """The chunk for an observation, and when it arrives."""
        times = observed + np.arange(1, ACTIONS + 1) / RATE
        u = np.maximum(times - self.begin, 0)[:, None]
        path = 0.5 * (1 - np.cos(2 * np.pi * 0.3 * u)) * np.sin(1.0 + np.arange(JOINTS) + 0.9 * u)
        bias = self.random.normal(0, 0.02, JOINTS)  # this chunk's opinion
        noise = self.random.normal(0, 0.002, (ACTIONS, JOINTS))
        late = LATE + self.random.uniform(-SPREAD, SPREAD)
        return Chunk(observed + late, observed, times, path + bias + noise)


def arrivals(policy, begin, seconds):
    """The chunks in the order of their arrival."""
    waiting = [policy.infer(begin + i / RATE) for i in range(int(seconds * RATE))]
    heapq.heapify(waiting)
    while waiting:
        yield heapq.heappop(waiting)


def switch_to(arm, chunk):
    """Lets the curve leave for a chunk that has just arrived. Returns its item; None if it is too old."""
    if chunk.times[-1] * 1e9 <= arm.earliest:
        return None
    # As soon as possible. The actions whose time has passed until then are passed over.
    return arm.replace_from(times=chunk.times, positions=chunk.actions, blend=BLEND)


def follow(arm, chunks):
    """Switches to each chunk as it arrives. Returns what became of them: in force, too old, refused, ..."""
    newest, counts = -np.inf, Counter()
    for chunk in chunks:
        time.sleep(max(0.0, chunk.arrival - time.monotonic()))
        if chunk.observed < newest:  # overtaken by a chunk of a later observation
            counts["too old"] += 1
            continue
        try:
            item = switch_to(arm, chunk)
        except splinecast.Refused as refused:  # too late: this process was held up; the next chunk comes soon
            print(refused)
            counts["refused at once"] += 1
            continue
        if item is None:
            counts["too old"] += 1
            continue
        outcome = arm.wait_outcome(item, timeout=1)  # the solver takes it within milliseconds
        counts[str(outcome.kind)] += 1
        newest = chunk.observed
    return counts


def save(chunks, path):
    """Writes the chunks to a file of NumPy."""
    np.savez(path, arrival=[c.arrival for c in chunks], observed=[c.observed for c in chunks],
             times=[c.times for c in chunks], actions=[c.actions for c in chunks])


def run(options):
    """Starts the controller, then follows the policy."""
    names = [f"q{j + 1}" for j in range(JOINTS)]
    with splinecast.Producer(options.stream, names=names, units="rad") as arm:
        if not arm.wait_for_solver(60):
            sys.exit("no solver")
        begin = time.monotonic() + 0.2
        arm.append(begin, HOME)  # the stream begins at rest
        controller = subprocess.Popen([options.recorder, options.stream, str(options.seconds + 0.5),
                                       str(options.out / "recorded.csv")])
        chunks = list(arrivals(Policy(begin, options.seed), begin, options.seconds))
        counts = follow(arm, chunks)
        arm.finish("halt")
        arm.wait_until_consumed(10)
        refused = arm.refusals()
    if controller.wait(60) != 0:
        sys.exit("the controller has failed")
    save(chunks, options.out / "chunks.npz")
    said = ", ".join(f"{count} {what}" for what, count in counts.most_common())
    print(f"{len(chunks)} chunks: {said}; the solver refused {len(refused)} items")


def main():
    """Runs the solver as a process."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stream", nargs="?", default="arm")
    parser.add_argument("--seconds", type=float, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--recorder", default=shutil.which("splinecast_recorder") or "build/examples/recorder")
    parser.add_argument("--out", type=Path, default=Path())
    options = parser.parse_args()
    solver = subprocess.Popen([sys.executable, "-m", "splinecast", "solve", options.stream, "--quiet",
                               "--max-velocity", "4", "--max-acceleration", "60"])
    try:
        run(options)
    finally:
        solver.terminate()
        solver.wait()
        splinecast.remove(options.stream)


if __name__ == "__main__":
    main()
