#!/usr/bin/env python3
"""Runs `splinecast soak` of the release build and writes tests/campaign/results/soak.json.

    soak.py [SECONDS]
"""

import json
import subprocess
import sys
from pathlib import Path

from page import this_machine, today

CAMPAIGN = Path(__file__).resolve().parent
PROGRAM = CAMPAIGN.parent.parent / "build/release/bin/splinecast"
STREAMS, RATE = 100, 100  # the program's defaults
COUNTERS = ["interpolated", "passed_over", "refused", "withdrawn", "controls", "underruns", "deadline_misses", "late_commits"]
ROLES = ["solver", "producers", "readers"]


def result_of(report, version):
    reads = report["read"]

    def total(counter):
        return sum(reader[counter] for reader in reads)

    def halves(name, what):
        """The use of each role in the first and in the second half of the run."""
        return {f"{name} of {role}, {half} half": report[role][what][i]
                for role in ROLES for i, half in enumerate(("first", "second"))}

    return {
        "promise": 5,
        "attack": f"soak: {report['streams']} live streams of 7 dimensions at {report['rate']:.0f} Hz in one solver, "
                  f"{report['producers']['processes']} producer and {len(reads)} reader processes; a producer "
                  "process killed every two seconds and restarted",
        "count": report["producer_kills"],
        "unit": f"kills of {report['streams'] // report['producers']['processes']} producers each",
        "found": {"streams that lost an item": report["lossy_streams"],
                  "streams that did not finish": report["unfinished_streams"],
                  "settled samples that changed": total("changed"),
                  "streams with a step": total("unsound_streams"),
                  "roles whose memory or descriptors grew": sum(report[role]["grown"] for role in ROLES)},
        "measured": {"items": report["appended"],
                     **{name: report["counters"][name] for name in COUNTERS},
                     "samples": total("samples"),
                     "joins": total("joins"),
                     "solver share of a core": round(report["solver_share"], 3),
                     **halves("private bytes", "private_bytes"),
                     **halves("mapped bytes", "mapped_bytes"),
                     **halves("descriptors", "descriptors")},
        "machine": this_machine(),
        "seconds": round(report["seconds"], 1),
        "date": today(),
        "command": f"splinecast soak --seconds {report['seconds']:.0f}",
        "version": version}


def main(seconds):
    # Exit code 1 means findings, which are in its report.
    ended = subprocess.run([PROGRAM, "soak", "--streams", str(STREAMS), "--rate", str(RATE), "--seconds", seconds,
                            "--json"], check=False, stdout=subprocess.PIPE, text=True)
    version = subprocess.run([PROGRAM, "--version"], check=True, capture_output=True, text=True).stdout.split()[-1]
    path = CAMPAIGN / "results" / "soak.json"
    path.write_text(json.dumps(result_of(json.loads(ended.stdout), version), indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "60")
