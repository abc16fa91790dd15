#!/usr/bin/env python3
"""Writes the options of each verb into its page, from the verbs' table in the program.

    options.py [--check] BIN      BIN is the folder of splinecast; --check only compares

In docs/verbs/VERB.md, the list is between `<!-- options -->` and `<!-- end of options -->`.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

VERBS = Path(__file__).resolve().parent.parent / "verbs"
BEGIN, END = "<!-- options -->", "<!-- end of options -->"


def value_of(argument):
    """The name of an argument's value with a space before it, or nothing."""
    return f" {argument['value']}" if argument["value"] else ""


def item(argument):
    """The list item of an argument."""
    names = ", ".join(f"`{name}{value_of(argument)}`" for name in argument["names"])
    traits = [word for word, is_so in (("required", argument["required"] and not argument["positional"]),
                                       ("may be given several times", argument["list"])) if is_so]
    return f"- {names}{' (' + ', '.join(traits) + ')' if traits else ''}: {argument['help'].rstrip('.')}."


def options_of(command, path):
    """The lines of a command's arguments, and of those of its subcommands."""
    shown = [argument for argument in command["arguments"] if "--help" not in argument["names"]]
    lines = [item(argument) for argument in shown] or ["This verb has no options."]
    for inner in command["commands"]:
        lines += ["", f"`splinecast {path} {inner['name']}`:", "", *options_of(inner, f"{path} {inner['name']}")]
    return lines


def wrapped(line, width=118):
    """A list item in lines of at most this width; code is not broken."""
    words, lines = re.findall(r"(?:`[^`]*`|[^\s`])+", line), [""]
    for word in words:
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append("  " + word)
        else:
            lines[-1] += (" " if lines[-1] else "") + word
    return "\n".join(lines)


def page_with_options(text, verb):
    """The page with the present options. Also sets its summary, the paragraph below the title."""
    begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
    listed = "\n".join(wrapped(line) if line.startswith("- ") else line for line in options_of(verb, verb["name"]))
    text = f"{text[:begin]}\n\n{listed}\n\n{text[end:]}"
    summary = "\n".join(wrapped(verb["summary"] + ".").split("\n  "))
    return re.sub(r"\A(# [^\n]+\n\n).*?\n\n", lambda m: f"{m.group(1)}{summary}\n\n", text, flags=re.S)


def main():
    """Writes or compares the page of every verb."""
    is_check = sys.argv[1] == "--check"
    program = os.path.join(sys.argv[-1], "splinecast")
    table = json.loads(subprocess.run([program, "completion", "json"], check=True, capture_output=True).stdout)
    wrong = 0
    for verb in table["commands"]:
        page = VERBS / f"{verb['name']}.md"
        if not page.exists():
            print(f"there is no page {page}")
            wrong += 1
            continue
        before = page.read_text(encoding="utf-8")
        after = page_with_options(before, verb)
        if is_check and after != before:
            print(f"{page} does not have the present options: run docs/site/options.py {sys.argv[-1]}")
            wrong += 1
        elif after != before:
            page.write_text(after, encoding="utf-8")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
