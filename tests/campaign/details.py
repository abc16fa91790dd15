"""The page docs/verification-details.md: each attack with its counters, measurements and run. page.py writes it."""

import re
import textwrap

WIDTH = 120  # of a line
BUGS = "Bugs that the attacks found"
CHANGES = "Requests of a rate, before and after"
MEASURED = """`tests/campaign/measure_requests.py` measures the values of the last column, beside other work. Rows with
more than 1,000 requests are of the campaigns `requests`, and two rows are of the tests that they name."""

HEAD = """# Attacks in detail

This page describes each attack of [Verification]({overview}): what it does, its counters of violations, what it
measured, and how it ran. It is for developers who repeat an attack or compare its numbers.

All numbers are from the run whose date, version and machine are given. Names of quantities:

- *passed over*: share of the waypoints that entries pass over
- *holding*: share of the samples with the status `holding`, without those during pauses and deaths
- *peak*: largest absolute value that a reader sees
- *path error*: distance from the motion that the producer sends, from 2 s on
"""


def heading_of(result):
    """The short name of an attack, as a heading."""
    name = result["attack"].split(": ", 1)[0]
    return name[0].upper() + name[1:]


def slug(heading):
    """The anchor of a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def anchor_of(result):
    return slug(heading_of(result))


def description_of(result):
    text = result["attack"].split(": ", 1)[1]
    first = text.split()[0]
    return (text[0].upper() + text[1:] if first.isalpha() and first.islower() else text) + "."


def promises_of(result):
    return result["promise"] if isinstance(result["promise"], list) else [result["promise"]]


def number_text(value):
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:,.0f}"


def duration(seconds):
    if seconds < 120:
        return f"{seconds:.0f} s" if seconds >= 10 else f"{seconds:.1f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def machine_text(machine):
    return f"{machine['cpu']}, {machine['cores']} cores, {machine['kernel']}"


def wrapped(text, first="", then=""):
    """The text in lines of at most WIDTH; code spans and links stay in one line."""
    glued = re.sub(r"`[^`]*`|\[[^\]]*\]\([^)]*\)", lambda m: m.group(0).replace(" ", "\0"), text)
    return textwrap.fill(glued, WIDTH, initial_indent=first, subsequent_indent=then, break_long_words=False,
                         break_on_hyphens=False).replace("\0", " ")


def item(text):
    return wrapped(text, "- ", "  ")


def cell(value):
    text = value if isinstance(value, str) else number_text(value)
    return re.sub(r"(/s)([23])\b", lambda m: m[1] + "²³"[int(m[2]) - 2], text).replace("|", r"\|")


def natural(name):
    """A key that sorts the numbers within names by value."""
    return [(0, float(part), "") if re.match(r"\d", part) else (1, 0.0, part)
            for part in re.findall(r"\d+(?:\.\d+)?|\D+", name)]


def in_order(names):
    """Alphabetical names with their numbers sorted by value; other names as they are."""
    names = list(names)
    return sorted(names, key=natural) if names == sorted(names) else names


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return lines + ["| " + " | ".join(map(cell, row)) + " |" for row in rows] + [""]


def quantities_of(value):
    """The quantities of a text "name: value; name: value"; None for any other value."""
    parts = value.split("; ") if isinstance(value, str) else [""]
    return dict(part.split(": ", 1) for part in parts) if all(": " in part for part in parts) else None


def variants_table(variants):
    """Tables with a row for each quantity and a column for each variant; several if one would be too wide."""
    quantities = max((list(values) for values in variants.values()), key=len)
    quantities = dict.fromkeys([*quantities, *(name for values in variants.values() for name in values)])
    names = list(variants)
    for columns in range(len(names), 0, -1):
        lines = []
        for begin in range(0, len(names), columns):
            part = names[begin:begin + columns]
            lines += table(["", *map(cell, part)],
                           [[name] + [variants[variant].get(name, "") for variant in part] for name in quantities])
        if all(len(line) <= WIDTH for line in lines):
            break
    return lines


def run_tables(measured):
    """The tables of each run of which several quantities were measured."""
    runs = {}
    for name in in_order(name for name, value in measured.items() if quantities_of(value)):
        run, _, variant = name.rpartition("; ")
        runs.setdefault(run, {})[variant] = quantities_of(measured[name])
    return [line for run, variants in runs.items() for line in [f"**{run}**", "", *variants_table(variants)]]


def section(result, overview, promise_anchors):
    build = [item(f"build: {result['build']}")] if "build" in result else []
    links = ", ".join(f"[{number}]({overview}#{promise_anchors[number - 1]})" for number in promises_of(result))
    single = {name: value for name, value in result["measured"].items() if not quantities_of(value)}
    lines = [f"## {heading_of(result)}", "", wrapped(description_of(result)), "",
             item(f"promises: {links}"),
             item(f"count: {number_text(result['count'])} {result['unit']}"),
             item(f"command: `{result['command']}`"),
             item(f"duration: {duration(result['seconds'])}"),
             item(f"date: {result['date']}"),
             item(f"version: {result['version']}"), *build,
             item(f"machine: {machine_text(result['machine'])}"), ""]
    lines += table(["violation", "count"], [(name, result["found"][name]) for name in in_order(result["found"])])
    if single:
        lines += table(["measurement", "value"], [(name, single[name]) for name in in_order(single)])
    return lines + run_tables(result["measured"])


def bug_lines(bugs):
    lines = []
    for number, bug in enumerate(bugs, 1):
        begin = f"{number}. "
        indent = " " * len(begin)
        lines.append(wrapped(bug["what"], begin, indent))
        lines.append(wrapped(f"Found by: {bug['found_by']}.", indent + "- ", indent + "  "))
        lines.append(wrapped(f"Correction: {bug['correction']}", indent + "- ", indent + "  "))
    return lines or ["None so far."]


def page(results, bugs, changes, overview, promise_anchors):
    lines = [HEAD.format(overview=overview)]
    for result in results:
        lines += section(result, overview, promise_anchors)
    rows = [(change["fault"], change["before"], change["after"]) for change in changes]
    lines += [f"## {BUGS}", "", *bug_lines(bugs), ""]
    lines += [f"## {CHANGES}", "", wrapped(MEASURED.replace("\n", " ")), "", *table(["fault", "before", "after"], rows)]
    return "\n".join(lines).rstrip("\n") + "\n"
