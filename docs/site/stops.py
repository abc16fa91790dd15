#!/usr/bin/env python3
"""Stops a machine in each way with real processes, and draws what a controller reads.

    stops.py              draws docs/plots/stops/*.svg, and writes the table of docs/stopping.md
    stops.py --check      exits with 1 unless the page has every way, with its plot, and every plot is there
    stops.py swing …      a producer of the swing that the ways stop (used by this program)

Needs the build with Python: PYTHONPATH=build/release/python, and build/release/bin in PATH. Takes about 40 s.
"""

import argparse
import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

DOCS = Path(__file__).resolve().parent.parent
PLOTS = DOCS / "plots" / "stops"
PAGE = DOCS / "stopping.md"
BEGIN, END = "<!-- measured -->", "<!-- end of measured -->"

AMPLITUDE, PERIOD, LEAD, STEP = 0.3, 2.0, 0.2, 0.01  # rad, s, s, s
LIMIT = "20"  # rad/s²
WIDTH, HEIGHT, LEFT, TOP, PANEL, GAP = 640, 250, 56, 28, 84, 14
INK, FAINT, CURVE, MARK = "#24292f", "#d8dee4", "#0b62c4", "#c1272d"


def name_of(way):
    return f"stops.{os.getpid()}.{way}"


# ---------------------------------------------------------------------------------------- the machine

def swing(arguments):
    """Sends a swing until it is stopped: by SIGUSR1 in the way that is given, or from outside."""
    import math

    import splinecast

    parser = argparse.ArgumentParser()
    parser.add_argument("stream")
    parser.add_argument("--at-signal", choices=["stop", "finish", "with", "nothing"], default="nothing")
    parser.add_argument("--law")
    asked = parser.parse_args(arguments)
    is_stopped = []
    signal.signal(signal.SIGUSR1, lambda *_: is_stopped.append(True))
    with splinecast.Producer(asked.stream, law=asked.law) as producer:
        producer.wait_for_solver(10)
        begin = producer.now() + int(LEAD * 1e9)
        sent = 0
        while not is_stopped:
            while sent * STEP < (producer.now() - begin) / 1e9 + LEAD and not is_stopped:
                x = AMPLITUDE * (1 - math.cos(2 * math.pi * sent * STEP / PERIOD))
                try:
                    producer.append(begin + int(sent * STEP * 1e9), [x])
                except splinecast.Refused as refused:
                    print(refused, flush=True)
                    is_stopped.append(True)
                sent += 1
            time.sleep(0.002)
        if asked.at_signal == "stop":
            producer.replace_from()
        if asked.at_signal == "finish":
            producer.finish()
        if asked.at_signal != "with":
            time.sleep(2)  # until it is killed


class Machine:
    """A solver, the swing, and a reader at 1 kHz."""

    def __init__(self, way, at_signal="nothing", law=False):
        self.name = name_of(way)
        self.law = self.name + ".law" if law else None
        names = [self.name] + ([self.law] if law else [])
        self.solver = subprocess.Popen(["splinecast", "solve", *names, "--quiet", "--max-acceleration", LIMIT])
        if law:
            splinecast_run("rate", self.law, "1", "--ramp", "0.05", "--wait", "10")
        self.producer = None
        if at_signal != "none":
            command = [sys.executable, __file__, "swing", self.name, "--at-signal", at_signal]
            self.producer = subprocess.Popen(command + (["--law", self.law] if law else []))

    def record(self, act):
        """Lets `act` stop the machine in the middle of a swing. Returns samples and the time of the request."""
        import splinecast

        rows = []
        requested = None
        with splinecast.Reader(self.name, timeout=10) as reader:
            begin = None
            last = time.monotonic() + 20
            while time.monotonic() < last:
                now = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
                state = reader.sample(now)
                if state.position[0] == state.position[0]:  # not NaN: it has values
                    rows.append((now, float(state.position[0]), float(state.velocity[0])))
                    if begin is None and abs(rows[-1][2]) > 0.01:
                        begin = now
                due = begin is not None and now - begin > (1.75 if self.law else 1.25) * PERIOD * 1e9
                if requested is None and due and rows[-1][2] > 0.9 * 2 * 3.1416 * AMPLITUDE / PERIOD:
                    requested = now
                    act(self)
                    last = time.monotonic() + 1.2
                time.sleep(0.001)
        return rows, requested

    def close(self):
        for process in (self.producer, self.solver):
            if process is not None:
                process.kill()
                process.wait()
        for name in (self.name, self.law):
            if name:
                subprocess.run(["splinecast", "stop", name, "--release", "--wait", "0"], capture_output=True)
                subprocess.run(["splinecast", "rm", "--now", name], capture_output=True)


def splinecast_run(*arguments):
    subprocess.run(["splinecast", *arguments], check=True, capture_output=True)


def start(*arguments):
    """A process in the background: the time from its start is part of what is measured."""
    return subprocess.Popen(["splinecast", *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


# ------------------------------------------------------------------------------------------- the ways

def signal_producer(machine):
    machine.producer.send_signal(signal.SIGUSR1)


def dead_man(machine):
    machine.commander.kill()


def make_replay(machine):
    """A recording of the swing, sent by `replay`."""
    import math

    path = Path(f"/tmp/{machine.name}.csv")
    rows = ["t,x"] + [f"{i * STEP:.2f},{AMPLITUDE * (1 - math.cos(2 * math.pi * i * STEP / PERIOD)):.9f}"
                      for i in range(1001)]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    machine.producer = start("replay", str(path), "--stream", machine.name, "--lead", "200")


def make_dead_man(machine):
    machine.commander = start("rate", machine.law, "1", "--as", "pendant", "--dead-man", "0.1",
                              "--dead-man-ramp", "0.1", "--force")


# (file, title, how the machine is made, what stops it)
WAYS = [
    ("stop", "stop: its producer's own", {"at_signal": "stop"}, signal_producer, None),
    ("elsewhere", "stop from elsewhere: splinecast stop", {},
     lambda m: start("stop", m.name), None),
    ("hold", "hold: rate 0, ramp 0.2 s", {"law": True},
     lambda m: start("rate", m.law, "0", "--ramp", "0.2", "--as", "panel"), None),
    ("estop", "estop: rate 0, ramp 0.05 s", {"law": True},
     lambda m: start("rate", m.law, "0", "--ramp", "0.05", "--as", "estop"), None),
    ("dead_man", "dead man of 0.1 s: its process is killed", {"law": True}, dead_man, make_dead_man),
    ("finish", "finish", {"at_signal": "finish"}, signal_producer, None),
    ("ctrl_c", "Ctrl-C of replay", {"at_signal": "none"},
     lambda m: m.producer.send_signal(signal.SIGINT), make_replay),
    ("with", "the end of `with`", {"at_signal": "with"}, signal_producer, None),
    ("kill_producer", "kill -9 of the producer", {}, lambda m: m.producer.kill(), None),
    ("kill_solver", "kill -9 of the solver", {}, lambda m: m.solver.kill(), None),
    ("kill_both", "kill -9 of both", {}, lambda m: (m.producer.kill(), m.solver.kill()), None),
]


def run_way(way):
    file, title, made, act, prepare = way
    machine = Machine(file, **made)
    try:
        if prepare:
            prepare(machine)
        rows, requested = machine.record(act)
    finally:
        machine.close()
        with contextlib.suppress(FileNotFoundError):
            Path(f"/tmp/{machine.name}.csv").unlink()
    if requested is None:
        sys.exit(f"{title}: the machine did not move")
    return rows, requested


def measured(rows, requested):
    """How far and how long the machine moves after the request: the way, and the time until it rests."""
    behind = [row for row in rows if row[0] >= requested]
    way = sum(abs(b[1] - a[1]) for a, b in zip(behind, behind[1:]))
    moving = [t for t, _, v in behind if abs(v) > 1e-6]
    return way, (max(moving, default=requested) - requested) / 1e9


# ------------------------------------------------------------------------------------------ the plots

def line(points):
    """A polyline with no more points than the eye needs."""
    kept = [points[0]]
    for before, point, after in zip(points, points[1:], points[2:]):
        turns = abs((point[1] - kept[-1][1]) * (after[0] - kept[-1][0])
                    - (after[1] - kept[-1][1]) * (point[0] - kept[-1][0]))
        if turns > 1.5 or point[0] - kept[-1][0] > 12:
            kept.append(point)
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in [*kept, points[-1]])


def draw(title, rows, requested):
    shown = [((t - requested) / 1e9, x, v) for t, x, v in rows if -0.5e9 <= t - requested <= 1.0e9]
    x_of = lambda t: LEFT + (t + 0.5) / 1.5 * (WIDTH - LEFT - 12)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
             f'height="{HEIGHT}" font-family="sans-serif" font-size="12" fill="{INK}">', f"<title>{title}</title>",
             f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>',
             f'<text x="{LEFT}" y="16" font-weight="bold">{title}</text>']
    for number, (label, index, low, high) in enumerate((("position [rad]", 1, -0.05, 2 * AMPLITUDE + 0.05),
                                                        ("velocity [rad/s]", 2, -1.1, 1.1))):
        top = TOP + number * (PANEL + GAP)
        y_of = lambda value: top + PANEL * (1 - (value - low) / (high - low))
        parts.append(f'<rect x="{LEFT}" y="{top}" width="{WIDTH - LEFT - 12}" height="{PANEL}" fill="none" '
                     f'stroke="{FAINT}"/>')
        parts += [f'<text x="{LEFT - 6}" y="{y_of(value) + 4:.0f}" text-anchor="end">{value:g}</text>'
                  for value in ((0, 0.3, 0.6) if index == 1 else (-1, 0, 1))]
        parts.append(f'<text x="{LEFT + 6}" y="{top + 14}">{label}</text>')
        parts.append(f'<path d="M{x_of(0):.1f} {top}v{PANEL}" stroke="{MARK}" stroke-dasharray="4 3"/>')
        points = [(x_of(row[0]), y_of(row[index])) for row in shown]
        parts.append(f'<polyline points="{line(points)}" fill="none" stroke="{CURVE}" stroke-width="1.6"/>')
    bottom = TOP + 2 * PANEL + GAP
    parts += [f'<text x="{x_of(t):.1f}" y="{bottom + 16}" text-anchor="middle">{t:g}</text>'
              for t in (-0.5, 0, 0.5, 1)]
    parts.append(f'<text x="{(LEFT + WIDTH) / 2:.0f}" y="{HEIGHT - 4}" text-anchor="middle">time after the request '
                 "[s]</text></svg>")
    return "\n".join(parts) + "\n"


def table(results):
    rows = ["| way | moves on for | distance |", "|---|---|---|"]
    rows += [f"| {title} | {seconds:.2f} s | {way * 1000:.0f} mrad |" for title, way, seconds in results]
    return "\n".join([BEGIN, "", *rows, "", END])


def make():
    PLOTS.mkdir(parents=True, exist_ok=True)
    results = []
    for way in WAYS:
        rows, requested = run_way(way)
        distance, seconds = measured(rows, requested)
        results.append((way[1], distance, seconds))
        print(f"{way[1]}: {seconds:.3f} s, {distance * 1000:.1f} mrad", flush=True)
        (PLOTS / f"{way[0]}.svg").write_text(draw(way[1], rows, requested), encoding="utf-8")
    page = PAGE.read_text(encoding="utf-8")
    before, behind = page.split(BEGIN)[0], page.split(END)[1]
    PAGE.write_text(before + table(results) + behind, encoding="utf-8")


def check():
    page = PAGE.read_text(encoding="utf-8")
    problems = []
    for file, title, *_ in WAYS:
        if f"(plots/stops/{file}.svg)" not in page or not (PLOTS / f"{file}.svg").is_file():
            problems.append(f"no plot {file}.svg")
        if f"| {title} |" not in page:
            problems.append(f"the table does not have “{title}”")
    problems += [f"the page does not show {path.name}" for path in PLOTS.glob("*.svg")
                 if path.stem not in {way[0] for way in WAYS}]
    if problems:
        sys.exit("\n".join(problems))


if __name__ == "__main__":
    if sys.argv[1:2] == ["swing"]:
        swing(sys.argv[2:])
    elif sys.argv[1:] == ["--check"]:
        check()
    elif len(sys.argv) == 1:
        make()
    else:
        sys.exit(__doc__)
