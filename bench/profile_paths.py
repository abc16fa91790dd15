"""The profile of the hot paths: instructions, counted by callgrind, and cache lines.

    profile_paths.py SPLINECAST_BENCH    lists the functions of each path: instructions per call, purpose, name;
                                         "(no pattern)" marks functions whose purpose is REST

Instruction counts are repeatable for one binary, regardless of other load on the machine.
"""

import re
import subprocess
import sys
import tempfile
from collections import defaultdict

# Iterations of the benchmarks `counted/…`.
CALLS = 10_000

# The purpose of functions that no pattern matches.
REST = "copies and fills of the C library, and the rest"

LOOKUP = "checks for a new revision, finds the segment, time within it, status"


class Path:
    """A counted path: `benchmark` runs it, `entries` are the functions in which instructions are counted.

    `purposes` is a list of (regular expression, purpose); a function has the purpose of the first expression found in
    its name. `lines` describe the cache lines that the path touches: a sentence and the items of a list.
    """

    def __init__(self, title, benchmark, entries, purposes, lines):
        self.title, self.benchmark, self.entries = title, benchmark, entries
        self.purposes, self.lines = purposes, lines

    def purpose(self, function):
        """The purpose of a function; None if no pattern matches it."""
        return next((purpose for pattern, purpose in self.purposes if re.search(pattern, function)), None)

    def count(self, binary):
        """Instructions per call, by function, in descending order."""
        with tempfile.TemporaryDirectory() as folder:
            out = f"{folder}/callgrind.out"
            subprocess.run(
                ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}"]
                + [f"--toggle-collect={entry}" for entry in self.entries]
                + [binary, f"--benchmark_filter=^{self.benchmark}/"],
                check=True, capture_output=True)
            text = subprocess.run(["callgrind_annotate", "--threshold=100", out], check=True,
                                  capture_output=True, text=True).stdout
        functions = defaultdict(float)
        for line in text.splitlines():
            found = re.match(r"\s*([\d,]+) \([ \d.]+%\)\s+\S*?:(.*?)( \[.*)?$", line)
            if found:
                functions[found[2]] += int(found[1].replace(",", "")) / CALLS
        return dict(sorted(functions.items(), key=lambda item: -item[1]))


PATHS = [
    Path(
        title="`sample/dims:7`",
        benchmark="counted/sample",
        entries=["splinecast::Reader::sample*"],
        purposes=[
            (r"KeptSegments::|ipc::number_(near|by)", LOOKUP),
            (r"core::evaluate", "the polynomial and three derivatives, 7 dimensions"),
            (r"KnotBoardReader|KnotCopy|fetch|load_values",
             "copies the next knot out of shared memory, once every 10 samples"),
            (r"BoardSegment|build_segment|build_cubic|magnitude",
             "builds the segment from its knots, once every 10 samples"),
            (r"copy_bounds|see\(", "copies the bounds of a revision"),
            (r"Sampler::", LOOKUP),
        ],
        lines=[
            "It loads these cache lines of shared memory (64 bytes, 7 dimensions) and stores nothing:",
            "1 line with `revision`, `retired` and `settled until`, while the revision is unchanged and the time is in "
            "the segment used last",
            "3 more for the next segment: the two cells of its right knot, whose tags are in the same lines as the "
            "velocities, and a node",
            "7 more for a new revision: the tags of the summary's two cells with the bounds beside them, the `changed "
            "from` of the revisions missed, the cells of the segment's two knots, and, if these were republished, their "
            "nodes; all of them are prefetched before the first load",
        ],
    ),
    Path(
        title="`publish/dims:7`, K = 8: one append, solved and published",
        benchmark="counted/publish",
        entries=["splinecast::Producer::append*", "splinecast::Solver::step*"],
        purposes=[
            (r"KnotBoardWriter::commit", "the summary, and the commit"),
            (r"KnotBoardWriter|magnitude", "writes the knots that the waypoint changes into spare cells"),
            (r"acceleration", "the initial acceleration of the stop"),
            (r"PublishedCurve|KnotWriter|Plan::|KnotRing::knot|SlidingWindow::(segment|newer|left)",
             "which knots changed, and their values"),
            (r"append_behind|back_substitute|solve|eliminate|close|TridiagonalSolver|SlidingWindow|KnotRing|"
             r"write_chord|end_intervals",
             "the window: forward row, tail, K backward rows"),
            (r"stop_time", "the stop segment"),
            (r"Waypoint|Producer|is_finite|judge_interval", "the ring: checks, one item in, one item out"),
            (r"StreamSolver|Solver::step|Quaternion|DimensionKinds",
             "the step: whether to consume items, and how many"),
        ],
        lines=[
            "Cache lines of shared memory, K = 8, 7 dimensions:",
            "The producer stores 2 lines of the ring's item and 1 with `written`.",
            "The producer loads the 2 lines with `consumed` and `sleeping`.",
            "The solver loads 3 lines of the ring.",
            "The solver stores one cell for each of the K + 1 knots that a waypoint solves, a node, a row, the "
            "acceleration of the stop, 1 line of the packed times per eight knots, 2 of the summary, `changed from`, "
            "`revision` with `settled until`, and `consumed`: about 17 lines and 110 words.",
        ],
    ),
]


# Why a subject misses its target, by the first characters of its name; the page shows it only for missed targets.
LIMITS = {
    "roundtrip/":
        "`roundtrip/…`: a ping moves two lines. A round trip moves at least four, in sequence: the commit word "
        "(for `solver` the ring's `written` before it), the bounds with the tags of the nearby knots, and the "
        "acknowledgement. Before the commit, it takes the time of `publish`. iceoryx only moves the waypoint and "
        "solves nothing.",
    "publish":
        "`publish`: the instructions of its table. The window, the cells, node and row that a waypoint changes, "
        "the item in the ring and the commit take about 2,200 of them, more than four times the window alone, "
        "without checks and counters. Each word of shared memory is stored by one instruction after one load, 63 "
        "words for the velocities alone.",
    "streams:1000/busy":
        "`streams:1000/busy`: 100,000 waypoints a second in a tenth of a core leave 1 µs for each. A step touches "
        "about 120 cache lines: 65 of the solver's own state, 30 of the window, 25 shared ones. For a thousand "
        "streams that is 8 MB, more than the second-level cache holds. They are prefetched during the step "
        "before.",
    "sample_random":
        "`sample_random`: 65,536 slots take 33 MB, on 8,192 pages. A sample loads two slots, up to eight lines, "
        "after a line of the packed times.",
    "sample_many":
        "`sample_many`: the copies of a horizon's segments are kept from call to call. Each time takes about 130 "
        "instructions: 67 evaluate; the rest find the segment (five times fall into each) and compute the time "
        "within it and the status.",
    "sample":
        "`sample`: status, lookup and copy of its table together may take the time that the target leaves in "
        "addition to the polynomial alone (`floor/eval`).",
    "append":
        "`append`: K rows form a dependency chain, each a multiplication and a subtraction after the one before, "
        "and the first waits for three divisions: chord slope, pivot, tail.",
    "parse":
        "`parse`: half of it is the conversion of digits to doubles (fast_float), the rest finding lines and "
        "fields.",
    "replay":
        "`replay` parses, solves and publishes in one thread. Its time is the sum of `parse`, of one append "
        "through the window and of one settled segment written per waypoint. The revisions themselves are shared "
        "by 256 waypoints.",
}


def limits_of(missed):
    """The texts of LIMITS for the subjects that have missed a target."""
    return [text for name, text in LIMITS.items() if any(subject.startswith(name) for subject in missed)]


def count_all(binary):
    """Instructions per call of each path: benchmark → purpose → number."""
    counted = {}
    for path in PATHS:
        groups = defaultdict(float)
        for function, instructions in path.count(binary).items():
            groups[path.purpose(function) or REST] += instructions
        counted[path.benchmark] = {purpose: round(groups[purpose], 1)
                                   for purpose in sorted(groups, key=groups.get, reverse=True)}
    return counted


def list_functions(binary):
    for path in PATHS:
        print(path.title)
        for function, instructions in path.count(binary).items():
            print(f"{instructions:10,.1f}  {path.purpose(function) or '(no pattern)'}: {function}")


if __name__ == "__main__":
    list_functions(sys.argv[1])
