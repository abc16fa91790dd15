#!/usr/bin/env python3
"""Reports a run of ctest: lists failed and skipped tests and counts all.

    report_tests.py JUNIT.xml LIST

LIST has a line `PATTERN | MESSAGE | REASON` for each reason to skip: a test whose name matches PATTERN
may be skipped if its message contains MESSAGE. Exits with 1 if a test failed, if a skipped test is not
on the list, or if no test ran. The last line is `N passed, N failed, N skipped`.
"""

import fnmatch
import os
import re
import sys
import xml.etree.ElementTree as ElementTree


def read_list(path):
    """The lines of the list as (pattern, message, reason)."""
    lines = []
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            if not line.strip() or line.startswith("#"):
                continue
            fields = [field.strip() for field in line.split(" | ")]
            if len(fields) != 3 or not all(fields):
                raise SystemExit(f"{path}:{number}: not PATTERN | MESSAGE | REASON: {line.strip()}")
            lines.append(fields)
    return lines


def message_of(case):
    """Message of a skipped test: GoogleTest's text, or the last line of another program."""
    output = case.findtext("system-out") or ""
    said = re.search(r": Skipped\n(.*?)(?:\n\n|\n\[|\Z)", output, re.DOTALL)
    if said:
        return " ".join(said.group(1).split())
    lines = [line for line in output.splitlines() if line.strip()]
    return lines[-1].strip() if lines else ""


def judge(case):
    """`passed`, `failed` or `skipped`. A test that ctest could not start and calls skipped is `failed`."""
    skipped = case.find("skipped")
    if skipped is not None or case.get("status") == "disabled":
        was_told = skipped is not None and skipped.get("message", "").startswith("SKIP_")
        return "skipped" if was_told or case.get("status") == "disabled" else "failed"
    return "passed" if case.get("status") == "run" and case.find("failure") is None else "failed"


def main():
    """Prints the report."""
    junit, path = sys.argv[1:]
    allowed = read_list(path)
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    unlisted = 0
    root = ElementTree.parse(junit).getroot() if os.path.exists(junit) else ()
    for case in root.iter("testcase") if len(root) else ():
        outcome = judge(case)
        counts[outcome] += 1
        name = case.get("name")
        if outcome == "failed":
            print(f"failed: {name}")
        if outcome != "skipped":
            continue
        message = message_of(case)
        reasons = [reason for pattern, text, reason in allowed
                   if fnmatch.fnmatchcase(name, pattern) and text in message]
        if not reasons:
            unlisted += 1
        print(f"skipped: {name}: {message or 'no message'}"
              f" ({reasons[0] if reasons else 'NOT ON THE LIST ' + path})")
    if sum(counts.values()) == 0:
        print("no test ran")
    print(", ".join(f"{count} {what}" for what, count in counts.items()))
    return 1 if counts["failed"] or unlisted or sum(counts.values()) == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
