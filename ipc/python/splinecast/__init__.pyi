# The types and the docstrings of the module. The build copies the docstrings into the extension.
from types import TracebackType
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Type, TypeVar, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import BadRegion as BadRegion
from .errors import BadRequest as BadRequest
from .errors import Error as Error
from .errors import Full as Full
from .errors import NoSuchStream as NoSuchStream
from .errors import OutOfResources as OutOfResources
from .errors import Refused as Refused
from .errors import StreamBusy as StreamBusy
from .records import Alive as Alive
from .records import Excess as Excess
from .records import ItemOutcome as ItemOutcome
from .records import ItemRefusal as ItemRefusal
from .records import LawRate as LawRate
from .records import LimitExcess as LimitExcess
from .records import Limits as Limits
from .records import MotionPeaks as MotionPeaks
from .records import Progress as Progress
from .records import Refusals as Refusals
from .records import ReplacementBegin as ReplacementBegin
from .records import ReplacePreview as ReplacePreview
from .records import Segment as Segment
from .records import StepResult as StepResult
from .statuses import AppendStatus as AppendStatus
from .statuses import OutcomeKind as OutcomeKind
from .statuses import OutcomeWay as OutcomeWay
from .statuses import Refusal as Refusal
from .statuses import SampleStatus as SampleStatus
from .statuses import SegmentKind as SegmentKind

__version__: str
__all__: List[str]

Array = NDArray[np.float64]
Instant = Union[int, float, np.integer[Any], np.floating[Any]]  # int ns or float s
Seconds = Union[int, float, np.integer[Any], np.floating[Any]]
Instants = Union[NDArray[Any], Sequence[Instant]]
Condition = Union[str, Tuple[str, ArrayLike]]
LimitValues = Mapping[str, Union[Seconds, ArrayLike]]
_Self = TypeVar("_Self")

class Producer:
    """The role that appends waypoints: the one writer of a stream.

    Creates the stream, creates it again if it is finished, or continues it if its producer died
    before finishing. As a context manager it finishes the stream with a full stop when the body
    ends normally. After an exception it stops a live stream at once and finishes it there; a
    recorded one it only closes.

    Parameters
    ----------
    stream : str
        1 to 128 characters of A-Z a-z 0-9 . _ - without a leading dot.
    names : sequence of str, optional
        One name per dimension; each is cut to 31 bytes.
    units : str or sequence of str, optional
        The unit of all dimensions, or one per dimension; each is cut to 15 bytes.
    dimensions : int, optional
        1 to 64. Default: the number of names, else of kinds, else 1.
    kinds : str or sequence of str, optional
        The kind of all dimensions, or one per dimension: 'linear' (the default), 'periodic:PERIOD',
        and for each of four consecutive dimensions 'quaternion' (x y z w) or 'quaternion-wxyz'.
    clock : {'monotonic', 'recorded', 'law'}, optional
        A live stream, whose times are those of CLOCK_MONOTONIC, a recorded stream, or a live stream
        that follows a time law. Default: 'law' if `law` is given, else 'monotonic'.
    law : str, optional
        The time law that the stream follows: times of waypoints are its stream time, see `now`.
    start : str or (str, array-like)
        The boundary condition at the first waypoint: 'halt' (full stop), 'clamped', 'natural',
        'velocity=1,2' or ('velocity', values), 'acceleration=…'.
    min_interval : float
        Shortest interval between two waypoints [s]: 1 ns or more; default 1 µs.
    max_interval : float
        Longest interval between two waypoints [s]: min_interval or more, below 2⁶¹ ns; default 1 h.
    horizon : float
        Of a live stream without a law: how far ahead of now a time may be [s]: above 0; default
        1 h. A time of another clock is refused, and the message names that clock.
    start_tolerance : float
        Of a live stream: how far the first waypoint may be from where an earlier stream of this
        name has left the machine, in a dimension without limits; in the dimension's unit, rad for a
        quaternion: 0 or more; default 0.001.
    capacity : int
        Items of the ring, 2 to 2²⁴; default 1,024; rounded up to a power of two.
    mode : int
        Permission bits of the region.
    group : int, optional
        Group of the region.
    owner : int, optional
        A further user whose regions are trusted.

    Raises
    ------
    StreamBusy
        The stream has a living producer.
    BadRequest
        An invalid name or option, or options that contradict the stream that it continues.
    BadRegion
        Shared memory is full, or the files of that name cannot be used.
    """

    def __init__(
        self,
        stream: str,
        names: Optional[Sequence[str]] = None,
        units: Union[str, Sequence[str], None] = None,
        *,
        dimensions: Optional[int] = None,
        kinds: Union[str, Sequence[str], None] = None,
        clock: Optional[str] = None,
        law: Optional[str] = None,
        start: Condition = "halt",
        min_interval: Seconds = 1e-6,
        max_interval: Seconds = 3600.0,
        horizon: Seconds = 3600.0,
        start_tolerance: float = 0.001,
        capacity: int = 1024,
        mode: int = 0o600,
        group: Optional[int] = None,
        owner: Optional[int] = None,
    ) -> None: ...
    def append(
        self,
        t: Instant,
        x: ArrayLike,
        velocity: Optional[ArrayLike] = None,
        acceleration: Optional[ArrayLike] = None,
        timeout: Optional[Seconds] = 0.0,
    ) -> int:
        """Append a waypoint.

        The first waypoint after a producer that died replaces its motion as soon as possible, if it
        does not continue it: see docs/live-streams.md.

        Parameters
        ----------
        t : int or float
            Its time [int ns or float s].
        x : array-like
            Its position, one value per dimension; a number if there is one dimension.
        velocity, acceleration : array-like, optional
            For the methods that use them.
        timeout : float, optional
            Seconds to wait for room if the ring is full; None waits without end.

        Returns
        -------
        int
            The number of the item, to which `refusals` refers.

        Raises
        ------
        Full
            The ring is full, and stays so until the timeout.
        Refused
            The ring refuses the waypoint: see its `status`.
        """
    def append_many(
        self,
        times: Instants,
        positions: ArrayLike,
        velocities: Optional[ArrayLike] = None,
        accelerations: Optional[ArrayLike] = None,
        timeout: Optional[Seconds] = 0.0,
    ) -> int:
        """Append waypoints one by one, without the GIL.

        Parameters
        ----------
        times : array-like
            n times: integers [ns] or floats [s].
        positions, velocities, accelerations : array-like
            Shape (n, D); (n,) if there is one dimension.
        timeout : float, optional
            Seconds to wait for room, in total.

        Returns
        -------
        int
            The number of the first item; the others follow in order.

        Raises
        ------
        Refused
            A waypoint was not accepted: `index` says which. Those before it were accepted.
        """
    def replace_from(
        self,
        t: Optional[Instant] = None,
        times: Optional[Instants] = None,
        positions: Optional[ArrayLike] = None,
        velocities: Optional[ArrayLike] = None,
        accelerations: Optional[ArrayLike] = None,
        blend: Seconds = 0.0,
    ) -> int:
        """Replace everything after time t by new waypoints, as one revision.

        The curve continues from its state at `t` by an entry onto the waypoints; without waypoints
        it comes to rest. If the solver takes it later than that, it takes effect as soon as
        possible, and passes over the waypoints before.

        Parameters
        ----------
        t : int or float, optional
            None: as soon as possible. Otherwise not before the settled time nor now + freeze_ahead,
            unless there are no waypoints: see `earliest`.
        times : array-like, optional
            n times, later than `t`.
        positions, velocities, accelerations : array-like, optional
            Shape (n, D).
        blend : float
            Least duration of the entry [s], at most 60; waypoints before its end are passed over.

        Returns
        -------
        int
            The number of the item; waypoint i is item 1 + i after it.

        Raises
        ------
        Refused
            The ring refuses the replacement: see its `status`.
        """
    def preview_replace(
        self,
        t: Optional[Instant] = None,
        times: Optional[Instants] = None,
        positions: Optional[ArrayLike] = None,
        velocities: Optional[ArrayLike] = None,
        accelerations: Optional[ArrayLike] = None,
        blend: Seconds = 0.0,
    ) -> ReplacePreview:
        """Compute what `replace_from` with these arguments would do now, and change nothing."""
    def start_from(
        self,
        t: Instant,
        position: ArrayLike,
        velocity: Optional[ArrayLike] = None,
        acceleration: Optional[ArrayLike] = None,
        moved: bool = False,
    ) -> int:
        """Set the state in which the stream starts, before its first waypoint: where the machine is.

        Parameters
        ----------
        t : int or float
            Before the first waypoint. A state that comes late begins as early as possible.
        position : array-like
            Shape (D,).
        velocity, acceleration : array-like, optional
            Shape (D,); default 0: at rest.
        moved : bool
            The machine was moved since an earlier stream of this name came to rest: the state is not
            compared with that end. With a position only nothing is appended: the machine rests
            there, and the first waypoint is compared with it.

        Returns
        -------
        int
            The number of the item.

        Raises
        ------
        Refused
            The ring refuses the state: see its `status`.
        """
    def stopped_by(self) -> List[str]:
        """Return the names of the stoppers that hold the stream: see `Stopper`. Reads the board."""
    def old_end(self) -> Optional[Tuple[int, NDArray[np.float64]]]:
        """Return where an earlier live stream of this name has left the machine.

        Returns
        -------
        tuple or None
            The earliest time at which this stream can start there [ns] and the position, shape (D,),
            for `start_from`; None if there is no such place, or this stream has started.
        """
    def finish(self, end: Condition = "halt", timeout: Optional[Seconds] = 0.0) -> int:
        """End the stream at its last waypoint.

        Parameters
        ----------
        end : str or (str, array-like)
            The boundary condition there; of a live stream 'halt' or 'clamped'.
        timeout : float, optional
            Seconds to wait for room if the ring is full.

        Returns
        -------
        int
            The number of the item.

        Raises
        ------
        BadRequest
            A stream cannot meet the condition.
        Refused
            The stream is already finished, or the ring is full.
        """
    def now(self) -> int:
        """Return the time of the stream's clock [ns]: stream time if the stream follows a law.

        CLOCK_MONOTONIC for another live stream, 0 for a recorded one.
        """
    def refusals(self) -> Refusals:
        """Return what the solver has refused since the last call.

        Returns
        -------
        Refusals
            A list of `ItemRefusal`: item, time, reason, excess.
        """
    def outcome(self, item: int) -> ItemOutcome:
        """Return what became of an item, by the newest revision.

        Parameters
        ----------
        item : int
            Its number: what the call that sent it returned. Waypoint i of a replacement has the
            number of the replacement + 1 + i.

        Returns
        -------
        ItemOutcome
            kind, time, way, reason, is_final. FORGOTTEN is never a guess: the board keeps the last
            256 outcomes that are not those of a waypoint on the spline at its own time, and the
            last 1,024 refusals, and a solver knows only the items that it took itself.
        """
    def wait_outcome(self, item: int, timeout: Optional[Seconds] = None) -> ItemOutcome:
        """Wait until it is known what became of an item; return its outcome.

        Parameters
        ----------
        item : int
            Its number.
        timeout : float, optional
            Seconds; then the outcome is WAITING or UNDECIDED.
        """
    def wait_for_solver(self, timeout: Optional[Seconds] = None) -> bool:
        """Wait until a solver has attached; return False after the timeout [s]."""
    def wait_for_room(self, timeout: Optional[Seconds] = None) -> bool:
        """Wait until the ring has room for a waypoint; return False after the timeout [s]."""
    def wait_until_consumed(self, timeout: Optional[Seconds] = None) -> bool:
        """Wait until the solver has consumed everything; return False after the timeout [s]."""
    def withdraw(self) -> None:
        """Remove the stream, to which no solver ever attached, and close the producer."""
    def close(self) -> None:
        """Give the stream up without finishing it. Closing again does nothing."""
    def __enter__(self: _Self) -> _Self:
        """Return the producer."""
    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        value: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None:
        """Finish with a full stop, unless already finished; then close.

        After an exception of the body a live stream stops at once, and ends where the stop rests.
        A recorded one is only closed.
        """
    @property
    def stream(self) -> str:
        """The stream's name."""
    @property
    def dimensions(self) -> int:
        """The number of dimensions, D."""
    @property
    def earliest(self) -> Optional[int]:
        """The earliest time at which a replacement sent now takes effect at its own time [ns].

        The later of the settled time and now + freeze_ahead, plus the longest pause of the solver
        in the last second, at least 0.2 ms. Of a recorded stream the settled time, or None.
        """
    @property
    def replacement_begin(self) -> Optional[ReplacementBegin]:
        """Where the motion of the last replacement begins, and whether at rest in a hold.

        None while the solver has not taken it, if it was refused, and if the board no longer
        keeps it.
        """
    @property
    def last_time(self) -> int:
        """Time of the newest item, of this or an earlier producer [ns]; 0 if there is none."""
    @property
    def last_item(self) -> int:
        """The number of the item of the last call that was accepted; of a replacement its own."""
    @property
    def appended(self) -> int:
        """Number of items appended, over the stream's life."""
    @property
    def consumed(self) -> int:
        """Number of these that the solver has consumed."""
    @property
    def continues(self) -> bool:
        """Whether the ring already held the items of an earlier producer."""
    @property
    def solver_alive(self) -> bool:
        """Whether a solver process lives. System calls."""
    @property
    def is_finished(self) -> bool:
        """Whether this producer has finished the stream."""
    @property
    def is_closed(self) -> bool:
        """Whether the producer is closed."""
    @property
    def is_memory_locked(self) -> bool:
        """Whether the region's pages are locked into memory (RLIMIT_MEMLOCK)."""
    @property
    def stream_id(self) -> int:
        """The stream's random number, the same in both of its regions."""

class Solver:
    """The role that turns waypoints into the curve: the one writer of a stream's spline.

    `start` runs it in a thread that never takes the GIL. A program with a loop of its own calls
    `attach`, `step` and `wait` instead. As a context manager it stops and closes at the end.

    Parameters
    ----------
    stream : str
        The stream, which need not exist yet.
    method : str, optional
        Default 'c2'; see `methods`.
    lam : float, optional
        λ of 'smoothing', which needs it: 0 to 1e100 s³.
    time_scale : float, optional
        Of 'rounded': the time that counts as one unit of position: above 0, at most 1e100 s;
        default 1 s.
    settle : int, optional
        The settle lag K, 0 to 64; default 8 for c2, 64 for smoothing, else the look-ahead of the
        method.
    tail : {'bessel', 'parabolic', 'natural', 'clamped'}, optional
        The condition at the newest knot while the stream continues; default bessel.
    force_lag : bool
        Of 'smoothing': accept a lag that is too short for λ.
    stop_time : float, optional
        Length of the stop segment [s]; with a limit of acceleration or jerk, its least length:
        above 0, at most 2⁶⁰ ns; default 250 ms.
    limits : mapping, optional
        By kind, 'velocity', 'acceleration', 'jerk', 'lower', 'upper': a number for all dimensions
        or one per dimension.
    named_limits : mapping, optional
        By dimension name: a mapping from kind to number.
    beyond : {'report', 'refuse', 'enter'}, optional
        What to do with a waypoint that makes the curve exceed a limit: report and accept it,
        refuse it, or leave the spline for an entry within the limits; default report.
    freeze_ahead : float, optional
        Live streams: the curve settles this long ahead of now [s]: 1 ns to 1 min; default 5 ms.
    history : float, optional
        Live streams: segments that ended less than this ago are kept [s]: 0 to 24 h; default 1 s.
    min_entry : float, optional
        Live streams: least length of an entry [s]: 1 ns to 1 min; default freeze_ahead.
    largest_rate : float, optional
        Of a time law: above 0, at most 100; default 1.
    capacity : int, optional
        Segments of history, 2(K + 6) + 2 to 2²²; default 4,096; rounded up to a power of two.
    wake : bool
        Wake waiting readers at each revision.
    mode : int
        Permission bits of the region.
    group : int, optional
        Group of the region.
    owner : int, optional
        A further user whose regions are trusted.

    Raises
    ------
    StreamBusy
        The stream has a living solver.
    BadRequest
        An invalid name or option.
    BadRegion
        The lock or a board of that name cannot be used.
    """

    def __init__(
        self,
        stream: str,
        method: Optional[str] = None,
        *,
        lam: Optional[Seconds] = None,
        time_scale: Optional[Seconds] = None,
        settle: Optional[int] = None,
        tail: Optional[str] = None,
        force_lag: bool = False,
        stop_time: Optional[Seconds] = None,
        limits: Optional[LimitValues] = None,
        named_limits: Optional[Mapping[str, Mapping[str, Seconds]]] = None,
        beyond: Optional[str] = None,
        freeze_ahead: Optional[Seconds] = None,
        history: Optional[Seconds] = None,
        min_entry: Optional[Seconds] = None,
        largest_rate: Optional[Seconds] = None,
        capacity: Optional[int] = None,
        wake: bool = True,
        mode: int = 0o600,
        group: Optional[int] = None,
        owner: Optional[int] = None,
    ) -> None: ...
    def start(self: _Self) -> _Self:
        """Start a thread that attaches, solves and waits until `stop`; return the solver.

        Raises
        ------
        RuntimeError
            The thread already runs.
        """
    def stop(self) -> None:
        """End the thread and raise the error that ended it, if one did. No thread: does nothing."""
    def close(self) -> None:
        """Stop, and give the stream up. Closing again does nothing."""
    def __enter__(self: _Self) -> _Self:
        """Return the solver."""
    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        value: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None:
        """Stop and close. After an exception of the body, keep that of the thread in `error`."""
    def attach(self) -> bool:
        """Attach to the stream; return False if it does not exist, or its old curve still moves.

        Raises
        ------
        BadRequest
            The options contradict a board that is taken over, or the limits do not fit.
        BadRegion
            A region cannot be used, continued or created.
        """
    def step(self) -> StepResult:
        """Consume waypoints and publish, without the GIL. Does nothing unless attached.

        Call it after each item that the producer appends, and no later than `due`.

        Raises
        ------
        BadRegion
            Another process has written to the board.
        """
    def wait(self, timeout: Optional[Seconds] = None) -> None:
        """Sleep until there may be work to do, at most 50 ms, or the timeout [s] if shorter."""
    def first_refusals(self) -> List[ItemRefusal]:
        """Return the first refusal for each reason, except those returned before."""
    def first_excess(self) -> Optional[LimitExcess]:
        """Return the first accepted waypoint with which the curve exceeds a limit, once."""
    @property
    def stream(self) -> str:
        """The stream's name."""
    @property
    def attached(self) -> bool:
        """Whether the solver has the stream."""
    @property
    def took_over(self) -> bool:
        """Whether it continued the board of a dead solver."""
    @property
    def due(self) -> Optional[int]:
        """When `step` must be called next [ns]; None: when an item arrives."""
    @property
    def is_running(self) -> bool:
        """Whether the thread runs."""
    @property
    def error(self) -> Optional[Exception]:
        """The error that ended the thread; None if there is none."""
    @property
    def is_closed(self) -> bool:
        """Whether the solver is closed."""
    @property
    def is_memory_locked(self) -> bool:
        """Whether the region's pages are locked into memory (RLIMIT_MEMLOCK)."""

class State:
    """A sample: position, velocity, acceleration and jerk at one time.

    Parameters
    ----------
    dimensions : int
        D, 1 to 64. All values are NaN until a sample writes them.
    """

    def __init__(self, dimensions: int) -> None: ...
    @property
    def position(self) -> Array:
        """Shape (D,), a view of the state's memory, as the next four are."""
    @property
    def velocity(self) -> Array:
        """Shape (D,) [unit/s]."""
    @property
    def acceleration(self) -> Array:
        """Shape (D,) [unit/s²]."""
    @property
    def jerk(self) -> Array:
        """Shape (D,) [unit/s³]."""
    @property
    def values(self) -> Array:
        """Shape (4, D): position, velocity, acceleration, jerk."""
    @property
    def status(self) -> SampleStatus:
        """The validity of the last sample; NO_DATA before the first."""
    @property
    def time(self) -> int:
        """The time of the last sample [ns]."""
    @property
    def dimensions(self) -> int:
        """The number of dimensions, D."""

class Block:
    """Samples at n times under one revision, made by `Reader.sample_many`."""

    @property
    def values(self) -> Array:
        """Shape (n, derivatives, D): for 'pvaj' [time][position, velocity, …][dimension]."""
    @property
    def status(self) -> NDArray[np.uint8]:
        """Shape (n,): a `SampleStatus` for each time. Values without a valid status are NaN."""
    @property
    def revision(self) -> int:
        """The revision of all samples; 0: none could be read, and `status` says why."""
    @property
    def derivatives(self) -> str:
        """Which derivatives `values` has, in order: letters of 'pvaj'."""
    @property
    def shape(self) -> Tuple[int, int, int]:
        """The shape of `values`."""
    def __len__(self) -> int:
        """The number of times."""
    def __getitem__(self, key: Any) -> Any:
        """Return a part of `values`."""
    def __array__(self, dtype: Any = None) -> Array:
        """Return `values`, for numpy."""

class Snapshot:
    """Consecutive segments of one revision: a consistent part of the curve, or none."""

    @property
    def status(self) -> SampleStatus:
        """SETTLED or PROVISIONAL for the whole; else there are no segments."""
    @property
    def revision(self) -> int:
        """The revision of all segments; 0: none."""
    @property
    def settled_until(self) -> Optional[int]:
        """The time before which no later revision changes the curve [ns]; None: none is known."""
    @property
    def segments(self) -> List[Segment]:
        """The segments, oldest first, as solved: periodic values are not wrapped."""
    def curve(self) -> Curve:
        """Return the segments as a curve. Raises BadRequest if there are none."""
    def to_ppoly(self, origin: Instant = 0) -> Any:
        """Return the segments as a scipy.interpolate.PPoly: see `Curve.to_ppoly`."""
    def __len__(self) -> int:
        """The number of segments."""

class Reader:
    """The role that samples the curve. Any number of processes may read one stream.

    Parameters
    ----------
    stream : str
        The stream's name.
    timeout : float, optional
        Seconds to wait for the stream and its solver; None waits without end.
    owner : int, optional
        A further user whose regions are trusted.

    Raises
    ------
    NoSuchStream
        The stream did not appear before the timeout.
    BadRequest
        An invalid name.
    BadRegion
        The stream's region cannot be used.
    """

    def __init__(
        self, stream: str, timeout: Optional[Seconds] = 0.0, owner: Optional[int] = None
    ) -> None: ...
    def sample(self, t: Instant, out: Optional[State] = None) -> State:
        """Evaluate position, velocity, acceleration and jerk at time t.

        A sample counts as executed: if a later revision changes the curve at or before the latest
        time sampled, the next sample is REVISED, once.

        Parameters
        ----------
        t : int or float
            A time of the stream's clock [int ns or float s]; of a stream that follows a time law,
            host time. Derivatives are by host time.
        out : State, optional
            Written and returned instead of a new state; nothing is allocated. Without values its
            memory stays as it is.

        Returns
        -------
        State
            Check its `status`.

        Raises
        ------
        BadRequest
            On a live stream: `t` is before or after the curve, and more than an hour from
            `time.monotonic()`.
        """
    def preview(self, t: Instant, out: Optional[State] = None) -> State:
        """Sample ahead of `settled_until`: as `sample`, but does not count as executed."""
    def sample_many(
        self,
        times: Instants,
        out: Union[Block, Array, None] = None,
        derivatives: str = "pvaj",
    ) -> Block:
        """Evaluate the curve at many times, all under one revision.

        Parameters
        ----------
        times : array-like
            n times in any order: integers [ns] or floats [s].
        out : Block or array, optional
            A block is written and returned instead of a new one. Nothing is allocated if it has n
            times and `times` is an array of int64 or float64; its own derivatives are used. An
            array of shape (n, 4, D) becomes the values of the block that is returned.
        derivatives : str
            Letters of 'pvaj' in this order.

        Returns
        -------
        Block
            Shape (n, 4, D) for all derivatives.
        """
    def snapshot(self, start: Instant, end: Instant) -> Snapshot:
        """Copy the segments that overlap the interval from `start` to `end`."""
    def wait(self, timeout: Optional[Seconds] = None) -> bool:
        """Wait for a revision that this reader has not seen; return False after the timeout [s].

        Raises
        ------
        NoSuchStream
            The stream was removed or created again: make a new Reader.
        """
    def excess(self, state: State) -> Excess:
        """Compare a sample with the stream's limits."""
    def progress(self) -> Optional[Progress]:
        """Return the progress of the curve; None if there is none yet, or the writer overtook."""
    def alive(self) -> Alive:
        """Return which writers live. System calls: not for a control loop."""
    def rate(self) -> LawRate:
        """Return the rate of the law that the stream follows, as the last sample or preview saw it.

        Returns
        -------
        LawRate
            stream_time, rate, slope. Of a stream without a law: rate 1, stream time 0.
        """
    def close(self) -> None:
        """Unmap the stream. Closing again does nothing."""
    def __enter__(self: _Self) -> _Self:
        """Return the reader."""
    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        value: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None:
        """Close."""
    @property
    def stream(self) -> str:
        """The stream's name."""
    @property
    def dimensions(self) -> int:
        """The number of dimensions, D."""
    @property
    def names(self) -> List[str]:
        """One name per dimension, or none."""
    @property
    def units(self) -> List[str]:
        """One unit per dimension, or none."""
    @property
    def kinds(self) -> List[str]:
        """One kind per dimension, as `Producer` takes them."""
    @property
    def clock(self) -> str:
        """'monotonic' for a live stream, 'recorded' for a recorded one, 'law' if it follows a law."""
    @property
    def limits(self) -> Limits:
        """The stream's limits by kind; empty if it has none."""
    @property
    def settled_until(self) -> Optional[int]:
        """The settled time of the curve that the last sample used [ns]; None before the first."""
    @property
    def first_time(self) -> Optional[int]:
        """Time of the oldest knot that the board keeps [ns]; None if there is none."""
    @property
    def is_closed(self) -> bool:
        """Whether the reader is closed."""
    @property
    def is_memory_locked(self) -> bool:
        """Whether the region's pages are locked into memory (RLIMIT_MEMLOCK)."""

class RateCommander:
    """Requests the rate of a time law: a panel, a feed hold, an emergency stop.

    A law maps host time to the stream time of all streams that follow it; its rate is stream time
    per host time, the least that its commanders request. Its solver creates the law when the first
    commander appears. When a commander ends, its last request remains in force until a commander of
    the same name makes another one, or until its dead man expires.

    Parameters
    ----------
    law : str
        The law's name.
    commander : str
        The commander's name, such as 'operator' or 'estop'.
    mode : int
        Permission bits of the region.
    group : int, optional
        Group of the region.
    owner : int, optional
        A further user whose regions are trusted.

    Raises
    ------
    StreamBusy
        The law has a living commander of this name.
    BadRequest
        An invalid name.
    BadRegion
        Shared memory is full, or the files of that name cannot be used.
    """

    def __init__(
        self,
        law: str,
        commander: str,
        *,
        mode: int = 0o600,
        group: Optional[int] = None,
        owner: Optional[int] = None,
    ) -> None: ...
    def set_rate(self, rate: Seconds, ramp: Seconds, *, wait: Optional[Seconds] = None) -> int:
        """Request a rate, reached by a ramp.

        Parameters
        ----------
        rate : float
            0 to the law's largest rate; while no solver has begun the law, 0 to 100.
        ramp : float
            Length of the ramp [s], 0.001 to 3600. A rise that it interrupts is first flattened,
            within a quarter of it.
        wait : float, optional
            Return when the request is in force: when the law's solver has committed it. For at most this time [s].
            Without it, do not wait.

        Returns
        -------
        int
            The number of the request.

        Raises
        ------
        BadRequest
            A value out of range.
        TimeoutError
            The request is not in force after `wait`. It remains.
        """
    def hold(self, ramp: Seconds, *, wait: Optional[Seconds] = None) -> int:
        """Request rate 0, reached by a ramp of this length [s]. `wait` and the result are those of `set_rate`."""
    def release(self, ramp: Seconds, *, wait: Optional[Seconds] = None) -> int:
        """Withdraw the request: the law has the least rate of the others, or 1 if there is none.

        `wait` and the result are those of `set_rate`.
        """
    def set_dead_man(self, timeout: Seconds, ramp: Seconds = 0.5) -> None:
        """Hold the law unless a request is renewed within this time [s], 0.001 to 3600; 0: never.

        In force from the next request on. The hold has a ramp of this length [s], 0.001 to 3600, and lasts until the
        next request: a renewal that comes too late does not end it.
        """
    def renew(self) -> bool:
        """Renew the last request, for `set_dead_man`.

        Returns False, and does nothing, if the dead man of that request has fired: make another request.
        """
    def close(self) -> None:
        """Give the name up. The last request remains in force. Closing again does nothing."""
    def __enter__(self: _Self) -> _Self:
        """Return the commander."""
    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        value: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None:
        """Close."""
    @property
    def law(self) -> str:
        """The law's name."""
    @property
    def commander(self) -> str:
        """The commander's name."""
    @property
    def is_closed(self) -> bool:
        """Whether the commander is closed."""

class Stopper:
    """Stops a live stream from any process: a latched stop. It is not a safety function.

    The next step of the solver begins a stop at the settled time, and then refuses waypoints, start states and
    replacements as `stopped` until all stoppers of the stream have released it. A finish is taken, and ends the stream
    where the stop rests. The request stays in force when this object or its process ends, when the solver ends, and
    when the stream is created again. It may be made before there is a stream. A recorded stream and a time law have no
    stoppers.

    Parameters
    ----------
    stream : str
        The stream's name.
    stopper : str
        The stopper's name, such as 'operator' or 'panel'.
    mode : int
        Permission bits of the region.
    group : int, optional
        Group of the region.
    owner : int, optional
        A further user whose regions are trusted.

    Raises
    ------
    StreamBusy
        The stream has a living stopper of this name.
    BadRequest
        An invalid name.
    BadRegion
        Shared memory is full, or the files of that name cannot be used.
    """

    def __init__(
        self,
        stream: str,
        stopper: str,
        *,
        mode: int = 0o600,
        group: Optional[int] = None,
        owner: Optional[int] = None,
    ) -> None: ...
    def stop(self, *, wait: Optional[Seconds] = None) -> int:
        """Request that the stream stop, and stay. Does nothing if that is requested already.

        Parameters
        ----------
        wait : float, optional
            Return when the request is in force: when the stream's solver has committed it. For at most this time [s].
            Without it, do not wait.

        Returns
        -------
        int
            The number of the request.

        Raises
        ------
        TimeoutError
            The request is not in force after `wait`. It remains.
        """
    def release(self, *, wait: Optional[Seconds] = None) -> int:
        """Withdraw the request. `wait` and the result are those of `stop`."""
    def close(self) -> None:
        """Give the name up. Does not release the stream. Closing again does nothing."""
    def __enter__(self: _Self) -> _Self:
        """Return the stopper."""
    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        value: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None:
        """Close. Does not release the stream."""
    @property
    def is_latched(self) -> bool:
        """Whether this stopper, or an earlier one of its name, requests the stop."""
    @property
    def stream(self) -> str:
        """The stream's name."""
    @property
    def stopper(self) -> str:
        """The stopper's name."""
    @property
    def is_closed(self) -> bool:
        """Whether the stopper is closed."""

class Curve:
    """A piecewise polynomial of D dimensions, made by `fit` or `Snapshot.curve`."""

    def __call__(
        self, t: Union[Instant, Instants, ArrayLike], nu: int = 0, extrapolate: bool = False
    ) -> Any:
        """Evaluate the curve or a derivative.

        Parameters
        ----------
        t : int, float or array-like
            Times of any shape: integers [ns] or floats [s].
        nu : int
            The derivative, 0 or more.
        extrapolate : bool
            Continue the first and the last polynomial beyond the ends.

        Returns
        -------
        numpy.ndarray or float
            Shape of `t` followed by (D,); without it if the positions were one-dimensional: a float
            for a single time.

        Raises
        ------
        BadRequest
            A time is outside the curve, which the message names, or NaN.
        """
    def to_ppoly(self, origin: Instant = 0) -> Any:
        """Return the same curve as a scipy.interpolate.PPoly, in seconds after `origin`.

        Give `breaks[0]` as the origin of a curve whose times are large, such as those of a clock:
        a float of seconds does not hold them to the nanosecond.

        Raises
        ------
        BadRequest
            The curve is the hold of a single waypoint.
        """
    @property
    def breaks(self) -> NDArray[Any]:
        """The times of the knots, as they were given: int64 [ns] or float64 [s]."""
    @property
    def dimensions(self) -> int:
        """The number of dimensions, D."""
    @property
    def method(self) -> Optional[str]:
        """The method of the fit; None for a snapshot."""
    @property
    def lam(self) -> Optional[float]:
        """λ of a smoothing fit [s³]; None for other methods."""
    def __len__(self) -> int:
        """The number of segments."""

def fit(
    times: Instants,
    positions: ArrayLike,
    velocities: Optional[ArrayLike] = None,
    accelerations: Optional[ArrayLike] = None,
    method: str = "c2",
    start: Optional[Condition] = None,
    end: Optional[Condition] = None,
    lam: Optional[Seconds] = None,
    time_scale: Seconds = 1.0,
) -> Curve:
    """Fit a curve through all waypoints at once, or near them for 'smoothing'.

    Parameters
    ----------
    times : array-like
        n increasing times: integers [ns] or floats [s]. Float times are used exactly, up to
        2**-62 of their range.
    positions : array-like
        Shape (n, D), or (n,) for a curve of numbers.
    velocities, accelerations : array-like, optional
        The same shape; 'hermite' and 'quintic' need velocities, 'quintic' also accelerations.
    method : str
        See `methods`.
    start, end : str or (str, array-like), optional
        Boundary conditions: 'natural', 'clamped', 'halt', 'velocity=1,2' or ('velocity', values),
        'acceleration=…', 'not-a-knot', 'periodic'. Default: the method's own; of 'c2' natural.
    lam : float, optional
        λ of 'smoothing' [s³]; default: by generalised cross-validation.
    time_scale : float
        Of 'rounded': the seconds that count as one unit of position.

    Returns
    -------
    Curve

    Raises
    ------
    BadRequest
        The message names the value, such as a time that does not increase, and its index.
    """

def cross_validated_lambda(times: Instants, positions: ArrayLike) -> float:
    """Return the λ [s³] that generalised cross-validation chooses for 'smoothing'."""

def methods(streaming: bool = False) -> List[str]:
    """Return the names of all methods, or of those that stream; 'c2' is the first."""

def streams() -> List[str]:
    """Return the sorted names of all streams that have a region or a lock on this host."""

def remove(stream: str, owner: Optional[int] = None) -> None:
    """Remove a stream.

    Raises
    ------
    NoSuchStream
        There is no stream of this name.
    StreamBusy
        A writer of the stream lives.
    """
