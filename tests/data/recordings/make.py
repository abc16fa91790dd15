#!/usr/bin/python3
"""Makes the recordings of this folder: small streams that end in each way that a stream can end.

    make.py FOLDER [CASE ...]    records all cases, or those named, as FOLDER/CASE.mcap, verifies each recording, and
                                 writes the numbers of verified segments to FOLDER/expected.json
    make.py --check              does the same in a temporary folder
    make.py --list               prints the names of the cases

Needs the Python module and the program of one build: PYTHONPATH and PATH as `./run python` says. Each case runs in a
process of its own, so that a case may kill its solver or its producer. Exits with 1 if a case fails, or if a recording
does not verify. A machine under load may refuse an item of a case, which then ends there.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

import splinecast

import ends  # pylint: disable=unused-import  # registers its cases, as the next three do
import laws  # pylint: disable=unused-import
import live  # pylint: disable=unused-import
import methods  # pylint: disable=unused-import
from stage import CASES, Stage


def make(name, path):
    """Records one case."""
    stage = Stage(name, path)
    try:
        try:
            CASES[name](stage)
        except splinecast.Refused as refused:
            print(f"{name}: {refused}", file=sys.stderr)
        stage.close()
    except BaseException:
        stage.end()
        raise


def make_all(folder, names):
    """Records cases, eight at a time. Returns those that failed."""
    waiting, running, failed = list(names), {}, []
    while waiting or running:
        while waiting and len(running) < 8:
            name = waiting.pop(0)
            path = os.path.join(folder, f"{name}.mcap")
            running[name] = subprocess.Popen([sys.executable, "-B", __file__, "--case", name, path])
        for name in [name for name, child in running.items() if child.poll() is not None]:
            if running.pop(name).returncode != 0:
                failed.append(name)
        time.sleep(0.01)
    return failed


def verify(path):
    """The number of equal segments of each stream of a recording, or None if it does not verify."""
    ended = subprocess.run(["splinecast", "replay", "--verify", "--json", path], check=False, capture_output=True, text=True)
    if ended.returncode != 0:
        print(f"{path}: exit code {ended.returncode}\n{ended.stdout}{ended.stderr}")
        return None
    return {name: stream["equal"] for name, stream in json.loads(ended.stdout)["streams"].items()}


def main():
    if sys.argv[1:] == ["--list"]:
        print("\n".join(CASES))
        return 0
    if sys.argv[1:2] == ["--case"]:
        make(*sys.argv[2:])
        return 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = temporary if sys.argv[1:2] == ["--check"] else sys.argv[1]
        names = sys.argv[2:] or CASES
        failed = make_all(folder, names)
        verified = {name: verify(os.path.join(folder, f"{name}.mcap")) for name in names if name not in failed}
        with open(os.path.join(folder, "expected.json"), "w", encoding="utf-8") as file:
            json.dump(verified, file, indent=1)
            file.write("\n")
    failed += [name for name, found in verified.items() if found is None]
    print(f"{len(names)} recordings, {len(failed)} failed {' '.join(failed)}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
