#!/usr/bin/env python3
"""Builds the site: the manual with mkdocs-material, and the reference of the public headers with doxygen.

    build.py OUT      writes the pages as they are given to mkdocs to OUT/pages, and the site to OUT/site

README.md is the front page. A link to a source file leads to a page that shows the file.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PROJECT = HERE.parent.parent
sys.path.insert(0, str(PROJECT / "tests" / "pages"))
from blocks import LINK  # noqa: E402  pylint: disable=wrong-import-position

# Where pages outside of docs are on the site.
MOVED = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md",
         "tests/defects/README.md": "defects.md", "tests/fuzz/README.md": "fuzzers.md",
         "tests/data/README.md": "recordings.md", "LICENSE": "source/LICENSE.md"}
LANGUAGES = {".c": "c", ".cpp": "cpp", ".hpp": "cpp", ".py": "python", ".sh": "bash", ".json": "json", ".cmake": "cmake"}


class Pages:
    """The pages of the site, and the source files that they link to."""

    def __init__(self, out):
        self.out = out
        self.sources = []

    def place(self, path):
        """Where a file of the project is among the pages; a source file gets a page of its own."""
        name = path.relative_to(PROJECT).as_posix()
        if name in MOVED and not name == "LICENSE":
            return MOVED[name]
        if name.startswith("docs/") and path.suffix in (".md", ".svg"):
            return name.removeprefix("docs/")
        if "/include/splinecast/" in name:
            return f"api/{path.stem.replace('_', '__')}_8hpp.html"
        if name == "ipc/include/splinecast.h":
            return "api/splinecast_8h.html"
        if path not in self.sources:
            self.sources.append(path)
        return f"source/{name}/index.md" if path.is_dir() else f"source/{name}.md"

    def relinked(self, text, page, place):
        """The text of a page with links that lead to the places on the site."""
        def target(match):
            name, hash_, anchor = match.group(1).partition("#")
            if not name or re.match(r"[a-z]+:", name):
                return match.group(0)
            to = self.place((page.parent / name).resolve())
            return match.group(0).replace(f"({match.group(1)})", f"({os.path.relpath(to, Path(place).parent)}{hash_}{anchor})")
        code = r"^ *```+.*?^ *```+ *$|`(?:[^`\n]|\n(?!\n))+`"
        return re.sub(f"{LINK.pattern}|{code}", lambda match: target(match) if match.group(1) else match.group(0), text,
                      flags=re.S | re.M)

    def add(self, path):
        """Adds a page or a picture."""
        place = self.place(path)
        to = self.out / place
        to.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md":
            to.write_text(self.relinked(path.read_text(encoding="utf-8"), path, place), encoding="utf-8")
        else:
            shutil.copy(path, to)

    def add_source(self, path):
        """Adds the page of a source file, or of a folder."""
        name = path.relative_to(PROJECT).as_posix()
        to = self.out / self.place(path)
        to.parent.mkdir(parents=True, exist_ok=True)
        if path.is_dir():
            files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", name], cwd=PROJECT, check=True,
                                   capture_output=True, text=True).stdout.split()
            lines = "".join(f"- `{file}`\n" for file in files)
            to.write_text(f"# {name}\n\n{lines}", encoding="utf-8")
        else:
            language = LANGUAGES.get(path.suffix, "text")
            to.write_text(f"# {name}\n\n``````{language}\n{path.read_text(encoding='utf-8')}\n``````\n", encoding="utf-8")


def main():
    """Builds pages, reference and site."""
    out = Path(sys.argv[1]).resolve()
    shutil.rmtree(out, ignore_errors=True)
    pages = Pages(out / "pages")
    for path in [PROJECT / name for name in MOVED if name != "LICENSE"] + sorted((PROJECT / "docs").rglob("*")):
        if path.suffix in (".md", ".svg"):
            pages.add(path)
    for path in pages.sources:
        pages.add_source(path)
    shutil.copy(HERE / "extra.css", out / "pages" / "extra.css")
    subprocess.run(["doxygen", str(HERE / "Doxyfile")], cwd=PROJECT, check=True,
                   env=os.environ | {"SPLINECAST_API": str(out / "pages" / "api")})
    shutil.copy(HERE / "mkdocs.yml", out / "mkdocs.yml")
    subprocess.run(["mkdocs", "build", "--quiet", "--strict", "-f", str(out / "mkdocs.yml")], check=True)
    print(out / "site" / "index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
