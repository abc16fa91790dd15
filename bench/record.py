#!/usr/bin/env python3
"""What a recorder costs: CPU time beside many live streams, and instructions of a producer and a solver beside it.

    record.py cost PROGRAM [STREAMS] [SECONDS] [COMPRESSION]   live streams at 100 Hz with 7 dimensions
    record.py instructions PROGRAM                             counted by valgrind's callgrind, without and with a recorder

Makes streams `bench.record.N` and removes them.
"""

import json
import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

STREAM = "bench.record"
TICK = os.sysconf("SC_CLK_TCK")
FUNCTIONS = {"append": r"splinecast::Producer::append\(", "step": r"splinecast::ipc::StreamSolver::step\("}


def write_motion(path, rows):
    """A recording of seven joints at 100 Hz."""
    with open(path, "w", encoding="utf-8") as file:
        file.write("t," + ",".join(f"j{d}" for d in range(7)) + "\n")
        for i in range(rows):
            values = ",".join(repr(1.234567 * math.sin(0.02 * i + d)) for d in range(7))
            file.write(f"{i * 0.01:.2f},{values}\n")


def cpu_seconds(pid):
    """CPU time of all threads of a process."""
    with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICK


def remove(program, names):
    for name in names:
        subprocess.run([program, "rm", name], stderr=subprocess.DEVNULL, check=False)


def stopped(process):
    process.send_signal(signal.SIGINT)
    return process.communicate()[0]


def cost(program, streams=100, seconds=20.0, compression="zstd"):
    """Share of a core that a recorder takes, what it lost, and whether the recording verifies."""
    names = [f"{STREAM}.{i}" for i in range(int(streams))]
    with tempfile.TemporaryDirectory() as folder:
        motion, output = f"{folder}/motion.csv", f"{folder}/run.mcap"
        write_motion(motion, int(100 * (float(seconds) + 60)))
        solver = subprocess.Popen([program, "solve", f"{STREAM}.*", "--quiet"])
        time.sleep(0.5)
        producers = [subprocess.Popen([program, "replay", motion, "--stream", name, "--lead", "300"],
                                      stderr=subprocess.DEVNULL) for name in names]
        time.sleep(6)
        recorder = subprocess.Popen([program, "record", f"{STREAM}.*", "-o", output, "--json", "--quiet",
                                     "--compression", compression], stdout=subprocess.PIPE)
        time.sleep(3)
        begin, used = time.monotonic(), cpu_seconds(recorder.pid)
        time.sleep(float(seconds))
        share = (cpu_seconds(recorder.pid) - used) / (time.monotonic() - begin)
        report = json.loads(stopped(recorder))
        for process in [*producers, solver]:
            stopped(process)
        verified = subprocess.run([program, "replay", "--verify", output, "--json"], stdout=subprocess.PIPE, check=False)
        found = json.loads(verified.stdout)["streams"].values()
    remove(program, names)
    print(json.dumps({"streams": len(names), "compression": compression, "percent_of_a_core": round(100 * share, 2),
                      "bytes": report["bytes"], "items": report["items"], "segments": report["segments"],
                      "dropped": report["dropped"], "lost": report["lost"], "verify_code": verified.returncode,
                      "equal": sum(s["equal"] for s in found), "unverified": sum(s["unverified"] for s in found)}))


def counted(program, folder, name):
    """Instructions of each function, for a recorded stream of 20,000 waypoints that is solved in the same process."""
    out = f"{folder}/{name}.out"
    subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", program, "replay", f"{folder}/motion.csv",
                    "--stream", STREAM, "--clock", "recorded", "--rate", "max", "--embedded", "--capacity", "65536"],
                   check=True, stderr=subprocess.DEVNULL)
    text = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", out], check=True,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    found = {}
    for key, pattern in FUNCTIONS.items():
        line = next(line for line in text.splitlines() if re.search(pattern, line))
        found[key] = int(line.split()[0].replace(",", ""))
    return found


def instructions(program):
    """The same counts without and with a recorder that reads the stream meanwhile."""
    with tempfile.TemporaryDirectory() as folder:
        write_motion(f"{folder}/motion.csv", 20_000)
        remove(program, [STREAM])
        without = counted(program, folder, "without")
        remove(program, [STREAM])
        recorder = subprocess.Popen([program, "record", STREAM, "-o", f"{folder}/run.mcap", "--json", "--quiet"],
                                    stdout=subprocess.PIPE)
        time.sleep(0.5)
        beside = counted(program, folder, "beside")
        report = json.loads(stopped(recorder))
        remove(program, [STREAM])
    print(json.dumps({"without": without, "beside_a_recorder": beside, "items_recorded": report["items"]}))


if __name__ == "__main__":
    {"cost": cost, "instructions": instructions}[sys.argv[1]](*sys.argv[2:])
