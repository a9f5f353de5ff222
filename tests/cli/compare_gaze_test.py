# SPDX-License-Identifier: Apache-2.0
"""Where `gazetrace compare` takes the gaze from, when it was, and where the frame lies on the screen."""

import json

import harness


def grey(value):
    return lambda x, y: (value, value, value)


class CompareGaze(harness.CliTest):
    def scores(self, *arguments):
        self.run_ok("compare", *arguments, "--json", "out.json")
        result = json.loads((self.folder / "out.json").read_text())
        (self.folder / "out.json").unlink()
        return {score["metric"]: score for score in result["sequence"][0]["scores"]}, result

    def render(self, folder, *more):
        self.run_ok("render", "box.gltf", "--size", "64x36", "--frames", "1-3", "--fps", "24", "--quiet", "--accumulate", "off",
                    "--exposure", "0", *harness.SCREEN, "-o", f"{folder}/p.####.exr", "-o", f"{folder}/p.####.png", *more)

    def test_gaze_of_the_test_where_the_reference_has_none(self):
        self.write("gaze.csv", harness.moving_gaze())
        self.render("none", "--sampling", "uniform", "--spp", "8", "--seed", "1")
        self.render("same", "--sampling", "uniform", "--spp", "8", "--seed", "1", "--gaze", "gaze.csv")
        self.render("fov", "--seed", "2", "--gaze", "gaze.csv")
        for suffix in ("exr", "png"):
            found, result = self.scores(f"none/p.####.{suffix}", f"fov/p.####.{suffix}", "--metrics", "flip,fovvideovdp")
            wanted, _ = self.scores(f"same/p.####.{suffix}", f"fov/p.####.{suffix}", "--metrics", "flip,fovvideovdp")
            self.assertEqual([frame["gaze"] for frame in result["frames"]], ["in-flight"] * 3)
            self.assertIn("the test's", result["conditions"]["gaze"])
            for name in found:
                self.assertIsNotNone(found[name]["bands"]["0-2.6"])
                self.assertEqual(found[name], wanted[name])

    def test_two_gazes_must_agree(self):
        fixed = ["--sampling", "uniform", "--spp", "1", "--seed", "1"]
        self.render("left", *fixed, "--gaze-at", "0.25,0.5")
        self.render("right", *fixed, "--gaze-at", "0.75,0.5")
        for suffix in ("exr", "png"):
            pair = [f"left/p.####.{suffix}", f"right/p.####.{suffix}", "--metrics", "flip"]
            self.assert_refused(["compare", *pair], ["right/p.0001", "0.7500,0.5000", "0.2500,0.5000", "--anyway"])
            _, result = self.scores(*pair, "--anyway")
            self.assertIn("the reference's", result["conditions"]["gaze"])
            self.scores(*pair, "--gaze-at", "0.5,0.5")

    def test_a_log_needs_the_time_of_the_pictures(self):
        self.write("gaze.csv", harness.moving_gaze())
        for name, value in (("a", 100), ("b", 110)):
            self.write(f"{name}.png", harness.png(64, 36, grey(value)))
            for frame in (1, 2, 12):
                self.write(f"{name}/p.{frame:02}.png", harness.png(64, 36, grey(value)))
        log = ["--metrics", "mse", "--gaze", "gaze.csv", *harness.SCREEN]
        self.assert_refused(["compare", "a.png", "b.png", *log], ["--gaze", "single picture", "--gaze-at"])
        self.assert_refused(["compare", "a.png", "b.png", *log, "--fps", "24"], ["single picture"])
        self.assert_refused(["compare", "a/p.##.png", "b/p.##.png", *log], ["--gaze", "--fps"])
        self.scores("a/p.##.png", "b/p.##.png", *log, "--fps", "24")
        # One frame of a sequence has its time, too: at 24 a second the twelfth is of 0.479 s, where u is 0.482.
        self.run_ok("compare", "a/p.##.png", "b/p.##.png", "--frames", "12", "--fps", "24", "--maps", "log", "--map-overlay",
                    *log)
        self.run_ok("compare", "a/p.##.png", "b/p.##.png", "--frames", "12", "--metrics", "mse", "--gaze-at", "0.482,0.5",
                    "--maps", "fixed", "--map-overlay", *harness.SCREEN)
        self.assertEqual((self.folder / "log/mse.0012.png").read_bytes(), (self.folder / "fixed/mse.0012.png").read_bytes())

    def test_frames_off_the_middle_of_the_screen(self):
        # 1 cm a pixel at 60 cm: a frame in a corner is seen at a slant, with more pixels a degree and at smaller angles.
        self.write("a.png", harness.png(64, 36, grey(100)))
        self.write("b.png", harness.png(64, 36, lambda x, y: grey(100 if (x // 3 + y // 3) % 2 else 112)(x, y)))
        screen = ["--screen-px", "256,144", "--screen-cm", "256,144", "--screen-distance-cm", "60", "--metrics", "fovvideovdp"]

        def jod(left, top, u):
            scores, _ = self.scores("a.png", "b.png", *screen, "--frame-rect", f"{left},{top},64,36", "--gaze-at",
                                    f"{(left + 64 * u) / 256},{(top + 18) / 144}")
            return scores["fovvideovdp"]["value"]

        middle = jod(96, 54, 0.25)
        corner = jod(0, 0, 0.25)
        self.assertGreater(abs(middle - corner), 0.05)
        # Up and down mirror each other, and so do left and right with the gaze mirrored: but for the pattern's phase.
        self.assertAlmostEqual(corner, jod(0, 108, 0.25), delta=0.1 * abs(middle - corner))
        self.assertNotAlmostEqual(corner, jod(192, 0, 0.25), delta=0.02)
        self.assertAlmostEqual(corner, jod(192, 0, 0.75), delta=0.1 * abs(middle - corner))


if __name__ == "__main__":
    harness.main()
