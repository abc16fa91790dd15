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
    """What a subject is compared with, and the ratio that it must reach.

    `faster`: peer's time / subject's must be at least `bound`; else subject's / peer's at most.
    """

    def __init__(self, subject, peer, bound, faster=False):
        self.subject, self.peer, self.bound, self.faster = subject, peer, bound, faster

    def ratio(self, subject, peer):
        return peer / subject if self.faster else subject / peer

    def text(self):
        return f"≥ {self.bound:g} × faster" if self.faster else f"≤ {self.bound:g} ×"

    def reached(self, ratio):
        return ratio >= self.bound if self.faster else ratio <= self.bound


TARGETS = [
    Target("sample/dims:7", "gsl/sample/dims:7", 6, faster=True),
    Target("sample/dims:7", "floor/eval/dims:7", 3),
    Target("sample/dims:7/writer:100Hz", "sample/dims:7/writer:quiet", 1.5),
    Target("sample/dims:7/writer:1kHz", "sample/dims:7/writer:quiet", 2),
    Target("sample_random/dims:7", "gsl/sample_random/dims:7", 3, faster=True),
    Target("append/dims:7/settle:8", "gsl/append/dims:7", 600, faster=True),
    Target("append/dims:7/settle:16", "gsl/append/dims:7", 350, faster=True),
    Target("append/dims:7/settle:8", "makima/append/dims:7", 1),
    Target("append/dims:7/settle:8/after:10000000", "append/dims:7/settle:8", 1.1),
    Target("publish/dims:7/readers:1", "publish/dims:7/readers:0", 1.15),
    Target("publish/dims:7/readers:16", "publish/dims:7/readers:0", 1.15),
    Target("publish/dims:7/readers:64", "publish/dims:7/readers:0", 1.15),
    Target("roundtrip/embedded", "floor/ping", 2),
    Target("roundtrip/solver", "floor/ping", 2.5),
    Target("roundtrip/embedded", "iceoryx/roundtrip", 4, faster=True),
    Target("roundtrip/solver", "iceoryx/roundtrip", 4, faster=True),
]

# Rates: benchmark, counter of the run, least value, unit and its size.
RATES = [
    ("replay/dims:7", "items_per_second", 1_000_000, "waypoints/s", 1),
    ("parse/dims:7", "bytes_per_second", 150, "MB/s", 1e6),
]

# Shares of a core that a solver of many streams takes: benchmark, most [%], waypoints/s that it needs.
SHARES = [
    ("streams:1000/idle", 1, 0),
    ("streams:1000/busy:100Hz", 10, 100_000),
]


# Google Benchmark ends a run early that other programs keep from the processor; one with less CPU
# time than this measured cold caches and nothing else.
LEAST_MEASURED_NS = 1e6


def read_runs(document):
    """name → the runs by block, with `ns`: CPU time, or manual time where trips were measured; and
    how many runs were cut short, which are left out."""
    runs = defaultdict(dict)
    cut_short = 0
    for run in document["runs"]:
        if not {"p50_ns", "core_percent"} & run.keys() and run["iterations"] * run["cpu_ns"] < LEAST_MEASURED_NS:
            cut_short += 1
            continue
        name = run["name"].replace("/iterations:1", "").replace("/iterations:3", "").replace("/manual_time", "")
        run["ns"] = run["real_ns"] if "p50_ns" in run else run["cpu_ns"]
        runs[name][run["block"]] = run
    return runs, cut_short


def column(runs, name, key="ns"):
    return [run[key] for _, run in sorted(runs[name].items()) if key in run]


def number(x):
    if x >= 1000:
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


def print_targets(runs):
    """Prints the table and returns the subjects that have missed a target."""
    rows, missed = [], []
    for target in TARGETS:
        times = {name: runs.get(name, {}) for name in (target.subject, target.peer)}
        blocks = sorted(set(times[target.subject]) & set(times[target.peer]))
        if not blocks:
            rows.append([f"`{target.subject}`", f"`{target.peer}`", target.text(), "not run", "", ""])
            continue
        ratios = [
            target.ratio(times[target.subject][b]["ns"], times[target.peer][b]["ns"])
            for b in blocks
        ]
        median = statistics.median(ratios)
        rows.append([
            f"`{target.subject}`", f"`{target.peer}`", target.text(), f"**{number(median)}**",
            spread(ratios), "reached" if target.reached(median) else "not reached",
        ])
        if not target.reached(median):
            missed.append(target.subject)
    for name, counter, least, unit, size in RATES:
        rates = [rate / size for rate in column(runs, name, counter)]
        if not rates:
            continue
        median = statistics.median(rates)
        rows.append([
            f"`{name}`", "", f"≥ {least:,} {unit}", f"**{number(median)}**", spread(rates),
            "reached" if median >= least else "not reached",
        ])
        if median < least:
            missed.append(name)
    for name, most, rate in SHARES:
        shares, rates = column(runs, name, "core_percent"), column(runs, name, "waypoints_per_s")
        if not shares:
            continue
        median, reached_rate = statistics.median(shares), statistics.median(rates)
        is_fed = reached_rate >= 0.95 * rate
        rows.append([
            f"`{name}`", "", f"≤ {most} % of a core", f"**{number(median)} %**", spread(shares),
            ("reached" if is_fed and median <= most else "not reached") +
            ("" if is_fed else f": the producers got to {number(reached_rate)} waypoints/s"),
        ])
        if median > most or not is_fed:
            missed.append(name)
    table(["subject", "against", "target", "median", "range", ""], rows)
    few = column(runs, "streams:10/idle", "core_percent")
    if few:
        print(f"Ten idle streams take {number(statistics.median(few))} % of a core: a wake-up every 20 ms, with ten "
              "looks each.\n")
    return missed


def print_times(runs):
    def cell(name):
        return number(statistics.median(column(runs, name))) if runs.get(name) else ""

    kinds = ["floor/eval/dims:{}", "sample/dims:{}", "gsl/sample/dims:{}",
             "append/dims:{}/settle:8", "append/dims:{}/settle:16", "makima/append/dims:{}",
             "gsl/append/dims:{}", "publish/dims:{}/readers:0"]
    table(["ns at dims"] + [str(d) for d in DIMENSIONS],
          [[f"`{kind.replace('/dims:{}', '')}`"] + [cell(kind.format(d)) for d in DIMENSIONS]
           for kind in kinds])


def print_trips(runs):
    rows = []
    for name in sorted(runs):
        p50, p99 = column(runs, name, "p50_ns"), column(runs, name, "p99_ns")
        if not p50:
            continue
        first = column(runs, name, "new_revision_p50_ns")
        rows.append([f"`{name}`", number(statistics.median(p50)), spread(p50),
                     number(statistics.median(p99)), spread(p99),
                     number(statistics.median(first)) if "Hz" in name and first else ""])
    table(["single trips, ns", "p50", "range", "p99", "range", "p50 at a new revision"], rows)


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

Written by `./run bench`; not to be edited. Every figure is of the run that wrote this page.

Subjects, peers and floors are compiled into one program, `splinecast_bench`, and alternate in blocks: each of a
group runs once, then each one again. A ratio is taken within a block; the tables give the median and the range over
{blocks} blocks. Times are CPU time per operation, which does not count what other programs take from the machine; but
single trips between processes are wall time, p50 and p99 of 20,000 trips (of 2,000,000 samples) a block.

Peers: *gsl* is the GNU Scientific Library, a cubic spline and an accelerator per dimension in this process (position,
velocity, acceleration; `append` solves 1,024 knots again). *makima* is boost::math::interpolators::makima's
`push_back`. *iceoryx* 2.0.3 sends the same payload there and back, polled, with an iox-roudi of its own. Floors:
*floor/eval* is the polynomial alone, from this process's own memory; *floor/ping* is a word there and a word back over
two cache lines between the two cores.
"""

CURVE = """`sample` steps at 1 kHz through 100 Hz knots with the public `Reader`, position, velocity, acceleration and jerk;
`sample_random` jumps in 65,536 segments; `writer:…` is another process that publishes meanwhile; `append` is one
waypoint through the window and out as a settled segment; `publish` is one append, solved and published, with so many
readers polling at 1 kHz on the other core; `roundtrip/embedded` appends and publishes on one core, samples on the other
and acknowledges on a cache line; `roundtrip/solver` appends on one core, solves on the other and samples on the first;
with `settle:0` a waypoint changes the fewest segments; `replay` is CSV text to settled segments in shared memory, one
thread; `streams:1000` is the CPU time of one process that solves a thousand streams of seven dimensions, with producers
in another process: busy, it looks at them every millisecond; idle, nothing has happened on them for a second, and it
looks every twenty.
"""


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        document = json.load(file)
    runs, cut_short = read_runs(document)
    print(INTRODUCTION.format(blocks=document["blocks"]))
    print(CURVE)
    print_machine(document)
    print(f"Of {len(document['runs'])} runs {cut_short} measured less than 1 ms of CPU time, because other programs "
          "kept them from the processor, and are left out.\n")
    print("## Targets\n")
    missed = print_targets(runs)
    print("## Times\n")
    print_times(runs)
    print_trips(runs)
    profile_paths.write(sys.argv[2], missed)


if __name__ == "__main__":
    main()
