# SPDX-License-Identifier: Apache-2.0
"""Lens and shutter from outside: what a frame says of them, and what is refused."""

import json
import math

import harness


class Lens(harness.CliTest):
    def header(self, *options):
        """The text of the first frame's header, rendered with these options."""
        self.run_ok("render", self.scene, "-o", "out/f.####.exr", "--frames", "1", "--fps", "10", "--size", "16x9", "--spp", "1",
                    "--quiet", *options)
        data = (self.folder / "out" / "f.0001.exr").read_bytes()
        return data[:8192].decode("latin-1")

    def setUp(self):
        super().setUp()
        self.scene = self.write("moving.gltf", json.dumps(harness.box_gltf(camera_seconds=1)))

    def test_f_number(self):
        text = self.header("--aperture", "f/2", "--sensor-height", "24", "--focus-distance", "4")
        focal_length_m = 0.024 / (2 * math.tan(0.8 / 2))
        radius = float(text.split("aperture_radius_m=")[1].split()[0])
        self.assertAlmostEqual(radius, focal_length_m / 4, delta=1e-9)
        self.assertIn("focus_distance_m=4", text)

    def test_radius_in_metres(self):
        self.assertIn("aperture_radius_m=0.05 ", self.header("--aperture", "0.05", "--focus-distance", "4"))

    def test_pinhole_says_nothing(self):
        text = self.header()
        self.assertNotIn("aperture", text)
        self.assertNotIn("shutter_ns", text)

    def test_shutter(self):
        # Half of the first frame's 100 ms, about their middle; and a stated part.
        self.assertIn("25000000,75000000", self.header("--shutter", "180deg"))
        self.assertIn("0,40000000", self.header("--shutter", "0,0.4", "--overwrite"))

    def test_bad_values_are_one_line(self):
        for options, word in (
            (("--aperture", "f/2"), "--focus-distance"),
            (("--aperture", "f/0", "--focus-distance", "1"), "--aperture"),
            (("--aperture", "f/x", "--focus-distance", "1"), "f-number"),
            (("--aperture", "-1", "--focus-distance", "1"), "-1"),
            (("--aperture", "f/2", "--focus-distance", "0"), "focus"),
            (("--shutter", "400deg"), "400deg"),
            (("--shutter", "0.75,0.25"), "0.75,0.25"),
            (("--shutter", "nan"), "nan"),
        ):
            with self.subTest(options=options):
                self.assert_refused(("render", self.scene, "-o", "bad/f.exr", "--frames", "1", "--size", "16x9", *options), [word])


if __name__ == "__main__":
    harness.main()
