# SPDX-License-Identifier: Apache-2.0
"""plan --model-gain: needs a screen and gaze only, and says what it leaves out."""

import json

import harness

WIDE = ["--screen", "paper", "--size", "1920x1080"]
NARROW = ["--screen-px", "256,144", "--screen-ppd", "12", "--size", "256x144"]
SMALL = ["--size", "64x36"]  # of the log's own screen


class ModelGain(harness.CliTest):
    def gain(self, *arguments):
        return json.loads(self.run_ok("plan", "--model-gain", "--json", *arguments).stdout)

    def test_json(self):
        wide = self.gain(*WIDE, "--gaze-at", "0.5,0.5")
        self.assertEqual([kind["noise"] for kind in wide["gains"]], ["white", "cut_below_4_cpd", "cut_below_2_cpd", "white_even_resolution"])
        self.assertAlmostEqual(wide["width_deg"], 61.1, delta=0.1)
        self.assertFalse(wide["content_and_masking"])
        for kind in wide["gains"]:
            self.assertAlmostEqual(kind["gain"], kind["uniform_spp"] / kind["allocated_spp"], delta=1e-9 * kind["gain"])
        white, *cut, even = [kind["gain"] for kind in wide["gains"]]
        self.assertGreater(white, 1.2)
        self.assertTrue(all(gain > white for gain in cut))
        self.assertTrue(1.1 < even < white)
        # A field of 21 degrees has less periphery.
        narrow = self.gain(*NARROW, "--gaze-at", "0.5,0.5")["gains"][0]["gain"]
        self.assertGreater(narrow, 1)
        self.assertLess(narrow, white)

    def test_frames_of_a_log_are_averaged(self):
        self.write("gaze.csv", harness.moving_gaze(samples=120))
        few = self.gain(*SMALL, "--gaze", "gaze.csv", "--frames", "1-3")
        self.assertEqual((few["frames"], few["frames_with_gaze"]), (3, 3))
        many = self.gain(*SMALL, "--gaze", "gaze.csv", "--frames", "1-26")
        self.assertEqual((many["frames"], many["frames_with_gaze"]), (24, 26))

    def test_text(self):
        text = self.run_ok("plan", "--model-gain", *NARROW, "--gaze-at", "0.5,0.5").stdout
        for words in ("white noise", "below 4 cycles a degree", "below 2 cycles a degree", "times", "Content and masking are left out"):
            self.assertIn(words, text)

    def test_refusals(self):
        self.assert_refused(["plan", "--model-gain", *NARROW], ["no frame has gaze", "--gaze-at"])
        result = self.run_program("plan", "--model-gain", "--counts", *NARROW, "--gaze-at", "0.5,0.5")
        self.assertEqual(result.returncode, 2)


if __name__ == "__main__":
    harness.main()
