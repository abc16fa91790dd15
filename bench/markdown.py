"""Texts of the pages: numbers, tables and lines of limited width."""

import re
import textwrap

WIDTH = 120  # maximum length of a line


def number(x):
    if x >= 1000 or x == 0:
        return f"{x:,.0f}"
    return f"{x:.0f}" if x >= 100 else f"{x:.1f}" if x >= 10 else f"{x:.2f}"


def median_of(values, size=1):
    """The median of a list of summarize.py, in units of `size`."""
    return number(values[0] / size)


def range_of(values, size=1):
    return f"{number(values[1] / size)} – {number(values[2] / size)}"


def natural(name):
    """A key for sorting names: numbers within a name sort by value."""
    return [(0, int(part), "") if part.isdigit() else (1, 0, part) for part in re.findall(r"\d+|\D+", name)]


def wrapped(text, first="", then=""):
    """The text in lines of at most WIDTH; code spans and links stay in one line."""
    glued = re.sub(r"`[^`]*`|\[[^\]]*\]\([^)]*\)", lambda m: m.group(0).replace(" ", "\0"), text)
    return textwrap.fill(glued, WIDTH, initial_indent=first, subsequent_indent=then, break_long_words=False,
                         break_on_hyphens=False).replace("\0", " ")


def item(text):
    return wrapped(text, "- ", "  ")


def table(heads, rows):
    """The lines of a table and an empty line after it; no lines if there are no rows."""
    if not rows:
        return []
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return [*lines, *("| " + " | ".join(row) + " |" for row in rows), ""]
