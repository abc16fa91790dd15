#!/usr/bin/env python3
"""Runs the attacks on concurrency and real time. Writes the results model, tsan and realtime.

    concurrency.py [--tests PROGRAM] [--plain-word PROGRAM]

The programs are splinecast_tests of the release preset and splinecast_plain_word of the tsan preset.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from page import this_machine, today

CAMPAIGN = Path(__file__).resolve().parent
PROJECT = CAMPAIGN.parent.parent
WORDS = ["tag", "velocity", "node", "acceleration", "summary-tag", "summary-slot", "changed-from", "settled-until", "knot-time",
         "revision", "consumed", "written", "claimed", "item"]
RACE = "WARNING: ThreadSanitizer: data race"


def run(command, **environment):
    """Output of a command, whether it ended with 0, and its duration in seconds."""
    begin = time.monotonic()
    ended = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                           env={**os.environ, **environment})
    return ended.stdout, ended.returncode == 0, time.monotonic() - begin


def write(name, result):
    version = re.search(r"project\(splinecast VERSION (\S+)", (PROJECT / "CMakeLists.txt").read_text())
    result |= {"machine": this_machine(), "date": today(), "command": "tests/campaign/concurrency.py",
               "version": version.group(1)}
    path = CAMPAIGN / "results" / f"{name}.json"
    path.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


def attack_model():
    with tempfile.TemporaryDirectory() as build:
        text, good, seconds = run([str(CAMPAIGN.parent / "model" / "run.sh"), build])
    if not good:
        sys.exit(text)
    held = {}
    for model, states in re.findall(r"(?m)^(\w+).*: holds in (\d+) states", text):
        held.setdefault(model, []).append(int(states))
    write("model", {
        "promise": [1, 3, 5, 8],
        "attack": "models: all interleavings, with spin, of models of the publication of knots, the ring of changes, "
                  "the settled word, also where a hold lowers it, the refusals and excesses of a lost revision, the "
                  "takeover of the waypoint ring and the record of a commander, with writers that die at any store",
        "count": sum(map(sum, held.values())),
        "unit": "states",
        "found": {"states that break a promise": 0, "mutants not caught": 0},
        "measured": {"mutants caught": text.count(": caught after"),
                     "searches without a violation": sum(map(len, held.values())),
                     **{f"states of {model}": sum(states) for model, states in held.items()}},
        "seconds": round(seconds, 1)})


def attack_races(program):
    text, good, seconds = run([program, "none"])
    items, revisions, samples = map(int, re.search(r"(\d+) items, (\d+) revisions, (\d+) samples", text).groups())
    missed = 0
    for word in WORDS:
        report, _, took = run([program, word], TSAN_OPTIONS="halt_on_error=1")
        missed += RACE not in report
        seconds += took
    write("tsan", {
        "promise": [1, 3, 8],
        "attack": "ThreadSanitizer: threads on one mapping: a producer, a solver and the one that takes over, "
                  "three readers and an observer; then the same with each kind of word as plain memory",
        "count": samples,
        "unit": "samples",
        "found": {"races reported": text.count(RACE), "runs with torn payloads": 0 if good else 1,
                  "plain words without a reported race": missed},
        "measured": {"plain words with a reported race": len(WORDS) - missed, "items": items, "revisions": revisions},
        "seconds": round(seconds, 1)})


def attack_real_time(program):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "tests.json"
        text, good, seconds = run([program, "--gtest_filter=RealTime.*NoSystemCall*:PreemptedWriter.*",
                                   f"--gtest_output=json:{path}"])
        tests = {test["name"]: test for suite in json.loads(path.read_text())["testsuites"]
                 for test in suite["testsuite"]}
    if not good or any("skipped" in test or test.get("result") == "SKIPPED" for test in tests.values()):
        sys.exit(text)
    loops = {name.split("Makes")[0]: test for name, test in tests.items() if "Makes" in name}
    preempted = next(test for name, test in tests.items() if "Makes" not in name)

    def total(counter):
        return sum(int(test[counter]) for test in loops.values())

    write("realtime", {
        "promise": 3,
        "attack": "real-time loops: sampling, appending and solving in a process that any system call kills; a "
                  "SCHED_FIFO reader that preempts the writer on its core",
        "count": total("rounds") + int(preempted["samples"]),
        "unit": "rounds",
        "found": {"processes killed at a system call": total("killed"), "allocations": total("allocations"),
                  "page faults": total("minor_faults") + total("major_faults"),
                  "samples without an answer while the writer is preempted": int(preempted["unanswered"])},
        "measured": {"rounds of sampling": int(loops["Sampling"]["rounds"]),
                     "waypoints appended": int(loops["Appending"]["answered"]),
                     "revisions solved": int(loops["Solving"]["answered"]),
                     "samples while the writer is preempted": int(preempted["samples"]),
                     "preemptions": int(preempted["preemptions"]),
                     "preemptions within a publication": int(preempted["midway"]),
                     "CPU time per sample of 64 dimensions meanwhile [ns]": int(preempted["cpu_ns_per_sample"])},
        "seconds": round(seconds, 1)})


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--tests", default=str(PROJECT / "build/release/bin/splinecast_tests"))
    parser.add_argument("--plain-word", default=str(PROJECT / "build/tsan/bin/splinecast_plain_word"))
    arguments = parser.parse_args()
    attack_model()
    attack_races(arguments.plain_word)
    attack_real_time(arguments.tests)


if __name__ == "__main__":
    main()
