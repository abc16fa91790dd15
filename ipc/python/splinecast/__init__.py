"""Online streaming cubic splines over shared memory.

A producer appends timed waypoints, a solver turns them into a C² spline, and any number of readers
sample position, velocity, acceleration and jerk at their own instants.

Instants are an int, nanoseconds, or a float, seconds, of the stream's clock: of a live stream
CLOCK_MONOTONIC (`time.monotonic_ns`, `time.monotonic`). Instants that are returned are int
nanoseconds. Durations and timeouts are seconds; a timeout of None waits without end. Arrays of
float64 are read where they are, with any strides; other array-likes are converted.

An object belongs to the process that made it: in a forked child its methods raise RuntimeError.
Several threads may use one object: its methods run one after the other.

Examples
--------
>>> import time, splinecast
>>> with splinecast.Solver("doc").start(), splinecast.Producer("doc", dimensions=1) as arm:
...     arm.wait_for_solver(5)
...     t = time.monotonic_ns() + 200_000_000
...     for i in range(20):
...         _ = arm.append(t + i * 10_000_000, [i * 0.01])
...     print(splinecast.Reader("doc", timeout=5).dimensions)
True
1
>>> splinecast.remove("doc")
"""

from ._splinecast import (
    Block,
    Curve,
    Producer,
    RateCommander,
    Reader,
    Snapshot,
    Solver,
    State,
    Stopper,
    __version__,
    cross_validated_lambda,
    fit,
    methods,
    remove,
    streams,
)
from .errors import BadRegion, BadRequest, Error, Full, NoSuchStream, OutOfResources, Refused, StreamBusy
from .records import (
    Alive,
    Excess,
    ItemOutcome,
    ItemRefusal,
    LawRate,
    LimitExcess,
    Limits,
    MotionPeaks,
    Progress,
    Refusals,
    ReplacementBegin,
    ReplacePreview,
    Segment,
    StepResult,
)
from .statuses import AppendStatus, OutcomeKind, OutcomeWay, Refusal, SampleStatus, SegmentKind

__all__ = [
    "Alive", "AppendStatus", "BadRegion", "BadRequest", "Block", "Curve", "Error", "Excess", "Full", "ItemOutcome",
    "ItemRefusal", "LawRate", "LimitExcess", "Limits", "MotionPeaks", "NoSuchStream", "OutOfResources", "OutcomeKind",
    "OutcomeWay", "Producer", "Progress", "RateCommander", "Reader", "Refusal", "Refusals", "Refused", "ReplacementBegin",
    "ReplacePreview", "SampleStatus", "Segment",
    "SegmentKind", "Snapshot", "Solver", "State", "StepResult", "Stopper", "StreamBusy", "__version__",
    "cross_validated_lambda", "fit", "methods", "remove", "streams",
]
