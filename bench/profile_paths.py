"""The profile of the hot paths: instructions as callgrind counts them, and cache lines.

    profile_paths.py SPLINECAST_BENCH    lists the functions of each path: instructions per call, purpose, name;
                                         "(no pattern)" marks those that count as the rest

Instructions are repeatable for one binary, whatever else the machine does.
"""

import re
import subprocess
import sys
import tempfile
from collections import defaultdict

# Of the benchmarks `counted/…`, which run so often.
CALLS = 10_000

# What no pattern names.
REST = "copies and fills of the C library, and the rest"


class Path:
    """A path that is counted: `benchmark` runs it, `entries` are the functions in which it is counted.

    `purposes` says what a function is for: (expression, purpose), the first expression found in its name counts.
    `lines` is a text on the cache lines that the path touches.
    """

    def __init__(self, title, benchmark, entries, purposes, lines):
        self.title, self.benchmark, self.entries = title, benchmark, entries
        self.purposes, self.lines = purposes, lines

    def purpose(self, function):
        """What a function is for; nothing if no pattern names it."""
        return next((purpose for pattern, purpose in self.purposes if re.search(pattern, function)), None)

    def count(self, binary):
        """Instructions a call, by function, most first."""
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
        entries=["splinecast::ipc::Sampler::sample*"],
        purposes=[
            (r"core::evaluate", "the polynomial and three derivatives, 7 dimensions"),
            (r"copy_segment", "copies the next segment out of shared memory, once every 10 samples"),
            (r"copy_bounds|see\(", "takes over the bounds of a revision"),
            (r"Sampler::", "looks whether there is a new revision, finds the segment, time within it, status"),
        ],
        lines="""Cache lines of shared memory that it loads (64 bytes, 7 dimensions): one, with `revision` and `retired`, while
the revision stands and the time lies in the segment used last. Another segment adds 6: the tags of its two cells, of
which one is the first of the 5 lines (8 + 28 words) that hold a cubic; after a jump it asks for those of both cells at
once. A new revision adds 5: the tags of the head's two
cells with the bounds beside them, the `changed_from` of the revisions missed, and the tags of the own segment's two
cells; these, and the tags of the next segment, it asks for at once before it waits for the first of them. It stores
nothing.
""",
    ),
    Path(
        title="`publish/dims:7`, K = 8: one append, solved and published",
        benchmark="counted/publish",
        entries=["splinecast::ipc::Producer::append*", "splinecast::ipc::Solver::step*"],
        purposes=[
            (r"SegmentBoardWriter::(write|claim|slot|prefetch)", "writes the segments that the waypoint changes into spare cells"),
            (r"build_segment|KnotRing::interval|write_cubic", "coefficients from knot velocities"),
            (r"acceleration|write_step", "the acceleration step published at each knot"),
            (r"PublishedCurve|KnotRing::knot|SlidingWindow::(segment|newer|left)", "which segments changed, and what goes with each"),
            (r"back_substitute|solve|eliminate|close|TridiagonalSolver|SlidingWindow|KnotRing|write_chord|end_intervals",
             "the window: forward row, tail, K backward rows"),
            (r"stop_tail|stop_time", "the stop tail"),
            (r"SegmentBoardWriter::commit", "the head, and the commit"),
            (r"Waypoint|Producer|is_finite|judge_interval", "the ring: checks, one item in, one item out"),
            (r"StreamSolver|Solver::step|Quaternion|DimensionKinds", "the step: what to take, whether to"),
        ],
        lines="""Cache lines, K = 8, 7 dimensions: the producer stores 2 of the ring's item and 1 with `head`, and loads the 2 with
`tail` and `sleeping`; the solver loads 3 of the ring and stores, for each of the K + 2 segments that a waypoint changes,
9 of a cell (10 of the stop tail's) and 1 in ten of the packed times; of the head 6 or 7, `revision` and `tail`: about 105
lines and 650 words in all, each word a store of its own, because readers may look at any time.
""",
    ),
]


# What stands in the way of a target, by the beginning of its subject's name; told where it is missed.
LIMITS = {
    "roundtrip/": """- `roundtrip/…`: a ping moves two lines. A round trip moves at least four, one after the other: the commit word (for
  `solver` the ring's `head` before it), the head of the revision with the tags of the segments near by, the words of one
  of them, and the acknowledgement. Before the commit, `publish` takes what the table of times says: some 650 words are
  stored on about 105 lines, of which the reader's core has taken some meanwhile. Most of the words are the K + 1 open
  segments, all of which a waypoint changes. `settle:0` shows what is left of the trip without them. iceoryx moves the
  waypoint alone and solves nothing.
""",
    "streams:1000/busy": """- `streams:1000/busy`: 100,000 waypoints a second in a tenth of a core leave 1 µs for each; `publish` in the table of times
  has everything in the caches, and here nothing is. By one trace of its loads and stores (valgrind's lackey, x86-64,
  K = 8), a step with a waypoint goes through 208 lines of its stream's own, 118 of them in the regions, on some 20 pages:
  13 kB, and a thousand streams make 13 MB of it. The streams are also published anew every half freeze-ahead, at sweeps
  of 1 ms 300,000 times a second in all, which goes through 34 lines each. So 31 million lines a second come from
  beyond this core's own caches, 3 ns each if a tenth of a core were to do. The solver fetches them ahead, several at
  once.
""",
    "sample": """- `sample`: the time that the target leaves beside the bare polynomial (`floor/eval`) is what status, lookup and copy
  of the table above may take together.
""",
    "append": """- `append`: K rows follow one another, each a multiplication and a subtraction behind the one before, and the first waits
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
        print("### What stands in the way of a target that is not reached\n")
        print("".join(told))


def write_table(path, functions):
    groups = defaultdict(float)
    for function, instructions in functions.items():
        groups[path.purpose(function) or REST] += instructions
    total = sum(groups.values())
    print("| instructions | share | what for |\n|---|---|---|")
    for purpose, instructions in sorted(groups.items(), key=lambda group: -group[1]):
        print(f"| {instructions:,.0f} | {instructions / total:.0%} | {purpose} |")
    print(f"| **{total:,.0f}** | | in all |\n")


def write(binary, missed):
    print("## Where the time goes\n")
    print("Instructions as valgrind's callgrind counts them, per call.\n")
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
