# SPDX-License-Identifier: Apache-2.0
import importlib.util
import json
import unittest

import gazetrace
from support import COURTYARD, SCENE, TestCase

PLAN = """[common]
size = "32x18"
screen = "paper"
gaze-at = "0.5,0.5"
[[scene]]
name = "triangle"
path = "{scene}"
[grid]
region-samples = [[4, 2, 1]]
[reference]
spp = 4
[measure]
repeats = 2
reference-rate = 4
metrics = ["mse"]
baselines = ["none"]
controls = false
"""


class SweepTest(TestCase):
    def test_a_sweep_its_results_and_its_page(self):
        plan = self.folder / "plan.toml"
        plan.write_text(PLAN.format(scene=SCENE))
        told = []
        results = gazetrace.sweep(plan, self.folder / "out", frames=1, tell=told.append)
        self.assertTrue(told)
        raw = json.loads((self.folder / "out/results.json").read_text())
        self.assertEqual([row.id for row in results.rows], [row["id"] for row in raw["rows"]])
        self.assertIn(f"{len(raw['rows'])} runs", repr(results))
        if importlib.util.find_spec("pandas"):
            self.assertEqual(list(results.to_pandas()["mse"]), [row["scores"]["mse"]["whole"]["mean"] for row in raw["rows"]])
        if importlib.util.find_spec("matplotlib") and importlib.util.find_spec("jinja2"):
            self.assertIn("<html", gazetrace.report(results).read_text())
        self.assertSays("none.toml", "input", gazetrace.sweep, "none.toml", self.folder / "none")

    def test_the_reports_raise_the_librarys_error(self):
        self.assertSays("no such file", "input", gazetrace.report, self.folder / "none.json")


class OutlinesTest(TestCase):
    def test_outlines_of_a_job(self):
        outlines = gazetrace.Job(scene=COURTYARD, camera="walk", size=(32, 18), fps=2, frames=range(1, 3)).outlines()
        self.assertEqual([frame["frame"] for frame in outlines["frames"]], [1, 2])
        self.assertEqual(outlines["size_px"], [32, 18])
        self.assertIsNone(outlines["frames"][0]["t_log_ns"])
        self.assertTrue(outlines["frames"][0]["objects"][0]["polygons"])


if __name__ == "__main__":
    unittest.main()
