#!/usr/bin/env python3
"""Appends the waypoints of a live motion, a circle of 2 s at 100 Hz, each 200 ms before its time.

    5_producer.py [STREAM] [--law LAW]      default: arm, without a time law

Needs a solver in a process of its own: splinecast solve STREAM. 6_reader.py and examples/2_controller.cpp read it. With
a law: splinecast solve STREAM LAW, and splinecast rate LAW 1.
"""

import argparse
import sys
import time

import numpy as np

import splinecast

DURATION = 2.0  # s
INTERVAL = 0.01  # s
LEAD = 0.2  # s: at least freeze-ahead (5 ms) and K + 1 (9) intervals


def circle(u):
    """The position u seconds after the begin: once around, from rest to rest."""
    w = u / DURATION
    angle = 2 * np.pi * w**3 * (10 - 15 * w + 6 * w**2)
    return 0.3 * np.cos(angle), 0.3 * np.sin(angle)


def wait_until(arm, t):
    """Waits until the stream's clock shows t, in s. The clock of a time law may be slow, or held."""
    while (rest := t - arm.now() * 1e-9) > 0:
        time.sleep(min(rest, 0.005))


parser = argparse.ArgumentParser()
parser.add_argument("stream", nargs="?", default="arm")
parser.add_argument("--law")
options = parser.parse_args()
with splinecast.Producer(options.stream, names=["x", "y"], units="m", law=options.law) as arm:
    if not arm.wait_for_solver(10):
        sys.exit(f"no solver: splinecast solve {arm.stream}")
    begin = arm.now() * 1e-9 + LEAD  # times count from now, not from earlier
    for i in range(round(DURATION / INTERVAL) + 1):
        u = i * INTERVAL
        wait_until(arm, begin + u - LEAD)
        try:
            arm.append(begin + u, circle(u), timeout=1.0)  # waits up to 1 s if the ring is full
        except splinecast.Refused as refused:
            if refused.status != splinecast.AppendStatus.PAST:
                raise
            print(refused)  # this process was held up: the motion continues with the next waypoint
    arm.finish("halt")
    arm.wait_until_consumed(10)
    for refusal in arm.refusals():
        print(refusal)
    print(f"{arm.appended - 1} waypoints sent")  # the finish is an item, too
