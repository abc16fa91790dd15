#!/usr/bin/env python3
"""Runs the tests of a build, which must be up to date.

    run.py BUILD [PATTERN]       the tests whose names match PATTERN; else all but those that build the project again
    run.py BUILD --rebuilds      the tests that build the project again, and the long forms of campaigns

Runs in its own /dev/shm where the kernel allows it, unless SPLINECAST_SHARED_MEMORY is `shared`. Lists failed and
skipped tests at the end; the last line is `N passed, N failed, N skipped`. A name that is left in shared memory counts
as a failed test. A test is killed, and fails, if its processes use no CPU time for ten minutes.
"""

import os
import signal
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import left
import report
import shared_memory

HERE = Path(__file__).resolve().parent
STALL = 600  # seconds
LOOK = 5  # seconds
AT_ONCE = "4"  # most tests wait for processes that wait
BACKSTOP = "7200"  # seconds, for a test that never ends
TICKS = os.sysconf("SC_CLK_TCK")


def enter_own_shared_memory():
    """Runs this program again with an empty /dev/shm, as the same user, if the kernel allows it."""
    if os.environ.get("SPLINECAST_SHARED_MEMORY") in ("own", "shared"):
        return
    os.environ["SPLINECAST_SHARED_MEMORY"] = "own" if shared_memory.is_allowed() else "shared"
    if os.environ["SPLINECAST_SHARED_MEMORY"] == "own":
        command = shared_memory.in_own([sys.executable, *sys.argv])
        os.execvp(command[0], command)
    print("these tests share /dev/shm with other programs: no mount namespace is allowed", file=sys.stderr)


def processes():
    """Parent and used CPU time in s of each process, by its number."""
    found = {}
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        try:
            fields = Path("/proc", entry, "stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
        except OSError:
            continue
        # With the time of children that have ended: it must not vanish with them.
        found[int(entry)] = int(fields[1]), sum(map(int, fields[11:15])) / TICKS
    return found


def used(all_processes, root):
    """The CPU time of a process and of its descendants."""
    total = all_processes[root][1]
    return total + sum(used(all_processes, child) for child, (parent, _) in all_processes.items() if parent == root)


def kill_tree(all_processes, root):
    """Kills a process, then its descendants: in the other order it could continue and succeed."""
    try:
        os.kill(root, signal.SIGKILL)
    except ProcessLookupError:
        pass
    for child, (parent, _) in all_processes.items():
        if parent == root:
            kill_tree(all_processes, child)


def watch(ctest, ended):
    """Kills each test that makes no progress."""
    progress = {}  # used time and seconds since it grew, by process
    while not ended.wait(LOOK):
        now = processes()
        tests = [child for child, (parent, _) in now.items() if parent == ctest]
        progress = {test: progress.get(test, (-1.0, 0)) for test in tests}
        for test in tests:
            before, stalled = progress[test]
            time = used(now, test)
            progress[test] = (time, 0) if time > before else (before, stalled + LOOK)
            if progress[test][1] >= STALL:
                command = Path(f"/proc/{test}/cmdline").read_text(encoding="utf-8", errors="replace")
                print(f"no progress for {STALL} s, killed: {command.replace(chr(0), ' ')}", flush=True)
                kill_tree(now, test)


def run_ctest(build, selection, junit):
    """Runs the selected tests in the order in which they are defined: the quickest first."""
    (build / "Testing/Temporary/CTestCostData.txt").unlink(missing_ok=True)
    with subprocess.Popen(["ctest", "--test-dir", build, "-j", AT_ONCE, "--timeout", BACKSTOP, "--output-on-failure",
                           "--no-tests=error", "--output-junit", junit, *selection]) as ctest:
        ended = threading.Event()
        watcher = threading.Thread(target=watch, args=(ctest.pid, ended))
        watcher.start()
        code = ctest.wait()
        ended.set()
        watcher.join()
    return code


def main():
    enter_own_shared_memory()
    build, *rest = sys.argv[1:]
    if rest == ["--rebuilds"]:
        selection = ["-L", "^rebuilds$"]
    elif rest:
        selection = ["-R", rest[0]]
    else:
        selection = ["-LE", "^rebuilds$"]
    before = left.names()
    with tempfile.TemporaryDirectory() as folder:
        junit = os.path.join(folder, "tests.xml")
        code = run_ctest(Path(build).resolve(), selection, junit)
        cases = report.read(junit)
    cases += report.judge_end(code, cases)
    names = left.wait_for_removal(before, is_own=os.environ["SPLINECAST_SHARED_MEMORY"] == "own")
    cases.append(report.Case("SharedMemory.NoTestLeavesANameBehind", "failed" if names else "passed",
                             " ".join(names)))
    return report.write(cases, HERE / "skipped.txt")


if __name__ == "__main__":
    sys.exit(main())
