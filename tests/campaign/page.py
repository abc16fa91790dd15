#!/usr/bin/env python3
"""Makes tests/README.md from the results of the campaigns.

    page.py            writes the page
    page.py --check    exits with 1 if the page is not up to date with the results
    page.py --machine  prints the JSON object `machine` of a result, for this machine

Each file tests/campaign/results/*.json holds one result or a list of results. A result is an object:

    promise   number of the attacked promise, its row in the table "What it promises" of the README,
              counted from 1; or a list of such numbers
    attack    description of the attack, a phrase for a table
    count     number of attacks, an integer from 1
    unit      unit of `count`, in the plural: "kills", "inputs", "samples"
    found     object of counters of violations: name ("torn reads") and integer; 0: the promise held
    measured  object of other measurements: name with unit ("recovery p50 [ms]") and number or text;
              may be empty
    machine   object of cpu (text), cores (number) and kernel (text), as printed by --machine
    seconds   duration of the attack, a number
    command   command that repeats the attack, for the project's top folder
    version   version of splinecast
    build     commit, compiler and flags, a text; optional

tests/campaign/bugs.json holds a list of the bugs that attacks have found. Each is an object of texts:
what (the bug), found_by (the attack), mended (the correction).
"""

import json
import os
import platform
import re
import sys
from pathlib import Path

CAMPAIGN = Path(__file__).resolve().parent
PROJECT = CAMPAIGN.parent.parent
PAGE = CAMPAIGN.parent / "README.md"

HEAD = """# The promises under attack

For each promise of the [README](../README.md#what-it-promises): the attacks on it, their number and their findings.
`./run campaign` runs the attacks, which write [`campaign/results`](campaign/results), and makes this page from them.
[`campaign/page.py`](campaign/page.py) describes the schema of the results. `./run test` runs shorter attacks.

The numbers under *found* count violations: 0 means that the promise held each time.
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
        "attack": is_text,
        "count": lambda v: is_count(v) and v > 0,
        "unit": is_text,
        "found": lambda v: v != {} and is_table_of(is_count, v),
        "measured": lambda v: is_table_of(lambda x: is_number(x) or is_text(x), v),
        "machine": is_machine,
        "seconds": lambda v: is_number(v) and v >= 0,
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
    """The sentences of the README's table of promises, in order."""
    text = (PROJECT / "README.md").read_text(encoding="utf-8")
    table = text.split("\n## What it promises\n", 1)[1].split("\n## ", 1)[0]
    rows = [line for line in table.splitlines() if line.startswith("| ")]
    return [re.split(r"(?<!\\)\|", row)[1].strip() for row in rows[1:]]


def read_results(promises):
    results = []
    for path in sorted((CAMPAIGN / "results").glob("*.json")):
        content = json.loads(path.read_text(encoding="utf-8"))
        for result in content if isinstance(content, list) else [content]:
            wrong = faults(result, promises)
            if wrong:
                sys.exit(f"{path}: {', '.join(wrong)}: does not match the schema in page.py")
            results.append(result)
    return results


def read_bugs():
    path = CAMPAIGN / "bugs.json"
    bugs = json.loads(path.read_text(encoding="utf-8"))
    for bug in bugs:
        if bug.keys() != {"what", "found_by", "mended"} or not all(map(is_text, bug.values())):
            sys.exit(f"{path}: a bug needs the texts what, found_by and mended")
    return bugs


def to_text(value):
    if isinstance(value, int):
        return f"{value:,}"
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 1000 else f"{value:,.0f}"
    return value


def cell(text):
    return text.replace("|", r"\|").replace("\n", " ")


def counters(table):
    return ", ".join(f"{cell(name)} {cell(to_text(value))}" for name, value in table.items())


def duration(seconds):
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"


def machine_text(machine):
    return f"{machine['cpu']}, {machine['cores']} cores, {machine['kernel']}"


def attack_rows(results, machines):
    lines = ["| attack | count | found | measured | run |", "|---|---|---|---|---|"]
    for result in results:
        machine = machines.index(machine_text(result["machine"])) + 1
        build = f", build {cell(result['build'])}" if "build" in result else ""
        lines.append(
            f"| {cell(result['attack'])} | {to_text(result['count'])} {cell(result['unit'])} "
            f"| {counters(result['found'])} | {counters(result['measured'])} "
            f"| `{cell(result['command'])}`: {duration(result['seconds'])} on machine {machine}, "
            f"version {cell(result['version'])}{build} |")
    return lines


def bug_rows(bugs):
    if not bugs:
        return ["None so far."]
    return ["| bug | found by | correction |", "|---|---|---|"] + [
        f"| {cell(bug['what'])} | {cell(bug['found_by'])} | {cell(bug['mended'])} |" for bug in bugs]


def make_page():
    promises = read_promises()
    results = read_results(len(promises))
    machines = sorted({machine_text(result["machine"]) for result in results})
    lines = [HEAD]
    for number, promise in enumerate(promises, 1):
        lines += [f"## Promise {number}", "", promise, ""]
        attacks = [r for r in results
                   if number in (r["promise"] if isinstance(r["promise"], list) else [r["promise"]])]
        lines += attack_rows(attacks, machines) if attacks else [
            "No campaign attacks this promise. The README names its tests."]
        lines.append("")
    if machines:
        lines += ["## Machines", ""]
        lines += [f"{i}. {machine}" for i, machine in enumerate(machines, 1)] + [""]
    lines += ["## Bugs that the attacks found", ""] + bug_rows(read_bugs())
    return "\n".join(lines) + "\n"


def this_machine():
    with open("/proc/cpuinfo", encoding="utf-8") as info:
        models = [line.split(":", 1)[1].strip() for line in info if line.startswith("model name")]
    return {"cpu": models[0] if models else platform.machine(), "cores": os.cpu_count(),
            "kernel": f"{platform.system()} {platform.release()}"}


def main(arguments):
    if arguments == ["--machine"]:
        print(json.dumps(this_machine()))
    elif arguments == ["--check"]:
        if PAGE.read_text(encoding="utf-8") != make_page():
            sys.exit(f"{PAGE} is not up to date with the results: run {Path(__file__).name}")
    elif not arguments:
        PAGE.write_text(make_page(), encoding="utf-8")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
