"""The targets of the benchmarks: comparisons of a row with a peer, and bounds on a value of a row."""

DIMENSIONS = (1, 3, 6, 7, 16, 32)


class Target:
    """The comparison of a subject with a peer, and the ratio to reach.

    With `faster`, (time of the peer / time of the subject) must be at least `bound`; without it,
    (time of the subject / time of the peer) must be at most `bound`.
    `key` and `peer_key` name the compared times; `what` describes the time of the subject.
    """

    def __init__(self, subject, peer, bound, faster=False, key="ns", peer_key="ns", what=""):
        self.subject, self.peer, self.bound, self.faster = subject, peer, bound, faster
        self.key, self.peer_key, self.what = key, peer_key, what

    @property
    def name(self):
        """The key of the ratio in the results."""
        return f"{self.subject} [{self.key}] / {self.peer} [{self.peer_key}]"

    def text(self):
        return f"≥ {self.bound:g} × faster" if self.faster else f"≤ {self.bound:g} ×"

    def reached(self, ratio):
        return ratio >= self.bound if self.faster else ratio <= self.bound

    def ratios(self, runs):
        """One ratio for each block of each group in which both ran."""
        subjects, peers = runs.get(self.subject, {}), runs.get(self.peer, {})
        pairs = [(subjects[at][self.key], peers[at][self.peer_key]) for at in sorted(subjects.keys() & peers.keys())]
        return [peer / subject if self.faster else subject / peer for subject, peer in pairs]


class Bound:
    """A bound on a value of a row, without a peer.

    `key` names the value; value / `size` is in `unit`. `needs` is the key and the minimum of another value of the row:
    if that is below its minimum, the bound is not reached.
    """

    def __init__(self, subject, key, unit, size=1, least=None, most=None, what="", needs=None):
        self.subject, self.key, self.unit, self.size = subject, key, unit, size
        self.least, self.most, self.what, self.needs = least, most, what, needs

    def text(self):
        return f"≥ {self.least:,} {self.unit}" if self.most is None else f"≤ {self.most:,} {self.unit}"

    def reached(self, value):
        return value >= self.least if self.most is None else value <= self.most


TARGETS = [
    *(Target(f"sample/dims:{d}", f"floor/eval/dims:{d}", 1.8) for d in DIMENSIONS),
    Target("sample_many/dims:7/times:50", "floor/eval/dims:7", 1.3, what="per time"),
    Target("sample/dims:7", "gsl/sample/dims:7", 9, faster=True),
    Target("sample_random/dims:7", "gsl/sample_random/dims:7", 4, faster=True),
    Target("sample/dims:7/writer:100Hz", "sample/dims:7/writer:quiet", 1.5, key="mean_ns", peer_key="mean_ns"),
    Target("sample/dims:7/writer:1kHz", "sample/dims:7/writer:quiet", 2, key="mean_ns", peer_key="mean_ns"),
    Target("sample/dims:7/writer:100Hz", "floor/ping", 1.5, key="new_revision_p50_ns",
           what="first sample of a revision"),
    Target("append/dims:7/settle:8", "gsl/append/dims:7", 700, faster=True),
    Target("append/dims:7/settle:16", "gsl/append/dims:7", 550, faster=True),
    Target("append/dims:7/settle:8", "makima/append/dims:7", 1),
    Target("append/dims:7/settle:8/after:10000000", "append/dims:7/settle:8", 1.1),
    Target("publish/dims:7/readers:0", "append/dims:7/settle:8", 2),
    Target("publish/dims:7/readers:0", "floor/ping", 1.2),
    Target("publish/dims:7/readers:1", "publish/dims:7/readers:0", 1.15),
    Target("publish/dims:7/readers:16", "publish/dims:7/readers:0", 1.15),
    Target("publish/dims:7/readers:64", "publish/dims:7/readers:0", 1.15),
    Target("roundtrip/embedded", "floor/ping", 2.5),
    Target("roundtrip/solver", "floor/ping", 3.5),
    Target("roundtrip/embedded", "iceoryx/roundtrip", 4, faster=True),
    Target("roundtrip/solver", "iceoryx/roundtrip", 4, faster=True),
]

BOUNDS = [
    Bound("attach/dims:7/knots:4096", "p50_ns", "ms", size=1e6, most=1, what="p50"),
    Bound("attach/dims:7/knots:4096", "p99_ns", "ms", size=1e6, most=1, what="p99"),
    Bound("board/dims:7/knots:4096", "region_bytes", "MB", size=1e6, most=2.25, what="size of the region"),
    *(Bound(f"plan/dims:7/limits:{limits}", key, "µs", size=1e3, most=most, what=what)
      for limits in (0, 1)
      for key, most, what in (("p50_ns", 20, "a step of the return, p50"), ("worst_ns", 1000, "the same, worst"))),
    Bound("replay/dims:7", "items_per_second", "waypoints/s", least=1_000_000),
    Bound("replay/mcap:recorded_stream/dims:7", "items_per_second", "waypoints/s", least=500_000),
    Bound("replay/mcap:joint_states/dims:7", "items_per_second", "waypoints/s", least=500_000),
    Bound("parse/dims:7", "bytes_per_second", "MB/s", size=1e6, least=150),
    Bound("streams:1000/idle", "core_percent", "% of a core", most=1),
    Bound("streams:1000/busy:100Hz", "core_percent", "% of a core", most=10, needs=("waypoints_per_s", 95_000)),
]
