#!/usr/bin/env python3
"""Checks the pages of the manual.

    pages.py commands [--write] BIN PAGE...   runs each page's commands and compares their output; BIN has splinecast
    pages.py links                            follows every link of every page
    pages.py code                             every C, C++ or Python block is part of an example
    pages.py shape                            lines of the README, width of tables, pages that no page links to
    pages.py beat FILE COMMAND...             runs a command, and writes the longest delay of a process beside it to FILE

A page's commands are the lines of its `console` blocks that begin with `$ `, and comments `<!-- run: COMMAND -->`. They
run from top to bottom in one shell, in an empty folder, with a private /dev/shm. The lines between two commands are the
first one's output; without such lines its output is not compared. A line `...` matches any lines, `...` in a line
any characters. Words after `console`: `varies`: numbers and the units of durations are not compared; `exit=N`: the exit
code, 0 without it. Durations and numbers of streams are shortened. --write writes the output of commands into the page,
except where the page has a `...`. Commands find this project's root in $SPLINECAST_SOURCE, the Python module beside
BIN, and Debian's python3. A page with a failure is run again, up to TRIES times, if meanwhile the machine delayed a
sleeping process by more than DELAY. Exits with 77 if a private /dev/shm is not allowed.
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import blocks

sys.path.insert(0, str(blocks.PROJECT / "tests" / "runner"))
import shared_memory  # pylint: disable=wrong-import-position

BOUND = 600  # seconds, for each command: too long for any busy machine
DELAY = 0.1  # seconds
TRIES = 20
README_LINES = 150
TABLE_WIDTH = 120
SHORTER = [(r"--duration \d+\b", "--duration 0.5"), (r"--seconds \d+", "--seconds 2"), (r"--streams \d+\b", "--streams 3")]
# A machine under load delays the first rows by more than the lead that the file needs.
LIVE_REPLAY = re.compile(r"splinecast replay moves\.csv --stream \S+")
# Commands whose exit code depends on the machine, and the codes allowed in addition to the stated one.
MACHINE = [("splinecast doctor", {0, 1}), ("splinecast latency compare", {0, 2, 3}), ("--mode spin", {0, 2})]
# The examples in which a block of this language must be.
EXAMPLES = {"c": "*.c", "cpp": "*.cpp", "c++": "*.cpp", "python": "python/*.py"}
NUMBER = re.compile(r"[-+]?\d+(?:[.,:]\d+)*(?:e[-+]?\d+)?(?: ?(?:ns|µs|us|ms|s)\b)?")


def machine_of(program):
    """MACHINE, and what the build of the program adds: ThreadSanitizer's memory grows, which `soak` reports."""
    with open(program, "rb") as file:
        return MACHINE + ([("splinecast soak", {1})] if b"__tsan_init" in file.read() else [])


def shortened(text):
    """The command with short durations and few streams."""
    for pattern, shorter in SHORTER:
        text = re.sub(pattern, shorter, text)
    return text


def script(found):
    """A shell script that marks where each command's output begins and ends, and its exit code."""
    text = "exec 2>&1\n"
    for number, command in enumerate(found):
        line = shortened(command.text)
        if LIVE_REPLAY.fullmatch(line) and not command.output:
            line += " --lead 2000"
        if line.endswith("&"):
            text += f"{line[:-1]} &\n" if ">" in line else f"{line[:-1]} >>.background 2>&1 &\n"
        else:
            text += f"printf '\\036BEGIN {number}\\n'\n{line}\nprintf '\\036END {number} %d\\n' $?\n"
    return text


def beat(report, command):
    """Runs a command. Writes the longest delay [s] of this process, which sleeps for 10 ms at a time, to a file."""
    most, before = 0.0, time.monotonic()
    with subprocess.Popen(command) as running:
        while running.poll() is None:
            time.sleep(0.01)
            now = time.monotonic()
            if now - before - 0.01 > most:
                most = now - before - 0.01
                Path(report).write_text(str(most), encoding="utf-8")
            before = now
    return running.returncode


def beside_a_beat(report, command):
    """The arguments that run a command as `beat` does."""
    return [sys.executable, "-B", str(Path(__file__).resolve()), "beat", str(report), *command]


def until_not_delayed(check):
    """Repeats a check that fails on a delayed machine. The check returns its failures and the longest delay [s]."""
    for attempt in range(1, TRIES + 1):
        wrong, delay = check()
        if not wrong or delay <= DELAY or attempt == TRIES:
            return wrong
        print(f"again: a process was delayed by {delay:.3f} s", flush=True)


def wait_while_it_continues(process, output):
    """Waits until the process ends, or until no command has ended for BOUND seconds."""
    ended, end = 0, time.monotonic() + BOUND
    while process.poll() is None and time.monotonic() < end:
        time.sleep(0.02)
        now = Path(output).read_bytes().count(b"\036END ")
        if now > ended:
            ended, end = now, time.monotonic() + BOUND


def run(found, programs):
    """What the script of these commands prints, and the longest delay of a process beside it [s]."""
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"PATH": os.pathsep.join([programs, "/usr/bin", os.environ["PATH"]]), "HOME": folder,
                                    "XDG_RUNTIME_DIR": folder,  # sockets of recorders, by their names
                                    "PYTHONPATH": os.path.join(os.path.dirname(programs), "python"),
                                    "SPLINECAST_SOURCE": str(blocks.PROJECT), "TERM": "dumb", "LC_ALL": "C.UTF-8"}
        Path(folder, ".script").write_text(script(found), encoding="utf-8")
        with open(os.path.join(folder, ".out"), "wb") as out:
            started = subprocess.Popen(beside_a_beat(os.path.join(folder, ".delay"), shared_memory.in_own(["bash", ".script"])),
                                       cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=out,
                                       start_new_session=True)
            wait_while_it_continues(started, out.name)
            try:
                os.killpg(started.pid, 9)  # commands that hang or still run in the background
            except ProcessLookupError:
                pass
            started.wait()
        return Path(folder, ".out").read_text(encoding="utf-8", errors="replace"), delay_of(Path(folder, ".delay"))


def delay_of(report):
    return float(report.read_text(encoding="utf-8") or 0) if report.exists() else 0.0


def comparable(line, varies):
    """A line of output as it is compared: if it varies, lists of numbers become one number, with or without signs."""
    if not varies:
        return line.rstrip()
    return re.sub(r"0(?:,0)+", "0", " ".join(NUMBER.sub("0", line).split()))


def pattern_of(lines, varies):
    """A regular expression for output as a page shows it."""
    parts = []
    for line in lines:
        if line.strip() == "...":
            parts.append(r"(?:.*\n)*?")
            continue
        parts.append(re.escape(comparable(line, varies)).replace(r"\.\.\.", ".*") + r"\n")
    return "".join(parts)


def is_shown(printed, command):
    """Whether the output that a page shows is the printed one."""
    lines = [comparable(line, command.varies) + "\n" for line in printed.splitlines()]
    return re.fullmatch(pattern_of(command.output, command.varies), "".join(lines)) is not None


def judge(command, printed, code, machine):
    """What is wrong with a command's run, or None."""
    if code is None:
        return "does not end"
    allowed = {command.exit_code}.union(*(codes for text, codes in machine if text in command.text))
    if code not in allowed:
        return f"exit code {code}, expected {command.exit_code}"
    if command.output and not is_shown(printed, command):
        return "the page shows other output"
    return None


def write_output(page, ran):
    """Writes what the commands have printed into the page."""
    lines = page.read_text(encoding="utf-8").splitlines()
    for command, printed in reversed(ran):
        if command.output and "..." not in "\n".join(command.output):
            begin = command.last - 1 - len(command.output)
            lines[begin:command.last - 1] = [line.rstrip() for line in printed.splitlines()]
    page.write_text("\n".join(lines) + "\n", encoding="utf-8")


def check_commands(page, programs, is_writing):
    """Runs a page's commands; returns the number of those that fail, and the longest delay of a process [s]."""
    found = blocks.commands(page)
    if not found:
        return 0, 0.0
    said, delay = run(found, programs)
    machine = machine_of(os.path.join(programs, "splinecast"))
    wrong, ran = 0, []
    for number, command in enumerate(found):
        if command.text.endswith("&"):
            continue
        match = re.search(rf"\036BEGIN {number}\n(.*?)\036END {number} (\d+)\n", said, re.S)
        printed, code = (match.group(1), int(match.group(2))) if match else ("", None)
        problem = judge(command, printed, code, machine)
        if match and is_writing and problem == "the page shows other output":
            problem = "the page shows other output, and has `...`" if "..." in "\n".join(command.output) else None
        ran.append((command, printed if match else "\n".join(command.output)))
        if problem:
            wrong += 1
            print(f"{page.relative_to(blocks.PROJECT)}:{command.line}: {problem}: {command.text}\n{printed}")
    if is_writing:
        write_output(page, ran)
    print(f"{page.relative_to(blocks.PROJECT)}: {len(found)} commands, {wrong} failed")
    return wrong, delay


def check_all_commands(arguments):
    """Runs the commands of the pages that are named."""
    is_writing = arguments[:1] == ["--write"]
    programs, *named = arguments[is_writing:]
    if not shared_memory.is_allowed():
        print("needs a mount namespace of its own (root, or user namespaces)")
        return 77
    programs = os.path.abspath(programs)
    wrong = [until_not_delayed(lambda: check_commands(page, programs, is_writing)) for page in map(Path.resolve, map(Path, named))]
    return 1 if sum(wrong) else 0


def check_links(_):
    """Every relative link leads to a file, and to a heading if it names one."""
    wrong = 0
    for page in blocks.pages():
        for line, target in blocks.links(page):
            name, _, anchor = target.partition("#")
            file = (page.parent / name).resolve() if name else page
            problem = None
            if re.match(r"[a-z]+:", target):
                problem = "leads out of the project, where no test can follow it"
            elif not file.exists():
                problem = "there is no such file"
            elif anchor and (file.suffix != ".md" or anchor not in blocks.anchors(file)):
                problem = "there is no such heading"
            if problem:
                wrong += 1
                print(f"{page.relative_to(blocks.PROJECT)}:{line}: {target}: {problem}")
    return 1 if wrong else 0


def check_code(_):
    """Every C, C++ or Python block of a page is part of an example, which tests build and run."""
    def dense(lines):
        return "\n".join(line.strip() for line in lines).strip()
    examples = {language: [dense(file.read_text(encoding="utf-8").splitlines())
                           for file in (blocks.PROJECT / "examples").glob(pattern)]
                for language, pattern in EXAMPLES.items()}
    wrong, count = 0, 0
    for page in blocks.pages():
        for block in blocks.blocks(page.read_text(encoding="utf-8").splitlines()):
            if block.language not in examples:
                continue
            count += 1
            if not any(dense(block.lines) in example for example in examples[block.language]):
                wrong += 1
                print(f"{page.relative_to(blocks.PROJECT)}:{block.first}: no example contains this block")
    print(f"{count} blocks")
    return 1 if wrong or not count else 0


def check_shape(_):
    """The README's length, the width of tables, and that a reader can reach each page of docs."""
    problems = []
    length = len((blocks.PROJECT / "README.md").read_text(encoding="utf-8").splitlines())
    if length > README_LINES:
        problems.append(f"README.md has {length} lines, more than {README_LINES}")
    reached = set()
    for page in blocks.pages():
        name = page.relative_to(blocks.PROJECT)
        reached |= {(page.parent / target.partition("#")[0]).resolve() for _, target in blocks.links(page)}
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            width = len(re.sub(r"\]\([^()]*\)", "]", line))  # as shown: without the targets of links
            if line.lstrip().startswith("|") and width > TABLE_WIDTH:
                problems.append(f"{name}:{number}: a row of a table has {width} characters, more than {TABLE_WIDTH}")
    for page in sorted((blocks.PROJECT / "docs").rglob("*.md")):
        if page not in reached:
            problems.append(f"{page.relative_to(blocks.PROJECT)}: no page links to it")
    print("\n".join(problems))
    return 1 if problems else 0


def main():
    """Runs one check."""
    if sys.argv[1:2] == ["beat"]:
        return beat(sys.argv[2], sys.argv[3:])
    checks = {"commands": check_all_commands, "links": check_links, "code": check_code, "shape": check_shape}
    if len(sys.argv) < 2 or sys.argv[1] not in checks:
        print(__doc__)
        return 2
    return checks[sys.argv[1]](sys.argv[2:])


if __name__ == "__main__":
    sys.exit(main())
