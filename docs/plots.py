#!/usr/bin/env python3
"""Plots what readers get around each fault, and writes the measured numbers into the pages.

    plots.py FOLDER           draws docs/plots/*.svg from the files of `splinecast_campaign motions --trace FOLDER`
                              and updates the tables of docs/what-happens-when.md; also updates the tables of
                              docs/choosing-a-method.md from tests/campaign/results/stops.json
    plots.py --check PROGRAM  exits with 1 unless docs/what-happens-when.md shows every plot and names every fault
                              of `PROGRAM motions --list`, every plot exists, and the tables of
                              docs/choosing-a-method.md are those of stops.json

`./run plots` runs the campaign and this program.
"""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
PLOTS = DOCS / "plots"
PAGE = DOCS / "what-happens-when.md"
TAILS = DOCS / "choosing-a-method.md"
STOPS = DOCS.parent / "tests" / "campaign" / "results" / "stops.json"

WIDTH = 760
LEFT, RIGHT, TOP, GAP, BOTTOM = 62, 14, 58, 16, 40
PANEL = 132
END = 6  # s, the time of the last waypoint of the streams that end
HEIGHT = TOP + 3 * PANEL + 2 * GAP + BOTTOM

INK, FAINT, CURVE, TARGET, LIMIT = "#24292f", "#d8dee4", "#0b62c4", "#8c959f", "#c1272d"
SHADES = {"stopping": "#ffe3b8", "holding": "#dfe3e8", "entry": "#d3efd7", "slowed": "#e9dcf7"}
SHADE_NAMES = {"stopping": "stop", "holding": "hold", "entry": "entry", "slowed": "slows down on its path"}


def read_trace(path):
    """Columns of numbers by name, with None for empty fields; and the statuses."""
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    numbers = {name: [float(row[name]) if row[name] else None for row in rows]
               for name in rows[0] if name != "status"}
    return numbers, [row["status"] for row in rows]


def spans_of(times, statuses):
    """(status, from, until) of consecutive samples with the same shaded status."""
    spans = []
    for t, status in zip(times, statuses):
        if spans and spans[-1][0] == status:
            spans[-1][2] = t
        else:
            if spans:
                spans[-1][2] = t
            spans.append([status, t, t])
    return [span for span in spans if span[0] in SHADES and span[2] > span[1]]


def simplified(points, tolerance=0.25):
    """Ramer–Douglas–Peucker: the points that remain at this tolerance, in pixels."""
    keep = {0, len(points) - 1}
    stack = [(0, len(points) - 1)]
    while stack:
        a, b = stack.pop()
        (xa, ya), (xb, yb) = points[a], points[b]
        worst, most = None, tolerance
        for i in range(a + 1, b):
            x, y = points[i]
            share = (x - xa) / (xb - xa) if xb > xa else 0
            distance = abs(y - (ya + share * (yb - ya)))
            if distance > most:
                worst, most = i, distance
        if worst is not None:
            keep.add(worst)
            stack += [(a, worst), (worst, b)]
    return [points[i] for i in sorted(keep)]


def round_step(span, count):
    """A step of 1, 2 or 5 times a power of ten, for at most `count` ticks."""
    step = 10.0 ** -6
    while True:
        for factor in (1, 2, 5):
            if span / (step * factor) <= count:
                return step * factor
        step *= 10


def tick_text(value, step):
    decimals = 0
    while decimals < 6 and abs(round(step, decimals) - step) > 1e-9 * step:
        decimals += 1
    return f"{value:.{decimals}f}".replace("-", "−") if abs(value) > step / 2 else "0"


class Panel:
    """One quantity over time."""

    def __init__(self, number, label, times, low, high):
        self.top = TOP + number * (PANEL + GAP)
        self.label = label
        self.first, self.last = times[0], times[-1]
        margin = 0.08 * (high - low) or 1
        self.low, self.high = low - margin, high + margin

    def x(self, t):
        return LEFT + (t - self.first) / (self.last - self.first) * (WIDTH - LEFT - RIGHT)

    def y(self, value):
        return self.top + (self.high - value) / (self.high - self.low) * PANEL

    def frame(self):
        right = WIDTH - RIGHT
        parts = [f'<text transform="translate(14 {self.top + PANEL / 2:.0f}) rotate(-90)" '
                 f'text-anchor="middle">{self.label}</text>']
        step = round_step(self.high - self.low, 5)
        tick = -int(-self.low // step) * step
        while tick <= self.high:
            y = self.y(tick)
            parts.append(f'<path d="M{LEFT} {y:.1f}H{right}" stroke="{FAINT}"/>'
                         f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">'
                         f'{tick_text(tick, step)}</text>')
            tick += step
        parts.append(f'<rect x="{LEFT}" y="{self.top}" width="{right - LEFT}" height="{PANEL}" '
                     f'fill="none" stroke="{TARGET}"/>')
        return parts

    def shades(self, spans):
        return [f'<rect x="{self.x(a):.1f}" y="{self.top}" width="{self.x(b) - self.x(a):.1f}" '
                f'height="{PANEL}" fill="{SHADES[status]}"/>' for status, a, b in spans]

    def line(self, times, values, color, width, dashes=""):
        points = [(self.x(t), self.y(v)) for t, v in zip(times, values) if v is not None]
        if len(points) < 2:
            return []
        text = "".join(f"{'L' if i else 'M'}{x:.1f} {y:.1f}"
                       for i, (x, y) in enumerate(simplified(points)))
        return [f'<path clip-path="url(#p{self.top})" d="{text}" fill="none" stroke="{color}" '
                f'stroke-width="{width}" stroke-linejoin="round"{dashes}/>']

    def clip(self):
        return (f'<clipPath id="p{self.top}"><rect x="{LEFT}" y="{self.top}" '
                f'width="{WIDTH - LEFT - RIGHT}" height="{PANEL}"/></clipPath>')


def legend(row, statuses):
    """The legend, above the panels."""
    parts, x = [], LEFT
    entries = [("line", CURVE, f"joint {row['joint']}"), ("line", TARGET, "target")]
    if row["limit [rad/s2]"]:
        entries.append(("dashes", LIMIT, f"limit {row['limit [rad/s2]']:g} rad/s²"))
    entries += [("box", SHADES[s], SHADE_NAMES[s]) for s in SHADES if s in statuses]
    if row["silences [s]"]:
        entries.append(("bar", INK, "producer silent"))
    if row["solver dead [s]"]:
        entries.append(("bar", LIMIT, "no solver"))
    if row["replacements [s]"]:
        entries.append(("tick", INK, "replace_from"))
    if row.get("finish at [s]"):
        entries.append(("tick", LIMIT, "finish"))
    for kind, color, name in entries:
        if kind == "box":
            parts.append(f'<rect x="{x}" y="25" width="18" height="11" fill="{color}"/>')
        elif kind == "bar":
            parts.append(f'<rect x="{x}" y="28" width="18" height="5" fill="{color}"/>')
        elif kind == "tick":
            parts.append(f'<path d="M{x + 9} 25l-4 8h8z" fill="{color}"/>')
        else:
            dashes = ' stroke-dasharray="5 4"' if kind == "dashes" else ""
            parts.append(f'<path d="M{x} 31h18" stroke="{color}" stroke-width="2"{dashes}/>')
        parts.append(f'<text x="{x + 23}" y="35">{name}</text>')
        x += 40 + 6.3 * len(name)
    return parts


def events(panel, row):
    """The events, in the strip between the legend and the panels."""
    parts = []

    def bar(intervals, color, y):
        for begin, end in intervals:
            a, b = panel.x(begin), panel.x(min(end, panel.last))
            parts.append(f'<rect x="{a:.1f}" y="{y}" width="{b - a:.1f}" height="5" fill="{color}"/>')

    bar(row["silences [s]"], INK, TOP - 14)
    bar(row["solver dead [s]"], LIMIT, TOP - 8)
    marks = [(at, INK) for at, _ in row["replacements [s]"]]
    finish = row.get("finish at [s]", panel.last)
    marks += [(finish, LIMIT)] if panel.first <= finish < panel.last else []
    for at, color in marks:
        parts.append(f'<path d="M{panel.x(at):.1f} {TOP - 13}l-4 8h8z" fill="{color}"/>')
    return parts


def acceleration_range(values, statuses, limit):
    """Largest acceleration of the panel: the peak, or that of stops and entries if noise would hide them."""
    most = max(abs(v) for v in values)
    shaded = [abs(v) for v, s in zip(values, statuses) if s in SHADES]
    calm = max(shaded + [limit * 1.15, 1])
    return min(most, 1.5 * calm) if most > 4 * calm else max(most, limit * 1.15)


def draw(row, numbers, statuses):
    times = [t for t in numbers["t [s]"]]
    spans = spans_of(times, statuses)
    limit = row["limit [rad/s2]"]
    a = numbers["acceleration [rad/s2]"]
    most = acceleration_range(a, statuses, limit)
    panels = []
    for number, (label, name) in enumerate((("position [rad]", "position [rad]"),
                                            ("velocity [rad/s]", "velocity [rad/s]"))):
        values = [v for v in numbers[name] + numbers["target " + name] if v is not None]
        panels.append(Panel(number, label, times, min(values), max(values)))
    panels.append(Panel(2, "acceleration [rad/s²]", times, -most, most))
    title = row["fault"] + (f", limit {limit:g} rad/s²" if limit else ", no limit")
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
             f'width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif" font-size="12" '
             f'fill="{INK}">', f"<title>{title}</title>",
             "<defs>" + "".join(panel.clip() for panel in panels) + "</defs>",
             f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>',
             f'<text x="{LEFT}" y="16" font-weight="bold">{title}</text>']
    parts += legend(row, set(statuses)) + events(panels[0], row)
    for panel in panels:
        parts += panel.shades(spans) + panel.frame()
    for panel, name in zip(panels, ("position [rad]", "velocity [rad/s]")):
        parts += panel.line(times, numbers["target " + name], TARGET, 3)
        parts += panel.line(times, numbers[name], CURVE, 1.5)
    if limit:
        for y in (limit, -limit):
            parts += panels[2].line([times[0], times[-1]], [y, y], LIMIT, 1.2,
                                    ' stroke-dasharray="5 4"')
    parts += panels[2].line(times, a, CURVE, 1.5)
    if max(abs(v) for v in a) > panels[2].high:
        parts.append(f'<text x="{WIDTH - RIGHT - 6}" y="{panels[2].top + 14}" text-anchor="end">'
                     f"the noise outside the panel reaches {max(abs(v) for v in a):.0f} rad/s²</text>")
    step = round_step(times[-1] - times[0], 9)
    tick = -int(-times[0] // step) * step
    bottom = panels[2].top + PANEL
    while tick <= times[-1] + 1e-9:
        x = panels[0].x(tick)
        parts.append(f'<path d="M{x:.1f} {bottom}v4" stroke="{TARGET}"/>'
                     f'<text x="{x:.1f}" y="{bottom + 17}" text-anchor="middle">'
                     f"{tick_text(tick, step)}</text>")
        tick += step
    parts.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2:.0f}" y="{HEIGHT - 6}" '
                 'text-anchor="middle">time [s]</text></svg>')
    return "\n".join(parts) + "\n"


def percent(part, whole):
    return f"{100 * part / whole:.1f} %"


def mrad(radians):
    return f"{1000 * radians:.2g} mrad" if radians < 0.01 else f"{1000 * radians:.0f} mrad"


def table_with(rows, lines):
    """A table with a column for each row of the campaign, and these lines: a name and the text of a row."""
    heads = [f"limit {row['limit [rad/s2]']:g} rad/s²" if row["limit [rad/s2]"] else "no limit" for row in rows]
    table = ["| | " + " | ".join(heads) + " |", "|---" * (len(rows) + 1) + "|"]
    table += [f"| {name} | " + " | ".join(text(row) for row in rows) + " |" for name, text in lines]
    return "\n".join(table)


def table_of(rows):
    """The measured numbers of a section."""

    def back(row):
        t = row["back on the path after [s]"]
        return f"{t:.2f} s" if t >= 0 else "not in the plot"

    return table_with(rows, (
            ("plot: path error, largest", lambda r: mrad(r["largest path error shown [rad]"])),
            ("plot: back on the path after", back),
            ("plot: time in the stop", lambda r: f"{r['stopping [s]']:.2f} s"),
            ("plot: time holding", lambda r: f"{r['holding [s]']:.2f} s"),
            ("plot: time in entries", lambda r: f"{r['in entries [s]']:.2f} s"),
            ("20 s: path error from 2 s on, p99", lambda r: mrad(r["path error p99 [rad]"])),
            ("20 s: path error from 2 s on, largest", lambda r: mrad(r["largest path error [rad]"])),
            ("20 s: peak velocity", lambda r: f"{r['peak velocity [rad/s]']:.2f} rad/s"),
            ("20 s: peak acceleration", lambda r: f"{r['peak acceleration [rad/s2]']:.2f} rad/s²"),
            ("20 s: peak acceleration in entries",
             lambda r: f"{r['peak acceleration in entries [rad/s2]']:.2f} rad/s²"),
            ("20 s: waypoints", lambda r: f"{r['waypoints']:,}"),
            ("20 s: waypoints passed over", lambda r: percent(r["passed over"], r["waypoints"])),
            ("20 s: waypoints refused as `past`", lambda r: f"{r['refused as past']}"),
            ("20 s: waypoints refused for other reasons", lambda r: f"{r['refused for other reasons']}"),
            ("20 s: times that the stream starved (`underruns`)", lambda r: f"{r['starvations']}"),
            ("20 s: time holding, outside silences and deaths",
             lambda r: f"{r['holding outside the pauses [%]']:.2f} %")))


def end_table_of(rows):
    """The measured numbers of an end."""
    return table_with(rows, (
            ("`end` of `info`", lambda r: f"`{r['end']}`"),
            ("finish, before the time of the last waypoint",
             lambda r: f"{END - r['finish at [s]']:.2f} s".replace("-", "−")),
            ("at rest, after the time of the last waypoint",
             lambda r: f"{r['rest after the last waypoint [s]']:.3f} s"),
            ("at rest, from the last waypoint", lambda r: mrad(round(r["rest from the last waypoint [rad]"], 9))),
            ("peak velocity", lambda r: f"{r['peak velocity [rad/s]']:.2f} rad/s"),
            ("peak acceleration", lambda r: f"{r['peak acceleration [rad/s2]']:.2f} rad/s²")))


def with_tables(path, tables):
    """The text of a page with each table between the marks with its name."""
    text = path.read_text(encoding="utf-8")
    for name, table in tables.items():
        begin, end = f"<!-- measured: {name} -->\n", "\n<!-- end -->"
        if begin not in text:
            sys.exit(f"{path}: missing mark for the table of {name}")
        head, rest = text.split(begin, 1)
        text = head + begin + "\n" + table + "\n" + end + rest.split(end, 1)[1]
    return text


def tables_of_faults(rows):
    """A table for each section, from rows.json."""
    sections = dict.fromkeys(row["section"] for row in rows)
    return {section: (end_table_of if section.startswith("ends/") else table_of)(
        [row for row in rows if row["section"] == section]) for section in sections}


def tables_of_tails():
    """A table for each source of waypoints, from stops.json: a row per quantity, a column per curve."""
    measured = json.loads(STOPS.read_text(encoding="utf-8"))["measured"]
    sources = {}
    for name, text in measured.items():
        source, curve = name.split("; ")
        quantities = dict(part.split(": ") for part in text.split("; "))
        sources.setdefault(source, {})[curve.removeprefix("c2, ")] = quantities
    order = ["bessel", "parabolic", "natural", "clamped", "smoothing, lambda 5e-7 s3"]
    tables = {}
    for source, curves in sources.items():
        lines = ["| | " + " | ".join(f"`{curve.split(',')[0]}`" for curve in order) + " |",
                 "|---" * (len(order) + 1) + "|"]
        for quantity, text in max(curves.values(), key=len).items():
            unit = text.split(" ")[1].replace("/s2", "/s²").replace("/s3", "/s³")
            cells = [curves[curve].get(quantity, "none").split(" ")[0] for curve in order]
            name = quantity.replace("|", r"\|")
            lines.append(f"| {name} [{unit}] | " + " | ".join(cells) + " |")
        tables[source] = "\n".join(lines)
    return tables


def drawn():
    """The plots of faults and ends."""
    return [*PLOTS.glob("*.svg"), *PLOTS.glob("ends/*.svg")]


def make(folder):
    rows = json.loads((folder / "rows.json").read_text(encoding="utf-8"))
    (PLOTS / "ends").mkdir(parents=True, exist_ok=True)
    for old in drawn():
        old.unlink()
    for row in rows:
        svg = draw(row, *read_trace(folder / f"{row['file']}.csv"))
        (PLOTS / f"{row['file']}.svg").write_text(svg, encoding="utf-8")
    PAGE.write_text(with_tables(PAGE, tables_of_faults(rows)), encoding="utf-8")
    TAILS.write_text(with_tables(TAILS, tables_of_tails()), encoding="utf-8")


def check(program):
    page = PAGE.read_text(encoding="utf-8")
    words = " ".join(page.split())
    shown = set(re.findall(r"\(plots/([^)]+\.svg)\)", page))
    there = {str(path.relative_to(PLOTS)) for path in drawn()}
    problems = [f"missing plot {name}" for name in sorted(shown - there)]
    problems += [f"the page does not show {name}" for name in sorted(there - shown)]
    listed = subprocess.run([program, "motions", "--list"], check=True, capture_output=True,
                            text=True).stdout
    for line in listed.splitlines():
        name, fault = line.split("\t")
        if fault not in words:
            problems.append(f"the page does not name “{fault}”")
        problems += [f"the page does not show {plot}"
                     for plot in (f"{name}_limit.svg", f"{name}_no_limit.svg")
                     if name and plot not in shown]
    if with_tables(TAILS, tables_of_tails()) != TAILS.read_text(encoding="utf-8"):
        problems.append(f"{TAILS.name}: the tables are not those of {STOPS.name}: ./run plots writes them")
    if problems:
        sys.exit("\n".join(problems))


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "--check":
        check(arguments[1])
    elif len(arguments) == 1 and not arguments[0].startswith("-"):
        make(Path(arguments[0]))
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
