# SPDX-License-Identifier: Apache-2.0
"""Every tutorial runs, small, and becomes a page with pictures; what they promise of their length holds."""

import contextlib
import importlib.util
import io
import os
import re
import sys
import unittest

import numpy as np

import gazetrace
from support import COURTYARD, ROOT, TestCase

TUTORIALS = sorted((ROOT / "docs/tutorials").glob("*.py"))
HAS_ALL = all(importlib.util.find_spec(name) for name in ("matplotlib", "jinja2", "pandas"))

if HAS_ALL:
    sys.path.append(str(ROOT / "python/tools"))
    import make_tutorials


def statements(source):
    return [line for line in source.splitlines() if line.strip() and not line.lstrip().startswith(("#", '"""'))]


@unittest.skipUnless(HAS_ALL, "matplotlib, jinja2 or pandas is not installed")
class TutorialTest(TestCase):
    def setUp(self):
        super().setUp()
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)  # with what tutorials read; what they write stays here
        for name in ("docs", "examples", "gazelogs", "scenes"):
            (self.folder / name).symlink_to(ROOT / name)

    def code_of(self, name):
        cells = make_tutorials.cells_of((ROOT / "docs/tutorials" / name).read_text(encoding="utf-8"))
        return [source for kind, _, source in cells if kind == "code"]

    def test_all_of_them(self):
        self.assertGreaterEqual(len(TUTORIALS), 4)
        for path in TUTORIALS:
            with self.subTest(path.name):
                pictures = make_tutorials.page_of(path, self.folder, small=True)
                page = (self.folder / f"{path.stem}.md").read_text(encoding="utf-8")
                shown = re.findall(r"!\[\]\((.+)\)", page)
                self.assertGreaterEqual(pictures, 1)
                self.assertEqual(len(shown), pictures)
                for picture in shown:
                    self.assertGreater((self.folder / picture).stat().st_size, 1000, picture)
                self.assertTrue(page.startswith("# "))
                self.assertNotIn("# small:", page)
                for link in re.findall(r"\]\((\.\.?/?[^)]*|\w+\.py)\)", page):
                    self.assertTrue((ROOT / "docs/tutorials" / link).exists(), link)

    def test_the_manual_says_what_runs(self):
        """The code of docs/python.md, in order and small."""
        for name in ("uniform", "gaze"):
            gazetrace.Job(scene=COURTYARD, camera="walk", gaze="gazelogs/tx300_left.csv", size=(32, 18), fps=10, frames=range(1, 4), spp=1,
                          output=f"out/{name}/frame.####.exr").run()
        text = (ROOT / "docs/python.md").read_text(encoding="utf-8")
        blocks = re.findall(r"(<!--[^\n]*-->\n)?```python\n(.*?)```", text, re.S)
        names = {}
        for skipped, code in blocks:
            if not skipped:
                with contextlib.redirect_stdout(io.StringIO()):
                    exec(code.replace("(640, 360)", "(32, 18)").replace("range(1, 25)", "range(1, 4)").replace("spp=64", "spp=1"), names)
        self.assertGreaterEqual(len([1 for skipped, _ in blocks if not skipped]), 3)
        self.assertIsInstance(names["fixations"], gazetrace.Events)
        # What the tables name is there.
        plan, frame = names["plan"], names["frame"]
        named = re.findall(r"`((?:plan|frame)[.\[][^`]*)`", text)
        self.assertGreater(len(named), 15)
        for code in named:
            if "matte" not in code and not code.endswith((".csv", ".json")):  # of layers, and files
                eval(code, {"plan": plan, "frame": frame, "row": 0})

    def test_fifteen_lines(self):
        self.assertLessEqual(len(statements(*self.code_of("fifteen_lines.py"))), 15)

    def test_the_reader_has_twenty_lines(self):
        """Every pixel's middle lies in one rectangle of the object that is behind it, and in none of another."""
        source = next(source for source in self.code_of("objects_under_gaze.py") if "def rectangles" in source)
        names = {"pandas": importlib.import_module("pandas"), "outlines": {"frames": [], "size_px": [1, 1], "frame_on_display_px": None}}
        exec(source, names)
        function = source[source.index("def rectangles"):source.index("areas =")]
        self.assertLessEqual(len(statements(function)), 20)
        outlines = gazetrace.Job(scene=COURTYARD, camera="walk", size=(64, 36), fps=2, frames=range(1, 4)).outlines()
        covered = np.zeros((4, 36, 64), int)
        for one in names["rectangles"](outlines):
            left, top, right, bottom = (one[key] for key in ("start_x", "start_y", "end_x", "end_y"))
            covered[one["frame"], int(top):int(bottom), int(left):int(right)] += 1
        self.assertEqual(covered.max(), 1)
        for frame in outlines["frames"]:
            self.assertEqual(covered[frame["frame"]].sum(), sum(one["pixels"] for one in frame["objects"]))

    @unittest.skipUnless(importlib.util.find_spec("pymovements"), "pymovements is not installed")
    def test_pymovements_finds_the_same_objects(self):
        outlines, _, *others = self.code_of("objects_under_gaze.py")
        names = {}
        for source in (outlines.replace("size, frames = (320, 180)", "size, frames = (96, 54)"), *others[:3]):
            exec(source, names)
        theirs = {row["onset"]: row["object"] for row in names["looks"].frame.iter_rows(named=True)}
        ours = dict(zip(names["hits"].onset, names["hits"].object))
        self.assertGreater(len(ours), 5)
        self.assertEqual({onset: name for onset, name in theirs.items() if name}, ours)


if __name__ == "__main__":
    unittest.main()
