#!/usr/bin/env python3
"""The chunks of 2_policy.py followed by linear interpolation and jumps, beside what splinecast made of them.

    3_chunks_naive.py [STREAM] [--seconds S] [--recorder PROGRAM] [--plot FILE]      FILE: default chunks.svg

Runs 2_policy.py. Computes what a controller at 1 kHz sends that interpolates linearly between the actions of the newest
chunk, prints the largest step in velocity between two consecutive samples of both, and draws both.
"""

import argparse
import csv
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of the backend)

TICK = 1e-3  # s
SHOWN = (1.0, 3.0)  # s: the part of the motion that is drawn


def read_samples(path):
    """Times [s]; positions, velocities, accelerations, jerks of each joint; the statuses."""
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    values = np.array([row[1:-1] for row in rows], dtype=float).reshape(len(rows), 4, -1)
    assert header[1] == "p[0]" and header[-1] == "status", header
    return np.array([int(row[0]) for row in rows]) * 1e-9, values, np.array([row[-1] for row in rows])


def naive(times, chunks):
    """Positions at these times: linear between the actions of the newest chunk that has arrived."""
    positions = np.zeros((len(times), chunks["actions"].shape[2]))
    newest = -np.inf
    for arrival, observed, at, actions in zip(*(chunks[name] for name in ("arrival", "observed", "times", "actions"))):
        if observed < newest:
            continue
        newest, after = observed, times >= arrival
        for j in range(actions.shape[1]):
            positions[after, j] = np.interp(times[after], at, actions[:, j])
    return positions


def largest_steps(values, statuses):
    """The largest steps in velocity of the curve, and the largest that its acceleration and jerk explain."""
    velocity, acceleration, jerk = values[:, 1], np.abs(values[:, 2]), np.abs(values[:, 3])
    steps = np.abs(np.diff(velocity, axis=0))
    explained = TICK * (np.maximum(acceleration[:-1], acceleration[1:]) + TICK * np.maximum(jerk[:-1], jerk[1:]))
    is_kept = (statuses[1:] != "revised")[:, None]  # a commit that was late, which the status reports
    return (steps * is_kept).max(), ((steps - explained) * is_kept).max()


def draw(path, times, naive_positions, values, joint=0):
    """Draws position and velocity of one joint; commanded by both."""
    part = (times >= SHOWN[0]) & (times <= SHOWN[1])
    t = times[part]
    matplotlib.rcParams.update({"svg.hashsalt": "splinecast", "font.size": 9})
    figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(8, 5), constrained_layout=True)
    naive_velocity = np.gradient(naive_positions[part, joint], TICK)
    above.plot(t, naive_positions[part, joint], color="#c1272d", lw=0.8, label="linear, jumps to the newest chunk")
    above.plot(t, values[part, 0, joint], color="#0b62c4", lw=1.4, label="splinecast")
    below.plot(t, naive_velocity, color="#c1272d", lw=0.8)
    below.plot(t, values[part, 1, joint], color="#0b62c4", lw=1.4)
    below.set_ylim(-4, 4)
    above.set_ylabel("q1 [rad]")
    below.set_ylabel("velocity [rad/s], cut at ±4")
    below.set_xlabel("time [s]")
    above.legend(loc="lower left", frameon=False)
    for axes in (above, below):
        axes.grid(color="#d8dee4", lw=0.6)
    figure.savefig(path, metadata={"Date": None} if str(path).endswith(".svg") else None)


def compare(folder, plot):
    """Prints and draws both."""
    chunks = np.load(folder / "chunks.npz")
    times, values, statuses = read_samples(folder / "recorded.csv")
    positions = naive(times, chunks)
    # The velocity that a controller sends with a position: the difference to the one before.
    naive_step = np.abs(np.diff(positions, n=2, axis=0)).max() / TICK
    step, unexplained = largest_steps(values, statuses)
    print(f"largest step in velocity within 1 ms: {naive_step:.3f} rad/s with jumps, {step:.3f} rad/s with splinecast")
    print(f"steps beyond acceleration × 1 ms: {'none' if unexplained <= 1e-9 else f'{unexplained:g} rad/s'}")
    draw(plot, times - chunks["observed"].min(), positions, values)


def main():
    """Runs 2_policy.py in a temporary folder."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stream", nargs="?", default="arm")
    parser.add_argument("--seconds", default="6")
    parser.add_argument("--recorder", default=shutil.which("splinecast_recorder") or "build/examples/recorder")
    parser.add_argument("--plot", type=Path, default=Path("chunks.svg"))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, Path(__file__).with_name("2_policy.py"), options.stream, "--out", folder,
                        "--seconds", options.seconds, "--recorder", options.recorder], check=True)
        compare(Path(folder), options.plot)


if __name__ == "__main__":
    main()
