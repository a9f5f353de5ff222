# SPDX-License-Identifier: Apache-2.0
"""Options that do nothing beside the others say so, and those that do something say nothing."""

import json

import harness

AT = [*harness.SCREEN, "--size", "64x36", "--gaze-at", "0.4,0.5"]


class IdleOptions(harness.CliTest):
    def setUp(self):
        super().setUp()
        self.write("log.csv", harness.moving_gaze())

    def warnings(self, *arguments):
        lines = self.run_ok("plan", "--counts", "--json", *arguments).stderr.splitlines()
        for line in lines:
            self.assertTrue(line.startswith("gazetrace: warning: "), line)
        return [line.removeprefix("gazetrace: warning: ") for line in lines]

    def test_what_does_nothing_is_said(self):
        reproject = ["--accumulate", "reproject"]
        for options, others in (
            (["--accumulate-blend", "0.2"], []),
            (["--accumulate-frames", "4"], []),
            (["--accumulate-clip", "1"], []),
            (["--accumulate-order", "before"], []),
            (["--accumulate-reset-saccades"], []),
            (["--accumulate-reset-blinks"], ["--accumulate", "running"]),
            (["--accumulate-reset-blinks"], reproject),
            (["--block-samples", "4"], []),
            (["--max-block", "4"], []),
            (["--density-floor", "0.1"], []),
            (["--density-floor", "0.1"], ["--falloff", "uniform"]),
            (["--border-blend-deg", "2"], ["--falloff", "uniform"]),
            (["--region-samples", "4,4,4"], ["--falloff", "mar"]),
            (["--gaze-latency", "20ms"], []),
            (["--gaze-uncertainty"], ["--falloff", "uniform", "--gaze-accuracy", "1", "--gaze-precision", "0"]),
        ):
            with self.subTest(options=options, others=others):
                said = self.warnings(*AT, *others, *options)
                self.assertEqual(len(said), 1, said)
                self.assertTrue(said[0].startswith(f"{options[0]} does nothing with"), said)

    def test_what_does_something_is_not(self):
        for options in (
            [],
            ["--accumulate", "reproject", "--accumulate-blend", "0.2", "--accumulate-order", "before"],
            ["--falloff", "mar", "--block-samples", "4", "--max-block", "4", "--density-floor", "0.1"],
            ["--border-blend-deg", "2", "--block-samples", "4"],
            ["--region-samples", "4,4,4"],
            ["--preset", "paper", "--falloff", "mar"],  # a preset's settings are not the user's
        ):
            with self.subTest(options=options):
                self.assertEqual(self.warnings(*AT, *options), [])
        # What --print-config wrote holds every option, and says nothing new.
        self.write("all.toml", self.run_ok("render", *AT, "--falloff", "mar", "--max-block", "4", "--print-config").stdout)
        self.assertEqual(self.warnings("--config", "all.toml"), [])

    def test_idle_options_do_nothing_indeed(self):
        def samples(*options):
            return json.loads(self.run_ok("plan", "--counts", "--json", *AT, *options).stdout)[0]["traced_samples"]

        self.assertEqual(samples(), samples("--block-samples", "2", "--max-block", "2", "--density-floor", "0.5"))
        uniform = ["--falloff", "uniform"]
        self.assertEqual(samples(*uniform), samples(*uniform, "--border-blend-deg", "5", "--gaze-uncertainty",
                                                    "--gaze-accuracy", "9", "--gaze-precision", "1"))

    def test_a_fixed_gaze_may_be_off_too(self):
        def samples(*options):
            return json.loads(self.run_ok("plan", "--counts", "--json", *AT, *options).stdout)[0]["traced_samples"]

        # As with regions that end 5 degrees of eccentricity farther out, which is 10 degrees of diameter.
        off = samples("--gaze-uncertainty", "--gaze-accuracy", "4", "--gaze-precision", "1")
        self.assertEqual(off, samples("--region-angles", "15.2,27"))
        self.assertGreater(off, samples())
        self.assert_refused(["plan", "--counts", *AT, "--gaze-uncertainty"], ["--gaze-at", "give --gaze-accuracy"])
        self.assert_refused(["plan", "--counts", *AT, "--gaze-accuracy", "4"], ["add --gaze-uncertainty"])

    def test_lost_blur_is_said(self):
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=1)))

        def said(scene, *options):
            return self.run_ok("render", scene, *AT, "--frames", "1", "--quiet", "--overwrite", "-o", "out/f.png", *options).stderr

        lens = ["--aperture", "f/1.0", "--focus-distance", "1.5"]
        self.assertIn("blur of the lens is missing there", said("glide.gltf", "--filter", "guided", *lens))
        self.assertIn("blur of the shutter is missing there", said("glide.gltf", "--filter", "guided", "--shutter", "180deg"))
        self.assertIn("blur of lens and shutter", said("glide.gltf", "--filter", "guided", "--shutter", "180deg", *lens))
        self.assertEqual(said("glide.gltf", "--filter", "linear", "--shutter", "180deg", *lens), "")
        self.assertEqual(said("glide.gltf", "--filter", "guided"), "")
        self.assertEqual(said("box.gltf", "--filter", "guided", "--shutter", "180deg"), "")  # nothing moves

    def test_unknown_names(self):
        for option, text in (("--filter", "unknown filter 'x'; Known: none, linear"), ("--falloff", "unknown falloff 'x'; Known: regions"),
                             ("--preset", "unknown preset 'x'; Known: paper")):
            self.assert_refused(["plan", "--counts", *AT, option, "x"], [text])
        self.write("x.toml", "qqqqqqqqqqqqqqqq = 1\n")
        line = self.assert_refused(["plan", "--counts", "--config", "x.toml"], ["unknown key 'qqqqqqqqqqqqqqqq'; 'gazetrace plan"])
        self.assertNotIn("Known", line)
        line = self.assert_refused(["plan", "--qqqqqqqqqqqqqqqq"], ["unknown option '--qqqqqqqqqqqqqqqq'; see"])
        self.assertNotIn("Known", line)


if __name__ == "__main__":
    harness.main()
