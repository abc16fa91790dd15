#!/usr/bin/env python3
"""Completes command lines of splinecast in bash and zsh, with the scripts that `splinecast completion` prints.

    run.py BIN      BIN is the folder of splinecast

In zsh, types the line and a tab into an interactive shell. Exits with 77 if zsh is missing.
"""

import os
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

STREAM = f"test.{os.getpid()}.arm"
# A line, and a word that its completion must offer, or complete it to.
LINES = [
    ("splinecast rep", "replay"),
    ("splinecast fit --meth", "--method"),
    ("splinecast fit --method maki", "makima"),
    ("splinecast solve --tail parab", "parabolic"),
    ("splinecast replay --clock rec", "recorded"),
    ("splinecast check --limits joint_lim", "joint_limits.yaml"),
    ("splinecast fit waypoi", "waypoints.csv"),
    (f"splinecast info {STREAM[:-1]}", STREAM),
    (f"splinecast rate {STREAM[:-1]}", STREAM),
    ("splinecast latency comp", "compare"),
    ("splinecast latency compare --thresh", "--threshold"),
    ("splinecast completion z", "zsh"),
]


def in_bash(script, line, environment, folder):
    """The words that bash offers for the last word of a line."""
    words = line.split(" ")
    command = (f"source {script}; COMP_WORDS=({' '.join(words)}); COMP_CWORD={len(words) - 1}; _splinecast; "
               "printf '%s\\n' \"${COMPREPLY[@]}\"")
    ended = subprocess.run(["bash", "--norc", "-c", command], cwd=folder, env=environment, check=True,
                           capture_output=True, text=True)
    return ended.stdout.split("\n")


class Zsh:
    """An interactive zsh with the script loaded."""

    def __init__(self, folder, environment):
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.chdir(folder)
            os.execvpe("zsh", ["zsh", "-f", "-i"], environment | {"TERM": "dumb", "PS1": "", "COLUMNS": "400"})
        self.type("stty cols 400; PROMPT=; fpath=($PWD $fpath); autoload -U compinit; compinit -u -d .dump; "
                  "unsetopt menu_complete auto_menu zle_bracketed_paste; print rea''dy\n")
        self.read_until("ready")

    def type(self, text):
        """Types text."""
        os.write(self.terminal, text.encode())

    def read_until(self, word, seconds=600):
        """Reads until the shell has written the word, for this long at most; returns what it has written."""
        text, end = "", time.monotonic() + seconds
        while word not in text and time.monotonic() < end:
            if select.select([self.terminal], [], [], 0.1)[0]:
                text += os.read(self.terminal, 65536).decode(errors="replace")
        return text

    def complete(self, line, word):
        """What the shell writes when the line and a tab are typed, up to the word."""
        self.type("\x15" + line + "\t")
        return self.read_until(word)


def main():
    """Completes every line in both shells."""
    programs = os.path.abspath(sys.argv[1])
    if not shutil.which("zsh"):
        print("there is no zsh")
        return 77
    environment = os.environ | {"PATH": programs + os.pathsep + os.environ["PATH"]}
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for shell, name in (("bash", "bash"), ("zsh", "_splinecast")):
            Path(folder, name).write_bytes(subprocess.run(["splinecast", "completion", shell], env=environment,
                                                          check=True, capture_output=True).stdout)
        Path(folder, "waypoints.csv").write_text("t,x\n0,0\n0.1,1\n0.2,0\n", encoding="utf-8")
        Path(folder, "joint_limits.yaml").touch()
        subprocess.run(["splinecast", "replay", "waypoints.csv", "--stream", STREAM, "--clock", "recorded",
                        "--rate", "max", "--embedded"], cwd=folder, env=environment, check=True, capture_output=True)
        try:
            zsh = Zsh(folder, environment)
            for line, word in LINES:
                offered = in_bash(Path(folder, "bash"), line, environment, folder)
                written = zsh.complete(line, word)
                if word not in offered:
                    wrong += 1
                    print(f"bash: {line}<tab>: {offered}, not {word}")
                if word not in re.sub(r"\s", "", written):
                    wrong += 1
                    print(f"zsh: {line}<tab>: {written!r}, not {word}")
            os.close(zsh.terminal)
        finally:
            subprocess.run(["splinecast", "rm", STREAM], env=environment, check=False)
    print(f"{len(LINES)} lines, {wrong} failed")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
