"""Writes bench/README.md to standard output: ratios of a run of the benchmarks in blocks.

    page.py BENCH.json SPLINECAST_BENCH
"""

import json
import platform
import statistics
import subprocess
import sys
from collections import defaultdict

import profile_paths

DIMENSIONS = (1, 3, 6, 7, 16, 32)


class Target:
    """The comparison of a subject with a peer, and the ratio to reach.

    `faster`: peer's time / subject's must be at least `bound`; else subject's / peer's at most.
    `key` and `peer_key` name the compared times; `what` describes the subject's.
    """

    def __init__(self, subject, peer, bound, faster=False, key="ns", peer_key="ns", what=""):
        self.subject, self.peer, self.bound, self.faster = subject, peer, bound, faster
        self.key, self.peer_key, self.what = key, peer_key, what

    def ratio(self, subject, peer):
        return peer / subject if self.faster else subject / peer

    def text(self):
        return f"≥ {self.bound:g} × faster" if self.faster else f"≤ {self.bound:g} ×"

    def reached(self, ratio):
        return ratio >= self.bound if self.faster else ratio <= self.bound

    def ratios(self, runs):
        """One ratio for each block of each group in which both ran."""
        subjects, peers = runs.get(self.subject, {}), runs.get(self.peer, {})
        return [self.ratio(subjects[at][self.key], peers[at][self.peer_key])
                for at in sorted(subjects.keys() & peers.keys())]


class Bound:
    """A bound on a value of a run, without a peer.

    `key` names the value, of which `size` make one `unit`. `needs` is another value and its minimum, below which the
    first one has no meaning.
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
    Bound("board/dims:7/knots:4096", "region_bytes", "MB", size=1e6, most=2.2, what="size of the region"),
    *(Bound(f"plan/dims:7/limits:{limits}", key, "µs", size=1e3, most=most, what=what)
      for limits in (0, 1)
      for key, most, what in (("p50_ns", 20, "a step of the return, p50"), ("worst_ns", 1000, "the same, worst"))),
    Bound("replay/dims:7", "items_per_second", "waypoints/s", least=1_000_000),
    Bound("parse/dims:7", "bytes_per_second", "MB/s", size=1e6, least=150),
    Bound("streams:1000/idle", "core_percent", "% of a core", most=1),
    Bound("streams:1000/busy:100Hz", "core_percent", "% of a core", most=10, needs=("waypoints_per_s", 95_000)),
]


# Google Benchmark ends a run early if other programs use the processor; a run with less CPU time than this measured
# only cold caches.
LEAST_MEASURED_NS = 1e6

# Keys of the runs that measured something else than their own CPU time.
OTHER_MEASURES = {"p50_ns", "core_percent", "region_bytes"}


def read_runs(document):
    """Returns name → runs by group and block, and the number of runs that were cut short, which are left out. `ns`
    of a run is its CPU time (per time if it samples many at once), or p50 if it measured trips."""
    runs = defaultdict(dict)
    cut_short = 0
    for run in document["runs"]:
        if not OTHER_MEASURES & run.keys() and run["iterations"] * run["cpu_ns"] < LEAST_MEASURED_NS:
            cut_short += 1
            continue
        name = run["name"].replace("/iterations:1", "").replace("/iterations:3", "").replace("/manual_time", "")
        run["ns"] = run.get("p50_ns", run["cpu_ns"] / run.get("times", 1))
        runs[name][run["group"], run["block"]] = run
    return runs, cut_short


def column(runs, name, key="ns"):
    return [run[key] for _, run in sorted(runs.get(name, {}).items()) if key in run]


def number(x):
    if x >= 1000 or x == 0:
        return f"{x:,.0f}"
    return f"{x:.0f}" if x >= 100 else f"{x:.1f}" if x >= 10 else f"{x:.2f}"


def spread(values):
    return f"{number(min(values))} – {number(max(values))}"


def table(heads, rows):
    print("| " + " | ".join(heads) + " |")
    print("|" + "---|" * len(heads))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def subject_text(row):
    return f"`{row.subject}`" + (f", {row.what}" if row.what else "")


def print_targets(runs):
    """Prints the table and returns the subjects that have missed a target."""
    rows, missed = [], []

    def add(row, peer, values, unit="", complaint=""):
        if not values:
            rows.append([subject_text(row), peer, row.text(), "not run", "", "", ""])
            return
        median = statistics.median(values)
        reached = row.reached(median) and not complaint
        rows.append([subject_text(row), peer, row.text(), f"**{number(median)}**{unit}", spread(values),
                     str(len(values)), "reached" if reached else "not reached" + complaint])
        if not reached:
            missed.append(row.subject)

    for target in TARGETS:
        add(target, f"`{target.peer}`", target.ratios(runs))
    for bound in BOUNDS:
        complaint = ""
        if bound.needs:
            found = statistics.median(column(runs, bound.subject, bound.needs[0]) or [0])
            if found < bound.needs[1]:
                complaint = f": {bound.needs[0]} was {number(found)}"
        values = [value / bound.size for value in column(runs, bound.subject, bound.key)]
        add(bound, "", values, " " + bound.unit.split(" of ")[0], complaint)
    table(["subject", "against", "target", "median", "range", "blocks", ""], rows)
    few = column(runs, "streams:10/idle", "core_percent")
    if few:
        print(f"Ten idle streams take {number(statistics.median(few))} % of a core: a wake-up every 20 ms, each "
              "of which polls all ten.\n")
    return missed


def print_times(runs):
    def cell(name):
        return number(statistics.median(column(runs, name))) if runs.get(name) else ""

    kinds = ["floor/eval/dims:{}", "sample/dims:{}", "sample_many/dims:{}/times:50", "gsl/sample/dims:{}",
             "append/dims:{}/settle:8", "append/dims:{}/settle:16", "makima/append/dims:{}",
             "gsl/append/dims:{}", "publish/dims:{}/readers:0"]
    table(["ns at dims"] + [str(d) for d in DIMENSIONS],
          [[f"`{kind.replace('/dims:{}', '')}`"] + [cell(kind.format(d)) for d in DIMENSIONS]
           for kind in kinds])


# Trips that are reported in milliseconds.
LONG_TRIPS = ("attach/", "idle_append/")


def print_trips(runs):
    rows, long_rows = [], []
    for name in sorted(runs):
        p50, p99 = column(runs, name, "p50_ns"), column(runs, name, "p99_ns")
        if not p50:
            continue
        is_long = name.startswith(LONG_TRIPS)
        if is_long:
            p50, p99 = [ns / 1e6 for ns in p50], [ns / 1e6 for ns in p99]
        row = [f"`{name}`", number(statistics.median(p50)), spread(p50), number(statistics.median(p99)), spread(p99)]
        if is_long:
            long_rows.append(row)
            continue
        first = column(runs, name, "new_revision_p50_ns")
        rows.append(row + [number(statistics.median(first)) if first else ""])
    table(["single trips, ns", "p50", "range", "p99", "range", "p50 at a new revision"], rows)
    table(["single trips, ms", "p50", "range", "p99", "range"], long_rows)
    pause = column(runs, "idle_append/streams:1000", "quiet_sweep_ns")
    if pause:
        print(f"The solver of a thousand streams polls each idle one every {pause[0] / 1e6:g} ms; an append waits for "
              "that poll, so the expected p50 of `idle_append` is half of that.\n")


OVERTAKEN = ("sample/dims:7/beside:replay", "sample/dims:7/beside:publish")


def print_overtaken(runs):
    def per_million(name, key):
        values = [1e6 * share for share in column(runs, name, key)]
        return [number(statistics.median(values)), spread(values)] if values else ["", ""]

    table(["of 1,000,000 samples", "`busy`", "range", "`before history`", "range", "with a new revision", "range"],
          [[f"`{name}`", *per_million(name, "busy_share"), *per_million(name, "before_history_share"),
            *per_million(name, "new_revision_share")]
           for name in OVERTAKEN if name in runs])


def cpu_model():
    with open("/proc/cpuinfo", encoding="utf-8") as info:
        for line in info:
            if line.startswith("model name"):
                return line.split(":")[1].strip()
    return platform.processor()


def print_machine(document):
    machine = document["machine"]
    load = machine["load"][0] if machine["load"] else 0
    with open("/proc/cpuinfo", encoding="utf-8") as info:
        virtual = "hypervisor" in info.read()
    compiler = subprocess.run(["g++", "-dumpfullversion"], capture_output=True, text=True).stdout
    caches = ", ".join(f"L{c['level']} {c['type'][:4].lower()} {c['bytes'] // 1024} KiB"
                       for c in machine["caches"])
    print(f"Machine: {cpu_model()}, {machine['cores']} cores{' (virtual)' if virtual else ''}; "
          f"{caches}; Linux {platform.release()}; g++ {compiler.strip()}; "
          f"load average {load:.1f} at the end of the run.\n")


INTRODUCTION = """# Benchmarks

Written by `./run bench`; do not edit. All figures are from the run that wrote this page.

One program, `splinecast_bench`, contains subjects, peers and floors. It runs them in groups and blocks: in a block each
benchmark of the group runs once, then the next block begins. A ratio is taken between two runs of the same block, and
the tables give the median and the range over the blocks: {blocks}, or fewer for rows that take seconds per run.

Times are CPU time per operation, the mean of a run: it excludes the time of other programs. Single trips
are wall time, measured one by one: p50 and p99 of 20,000 round trips, 2,000,000 samples, 1,000,000 samples (`beside`),
500 attachments or 200 appends to idle streams. `publish` against `floor/ping` compares the mean CPU time of one with
the p50 of the other.

Peers: *gsl* is the GNU Scientific Library, a cubic spline and an accelerator per dimension in this process (position,
velocity, acceleration; `append` solves 1,024 knots again). *makima* is boost::math::interpolators::makima's
`push_back`. *iceoryx* 2.0.3 sends the same payload there and back, polled, with its own iox-roudi. Floors:
*floor/eval* is the polynomial alone, from this process's own memory; *floor/ping* is one word each way over
two cache lines between the two cores.
"""

ROWS = """| row | what it measures |
|---|---|
| `sample` | position, velocity, acceleration and jerk through the public `Reader`, in steps of 1 ms through knots at 100 Hz |
| `sample/…/writer:…` | the same, while another process publishes at this rate: the mean CPU time, which the targets compare; then every sample timed alone, and separately those that find a new revision |
| `sample/…/beside:replay` | samples in the segments that revisions change, one after the other, while `replay --embedded --rate max` writes the board on the other core, with one revision for up to 256 waypoints |
| `sample/…/beside:publish` | the same beside a writer that commits a revision for each waypoint, as fast as possible |
| `sample_random` | samples at random times in 65,536 segments |
| `sample_many` | 50 times, 2 ms apart, from one revision by one call, per time; the first time is 1 ms later from call to call, as for a predictive controller at 1 kHz; knots at 100 Hz |
| `append` | one waypoint through the window, and out as a settled segment |
| `plan` | each step of a solver that returns to the waypoints after 300 ms of silence, with limits and without: it consumes the waypoints that arrive at once, searches for an entry and publishes it |
| `publish` | one waypoint appended to the ring, solved and published, beside readers that poll at 1 kHz on the other core |
| `roundtrip/embedded` | one core appends and publishes; the other samples, and acknowledges on a cache line |
| `roundtrip/solver` | one core appends; the other solves and publishes; the first samples |
| `…/settle:0` | with settle lag 0, where a waypoint changes the fewest knots |
| `attach` | from the constructor of `Reader` to the first sample, of another process's stream whose board holds 4,096 knots; the same process attaches repeatedly |
| `board` | bytes of the region that the solver writes |
| `replay` | CSV text to settled segments in shared memory, one thread |
| `parse` | CSV text to a table |
| `streams:1000/busy:100Hz` | share of a core that one process uses to solve a thousand streams of seven dimensions, with producers in another process; it polls them every millisecond |
| `streams:1000/idle` | the same while the streams have been idle for a second: it polls each every 20 ms |
| `idle_append` | from an append to one of a thousand idle streams, at a random instant, until a reader gets the curve through the new knot |
"""


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        document = json.load(file)
    runs, cut_short = read_runs(document)
    print(INTRODUCTION.format(blocks=document["blocks"]))
    print(ROWS)
    print_machine(document)
    print(f"{cut_short} of {len(document['runs'])} runs are left out: they measured less than 1 ms of CPU time, "
          "because other programs used the processor.\n")
    print("## Targets\n")
    missed = print_targets(runs)
    print("## Times\n")
    print_times(runs)
    print_trips(runs)
    print_overtaken(runs)
    profile_paths.write(sys.argv[2], missed)


if __name__ == "__main__":
    main()
