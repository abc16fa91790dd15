#!/usr/bin/env python3
"""Runs the `sh` blocks of a page in this checkout, which must have been built.

    checkout.py PAGE

The blocks of the page, and its comments `<!-- sh: COMMAND -->`, run in one shell in the project's root, with a private
/dev/shm and an empty home. SHORTER has the short forms of commands that need minutes or hours; LEFT_OUT has the
commands that are not run, with the reason. Exits with 77 if a private /dev/shm is not allowed.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import blocks
from pages import beside_a_beat, delay_of, shared_memory, until_not_delayed

HIDDEN = re.compile(r"<!-- sh: (.*) -->")
CAMPAIGN = "build/release/bin/splinecast_campaign"
BENCH = "build/release/bin/splinecast_bench --blocks=1 --benchmark_filter=floor/ping --benchmark_min_time=0.001"
SHORTER = [
    (r"\./run test\b.*", "./run test '^Runner'"),
    (r"\./run demo\b(.*?)(?: --seconds \d+)?$", r"./run demo\1 --seconds 2"),
    (r"\./run bench\b.*", f'{BENCH} --out="$HOME/bench.json"'),
    (r"\./run campaign\b.*", f'{CAMPAIGN} returns --runs 5 --json "$HOME/returns.json"'),
    (r"\./run defects\b.*", "tests/defects/run.py --check"),
    # Processor 3 and a real-time priority may not be there.
    (r"taskset -c \d+ (?:chrt -f \d+ )?(.*&)", r"taskset -c 0 \1"),
    (r"taskset -c \d+ (?:chrt -f \d+ )?(.*[^&])", r"taskset -c 0 timeout 2 \1 || [ $? -eq 124 ]"),
]
LEFT_OUT = [
    (r"\./run races\b", "another step of CI"),
    (r"\./run (check|fuzz)\b", "builds with clang and sanitizers, and tests run every fuzzer on its seeds"),
    (r"(.*\bsudo\b|docker|podman|systemctl|loginctl|tuna|cpupower)\b", "changes the machine, or needs software that is not there"),
    (r"cmake --preset (dev|asan|tsan)|cmake --build --preset (dev|asan|tsan)|build/dev/|ctest --preset dev",
     "another build of everything"),
]


def short_form(line):
    """The command as the test runs it: shortened, or `:` (no operation) with the reason why it is left out."""
    command = re.sub(r"\s+#.*", "", line)
    for pattern, reason in LEFT_OUT:
        if re.match(pattern, command):
            return f": left out, because it is: {reason}"
    for pattern, shorter in SHORTER:
        command = re.sub(rf"^{pattern}$", shorter, command)
    return command


def run(path):
    """Runs the `sh` blocks of a page. Returns 1 if they fail, or if there are none, and the longest delay."""
    page = path.read_text(encoding="utf-8").splitlines()
    found = [(block.first, line) for block in blocks.blocks(page) if block.language == "sh" for line in block.lines]
    if not found:
        print(f"{path} has no block of sh")
        return 1, 0.0
    found += [(number, match.group(1)) for number, line in enumerate(page, 1) if (match := HIDDEN.fullmatch(line))]
    found.sort(key=lambda place: place[0])
    lines = [short_form(line) for _, line in found if line and not line.startswith("#")]
    path_of_programs = f"{blocks.PROJECT}/build/release/bin{os.pathsep}{os.environ['PATH']}"
    with tempfile.TemporaryDirectory() as folder:
        script = os.path.join(folder, "script")
        with open(script, "w", encoding="utf-8") as file:
            file.write("set -e\nset -x\n" + "\n".join(lines) + "\nkill $(jobs -p) 2>/dev/null || true\nwait\n")
        with open(os.path.join(folder, "out"), "w+", encoding="utf-8") as out:
            report = Path(folder, "delay")
            started = subprocess.Popen(beside_a_beat(report, shared_memory.in_own(["bash", script])), cwd=blocks.PROJECT,
                                       stdin=subprocess.DEVNULL, stdout=out, stderr=out, start_new_session=True,
                                       env=os.environ | {"HOME": folder, "XDG_RUNTIME_DIR": folder, "PATH": path_of_programs})
            code = started.wait()
            delay = delay_of(report)
            out.seek(0)
            said = out.read()
    print(f"{path.relative_to(blocks.PROJECT)}: {len(lines)} commands for a checkout, exit code {code}")
    if code != 0:
        print(said[-4000:])
    return (1 if code else 0), delay


def main():
    """Runs the blocks of a page."""
    if not shared_memory.is_allowed():
        print("needs a mount namespace of its own (root, or user namespaces)")
        return 77
    return until_not_delayed(lambda: run(Path(sys.argv[1]).resolve()))


if __name__ == "__main__":
    sys.exit(main())
