# SPDX-License-Identifier: Apache-2.0
"""Options that do nothing beside the others say so, and those that do something say nothing."""

import base64
import json
import struct

import harness

# Ten pixels a degree, so that density models have something to save, and nothing is said of that.
AT = [*harness.SCREEN, "--size", "640x360", "--gaze-at", "0.4,0.5"]


class IdleOptions(harness.CliTest):
    def setUp(self):
        super().setUp()
        self.write("log.csv", harness.moving_gaze())

    def warnings(self, *arguments):
        lines = self.run_ok("plan", "--counts", "--json", *arguments).stderr.splitlines()
        lines = [line for line in lines if not line.startswith(("replaced ", "sampling: "))]  # decisions, which config_test.py looks at
        for line in lines:
            self.assertTrue(line.startswith("gazetrace: warning: "), line)
        return [line.removeprefix("gazetrace: warning: ") for line in lines]

    def counts(self, *arguments):
        frame = json.loads(self.run_ok("plan", "--counts", "--json", *arguments).stdout)[0]
        return frame["traced_samples"], frame["regions"]

    def test_what_does_nothing_is_said(self):
        for options, others in (
            (["--accumulate-past", "0.2s"], ["--accumulate", "off"]),
            (["--accumulate-future", "0.2s"], ["--accumulate", "off"]),
            (["--block-samples", "4"], ["--sampling", "regions"]),
            (["--max-block", "4"], ["--sampling", "regions"]),
            (["--max-block", "4"], ["--sampling", "uniform"]),
            (["--region-samples", "4,4,4"], ["--density", "mar"]),
            (["--region-eccentricities", "2,5"], ["--density", "mar"]),
            (["--gaze-latency", "20ms"], []),
            (["--exposure-key", "0.3"], ["--exposure", "0"]),
        ):
            with self.subTest(options=options, others=others):
                said = self.warnings(*AT, *others, *options)
                self.assertEqual(len(said), 1, said)
                self.assertTrue(said[0].startswith(f"{options[0]} does nothing with"), said)

    def test_what_does_something_is_not(self):
        for options in (
            [],
            ["--accumulate", "window", "--accumulate-past", "0.2s", "--accumulate-future", "0s"],
            ["--density", "mar", "--block-samples", "4", "--max-block", "4"],
            ["--region-samples", "4,4,4"],
            ["--density", "csf:eye=left,luminance=20,relative-to=fovea"],
            ["--exposure", "auto", "--exposure-key", "0.3"],
            ["--preset", "paper", "--density", "mar"],  # a preset's settings are not the user's
        ):
            with self.subTest(options=options):
                self.assertEqual(self.warnings(*AT, *options), [])
        # What --print-config wrote holds every option, and says nothing new.
        self.write("all.toml", self.run_ok("render", *AT, "--density", "mar", "--max-block", "4", "--print-config").stdout)
        self.assertEqual(self.warnings("--config", "all.toml"), [])

    def test_without_gaze_all_frames_are_uniform(self):
        eyeless = [*harness.SCREEN, "--size", "64x36"]
        for options in (
            ["--density", "mar"], ["--density", "acuity"], ["--region-samples", "4,4,4"], ["--region-blocks", "4,8"], ["--region-eccentricities", "3,10"],
            ["--block-samples", "4"], ["--max-block", "4"],
        ):
            with self.subTest(options=options):
                self.assertEqual(self.warnings(*eyeless, *options), [f"there is no gaze, and without it {options[0]} does nothing: give --gaze or --gaze-at"])
                self.assertEqual(self.counts(*eyeless, *options), self.counts(*eyeless))
        both = self.run_ok("plan", *eyeless, "--eye", "0,0,3", "--target", "0,0,0", "--density", "linear", "--max-block", "4").stderr
        self.assertIn("without it --density, --max-block do nothing", both)
        # Uniform is what was asked for, and budgets are met everywhere.
        for options in ([], ["--sampling", "uniform"], ["--spp", "3"], ["--preset", "paper"]):
            with self.subTest(options=options):
                self.assertEqual(self.warnings(*eyeless, *options), [])

    def test_idle_options_do_nothing_indeed(self):
        def samples(*options):
            return json.loads(self.run_ok("plan", "--counts", "--json", *AT, *options).stdout)[0]["traced_samples"]

        self.assertEqual(samples(), samples("--block-samples", "2", "--max-block", "2"))

    def test_a_lost_pixel_filter_is_said(self):
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=1)))

        def said(scene, *options):
            return self.run_ok("render", scene, *AT, "--frames", "1", "--quiet", "--overwrite", "--env", "sky",
                               "-o", "out/f.png", *options).stderr

        lens = ["--aperture", "f/1.0", "--focus-distance", "1.5"]
        for filter in ("guided", "linear"):
            self.assertEqual(said("glide.gltf", "--filter", filter, "--shutter", "180deg", *lens), "")
        spread = ["--pixel-filter", "blackman-harris"]
        self.assertIn("--pixel-filter blackman-harris is missing there", said("box.gltf", "--filter", "guided", *spread))
        self.assertIn("--filter guided takes edges", said("box.gltf", *spread))
        self.assertEqual(said("box.gltf", "--filter", "linear", *spread), "")
        self.assertEqual(said("glide.gltf", "--filter", "guided"), "")
        self.assertEqual(said("box.gltf", "--filter", "guided", "--shutter", "180deg"), "")  # nothing moves

    def test_the_log_of_a_run_begins_with_one_line_on_sampling(self):
        logged = [*harness.SCREEN, "--size", "64x36", "--gaze", "log.csv", "--frames", "3"]
        eyeless = ["--size", "64x36"]
        for gaze, options, line in (
            (logged, [], "--density acuity: 2 samples a pixel in frame 3, 2 where the eye looks"),
            (logged, ["--sampling", "regions"], "--sampling regions: 1.37 samples a pixel in frame 3, 32 where the eye looks"),
            (logged, ["--sampling", "uniform"], "--sampling uniform: 32 samples a pixel everywhere, wherever the eye looks"),
            (logged, ["--sampling", "adaptive", "--spp", "4"], "--sampling adaptive: 4 samples a pixel on average, more where a pilot"),
            (logged, ["--sampling", "adaptive", "--target-relmse", "0.5"], "--sampling adaptive: as many samples as the stated quality takes"),
            (logged, ["--target-relmse", "0.5"], "adaptive, since a quality is stated"),
            (eyeless, [], "32 samples a pixel everywhere: there is no gaze"),
            (eyeless, ["--region-eccentricities", "5,10"], "32 samples a pixel everywhere: there is no gaze"),
            (eyeless, ["--sampling", "adaptive", "--spp", "4"], "--sampling adaptive: 4 samples a pixel on average, more where a pilot"),
        ):
            with self.subTest(options=options, gaze=gaze is logged):
                said = self.run_ok("render", "box.gltf", *gaze, *options, "--accumulate", "off", "-o", "f.exr", "--overwrite").stderr
                told = [line for line in said.splitlines() if not line.startswith("gazetrace: warning: ")]
                self.assertEqual(sum(line.startswith("sampling: ") for line in told), 1, said)
                self.assertTrue(told[0].startswith("sampling: " + line), said)

    def test_unknown_names(self):
        for option, text in (("--filter", "unknown filter 'x'; Known: none, linear"), ("--sampling", "unknown sampling 'x'; Known: regions"), ("--density", "unknown density 'x'; Known: acuity"),
                             ("--preset", "unknown preset 'x'; Known: paper")):
            self.assert_refused(["plan", "--counts", *AT, option, "x"], [text])
        self.write("x.toml", "qqqqqqqqqqqqqqqq = 1\n")
        line = self.assert_refused(["plan", "--counts", "--config", "x.toml"], ["unknown key 'qqqqqqqqqqqqqqqq'; 'gazetrace plan"])
        self.assertNotIn("Known", line)
        line = self.assert_refused(["plan", "--qqqqqqqqqqqqqqqq"], ["unknown option '--qqqqqqqqqqqqqqqq'; see"])
        self.assertNotIn("Known", line)


if __name__ == "__main__":
    harness.main()
