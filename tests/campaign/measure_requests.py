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

from measured import BUILD, PREFIX, PROGRAM, files, main, measurement, processes  # sets the path of the module splinecast

import splinecast

def busy(count):
    return processes([["sh", "-c", "while :; do :; done"]] * count)


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


def exit_code_of_a_hold(stream):
    command = [PROGRAM, "rate", stream, "0", "--as", "panel", "--ramp", "0.01", "--wait", "20"]
    return subprocess.run(command, check=False, stdout=subprocess.DEVNULL).returncode


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
    wrong = failed = 0
    with busy(2 * os.cpu_count()), law() as (stream, operator), splinecast.Reader(stream, timeout=10) as reader:
        for _ in range(60):
            operator.set_rate(1, 0.01, wait=20)
            code = exit_code_of_a_hold(stream)
            failed += 1 if code != 0 else 0
            wrong += 1 if code == 0 and not holds_within(reader, 2) else 0
            subprocess.run([PROGRAM, "rate", stream, "--release", "--as", "panel", "--ramp", "0.01", "--wait", "30"],
                           check=True, stdout=subprocess.DEVNULL)
    return f"{wrong} of 60, {failed} with another exit code"


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


@contextlib.contextmanager
def follower():
    """A law at rate 1, and a stream that moves at 1 m/s under it, with a limit of 10 m/s²."""
    stream, arm = f"{PREFIX}.law", f"{PREFIX}.arm"
    with processes([[PROGRAM, "solve", stream, arm, "--quiet", "--max-acceleration", "10"]]):
        with splinecast.RateCommander(stream, "operator") as operator:
            operator.set_rate(1, 0.01, wait=20)
            splinecast.Reader(stream, timeout=10)
            with splinecast.Producer(arm, law=stream) as producer:
                producer.wait_for_solver(10)
                begin = producer.now()
                for i in range(1, 500):
                    producer.append(begin + i * 100_000_000, [0.1 * i])
                time.sleep(1)
                yield stream, arm
    subprocess.run([PROGRAM, "rm", "--now", arm, stream], check=False, stdout=subprocess.DEVNULL)


@measurement
def exit_code_of_a_hold_beyond_a_limit():
    with follower() as (stream, _):
        return exit_code_of_a_hold(stream)


@measurement
def exit_code_of_a_hold_with_a_damaged_follower():
    with follower() as (stream, arm):
        with open(f"/dev/shm/splinecast.{arm}.spline", "r+b") as board:
            board.write(bytes(64))
        return exit_code_of_a_hold(stream)


@measurement
def rate_after_a_renewal_by_a_new_process():
    """A process holds and is killed; the next one renews: the rate 1 s later."""
    with law() as (stream, _), splinecast.Reader(stream, timeout=10) as reader:
        holder = subprocess.Popen([sys.executable, "-c", "import sys, time, splinecast\n"
                                   f"c = splinecast.RateCommander('{stream}', 'panel')\n"
                                   "c.hold(0.01, wait=20)\nprint(flush=True)\ntime.sleep(60)"],
                                  env={**os.environ, "PYTHONPATH": str(BUILD / "python")}, stdout=subprocess.PIPE)
        holder.stdout.readline()
        holder.kill()
        holder.wait()
        with splinecast.RateCommander(stream, "panel") as panel:
            panel.renew()
            time.sleep(1)
            return f"{rate(reader):.3f}"


@measurement
def rate_at_the_end_of_a_ramp_that_is_renewed():
    """0 in 2 s, renewed each 0.1 s: the rate after 2.5 s."""
    with law() as (stream, operator), splinecast.Reader(stream, timeout=10) as reader:
        operator.hold(2, wait=20)
        for _ in range(25):
            time.sleep(0.1)
            operator.renew()
        return f"{rate(reader):.3f}"


@measurement
def rate_after_a_dead_man_of_a_slow_request():
    """0.9 in 60 s with a dead man of 0.1 s: the rate 2 s later."""
    with law() as (stream, operator), splinecast.Reader(stream, timeout=10) as reader:
        operator.set_dead_man(0.1)
        operator.set_rate(0.9, 60, wait=20)
        time.sleep(2)
        return f"{rate(reader):.3f}"


def used(pid):
    """The CPU time of a process in s."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@measurement
def solver_with_a_damaged_ring_and_a_torn_request():
    """Random bytes in the items of the law's ring, then an odd sequence in a commander's region: whether the solver
    lives, its share of a core, and the law's rate."""
    stream = f"{PREFIX}.damaged"
    with splinecast.RateCommander(stream, "operator") as operator:
        with processes([[PROGRAM, "solve", stream, "--quiet"]]) as (solver,):
            operator.set_rate(0.5, 0.01, wait=20)
            with splinecast.Reader(stream, timeout=10) as reader:
                ring = f"/dev/shm/splinecast.{stream}.waypoints"
                with open(ring, "r+b") as words:
                    words.seek(16384)  # after the header and the control block
                    words.write(os.urandom(os.path.getsize(ring) - 16384))
                with open(f"/dev/shm/splinecast.{stream}@operator.commander", "r+b") as words:
                    header = words.read(512)
                    control = int.from_bytes(header[10 * 8:11 * 8], "little")
                    words.seek(control)
                    words.write((1).to_bytes(8, "little"))
                time.sleep(2)
                before = used(solver.pid)
                time.sleep(5)
                alive = solver.poll() is None
                share = (used(solver.pid) - before) / 5 if alive else 0
                text = f"{'alive' if alive else 'ended'}, {100 * share:.1f} %, rate {rate(reader):.3f}"
    subprocess.run([PROGRAM, "rm", stream], check=False, stdout=subprocess.DEVNULL)
    return text


@measurement
def exit_code_of_a_rate_above_the_largest():
    with law() as (stream, _):
        return subprocess.run([PROGRAM, "rate", stream, "1.5"], check=False, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL).returncode


def share_of_a_core(solve, seconds=10):
    """The CPU time of a solver that has nothing to do, as a share of a core."""
    solver = subprocess.Popen(solve)
    time.sleep(3)
    before = used(solver.pid)
    time.sleep(seconds)
    share = (used(solver.pid) - before) / seconds
    solver.kill()
    solver.wait()
    return f"{100 * share:.1f} %"


@measurement
def idle_law():
    stream = f"{PREFIX}.idle"
    with splinecast.RateCommander(stream, "operator") as operator:
        operator.set_rate(1, 0.01)
        share = share_of_a_core([PROGRAM, "solve", stream, "--quiet"])
    subprocess.run([PROGRAM, "rm", stream], check=False, stdout=subprocess.DEVNULL)
    return share


@measurement
def idle_law_with_10000_files():
    with files(10000):
        return idle_law()


@measurement
def idle_pattern_with_10000_files():
    with files(10000):
        return share_of_a_core([PROGRAM, "solve", f"{PREFIX}.none*", "--quiet"])


@measurement
def idle_pattern_without_files():
    return share_of_a_core([PROGRAM, "solve", f"{PREFIX}.none*", "--quiet"])


if __name__ == "__main__":
    main()
