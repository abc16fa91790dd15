"""The profile of the hot paths: instructions, counted by callgrind, and cache lines.

    profile_paths.py SPLINECAST_BENCH    lists the functions of each path: instructions per call, purpose, name;
                                         "(no pattern)" marks those that count as the rest

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


class Path:
    """A counted path: `benchmark` runs it, `entries` are the functions in which instructions are counted.

    `purposes` is a list of (regular expression, purpose); a function has the purpose of the first expression found in
    its name. `lines` is a text on the cache lines that the path touches.
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
            (r"KeptSegments::|ipc::number_(near|by)", "checks for a new revision, finds the segment, time within it, status"),
            (r"core::evaluate", "the polynomial and three derivatives, 7 dimensions"),
            (r"KnotBoardReader|KnotCopy|fetch|load_values", "copies the next knot out of shared memory, once every 10 samples"),
            (r"BoardSegment|build_segment|build_cubic|magnitude", "builds the segment from its knots, once every 10 samples"),
            (r"copy_bounds|see\(", "copies the bounds of a revision"),
            (r"Sampler::", "checks for a new revision, finds the segment, time within it, status"),
        ],
        lines="""It loads these cache lines of shared memory (64 bytes, 7 dimensions): one, with `revision`, `retired` and
`settled until`, while the revision is unchanged and the time is in the segment used last. The next segment adds 3: the
two cells of its right knot, whose tags are in the same lines as the velocities, and a node. A new revision adds 7: the
tags of the summary's two cells with the bounds beside them, the `changed from` of the revisions missed, the cells of the
segment's two knots, and, if these were republished, their nodes; all of them are prefetched before the first load. It
stores nothing.
""",
    ),
    Path(
        title="`publish/dims:7`, K = 8: one append, solved and published",
        benchmark="counted/publish",
        entries=["splinecast::Producer::append*", "splinecast::Solver::step*"],
        purposes=[
            (r"KnotBoardWriter::commit", "the summary, and the commit"),
            (r"KnotBoardWriter|magnitude", "writes the knots that the waypoint changes into spare cells"),
            (r"acceleration", "the initial acceleration of the stop"),
            (r"PublishedCurve|KnotRing::knot|SlidingWindow::(segment|newer|left)", "which knots changed, and their values"),
            (r"append_behind|back_substitute|solve|eliminate|close|TridiagonalSolver|SlidingWindow|KnotRing|write_chord|end_intervals",
             "the window: forward row, tail, K backward rows"),
            (r"stop_time", "the stop segment"),
            (r"Waypoint|Producer|is_finite|judge_interval", "the ring: checks, one item in, one item out"),
            (r"StreamSolver|Solver::step|Quaternion|DimensionKinds", "the step: whether to consume items, and how many"),
        ],
        lines="""Cache lines, K = 8, 7 dimensions: the producer stores 2 of the ring's item and 1 with `written`, and loads the 2 with
`tail` and `sleeping`; the solver loads 3 of the ring and stores one cell for each of the K + 1 knots that a waypoint
solves, a node, a row, the acceleration of the stop, 1 of the packed times per eight knots, 2 of the summary,
`changed from`, `revision` with `settled until`, and `tail`: about 17 lines and 110 words.
""",
    ),
]


# What limits a subject, by the beginning of its name; printed if its target is missed.
LIMITS = {
    "roundtrip/": """- `roundtrip/…`: a ping moves two lines. A round trip moves at least four, in sequence: the commit word (for
  `solver` the ring's `written` before it), the bounds with the tags of the knots near by, and the acknowledgement. Before the
  commit, it takes the time of `publish` in the table of times. iceoryx only moves the waypoint and solves nothing.
""",
    "publish": """- `publish`: the instructions above. The window, the cells, node and row that a waypoint changes, the item in the ring and
  the commit take about 2,200 of them, more than four times the window alone, without checks and counters: each
  word of shared memory is stored by one instruction after one load, 63 words for the velocities alone.
""",
    "streams:1000/busy": """- `streams:1000/busy`: 100,000 waypoints a second in a tenth of a core leave 1 µs for each. A step touches about 120
  cache lines: 65 of the solver's own state, 30 of the window, 25 shared ones. For a thousand streams that is 8 MB, more
  than the second-level cache holds; they are prefetched during the step before.
""",
    "sample_random": """- `sample_random`: 65,536 slots take 33 MB, on 8,192 pages; a sample loads two slots, up to eight lines, after a line of
  the packed times.
""",
    "sample_many": """- `sample_many`: the copies of a horizon's segments are kept from call to call. Each time takes about 130 instructions: 67
  evaluate; the rest find the segment (five times fall into each) and compute the time within it and the status.
""",
    "sample": """- `sample`: status, lookup and copy of the table above together may take the time that the target leaves in addition to
  the polynomial alone (`floor/eval`).
""",
    "append": """- `append`: K rows form a dependency chain, each a multiplication and a subtraction after the one before, and the first waits
  for three divisions: chord slope, pivot, tail.
""",
    "parse": """- `parse`: half of it is the conversion of digits to doubles (fast_float), the rest finding lines and fields.
""",
    "replay": """- `replay` parses, solves and publishes in one thread: its time is the sum of `parse`, of one append through the window
  and of one settled segment written per waypoint; the revisions themselves are shared by 256 waypoints.
""",
}


def write_limits(missed):
    told = [text for name, text in LIMITS.items() if any(subject.startswith(name) for subject in missed)]
    if told:
        print("### What limits the subjects that miss their target\n")
        print("".join(told))


def write_table(path, functions):
    groups = defaultdict(float)
    for function, instructions in functions.items():
        groups[path.purpose(function) or REST] += instructions
    total = sum(groups.values())
    print("| instructions | share | purpose |\n|---|---|---|")
    for purpose, instructions in sorted(groups.items(), key=lambda group: -group[1]):
        print(f"| {instructions:,.0f} | {instructions / total:.0%} | {purpose} |")
    print(f"| **{total:,.0f}** | | total |\n")


def write(binary, missed):
    print("## Where the time goes\n")
    print("Instructions per call, counted by valgrind's callgrind.\n")
    for path in PATHS:
        print(f"### {path.title}\n")
        write_table(path, path.count(binary))
        print(path.lines)
    write_limits(missed)


def list_functions(binary):
    for path in PATHS:
        print(path.title)
        for function, instructions in path.count(binary).items():
            print(f"{instructions:10,.1f}  {path.purpose(function) or '(no pattern)'}: {function}")


if __name__ == "__main__":
    list_functions(sys.argv[1])
