#!/usr/bin/env python3
"""Removes each correction and checks that its tests then fail. Writes tests/defects/README.md.

    run.py [NAME ...]     for all patches, or those named, for example held-zero: applies, builds, runs its tests, reports
    run.py --page         writes the page from the patches and their last results
    run.py --check        exits with 1 if a patch does not apply, or the page is not up to date
    run.py --keep         for all patches, without writing results and page; those of headers are applied together
    run.py --tree FOLDER  folder for the copy of the sources and its build (build/defects)

Each file NAME.patch removes one correction; patch -p1 applies it. The files are in tests/defects/core, ipc or apps,
by the corrected layer, or in laws or starts. Above its diff are the lines

    Defect:      the defect that a user saw
    Cause:       its cause
    Correction:  the change that corrected it
    Test:        names of the tests that fail without the correction: of GoogleTest, or ctest:NAME

A run writes its results to tests/defects/results.json. It uses the sources of the last commit, and builds the files of
the named tests only. Where overlays may be mounted, each patch is built in a layer of its own over this build, two at
once.
"""

import argparse
import concurrent.futures
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import textwrap
import time
from pathlib import Path

DEFECTS = Path(__file__).resolve().parent
PROJECT = DEFECTS.parent.parent
PAGE = DEFECTS / "README.md"
RESULTS = DEFECTS / "results.json"
FIELDS = ["Defect", "Cause", "Correction", "Test"]
TARGETS = ["splinecast_program", "splinecast_tests", "splinecast_byteflip", "splinecast_campaign"]
WORKERS = 2
TRIES = 3
TEST_SECONDS = 180  # a test that would take longer does not pass with all corrections either, which is tested first
PATIENCE = {"SPLINECAST_PATIENCE": "20"}  # so does a wait that takes longer
HANG = "did not end"

HEAD = """# Corrected defects

This page lists corrected defects, each with the tests that fail without its correction. It is for developers who change
the corrected code or its tests.

Each patch in this folder removes one correction. `./run defects` applies the patches one at a time, builds, and checks
that the named tests fail; `./run rebuilds` checks this, too. [`results.json`](results.json) contains the message of
each test in the last run of its patch; the context of the patch may have changed since.

Patches of older corrections are not kept; their tests are.

`tests/defects/run.py --page` writes this page.
"""
WIDTH = 120


def read_patch(path):
    """The fields above the diff of a patch, by name."""
    text = path.read_text(encoding="utf-8")
    above = text.split("\n--- ", 1)[0].split("\ndiff --git ", 1)[0]
    fields = dict.fromkeys(FIELDS, "")
    field = None
    for line in above.splitlines():
        begins = re.match(r"(\w+):\s*(.*)", line)
        if begins and begins.group(1) in fields:
            field = begins.group(1)
            line = begins.group(2)
        if field:
            fields[field] = f"{fields[field]} {line.strip()}".strip()
    missing = [name for name in FIELDS if not fields[name]]
    if missing:
        sys.exit(f"{path}: missing field {', '.join(missing)}")
    return fields


def find_patches():
    """The path of each patch by its name."""
    found = {}
    for path in sorted(DEFECTS.rglob("*.patch"), key=lambda path: path.name):
        if path.stem in found:
            sys.exit(f"{path} has the same name as {found[path.stem]}")
        found[path.stem] = path
    return found


def read_patches():
    return {name: read_patch(path) for name, path in find_patches().items()}


def patch(tree, path, *options):
    """Applies a patch to a folder. Returns None, or the output of patch if it does not apply."""
    ended = subprocess.run(["patch", "-p1", "--force", "--no-backup-if-mismatch", "--reject-file=-", *options,
                            "-i", str(path)], cwd=tree, text=True, check=False,
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return None if ended.returncode == 0 else ended.stdout


def copy_sources(tree):
    """Copies the files of the last commit to a folder. Equal files keep their times, for the build."""
    archive = subprocess.run(["git", "archive", "HEAD"], cwd=PROJECT, check=True, stdout=subprocess.PIPE).stdout
    with tarfile.open(fileobj=io.BytesIO(archive)) as files:
        wanted = {member.name: member for member in files.getmembers() if member.isfile()}
        for path in [p for p in tree.rglob("*") if p.is_file() and p.relative_to(tree).parts[0] != "build"]:
            if str(path.relative_to(tree)) not in wanted:
                path.unlink()
        for name, member in wanted.items():
            content = files.extractfile(member).read()
            path = tree / name
            if not path.exists() or path.read_bytes() != content:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
            path.chmod(member.mode)


def files_of(tree, tests):
    """The files that define these tests, as an expression for SPLINECAST_TEST_FILES."""
    suites = {test.split(".")[0].split("/")[-1] for test in tests if not test.startswith("ctest:")}
    defines = re.compile(rf"^(?:TEST|TEST_F|TEST_P|TYPED_TEST)\((?:{'|'.join(sorted(suites))}),", re.M)
    found = [path.relative_to(tree).as_posix() for path in sorted((tree / "tests").rglob("*_test.cpp"))
             if suites and defines.search(path.read_text(encoding="utf-8"))]
    return "|".join(found) or "apps/streams/count"  # a build without any test is not possible


def configure(tree, test_files):
    """Prepares a build of program and tests without optimisation. Returns None, or the output of a failure.

    Few files at once: a patch changes one of them.
    """
    tools = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    tools += ["-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=lld"] if shutil.which("ld.lld") else []
    ended = subprocess.run(
        ["cmake", "-G", "Ninja", "-S", ".", "-B", "build", "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_FLAGS=-O0 -g0",
         "-DSPLINECAST_UNITY=4", "-DSPLINECAST_BUILD_BENCH=OFF", "-DSPLINECAST_BUILD_PYTHON=OFF",
         "-DSPLINECAST_WERROR=ON", f"-DSPLINECAST_TEST_FILES={test_files}", *tools],
        cwd=tree, text=True, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return ended.stdout if ended.returncode != 0 else None


def build(tree, targets=tuple(TARGETS)):
    """Builds targets. Returns None, or the output of a failed build."""
    ended = subprocess.run(["ninja", "-C", "build", *targets], cwd=tree, text=True, check=False,
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                           env={**os.environ, "CCACHE_BASEDIR": str(tree), "CCACHE_NOHASHDIR": "1"})
    return ended.stdout if ended.returncode != 0 else None


class Unusable(Exception):
    """A patch or a test that cannot show a defect."""


def run_test(tree, test):
    """(whether a test passed, why not)."""
    if test.startswith("ctest:"):
        command = ["ctest", "--test-dir", "build", "--output-on-failure", "--no-tests=error",
                   "-R", "^" + re.escape(test.removeprefix("ctest:")) + "$"]
    else:
        command = ["build/bin/splinecast_tests", f"--gtest_filter={test}"]
    try:
        ended = subprocess.run(command, cwd=tree, text=True, check=False, errors="replace", timeout=TEST_SECONDS,
                               stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               env={**os.environ, **PATIENCE})
    except subprocess.TimeoutExpired:
        return False, HANG
    if "SKIPPED" in ended.stdout or "***Skipped" in ended.stdout:
        raise Unusable(f"{test} is skipped on this machine")
    if "[==========] 0 tests" in ended.stdout or "No tests were found" in ended.stdout:
        raise Unusable(f"there is no test {test}")
    return ended.returncode == 0, why_failed(ended.stdout, ended.returncode)


def run_until(tree, test, passes):
    """The result of the first of some runs of a test that passes, or fails, as expected; else that of the last one.

    On a machine with other work a test of several processes may fail once, and a race may not occur in each run.
    """
    for _ in range(TRIES):
        result = run_test(tree, test)
        if result[0] == passes:
            break
    return result


def why_failed(output, code):
    """The first failure that a test reports, in one line."""
    if code < 0:
        return f"ended by signal {-code}"
    lines = [line.strip() for line in output.splitlines()]
    for i, line in enumerate(lines):
        if re.search(r"(: Failure$|: error: |^Error|Errors? )", line):
            return " ".join(part for part in lines[i + 1:i + 4] if part)[:200] or line[:200]
    return f"exit code {code}"


def take_out(tree, tests):
    """Removes corrections, and returns the results of the tests of each."""
    applied = []
    try:
        for name in tests:
            path = find_patches()[name]
            refused = patch(tree, path, "--dry-run") or patch(tree, path)
            if refused is not None:
                raise Unusable(f"{name}.patch does not apply:\n{refused}")
            applied.append(path)
        needs_all = any(test.startswith("ctest:") for test in sum(tests.values(), []))
        output = build(tree, TARGETS if needs_all else ["splinecast_tests"])
        if output is not None:
            raise Unusable(f"does not build without the correction:\n{output[-4000:]}")
        return {name: {test: run_until(tree, test, False) for test in tests[name]} for name in tests}
    finally:
        for path in reversed(applied):
            patch(tree, path, "-R")


def fails_as_it_is(tree, tests):
    """The tests that do not pass with all corrections, and so cannot show a defect."""
    found = set()
    for test in tests:
        try:
            passed, why = run_until(tree, test, True)
        except Unusable as error:
            passed, why = False, error
        if not passed:
            print(f"{test}: does not pass with all corrections: {why}", file=sys.stderr, flush=True)
            found.add(test)
    return found


def outcome(tree, tests, unusable):
    """For each correction, the outcome of each of its tests without it: "passes", or why it fails."""
    try:
        without = take_out(tree, tests)
    except Unusable as error:
        print(f"{', '.join(tests)}: {error}", file=sys.stderr, flush=True)
        return {name: dict.fromkeys(tests[name], "passes") for name in tests}
    return {name: {test: "passes" if passed or test in unusable else why for test, (passed, why) in found.items()}
            for name, found in without.items()}


def groups_of(names, together):
    """The corrections that are taken out at once: one, or all in headers, each of which takes a build of everything."""
    paths = find_patches()
    in_headers = [name for name in names if together and re.search(r"(?m)^\+\+\+ .*\.hpp", paths[name].read_text())]
    return ([in_headers] if in_headers else []) + [[name] for name in names if name not in in_headers]


def in_layer(tree, name, command):
    """Runs a command with an empty layer of its own over the tree, so that it changes no other build."""
    folders = [tree.parent / f"{tree.name}.{what}.{name}" for what in ("layer", "scratch")]
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
    mount = f"mount -t overlay overlay -o lowerdir={tree},upperdir={folders[0]},workdir={folders[1]} {tree}"
    ended = subprocess.run(["unshare", "--mount", "sh", "-c", f'{mount} && exec "$@"', "sh", *command], text=True,
                           check=False, stdout=subprocess.PIPE)
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)
    return ended


def outcomes(tree, groups, unusable):
    """Pairs of name and outcome, as they are found: two groups at once, if a layer can be mounted."""
    is_layered = in_layer(tree, "try", ["true"]).returncode == 0
    work = [sys.executable, str(Path(__file__).resolve()), "--work", json.dumps(sorted(unusable)), "--tree", str(tree)]

    def find(names):
        command = [*work, *names]
        ended = in_layer(tree, names[0], command) if is_layered else subprocess.run(
            command, text=True, check=False, stdout=subprocess.PIPE)
        if ended.returncode != 0:
            raise RuntimeError(f"{', '.join(names)}: ended with exit code {ended.returncode}")
        return json.loads(ended.stdout)

    with concurrent.futures.ThreadPoolExecutor(WORKERS if is_layered else 1) as pool:
        for future in concurrent.futures.as_completed([pool.submit(find, names) for names in groups]):
            yield from future.result().items()


def run(tree, names, writes_results):
    patches = read_patches()
    tests = {name: patches[name]["Test"].split() for name in names or patches}
    tree.mkdir(parents=True, exist_ok=True)
    copy_sources(tree)
    begin = time.monotonic()
    every_test = sorted(set(sum(tests.values(), [])))
    output = configure(tree, files_of(tree, every_test)) or build(tree)
    if output is not None:
        sys.exit(output[-4000:])
    print(f"built in {(time.monotonic() - begin) / 60:.1f} min", flush=True)
    unusable = fails_as_it_is(tree, every_test)
    print(f"tests tried at {(time.monotonic() - begin) / 60:.1f} min", flush=True)
    results = read_results()
    results["patches"] = {name: results["patches"][name] for name in patches if name in results["patches"]}
    passed = []
    for name, found in outcomes(tree, groups_of(tests, not writes_results), unusable):
        fails = "passes" not in found.values()
        passed += [] if fails else [name]
        print(f"{name}: {'fails' if fails else 'PASSES'} without the correction", flush=True)
        for test, why in found.items():
            print(f"    {test}: {why}", flush=True)
        results["patches"][name] = found
    print(f"{len(tests)} corrections taken out in {(time.monotonic() - begin) / 60:.1f} min")
    if writes_results:
        results["patches"] = dict(sorted(results["patches"].items()))
        RESULTS.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
        PAGE.write_text(make_page(), encoding="utf-8")
    sys.exit(f"passed without the correction: {', '.join(passed)}" if passed else 0)


def read_results():
    return json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.exists() else {"patches": {}}


def paragraph(text, indent=""):
    return textwrap.fill(text, WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False) + "\n"


def section(name, path, fields, results):
    """A section of the page: one defect, and whether its tests fail without the correction."""
    lines = [f"\n## {name}\n\n", paragraph(fields["Defect"]), "\n"]
    lines += [paragraph(f"- {what}: {fields[what]}", "  ") for what in ("Cause", "Correction")]
    patch_file = path.relative_to(DEFECTS).as_posix()
    lines.append(f"- Patch: [`{patch_file}`]({patch_file})\n- Tests without the correction:\n")
    for test in fields["Test"].split():
        state = {None: "not run", "passes": "passes"}.get(results.get(test), "fails")
        lines.append(f"  - `{test}`: {state}\n")
    return "".join(lines)


def make_page():
    paths, patches = find_patches(), read_patches()
    results = read_results()
    sections = [section(name, paths[name], fields, results["patches"].get(name, {})) for name, fields in patches.items()]
    return HEAD + "".join(sections)


def check():
    """Exits with messages if a patch does not apply to the present lines, or the page is not up to date."""
    refused = [f"{name}.patch does not apply:\n{said}" for name, path in find_patches().items()
               if (said := patch(PROJECT, path, "--dry-run", "--fuzz=0")) is not None]
    if PAGE.read_text(encoding="utf-8") != make_page():
        refused.append(f"{PAGE} is not up to date: run run.py --page")
    sys.exit("\n".join(refused) or 0)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--page", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--work", help=argparse.SUPPRESS)  # the tests that cannot show a defect
    parser.add_argument("--tree", type=Path, default=PROJECT / "build" / "defects")
    arguments = parser.parse_args()
    if arguments.check:
        check()
    elif arguments.page:
        PAGE.write_text(make_page(), encoding="utf-8")
    elif arguments.work:
        tests = {name: read_patches()[name]["Test"].split() for name in arguments.names}
        print(json.dumps(outcome(arguments.tree, tests, json.loads(arguments.work))))
    else:
        run(arguments.tree.resolve(), arguments.names, not arguments.keep)


if __name__ == "__main__":
    main()
