#!/usr/bin/env python3
"""Makes a man page of each page of docs/verbs, with pandoc.

    man.py VERSION OUT      writes OUT/splinecast.1 and OUT/splinecast-VERB.1
"""

import re
import subprocess
import sys
from pathlib import Path

VERBS = Path(__file__).resolve().parent.parent / "verbs"


def prepared(page):
    """The Markdown of a man page: a section NAME from the title, links as their text, no comments."""
    text = re.sub(r"^<!--.*?-->\n+", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
    text = re.sub(r"!?\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\((?!http)([^()\s]+)\)", r"\1", text)
    title, summary, rest = re.match(r"# ([^\n]+)\n\n(.*?)\n\n(.*)", text, re.S).groups()
    name = title.replace(" ", "-") if page.stem != "index" else "splinecast"
    summary = summary.replace("\n", " ").rstrip(".") if page.stem != "index" else "online cubic splines over shared memory"
    rest = re.sub(r"^#(#+ .*)$", lambda m: m.group(1).upper() if m.group(1).startswith("# ") else m.group(1), rest,
                  flags=re.M)
    return name, f"# NAME\n\n{name} - {summary}\n\n{rest}"


def main():
    """Writes all man pages."""
    version, out = sys.argv[1], Path(sys.argv[2])
    out.mkdir(parents=True, exist_ok=True)
    for page in sorted(VERBS.glob("*.md")):
        name, text = prepared(page)
        made = subprocess.run(["pandoc", "-s", "-f", "gfm", "-t", "man", "-M", f"title={name.upper()}", "-M", "section=1",
                               "-M", f"footer=splinecast {version}", "-M", "header=splinecast"],
                              input=text, text=True, check=True, stdout=subprocess.PIPE).stdout
        # Another process may read the page of an earlier build.
        partial = out / f".{name}.1"
        partial.write_text(made, encoding="utf-8")
        partial.rename(out / f"{name}.1")
    return 0


if __name__ == "__main__":
    sys.exit(main())
