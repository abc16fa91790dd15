#!/usr/bin/env python3
"""Builds the site and opens pages of it in headless Chromium.

    site.py OUT      builds below OUT; exits with 77 if mkdocs, doxygen or chromium is missing

A page must show its text, its navigation, search and the switch between light and dark, search must find a word, and
nothing may be requested from another host.
"""

import functools
import http.server
import json
import re
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import blocks
from browser import Browser

# A page of the site, and what a browser must show of it.
SHOWN = [
    ("index.html", ["wait-free", "md-search", "verbs/fit.html"]),
    ("verbs/fit.html", ["Fit a spline to a file", "--method", "md-search"]),
    ("api/classsplinecast_1_1Reader.html", ["splinecast::Reader", "sample"]),
]
FOREIGN = re.compile(r"""(?:src|href)=["']?(?:https?:)?//(?!127\.0\.0\.1)[^"'> ]*\.(?:js|css|woff2?|png|svg)""")
SCHEME = "document.body.getAttribute('data-md-color-scheme')"


class Quiet(http.server.SimpleHTTPRequestHandler):
    """A server that writes no log."""

    def log_message(self, *_):  # pylint: disable=arguments-differ
        pass


def problems_in_browser(browser, site):
    """What pages do not show, or do not do."""
    for page, texts in SHOWN:
        if not browser.open(f"{site}/{page}"):
            yield f"{page}: does not load"
        document = browser.evaluate("document.documentElement.outerHTML")
        lacking = [text for text in texts if text not in document]
        if lacking:
            yield f"{page}: lacks {lacking}:\n{document[:2000]}"
    browser.open(f"{site}/index.html")
    schemes = [browser.evaluate(SCHEME)]
    browser.evaluate("document.querySelectorAll('[data-md-component=palette] input')[1].click()")
    schemes.append(browser.evaluate(SCHEME))
    if schemes != ["default", "slate"]:
        yield f"index.html: the switch from light to dark leads to {schemes}"
    found = "document.querySelectorAll('.md-search-result__item').length"
    browser.open(f"{site}/index.html?q=quaternion")
    if not browser.wait_for(f"{found} > 0"):
        yield f"search finds no page with the word quaternion, {browser.evaluate(found)} in all"
    loaded = json.loads(browser.evaluate("JSON.stringify(performance.getEntriesByType('resource').map(e => e.name))"))
    yield from (f"index.html: loads {name}" for name in loaded if not name.startswith(f"{site}/"))


def main():
    """Builds the site and looks at its pages."""
    missing = [tool for tool in ("mkdocs", "doxygen", "chromium") if not shutil.which(tool)]
    if missing:
        print(f"missing: {', '.join(missing)} (Debian: mkdocs-material doxygen chromium)")
        return 77
    subprocess.run([blocks.PROJECT / "docs" / "site" / "build.py", sys.argv[1]], check=True)
    site = Path(sys.argv[1]).resolve() / "site"
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=site))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with Browser() as browser:
        problems = list(problems_in_browser(browser, f"http://127.0.0.1:{server.server_port}"))
    for file in site.rglob("*.html"):
        foreign = FOREIGN.search(file.read_text(encoding="utf-8"))
        if foreign:
            problems.append(f"{file.relative_to(site)}: loads {foreign.group(0)}")
    server.shutdown()
    print("\n".join(problems + [f"{len(SHOWN)} pages opened, {len(problems)} problems"]))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
