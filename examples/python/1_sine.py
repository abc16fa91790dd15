#!/usr/bin/env python3
"""A sine at 50 Hz: producer, solver and reader in one process.

    1_sine.py [STREAM]      default: arm

The solver runs in a background thread that never takes the GIL. `splinecast solve STREAM` is the same solver as a
process of its own.
"""

import sys
import threading
import time

import numpy as np

import splinecast

INTERVAL = 0.02  # s
LEAD = 0.25  # s: at least freeze-ahead (5 ms) and K + 1 (9) intervals
PERIOD = 2.0  # s
AMPLITUDES = np.array([0.3, -0.3, 0.1])  # rad


def position(u):
    """The positions u seconds after the begin. The motion begins and ends at rest."""
    return AMPLITUDES * np.cos(2 * np.pi * u / PERIOD)


def produce(arm, begin):
    """Appends two periods, each waypoint one lead before its time."""
    for i in range(round(2 * PERIOD / INTERVAL) + 1):
        u = i * INTERVAL
        time.sleep(max(0.0, begin + u - LEAD - time.monotonic()))
        try:
            arm.append(begin + u, position(u), timeout=1.0)  # waits up to 1 s if the ring is full
        except splinecast.Refused as refused:
            print(refused)  # this process was held up: the motion continues with the next waypoint


def watch(reader, begin):
    """Samples the curve every 0.48 s and compares it with the sine."""
    state = splinecast.State(reader.dimensions)
    for i in range(round(4 * PERIOD)):
        u = 0.21 + 0.48 * i
        time.sleep(max(0.0, begin + u - time.monotonic()))
        reader.sample(begin + u, out=state)  # allocates nothing
        if not state.status.has_values:
            continue
        error = np.abs(state.position - position(u)).max()
        print(f"{u:.2f} s: q1 = {state.position[0]:.3f} rad, {state.velocity[0]:.3f} rad/s, {state.status}, "
              f"{error:.1e} rad from the sine")


def run(stream):
    """Produces in a thread and watches in this one."""
    with splinecast.Solver(stream).start(), splinecast.Producer(stream, names=["q1", "q2", "q3"], units="rad") as arm:
        if not arm.wait_for_solver(10):
            sys.exit("no solver")
        begin = time.monotonic() + LEAD  # times count from now, not from earlier
        producing = threading.Thread(target=produce, args=(arm, begin))
        producing.start()
        with splinecast.Reader(stream, timeout=10) as reader:
            watch(reader, begin)
        producing.join()
        arm.finish("halt")
        arm.wait_until_consumed(10)
        print(f"{arm.appended - 1} waypoints, {len(arm.refusals())} refused")  # the finish is an item, too
    splinecast.remove(stream)


if __name__ == "__main__":
    run(sys.argv[1] if len(sys.argv) > 1 else "arm")
