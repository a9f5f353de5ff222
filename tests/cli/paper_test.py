# SPDX-License-Identifier: Apache-2.0
"""examples/paper.py, small: the counts of the source paper's radii, and a page that is whole."""

import re
import subprocess
import sys
import unittest

import harness


@unittest.skipUnless((harness.SHARED / "scenes/sponza/Sponza.gltf").is_file(), "Sponza is not here")
class Paper(harness.CliTest):
    def test_the_page_of_the_authors_views(self):
        (self.folder / "data").mkdir()
        (self.folder / "data/sponza").symlink_to(harness.SHARED / "scenes/sponza")
        (self.folder / "data/kiara_1_dawn_1k.hdr").symlink_to(harness.SHARED / "hdri/kiara_1_dawn_1k.hdr")
        words = ["--data", "data", "--program", harness.PROGRAM, "--size", "64x36", "--seconds", "0", "--error-size", "64x36",
                 "--reference-spp", "16", "--seeds", "1", "--scenes", "sponza", "-o", "page.md"]
        done = subprocess.run([sys.executable, "-B", str(harness.SOURCE / "examples/paper.py"), *words], cwd=self.folder,
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        page = (self.folder / "page.md").read_text()
        # Discs of 148 and 482 pixels about the middle of 3840 x 2160, whose areas pixel centres meet to some parts of 10^4.
        inner, outer = 3.14159265 * 148**2, 3.14159265 * 482**2
        rows = re.findall(r"^\| sponza \| (\d+)/(\d+)/(\d+) \| (\d+) \| (\d+) \| (\d+) \| ([\d.]+) \| ([\d.]+) \|$", page, re.MULTILINE)
        self.assertEqual([row[:3] for row in rows], [("32", "16", "8"), ("32", "8", "4"), ("32", "4", "2"), ("32", "2", "1")])
        for row in rows:
            a, b, c, fovea, ring, rest, nominal, traced = map(float, row)
            self.assertEqual(fovea + ring + rest, 3840 * 2160)
            self.assertAlmostEqual(fovea / inner, 1, delta=1e-3)
            self.assertAlmostEqual((fovea + ring) / outer, 1, delta=1e-3)
            expected = 3840 * 2160 * 32 / (inner * a + (outer - inner) * b / 4 + (3840 * 2160 - outer) * c / 16)
            self.assertAlmostEqual(nominal / expected, 1, delta=1e-3)
            self.assertAlmostEqual(traced / nominal, 1, delta=1e-2)
        for word in ("25.5", "constant in each block", "the default"):
            self.assertIn(word, page)
        missing = subprocess.run([sys.executable, "-B", str(harness.SOURCE / "examples/paper.py"), *words, "--scenes", "san-miguel"],
                                 cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(missing.returncode, 2)
        self.assertIn("san-miguel.gltf is not there", missing.stderr)


if __name__ == "__main__":
    harness.main()
