#!/usr/bin/env python3
"""Runs an example of examples/python in an empty folder and checks what it prints.

    run.py EXAMPLE RECORDER      EXAMPLE: 1_sine, 2_policy, 3_chunks_naive or 4_scipy; RECORDER: the program of
                                 examples/9_recorder.cpp

Needs the module in PYTHONPATH and `splinecast` in PATH. A step in velocity is compared with the acceleration of the
curve, never with time that has passed.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parent.parent.parent / "examples" / "python"
STREAM = f"test.{os.getpid()}.example"


def output_of(name, folder, *arguments):
    """What the example prints; fails if the example fails."""
    done = subprocess.run([sys.executable, EXAMPLES / f"{name}.py", *arguments], cwd=folder, check=False, text=True,
                          capture_output=True)
    print(done.stdout + done.stderr)
    assert done.returncode == 0, f"exit code {done.returncode}"
    return done.stdout


def numbers(pattern, text):
    """The groups of the only match, as numbers."""
    found = re.findall(pattern, text)
    assert len(found) == 1, f"{len(found)} lines match {pattern}"
    return [float(group) for group in (found[0] if isinstance(found[0], tuple) else found)]


def sine(folder, _):
    """The curve follows the sine where it was sampled, and every waypoint has been sent."""
    said = output_of("1_sine", folder, STREAM)
    errors = [float(error) for error in re.findall(r"settled, (\S+) rad from the sine", said)]
    late = len(re.findall(r"^waypoint refused: ", said, re.M))  # each is printed
    sent, refused = numbers(r"(\d+) waypoints, (\d+) refused", said)
    assert sent + late == 201, said
    assert refused + late or errors, "no settled sample"
    assert refused + late or max(errors) < 1e-3, f"{max(errors)} rad from the sine"


def policy(folder, recorder):
    """The controller records the motion; most chunks are used or too old, and each is counted."""
    said = output_of("2_policy", folder, STREAM, "--seconds", "3", "--recorder", recorder)
    chunks, _ = numbers(r"(\d+) chunks: .*; the solver refused (\d+) items", said)
    outcomes = {what: int(count) for count, what in re.findall(r"(\d+) ([a-z ]+)[,;]", said)}
    assert chunks == 90 and sum(outcomes.values()) == chunks and outcomes["in force"] > 0, said
    rows = (Path(folder) / "recorded.csv").read_text(encoding="utf-8").count("\n")
    assert rows > 3000, f"{rows} rows"
    assert (Path(folder) / "chunks.npz").is_file()


def chunks_naive(folder, recorder):
    """Jumps step in velocity; the curve changes it only as its acceleration and jerk explain."""
    said = output_of("3_chunks_naive", folder, STREAM, "--seconds", "3", "--recorder", recorder)
    jumps, curve = numbers(r"largest step .*: (\S+) rad/s with jumps, (\S+) rad/s with splinecast", said)
    assert "steps beyond acceleration × 1 ms: none" in said
    assert jumps > 10 * curve > 0, f"{jumps} with jumps, {curve} with splinecast"
    assert "<svg" in (Path(folder) / "chunks.svg").read_text(encoding="utf-8")


def scipy(folder, _):
    """Every curve equals SciPy's, and both peaks are compared with the limits."""
    said = output_of("4_scipy", folder, "--plot", "fit.png")
    assert said.count("equals SciPy's to 1e-12") == 5 and "PPoly equals the curve to 1e-13: True" in said
    assert len(re.findall(r"largest (?:velocity|acceleration) of q\d", said)) == 4
    assert (Path(folder) / "fit.png").stat().st_size > 0


def main():
    """Runs one example; removes the stream that a failure has left."""
    checks = {"1_sine": sine, "2_policy": policy, "3_chunks_naive": chunks_naive, "4_scipy": scipy}
    if len(sys.argv) != 3 or sys.argv[1] not in checks:
        print(__doc__)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        try:
            checks[sys.argv[1]](folder, sys.argv[2])
        finally:
            subprocess.run(["splinecast", "rm", STREAM], check=False, capture_output=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
