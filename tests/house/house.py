#!/usr/bin/env python3
"""Measures the structure of the code and checks it against limits.

    house.py rooms                 number of files in each folder
    house.py files                 lines per file, and the longest files
    house.py functions             the longest functions
    house.py members               the classes with the most data members
    house.py headers               the installed headers
    house.py options               the options of streams and curves, and how many files name each
    house.py layers                the rooms from the lowest to the highest, and includes of higher rooms
    house.py walk                  the files that a waypoint passes through, as listed in CONTRIBUTING.md
    house.py symbols LIBRARY       compares the symbols that the shared library exports with exports.txt
                [--write]          writes exports.txt instead
    house.py page [--check]        writes docs/house.md; --check: exits with 1 if it is not up to date

Each command exits with 1 if a limit is exceeded. The limits: 20 files in a room, 30 in a folder of tests or docs;
400 lines in a file, with a median of at most 150; 40 lines in a function; 25 data members in a class; 24 installed
headers; 12 files of core, ipc and apps that name an option; 17 stations of a waypoint.
"""

import argparse
import os
import re
import statistics
import subprocess
import sys
from collections import Counter
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent.parent
EXPORTS = Path(__file__).resolve().parent / "exports.txt"
PAGE = PROJECT / "docs" / "house.md"
MOST_FILES, MOST_FILES_OF_TESTS, MOST_LINES, MEDIAN_LINES, MOST_FUNCTION_LINES, MOST_HEADERS = 20, 30, 400, 150, 40, 24
MOST_MEMBERS = 25
MOST_STATIONS = 17
MOST_FILES_OF_AN_OPTION = 12
# Their members are the words of a region: see ipc/layout/table.hpp.
FORMATS = {"ipc/layout/header.hpp: RegionHeader", "ipc/layout/summary.hpp: Summary"}

# The rooms from the lowest to the highest. A file includes only files of its own room and of lower ones.
ROOMS = {
    "core": "simd basics polynomial limits slopes forms laws solvers batch methods online motion",
    "ipc": "memory layout mapping requests ring board runs solve options sampling law owned roles sweep verification/promises verification arguments c "
           "python/values python",
    "apps": "process files mcap/format mcap/output mcap/input messages output pages timing tables tables/topics "
            "tables/ulog cli recover contents recordings limits streams rate stop record/format record/executed record/watch record/output "
            "record/verification record/trigger record sample advise fit check replay trials demo machine latency soak completion",
}
# The installed C header, which may be included as an installed header of C++ is.
C_HEADER = "splinecast.h"
LAYERS = [f"{layer}/{room}" for layer, rooms in ROOMS.items() for room in rooms.split()]


def files(*patterns):
    """The tracked files and the new files that are not ignored, if they match one of these patterns."""
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *patterns],
                            cwd=PROJECT, check=True, text=True, stdout=subprocess.PIPE).stdout
    return sorted({name for name in listed.splitlines() if (PROJECT / name).is_file()})


def lines_of(name):
    return (PROJECT / name).read_text(encoding="utf-8").count("\n")


def sources():
    return files("*.cpp", "*.hpp")


def rooms():
    """Number of files in each folder."""
    out, broken = [], []
    counts = Counter()
    for name in files("core", "ipc", "apps", "bench", "tests", "docs", "examples"):
        if name.endswith(".mcap"):
            continue  # recordings are data
        folder = os.path.dirname(name)
        counts[folder] += 1
    for folder in sorted(counts):
        most = MOST_FILES_OF_TESTS if folder.startswith(("tests", "docs")) else MOST_FILES
        out.append(f"{counts[folder]:4} files  {folder}")
        if counts[folder] > most:
            broken.append(f"{folder}: {counts[folder]} files, more than {most}")
    return out, broken


def file_lengths():
    """Lines per C++ file."""
    lengths = sorted(((lines_of(name), name) for name in sources()), reverse=True)
    median = statistics.median(length for length, _ in lengths)
    out = [f"median {median:g} lines", "the longest:"]
    out += [f"{length:5}  {name}" for length, name in lengths[:5]]
    broken = [f"{name}: {length} lines, more than {MOST_LINES}" for length, name in lengths if length > MOST_LINES]
    if median > MEDIAN_LINES:
        broken.append(f"the median is {median:g} lines, more than {MEDIAN_LINES}")
    return out, broken


def without_texts(code):
    """The code with blanks in place of comments, strings and characters; lines stay."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match.group(0))
    code = re.sub(r'R"(\w*)\((.*?)\)\1"', blank, code, flags=re.S)
    return re.sub(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'", blank, code,
                  flags=re.S)


def functions_of(name):
    """(length, file, first line, name) of each function; the length includes the closing brace."""
    code = without_texts((PROJECT / name).read_text(encoding="utf-8"))
    found, stack, start = [], [], 0
    for i, c in enumerate(code):
        if c == "{":
            head = re.sub(r"^\s*(public|private|protected)\s*:", "", code[start:i].strip())
            first = code.count("\n", 0, start + len(code[start:i]) - len(code[start:i].lstrip())) + 1
            inside = bool(stack) and stack[-1][0] != "scope"
            is_type = re.search(r"\b(namespace|class|struct|enum|union)\b", head) and not re.search(
                r"\)\s*(const|noexcept|override|final|\s|->.*)*$", head)
            kind = "block" if inside else "scope" if is_type else "function" if "(" in head else "block"
            stack.append((kind, first, head))
            start = i + 1
        elif c == "}" and stack:
            kind, first, head = stack.pop()
            if kind == "function":
                words = head.split("(")[0].split()
                found.append((code.count("\n", 0, i) + 2 - first, name, first, words[-1] if words else head[:40]))
            start = i + 1
        elif c in "};":
            start = i + 1
    return found


def functions():
    """The longest functions, including tests."""
    found = sorted((f for name in sources() for f in functions_of(name)), reverse=True)
    out = [f"median {statistics.median(f[0] for f in found):g} lines", "the longest:"]
    out += [f"{length:5}  {file}: {name}" for length, file, _, name in found[:5]]
    broken = [f"{file}:{line}: {name} has {length} lines, more than {MOST_FUNCTION_LINES}"
              for length, file, line, name in found if length > MOST_FUNCTION_LINES]
    return out, broken


def body_from(code, begin):
    """What the braces that open before `begin` enclose, with a semicolon in place of each inner block."""
    depth, out = 1, []
    for c in code[begin:]:
        depth += (c == "{") - (c == "}")
        if depth == 0:
            break
        if depth == 1:
            out.append(";" if c == "}" else c)
    return "".join(out)


def is_member(statement):
    """Whether a statement of a class declares a data member."""
    statement = re.sub(r"\b(public|private|protected)\s*:(?!:)|\[\[.*?\]\]", " ", statement).split("=")[0].strip()
    while "<" in statement and (shorter := re.sub(r"<[^<>]*>", "", statement)) != statement:
        statement = shorter
    if re.match(r"(using|friend|static|enum|template|typedef|class|struct|union|explicit|constexpr)\b", statement):
        return False
    return bool(re.fullmatch(r"[A-Za-z_][\w:*&\s]*[\s*&]\w+(\s*\[[^\]]*\])?(\s*:\s*\d+)?", statement))


def members_of(name):
    """(number of data members, file and class) of each class in a file; those of its bases do not count."""
    code = without_texts((PROJECT / name).read_text(encoding="utf-8"))
    heads = re.finditer(r"(?<!enum )\b(?:class|struct)\s+(?:\[\[.*?\]\]\s*)?(\w+)[^;{}()=]*\{", code)
    return [(sum(map(is_member, body_from(code, head.end()).split(";"))), f"{name}: {head.group(1)}") for head in heads]


def members():
    """The classes of the product with the most data members, except those whose members are the words of a region."""
    found = sorted((m for name in sources() if not name.startswith("tests/")
                    for m in members_of(name) if m[1] not in FORMATS), reverse=True)
    out = [f"{len(found)} classes, median {statistics.median(count for count, _ in found):g} members", "the most:"]
    out += [f"{count:5}  {name}" for count, name in found[:5]]
    broken = [f"{name} has {count} data members, more than {MOST_MEMBERS}" for count, name in found
              if count > MOST_MEMBERS]
    return out, broken


def headers():
    """The installed headers, which include no other file of the project."""
    found = files("core/include/*.hpp", "ipc/include/*.hpp")
    out = [f"{len(found)} installed headers: " + " ".join(Path(name).stem for name in found)]
    broken = [f"{name} includes {included}, which is not installed"
              for name in found for included in includes_of(name) if not included.startswith("splinecast/")]
    if len(found) > MOST_HEADERS:
        broken.append(f"{len(found)} headers, more than {MOST_HEADERS}")
    return out, broken


def includes_of(name):
    """The project's files that a file includes."""
    return re.findall(r'^#include "([^"]+)"', (PROJECT / name).read_text(encoding="utf-8"), re.M)


def goes_up(name):
    """The includes of a file from a higher room or from a room that ROOMS does not list."""
    room = os.path.dirname(name)
    if room not in LAYERS:
        return [] if "/include/" in name or not name.startswith(("core/", "ipc/", "apps/")) else [f"{name}: no room"]
    own, up = LAYERS.index(room), []
    for included in includes_of(name):
        other = os.path.dirname(included)
        if other == "splinecast":
            is_core = (PROJECT / "core" / "include" / included).is_file()
            if not is_core and room.startswith("core/"):
                up.append(f"{name} includes {included}")
        elif included != C_HEADER and (other not in LAYERS or LAYERS.index(other) > own):
            up.append(f"{name} includes {included}")
    return up


def layers():
    """The rooms from the lowest to the highest, and includes of higher rooms."""
    out = [f"{layer}: {rooms_of}" for layer, rooms_of in ROOMS.items()]
    known = {os.path.dirname(name) for name in files("core/*.?pp", "ipc/*.?pp", "apps/*.?pp") if "/include/" not in name}
    broken = [f"ROOMS does not list {room}" for room in sorted(known - set(LAYERS))]
    broken += [f"{room} of ROOMS has no file" for room in LAYERS if room not in known]
    broken += [up for name in files("core/*.?pp", "ipc/*.?pp", "apps/*.?pp") for up in goes_up(name)]
    return out, broken


def options():
    """The options of streams and curves, and how many files of core, ipc and apps name each.

    Those whose name is one word are left out, because text uses these words, too.
    """
    table = (PROJECT / "ipc/layout/options.hpp").read_text(encoding="utf-8")
    keys = re.findall(r"\{\s*\"(\w+_\w+)\",", table) + ["named_limits"]
    texts = [(PROJECT / name).read_text(encoding="utf-8") for name in files("core", "ipc", "apps")]
    counts = sorted(((sum(bool(re.search(rf"\b{key}\b", text)) for text in texts), key) for key in keys), reverse=True)
    broken = [f"{key} is in {count} files, more than {MOST_FILES_OF_AN_OPTION}" for count, key in counts
              if count > MOST_FILES_OF_AN_OPTION]
    broken += [] if len(keys) >= 9 else ["ipc/layout/options.hpp has too few options"]
    return [f"{count:5}  {key}" for count, key in counts], broken


def stations():
    """The way of a waypoint in CONTRIBUTING.md: for each process, the stations' files and function."""
    text = (PROJECT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    part = re.search(r"^## The way of a waypoint\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    processes = re.split(r"^In .*:\n", part.group(1), flags=re.M)[1:] if part else []
    listed = [re.findall(r"^\d+\. (`.*?`):(?:\s+`(?:(\w+)::)?(\w+)`)?", process, re.M) for process in processes]
    return [[(re.findall(r"`([^`]+)`", names), of, function) for names, of, function in process] for process in listed]


def is_defined(of, function, names):
    """Whether these files define a function: of a class, or of none if `of` is empty. False without a function."""
    text = "".join((PROJECT / name).read_text(encoding="utf-8") for name in names)
    in_class = re.search(rf"\bclass {of}\b.*?\b{function}\(", text, re.S)
    is_there = re.search(rf"\b{of}::{function}\(" if of else rf"\b{function}\(", text) or (of and in_class)
    return bool(function and is_there)


def wrong_stations(process):
    """What is wrong with the stations in a process: an earlier one calls each, and the way does not go in circles.

    It leads to a lower room that it has not passed, or back to the room of a caller.
    """
    broken, passed, before = [], [], ""
    for names, of, function in process:
        if not is_defined(of, function, names):
            broken.append(f"{' and '.join(names)}: no function '{function}'")
        if before and not re.search(rf"(?:\.|->|::){function}\(", before):
            broken.append(f"{' and '.join(names)}: no station before it calls {function}")
        before += "".join((PROJECT / name).read_text(encoding="utf-8") for name in names)
        for room in map(os.path.dirname, names):
            at = passed[-1] if passed else room
            is_down = LAYERS.index(room) < LAYERS.index(at)
            if is_down and room in passed:
                broken.append(f"{' and '.join(names)}: the way has already passed {room}")
            if LAYERS.index(room) > LAYERS.index(at) and room not in passed:
                broken.append(f"{' and '.join(names)}: no station before it is in {room}")
            passed.append(room)
    return broken


def walk():
    """The files that a waypoint passes through, as listed in CONTRIBUTING.md."""
    processes = stations()
    listed = [name for process in processes for names, _, _ in process for name in names]
    count = sum(map(len, processes))
    out = [f"{count} stations in {len(processes)} processes, {len(listed)} files:"]
    out += ["  ".join(names) for process in processes for names, _, _ in process]
    broken = [f"{name} does not exist" for name in listed if not (PROJECT / name).is_file()]
    broken += [f"{name} is in no room" for name in listed if os.path.dirname(name) not in LAYERS]
    broken += [f"{name} is listed {times} times" for name, times in Counter(listed).items() if times > 1]
    broken = broken or [up for name in listed for up in goes_up(name)]
    broken = broken or [wrong for process in processes for wrong in wrong_stations(process)]
    if not 8 <= count <= MOST_STATIONS or len(processes) != 3:
        broken.append(f"{count} stations in {len(processes)} processes, not 8 to {MOST_STATIONS} in 3")
    return out, broken


def symbols(library, write):
    """The exported symbols of the shared library: functions, variables, and type information of exceptions."""
    listed = subprocess.run(["nm", "-D", "--defined-only", "-C", library], check=True, text=True,
                            stdout=subprocess.PIPE).stdout
    exported = set()
    for line in listed.splitlines():
        kind, name = line.split(maxsplit=2)[1:] if line[0] != " " else line.split(maxsplit=1)
        if kind != "A":  # the version itself
            exported.add(re.sub(r"@@?\w[\w.]*$", "", name).replace("[abi:cxx11]", ""))
    text = "".join(f"{name}\n" for name in sorted(exported))
    if write:
        EXPORTS.write_text(text, encoding="utf-8")
    wanted = set(EXPORTS.read_text(encoding="utf-8").splitlines())
    broken = [f"not exported: {name}" for name in sorted(wanted - exported)]
    broken += [f"exported but not in {EXPORTS.name}: {name}" for name in sorted(exported - wanted)]
    return [f"{len(exported)} exported symbols"], broken


COMMANDS = {"rooms": rooms, "files": file_lengths, "functions": functions, "members": members, "headers": headers,
            "options": options, "layers": layers, "walk": walk}


def page():
    parts = ["# Structure of the code\n",
             "`tests/house/house.py page` writes this page. [CONTRIBUTING.md](../CONTRIBUTING.md) describes the "
             "rooms.\n"]
    for name, command in COMMANDS.items():
        out, _ = command()
        parts.append(f"## {command.__doc__.splitlines()[0].rstrip('.')}\n\n`tests/house/house.py {name}`\n")
        parts.append("".join(f"    {line}\n" for line in out))
    count = len(EXPORTS.read_text(encoding="utf-8").splitlines())
    parts.append("## The exported symbols of the shared library\n\n"
                 "`tests/house/house.py symbols build/release/ipc/libsplinecast.so`\n")
    parts.append(f"    {count} exported symbols: tests/house/exports.txt\n")
    return "\n".join(parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=[*COMMANDS, "symbols", "page"])
    parser.add_argument("library", nargs="?")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    if options.command == "page":
        text = page()
        if not options.check:
            PAGE.write_text(text, encoding="utf-8")
            return 0
        if PAGE.read_text(encoding="utf-8") == text:
            return 0
        print(f"{PAGE.relative_to(PROJECT)} is not up to date: run tests/house/house.py page")
        return 1
    if options.command == "symbols":
        if not options.library:
            parser.error("symbols needs the library")
        out, broken = symbols(options.library, options.write)
    else:
        out, broken = COMMANDS[options.command]()
    print("\n".join(out))
    for line in broken:
        print(f"BROKEN: {line}")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
