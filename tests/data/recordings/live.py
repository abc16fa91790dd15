"""Cases of live streams: how they end, and what happens before."""

import signal
import subprocess
import tempfile
import time

import numpy as np

import splinecast
from stage import LEAD, MS, PATIENCE, PERIOD, case, circle, in_a_child, pose




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
