# SPDX-License-Identifier: Apache-2.0
"""What is taken where nobody says it; with a gaze, it is not worse than as many samples spread evenly."""

import json
import statistics

import harness

EXAMPLE = ["--config", harness.SOURCE / "examples/example.toml", "--frames", "9-10", "--size", "160x90", "--fps", "10", "--quiet"]
SEEDS = (1, 2, 3, 4)
T_95 = 3.182  # Student's, two-sided, for three degrees of freedom


class Default(harness.CliTest):
    def render(self, name, *more):
        self.run_ok("render", *EXAMPLE, *more, "-o", f"{name}/f.####.exr", "--json", f"{name}.json", timeout=600)
        summary = json.loads((self.folder / f"{name}.json").read_text())
        return summary["samples"] / summary["pixels"]

    def jod(self, name):
        self.run_ok("compare", "truth/f.####.exr", f"{name}/f.####.exr", "--metrics", "fovvideovdp", "--anyway", "--csv", f"{name}.csv")
        lines = [line.split(",") for line in (self.folder / f"{name}.csv").read_text().splitlines() if not line.startswith("#")]
        at = lines[0].index("value")
        scores = [float(line[at]) for line in lines[1:] if line[lines[0].index("metric")] == "fovvideovdp"]
        self.assertTrue(scores)
        return statistics.mean(scores)

    def test_it_is_not_worse_than_uniform(self):
        self.render("truth", "--sampling", "uniform", "--spp", "64", "--filter", "none", "--accumulate", "off", "--seed", "99")
        gains = []
        for seed in SEEDS:
            traced = self.render(f"default{seed}", "--seed", str(seed))
            even = self.render(f"even{seed}", "--seed", str(seed), "--sampling", "uniform", "--spp", "2")
            self.assertAlmostEqual(traced, even, delta=0.01 * traced)  # those of the windows' other frames included
            gains.append(self.jod(f"default{seed}") - self.jod(f"even{seed}"))
        half = T_95 * statistics.stdev(gains) / len(gains) ** 0.5
        self.assertGreaterEqual(statistics.mean(gains) + half, 0, gains)


class WhatNobodySays(harness.CliTest):
    AT = [*harness.SCREEN, "--gaze-at", "0.4,0.5", "--fps", "24"]

    def told(self, *arguments):
        """What a plan says of the window and of the samples."""
        lines = self.run_ok("plan", *arguments).stderr.splitlines()
        return dict(line.split(": ", 1) for line in lines if line.startswith(("accumulate: window", "sampling: ")))

    def test_a_sequence_joins_and_a_still_does_not(self):
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=1)))
        self.write("gaze.csv", harness.moving_gaze())
        whole = "window: each frame joins 6 before it and 6 after it"  # 250 ms at 24 a second
        for frames in (["--frames", "1-3"], ["--frames", "2", "--chunk", "1/1"]):
            self.assertEqual(self.told("box.gltf", *self.AT, *frames).get("accumulate"), whole, frames)
        self.assertNotIn("accumulate", self.told("box.gltf", *self.AT))
        self.assertNotIn("accumulate", self.told("box.gltf", *self.AT, "--frames", "1"))
        # One frame of a sequence is that frame of it, whether the camera, the gaze or their lengths say that there is one.
        self.assertEqual(self.told("glide.gltf", *self.AT, "--frames", "5").get("accumulate"), whole)
        log = [*harness.SCREEN, "--gaze", "gaze.csv", "--fps", "24", "--frames", "5"]
        self.assertEqual(self.told("box.gltf", *log).get("accumulate"), whole)
        self.assertEqual(self.told("box.gltf", *log[:-1], "1", "--gaze-scale", "1e9").get("accumulate"), whole)
        self.assertNotIn("accumulate", self.told("glide.gltf", *self.AT, "--target-jod", "9"))

    def test_a_large_window_is_shortened_unless_its_time_is_given(self):
        for size, more, frames in (("3840x2160", [], (1, 1)), ("1920x1080", [], (3, 3)), ("960x540", [], (6, 6)),
                                   ("3840x2160", ["--accumulate-past", "125ms"], (3, 1))):
            told = self.told("box.gltf", *self.AT, "--frames", "1-3", "--size", size, *more)
            self.assertEqual(told["accumulate"], "window: each frame joins {} before it and {} after it".format(*frames), size)

    def test_what_is_said_of_regions_takes_regions(self):
        self.assertTrue(self.told("box.gltf", *self.AT)["sampling"].startswith("--density acuity: 2 samples a pixel"))
        self.assertTrue(self.told("box.gltf", *self.AT, "--region-samples", "8,4,2")["sampling"].startswith("--sampling regions: "))
        self.assertTrue(self.told("box.gltf", *self.AT, "--region-samples", "8,4,2", "--density", "mar")["sampling"]
                        .startswith("--density mar: 2 samples a pixel"))


if __name__ == "__main__":
    harness.main()
