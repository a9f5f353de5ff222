# SPDX-License-Identifier: Apache-2.0
"""plan --counts against the numbers of the source paper and what follows from them by arithmetic.

Display 3840 x 2160 px, 70.848 x 39.852 cm, at 60 cm; regions of 5.2 and 17 degrees; 32 samples a pixel as the reference.
"""

import json
import os
import subprocess

import harness

SCREEN = ["--screen-px", "3840,2160", "--screen-cm", "70.848,39.852", "--screen-distance-cm", "60", "--size", "3840x2160"]
CENTER, CORNER = "0.5,0.5", "0,0"
# (shape, reading, gaze): pixels of the three regions, ratios for 32/16/8, 32/8/4, 32/2/1 samples a block (None: not stated)
EXPECTED = {
    ("regions:shape=disc", "2.6,8.5", CENTER): ((68488, 673600, 7552312), (30.64, 48.91, 88.46)),
    ("regions:shape=disc-by-radius", "5.2,17", CENTER): ((273988, 2694376, 5326036), (11.95, 17.14, 25.40)),
    ("regions:shape=disc", "2.6,8.5", CORNER): ((17122, 168400, 8108878), (50.31, 91.15, 233.05)),
    ("regions:shape=disc-by-radius", "5.2,17", CORNER): ((68497, 673594, 7552309), (30.64, 48.91, 88.45)),
    ("regions", "5.2,17", CENTER): ((275180, 2830344, 5188876), (11.68, 16.84, 25.17)),
    ("regions", "5.2,17", CORNER): ((120721, 973251, 7200428), (23.37, 34.88, 55.30)),
    ("regions", "2.6,8.5", CORNER): ((31606, 274269, 7988525), (43.49, 74.62, 161.07)),
}
TAUS = ("32,16,8", "32,8,4", "32,2,1")


class Counts(harness.CliTest):
    def counts(self, *arguments):
        return json.loads(self.run_ok("plan", "--counts", "--json", *SCREEN, *arguments).stdout)

    def test_regions_and_nominal_ratios(self):
        for (sampling, ends, gaze), (pixels, ratios) in EXPECTED.items():
            for taus, ratio in zip(TAUS, ratios):
                with self.subTest(sampling=sampling, ends=ends, gaze=gaze, taus=taus):
                    frame = self.counts("--sampling", sampling, "--region-eccentricities", ends, "--gaze-at", gaze,
                                        "--region-samples", taus)[0]
                    self.assertEqual([region["pixels"] for region in frame["regions"]], list(pixels))
                    self.assertEqual(f"{frame['nominal_ratio']:.2f}", f"{ratio:.2f}")
                    samples = [int(tau) for tau in taus.split(",")]
                    nominal = sum(tau / block**2 * count for tau, block, count in zip(samples, (1, 2, 4), pixels))
                    self.assertAlmostEqual(frame["nominal_samples"], nominal, delta=1e-6)
                    self.assertEqual(frame["traced_samples"], sum(region["traced_samples"] for region in frame["regions"]))
                    # Straddling blocks add sites: a little more is traced, never less.
                    self.assertGreaterEqual(frame["traced_samples"], nominal)
                    self.assertLess(frame["traced_samples"], 1.02 * nominal)

    def test_long_plans_take_little_memory(self):
        # The peak is that of the whole plan: a kilobyte a frame, and nothing for its text but that of the table.
        def peak_of(frames, *more):
            with open(os.devnull, "wb") as nowhere:
                run = subprocess.Popen([harness.PROGRAM, "plan", "--eye", "0,0,0", "--target", "0,0,-1", "--gaze-at",
                                        "0.5,0.5", *SCREEN, "--frames", frames, *more], stdout=nowhere)
                _, status, usage = os.wait4(run.pid, 0)
                run.returncode = status
            self.assertEqual(status, 0)
            return usage.ru_maxrss * 1024

        for more in ([], ["--json"]):
            self.assertLess(peak_of("1-51000", *more) - peak_of("1-1000", *more), 50000 * 1350, more)
        self.assert_refused(["plan", "--eye", "0,0,0", "--target", "0,0,-1", "--frames", "1-2000000"],
                            "makes more than 1000000 frames")

    def test_samples_per_pixel(self):
        for taus, ratio in zip(TAUS, (3.62, 7.02, 23.93)):
            frame = self.counts("--sampling", "regions:shape=disc,unit=pixel", "--gaze-at", CENTER,
                                "--region-samples", taus)[0]
            self.assertEqual(f"{frame['nominal_ratio']:.2f}", f"{ratio:.2f}")

    def test_uniform(self):
        frame = self.counts("--gaze-at", CENTER, "--sampling", "uniform", "--spp", "4")[0]
        self.assertEqual((frame["traced_samples"], frame["nominal_ratio"]), (3840 * 2160 * 4, 1.0))

    def test_table(self):
        text = self.run_ok("plan", "--counts", *SCREEN, "--gaze-at", CENTER, "--sampling", "regions:shape=disc").stdout
        for word in ("68488", "673600", "7552312", "30.64", "nominal", "traced"):
            self.assertIn(word, text)

    def test_along_a_log(self):
        self.write("log.csv", harness.moving_gaze())
        frames = self.counts("--gaze", "log.csv", "--frames", "1-3", "--gaze-transfer", "fraction")
        self.assertEqual([frame["frame"] for frame in frames], [1, 2, 3])
        self.assertEqual({sum(region["pixels"] for region in frame["regions"]) for frame in frames}, {3840 * 2160})


if __name__ == "__main__":
    harness.main()
