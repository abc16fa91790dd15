#!/usr/bin/env python3
"""Checks the man pages: one for each page of docs/verbs, with its commands, and formatted without a warning.

    man.py FOLDER      the man pages that the build has made; exits with 77 if they, or the program man, are missing
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import blocks


def formatted(page):
    """The text of a man page, and the warnings of its formatter."""
    ended = subprocess.run(["man", "--warnings=w", "-l", str(page)], check=True, capture_output=True, text=True,
                           env=os.environ | {"MANWIDTH": "200", "LC_ALL": "C.UTF-8", "MAN_KEEP_FORMATTING": "", "PAGER": "cat"})
    return ended.stdout, ended.stderr


def problems_of(source, page):
    """What is wrong with the man page of a page of docs/verbs."""
    if not page.exists():
        yield "there is no such man page"
        return
    text, warnings = formatted(page)
    # A terminal has no pages of paper, on which a long table might not fit.
    yield from (line for line in warnings.splitlines() if "will not fit on one page" not in line)
    dense = re.sub(r"\s+", "", text)
    for command in blocks.commands(source):
        is_hidden = source.read_text(encoding="utf-8").splitlines()[command.line - 1].startswith("<!--")
        if not is_hidden and re.sub(r"\s+", "", command.text) not in dense:
            yield f"lacks the command {command.text}"
    for section in ("NAME", "SYNOPSIS", "OPTIONS"):
        if source.stem != "index" and not re.search(rf"^{section}$", text, re.M):
            yield f"lacks the section {section}"


def main():
    """Checks every page."""
    folder = Path(sys.argv[1])
    if not folder.exists() or not shutil.which("man"):
        print("there are no man pages (Debian: pandoc, man-db)")
        return 77
    wrong = 0
    for source in sorted((blocks.PROJECT / "docs" / "verbs").glob("*.md")):
        name = "splinecast.1" if source.stem == "index" else f"splinecast-{source.stem}.1"
        for problem in problems_of(source, folder / name):
            wrong += 1
            print(f"{name}: {problem}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
