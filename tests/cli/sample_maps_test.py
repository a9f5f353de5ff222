# SPDX-License-Identifier: Apache-2.0
"""plan --write-sample-maps: where the samples go, for other renderers."""

import csv
import json
import math

import harness
from exr_reader import Exr

SIZE = (64, 36)
JOB = ["--size", "64x36", *harness.SCREEN, "--gaze-at", "0.25,0.5"]


class SampleMaps(harness.CliTest):
    def density(self, name):
        exr = Exr(self.folder / name)
        self.assertEqual(exr.types, {"Y": 2})  # floats
        return exr.channel("Y")

    def test_a_curve_is_written_as_it_is_stated(self):
        """Of a flat screen and a gaze at a pixel, eccentricity is the angle at the eye between two places of the screen."""
        self.write("curve.csv", "ecc_deg,density\n0,1\n10,0.8\n20,0.6\n30,0.4\n40,0.2\n50,0\n")
        screen = ["--screen-px", "64,36", "--screen-cm", "64,36", "--screen-distance-cm", "50"]  # a pixel is 1 cm
        self.run_ok("plan", "--size", "64x36", *screen, "--gaze-at", "0.5,0.5", "--density", "curve.csv", "--write-sample-maps", "map.exr")
        rows = self.density("map.exr")
        for y in (3, 17, 30):
            for x in (2, 20, 40, 61):
                degrees = math.degrees(math.atan(math.hypot(x + 0.5 - SIZE[0] / 2, y + 0.5 - SIZE[1] / 2) / 50))
                self.assertAlmostEqual(rows[y][x], 1 - degrees / 50, delta=1e-5)

    def test_regions_are_in_proportion_to_their_counts(self):
        self.run_ok("plan", *JOB, "--sampling", "regions", "--spp", "0.5", "--write-sample-maps", "map.exr")
        values = {round(value, 6) for row in self.density("map.exr") for value in row}
        self.assertEqual(values, {1, 16 / 4 / 32, 8 / 16 / 32})

    def test_each_frame_of_a_log_has_its_own_and_a_render_reads_them(self):
        self.write("log.csv", harness.moving_gaze())
        told = json.loads(self.run_ok("plan", "--size", "64x36", *harness.SCREEN, "--gaze", "log.csv", "--frames", "1-3", "--fps", "10", "--density",
                                      "linear", "--write-sample-maps", "maps/map.####.exr", "--json", "-").stdout)
        self.assertEqual(told["sample_maps"], [f"maps/map.{frame:04}.exr" for frame in (1, 2, 3)])
        maps = [self.density(name) for name in told["sample_maps"]]
        self.assertNotEqual(maps[0], maps[2])
        self.assertGreater(max(map(max, maps[0])), 0.9)
        self.run_ok("render", "box.gltf", "--size", "64x36", "--frames", "1-3", "--density", "maps/map.####.exr", "--spp", "2", "-o", "f.####.exr", "--quiet")
        with open(self.folder / "f.timing.csv", newline="") as file:
            for row in csv.DictReader(file):
                self.assertAlmostEqual(int(row["samples"]), 2 * SIZE[0] * SIZE[1], delta=1.1)

    def test_without_gaze_every_place_is_alike(self):
        self.run_ok("plan", "--size", "64x36", "--write-sample-maps", "map.exr")
        self.assertEqual({value for row in self.density("map.exr") for value in row}, {1})

    def test_what_cannot_be_written_is_refused_before_anything_is(self):
        self.write("map.0002.exr", b"mine")
        several = ["plan", *JOB, "--frames", "1-3"]
        self.assert_refused([*several, "--write-sample-maps", "map.####.exr"], ["map.0002.exr", "exists already"])
        self.assertFalse((self.folder / "map.0001.exr").exists())
        self.assert_refused([*several, "--write-sample-maps", "map.exr"], ["map.exr", "####"])
        self.assert_refused([*several, "--write-sample-maps", "map.####.png"], ["--write-sample-maps", "no name of an EXR"])
        self.assert_refused([*several, "--sampling", "adaptive", "--write-sample-maps", "map.####.exr"], ["--sampling", "pilot"])


if __name__ == "__main__":
    harness.main()
