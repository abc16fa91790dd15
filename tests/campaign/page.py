#!/usr/bin/env -S python3 -B
"""Makes docs/verification.md and docs/verification-details.md from the results of the campaigns.

    page.py            writes the pages
    page.py --check    exits with 1 if a page is not up to date with the results
    page.py --machine  prints the JSON object `machine` of a result, for this machine

Each file tests/campaign/results/*.json holds one result or a list of results. A result is an object:

    promise   number of the attacked promise in docs/concepts.md; or a list of such numbers
    attack    short name of the attack, ": " and what it does: "random kills: SIGKILL at random instants"
    count     number of attacks, an integer from 1
    unit      unit of `count`, in the plural: "kills", "inputs", "samples"
    found     object of counters of violations: name ("torn reads") and integer; 0: the promise held
    measured  object of other measurements: name with unit ("time to new data [ms]") and number or text; may be
              empty. Several quantities of one run: name "run; variant" and text "quantity: value; quantity: value"
    machine   object of cpu (text), cores (number) and kernel (text), as printed by --machine
    seconds   duration of the attack, a number
    date      day of the attack in UTC, YYYY-MM-DD
    command   command that repeats the attack, for the project's top folder
    version   version of splinecast
    build     commit, compiler and flags, a text; optional

tests/campaign/bugs.json holds a list of the bugs that attacks have found. Each is an object of texts:
what (the bug), found_by (the attack), correction.

tests/campaign/before_after.json holds a list of faults with measurements before and after their correction. Each is an
object of texts: fault, before, after.
"""

import datetime
import json
import os
import platform
import re
import sys
from pathlib import Path

import details
from details import WIDTH, anchor_of, duration, heading_of, number_text, promises_of, slug, wrapped

CAMPAIGN = Path(__file__).resolve().parent
DOCS = CAMPAIGN.parent.parent / "docs"
PROMISES = DOCS / "concepts.md"
OVERVIEW = DOCS / "verification.md"
DETAILS = DOCS / "verification-details.md"

HEAD = f"""# Verification

This page says what tried to break each [promise](concepts.md#promises), how often, and what was found. It is for
readers who want to know how far they can rely on a promise.

- The column *violations* counts how often a promise was broken. 0 means that it held each time.
- [Attacks in detail]({DETAILS.name}) has every counter, measurement, command, machine and build.
- `./run campaign` repeats all attacks and writes this page. `./run test` runs shorter attacks.
- [Concepts](concepts.md#promises) names the tests of each promise.
- `./run defects` removes the correction of each [corrected defect](../tests/defects/README.md) and checks that its test
  fails.
- [Fuzzing](../tests/fuzz/README.md) describes the fuzzers and the flipped bytes.
- The [results](../tests/campaign/results) are stored as JSON. [page.py](../tests/campaign/page.py) describes their
  schema.
"""


def is_text(value):
    return isinstance(value, str) and value != ""


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_count(value):
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def is_promise(value, promises):
    numbers = value if isinstance(value, list) else [value]
    return numbers != [] and all(is_count(n) and 1 <= n <= promises for n in numbers)


def is_machine(value):
    return (isinstance(value, dict) and value.keys() == {"cpu", "cores", "kernel"}
            and is_text(value["cpu"]) and is_count(value["cores"]) and is_text(value["kernel"]))


def is_table_of(check, value):
    return isinstance(value, dict) and all(is_text(k) and check(v) for k, v in value.items())


def faults(result, promises):
    """The keys of a result that are missing, unknown or do not match the schema."""
    checks = {
        "promise": lambda v: is_promise(v, promises),
        "attack": lambda v: is_text(v) and re.match(r"[\w -]{1,24}: \S", v),
        "count": lambda v: is_count(v) and v > 0,
        "unit": is_text,
        "found": lambda v: v != {} and is_table_of(is_count, v),
        "measured": lambda v: is_table_of(lambda x: is_number(x) or is_text(x), v),
        "machine": is_machine,
        "seconds": lambda v: is_number(v) and v >= 0,
        "date": lambda v: is_text(v) and re.fullmatch(r"\d{4}-\d\d-\d\d", v),
        "command": is_text,
        "version": is_text,
    }
    may_be = {"build": is_text}
    if not isinstance(result, dict):
        return ["result"]
    wrong = [key for key, check in checks.items() if key not in result or not check(result[key])]
    wrong += [key for key, check in may_be.items() if key in result and not check(result[key])]
    return wrong + sorted(result.keys() - checks.keys() - may_be.keys())


def read_promises():
    """(title, first paragraph) of each promise, in order: headings "### 1. Title" in the section "Promises"."""
    text = PROMISES.read_text(encoding="utf-8")
    section = re.search(r"^## Promises\n(.*?)(?=^## |\Z)", text, re.S | re.M)
    parts = re.split(r"^### (\d+)\. (.*)\n", section[1] if section else "", flags=re.M)
    if len(parts) == 1 or parts[1::3] != [str(number) for number in range(1, len(parts) // 3 + 1)]:
        sys.exit(f"{PROMISES}: needs a section 'Promises' with headings '### 1. …', '### 2. …'")
    paragraphs = [body.strip().split("\n\n")[0] for body in parts[3::3]]
    return [(title, "" if text.startswith("- ") else " ".join(text.replace("](#", f"]({PROMISES.name}#").split()))
            for title, text in zip(parts[2::3], paragraphs)]


def read_results(promises):
    results = []
    for path in sorted((CAMPAIGN / "results").glob("*.json")):
        content = json.loads(path.read_text(encoding="utf-8"))
        for result in content if isinstance(content, list) else [content]:
            wrong = faults(result, promises)
            if wrong:
                sys.exit(f"{path}: {', '.join(wrong)}: does not match the schema in page.py")
            results.append(result)
    return sorted(results, key=heading_of)


def read_texts(name, keys):
    """The entries of a file; each has these texts and no other."""
    path = CAMPAIGN / name
    entries = json.loads(path.read_text(encoding="utf-8"))
    for i, entry in enumerate(entries):
        if entry.keys() != set(keys) or not all(map(is_text, entry.values())):
            sys.exit(f"{path}: entry {i} needs the texts {', '.join(keys)}")
    return entries


def violations(result):
    return sum(result["found"].values())


def promise_anchor(number, title):
    return slug(f"{number}. {title}")


def attack_rows(results):
    lines = ["| attack | count | violations | run |", "|---|---|---|---|"]
    for result in results:
        lines.append(f"| [{heading_of(result)}]({DETAILS.name}#{anchor_of(result)}) "
                     f"| {number_text(result['count'])} {result['unit']} "
                     f"| {number_text(violations(result))} "
                     f"| {duration(result['seconds'])}, {result['date']} |")
    return lines


def overview(promises, results, bugs):
    machines = sorted({details.machine_text(result["machine"]) for result in results})
    lines = [HEAD, "## Summary", "",
             f"- {len(results)} attacks",
             f"- violations: {number_text(sum(map(violations, results)))}",
             f"- [bugs found and corrected]({DETAILS.name}#{slug(details.BUGS)}): {len(bugs)}",
             f"- [{details.CHANGES}]({DETAILS.name}#{slug(details.CHANGES)})",
             *(f"- machine: {machine}" for machine in machines), ""]
    for number, (title, text) in enumerate(promises, 1):
        attacks = [result for result in results if number in promises_of(result)]
        more = f"[Meaning, exceptions, tests]({PROMISES.name}#{promise_anchor(number, title)})."
        lines += [f"## {number}. {title}", "", wrapped(f"{text} {more}".strip()), ""]
        lines += [*(attack_rows(attacks) if attacks else ["No campaign attacks this promise."]), ""]
    return "\n".join(lines)


def make_pages():
    """The text of each page by its path."""
    promises = read_promises()
    results = read_results(len(promises))
    bugs = read_texts("bugs.json", ("what", "found_by", "correction"))
    changes = read_texts("before_after.json", ("fault", "before", "after"))
    pages = {OVERVIEW: overview(promises, results, bugs).rstrip("\n") + "\n",
             DETAILS: details.page(results, bugs, changes, OVERVIEW.name,
                                   [promise_anchor(n, title) for n, (title, _) in enumerate(promises, 1)])}
    for path, text in pages.items():
        for number, line in enumerate(text.splitlines(), 1):
            if len(line) > WIDTH:
                sys.exit(f"{path}:{number}: would be longer than {WIDTH} characters: {line}")
    return pages


def this_machine():
    with open("/proc/cpuinfo", encoding="utf-8") as info:
        models = [line.split(":", 1)[1].strip() for line in info if line.startswith("model name")]
    return {"cpu": models[0] if models else platform.machine(), "cores": os.cpu_count(),
            "kernel": f"{platform.system()} {platform.release()}"}


def today():
    """The value `date` of a result that is made now."""
    return datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d")


def main(arguments):
    if arguments == ["--machine"]:
        print(json.dumps(this_machine()))
    elif arguments == ["--check"]:
        old = [path for path, text in make_pages().items()
               if not path.exists() or path.read_text(encoding="utf-8") != text]
        if old:
            sys.exit(f"not up to date with the results: {', '.join(map(str, old))}: run {Path(__file__).name}")
    elif not arguments:
        for path, text in make_pages().items():
            path.write_text(text, encoding="utf-8")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
