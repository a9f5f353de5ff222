# SPDX-License-Identifier: Apache-2.0
"""`gazetrace compare` from outside: numbers worked out by hand, sequences of our own, and what is refused."""

import csv
import json
import math

import harness


def grey(value):
    return lambda x, y: (value, value, value)


class Compare(harness.CliTest):
    def compare(self, *arguments):
        self.run_ok("compare", *arguments, "--json", "out.json", "--overwrite")
        result = json.loads((self.folder / "out.json").read_text())
        return {score["metric"]: score for score in result["sequence"][0]["scores"]}, result

    def render(self, folder, *more):
        self.write("gaze.csv", harness.moving_gaze())
        self.run_ok("render", "box.gltf", "--gaze", "gaze.csv", "--size", "64x36", "--frames", "1-3", "--fps", "24",
                    "-o", f"{folder}/p.####.exr", "-o", f"{folder}/p.####.png", "--quiet", *harness.SCREEN, *more)

    def test_uniform_pictures_by_hand(self):
        self.write("a.png", harness.png(32, 32, grey(100)))
        self.write("b.png", harness.png(32, 32, grey(110)))
        scores, _ = self.compare("a.png", "b.png", "--metrics", "psnr,mse,smape")
        light = [((v / 255 + 0.055) / 1.055) ** 2.4 for v in (100, 110)]
        self.assertAlmostEqual(scores["psnr"]["value"], -20 * math.log10(10 / 255), 5)
        self.assertAlmostEqual(scores["mse"]["value"], (light[1] - light[0]) ** 2, 8)
        self.assertAlmostEqual(scores["smape"]["value"], 2 * (light[1] - light[0]) / sum(light), 5)

    def test_sequences_average_before_the_logarithm(self):
        for frame, value in ((1, 100), (2, 100), (3, 100)):
            self.write(f"a/p.{frame:04}.png", harness.png(32, 32, grey(value)))
            self.write(f"b/p.{frame:04}.png", harness.png(32, 32, grey(value + 10 * frame)))
        scores, result = self.compare("a/p.####.png", "b/p.####.png", "--metrics", "psnr")
        mean = sum((10 * n / 255) ** 2 for n in (1, 2, 3)) / 3
        self.assertAlmostEqual(scores["psnr"]["value"], -10 * math.log10(mean), 5)
        self.assertEqual(scores["psnr"]["worst_frame"], 3)
        self.assertEqual([frame["frame"] for frame in result["frames"]], [1, 2, 3])

    def test_bands_are_in_degrees_around_the_gaze(self):
        # A screen of 36 x 36 cm at 60 cm and 36 pixels: a pixel is 0.95 degrees. The error is within 2 pixels of the gaze.
        self.write("a.png", harness.png(36, 36, grey(100)))
        self.write("b.png", harness.png(36, 36, lambda x, y: grey(110 if abs(x - 8) <= 1 and abs(y - 17) <= 1 else 100)(x, y)))
        screen = ["--screen-px", "36,36", "--screen-cm", "36,36", "--screen-distance-cm", "60"]
        scores, _ = self.compare("a.png", "b.png", "--metrics", "mse", *screen, "--gaze-at", f"{8.5 / 36},{17.5 / 36}")
        near = scores["mse"]["bands"]
        self.assertGreater(near["0-2.6"], 0)
        self.assertEqual(near["5.2-8.5"], 0)
        self.assertEqual(near["17-30"], 0)
        self.assertIsNone(near["60+"])
        self.assertGreater(scores["mse"]["weighted"], scores["mse"]["value"])
        scores, _ = self.compare("a.png", "b.png", "--metrics", "mse", *screen, "--gaze-at", f"{28.5 / 36},{17.5 / 36}")
        self.assertEqual(scores["mse"]["bands"]["0-2.6"], 0)
        self.assertGreater(scores["mse"]["bands"]["17-30"], 0)
        self.assertLess(scores["mse"]["weighted"], scores["mse"]["value"])

    def test_rendered_sequences(self):
        self.render("ref", "--sampling", "uniform", "--spp", "16", "--seed", "1")
        self.render("fov", "--seed", "2")
        metrics = "mse,rmse,relmse,smape,psnr,ssim,flip,hdr_flip,fovvideovdp"
        scores, result = self.compare("ref/p.####.exr", "fov/p.####.exr", "--metrics", metrics, "--csv", "out.csv",
                                      "--maps", "maps")
        self.assertEqual(list(scores), metrics.split(","))
        self.assertAlmostEqual(scores["rmse"]["value"], math.sqrt(scores["mse"]["value"]), 9)
        self.assertTrue(0 < scores["flip"]["value"] < 1)
        self.assertLess(scores["fovvideovdp"]["value"], 10)
        # Screen, gaze and frame rate came with the run.
        self.assertIn("64x36 px", result["conditions"]["screen"])
        self.assertEqual(result["conditions"]["frame rate"], "24")
        with open(self.folder / "ref/p.timing.csv", newline="") as file:
            events = [row["gaze_event"] for row in csv.DictReader(file)]
        self.assertNotIn("none", events)
        # This gaze glides too fast for a fixation.
        self.assertEqual(events, ["saccade"] * 3)
        self.assertEqual([frame["gaze"] for frame in result["frames"]], ["in-flight"] * 3)
        self.assertEqual(result["headline"], "all")
        self.assertIsNotNone(scores["flip"]["bands"]["0-2.6"])
        with open(self.folder / "out.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 3 * len(scores))
        self.assertIn("maps/flip.0002.png", self.files())
        # The same numbers for any number of threads; nothing against itself.
        self.run_ok("compare", "ref/p.####.exr", "fov/p.####.exr", "--metrics", metrics, "--csv", "one.csv", "--threads", "1")
        self.assertEqual((self.folder / "one.csv").read_bytes(), (self.folder / "out.csv").read_bytes())
        scores, _ = self.compare("ref/p.####.exr", "ref/p.####.exr", "--metrics", "mse,flip,fovvideovdp")
        self.assertEqual([scores[name]["value"] for name in ("mse", "flip", "fovvideovdp")], [0, 0, 10])
        # Display images of the same runs give what the linear ones give through the view.
        from_exr, _ = self.compare("ref/p.####.exr", "fov/p.####.exr", "--metrics", "flip")
        from_png, _ = self.compare("ref/p.####.png", "fov/p.####.png", "--metrics", "flip")
        self.assertAlmostEqual(from_exr["flip"]["value"], from_png["flip"]["value"], 3)
        self.assertAlmostEqual(from_exr["flip"]["regions"]["fovea"], from_png["flip"]["regions"]["fovea"], 2)

    def test_frames_are_scored_apart_by_what_the_eye_did(self):
        # At 24 frames a second: rest, a jump of 12 degrees at 0.51 s, rest, lids shut from 1 s to 1.2 s, rest.
        def row(i):
            t = 5 * i
            gone = 1000 <= t < 1200
            u = "" if gone else f"{0.4 if t < 510 else 0.6:.4f}"
            return f"{t * 1_000_000},{u},{'' if gone else '0.5'},{'blink' if gone else 'ok'},cyclopean"

        self.write("gaze.csv", harness.gaze_csv(row(i) for i in range(300)))
        common = ["render", "box.gltf", "--gaze", "gaze.csv", "--size", "64x36", "--frames", "1-36", "--fps", "24", "--quiet",
                  "--sampling", "uniform", *harness.SCREEN]
        self.run_ok(*common, "--spp", "4", "--seed", "1", "-o", "a/p.####.exr", "-o", "a/p.####.png")
        self.run_ok(*common, "--spp", "1", "--seed", "2", "-o", "b/p.####.exr", "-o", "b/p.####.png")
        expected = []
        for frame in range(1, 37):
            t = (frame - 0.5) / 24 * 1000
            expected.append("blink" if 1000 <= t < 1200 else "in-flight" if 510 <= t <= 610 else "fixation")
        for suffix in ("exr", "png"):
            scores, result = self.compare(f"a/p.####.{suffix}", f"b/p.####.{suffix}", "--csv", "out.csv")
            self.assertEqual([frame["gaze"] for frame in result["frames"]], expected)
            self.assertEqual(result["headline"], "fixation")
            parts = {part["gaze"]: part for part in result["sequence"]}
            self.assertEqual(parts["fixation"]["frames"], expected.count("fixation"))
            self.assertEqual(list(scores), ["mse", "relmse", "psnr", "ssim", "flip", "fovvideovdp", "flicker", "temporal_bias"])
            self.assertIn("12 Hz", result["conditions"]["flicker"])
            blinks = {score["metric"]: score for score in parts["blink"]["scores"]}
            self.assertIsNone(blinks["fovvideovdp"]["value"])
            self.assertIsNone(blinks["flip"]["regions"]["fovea"])
            self.assertGreater(blinks["flip"]["value"], 0)
            # The first second is not scored for flicker, nor are blinks.
            self.assertEqual(scores["flicker"]["scored_frames"], sum(name != "blink" for name in expected[23:]))
            self.assertGreater(scores["flicker"]["value"], 0)
        text = self.run_ok("compare", "a/p.####.png", "b/p.####.png", "--metrics", "flip").stdout
        self.assertIn(f"fixation {100 * expected.count('fixation') / 36:.1f} %", text)
        # The log again from outside gives the same classes; a limit is one on fixations.
        again, result = self.compare("a/p.####.png", "b/p.####.png", "--metrics", "mse", "--gaze", "gaze.csv", "--fps", "24")
        self.assertEqual([frame["gaze"] for frame in result["frames"]], expected)
        mean = {part["gaze"]: part["scores"][0]["value"] for part in result["sequence"]}["fixation"]
        for share, code in ((1.0001, 0), (0.9999, 1)):
            limit = f"mse={mean * share!r}"
            self.assertEqual(self.run_program("compare", "a/p.####.png", "b/p.####.png", "--metrics", "mse", "--fail-above",
                                              limit).returncode, code)

    def test_what_needs_gaze_is_refused_without(self):
        for folder, value in (("a", 100), ("b", 110)):
            for frame in range(1, 9):
                self.write(f"{folder}/p.{frame}.png", harness.png(32, 32, grey(value + frame)))
        screen = ["--screen-px", "32,32", "--screen-cm", "36,36", "--screen-distance-cm", "60", "--fps", "8"]
        pair = ["compare", "a/p.#.png", "b/p.#.png", *screen]
        for name in ("flicker", "fovvideovdp"):
            self.assert_refused([*pair, "--metrics", name], [name, "--gaze-at"])
        scores, result = self.compare(*pair[1:])
        self.assertEqual(list(scores), ["mse", "relmse", "psnr", "ssim", "flip"])
        self.assertEqual(result["headline"], "all")
        self.run_ok(*pair, "--metrics", "temporal_bias")
        self.run_ok(*pair, "--metrics", "flicker", "--gaze-at", "0.5,0.5")
        self.assert_refused([*pair, "--metrics", "flicker", "--gaze-at", "0.5,0.5", "--frames", "1-7"], ["7 frames at 8"])
        self.assert_refused([*pair, "--metrics", "temporal_bias", "--frames", "1-3,5-8"], ["missing"])
        self.assert_refused([*pair, "--region-eccentricities", "4.5,1.5"], ["--region-eccentricities"])

    def test_exit_code_over_a_limit(self):
        self.write("a.png", harness.png(32, 32, grey(100)))
        self.write("b.png", harness.png(32, 32, grey(110)))
        self.run_ok("compare", "a.png", "b.png", "--metrics", "flip,psnr", "--fail-above", "flip=0.9", "--fail-below", "psnr=20")
        self.assertEqual(self.run_program("compare", "a.png", "b.png", "--metrics", "flip", "--fail-above", "flip=0.01").returncode, 1)
        self.assertEqual(self.run_program("compare", "a.png", "b.png", "--metrics", "psnr", "--fail-below", "psnr=40").returncode, 1)
        self.assert_refused(["compare", "a.png", "b.png", "--fail-above", "psnr=40"], ["--fail-below"])
        self.assert_refused(["compare", "a.png", "b.png", "--fail-above", "flip"], ["METRIC=VALUE"])
        self.assert_refused(["compare", "a.png", "b.png", "--fail-above", "smape=1"], ["--metrics"])

    def test_what_is_refused(self):
        self.write("a.png", harness.png(32, 32, grey(100)))
        self.write("b.png", harness.png(32, 31, grey(110)))
        self.assert_refused(["compare", "a.png", "b.png"], ["b.png", "32x31", "32x32"])
        self.assert_refused(["compare", "a.png", "none.png"], ["none.png"])
        self.assert_refused(["compare", "a.png", "none.####.png"], ["none.####.png"])
        self.assert_refused(["compare", "a.png", "a.png", "--metrics", "fliip"], ["did you mean 'flip'"])
        self.assert_refused(["compare", "a.png", "a.png", "--metrics", "hdr_flip"], [".exr"])
        self.assert_refused(["compare", "a.png", "a.png", "--metrics", "fovvideovdp"], ["--screen"])
        self.write("c.png", b"no picture")
        self.assert_refused(["compare", "a.png", "c.png"], ["c.png"])
        for frame in (1, 2):
            self.write(f"s/p.{frame}.png", harness.png(16, 16, grey(100)))
        self.write("t/p.1.png", harness.png(16, 16, grey(100)))
        self.assert_refused(["compare", "s/p.#.png", "t/p.#.png"], ["1-2", "--anyway"])
        self.run_ok("compare", "s/p.#.png", "t/p.#.png", "--anyway")
        self.run_ok("compare", "s/p.#.png", "t/p.#.png", "--frames", "1")

    def test_light_that_no_display_has_is_refused(self):
        self.write("a.png", harness.png(32, 32, grey(0)))
        self.write("b.png", harness.png(32, 32, lambda x, y: (110,) * 3 if x // 4 % 2 else (90,) * 3))
        pair = ["compare", "a.png", "b.png", "--screen-px", "32,32", "--screen-cm", "10,10", "--screen-distance-cm", "60",
                "--gaze-at", "0.5,0.5"]
        for option, values in (("--contrast", ("0", "1", "-1000")), ("--peak-cd-m2", ("0", "-200")), ("--ambient-lux", ("-1",)),
                               ("--reflectivity", ("-0.1", "1.5")), ("--relmse-epsilon", ("0", "-0.01"))):
            for value in values:
                self.assert_refused([*pair, f"{option}={value}"], [option, value])
        # 10000 lux make a black of 16 cd/m2.
        self.assert_refused([*pair, "--ambient-lux", "10000", "--peak-cd-m2", "10"], ["10 cd/m2", "black", "--ambient-lux"])
        self.run_ok(*pair, "--contrast", "1.5", "--ambient-lux", "0", "--reflectivity", "1")

    def test_nothing_is_replaced_unasked(self):
        self.write("a.png", harness.png(16, 16, grey(100)))
        test = harness.png(16, 16, grey(110))
        self.write("b.png", test)
        self.write("s/flip.0001.png", test)
        self.write("old.csv", "mine")
        pair = ["compare", "a.png", "b.png", "--metrics", "flip"]
        for option in ("--csv", "--json"):
            self.assert_refused([*pair, option + "=old.csv"], ["old.csv", "--overwrite"])
            for more in ([], ["--overwrite"]):
                self.assert_refused([*pair, option + "=s/../b.png", *more], ["b.png", "input"])
            self.assert_refused([*pair, option + "=a.png/out"], ["a.png", "cannot be made"])
        self.assert_refused([*pair, "--csv", "x.json", "--json", "./x.json"], ["two outputs"])
        sequence = ["compare", "s/flip.####.png", "s/flip.####.png", "--metrics", "flip", "--maps", "s"]
        self.assert_refused([*sequence, "--overwrite"], ["flip.0001.png", "input"])
        self.assertEqual((self.folder / "b.png").read_bytes(), test)
        self.assertEqual((self.folder / "s/flip.0001.png").read_bytes(), test)
        self.assertEqual((self.folder / "old.csv").read_text(), "mine")
        self.run_ok(*pair, "--csv", "old.csv", "--overwrite", "--maps", "maps")
        self.assertIn("flip", (self.folder / "old.csv").read_text())
        self.assert_refused([*pair, "--maps", "maps"], ["maps/flip.0000.png", "--overwrite"])

    def test_views_must_agree(self):
        self.render("a", "--spp", "1", "--sampling", "uniform")
        self.render("b", "--spp", "1", "--sampling", "uniform", "--preset", "paper")
        self.assert_refused(["compare", "a/p.####.png", "b/p.####.png"], ["was shown through", "--anyway"])
        self.run_ok("compare", "a/p.####.png", "b/p.####.png", "--anyway", "--metrics", "flip")

    def test_maps_with_gaze_and_regions(self):
        self.render("a", "--spp", "4", "--sampling", "uniform", "--seed", "1")
        self.render("b", "--spp", "1", "--sampling", "uniform", "--seed", "2")
        pair = ["compare", "a/p.####.exr", "b/p.####.exr", "--metrics", "flip,fovvideovdp"]
        self.run_ok(*pair, "--maps", "plain")
        self.run_ok(*pair, "--maps", "drawn", "--map-overlay")
        for name in ("flip.0001.png", "fovvideovdp.0003.png"):
            self.assertNotEqual((self.folder / "plain" / name).read_bytes(), (self.folder / "drawn" / name).read_bytes())

    def test_light_of_hdr_displays(self):
        # 8-bit codes as PQ: FovVideoVDP and FLIP read them as light, which the peak bounds.
        self.write("a.png", harness.png(32, 32, lambda x, y: (130,) * 3 if x // 4 % 2 else (150,) * 3))
        self.write("b.png", harness.png(32, 32, lambda x, y: (140,) * 3 if x // 4 % 2 else (150,) * 3))
        screen = ["--screen-px", "32,32", "--screen-cm", "10,10", "--screen-distance-cm", "60", "--gaze-at", "0.5,0.5"]
        pair = ["a.png", "b.png", "--metrics", "flip,mse,fovvideovdp", *screen]
        values = {}
        for name, more in (("srgb", []), ("pq", ["--response", "pq", "--peak-cd-m2", "1000"]),
                           ("dim", ["--response", "pq", "--peak-cd-m2", "20"])):
            scores, _ = self.compare(*pair, *more)
            values[name] = {metric: scores[metric]["value"] for metric in scores}
        self.assertNotAlmostEqual(values["srgb"]["fovvideovdp"], values["pq"]["fovvideovdp"], 3)
        # PQ 130 is 103 cd/m2 and more: all of it is a dim display's white.
        self.assertEqual([values["dim"][name] for name in ("flip", "mse", "fovvideovdp")], [0, 0, 10])

    def test_exposures_must_agree(self):
        self.render("a", "--exposure", "0", "--spp", "1", "--sampling", "uniform")
        self.render("b", "--exposure", "1", "--spp", "1", "--sampling", "uniform")
        self.assert_refused(["compare", "a/p.####.png", "b/p.####.png"], ["stops", "--anyway"])
        self.assert_refused(["compare", "a/p.####.exr", "b/p.####.exr"], ["stops"])
        scores, _ = self.compare("a/p.####.exr", "b/p.####.exr", "--anyway", "--metrics", "flip")
        self.assertEqual(scores["flip"]["value"], 0)
        scores, _ = self.compare("a/p.####.png", "b/p.####.png", "--anyway", "--metrics", "flip")
        self.assertGreater(scores["flip"]["value"], 0.01)


if __name__ == "__main__":
    harness.main()
