#!/usr/bin/env python3
"""Runs `splinecast solve '*'` with live streams while a user attacks it through /dev/shm.

    hostile_user.py [--seconds S] [--seed N] [--bin FOLDER] [--json FILE]

Uses a mount namespace with its own /dev/shm. Run as root, one unprivileged user owns the streams and another
one, a member of the group that may read them, attacks. Otherwise both are the same user, and the attacks do
not touch the files of the streams. Exit code 1: there are findings, or a kind of attack was not carried out;
77: this machine does not allow such a namespace. hostile_user_attacks.py has the attacks.
"""

import argparse
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from page import this_machine, today

CAMPAIGN = Path(__file__).resolve().parent
VICTIM, ATTACKER, TEAM = 12345, 23456, 54321
STREAMS = ["arm.left", "arm.right", "base"]
# Large, because test machines are busy: these limits only find what never ends.
UNSERVED = 10.0  # seconds without a new settled knot
HANG = 600.0  # seconds
SPARE = 30.0  # seconds that recordings are longer than the attack
SKIPPED = 77


def identity(user):
    """Arguments of subprocess that run a child as another user, or none without this right."""
    if not TWO_USERS:
        return {}
    return {"user": user, "group": user, "extra_groups": [TEAM]}


TWO_USERS = os.environ.get("HOSTILE_USER_NAMESPACE") == "root"
SHARED = ["--mode", "0640", "--group", str(TEAM)] if TWO_USERS else []


class Victim:
    """The user whose streams are attacked: solver, producers, readers and findings."""

    def __init__(self, program, folder, seconds):
        self.program = program
        self.folder = folder
        self.seconds = seconds
        self.lock = threading.Lock()
        self.found = {name: 0 for name in ("solvers ended", "streams without progress", "wrong samples", "hangs",
                                           "verbs that failed")}
        self.measured = {"samples": 0, "checks of streams": 0, "streams created and removed": 0}
        self.longest_silence = 0.0
        self.ended = threading.Event()

    def start(self, *arguments, **more):
        return subprocess.Popen([self.program, *arguments], **identity(VICTIM), **more)

    def find(self, what, why):
        with self.lock:
            self.found[what] += 1
        print(f"{what}: {why}", file=sys.stderr, flush=True)

    def count(self, what, number=1):
        with self.lock:
            self.measured[what] += number

    def run(self, *arguments, codes=(0,)):
        """Output of a verb that must end in time with one of `codes`; None if it does not."""
        try:
            ended = subprocess.run([self.program, *arguments], capture_output=True, check=False, timeout=HANG,
                                   **identity(VICTIM))
        except subprocess.TimeoutExpired:
            self.find("hangs", " ".join(arguments))
            return None
        if ended.returncode not in codes:
            self.find("verbs that failed", f"{' '.join(arguments)}: {ended.returncode} {ended.stderr.decode()}")
            return None
        return ended.stdout.decode()

    def record(self, name, seconds):
        """A recording at 100 Hz with y = 2 x + 1, which also holds for each curve through it."""
        path = self.folder / name
        rows = (f"{i / 100},{math.sin(i / 30)},{2 * math.sin(i / 30) + 1}\n" for i in range(int(seconds * 100)))
        path.write_text("t,x,y\n" + "".join(rows))
        path.chmod(0o644)
        return str(path)

    def replay(self, recording, stream, **more):
        return self.start("replay", recording, "--stream", stream, "--lead", "500", "--on-error", "skip", "--wait",
                          str(HANG), *SHARED, stdout=subprocess.DEVNULL, **more)

    def read(self, stream):
        """Reads a stream and checks that each sample is on its curve."""
        while not self.ended.is_set():
            text = self.run("sample", stream, "--rate", "200", "--count", "100")
            for row in (text or "").splitlines()[1:]:
                fields = row.split(",")
                if fields[-1] not in ("settled", "provisional"):
                    continue
                x, y, vx, vy = (float(field) for field in fields[1:5])
                # The motion stays within 1; an entry after a pause may overshoot.
                if abs(y - 2 * x - 1) > 1e-9 or abs(vy - 2 * vx) > 1e-6 or not abs(x) < 2:
                    self.find("wrong samples", f"{stream}: {row}")
                self.count("samples")

    def watch(self, stream):
        """Checks that the stream continues to settle."""
        settled, since, is_told = None, time.monotonic(), False
        while not self.ended.is_set():
            text = self.run("info", stream, "--json")
            solver = json.loads(text).get("solver") if text else None
            now = time.monotonic()
            self.longest_silence = max(self.longest_silence, now - since)
            if solver and solver["settled_until_ns"] != settled:
                settled, since, is_told = solver["settled_until_ns"], now, False
            if now - since > UNSERVED and not is_told:
                is_told = True
                self.find("streams without progress", f"{stream}: nothing settled for {now - since:.1f} s")
            self.count("checks of streams")
            time.sleep(0.1)

    def look(self):
        """Runs the verbs that read all names. The exit code of doctor also depends on the machine."""
        while not self.ended.is_set():
            self.run("ls")
            self.run("doctor", codes=(0, 1))
            time.sleep(0.2)

    def come_and_go(self, recording):
        """Creates streams during the attack, which must be solved, and removes them."""
        for number in range(1 << 30):
            if self.ended.is_set():
                return
            producer = self.replay(recording, f"guest.{number}", stderr=subprocess.PIPE)
            try:
                _, said = producer.communicate(timeout=2 * HANG)
            except subprocess.TimeoutExpired:
                producer.kill()
                self.find("hangs", f"replay of guest.{number}")
                continue
            if producer.returncode != 0:
                self.find("streams without progress", f"guest.{number}: {said.decode()}")
            self.count("streams created and removed")


def attack(seconds, seed):
    """Runs the attacks as the other user. Returns the number of attacks of each kind."""
    # The other user may only run the system's Python, and read the program from a pipe.
    command = ["/usr/bin/python3", "-", str(seconds), str(seed), *([] if TWO_USERS else ["--same-user"]), *STREAMS]
    program = (CAMPAIGN / "hostile_user_attacks.py").read_bytes()
    ended = subprocess.run(command, input=program, stdout=subprocess.PIPE, check=True, cwd="/",
                           **identity(ATTACKER))
    return json.loads(ended.stdout)


def await_streams(victim):
    """Waits until each stream is being solved."""
    end = time.monotonic() + HANG
    for stream in STREAMS:
        while True:
            ended = subprocess.run([victim.program, "info", stream, "--json"], capture_output=True, check=False,
                                   **identity(VICTIM))
            solver = json.loads(ended.stdout).get("solver") if ended.returncode == 0 else None
            if solver and solver["interpolated"] > 10:
                break
            if time.monotonic() > end:
                sys.exit(f"{stream} is not solved even without attacks")
            time.sleep(0.05)


def run(victim, seconds, seed):
    long = victim.record("long.csv", seconds + SPARE)
    short = victim.record("short.csv", 1.0)
    log = open(victim.folder / "solve.log", "wb")
    solver = victim.start("solve", "*", *SHARED, stdout=log, stderr=log)
    producers = [victim.replay(long, stream, stderr=subprocess.DEVNULL) for stream in STREAMS]
    await_streams(victim)
    jobs = [threading.Thread(target=job, args=(stream,)) for stream in STREAMS for job in (victim.read, victim.watch)]
    jobs += [threading.Thread(target=victim.look), threading.Thread(target=victim.come_and_go, args=(short,))]
    for job in jobs:
        job.start()
    try:
        kinds = attack(seconds, seed)
    finally:
        victim.ended.set()
        for job in jobs:
            job.join()
    if solver.poll() is not None:
        victim.find("solvers ended", f"with code {solver.returncode}: {(victim.folder / 'solve.log').read_bytes()!r}")
    solver.send_signal(signal.SIGINT)
    try:
        solver.wait(HANG)
    except subprocess.TimeoutExpired:
        solver.kill()
        victim.find("hangs", "solve does not end")
    for producer in producers:
        producer.kill()
        producer.wait()
    return kinds


def inside(arguments):
    folder = Path(tempfile.mkdtemp(prefix="hostile_user_"))
    folder.chmod(0o755)
    program = str(Path(arguments.bin).resolve() / "splinecast")
    victim = Victim(program, folder, arguments.seconds)
    begin = time.monotonic()
    kinds = run(victim, arguments.seconds, arguments.seed)
    seconds = time.monotonic() - begin
    shutil.rmtree(folder)
    missing = [kind for kind, count in kinds.items() if count == 0]
    victim.found["kinds of attack that were not carried out"] = len(missing)
    if missing:
        print("not carried out:", ", ".join(missing), file=sys.stderr)
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout.split()[-1]
    result = {
        "promise": [5, 6],
        "attack": "hostile user: a hostile local user while `solve '*'`, producers and readers run: invalid names, files "
                  "of all kinds that are exchanged, links, locks, leases, futex waiters, floods of files",
        "count": sum(kinds.values()),
        "unit": "attacks",
        "found": victim.found,
        "measured": {**kinds, **victim.measured,
                     "longest time without a new settled knot [s]": round(victim.longest_silence, 2),
                     "users": 2 if TWO_USERS else 1, "seed": arguments.seed},
        "machine": this_machine(),
        "seconds": round(seconds, 1),
        "date": today(),
        "command": f"tests/campaign/hostile_user.py --seconds {arguments.seconds:g} --seed {arguments.seed}",
        "version": version,
    }
    text = json.dumps(result, indent=2) + "\n"
    if arguments.json:
        Path(arguments.json).write_text(text, encoding="utf-8")
    print(text, end="")
    return 1 if any(victim.found.values()) else 0


def in_namespace():
    """Runs this program again in a mount namespace with its own /dev/shm."""
    is_root = os.geteuid() == 0
    unshare = ["unshare", "--mount", *([] if is_root else ["--map-root-user"])]
    mount = "mount -t tmpfs -o mode=1777,size=512m tmpfs /dev/shm"
    if subprocess.run([*unshare, "sh", "-c", mount], check=False, capture_output=True).returncode != 0:
        print("needs its own mount namespace (root, or user namespaces)", file=sys.stderr)
        return SKIPPED
    environment = {**os.environ, "HOSTILE_USER_NAMESPACE": "root" if is_root else "user"}
    command = ["sh", "-c", f"{mount} && exec \"$@\"", "sh", sys.executable, "-B", *sys.argv]
    return subprocess.run([*unshare, *command], check=False, env=environment).returncode


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=300)
    parser.add_argument("--seed", type=int, default=int.from_bytes(os.urandom(4), "little"))
    parser.add_argument("--bin", default=str(CAMPAIGN.parent.parent / "build/release/bin"))
    parser.add_argument("--json")
    arguments = parser.parse_args()
    return inside(arguments) if "HOSTILE_USER_NAMESPACE" in os.environ else in_namespace()


if __name__ == "__main__":
    sys.exit(main())
