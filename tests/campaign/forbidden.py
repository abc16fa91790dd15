#!/usr/bin/env python3
"""Runs the tests Forbidden* of the release build and writes tests/campaign/results/forbidden.json.

Each test counts its attacks; an attack is one run of a verb against one obstacle. Run as root, the tests
act as several unprivileged users. Otherwise the tests that need several users are skipped and counted.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from page import this_machine, today

CAMPAIGN = Path(__file__).resolve().parent
BIN = CAMPAIGN.parent.parent / "build/release/bin"

SUITES = {
    "ForbiddenFiles": {
        "promise": 6,
        "attack": "forbidden files: files with a stream's names that are truncated, enlarged, of another layout or "
                  "byte order, writable by others, owned by another user, links, pipes or folders; the verbs solve, "
                  "replay, sample, info, ls, rm as an unprivileged user",
    },
    "ForbiddenLimits": {
        "promise": 5,
        "attack": "exhausted limits: /dev/shm full, regions with holes, RLIMIT_MEMLOCK, _FSIZE, _NOFILE, _AS, another "
                  "time namespace; the verbs solve, replay, sample, info, ls, rm, demo, doctor as an unprivileged user",
    },
    "ForbiddenSharing": {
        "promise": [6, 8],
        "attack": "shared access: readers in and outside the group; a reader that locks all files that it can open while "
                  "a solver is killed and replaced; a child that a dead owner has forked",
    },
}


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def run_suite(name):
    """GoogleTest's report of a suite's tests, and their duration in seconds."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        begin = time.monotonic()
        subprocess.run([BIN / "splinecast_tests", f"--gtest_filter={name}.*", f"--gtest_output=json:{report}"],
                       check=False, stdout=sys.stderr)
        seconds = time.monotonic() - begin
        return json.loads(report.read_text())["testsuites"][0]["testsuite"], round(seconds, 1)


def result_of(name, machine, version):
    tests, seconds = run_suite(name)
    total = lambda counter: sum(int(test.get(counter, 0)) for test in tests)
    return {
        **SUITES[name],
        "count": total("attacks"),
        "unit": "attacks",
        "found": {
            "unclear error messages": total("unclear"),
            "verbs killed": total("killed"),
            "files created, changed or destroyed": total("changed"),
            "tests failed": sum("failures" in test for test in tests),
        },
        "measured": {
            "tests": len(tests),
            "tests skipped": sum(test["result"] == "SKIPPED" for test in tests),
        },
        "machine": machine,
        "seconds": seconds,
        "date": today(),
        "command": "tests/campaign/forbidden.py",
        "version": version,
    }


def main():
    machine = this_machine()
    version = output_of(BIN / "splinecast", "--version").split()[-1]
    results = [result_of(name, machine, version) for name in SUITES]
    (CAMPAIGN / "results/forbidden.json").write_text(json.dumps(results, indent=2) + "\n")
    return 1 if any(any(result["found"].values()) for result in results) else 0


if __name__ == "__main__":
    sys.exit(main())
