#!/usr/bin/env python3
"""Kills recorders of a live stream at random times, and verifies what each has written.

    recorder_kills.py PROGRAM [KILLS] [SEED]

The stream is that of `demo --chaos`: its producer and solver are killed, paused and starved meanwhile. Prints counts as
JSON. Exits with 1 if a file cannot be read up to its last whole chunk, or if a segment differs.
"""

import json
import random
import signal
import subprocess
import sys
import tempfile
import time


def verified(program, path):
    """The exit code of `replay --verify`, and what it found of the only stream; None if the file has none."""
    ended = subprocess.run([program, "replay", "--verify", "--json", path], stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE, text=True, check=False)
    if ended.returncode == 2 and "no stream" in ended.stderr:
        return 2, None
    if ended.returncode not in (0, 3):
        return ended.returncode, {"message": ended.stderr}
    return ended.returncode, next(iter(json.loads(ended.stdout)["streams"].values()))


def main():
    program = sys.argv[1]
    kills = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    chance = random.Random(seed)
    demo = subprocess.Popen([program, "demo", "--chaos", "--seconds", str(4 * kills + 20), "--json"],
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    counts = {"seed": seed, "kills": kills, "without_a_chunk": 0, "recovered": 0, "segments": 0, "equal": 0, "bad": []}
    with tempfile.TemporaryDirectory() as folder:
        for kill in range(kills):
            path = f"{folder}/{kill}.mcap"
            recorder = subprocess.Popen([program, "record", f"demo.{demo.pid}", "-o", path, "--quiet"])
            time.sleep(chance.uniform(0.1, 3))
            recorder.send_signal(signal.SIGKILL)
            recorder.wait()
            code, found = verified(program, path)
            if found is None:
                counts["without_a_chunk"] += 1
                continue
            if "equal" not in found or found["difference"]:
                counts["bad"].append({"kill": kill, "code": code, "found": found})
                continue
            counts["segments"] += found["segments"]
            counts["equal"] += found["equal"]
            # A complete file of the whole part has the same segments.
            whole = f"{folder}/{kill}.whole.mcap"
            subprocess.run([program, "recover", path, "-o", whole], check=True, stderr=subprocess.DEVNULL)
            if verified(program, whole)[1] != found:
                counts["bad"].append({"kill": kill, "found": "recover gives another result"})
            counts["recovered"] += 1
    demo.send_signal(signal.SIGINT)
    demo.wait()
    print(json.dumps(counts))
    return 1 if counts["bad"] else 0


if __name__ == "__main__":
    sys.exit(main())
