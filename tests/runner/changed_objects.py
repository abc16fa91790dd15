#!/usr/bin/env python3
"""Prints the objects of a build that contain what has changed since the commit before the last one.

    changed_objects.py BUILD      BUILD is configured, for Ninja
"""

import json
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent.parent
MOST = 12  # more would take longer than a minute


def changed():
    """The C++ sources that are new, changed, or part of the last commit. There may be no commit before it."""
    listed = ""
    for command in (["diff", "--name-only", "HEAD~1"], ["ls-files", "--others", "--exclude-standard"]):
        listed += subprocess.run(["git", *command], cwd=PROJECT, check=False, text=True, stdout=subprocess.PIPE,
                                 stderr=subprocess.DEVNULL).stdout
    return {str(PROJECT / name) for name in listed.splitlines() if name.endswith(".cpp")}


def sources_of(file):
    """The sources that are compiled as this file: a unity file includes several."""
    if "/Unity/" not in file:
        return {file}
    lines = Path(file).read_text(encoding="utf-8").splitlines()
    return {line.split('"')[1] for line in lines if line.startswith("#include")}


def main():
    build = Path(sys.argv[1])
    found, wanted = [], changed()
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        if wanted & sources_of(entry["file"]):
            found.append(entry["output"] if "output" in entry else entry["command"].split(" -o ")[1].split(" ")[0])
    print("\n".join(found[:MOST]))


if __name__ == "__main__":
    main()
