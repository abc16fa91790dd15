"""The results that the roles report, with the numbers that the C++ interface uses."""

import enum


class _Status(enum.IntEnum):
    """A number whose text is its name in words."""

    def __str__(self) -> str:
        return self.name.lower().replace("_", " ")

    def __format__(self, form: str) -> str:
        return format(str(self), form)


class AppendStatus(_Status):
    """The result of an append. Only ACCEPTED changes anything; the others raise `Refused`."""

    ACCEPTED = 0
    FULL = 1  #: the ring has no room until the solver consumes; retry
    PAST = 2  #: live streams: the time has settled, or that of the first waypoint is before now
    DUPLICATE = 3  #: the time equals that of the previous waypoint
    OUT_OF_ORDER = 4  #: the time is earlier than that of the previous waypoint
    NOT_FINITE = 5  #: a value is infinite, NaN, or outside ±1e100
    TOO_CLOSE = 6  #: less than min_interval after the previous waypoint
    TOO_FAR_APART = 7  #: more than max_interval after the previous waypoint, or a time out of range
    WRONG_DIMENSION = 8  #: not one value per dimension
    TOO_LATE = 9  #: a replacement with waypoints at a time before `Producer.earliest` or now
    TOO_MANY = 10  #: a replacement that does not fit even into an empty ring
    ALREADY_STARTED = 11  #: a start state after the first waypoint
    FINISHED = 12  #: the stream has been finished
    CANNOT_FOLLOW = 13  #: no waypoint met for 3 s, and the curve moves until this time
    TOO_FAR_AHEAD = 14  #: live streams without a law: more than `horizon` after now
    ELSEWHERE = 15  #: the start is not where an earlier live stream has left the machine
    STOPPED = 16  #: a stopper holds the stream: see `Producer.stopped_by`


class Refusal(_Status):
    """Why the solver refused an item that the ring had accepted."""

    PAST = 1  #: the time had settled
    DUPLICATE = 2
    OUT_OF_ORDER = 3
    NOT_FINITE = 4  #: a value is not usable, or makes the curve not finite
    TOO_CLOSE = 5
    TOO_FAR_APART = 6
    TOO_LATE = 7  #: a replacement at a settled time, or a waypoint of it
    AFTER_FINISH = 8
    ALREADY_STARTED = 9
    UNKNOWN_KIND = 10
    LACKS_DERIVATIVES = 11  #: the method needs a velocity, or acceleration, that is not given
    LAG_TOO_SHORT = 12  #: the settle lag is too short for λ with waypoints this close
    ZERO_QUATERNION = 13  #: a quaternion has length 0, or one outside 1e-100 to 1e100
    BEYOND_LIMITS = 14  #: the curve would exceed a limit, and the solver refuses such waypoints
    CANNOT_FOLLOW = 15  #: no waypoint met for 3 s, and no entry from rest can lead to this one
    STOPPED = 16  #: a stopper held the stream


class OutcomeKind(_Status):
    """What became of an item that the ring has accepted."""

    WAITING = 0  #: no solver has taken it yet
    UNDECIDED = 1  #: taken, but a transition may still pass over it
    IN_FORCE = 2  #: the curve is at the waypoint, or does what the item asks, at `time`
    PASSED_OVER = 3  #: the curve goes from before the waypoint to a later one
    WITHDRAWN = 4  #: a replacement or a stop took its place
    REFUSED = 5  #: by the solver, for `reason`
    FORGOTTEN = 6  #: not known any more


class OutcomeWay(_Status):
    """By which part of the curve an item is in force."""

    SPLINE = 0  #: the spline through the waypoints
    ENTRY = 1  #: a transition ends at the waypoint, or begins with the replacement or start state
    STOP = 2  #: a stop, which begins at `time`
    END = 3  #: the curve slows down or ends there, or rests from then on


class SampleStatus(_Status):
    """The validity of a sample."""

    SETTLED = 0  #: final: every reader gets the same bits at this time, now and later
    PROVISIONAL = 1  #: a newer waypoint or a replacement may still change it
    STOPPING = 2  #: in the stop segment after the newest waypoint
    HOLDING = 3  #: at rest: after the end, or before the first waypoint of a live stream
    REVISED = 4  #: valid, but the curve changed at a time that this reader has already sampled
    BEFORE_HISTORY = 5  #: before what the board keeps; no values
    NO_DATA = 6  #: no waypoint has been solved yet; no values
    BUSY = 7  #: the writer overtook every try: retry; no values
    RETIRED = 8  #: the stream was removed or created again: make a new Reader; no values
    WRONG_DIMENSION = 9  #: the state or block is for a stream of other dimensions; no values

    @property
    def has_values(self) -> bool:
        """Whether a sample of this status has values."""
        return self <= SampleStatus.REVISED


class SegmentKind(_Status):
    """The purpose of a segment."""

    SPLINE = 0  #: between two waypoints
    ENTRY = 1  #: from a given state onto the waypoints
    STOP = 2  #: after the newest waypoint, ends at rest
    HOLD = 3  #: at rest
    SLOWED = 4  #: between two waypoints of a path on which the curve comes to rest
