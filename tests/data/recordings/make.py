#!/usr/bin/python3
"""Makes the recordings of this folder: small streams that end in each way that a stream can end.

    make.py FOLDER [CASE ...]    records all cases, or those named, as FOLDER/CASE.mcap, verifies each recording, and
                                 writes the numbers of verified segments to FOLDER/expected.json
    make.py --check              does the same in a temporary folder
    make.py --list               prints the names of the cases

Needs the Python module and the program of one build: PYTHONPATH and PATH as `./run python` says. Each case runs in a
process of its own, so that a case may kill its solver or its producer. Exits with 1 if a case fails, or if a recording
does not verify. A machine under load may refuse an item of a case, which then ends there.
"""

import contextlib
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np

import splinecast

MS = 1_000_000
PATIENCE = 600.0
PERIOD = 20 * MS
LEAD = 200 * MS
FIRST_LEAD = 200 * MS  # in addition: a stream whose first waypoint is late does not begin
FRESH = {"c2", "hermite", "quintic", "smoothing", "bessel", "akima", "makima", "pchip", "rounded"}
CASES = {}


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
        while not os.path.exists(path):
            if self.recorder.poll() is not None:
                raise RuntimeError(f"{self.name}: the recorder ended with {self.recorder.returncode}")
            time.sleep(0.005)

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

    def close(self):
        """Lets the recorder read everything, ends it and the solvers, and removes the streams."""
        time.sleep(0.15)
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


# Ends of live streams.


@case("halt", "clamped")
def finish(stage, end):
    producer = stage.live()
    stage.send(producer, 30)
    producer.finish(end)
    stage.wait_for_rest()


@case("halt", "clamped")
def finish_late(stage, end):
    """The finish arrives when the stop has begun."""
    producer = stage.live()
    stage.send(producer, 25)
    time.sleep(0.26)
    producer.finish(end)
    stage.wait_for_rest()


@case()
def finish_with_limits(stage):
    producer = stage.live("--max-velocity", "3", "--max-acceleration", "20", "--max-jerk", "400",
                          "--bounds", "-1.1:1.1")
    stage.send(producer, 30)
    producer.finish()
    stage.wait_for_rest()


@case()
def finish_at_once(stage):
    """One waypoint, and the finish."""
    producer = stage.live()
    stage.send(producer, 1)
    producer.finish()
    stage.wait_for_rest()


@case()
def stop(stage):
    producer = stage.live()
    stage.send(producer, 30)
    producer.replace_from(0)
    stage.wait_for_rest()


@case()
def stop_with_limits(stage):
    producer = stage.live("--max-acceleration", "20", "--max-jerk", "400", "--stop-time", "0.1")
    stage.send(producer, 30)
    producer.replace_from(0)
    stage.wait_for_rest()


@case()
def stop_then_finish(stage):
    producer = stage.live()
    stage.send(producer, 30)
    producer.replace_from(0)
    time.sleep(0.05)
    producer.finish()
    stage.wait_for_rest()


@case()
def stop_then_motion(stage):
    """The motion continues from within the stop, and then from rest."""
    producer = stage.live()
    stage.send(producer, 20)
    producer.replace_from(0)
    stage.pause(100)
    stage.send(producer, 15)
    producer.replace_from(0)
    stage.wait_for_rest()
    stage.pause(500)
    stage.send(producer, 15)
    producer.finish()
    stage.wait_for_rest()


@case()
def cancelled_replacement(stage):
    """A replacement that has no effect yet is replaced, then withdrawn by a stop."""
    producer = stage.live()
    stage.send(producer, 25)
    now = producer.now()
    for shift in (0.2, 0.4):
        times = now + (np.arange(1, 8) * 30 + 120) * MS
        producer.replace_from(now + 120 * MS, times, np.full((7, 2), shift))
    producer.replace_from(0)
    stage.wait_for_rest()


def moves(stage, count=40):
    """A file of waypoints."""
    file = tempfile.NamedTemporaryFile("w", suffix=".csv")
    file.write("t,x,y\n")
    for i in range(count):
        x, y = circle(i * PERIOD)[0]
        file.write(f"{i * PERIOD * 1e-9:.2f},{x:.17g},{y:.17g}\n")
    file.flush()
    return file


@case("INT", "KILL")
def replay(stage, number):
    """A replay that a signal ends in the middle."""
    stage.solve()
    with moves(stage) as file:
        player = stage.program("replay", file.name, "--stream", stage.name, "--lead", "200", "--quiet",
                               stderr=subprocess.DEVNULL)
        reader = splinecast.Reader(stage.name, timeout=PATIENCE)
        while reader.sample(time.monotonic_ns()).status is not splinecast.SampleStatus.SETTLED:
            time.sleep(0.005)
        time.sleep(0.2)
        player.send_signal(signal.Signals[f"SIG{number}"])
        player.wait()
    stage.wait_for_rest()


@case()
def producer_killed(stage):
    stage.solve()
    in_a_child(lambda: stage.send(stage.produce(), 30))
    stage.wait_for_rest()


@case()
def producer_killed_and_replaced(stage):
    stage.solve()
    in_a_child(lambda: stage.send(stage.produce(), 30))
    producer = stage.produce()
    stage.begin, stage.sent = producer.last_time, 1
    stage.send(producer, 30, at=lambda t: circle(t + 30 * PERIOD))
    producer.finish()
    stage.wait_for_rest()


@case()
def both_killed(stage):
    solver = stage.solve()
    in_a_child(lambda: stage.send(stage.produce(), 30))
    solver.kill()
    solver.wait()
    time.sleep(0.6)


@case()
def take_over(stage):
    """Solvers are killed; a standby takes over each time."""
    first = stage.solve()
    producer = stage.produce()
    stage.send(producer, 15)
    for solver in (first, stage.solve(), stage.solve()):
        solver.kill()
        solver.wait()
        stage.send(producer, 15)
    stage.solve()
    producer.wait_until_consumed(PATIENCE)
    producer.finish()
    stage.wait_for_rest()


@case()
def take_over_late(stage):
    """The successor comes when the motion has come to rest."""
    first = stage.solve()
    producer = stage.produce()
    stage.send(producer, 15)
    first.kill()
    first.wait()
    stage.send(producer, 15)
    time.sleep(0.6)
    stage.solve()
    stage.sent += 30
    stage.send(producer, 15)
    producer.finish()
    stage.wait_for_rest()


@case()
def start_from(stage):
    producer = stage.live()
    now = producer.now()
    producer.start_from(now + 150 * MS, [0.9, 0.0], [0.0, 0.3], [0.0, 0.0])
    stage.send(producer, 30)
    producer.finish()
    stage.wait_for_rest()


@case("20", "100", "400")
def starvation(stage, ms):
    """The source is silent for this time beyond its lead."""
    producer = stage.live()
    for _ in range(2):
        stage.send(producer, 20)
        stage.pause(int(ms) + LEAD // MS)
    stage.send(producer, 20)
    producer.finish()
    stage.wait_for_rest()


@case()
def starvation_with_limits(stage):
    producer = stage.live("--max-velocity", "3.2", "--max-acceleration", "30", "--max-jerk", "900",
                          "--bounds", "-1.2:1.2")
    for ms in (30, 120):
        stage.send(producer, 20)
        stage.pause(ms + LEAD // MS)
    stage.send(producer, 25)
    producer.finish()
    stage.wait_for_rest()


@case("report", "refuse")
def beyond(stage, what):
    """Waypoints with which the curve exceeds a limit."""
    producer = stage.live("--max-velocity", "3", "--max-acceleration", "10", "--beyond", what)
    def jumps(t):
        x, v, a = circle(t)
        return x + (0.2 if (t // PERIOD) % 12 == 11 else 0), v, a
    stage.send(producer, 40, at=jumps)
    producer.finish()
    stage.wait_for_rest()


@case()
def replacements(stage):
    """Chunks that replace one another, with and without a blend, in the future, and one that is too late."""
    producer = stage.live()
    stage.send(producer, 15)
    for i in range(8):
        t = producer.earliest + (10 + 15 * (i % 3)) * MS
        times = t + np.arange(1, 9) * 25 * MS
        x = np.array([circle((15 + 3 * i) * PERIOD + int(u - t))[0] for u in times])
        producer.replace_from(t, times, x * (1 + 0.01 * i), blend=0.03 * (i % 2))
        time.sleep(0.07)
    try:
        producer.replace_from(producer.now() + 6 * MS, [producer.now() + 300 * MS], [[0.0, 0.0]])
    except splinecast.Refused as refused:
        print(f"{stage.name}: {refused}", file=sys.stderr)
    producer.finish()
    stage.wait_for_rest()


@case()
def refused_items(stage):
    """Waypoints with a quaternion of length 0, between others."""
    producer = stage.live(dimensions=7, kinds=["linear", "linear", "periodic:360", *["quaternion"] * 4])
    def broken(t):
        x, v, a = pose(t)
        if (t // PERIOD) % 10 == 9:
            x[3:] = 0
        return x, v, a
    stage.send(producer, 35, at=broken)
    producer.finish()
    stage.wait_for_rest()


# Methods, each with all kinds of dimensions.

KINDS = ["linear", "linear", "periodic:360", *["quaternion"] * 4]


def options_of(method):
    return {"smoothing": ["--lambda", "1e-7"], "rounded": ["--time-scale", "0.5"]}.get(method, [])


@case(*sorted(FRESH))
def live(stage, method):
    """Starvation, a replacement, a stop and a finish."""
    producer = stage.live("--method", method, *options_of(method), dimensions=7, kinds=KINDS)
    given = method in ("hermite", "quintic")
    def send(count):
        stage.send(producer, count, at=pose, derivatives=given)
    send(15)
    stage.pause(60 + LEAD // MS)
    send(15)
    t = producer.earliest + 30 * MS
    times = t + np.arange(1, 8) * 30 * MS
    values = [np.array(row) for row in zip(*(pose(stage.sent * PERIOD + int(u - t)) for u in times))]
    producer.replace_from(t, times, values[0], *(values[1:] if given else ()))
    time.sleep(0.1)
    producer.replace_from(0)
    stage.wait_for_rest()
    stage.begin, stage.sent = 0, 0
    send(10)
    producer.finish()
    stage.wait_for_rest()


@case(*sorted(FRESH))
def recorded(stage, method):
    """Recorded times, with a stop and a start between two parts, and the end of the method."""
    given = method in ("hermite", "quintic")
    stage.solve("--method", method, *options_of(method))
    producer = stage.produce(clock="recorded", dimensions=7, kinds=KINDS)
    for i in range(60):
        t = i * PERIOD + (500 * MS if i >= 30 else 0)
        x, v, a = pose(i * PERIOD)
        producer.append(t, x, *((v, a) if given else ()), timeout=PATIENCE)
    producer.finish("halt" if method in ("c2", "smoothing") else "clamped", timeout=PATIENCE)
    producer.wait_until_consumed(PATIENCE)


@case("halt", "clamped", "natural", "velocity=0.5,-0.25", "acceleration=1,-2")
def recorded_end(stage, condition):
    stage.solve()
    producer = stage.produce(clock="recorded", start=condition)
    for i in range(30):
        producer.append(i * PERIOD, circle(i * PERIOD)[0], timeout=PATIENCE)
    producer.finish(condition, timeout=PATIENCE)
    producer.wait_until_consumed(PATIENCE)


@case("bessel", "parabolic", "natural", "clamped")
def tail(stage, condition):
    """Each tail, with a small settle lag."""
    producer = stage.live("--tail", condition, "--settle", "3")
    stage.send(producer, 20)
    stage.pause(60 + LEAD // MS)
    stage.send(producer, 20)
    producer.finish()
    stage.wait_for_rest()


# Time laws.


@case()
def law_ramps(stage):
    """Ramps up, down, to rest, and ramps that interrupt ramps."""
    operator, producer = stage.law_and_stream()
    sender = threading.Thread(target=stage.send, args=(producer, 50))
    sender.start()
    for rate, ramp, wait in ((0.3, 0.1, 0.15), (1, 0.2, 0.05), (0.5, 0.1, 0.15), (0, 0.05, 0.2), (0.8, 0.1, 0.05),
                             (0.2, 0.05, 0.1), (1, 0.02, 0.2)):
        operator.set_rate(rate, ramp)
        time.sleep(wait)
    sender.join()
    producer.finish()
    stage.wait_for_rest()


@case()
def law_fast(stage):
    """A law that runs at twice its speed."""
    operator, producer = stage.law_and_stream(largest=2.0)
    sender = threading.Thread(target=stage.send, args=(producer, 40), kwargs={"lead": 2 * LEAD})
    sender.start()
    for rate in (2, 0.5, 1.5, 1):
        operator.set_rate(rate, 0.1)
        time.sleep(0.15)
    sender.join()
    producer.finish()
    stage.wait_for_rest()


@case()
def law_commanders(stage):
    """Several commanders, a dead man that fires, and releases."""
    operator, producer = stage.law_and_stream()
    sender = threading.Thread(target=stage.send, args=(producer, 40))
    sender.start()
    with stage.command("panel") as panel, stage.command("estop") as estop:
        panel.set_rate(0.4, 0.05)
        time.sleep(0.1)
        estop.hold(0.05)
        time.sleep(0.1)
        estop.release(0.1)
        panel.release(0.1)
        time.sleep(0.15)
        panel.set_dead_man(0.08)
        panel.set_rate(0.7, 0.05)
        time.sleep(0.3)
        panel.set_dead_man(0)
        panel.set_rate(1, 0.05)
        panel.release(0.05)
    sender.join()
    producer.finish()
    stage.wait_for_rest()


def held(stage, *options):
    """A stream that a law holds in its motion: the operator and the producer."""
    operator, producer = stage.law_and_stream(*options)
    stage.send(producer, 30)
    operator.hold(0.05)
    time.sleep(0.15)
    return operator, producer


@case()
def hold(stage):
    held(stage)


@case()
def hold_then_finish(stage):
    operator, producer = held(stage)
    producer.finish()
    time.sleep(0.05)
    operator.release(0.1)
    stage.wait_for_rest()


@case()
def hold_then_stop(stage):
    operator, producer = held(stage)
    producer.replace_from(0)
    time.sleep(0.05)
    operator.set_rate(1, 0.05)
    stage.wait_for_rest()


@case()
def hold_in_a_stop(stage):
    operator, producer = stage.law_and_stream()
    stage.send(producer, 30)
    producer.replace_from(0)
    time.sleep(0.05)
    operator.hold(0.03)
    time.sleep(0.1)
    operator.set_rate(1, 0.05)
    stage.wait_for_rest()


@case()
def hold_then_redirect(stage):
    operator, producer = held(stage)
    t = producer.earliest + 10 * MS
    producer.replace_from(t, t + np.arange(1, 8) * 40 * MS, np.full((7, 2), 0.3))
    time.sleep(0.05)
    operator.set_rate(1, 0.05)
    time.sleep(0.2)
    producer.finish()
    stage.wait_for_rest()


@case()
def law_solver_killed(stage):
    """The law is taken over within a ramp and while it holds."""
    operator, producer = stage.law_and_stream()
    sender = threading.Thread(target=stage.send, args=(producer, 40))
    sender.start()
    for rate in (0.3, 0, 1):
        operator.set_rate(rate, 0.1)
        time.sleep(0.06)
        stage.solvers[stage.law][-1].kill()
        stage.solvers[stage.law][-1].wait()
        stage.solve(stream=stage.law)
        time.sleep(0.15)
    sender.join()
    producer.finish()
    stage.wait_for_rest()


@case()
def law_and_starvation(stage):
    operator, producer = stage.law_and_stream()
    stage.send(producer, 20)
    operator.set_rate(0.5, 0.05)
    time.sleep(0.7)
    stage.sent += round((producer.now() + LEAD - stage.begin) / PERIOD) - stage.sent
    stage.send(producer, 20)
    operator.set_rate(1, 0.05)
    stage.send(producer, 5)
    producer.finish()
    stage.wait_for_rest()


def make(name, path):
    """Records one case."""
    stage = Stage(name, path)
    try:
        try:
            CASES[name](stage)
        except splinecast.Refused as refused:
            print(f"{name}: {refused}", file=sys.stderr)
        stage.close()
    except BaseException:
        stage.end()
        raise


def make_all(folder, names):
    """Records cases, eight at a time. Returns those that failed."""
    waiting, running, failed = list(names), {}, []
    while waiting or running:
        while waiting and len(running) < 8:
            name = waiting.pop(0)
            path = os.path.join(folder, f"{name}.mcap")
            running[name] = subprocess.Popen([sys.executable, "-B", __file__, "--case", name, path])
        for name in [name for name, child in running.items() if child.poll() is not None]:
            if running.pop(name).returncode != 0:
                failed.append(name)
        time.sleep(0.01)
    return failed


def verify(path):
    """The number of equal segments of each stream of a recording, or None if it does not verify."""
    ended = subprocess.run(["splinecast", "replay", "--verify", "--json", path], check=False, capture_output=True, text=True)
    if ended.returncode != 0:
        print(f"{path}: exit code {ended.returncode}\n{ended.stdout}{ended.stderr}")
        return None
    return {name: stream["equal"] for name, stream in json.loads(ended.stdout)["streams"].items()}


def main():
    if sys.argv[1:] == ["--list"]:
        print("\n".join(CASES))
        return 0
    if sys.argv[1:2] == ["--case"]:
        make(*sys.argv[2:])
        return 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = temporary if sys.argv[1:2] == ["--check"] else sys.argv[1]
        names = sys.argv[2:] or CASES
        failed = make_all(folder, names)
        verified = {name: verify(os.path.join(folder, f"{name}.mcap")) for name in names if name not in failed}
        with open(os.path.join(folder, "expected.json"), "w", encoding="utf-8") as file:
            json.dump(verified, file, indent=1)
            file.write("\n")
    failed += [name for name, found in verified.items() if found is None]
    print(f"{len(names)} recordings, {len(failed)} failed {' '.join(failed)}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
