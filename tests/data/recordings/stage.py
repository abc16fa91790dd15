"""The stage of a recording: its streams, their processes and its recorder; the motions, and the list of cases."""

import contextlib
import math
import os
import signal
import subprocess
import sys
import time

import numpy as np

import splinecast

MS = 1_000_000
PATIENCE = 600.0
PERIOD = 20 * MS
LEAD = 200 * MS
FIRST_LEAD = 200 * MS  # in addition: a stream whose first waypoint is late does not begin
CASES = {}  # functions of a Stage, by name


def case(*arguments):
    """Registers a case: a function of a Stage, or one case for each argument."""
    def register(function):
        if not arguments:
            CASES[function.__name__] = function
        for argument in arguments:
            name = argument.partition("=")[0]
            CASES[f"{function.__name__}_{name}"] = lambda stage, a=argument: function(stage, a)
        return function
    return register


def circle(t):
    """Position, velocity and acceleration of a circle at t [ns], which begins at rest."""
    u = t * 1e-9 / 0.4
    s, v, a = (u * u / 2, u, 1.0) if u < 1 else (u - 0.5, 1.0, 0.0)
    at, along = np.array([math.cos(s), math.sin(s)]), np.array([-math.sin(s), math.cos(s)])
    return at, along * v / 0.4, (along * a - at * v * v) / 0.16


def pose(t):
    """Two positions, an angle in degrees that wraps, and a quaternion x y z w, with derivatives, at t [ns]."""
    x, v, a = circle(t)
    angle, rate, change = 170 + 40 * x[1], 40 * v[1], 40 * a[1]
    half = x[1] / 2
    q = [0.0, math.sin(half), 0.0, math.cos(half)]
    angular = [0.0, v[1], 0.0, 0.0]  # ω x y z in the first three places
    return (np.concatenate([x, [(angle + 180) % 360 - 180], q]), np.concatenate([v, [rate], angular]),
            np.concatenate([a, [change], [0.0, a[1], 0.0, 0.0]]))


class Stage:
    """One case: its streams, their processes and its recorder."""

    def __init__(self, name, path):
        self.name = f"test.{os.getpid()}.{name}"
        self.path = path
        self.law = f"{self.name}.law"
        self.solvers = {}
        self.children = []
        self.begin = 0
        self.sent = 0
        self.recorder = self.program("record", self.name, self.law, "-o", path, "--quiet", stderr=subprocess.DEVNULL)
        self.wait_for_recorder(lambda: os.path.exists(path))

    def program(self, *arguments, **options):
        child = subprocess.Popen(["splinecast", *arguments], **options)
        self.children.append(child)
        return child

    def solve(self, *options, stream=None):
        """Starts a solver process of the stream, or of the law."""
        stream = stream or self.name
        solver = self.program("solve", stream, "--quiet", *options, stderr=subprocess.DEVNULL)
        self.solvers.setdefault(stream, []).append(solver)
        return solver

    def produce(self, **options):
        options.setdefault("dimensions", 2)
        producer = splinecast.Producer(self.name, **options)
        if not producer.wait_for_solver(PATIENCE):
            raise TimeoutError(f"{self.name}: no solver")
        return producer

    def live(self, *options, **producer):
        """A solver process with these options, and the producer of a live stream."""
        self.solve(*options)
        return self.produce(**producer)

    def send(self, producer, count, at=circle, derivatives=False, lead=LEAD):
        """Sends the next waypoints, each `lead` before its time. Counts those that the ring or the solver refuses."""
        if not self.begin:
            self.begin = producer.now() + lead + FIRST_LEAD
        for _ in range(count):
            t = self.sent * PERIOD
            while producer.now() < self.begin + t - lead:
                time.sleep(0.001)
            x, v, a = at(t)
            try:
                producer.append(self.begin + t, x, *((v, a) if derivatives else ()))
            except splinecast.Refused as refused:
                print(f"{self.name}: {refused}", file=sys.stderr)
            self.sent += 1

    def pause(self, ms):
        """Sends nothing for this time: the waypoints of that time never come."""
        time.sleep(ms / 1000)
        self.sent += round(ms * MS / PERIOD)

    def wait_for_rest(self):
        """Waits until the curve is at rest behind its end."""
        reader = splinecast.Reader(self.name, timeout=PATIENCE)
        end = time.monotonic() + PATIENCE
        while reader.sample(time.monotonic_ns()).status is not splinecast.SampleStatus.HOLDING:
            if time.monotonic() > end:
                raise TimeoutError(f"{self.name}: does not come to rest")
            time.sleep(0.005)

    def command(self, name="operator"):
        return splinecast.RateCommander(self.law, name)

    def law_and_stream(self, *options, rate=1.0, largest=None):
        """A law, a stream that follows it, and the operator."""
        operator = self.command()
        operator.set_rate(rate, 0.005)
        if largest:
            # The program has no option for the largest rate.
            self.law_solver = splinecast.Solver(self.law, largest_rate=largest).start()
        else:
            self.solve(stream=self.law)
        splinecast.Reader(self.law, timeout=PATIENCE)
        self.solve(*options)
        return operator, self.produce(law=self.law)

    def wait_for_recorder(self, condition):
        while not condition():
            if self.recorder.poll() is not None:
                raise RuntimeError(f"{self.name}: the recorder ended with {self.recorder.returncode}")
            time.sleep(0.005)

    def is_observed(self):
        """Whether the recorder has mapped both regions of the stream."""
        with open(f"/proc/{self.recorder.pid}/maps", encoding="utf-8") as file:
            maps = file.read()
        return all(f"splinecast.{self.name}.{region}\n" in maps for region in ("waypoints", "spline"))

    def close(self):
        """Ends the recorder, which first reads the rest, and the solvers, and removes the streams."""
        self.wait_for_recorder(self.is_observed)
        self.recorder.send_signal(signal.SIGINT)
        if self.recorder.wait() != 0:
            raise RuntimeError(f"{self.name}: the recorder ended with {self.recorder.returncode}")
        self.children.remove(self.recorder)
        self.end()

    def end(self):
        for child in self.children:
            child.kill()
            child.wait()
        if hasattr(self, "law_solver"):
            self.law_solver.close()
        for stream in (self.name, self.law):
            with contextlib.suppress(splinecast.NoSuchStream):
                splinecast.remove(stream)


def in_a_child(work):
    """Runs `work` in a forked process, which ends by SIGKILL."""
    child = os.fork()
    if child == 0:
        work()
        os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)
