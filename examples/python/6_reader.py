#!/usr/bin/env python3
"""Samples a live stream four times a second, and its last half second once more at the end of the motion.

    6_reader.py [STREAM]      default: arm

Needs a producer and a solver: 5_producer.py, and splinecast solve STREAM. Start it before or after them.
"""

import sys
import time

import numpy as np

import splinecast

with splinecast.Reader(sys.argv[1] if len(sys.argv) > 1 else "arm", timeout=10) as reader:
    state = splinecast.State(reader.dimensions)
    while True:
        reader.sample(time.monotonic_ns(), out=state)  # no allocation
        if state.status.has_values:
            print(f"x = {state.position[0]:6.3f} m, vx = {state.velocity[0]:6.3f} m/s, {state.status}")
        progress = reader.progress()
        if progress and progress.is_finished and state.time > progress.newest:
            break
        time.sleep(0.25)

    times = progress.newest - np.arange(500, 0, -1) * 1_000_000  # ns
    block = reader.sample_many(times)  # all of one revision: (500, 4, D)
    print(f"largest speed of the last {len(block)} ms: {np.hypot(*block.values[:, 1].T).max():.3f} m/s")
