#!/usr/bin/env python3
"""Measures how live streams end and stop: values of before_after.json.

    measure_ends.py [BUILD] [NAME ...]    all measurements, or those named, as lines of `name: value`

Needs the Python module (`./run python`) and NumPy. Uses streams with a prefix of this process, and removes them.
"""

import json
import os
import signal
import subprocess
import tempfile
import time

import numpy as np

from measured import PROGRAM, main, measurement  # sets the path of the module splinecast

import splinecast


def values_of(node, name):
    """The values of a name anywhere in a JSON document."""
    children = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    if isinstance(node, dict) and name in node:
        yield node[name]
    for child in children:
        yield from values_of(child, name)


class Life:
    """A live stream with its solver; times are in seconds after its begin."""

    def __init__(self, kinds="linear", dimensions=1, **options):
        self.stream = f"test.{os.getpid()}.end"
        self.producer = splinecast.Producer(self.stream, kinds=kinds, dimensions=dimensions)
        self.solver = splinecast.Solver(self.stream, history=60.0, **options).start()
        self.reader = splinecast.Reader(self.stream, timeout=10)
        self.begin = time.monotonic_ns() + 300_000_000

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.reader.close()
        self.solver.close()
        self.producer.close()
        subprocess.run([PROGRAM, "rm", self.stream], check=False, stdout=subprocess.DEVNULL)

    def at(self, t):
        return self.begin + round(t * 1e9)

    def sleep_until(self, t):
        time.sleep(max(0.0, (self.at(t) - time.monotonic_ns()) * 1e-9))

    def send(self, times, positions, lead):
        """Sends waypoints, each `lead` before its time; those that are refused are left out."""
        for t, x in zip(times, positions):
            self.sleep_until(t - lead)
            try:
                self.producer.append(self.at(t), x)
            except splinecast.Refused:
                pass
        time.sleep(0.05)

    def values(self, start, end):
        """The curve between two times: [time][derivative][dimension]."""
        times = np.arange(self.at(start), self.at(end), 200_000, dtype=np.int64)
        return self.reader.sample_many(times).values

    def count(self, name):
        """A counter that `info` shows."""
        shown = subprocess.run([PROGRAM, "info", self.stream, "--json"], check=False, capture_output=True, text=True)
        return next(value for value in values_of(json.loads(shown.stdout), name))

    def peak(self, start, end, derivative):
        return np.abs(self.values(start, end)[:, derivative]).max()


LINE = np.arange(0, 1.0001, 0.02)


def bounded_line(finish_at):
    limits = {"lower": 0.0, "upper": 1.0}
    with Life(limits=limits) as life:
        life.send(LINE, LINE, 0.1)
        life.sleep_until(1.0 + finish_at)
        life.producer.finish()
        time.sleep(0.3)
        curve = life.values(0.5, 10)
        least, greatest = curve[:, 0, 0].min(), curve[:, 0, 0].max()
        return f"{least:.3g} to {greatest:.4g}, v = {abs(curve[-1, 1, 0]):.2g}"


@measurement
def bounds_0_to_1_finish_20_ms_before_the_last_waypoint():
    return bounded_line(-0.02)


@measurement
def bounds_0_to_1_finish_50_ms_after_the_last_waypoint():
    return bounded_line(0.05)


@measurement
def largest_acceleration_of_a_finish_with_limit_20():
    with Life(limits={"acceleration": 20.0}) as life:
        life.send(LINE, LINE, 0.3)
        life.producer.finish("halt")
        time.sleep(0.2)
        return f"{life.peak(0.5, 8, 2):.4g}"


@measurement
def largest_acceleration_of_a_stop_then_a_finish_with_limit_20():
    with Life(limits={"acceleration": 20.0}) as life:
        life.send(LINE[:30], LINE[:30], 0.2)
        life.producer.replace_from(life.at(0.5))
        time.sleep(0.05)
        rest = life.values(5, 5.001)[0, 0, 0]
        life.producer.finish()
        time.sleep(0.2)
        way = abs(life.values(30, 30.001)[0, 0, 0] - rest)
        return f"{life.peak(0.3, 8, 2):.4g}, moved {way:.2g} after the stop"


@measurement
def waypoints_passed_over_by_a_gripper_outside_its_bounds():
    with Life(limits={"lower": 0.0, "upper": 0.08, "acceleration": 1.0}) as life:
        life.producer.start_from(life.at(0), -0.0005, 0.0, 0.0)
        times = 0.5 + 0.02 * np.arange(51)
        life.send(times, 0.04 * (1 - np.cos(np.pi * np.arange(51) / 50)), 0.3)
        life.producer.finish()
        time.sleep(0.3)
        passed = life.count("passed_over")
        return f"{passed} of 51, ends at {life.values(60, 60.001)[0, 0, 0]:.3g}"


def step_in_a_sine(beyond):
    with Life(limits={"velocity": 2.5, "acceleration": 12.0}, beyond=beyond) as life:
        times = 0.01 * np.arange(301)
        x = 0.3 * np.sin(2 * times) + np.where(times > 1.5, 0.3, 0.0)
        life.send(times, x, 0.3)
        life.producer.finish()
        time.sleep(0.3)
        refused = len(life.producer.refusals())
        return f"{refused} of 301 refused, v {life.peak(0, 8, 1):.3g}, a {life.peak(0, 8, 2):.4g}"


@measurement
def step_of_03_refuse():
    return step_in_a_sine("refuse")


@measurement
def step_of_03_enter():
    return step_in_a_sine("enter")


@measurement
def largest_angular_acceleration_of_a_stop_with_limit_3():
    with Life("quaternion", 4, limits={"acceleration": 3.0}) as life:
        times = 0.02 * np.arange(60)
        angles = 0.75 * times  # half the angle of the rotation
        zeros = np.zeros_like(angles)
        life.send(times, np.stack([np.sin(angles), zeros, zeros, np.cos(angles)], 1), 0.2)
        time.sleep(1.5)
        curve = life.values(1.15, 2.5)
        q, second = curve[:, 0], curve[:, 2]
        across = second - (second * q).sum(1)[:, None] * q
        return f"{2 * np.linalg.norm(across, axis=1).max():.3g}"


def replayed(x, acceleration, interrupted_after=None):
    """The largest acceleration from the last waypoint or the signal on, of a replay by the command line."""
    stream = f"test.{os.getpid()}.replay"
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
        file.write("t,x\n" + "".join(f"{i / 100},{v:.9f}\n" for i, v in enumerate(x)))
        file.flush()
        limits = ["--max-acceleration", str(acceleration)] if acceleration else []
        solve = [PROGRAM, "solve", stream, "--quiet", "--history", "60", *limits]
        solver = subprocess.Popen(solve)
        replay = subprocess.Popen([PROGRAM, "replay", file.name, "--stream", stream], stderr=subprocess.DEVNULL)
        with splinecast.Reader(stream, timeout=10) as reader:
            if interrupted_after:
                time.sleep(interrupted_after)
                replay.send_signal(signal.SIGINT)
            replay.wait()
            time.sleep(1)
            end = time.monotonic_ns()
            begin = end - round(1e9 * (len(x) / 100 + 1))
            values = reader.sample_many(np.arange(begin, end, 200_000, dtype=np.int64)).values
        solver.terminate()
        solver.wait()
        subprocess.run([PROGRAM, "rm", stream], check=False, stdout=subprocess.DEVNULL)
        return f"{np.abs(values[2000:, 2]).max():.4g}"


@measurement
def replay_of_a_line_limit_10():
    return replayed(np.arange(200) / 100, 10)


@measurement
def replay_of_sines_with_a_largest_acceleration_of_1_limit_1_1():
    return replayed(np.sin(np.arange(300) / 100), 1.1)


@measurement
def signal_to_a_replay_whose_motion_has_1_without_limits():
    return replayed(np.sin(np.arange(600) / 100), 0, 2.0)


if __name__ == "__main__":
    main()
