"""The page docs/benchmarks-details.md: how the rows are measured, their ranges, and the profile. page.py writes it."""

import profile_paths
from markdown import item, median_of, natural, range_of, table, wrapped

HEAD = """# Benchmarks in detail

This page says how the rows of [Benchmarks]({overview}) are measured, gives their ranges, and shows where the
instructions go. It is for developers who compare a change or doubt a figure.

## How the rows are measured

- One program, `splinecast_bench`, contains subjects, peers and floors.
- It runs them in groups and blocks: in a block each benchmark of the group runs once, then the next block begins.
- A ratio is taken between two runs of the same block.
- The tables give the median and the range over the blocks. Blocks of this run: {blocks}; fewer for rows that take
  seconds per run.
- Times are CPU time per operation, the mean of a run: it excludes the time of other programs.
- Single trips are wall time, measured one by one: 20,000 round trips, 2,000,000 samples, 1,000,000 samples (`beside`),
  500 attachments or 200 appends to idle streams. The steps of `plan` after 400 silences are single trips too.
- `sample/…/writer:…`: the targets compare the mean CPU time. Then every sample is timed alone, and those that find a
  new revision also separately.
- `publish` against `floor/ping` compares the mean CPU time of one with the p50 of the other.
- A run that measured less than 1 ms of CPU time, because other programs used the processor, is left out: {cut_short}
  of {runs} runs.

## Peers

- *gsl*: the GNU Scientific Library, a cubic spline and an accelerator per dimension in this process. A sample is
  position, velocity and acceleration. `append` solves 1,024 knots again.
- *eigen* 3.4: the equations of the window of `append` with K = 8, dense of fixed size (PartialPivLU, LLT) and sparse
  with a pattern that is analysed once (SparseLU, SimplicialLDLT). No segment is made of the velocities.
- *makima*: `push_back` of boost::math::interpolators::makima. The curve is C¹ only.
- *iceoryx* 2.0.3: sends the same payload there and back, polled, with its own iox-roudi.
- *floor/eval*: the polynomial alone, from this process's own memory.
- *floor/ping*: one word each way over two cache lines between the two cores.
"""

# Trips that are reported in milliseconds.
LONG_TRIPS = ("attach/", "idle_append/")

OVERTAKEN = ("sample/dims:7/beside:replay", "sample/dims:7/beside:publish")

# The types of caches as Google Benchmark names them.
CACHES = {"Data": " data", "Instruction": " instructions", "Unified": ""}


def subject_text(row):
    return f"`{row.subject}`" + (f", {row.what}" if row.what else "")


def trip_unit(name):
    """Nanoseconds of the unit of a row of single trips, and the unit."""
    return (1e6, "ms") if name.startswith(LONG_TRIPS) else (1, "ns")


def machine_lines(results):
    machine = results["machine"]
    caches = ", ".join(f"L{c['level']}{CACHES.get(c['type'], ' ' + c['type'])} {c['bytes'] // 1024:,} KiB"
                       for c in machine["caches"])
    return [item(text) for text in (
        f"processor: {machine['cpu']}, {machine['cores']} cores{' (virtual)' if machine['is_virtual'] else ''}",
        f"caches: {caches}",
        f"system: {machine['kernel']}, {machine['compiler']}",
        f"load average at the end of the run: {machine['load']:.1f}",
        f"date: {results['date']}",
        f"version: {results['version']}, commit {results['commit']}")] + [""]


def target_ranges(judged):
    rows = [[subject_text(one), peer, median_of(values, size) + unit, range_of(values, size), str(values[3])]
            for one, peer, unit, size, values, _ in judged if values]
    return ["## Ranges of the targets", "", *table(["subject", "against", "median", "range", "blocks"], rows)]


def trip_ranges(rows):
    names = [name for name in sorted(rows, key=natural) if "p99_ns" in rows[name]]
    lines = ["## Ranges of single trips", ""]
    for unit in ("ns", "ms"):
        heads = [f"single trips, {unit}", "p50", "range", "p99", "range"]
        lines += table(heads, [[f"`{name}`", *(text(rows[name][key], trip_unit(name)[0]) for key in ("p50_ns", "p99_ns")
                                               for text in (median_of, range_of))]
                               for name in names if trip_unit(name)[1] == unit])
    first = [[f"`{name}`", median_of(rows[name]["new_revision_p50_ns"]), range_of(rows[name]["new_revision_p50_ns"])]
             for name in names if "new_revision_p50_ns" in rows[name]]
    worst = [[f"`{name}`", median_of(rows[name]["worst_ns"], 1e3), range_of(rows[name]["worst_ns"], 1e3)]
             for name in names if "worst_ns" in rows[name]]
    lines += table(["first sample of a revision, ns", "p50", "range"], first)
    return lines + table(["worst step, µs", "median", "range"], worst)


def overtaken(rows):
    keys = ("busy_share", "before_history_share", "new_revision_share")
    found = [[f"`{name}`", *(text(rows[name][key], 1e-6) for key in keys for text in (median_of, range_of))]
             for name in OVERTAKEN if name in rows]
    if not found:
        return []
    return ["## Samples beside the fastest writers", "",
            "Of 1,000,000 samples, how many are `busy` or `before history`, and how many find a new revision:", "",
            *table(["row", "`busy`", "range", "`before history`", "range", "new revision", "range"], found)]


def profile_lines(profile):
    lines = ["## Where the instructions go", "", "Instructions per call, counted by valgrind's callgrind.", ""]
    for path in profile_paths.PATHS:
        purposes = profile.get(path.benchmark, {})
        total = sum(purposes.values())
        lines += [f"### {path.title}", ""]
        lines += table(["instructions", "share", "purpose"],
                       [[f"{count:,.0f}", f"{100 * count / total:.0f} %", purpose]
                        for purpose, count in purposes.items()] + [[f"**{total:,.0f}**", "", "total"]])
        lines += [wrapped(path.lines[0]), "", *map(item, path.lines[1:]), ""]
    return lines


def page(results, judged, missed, overview):
    rows = results["rows"]
    lines = [HEAD.format(overview=overview, **{key: results[key] for key in ("blocks", "runs", "cut_short")}),
             "## Machine", "", *machine_lines(results), *target_ranges(judged), *trip_ranges(rows), *overtaken(rows),
             *profile_lines(results["profile"]),
             "## What limits the subjects that miss their target", "",
             *(map(item, profile_paths.limits_of(missed)) if missed else ["All targets are reached."])]
    return "\n".join(lines).rstrip("\n") + "\n"
