#!/usr/bin/env python3
"""Measures what requests of a rate do on a machine with other work: the values of before_after.json.

    measure_requests.py [BUILD] [NAME ...]    all measurements, or those named, as lines of `name: value`

Needs the Python module (`./run python`) and no other solver. Uses streams and files with a prefix of this process, and
removes them. The simulated campaign of requests measures random sequences and kills at any store.
"""

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent.parent
args = sys.argv[1:]
BUILD = Path(args.pop(0)).resolve() if args and Path(args[0]).is_dir() else PROJECT / "build" / "release"
sys.path.insert(0, str(BUILD / "python"))
import splinecast  # noqa: E402

PROGRAM = str(BUILD / "bin" / "splinecast")
PREFIX = f"test.{os.getpid()}"
measurements = {}


def measurement(function):
    measurements[function.__name__] = function
    return function


@contextlib.contextmanager
def processes(commands):
    """Runs commands until the end of the scope."""
    started = [subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for command in commands]
    try:
        yield started
    finally:
        for process in started:
            process.kill()
            process.wait()


def busy(count):
    return processes([["sh", "-c", "while :; do :; done"]] * count)


@contextlib.contextmanager
def files(count):
    """Other files in shared memory."""
    paths = [f"/dev/shm/splinecast.{PREFIX}.other{i}.waypoints" for i in range(count)]
    for path in paths:
        Path(path).touch()
    try:
        yield
    finally:
        for path in paths:
            os.unlink(path)


@contextlib.contextmanager
def law(name="law"):
    """A law with its solver, at rate 1."""
    stream = f"{PREFIX}.{name}"
    with processes([[PROGRAM, "solve", stream, "--quiet"]]):
        with splinecast.RateCommander(stream, "operator") as operator:
            operator.set_rate(1, 0.01, wait=20)
            yield stream, operator
    subprocess.run([PROGRAM, "rm", stream], check=False, stdout=subprocess.DEVNULL)


def rate(reader):
    """The law's rate now: the velocity of stream time."""
    return float(reader.preview(time.monotonic_ns()).velocity[0])


def holds_within(reader, seconds):
    """Whether the law comes to rest in that time, which a busy machine may lengthen."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if rate(reader) == 0:
            return True
        time.sleep(0.005)
    return False


def lost(count, request):
    """How many of some requests to hold are not followed within 2 s, each after a release."""
    missing = 0
    with law() as (stream, operator), splinecast.Reader(stream, timeout=10) as reader:
        for _ in range(count):
            operator.set_rate(1, 0.01, wait=20)
            time.sleep(0.02)
            request(operator)
            missing += 0 if holds_within(reader, 2) else 1
    return f"{missing} of {count}"


def expire(operator):
    operator.set_dead_man(0.02, 0.01)
    operator.set_rate(0.9, 0.01)
    time.sleep(0.03)
    operator.set_dead_man(0)


@measurement
def holds_beside_busy_loops():
    with busy(os.cpu_count()):
        return lost(100, lambda operator: operator.hold(0.01))


@measurement
def dead_men_beside_busy_loops():
    with busy(os.cpu_count()):
        return lost(100, expire)


@measurement
def holds_with_4100_files():
    with files(4100):
        return lost(200, lambda operator: operator.hold(0.01))


@measurement
def first_holds_with_1000_files():
    missing = 0
    with files(1000), law() as (stream, _), splinecast.Reader(stream, timeout=10) as reader:
        for i in range(10):
            with splinecast.RateCommander(stream, f"new{i}") as commander:
                commander.hold(0.01)
                missing += 0 if holds_within(reader, 2) else 1
                commander.release(0.01, wait=20)
                time.sleep(0.05)
    return f"{missing} of 10"


@measurement
def holds_when_the_solver_is_killed_within_150_us():
    count, missing = 100, 0
    stream = f"{PREFIX}.killed"
    solve = [PROGRAM, "solve", stream, "--quiet"]
    solver = subprocess.Popen(solve)
    with splinecast.RateCommander(stream, "operator") as operator:
        operator.set_rate(1, 0.01, wait=20)
        with splinecast.Reader(stream, timeout=10) as reader:
            for i in range(count):
                operator.set_rate(1, 0.01, wait=20)
                time.sleep(0.02)
                operator.hold(0.01)
                end = time.perf_counter() + 150e-6 * i / count
                while time.perf_counter() < end:
                    pass
                solver.send_signal(signal.SIGKILL)
                solver.wait()
                solver = subprocess.Popen(solve)
                missing += 0 if holds_within(reader, 5) else 1
    solver.kill()
    solver.wait()
    subprocess.run([PROGRAM, "rm", stream], check=False, stdout=subprocess.DEVNULL)
    return f"{missing} of {count}"


@measurement
def rate_0_of_the_program_on_a_busy_machine():
    wrong = 0
    with busy(2 * os.cpu_count()), law() as (stream, operator), splinecast.Reader(stream, timeout=10) as reader:
        for _ in range(60):
            operator.set_rate(1, 0.01, wait=20)
            ended = subprocess.run([PROGRAM, "rate", stream, "0", "--ramp", "0.01", "--wait", "30"], check=False,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            wrong += 1 if ended.returncode == 0 and not holds_within(reader, 2) else 0
            subprocess.run([PROGRAM, "rate", stream, "--release", "--ramp", "0.01", "--wait", "30"], check=False,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return f"{wrong} of 60"


def largest_rate(first, ramp, at, then, slow, seconds):
    """The largest rate after a request to slow, made while the rate rises."""
    with law() as (stream, operator), splinecast.Reader(stream, timeout=10) as reader:
        operator.set_rate(first[0], 0.01, wait=20)
        time.sleep(0.1)
        operator.set_rate(first[1], ramp, wait=20)
        while rate(reader) < at:
            time.sleep(0.002)
        operator.set_rate(then, slow)
        largest, end = 0.0, time.monotonic() + seconds
        while time.monotonic() < end:
            largest = max(largest, rate(reader))
            time.sleep(0.005)
    return f"{largest:.3f}"


@measurement
def largest_rate_after_a_slow_request_in_a_rise():
    return largest_rate((0.3, 0.5), 1, 0.4, 0.2, 60, 6)


@measurement
def largest_rate_after_a_slow_hold_in_a_rise():
    return largest_rate((0, 0.3), 0.5, 0.15, 0, 60, 6)


@measurement
def rate_after_a_faster_stop():
    """Operator 0 in 60 s, then estop 0 in 0.1 s: the rate 2 s later."""
    with law() as (stream, operator), splinecast.Reader(stream, timeout=10) as reader:
        operator.hold(60, wait=20)
        with splinecast.RateCommander(stream, "estop") as estop:
            estop.hold(0.1, wait=20)
            time.sleep(2)
            return f"{rate(reader):.3f}"


@measurement
def rate_after_a_stop_and_a_takeover():
    """Operator renews 1 in 60 s with a dead man, estop 0 in 0.1 s, the solver is replaced: the rate 2 s later."""
    stream = f"{PREFIX}.taken"
    solve = [PROGRAM, "solve", stream, "--quiet"]
    with splinecast.RateCommander(stream, "operator") as operator, processes([solve]) as started:
        operator.set_dead_man(1)
        operator.set_rate(1, 60, wait=20)
        with splinecast.RateCommander(stream, "estop") as estop, splinecast.Reader(stream, timeout=10) as reader:
            estop.hold(0.1)
            started[0].kill()
            started[0].wait()
            with processes([solve]):
                for _ in range(20):
                    time.sleep(0.1)
                    operator.renew()
                value = f"{rate(reader):.3f}"
    subprocess.run([PROGRAM, "rm", stream], check=False, stdout=subprocess.DEVNULL)
    return value


def share_of_a_core(solve, seconds=10):
    """The CPU time of a solver that has nothing to do, as a share of a core."""
    solver = subprocess.Popen(solve)
    time.sleep(3)

    def used():
        fields = Path(f"/proc/{solver.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    before = used()
    time.sleep(seconds)
    share = (used() - before) / seconds
    solver.kill()
    solver.wait()
    return f"{100 * share:.1f} %"


@measurement
def idle_law_with_10000_files():
    stream = f"{PREFIX}.idle"
    with files(10000), splinecast.RateCommander(stream, "operator") as operator:
        operator.set_rate(1, 0.01)
        share = share_of_a_core([PROGRAM, "solve", stream, "--quiet"])
    subprocess.run([PROGRAM, "rm", stream], check=False, stdout=subprocess.DEVNULL)
    return share


@measurement
def idle_pattern_with_10000_files():
    with files(10000):
        return share_of_a_core([PROGRAM, "solve", f"{PREFIX}.none*", "--quiet"])


@measurement
def idle_pattern_without_files():
    return share_of_a_core([PROGRAM, "solve", f"{PREFIX}.none*", "--quiet"])


def main():
    unknown = [name for name in args if name not in measurements]
    if unknown:
        sys.exit(f"there is no measurement {unknown[0]}; there are {', '.join(measurements)}")
    for name in args or measurements:
        print(f"{name}: {measurements[name]()}", flush=True)


if __name__ == "__main__":
    main()
