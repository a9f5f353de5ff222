# SPDX-License-Identifier: Apache-2.0
import importlib.util
import json
import os
import unittest

import gazetrace
from support import ROOT, TestCase

NOTEBOOK = ROOT / "examples/python/one-scene.ipynb"


class NotebookTest(TestCase):
    def test_has_no_output(self):
        for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]:
            self.assertFalse(cell.get("outputs"), cell["id"])

    @unittest.skipUnless(importlib.util.find_spec("pandas"), "pandas is not installed")
    def test_runs_at_a_small_size(self):
        before = os.getcwd()
        os.chdir(ROOT)
        self.addCleanup(os.chdir, before)
        names = {}
        for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]:
            if cell["cell_type"] == "code":
                source = "".join(cell["source"])
                exec(source.replace("size=(320, 180), frames=range(1, 7)", "size=(64, 36), frames=range(1, 3)"), names)
        self.assertEqual(len(names["result"].frames), 2)
        self.assertGreater(names["samples"] / names["fewer"], 1)
        self.assertIsInstance(names["frame"], gazetrace.Frame)


if __name__ == "__main__":
    unittest.main()
