"""Cases of time laws."""

import threading
import time

import numpy as np

from stage import LEAD, MS, PERIOD, case



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
