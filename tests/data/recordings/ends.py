"""Cases of ends within limits: of the solver's rules for stops and ends, number 2."""

import time

import splinecast
from methods import KINDS
from stage import LEAD, PATIENCE, case, circle, pose

LIMITS = ["--max-acceleration", "20"]
TURNS = ["--max-acceleration", "20,20,none,30,none,none,none"]


def end(stage, pause, *options):
    """Finishes a motion this long [s] after its last waypoint was sent."""
    producer = stage.live(*LIMITS, *options)
    stage.send(producer, 40)
    time.sleep(pause)
    producer.finish()
    stage.wait_for_rest()


@case()
def end_slowed(stage):
    """The motion slows down on its path."""
    end(stage, 0)


@case()
def end_stopped(stage):
    """The finish comes too late to slow down: the shortest stop after the last waypoint."""
    end(stage, LEAD * 1e-9 - 0.015)


@case()
def end_entered(stage):
    """The finish comes in the stop: an entry returns to the last waypoint."""
    end(stage, LEAD * 1e-9 + 0.03)


@case()
def end_in_stop(stage):
    """The same, and the last waypoint is beyond a bound."""
    end(stage, LEAD * 1e-9 + 0.03, "--bounds", "-1.1:1.1,-1.1:0.9")


@case()
def stop_before_bound(stage):
    """A bound makes a stop shorter than the stop time."""
    producer = stage.live("--max-acceleration", "60", "--bounds", "-1.1:1.1,-1.1:1.02", "--stop-time", "0.4")
    stage.send(producer, 42)
    producer.replace_from(0)
    stage.wait_for_rest()


@case("slowed", "stopped", "starved")
def rotation(stage, how):
    """Positions, an angle and a quaternion, with limits."""
    producer = stage.live(*TURNS, dimensions=7, kinds=KINDS)
    stage.send(producer, 40, at=pose)
    if how == "slowed":
        producer.finish()
    elif how == "stopped":
        producer.replace_from(0)
    else:
        stage.pause(60 + LEAD // 1_000_000)
        stage.send(producer, 20, at=pose)
        producer.finish()
    stage.wait_for_rest()


@case()
def beyond_enter(stage):
    """Waypoints that the curve leaves, so that it keeps its limits."""
    producer = stage.live("--max-velocity", "3", "--max-acceleration", "10", "--beyond", "enter")
    def jumps(t):
        x, v, a = circle(t)
        return x + (0.2 if (t // 20_000_000) % 24 >= 20 else 0), v, a
    stage.send(producer, 60, at=jumps)
    producer.finish()
    stage.wait_for_rest()


@case()
def law_faster(stage):
    """Limits of a stream whose law can run at 1.5."""
    stage.command().set_rate(1, 0.005)
    stage.law_solver = splinecast.Solver(stage.law, largest_rate=1.5).start()
    splinecast.Reader(stage.law, timeout=PATIENCE)
    stage.solve(*LIMITS)
    producer = stage.produce(law=stage.law)
    stage.send(producer, 30)
    producer.replace_from(0)
    stage.wait_for_rest()
    stage.begin, stage.sent = 0, 0
    stage.send(producer, 30)
    producer.finish()
    stage.wait_for_rest()
