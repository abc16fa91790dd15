#!/usr/bin/env python3
"""Runs the commands of the README as printed, from top to bottom, in an empty folder.

    run.py README.md FOLDER-OF-SPLINECAST

Its blocks are indented by four spaces; commands are lines that begin with splinecast, printf or
kill. Durations are shortened. Each command must end with exit code 0; MACHINE lists the exceptions.
Runs with a private /dev/shm; exits with 77 if that is not allowed.
"""

import os
import re
import subprocess
import sys
import tempfile
import time

BOUND = 30  # seconds, for each command
SHORTER = [(r"--duration 5\b", "--duration 0.5"), (r"--seconds \d+", "--seconds 2"),
           (r"--streams 100\b", "--streams 3")]
# Commands whose exit code depends on the machine, and the codes allowed in addition to 0.
MACHINE = [("splinecast doctor", {1}), ("splinecast latency compare", {2, 3}),
           ("--mode spin", {2})]


def machine_of(program):
    """MACHINE, and what the build of the program adds: ThreadSanitizer's memory grows, which `soak` reports."""
    with open(program, "rb") as file:
        return MACHINE + ([("splinecast soak", {1})] if b"__tsan_init" in file.read() else [])


def commands(readme):
    """The README's commands, in order."""
    with open(readme, encoding="utf-8") as file:
        for line in file:
            if re.match(r" {4}(splinecast|printf|kill) ", line):
                command = line.strip()
                for text, shorter in SHORTER:
                    command = re.sub(text, shorter, command)
                yield command


def script(lines):
    """A shell script that prints each command's exit code."""
    text = ""
    for number, line in enumerate(lines):
        if line.endswith("&"):
            text += f"{line}\n"
        else:
            text += f"echo 'RUN {number}'\n{line}\necho \"CODE {number} $?\"\n"
    return text


def is_allowed():
    """Whether this user may have a private /dev/shm."""
    return subprocess.run(private("true"), check=False, capture_output=True).returncode == 0


def private(command):
    """The arguments that run a shell command with an empty /dev/shm."""
    as_root = [] if os.geteuid() == 0 else ["--map-root-user"]
    mount = "mount -t tmpfs -o mode=1777,size=256m tmpfs /dev/shm"
    return ["unshare", "--mount", *as_root, "bash", "-c", f"{mount} && {command}"]


def wait_while_it_goes_on(process, output):
    """Waits until the process ends, or until no command has ended for BOUND seconds."""
    told, end = 0, time.monotonic() + BOUND
    while process.poll() is None and time.monotonic() < end:
        time.sleep(0.05)
        with open(output, encoding="utf-8", errors="replace") as file:
            now = file.read().count("\nCODE ")
        if now > told:
            told, end = now, time.monotonic() + BOUND


def main():
    """Runs the commands and checks their exit codes."""
    readme, programs = map(os.path.abspath, sys.argv[1:])
    if not is_allowed():
        print("needs a mount namespace of its own (root, or user namespaces)")
        return 77
    lines = list(commands(readme))
    environment = os.environ | {"PATH": programs + os.pathsep + os.environ["PATH"]}
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, ".script"), "w", encoding="utf-8") as file:
            file.write(script(lines))
        with open(os.path.join(folder, ".out"), "w+", encoding="utf-8") as out:
            started = subprocess.Popen(private("exec bash .script"), cwd=folder, env=environment,
                                       stdin=subprocess.DEVNULL, stdout=out, stderr=out,
                                       start_new_session=True)
            wait_while_it_goes_on(started, out.name)
            try:
                os.killpg(started.pid, 9)  # commands that hang or still run in the background
            except ProcessLookupError:
                pass
            started.wait()
            out.seek(0)
            said = out.read()
    return judge(lines, said, machine_of(os.path.join(programs, "splinecast")))


def judge(lines, said, machine):
    """Compares the exit codes with the allowed ones."""
    codes = {int(n): int(code) for n, code in re.findall(r"^CODE (\d+) (\d+)$", said, re.MULTILINE)}
    wrong = 0
    for number, line in enumerate(lines):
        if line.endswith("&"):
            continue
        may_be = {0}.union(*(more for text, more in machine if text in line))
        if codes.get(number) not in may_be:
            wrong += 1
            print(f"{line}: {'exit code ' + str(codes[number]) if number in codes else 'hangs'}")
    if wrong:
        print(said)
    print(f"{len(lines)} commands, {wrong} failed")
    return 1 if wrong or not lines else 0


if __name__ == "__main__":
    sys.exit(main())
