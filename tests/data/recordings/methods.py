"""Cases of each method, each condition and each tail, live and with recorded times."""

import time

import numpy as np

import splinecast
from stage import LEAD, MS, PATIENCE, PERIOD, case, circle, pose

KINDS = ["linear", "linear", "periodic:360", *["quaternion"] * 4]


def options_of(method):
    return {"smoothing": ["--lambda", "1e-7"], "rounded": ["--time-scale", "0.5"]}.get(method, [])


@case(*splinecast.methods(streaming=True))
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


@case(*splinecast.methods(streaming=True))
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
