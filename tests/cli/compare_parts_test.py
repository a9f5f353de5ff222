# SPDX-License-Identifier: Apache-2.0
"""`gazetrace compare` of sequences that were rendered in parts: merged they are compared as the one run's would be."""

import json

import harness

JOB_TOML = """
scene = "glide.gltf"
gaze = "log.csv"
size = "64x36"
fps = 24
region-samples = [8, 2, 1]
region-eccentricities = [2, 4.5]  # diameters
filter = "linear"
exposure = "0"
screen-px = [64, 36]
screen-cm = [64, 36]
screen-distance-cm = 60
quiet = true
"""


class CompareParts(harness.CliTest):
    more = ()  # of compare

    def setUp(self):
        super().setUp()
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=1.0)))
        self.write("log.csv", harness.moving_gaze())
        self.write("job.toml", JOB_TOML)
        self.render("ref", "--frames", "1-4", "--sampling", "uniform", "--spp", "16", "--seed", "9")

    def render(self, folder, *more):
        self.run_ok("render", "--config", "job.toml", "-o", f"{folder}/p.####.exr", "-o", f"{folder}/p.####.png", *more)

    def compare(self, reference, test, suffix="exr"):
        self.run_ok("compare", f"{reference}/p.####.{suffix}", f"{test}/p.####.{suffix}", "--metrics", "mse,flip", "--json",
                    "out.json", "--overwrite", *self.more)
        result = json.loads((self.folder / "out.json").read_text())
        self.assertEqual(result["conditions"].pop("reference"), f"{reference}/p.####.{suffix}")
        self.assertEqual(result["conditions"].pop("test"), f"{test}/p.####.{suffix}")
        return result

    def assert_compared_as_one(self, whole, parts):
        """On either side, of light and of display images: what the record knew, and every score."""
        for suffix in ("exr", "png"):
            one = self.compare("ref", whole, suffix)
            self.assertEqual(one["conditions"]["regions"], "fovea to 2 deg, intermediate to 4.5 deg of eccentricity")
            self.assertEqual(one["conditions"]["frame rate"], "24")
            self.assertIn("64x36 px", one["conditions"]["screen"])
            self.assertEqual([frame["frame"] for frame in one["frames"]], [1, 2, 3, 4])
            self.assertEqual(self.compare("ref", parts, suffix), one, suffix)
            self.assertEqual(self.compare(parts, "ref", suffix), self.compare(whole, "ref", suffix), suffix)
        # What was shown through another view is refused, which the record tells, too.
        self.render("other", "--frames", "1-4", "--preset", "paper")
        self.assert_refused(["compare", f"{parts}/p.####.png", "other/p.####.png"], ["was shown through", "--anyway"])

    def test_parts_of_the_frames(self):
        self.render("whole", "--frames", "1-4")
        for frames in ("3-4", "1-2"):
            self.render("parts", "--frames", frames, "--chunk", "1/1")
        # No record is yet of all of them: the regions of the test are not known.
        self.assertIn("fovea to 2.6 deg", self.compare("ref", "parts")["conditions"]["regions"])
        self.run_ok("merge", "parts")
        self.assert_compared_as_one("whole", "parts")

    def test_pictures_of_another_run_are_not_the_record_s(self):
        for frames in ("3-4", "1-2"):
            self.render("parts", "--frames", frames, "--chunk", "1/1")
        self.run_ok("merge", "parts")
        self.assertIn("fovea to 2 deg", self.compare("ref", "parts")["conditions"]["regions"])
        # Others may lie beside it, damaged ones, too.
        (self.folder / "parts/p.run.json").rename(self.folder / "parts/z.run.json")
        self.write("parts/a.run.json", "{")
        self.assertIn("fovea to 2 deg", self.compare("ref", "parts")["conditions"]["regions"])
        (self.folder / "parts/z.run.json").rename(self.folder / "parts/p.run.json")
        self.render("other", "--frames", "1-4", "--region-eccentricities", "3,6")
        for name, content in self.pictures("other").items():
            (self.folder / "parts" / name).write_bytes(content)
        self.assertNotIn("fovea to 2 deg", self.compare("ref", "parts")["conditions"]["regions"])


if __name__ == "__main__":
    harness.main()
