#!/usr/bin/env python3
"""Writes docs/benchmarks.md and docs/benchmarks-details.md from bench/results.json, which summarize.py describes.

    page.py                  writes the pages
    page.py --check          exits with 1 if a page is not up to date with the results
    page.py RESULTS FOLDER   writes the pages of other results to another folder
"""

import json
import sys
from pathlib import Path

import details
from markdown import WIDTH, median_of, table, wrapped
from targets import BOUNDS, TARGETS
from topics import HEADLINES, TOPICS

HERE = Path(__file__).resolve().parent
RESULTS = HERE / "results.json"
DOCS = HERE.parent / "docs"
OVERVIEW, DETAILS = "benchmarks.md", "benchmarks-details.md"

HEAD = f"""# Benchmarks

This page shows what a call of splinecast costs, compared with other libraries and with lower bounds. It is for readers
who plan the CPU time of a controller or of many streams.

- All figures are from one run of `./run bench`, which writes this page.
- Read the ratios: the same work can take twice as long within a run and from run to run.
- A figure is the median over the blocks of the run. Times are CPU time per operation; *single trips* are wall time.
- [Benchmarks in detail]({DETAILS}) has the ranges, how each row is measured, and where the instructions go.
- The [results](../bench/results.json) are stored as JSON. [summarize.py](../bench/summarize.py) describes them.
"""


def judged(results):
    """(target or bound, peer, unit with a space, size, list of summarize.py or None, complaint) of each target."""
    for one in TARGETS:
        yield one, f"`{one.peer}`", "", 1, results["ratios"].get(one.name), ""
    for one in BOUNDS:
        rows = results["rows"].get(one.subject, {})
        complaint = ""
        if one.needs and one.key in rows:
            found = rows.get(one.needs[0], [0])
            complaint = f": {one.needs[0]} was {median_of(found)}" if found[0] < one.needs[1] else ""
        yield one, "", " " + one.unit.split(" of ")[0], one.size, rows.get(one.key), complaint


def targets_table(results):
    """The lines of the table, and the subjects that have missed a target."""
    rows, missed = [], []
    for one, peer, unit, size, values, complaint in judged(results):
        reached = values is not None and one.reached(values[0] / size) and not complaint
        if values and not reached:
            missed.append(one.subject)
        median = median_of(values, size) + unit if values else "not run"
        rows.append([details.subject_text(one), peer, one.text(), median,
                     "" if not values else "yes" if reached else "no" + complaint])
    met = sum(row[-1] == "yes" for row in rows)
    return [f"{met} of {len(rows)} targets are reached.", "",
            *table(["subject", "against", "target", "median", "reached"], rows)], missed


def overview(results):
    headlines = [cells for headline in HEADLINES if (cells := headline.cells(results))]
    targets, missed = targets_table(results)
    lines = [HEAD, "## Headline figures", "", "All with 7 dimensions.", "",
             *table(["what", "median", "ratio"], headlines),
             "## Machine", "", *details.machine_lines(results),
             "## Targets", "",
             wrapped(f"The names of rows are explained below. A ratio is taken between two runs of the same block. "
                     f"[What limits a subject]({DETAILS}#what-limits-the-subjects-that-miss-their-target) is explained "
                     "for those that miss their target."), "", *targets]
    for topic in TOPICS:
        lines += topic.lines(results)
    return "\n".join(lines).rstrip("\n") + "\n", missed


def make_pages(results):
    """The text of each page by its name."""
    text, missed = overview(results)
    pages = {OVERVIEW: text, DETAILS: details.page(results, list(judged(results)), missed, OVERVIEW)}
    for name, page in pages.items():
        for line, content in enumerate(page.splitlines(), 1):
            if len(content) > WIDTH:
                sys.exit(f"{name}:{line}: would be longer than {WIDTH} characters: {content}")
    return pages


def main(arguments):
    is_checking = arguments == ["--check"]
    if not is_checking and len(arguments) not in (0, 2):
        sys.exit(__doc__)
    path, folder = (RESULTS, DOCS) if is_checking or not arguments else map(Path, arguments)
    pages = make_pages(json.loads(path.read_text(encoding="utf-8")))
    if is_checking:
        old = [name for name, text in pages.items()
               if not (folder / name).exists() or (folder / name).read_text(encoding="utf-8") != text]
        if old:
            sys.exit(f"not up to date with {RESULTS}: {', '.join(old)}: run {Path(__file__).name}")
        return
    for name, text in pages.items():
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
