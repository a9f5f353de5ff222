# SPDX-License-Identifier: Apache-2.0
"""Runs the commands that make pages, in this process: they are Python, and what they draw with takes a second to load."""

import contextlib
import importlib.util
import io
import math
import os
import re
import sys
from html.parser import HTMLParser
from pathlib import Path

import harness

NEEDED = ("matplotlib", "jinja2", "pandas")
SYSTEM = "/usr/bin/python3"

# Another Python that comes first on the PATH knows nothing of the distribution's packages.
if not all(importlib.util.find_spec(name) for name in NEEDED):
    if os.path.exists(SYSTEM) and not os.environ.get("GAZETRACE_TESTS_TRIED"):
        os.execve(SYSTEM, [SYSTEM, "-B", *sys.argv], {**os.environ, "GAZETRACE_TESTS_TRIED": "1"})
    print("skipped: reports need", ", ".join(NEEDED))
    sys.exit(77)

sys.path.insert(0, str(harness.SOURCE / "python"))
os.environ["PATH"] = f"{Path(harness.PROGRAM).resolve().parent}{os.pathsep}{os.environ['PATH']}"

from gazetrace_report.errors import EXIT_CODES, Error  # noqa: E402


class Page(HTMLParser):
    """Texts of scripts by their id, everything that could lead out of the page, the tables as lists of rows, also by their
    captions, and the headline."""

    def __init__(self, text):
        super().__init__()
        self.scripts, self.links, self.tables, self.open_script, self.cell = {}, [], [], None, None
        self.captioned, self.headline, self.paragraph, self.paragraph_kind = {}, "", None, ""
        self.text = text
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "script":
            self.open_script = attributes.get("id", "")
        elif tag == "p":
            self.paragraph, self.paragraph_kind = "", attributes.get("class", "")
        elif tag == "table":
            self.tables.append([])
            self.captioned[self.caption] = self.tables[-1]
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("th", "td"):
            self.cell = ""
        elif tag == "small" and self.cell is not None:
            self.cell += "|"
        self.links += [attributes[name] for name in ("src", "href", "srcset", "action") if name in attributes]

    def handle_endtag(self, tag):
        if tag == "script":
            self.open_script = None
        elif tag == "p":
            if self.paragraph_kind in ("caption", "headline"):
                setattr(self, self.paragraph_kind, self.paragraph)
            self.paragraph = None
        elif tag in ("th", "td"):
            self.tables[-1][-1].append(self.cell.strip())
            self.cell = None

    def handle_data(self, data):
        if self.open_script is not None:
            self.scripts[self.open_script] = self.scripts.get(self.open_script, "") + data
        if self.cell is not None:
            self.cell += data
        if self.paragraph is not None:
            self.paragraph += data


class ReportTest(harness.CliTest):
    def report(self, main, *words):
        """Output, messages and exit code of a command, in the test's folder."""
        out, err, here = io.StringIO(), io.StringIO(), os.getcwd()
        os.chdir(self.folder)
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                try:
                    code = main([str(word) for word in words])
                except Error as problem:
                    print(f"gazetrace: error: {problem}", file=sys.stderr)
                    code = EXIT_CODES[problem.kind]
                except SystemExit as left:
                    code = left.code
        finally:
            os.chdir(here)
        return out.getvalue(), err.getvalue(), code

    def made(self, main, *words):
        out, err, code = self.report(main, *words)
        self.assertEqual(code, 0, f"{words}\n{out}\n{err}")
        return out, err

    def refused(self, main, words, said, code=2):
        before = set(self.files())
        out, err, got = self.report(main, *words)
        self.assertEqual(got, code, f"{words}\n{out}\n{err}")
        self.assertEqual(len(err.splitlines()), 1, err)
        for word in said:
            self.assertIn(word.lower(), err.lower())
        self.assertEqual(out, "")
        self.assertEqual(set(self.files()), before)

    def assert_shows(self, text, value, digits=4):
        """A figure of a page, or a dash for none, is the value to so many digits."""
        if value is None:
            self.assertEqual(text, "–")
            return
        figure, _, unit = text.partition(" ")
        shown = float(figure) * {"": 1, "k": 1e3, "M": 1e6, "G": 1e9}[unit]
        last_digit = 10.0 ** (math.floor(math.log10(abs(value))) - digits + 1) if value else 0
        self.assertLessEqual(abs(shown - value), 0.5001 * last_digit, f"{text} for {value}")

    def assert_shows_estimate(self, text, value):
        """A mean, and below it the interval, which may be marked as unresolved in its place."""
        value = value or {"mean": None}
        mean, _, between = text.partition("|")
        self.assert_shows(mean, value["mean"])
        if value["mean"] is None or value.get("low") is None:
            self.assertEqual(between, "")
        elif not value.get("resolved", True):
            self.assertEqual(between, "unresolved")
        else:
            for shown, bound in zip(between.split(" to "), (value["low"], value["high"]), strict=True):
                self.assert_shows(shown, bound)

    def assert_stands_alone(self, text):
        for link in Page(text).links:
            self.assertRegex(link, r"^(#|data:)")
        self.assertFalse(re.findall(r"url\((?!#)[^)]{,40}|@import", text))
        self.assertLessEqual(set(re.findall(r"https?://[^\"<> \\\\]+", text)), {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"})


def main():
    harness.main()
