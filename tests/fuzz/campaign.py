#!/usr/bin/env python3
"""Runs every fuzzer and the byte flips, and writes their findings as JSON.

    campaign.py SECONDS [FOLDER]

Runs each fuzzer for SECONDS, from the seeds and the corpus of earlier runs in build/fuzz/corpus, and then
splinecast_byteflip. If FOLDER is given, writes fuzz.json and byteflip.json there, in the schema of
tests/campaign/page.py. Exits with 1 if a fuzzer found something or a byte flip broke a promise. The inputs
found are in build/fuzz/found.
"""

import json
import re
import subprocess
import sys
import time
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(PROJECT / "tests" / "campaign"))
from page import this_machine, today  # noqa: E402

BUILD = PROJECT / "build" / "fuzz"
SEEDS = PROJECT / "tests" / "fuzz" / "seeds"
REGIONS = ["reader", "writers", "roles"]
TEXTS = ["waypoints", "topics", "times", "polynomials", "limits", "recordings", "words", "arguments"]
PROMISE = 9  # number in docs/concepts.md
# Limits of an input: time in s, above which it hangs; size in bytes; memory in MiB.
LIMITS = ["-timeout=10", "-max_len=65536", "-rss_limit_mb=2048"]
# urdfdom does not free joints that form a cycle.
LEAKING = ["limits"]
BYTE_FLIP_SECONDS = 5


def version():
    return re.search(r"VERSION (\S+)", (PROJECT / "CMakeLists.txt").read_text().split("project(")[1])[1]


def result(attack, report, seconds, command):
    return {"promise": PROMISE, "attack": attack, **report, "machine": this_machine(),
            "seconds": round(seconds, 1), "date": today(), "command": command, "version": version()}


def run_fuzzer(target, seconds):
    """Number of executions of one fuzzer, number of covered edges, and exit code (not 0: it found something)."""
    corpus, found = BUILD / "corpus" / target, BUILD / "found" / target
    for folder in (corpus, found):
        folder.mkdir(parents=True, exist_ok=True)
    seeds = SEEDS / ("regions" if target in REGIONS else target)
    ended = subprocess.run(
        [BUILD / "bin" / f"fuzz_{target}", corpus, seeds, f"-max_total_time={seconds}",
         f"-artifact_prefix={found}/", "-print_final_stats=1",
         f"-detect_leaks={int(target not in LEAKING)}", *LIMITS],
        stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, errors="replace", check=False)
    if ended.returncode != 0:
        print(ended.stderr[-6000:], file=sys.stderr)
    executed = re.findall(r"number_of_executed_units:\s*(\d+)", ended.stderr)
    covered = re.findall(r"cov: (\d+)", ended.stderr)
    print(f"fuzz_{target}: {executed[-1] if executed else '?'} inputs, "
          f"exit code {ended.returncode}", file=sys.stderr)
    return int(executed[-1]) if executed else 0, int(covered[-1]) if covered else 0, ended.returncode


def fuzz(attack, targets, seconds, command):
    begin = time.monotonic()
    runs = {target: run_fuzzer(target, seconds) for target in targets}
    broken = sum(code != 0 for _, _, code in runs.values())
    measured = {f"inputs of {target}": count for target, (count, _, _) in runs.items()}
    measured |= {f"edges covered by {target}": edges for target, (_, edges, _) in runs.items()}
    report = {"count": sum(count for count, _, _ in runs.values()), "unit": "inputs",
              "found": {"fuzzers stopped by a crash, hang or broken promise": broken},
              "measured": measured}
    return result(attack, report, time.monotonic() - begin, command), broken


def flip(seconds, command):
    begin = time.monotonic()
    ended = subprocess.run([BUILD / "bin" / "splinecast_byteflip", "--seconds", str(seconds)],
                           stdout=subprocess.PIPE, text=True, check=False)
    print(f"splinecast_byteflip: exit code {ended.returncode}", file=sys.stderr)
    report = json.loads(ended.stdout)
    attack = "flipped bytes: random bytes flipped in both regions under live processes, with AddressSanitizer"
    return (result(attack, report, time.monotonic() - begin, command), ended.returncode)


def main(seconds, folder):
    command = f"./run fuzz {seconds}"
    regions, first = fuzz("fuzzed regions: libFuzzer over whole regions", REGIONS, seconds, command)
    texts, second = fuzz("fuzzed text: libFuzzer over files and command lines", TEXTS, seconds, command)
    flips, third = flip(max(BYTE_FLIP_SECONDS, seconds / 2), command)
    if folder:
        Path(folder, "fuzz.json").write_text(json.dumps([regions, texts], indent=2) + "\n")
        Path(folder, "byteflip.json").write_text(json.dumps(flips, indent=2) + "\n")
    return 1 if first + second + third else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(int(sys.argv[1]), sys.argv[2] if len(sys.argv) == 3 else None))
