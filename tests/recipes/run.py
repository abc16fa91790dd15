#!/usr/bin/env python3
"""Applies the recipes of CONTRIBUTING.md, builds the result and runs it.

    run.py [TREE]    TREE is the folder for the copy of the sources and its build (build/recipes)

Each file NAME.patch in this folder follows one recipe. Above its diff are the lines

    Files: largest number of files that it touches
    Run:   a command that must exit with 0; PROGRAM and TESTS are the two programs
    Shows: a text that the output must contain
"""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

RECIPES = Path(__file__).resolve().parent
PROJECT = RECIPES.parent.parent
PROGRAMS = {"PROGRAM": "bin/splinecast", "TESTS": "bin/splinecast_tests"}
# The tests that the commands of the patches run.
TEST_FILES = "core/methods/|apps/streams/count|apps/tables/bars|ipc/layout/page|ipc/board/"


def copy_sources(tree):
    """Copies tracked and new files. They keep their times, so that a second run builds only what has changed."""
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=PROJECT, check=True,
                            text=True, stdout=subprocess.PIPE).stdout
    shutil.rmtree(tree / "source", ignore_errors=True)
    for name in listed.splitlines():
        if (PROJECT / name).is_file():
            (tree / "source" / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(PROJECT / name, tree / "source" / name)


def read_patch(path):
    text = path.read_text(encoding="utf-8")
    above = text.split("\ndiff --git ", 1)[0]
    fields = {name: re.findall(rf"^{name}:\s*(.*)$", above, re.M) for name in ("Files", "Run", "Shows")}
    touched = set(re.findall(r"^diff --git a/\S+ b/(\S+)$", text, re.M))
    return int(fields["Files"][0]), fields["Run"], fields["Shows"], touched


def lacks_an_include(tree, name):
    """Whether a source does not compile alone: the build compiles it with others, which hides a missing include."""
    if not name.endswith(".cpp"):
        return False
    layer = {"core": "core", "ipc": "ipc", "apps": "apps"}.get(name.partition("/")[0], "tests")
    compiled = json.loads((tree / "build" / "compile_commands.json").read_text(encoding="utf-8"))
    command = next(entry["command"] for entry in compiled if f"/{layer}/CMakeFiles/" in entry["file"])
    words = [word for word in shlex.split(command.split(" -o ")[0]) if "cmake_pch" not in word and word != "-include"]
    ended = subprocess.run([*words, "-w", "-fsyntax-only", str(tree / "source" / name)], check=False)
    return ended.returncode != 0


def main():
    tree = Path(sys.argv[1] if len(sys.argv) > 1 else PROJECT / "build" / "recipes").resolve()
    patches = {path: read_patch(path) for path in sorted(RECIPES.glob("*.patch"))}
    copy_sources(tree)
    for path, (most, _, _, touched) in patches.items():
        if len(touched) > most:
            sys.exit(f"{path.name} touches {len(touched)} files, more than {most}")
        subprocess.run(["patch", "-p1", "--force", "--no-backup-if-mismatch", "-i", str(path)], cwd=tree / "source",
                       check=True, stdout=subprocess.DEVNULL)
    configured = subprocess.run(["cmake", "-S", str(tree / "source"), "-B", str(tree / "build"), "-G", "Ninja",
                                 "-DCMAKE_CXX_FLAGS=-O0", "-DSPLINECAST_UNITY=ON", "-DSPLINECAST_BUILD_BENCH=OFF",
                                 "-DSPLINECAST_BUILD_PYTHON=OFF",
                                 f"-DSPLINECAST_TEST_FILES={TEST_FILES}"], check=False, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    built = configured.returncode or subprocess.run(
        ["cmake", "--build", str(tree / "build"), "--target", "splinecast_program", "splinecast_tests"], check=False,
        text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if configured.returncode or built.returncode:
        sys.exit(configured.stdout if configured.returncode else built.stdout[-10000:])
    failed = sum(lacks_an_include(tree, name) for _, _, _, touched in patches.values() for name in touched)
    for path, (_, commands, shows, touched) in patches.items():
        output = ""
        for command in commands:
            for word, program in PROGRAMS.items():
                command = re.sub(rf"\b{word}\b", str(tree / "build" / program), command)
            ended = subprocess.run(["bash", "-c", command], cwd=tree / "source", check=False, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=os.environ)
            output += ended.stdout
            failed += ended.returncode != 0
        missing = [text for text in shows if text not in output]
        failed += len(missing)
        print(f"{path.name}: {len(touched)} files: {'failed' if missing else 'built and run'}")
        if missing:
            print(f"the output does not contain {missing}:\n{output}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
