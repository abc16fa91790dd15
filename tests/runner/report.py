"""Reports a run of ctest: lists failed and skipped tests and counts all."""

import dataclasses
import fnmatch
import os
import re
import xml.etree.ElementTree as ElementTree


@dataclasses.dataclass
class Case:
    """A test that has run. The message says why it was skipped or has failed."""
    name: str
    outcome: str  # passed, failed or skipped
    message: str


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


def read(junit):
    """The cases of ctest's file; none if there is no file."""
    if not os.path.exists(junit):
        return []
    cases = [(case, judge(case)) for case in ElementTree.parse(junit).getroot().iter("testcase")]
    return [Case(case.get("name"), outcome, message_of(case) if outcome == "skipped" else "")
            for case, outcome in cases]


def judge_end(code, cases):
    """A failed case if ctest has not run to its end: it was killed, or found no test. Else nothing."""
    tests_failed = 8
    if code in (0, tests_failed) and cases:
        return []
    return [Case("Runner.RunsToItsEnd", "failed", f"ctest ended with exit code {code} after {len(cases)} reported tests")]


def read_list(path):
    """The lines of a list of tests that may be skipped, as (pattern, message, reason)."""
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


def write(cases, path):
    """Prints the report. Returns 1 if a test failed, if a skipped one is not on the list, or if no test ran.

    The list has a line `PATTERN | MESSAGE | REASON` for each reason to skip: a test whose name matches PATTERN may be
    skipped if its message contains MESSAGE.
    """
    allowed = read_list(path)
    unlisted = 0
    for case in cases:
        if case.outcome == "failed":
            print(f"failed: {case.name}{': ' if case.message else ''}{case.message}")
        if case.outcome != "skipped":
            continue
        reasons = [reason for pattern, text, reason in allowed
                   if fnmatch.fnmatchcase(case.name, pattern) and text in case.message]
        unlisted += not reasons
        print(f"skipped: {case.name}: {case.message or 'no message'}"
              f" ({reasons[0] if reasons else f'NOT ON THE LIST {path}'})")
    counts = {outcome: sum(case.outcome == outcome for case in cases) for outcome in ("passed", "failed", "skipped")}
    if not cases:
        print("no test ran")
    print(", ".join(f"{count} {outcome}" for outcome, count in counts.items()))
    return 1 if counts["failed"] or unlisted or not cases else 0
