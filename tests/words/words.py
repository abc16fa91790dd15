#!/usr/bin/env python3
"""Checks the text of this project against the list of words that it does not use.

    words.py [PATH...]      checks these tracked files (default: all); exits with 1 if a word of words.txt is found

Text is: comments and string literals of C++, JavaScript and Python, identifiers of C++ and JavaScript and names of
tests, split into their words, the header of a patch, and all of every other text file. Generated data (results, golden values, plots) are not text.
exceptions.txt lists lines that may contain such a word: path, the text of the match or of more of the line, and the
reason, separated by tabs. An exception that no line needs is an error too.
"""

import io
import re
import subprocess
import sys
import tokenize
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parent.parent
NOT_TEXT = re.compile(r"\.(svg|json|csv|tum|hgrm|pml)$|^tests/words/|^tests/data/|^\.clang|^LICENSE")
C_TEXT = re.compile(r'R"(\w*)\(.*?\)\1"|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"' + r"|'(?:\\.|[^'\\\n])*'", re.S)
TEST_NAME = re.compile(r"\bTEST(?:_F|_P)?\((\w+),\s*(\w+)\)|\bTYPED_TEST\((\w+),\s*(\w+)\)", re.S)


def word_list():
    """Pairs of a compiled expression and what to write instead."""
    found = []
    for line in (HERE / "words.txt").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            word, instead = line.split("\t")
            found.append((re.compile(rf"(?<![\w`-])(?:{word})(?![\w`-])", re.I), instead))
    return found


def exceptions():
    """Triples of path, text and reason."""
    lines = (HERE / "exceptions.txt").read_text(encoding="utf-8").splitlines()
    return [tuple(line.split("\t")) for line in lines if line and not line.startswith("#")]


def c_text(source):
    """(position, text) of comments, strings and names of tests."""
    parts = [(m.start(), m.group(0)) for m in C_TEXT.finditer(source) if not m.group(0).startswith("'")]
    for match in TEST_NAME.finditer(source):
        names = [name for name in match.groups() if name]
        parts += [(match.start(), " ".join(re.findall(r"[A-Z]+(?![a-z])|[A-Z][a-z]*|[a-z]+|\d+", name)))
                  for name in names]
    return parts


def identifiers(source):
    """(position, its words) of each identifier of C++ or JavaScript; the first time that it occurs."""
    found = {}
    for match in re.finditer(r"\b[A-Za-z_]\w*", C_TEXT.sub(lambda m: re.sub(r"[^\n]", " ", m.group(0)), source)):
        words = " ".join(re.findall(r"[A-Z]+(?![a-z])|[A-Z][a-z]*|[a-z]+|\d+", match.group(0)))
        found.setdefault(words.lower(), match.start())
    return [(position, words) for words, position in found.items()]


def python_text(source):
    """(position, text) of comments and strings."""
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return [(starts[token.start[0] - 1] + token.start[1], token.string)
            for token in tokens if token.type in (tokenize.COMMENT, tokenize.STRING)]


def text_of(path, source):
    """(position, text) of the parts of a file that are text."""
    if path.endswith((".cpp", ".hpp", ".js", ".hpp.in", ".c", ".h")):
        return c_text(source) + identifiers(source)
    if path.endswith(".py"):
        return python_text(source)
    if path.endswith(".patch"):
        return [(0, source.split("diff --git", 1)[0])]
    return [(0, source)]


def matches(path, source, words):
    """(line number, match, line, replacement) of every word of the list in a file."""
    for position, text in text_of(path, source):
        flat = re.sub(r"\n\s*(?:///<?|//!?|#|\*)?", lambda m: "\n" + " " * (len(m.group(0)) - 1), text)
        flat = re.sub(r'"\n\s*"', lambda m: m.group(0).replace('"', " "), flat)
        for word, instead in words:
            for match in word.finditer(re.sub(r"\s", " ", flat)):
                number = source.count("\n", 0, position + match.start()) + 1
                lines = source.split("\n")
                yield number, match.group(0), lines[min(number, len(lines)) - 1], instead


def main():
    """Checks the files."""
    listed = sys.argv[1:] or subprocess.run(["git", "-C", PROJECT, "ls-files"], capture_output=True, text=True,
                                            check=True).stdout.split("\n")
    words, allowed, used, wrong = word_list(), exceptions(), set(), 0
    for path in filter(None, listed):
        file = PROJECT / path
        if NOT_TEXT.search(path) or not file.is_file():
            continue
        try:
            source = file.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # a seed of the fuzzers
        for number, found, line, instead in matches(path, source, words):
            fitting = [e for e in allowed if e[0] == path and e[1] in line]
            used.update(fitting)
            if not fitting:
                wrong += 1
                print(f"{path}:{number}: '{found}': write {instead}: {line.strip()}")
    if len(sys.argv) == 1:
        for unused in [e for e in allowed if e not in used]:
            wrong += 1
            print(f"exceptions.txt: no line needs: {unused[0]}: {unused[1]}")
    print(f"{wrong} to be changed" if wrong else "no word of the list is used")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
