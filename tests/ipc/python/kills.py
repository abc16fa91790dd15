#!/usr/bin/python3
"""Kills the Python producer and the Python solver of a live stream at random instants.

    kills.py [--kills N] [--seed S]     exits with 1 if a promise is broken

A reader in a process of its own samples at 1 kHz. It checks that settled samples never change and that position and
velocity never step: they change by no more than their derivative explains. This process checks that each accepted
waypoint is interpolated, refused with a reason, or counted as passed over.
"""

import argparse
import json
import os
import queue
import random
import signal
import subprocess
import sys
import threading
import time

import numpy as np

import splinecast

MS = 1_000_000
INTERVAL = 10 * MS
LEAD = 300 * MS
DIMENSIONS = 3
ROUNDING = 1e-9
PATIENCE = 600.0


def position(t):
    """The position of the motion at an instant [ns]."""
    return np.sin(2 * np.pi * 0.5e-9 * (t % 2_000_000_000) + np.arange(DIMENSIONS))


def produce(stream):
    """Appends waypoints until it or its parent is killed, and prints the time of each that was accepted."""
    producer = splinecast.Producer(stream, dimensions=DIMENSIONS)
    producer.wait_for_solver()
    newest = producer.last_time
    parent = os.getppid()
    while os.getppid() == parent:
        now = time.monotonic_ns()
        t = max(newest + INTERVAL, (now + LEAD) // INTERVAL * INTERVAL)
        if t <= now + LEAD:
            try:
                producer.append(t, position(t), timeout=1.0)
                print(t, flush=True)
            except splinecast.Refused as refused:
                print(f"not accepted: {refused}", file=sys.stderr, flush=True)
            newest = t
        time.sleep(0.002)


def solve(stream):
    """Solves until it is killed, or its parent is."""
    parent = os.getppid()
    with splinecast.Solver(stream, history=2.0).start() as solver:
        while solver.is_running and os.getppid() == parent:
            time.sleep(0.05)


class Watch:
    """Samples the stream at 1 kHz and checks the samples."""

    def __init__(self, stream):
        self.reader = splinecast.Reader(stream, timeout=PATIENCE)
        self.state = splinecast.State(DIMENSIONS)
        self.settled = {}
        self.before = None
        self.counts = {"samples": 0, "settled": 0, "compared": 0, "revised": 0, "stopping": 0}
        self.failures = []

    def look(self):
        now = time.monotonic_ns()
        status = self.reader.sample(now, self.state).status
        if not status.has_values:
            return
        self.counts["samples"] += 1
        if status.name.lower() in self.counts:
            self.counts[status.name.lower()] += 1
        self.check_step(now)
        if status is splinecast.SampleStatus.SETTLED:
            self.settled[now] = self.state.values.copy()
        self.check_settled(now)

    def check_step(self, now):
        """Position and velocity change by at most the largest derivative between two samples."""
        before, self.before = self.before, (now, self.state.values.copy())
        if before is None:
            return
        block = self.reader.sample_many(np.linspace(before[0], now, 33).astype(np.int64))
        if not block.revision or np.isnan(block.values).any():
            return
        seconds = (now - before[0]) / 1e9
        change = np.abs(self.state.values - before[1])
        most = np.abs(block.values).max(axis=0)
        # The largest value between two of the 33 instants: the next derivative explains it.
        slack = most[2:] * seconds / 32
        for r, allowed in ((0, most[1] + slack[0]), (1, most[2] + slack[1])):
            if (change[r] > allowed * seconds * 1.01 + 1e-6).any():
                self.failures.append(f"derivative {r} steps by {change[r]} in {seconds} s at {now}")

    def check_settled(self, now):
        for t in [t for t in self.settled if t < now - 1_500 * MS]:
            del self.settled[t]
        times = random.sample(sorted(self.settled), min(8, len(self.settled)))
        block = self.reader.sample_many(np.array(times, np.int64)) if times else None
        for i, t in enumerate(times):
            if not splinecast.SampleStatus(block.status[i]).has_values:
                continue
            self.counts["compared"] += 1
            if not np.array_equal(block.values[i], self.settled[t]):
                self.failures.append(f"the settled sample at {t} has changed at {now}")


def watch(stream):
    """Watches until standard input ends, then prints what it found."""
    found = Watch(stream)
    ended = threading.Event()
    threading.Thread(target=lambda: (sys.stdin.read(), ended.set()), daemon=True).start()
    due = time.monotonic()
    while not ended.is_set():
        found.look()
        due = max(due + 0.001, time.monotonic())
        time.sleep(max(due - time.monotonic(), 0))
    print(json.dumps({**found.counts, "failures": found.failures}))


class Journal:
    """The waypoints that were accepted, and whether the curve passes through them."""

    def __init__(self, stream):
        self.stream = stream
        self.reader = None
        self.printed = queue.SimpleQueue()
        self.waiting = []
        self.interpolated = 0
        self.missed = []

    def follow(self, process):
        """Reads the times that a producer prints, in a thread; the last line may be incomplete."""
        def read():
            for line in process.stdout:
                if line.endswith("\n"):
                    self.printed.put(int(line))
        threading.Thread(target=read, daemon=True).start()

    def check(self):
        """Looks at the accepted waypoints that have settled."""
        self.reader = self.reader or splinecast.Reader(self.stream, timeout=PATIENCE)
        while not self.printed.empty():
            self.waiting.append(self.printed.get())
        progress = self.reader.progress()
        until = progress.settled_until + progress.is_finished if progress else 0
        open_ones, self.waiting = self.waiting, []
        for t in open_ones:
            state = self.reader.preview(t)
            if t >= until or not state.status.has_values:
                self.waiting.append(t)
            elif np.abs(state.position - position(t)).max() <= ROUNDING:
                self.interpolated += 1
            else:
                self.missed.append(t)


def start(role, stream, **how):
    return subprocess.Popen([sys.executable, "-B", __file__, role, stream], text=True, **how)


def kill(process):
    process.send_signal(signal.SIGKILL)
    process.wait()


def info(stream):
    """What the program reports about the stream."""
    return json.loads(subprocess.run(["splinecast", "info", stream, "--json"], check=True, text=True,
                                     stdout=subprocess.PIPE).stdout)


def find(report, key):
    """The value of a key anywhere in a report."""
    if isinstance(report, dict):
        return report[key] if key in report else next((f for v in report.values() if (f := find(v, key)) is not None),
                                                      None)
    return None


def is_over(progress, final):
    return progress is not None and progress.is_finished and progress.settled_until >= final


def attack(stream, kills, seed):
    """Starts the roles, kills producer and solver in turn at random, and returns (facts, failures)."""
    choose = random.Random(seed)
    journal = Journal(stream)
    roles = {"solver": start("solver", stream), "producer": start("producer", stream, stdout=subprocess.PIPE)}
    journal.follow(roles["producer"])
    reader = start("reader", stream, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    for _ in range(kills):
        end = time.monotonic() + choose.uniform(0.02, 0.4)
        # Mostly the roles recover before the next kill; else it may come while one of them starts.
        wanted = journal.interpolated + (3 if choose.random() < 0.7 else 0)
        bound = time.monotonic() + PATIENCE
        while time.monotonic() < (end if journal.interpolated >= wanted else bound):
            journal.check()
            time.sleep(0.01)
        role = choose.choice(("solver", "producer"))
        kill(roles[role])
        roles[role] = start(role, stream, stdout=subprocess.PIPE if role == "producer" else None)
        if role == "producer":
            journal.follow(roles[role])
    kill(roles["producer"])
    with splinecast.Producer(stream, dimensions=DIMENSIONS) as producer:
        producer.wait_until_consumed(PATIENCE)
        final = producer.last_time
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end and not is_over(journal.reader.progress(), final):
        time.sleep(0.01)
    journal.check()
    out, _ = reader.communicate("", timeout=PATIENCE)
    report = info(stream)
    kill(roles["solver"])
    return judge(journal, json.loads(out), report, final)


def judge(journal, watched, report, final):
    # A stop may have passed the last one before it is finished, and an end that slows down meets the last ones later.
    end = find(report, "end")
    slows_from = final - (end["lateness_ns"] if end and end["kind"] == "slowed" else 0)
    missed = [t for t in journal.missed if t <= slows_from and t != final]
    progress = journal.reader.progress()
    passed_over = find(report, "passed_over")
    failures = watched.pop("failures")
    if watched["compared"] < 1000 or journal.interpolated < 100:
        failures.append("too little was checked")
    if journal.waiting:
        failures.append(f"{len(journal.waiting)} accepted waypoints have not settled")
    if len(missed) > passed_over + progress.refused:
        failures.append(f"{len(missed)} accepted waypoints are missing, {passed_over} are counted as passed over "
                        f"and {progress.refused} as refused")
    return {**watched, "interpolated": journal.interpolated, "missed": len(missed), "passed_over": passed_over,
            "refused": progress.refused, "waypoints": progress.waypoints, "revisions": progress.revision}, failures


def main():
    roles = {"producer": produce, "solver": solve, "reader": watch}
    if len(sys.argv) == 3 and sys.argv[1] in roles:
        roles[sys.argv[1]](sys.argv[2])
        return 0
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=60)
    parser.add_argument("--seed", type=int, default=random.randrange(2**32))
    options = parser.parse_args()
    print(f"seed {options.seed}")
    stream = f"test.{os.getpid()}.kills"
    try:
        facts, failures = attack(stream, options.kills, options.seed)
    finally:
        try:
            splinecast.remove(stream)
        except splinecast.Error as error:
            print(error, file=sys.stderr)
    print(json.dumps(facts))
    for failure in failures[:20]:
        print(f"BROKEN: {failure}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
