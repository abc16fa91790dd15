"""The sections of docs/benchmarks.md: the headline figures, and the rows and tables of each topic."""

import details
from markdown import item, median_of, natural, range_of, table
from targets import DIMENSIONS, TARGETS


class Headline:
    """A row of the first table: a value of a benchmark, and a target whose ratio it shows."""

    def __init__(self, text, row, key="ns", unit="ns", size=1, target=None, peer=""):
        self.text, self.row, self.key, self.unit, self.size = text, row, key, unit, size
        self.target, self.peer = target, peer

    def cells(self, results):
        values = results["rows"].get(self.row, {}).get(self.key)
        ratios = results["ratios"].get(self.target.name) if self.target else None
        ratio = f"{median_of(ratios)} × {'faster than ' if self.target.faster else ''}{self.peer}" if ratios else ""
        return [self.text, f"{median_of(values, self.size)} {self.unit}", ratio] if values else None


def target(subject, peer):
    return next(one for one in TARGETS if (one.subject, one.peer) == (subject, peer))


HEADLINES = [
    Headline("sample, steps of 1 ms through knots at 100 Hz", "sample/dims:7",
             target=target("sample/dims:7", "gsl/sample/dims:7"), peer="GSL"),
    Headline("the same", "sample/dims:7", target=target("sample/dims:7", "floor/eval/dims:7"),
             peer="the polynomial alone"),
    Headline("sample at a random time in 65,536 segments", "sample_random/dims:7",
             target=target("sample_random/dims:7", "gsl/sample_random/dims:7"), peer="GSL"),
    Headline("waypoint through the window, K = 8", "append/dims:7/settle:8",
             target=target("append/dims:7/settle:8", "gsl/append/dims:7"), peer="GSL, 1,024 knots again"),
    Headline("waypoint through the window, K = 16", "append/dims:7/settle:16",
             target=target("append/dims:7/settle:16", "gsl/append/dims:7"), peer="GSL, 1,024 knots again"),
    Headline("waypoint appended, solved and published, K = 8", "publish/dims:7/readers:0",
             target=target("publish/dims:7/readers:0", "floor/ping"), peer="a ping between two cores"),
    Headline("round trip, solver in the producer's process, p50", "roundtrip/embedded", "p50_ns",
             target=target("roundtrip/embedded", "iceoryx/roundtrip"), peer="iceoryx"),
    Headline("round trip, solver in its own process, p50", "roundtrip/solver", "p50_ns",
             target=target("roundtrip/solver", "iceoryx/roundtrip"), peer="iceoryx"),
    Headline("search for an entry with limits, a step, p50", "plan/dims:7/limits:1", "p50_ns", "µs", 1e3),
    Headline("attach and first sample, p50", "attach/dims:7/knots:4096", "p50_ns", "ms", 1e6),
    Headline("CSV text to a table", "parse/dims:7", "bytes_per_second", "MB/s", 1e6),
    Headline("CSV text to settled segments", "replay/dims:7", "items_per_second", "waypoints/s"),
    Headline("MCAP recording (zstd) to settled segments", "replay/mcap:recorded_stream/dims:7", "items_per_second",
             "waypoints/s"),
    Headline("1,000 live streams at 100 Hz, one solver", "streams:1000/busy:100Hz", "core_percent", "% of a core"),
    Headline("1,000 idle streams, one solver", "streams:1000/idle", "core_percent", "% of a core"),
    Headline("shared memory of a board of 4,096 knots", "board/dims:7/knots:4096", "region_bytes", "MB", 1e6),
]


class Topic:
    """A section: what its rows measure, and its tables.

    `kinds` are names of rows with a time for each number of dimensions; `trips` are prefixes of the names of rows of
    single trips; `values` are (row, key, unit, size) of other rows.
    """

    def __init__(self, title, rows, kinds=(), trips=(), values=()):
        self.title, self.rows, self.kinds, self.trips, self.values = title, rows, kinds, trips, values

    def lines(self, results):
        rows = results["rows"]
        lines = [f"## {self.title}", "", *map(item, self.rows), ""]
        kinds = [[f"`{kind.replace('/dims:{}', '')}`", *(time_of(rows, kind.format(d)) for d in DIMENSIONS)]
                 for kind in self.kinds]
        lines += table(["ns, by dimensions", *map(str, DIMENSIONS)], [row for row in kinds if any(row[1:])])
        lines += table(["single trips", "p50", "p99"],
                       [trip(name, rows[name]) for name in sorted(rows, key=natural)
                        if name.startswith(tuple(self.trips)) and "p99_ns" in rows[name]])
        values = [[f"`{name}`", f"{median_of(rows[name][key], size)} {unit}", range_of(rows[name][key], size)]
                  for name, key, unit, size in self.values if key in rows.get(name, {})]
        return lines + table(["row", "median", "range"], values)


def time_of(rows, name):
    return median_of(rows[name]["ns"]) if name in rows else ""


def trip(name, row):
    size, unit = details.trip_unit(name)
    return [f"`{name}`", *(f"{median_of(row[key], size)} {unit}" for key in ("p50_ns", "p99_ns"))]


TOPICS = [
    Topic("Sampling", [
        "`sample`: position, velocity, acceleration and jerk through the public `Reader`, in steps of 1 ms through "
        "knots at 100 Hz",
        "`sample/…/writer:…`: the same, while another process publishes at this rate",
        "`sample/…/beside:replay`: samples in the segments that revisions change, one after the other, while `replay "
        "--embedded --rate max` writes the board on the other core, with one revision for up to 256 waypoints",
        "`sample/…/beside:publish`: the same beside a writer that commits a revision for each waypoint, as fast as "
        "possible",
        "`sample_random`: samples at random times in 65,536 segments",
        "`sample_many`: 50 times, 2 ms apart, from one revision by one call, per time; the first time is 1 ms later "
        "from call to call, as for a predictive controller at 1 kHz; knots at 100 Hz",
        "`floor/eval`: the polynomial alone, from this process's own memory",
        "`gsl/sample`: the GNU Scientific Library, a cubic spline and an accelerator per dimension in this process: "
        "position, velocity, acceleration",
    ], kinds=["floor/eval/dims:{}", "sample/dims:{}", "sample_many/dims:{}/times:50", "sample_random/dims:{}",
              "gsl/sample/dims:{}", "gsl/sample_random/dims:{}"],
        trips=["sample/"]),
    Topic("Appending", [
        "`append`: one waypoint through the window, and out as a settled segment; `settle` is the settle lag K",
        "`makima/append`: `push_back` of boost::math::interpolators::makima",
        "`gsl/append`: GSL solves 1,024 knots again",
        "`eigen/append`: Eigen sets up and solves the equations of the same window, K = 8, for each waypoint. On the "
        "same machine beside other programs, medians of 5: a dense LLT or LU of fixed size takes 11 × the CPU time of "
        "`append`, SimplicialLDLT 11 ×, SparseLU 34 ×",
    ], kinds=["append/dims:{}/settle:8", "append/dims:{}/settle:16", "append/dims:{}/settle:8/after:10000000",
              "makima/append/dims:{}", "gsl/append/dims:{}"]),
    Topic("Publishing", [
        "`publish`: one waypoint appended to the ring, solved and published, beside readers that poll at 1 kHz on the "
        "other core",
    ], kinds=["publish/dims:{}/readers:0", "publish/dims:{}/readers:1", "publish/dims:{}/readers:16",
              "publish/dims:{}/readers:64"]),
    Topic("Round trips", [
        "`roundtrip/embedded`: one core appends and publishes; the other samples, and acknowledges on a cache line",
        "`roundtrip/solver`: one core appends; the other solves and publishes; the first samples",
        "`…/settle:0`: with settle lag 0, where a waypoint changes the fewest knots",
        "`iceoryx/roundtrip`: iceoryx 2.0.3 sends the same payload there and back, polled, with its own iox-roudi",
        "`floor/ping`: one word each way over two cache lines between the two cores",
    ], trips=["floor/ping", "roundtrip/", "iceoryx/"]),
    Topic("Entries", [
        "`plan`: each step of a solver that returns to the waypoints after 300 ms of silence, with limits and without: "
        "it consumes the waypoints that arrive at once, searches for an entry and publishes it",
    ], trips=["plan/"]),
    Topic("Attaching and memory", [
        "`attach`: from the constructor of `Reader` to the first sample, of another process's stream whose board holds "
        "4,096 knots; the same process attaches repeatedly",
        "`board`: bytes of the region that the solver writes",
    ], trips=["attach/"], values=[("board/dims:7/knots:4096", "region_bytes", "MB", 1e6)]),
    Topic("Files", [
        "`replay`: CSV text, or an MCAP file with zstd of 10⁶ waypoints (`mcap`: of `record`, or JointState of rosbag2), "
        "to settled segments in shared memory, one thread",
        "`parse`: CSV text to a table",
    ], values=[("replay/dims:7", "items_per_second", "waypoints/s", 1),
               ("replay/mcap:recorded_stream/dims:7", "items_per_second", "waypoints/s", 1),
               ("replay/mcap:joint_states/dims:7", "items_per_second", "waypoints/s", 1),
               ("parse/dims:7", "bytes_per_second", "MB/s", 1e6)]),
    Topic("Many streams", [
        "`streams:1000/busy:100Hz`: share of a core that one process uses to solve a thousand streams of seven "
        "dimensions, with producers in another process; it polls them every millisecond",
        "`streams:1000/idle`: the same while the streams have been idle for a second: it polls each every 20 ms",
        "`streams:10/idle`: ten idle streams; each wake-up, every 20 ms, polls all ten",
        "`idle_append`: from an append to one of a thousand idle streams, at a random instant, until a reader gets the "
        "curve through the new knot; the expected p50 is half of the 20 ms between two polls",
    ], trips=["idle_append/"], values=[(f"streams:{name}", "core_percent", "% of a core", 1)
                                       for name in ("1000/busy:100Hz", "1000/idle", "10/idle")]),
]
