"""Reads the pages of the manual: their fenced blocks, commands, headings and links."""

import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent.parent
FENCE = re.compile(r"^( *)(```+)\s*(.*?)\s*$")
HIDDEN = re.compile(r"^<!-- run: (.*) -->$")
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\[\]]*\])*\]\(([^()\s]+(?:\([^()]*\))?)\)")


@dataclass
class Block:
    """A fenced block: its language, further words after the language, its lines, and the number of its first line."""

    language: str
    words: list
    lines: list
    first: int


@dataclass
class Command:
    """A command of a page with the output that the page shows."""

    text: str
    line: int  # of the page, from 1
    output: list = field(default_factory=list)
    words: list = field(default_factory=list)  # of the block: `varies`, `exit=N`
    last: int = 0  # the line after its output
    indent: str = ""

    @property
    def exit_code(self):
        """The exit code that the block states, else 0."""
        codes = [int(word.removeprefix("exit=")) for word in self.words if word.startswith("exit=")]
        return codes[0] if codes else 0

    @property
    def varies(self):
        """Whether the numbers of the output differ from run to run."""
        return "varies" in self.words


def pages():
    """All Markdown files that are tracked or new, as paths."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "--deduplicate", "*.md"], cwd=PROJECT,
                            check=True, capture_output=True, text=True).stdout.split("\n")
    return [PROJECT / name for name in listed if name and (PROJECT / name).exists()]


def blocks(lines):
    """The fenced blocks of a page."""
    begin = None
    for number, line in enumerate(lines):
        match = FENCE.match(line)
        if begin is None and match:
            begin, indent, fence, info = number, *match.groups()
        elif begin is not None and line.strip() == fence:
            language, *words = info.split() or [""]
            yield Block(language, words, [text.removeprefix(indent) for text in lines[begin + 1:number]], begin + 2)
            begin = None


def split_commands(block):
    """The commands of a `console` block."""
    found, at = [], 0
    while at < len(block.lines):
        line = block.lines[at]
        if not line.startswith("$ "):
            if found:
                found[-1].output.append(line)
                found[-1].last = block.first + at + 1
            at += 1
            continue
        text, first = [line[2:]], at
        document = re.search(r"<<-?\s*'?\"?(\w+)", line)
        while at + 1 < len(block.lines) and (
                text[-1].endswith("\\") or (document and block.lines[at] != document.group(1))):
            at += 1
            text.append(block.lines[at])
        found.append(Command("\n".join(text), block.first + first, words=block.words, last=block.first + at + 1))
        at += 1
    return found


def commands(path):
    """The commands of a page, hidden ones included, in order."""
    lines = path.read_text(encoding="utf-8").splitlines()
    found = [command for block in blocks(lines) if block.language == "console" for command in split_commands(block)]
    for number, line in enumerate(lines):
        hidden = HIDDEN.match(line)
        if hidden:
            found.append(Command(hidden.group(1), number + 1, last=number + 2))
    return sorted(found, key=lambda command: command.line)


def without_code(text):
    """The text with fenced blocks, code spans and comments blanked."""
    text = re.sub(r"^( *)(```+).*?^\1\2 *$", lambda m: "\n" * m.group(0).count("\n"), text, flags=re.S | re.M)
    text = re.sub(r"<!--.*?-->", lambda m: "\n" * m.group(0).count("\n"), text, flags=re.S)
    return re.sub(r"(?<!`)(`+)(?!`)(.+?)(?<!`)\1(?!`)", lambda m: "x" * len(m.group(0)), text)


def anchors(path):
    """The anchors of a page's headings, as GitHub and the site make them."""
    text = re.sub(r"^( *)(```+).*?^\1\2 *$", "", path.read_text(encoding="utf-8"), flags=re.S | re.M)
    seen, found = {}, set()
    for heading in re.findall(r"^#+ +(.*?)\s*$", text, re.M):
        plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
        count = seen.get(slug, 0)
        seen[slug] = count + 1
        found.add(f"{slug}-{count}" if count else slug)
    found.update(re.findall(r'<a (?:id|name)="([^"]+)"', text))
    return found


def links(path):
    """(line number, target) of every link of a page."""
    text = without_code(path.read_text(encoding="utf-8"))
    for match in LINK.finditer(text):
        yield text.count("\n", 0, match.start()) + 1, match.group(1)
