# SPDX-License-Identifier: Apache-2.0
"""What the tests share: a small scene, and the program that was built with the package."""

import os
import subprocess
import tempfile
import unittest
import warnings
from pathlib import Path

import gazetrace

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "tests/data/package/triangle.gltf"
COURTYARD = ROOT / "scenes/courtyard/courtyard.gltf"
GAZE_LOG = ROOT / "gazelogs/saccades_blinks.csv"
PROGRAM = os.environ.get("GAZETRACE_PROGRAM", "")

needs_program = unittest.skipUnless(PROGRAM, "GAZETRACE_PROGRAM does not name the program")


class TestCase(unittest.TestCase):
    """With a folder of its own, and without the library's warnings in its output."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="gazetrace-test.")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        caught = warnings.catch_warnings()
        caught.__enter__()
        self.addCleanup(caught.__exit__, None, None, None)
        warnings.simplefilter("ignore", gazetrace.GazetraceWarning)

    def assertSays(self, words, kind, call, *arguments, **options):
        with self.assertRaises(gazetrace.Error) as raised:
            call(*arguments, **options)
        self.assertIn(words, str(raised.exception))
        self.assertEqual(raised.exception.kind, kind)


def small_job(**options):
    """A quick frame of a triangle, foveated at the middle of a screen."""
    given = {"scene": SCENE, "gaze_at": (0.5, 0.5), "screen": "paper", "size": (64, 36), "seed": 7}
    return gazetrace.Job(**{**given, **options})


def run_program(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True, text=True)
