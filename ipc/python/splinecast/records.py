"""The values that the roles return. Times are int nanoseconds, durations are seconds."""

from typing import Dict, Iterable, List, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

from .statuses import AppendStatus, OutcomeKind, OutcomeWay, Refusal, SampleStatus, SegmentKind

Array = NDArray[np.float64]


class Alive(NamedTuple):
    """Which writers of a stream live. True also if no file descriptor is left to find out."""

    producer: bool
    solver: bool


class Progress(NamedTuple):
    """The progress of a stream's curve, under one revision."""

    revision: int
    newest: int  #: time of the newest waypoint [ns]
    settled_until: int  #: no later revision changes the curve before this time [ns]
    is_finished: bool
    waypoints: int  #: accepted by the solver, over the stream's life
    refused: int  #: items that the solver refused


class LawRate(NamedTuple):
    """The time law of a stream at one instant of host time."""

    stream_time: int  #: rounded down [ns]
    rate: float  #: stream time per host time
    slope: float  #: change of the rate [1/s]


class Excess(NamedTuple):
    """The place of a motion that is nearest to a limit, or farthest beyond one."""

    ratio: float  #: value / limit: above 1 exceeds the limit; below 0: there are no limits
    kind: str  #: velocity, acceleration, jerk or position
    dimension: int  #: of a quaternion its first
    value: float  #: with its sign; of a quaternion, an upper bound of its magnitude
    limit: float


class LimitExcess(NamedTuple):
    """A place where the curve exceeds a limit."""

    item: int  #: number of the waypoint's item
    is_refused: bool  #: the waypoint was refused; else accepted
    kind: str  #: velocity, acceleration, jerk or position
    dimension: int
    time: int  #: [ns]
    value: float
    limit: float
    text: str  #: a message with the dimension's name and the values


class ItemRefusal(NamedTuple):
    """An item that the ring accepted and the solver refused."""

    item: int  #: its number: what `append` returned
    time: Optional[int]  #: [ns]; None if the ring has overwritten the item
    reason: Refusal
    excess: Optional[LimitExcess]  #: for BEYOND_LIMITS, while the board has it
    by: str  #: for STOPPED: a stopper's name, while the board has it; else ''

    def __str__(self) -> str:
        at = "" if self.time is None else f" (time {self.time} ns)"
        why = "" if self.excess is None else f": {self.excess.text}"
        who = f" by '{self.by}'" if self.by else ""
        return f"item {self.item} refused: {self.reason}{who}{at}{why}"


class Refusals(List[ItemRefusal]):
    """The items that a solver has refused since the last call, in the order of the ring.

    Attributes
    ----------
    missed : int
        Older refusals since that call that the board no longer has; it keeps 1,024.
    consumed : int
        All refusals of items below this number have been reported.
    """

    def __init__(self, items: Iterable[ItemRefusal] = (), missed: int = 0, consumed: int = 0) -> None:
        super().__init__(items)
        self.missed = missed
        self.consumed = consumed


class ItemOutcome(NamedTuple):
    """What became of an item that the ring has accepted."""

    kind: OutcomeKind
    time: Optional[int]  #: IN_FORCE: when [ns]; if the item came late, later than its own time
    way: Optional[OutcomeWay]  #: IN_FORCE: by which part of the curve
    reason: Optional[Refusal]  #: REFUSED: why
    is_final: bool  #: nothing can change it any more: its time has settled, or it is not in force

    def __str__(self) -> str:
        if self.reason is not None:
            return f"{self.kind}: {self.reason}"
        return str(self.kind) if self.time is None else f"{self.kind} at {self.time} ns: {self.way}"


class MotionPeaks(NamedTuple):
    """Largest magnitudes along a motion, each of shape (D,)."""

    velocity: Array
    acceleration: Array
    jerk: Array


class ReplacementBegin(NamedTuple):
    """Where the motion of a replacement begins."""

    begin: int  #: [ns]
    from_rest: bool  #: whether it begins at rest, where the stream's time law held it


class ReplacePreview(NamedTuple):
    """The effect that a replacement would have on the curve."""

    status: AppendStatus  #: what `replace_from` would get; unless ACCEPTED the rest is not valid
    is_known: bool  #: whether the curve's state at t is known; else the rest is not valid
    begin: int  #: of the motion [ns]: t; for a stop at a settled time, settled_until
    duration: float  #: of the entry onto the waypoints, or of the stop [s]
    from_rest: bool  #: whether it begins at rest where the stream's time law holds it
    enters: bool  #: whether there is an entry; else the curve comes to rest
    waypoint: Optional[int]  #: where the entry ends; None: beyond the last waypoint
    passed_over: int  #: waypoints before the end of the entry
    entry: MotionPeaks  #: of the entry or, without one, of the stop
    motion: MotionPeaks  #: of the whole motion, from t until the curve rests
    worst: Excess  #: the place of the motion nearest to a limit, or farthest beyond one


class StepResult(NamedTuple):
    """What one step of a solver did."""

    consumed: int  #: ring items consumed
    published: bool  #: whether a revision was committed
    missed: bool  #: whether a revision was discarded because it was too late: call step again


class Segment(NamedTuple):
    """A segment of a snapshot: a polynomial in seconds after `left`."""

    left: int  #: [ns]
    right: int  #: [ns]
    kind: SegmentKind
    coefficients: Array  #: (order, D), the lowest power first
    waypoint: Optional[Array]  #: position of the waypoint at `left`; None: none there
    acceleration_step: Optional[Array]  #: at `left`; None if the board no longer has it
    is_corner: bool  #: cut at `left` while its time law held it: the velocity may step there


#: Limits by kind (velocity, acceleration, jerk, lower, upper), each of shape (D,).
Limits = Dict[str, Array]
