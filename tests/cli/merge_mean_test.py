# SPDX-License-Identifier: Apache-2.0
"""`gazetrace merge --mean`: the mean of renders with different seeds, held against one that Python computes."""

import json
import math

import harness
from exr_reader import Exr

COURTYARD = [str(harness.SOURCE / "scenes/courtyard/courtyard.gltf"), "--env",
             str(harness.SOURCE / "scenes/courtyard/dusk.hdr"), "--camera", "walk", "--size", "48x27", "--fps", "24",
             "--screen", "paper", "--exposure", "0", "--quiet", "--exr-compression", "none", "--exr-pixels", "float",
             "--accumulate", "off"]
UNIFORM = ["--sampling", "uniform", "--filter", "none"]
# Fractions of samples, so that each seed gives other pixels one more.
FOVEATED = ["--region-samples", "8,4,2", "--spp", "1.7", "--gaze-at", "0.4,0.5", "--filter", "none"]
MEANS = ["albedo", "normal", "emission", "background", "diffuse_direct"]
FIRST = ["depth", "position", "forward", "eccentricity", "crypto_object"]
LAYERS = ["samples", "variance", *MEANS, *FIRST]
ROUNDING = 2.0 ** -23


class MergeMean(harness.CliTest):
    def render(self, name, seed, *options, frames="9-10"):
        self.run_ok("render", *COURTYARD, "--frames", frames, "--seed", str(seed), *options, "-o", f"{name}/f.####.exr")
        return f"{name}/f.####.exr"

    def merge(self, name, renders, *options):
        return self.run_ok("merge", "--mean", *renders, "-o", f"{name}/f.####.exr", *options)

    def exr(self, name, frame=9):
        return Exr(self.folder / name / f"f.{frame:04d}.exr")

    def values(self, exr, channel):
        return [value for row in exr.channel(channel) for value in row]

    def weighted(self, renders, channel, power=1):
        """The sum of w^power x over the renders, divided by (the sum of w)^power, pixel by pixel."""
        weights = [self.values(render, "samples.X") for render in renders]
        values = [self.values(render, channel) for render in renders]
        return [sum(w ** power * x for w, x in zip(ws, xs)) / sum(ws) ** power
                for ws, xs in zip(zip(*weights), zip(*values))]

    def assert_close(self, found, expected, units=1):
        self.assertEqual(len(found), len(expected))
        for a, b in zip(found, expected):
            self.assertLessEqual(abs(a - b), units * ROUNDING * abs(b) + 1e-37)

    def assert_is_mean(self, mean, renders, units=1):
        for channel in mean.types:
            layer = channel.split(".")[0] if "." in channel else ""
            with self.subTest(channel=channel):
                if layer == "samples":
                    expected = [sum(n) for n in zip(*(self.values(render, channel) for render in renders))]
                    self.assert_close(self.values(mean, channel), expected)
                elif layer == "variance":
                    self.assert_close(self.values(mean, channel), self.weighted(renders, channel, 2), units)
                elif layer in MEANS or not layer:
                    self.assert_close(self.values(mean, channel), self.weighted(renders, channel), units)
                else:
                    self.assertEqual(mean.channel(channel, bits=True), renders[0].channel(channel, bits=True))

    def test_every_layer_is_what_python_finds(self):
        renders = [self.render(f"s{seed}", seed, *FOVEATED, "--aov", ",".join(LAYERS)) for seed in (1, 2, 3)]
        told = self.merge("mean", renders)
        self.assertIn("mean of 3 renders, frames 9-10", told.stdout)
        for frame in (9, 10):
            parts = [self.exr(f"s{seed}", frame) for seed in (1, 2, 3)]
            counts = [self.values(part, "samples.X") for part in parts]
            self.assertGreater(sum(a != b for a, b in zip(counts[0], counts[1])), 20, "weights differ by pixel and seed")
            mean = self.exr("mean", frame)
            self.assertEqual(set(mean.types), set(parts[0].types))
            self.assert_is_mean(mean, parts)
            self.assertEqual(mean.text("gazetrace:mean_of").count(":"), 3)
            self.assertEqual(mean.text("gazetrace:camera"), parts[0].text("gazetrace:camera"))

    def test_weights_are_the_samples_of_the_header(self):
        renders = [self.render("few", 1, *UNIFORM, "--spp", "2"), self.render("many", 2, *UNIFORM, "--spp", "6")]
        self.merge("mean", renders)
        mean, few, many = (self.exr(name) for name in ("mean", "few", "many"))
        self.assertEqual(mean.text("gazetrace:samples_per_pixel"), "8")
        self.assertEqual(mean.text("gazetrace:mean_of"), "1:2 2:6")
        for channel in "RGB":
            expected = [(2 * a + 6 * b) / 8 for a, b in zip(self.values(few, channel), self.values(many, channel))]
            self.assert_close(self.values(mean, channel), expected)

    def test_a_mean_goes_on(self):
        renders = [self.render(f"s{seed}", seed, *UNIFORM, "--spp", str(seed), "--aov", "samples,variance") for seed in (1, 2, 4)]
        self.merge("whole", renders)
        self.merge("grown", renders[:2])
        half = (self.folder / "grown/f.0009.exr").read_bytes()
        self.merge("grown", renders[:2], "--resume")
        self.assertEqual((self.folder / "grown/f.0009.exr").read_bytes(), half, "nothing was to be added")
        # As after an interruption between the frames: the first has the third render, and the second has not.
        self.merge("ahead", renders)
        (self.folder / "grown/f.0009.exr").write_bytes((self.folder / "ahead/f.0009.exr").read_bytes())
        self.merge("grown", renders, "--resume")
        self.merge("mean-of-mean", ["ahead/f.####.exr", self.render("s5", 5, *UNIFORM, "--spp", "5", "--aov", "samples,variance")])
        for frame in (9, 10):
            parts = [self.exr(f"s{seed}", frame) for seed in (1, 2, 4)]
            self.assert_is_mean(self.exr("whole", frame), parts)
            self.assert_is_mean(self.exr("grown", frame), parts, units=3)
            self.assert_is_mean(self.exr("mean-of-mean", frame), [*parts, self.exr("s5", frame)], units=3)
            self.assertEqual(self.exr("grown", frame).text("gazetrace:mean_of"), "1:1 2:2 4:4")

    def test_a_mean_that_goes_on_keeps_its_frames_alike(self):
        options = [*UNIFORM, "--spp", "1"]
        renders = [self.render(f"s{seed}", seed, *options) for seed in (1, 2)]
        short = self.render("short", 3, *options, frames="9")
        self.merge("mean", renders)
        before = {path.name: path.read_bytes() for path in (self.folder / "mean").iterdir()}
        self.assert_refused(["merge", "--mean", short, "-o", "mean/f.####.exr", "--resume"], ["lack frames 10", "--allow-missing"])
        self.assertEqual({path.name: path.read_bytes() for path in (self.folder / "mean").iterdir()}, before)
        self.merge("mean", [short], "--resume", "--allow-missing")
        record = json.loads((self.folder / "mean/f.run.json").read_text())
        self.assertEqual(record["frames"], "9-10")
        self.assertEqual(sorted(record["files"]), ["f.0009.exr", "f.0010.exr"])
        self.assertEqual(record["facts"]["mean_of"], ", ".join([*renders, short]))
        self.assertEqual([self.exr("mean", frame).text("gazetrace:mean_of") for frame in (9, 10)], ["1:1 2:1 3:1", "1:1 2:1"])

    def test_parts_of_a_file_and_packed_halves(self):
        options = [*UNIFORM, "--spp", "2", "--aov", "depth,samples,crypto_object", "--exr-parts", "multi", "--exr-pixels",
                   "half", "--exr-compression", "dwaa"]
        renders = [self.render(f"s{seed}", seed, *options, frames="9") for seed in (1, 2)]
        self.merge("mean", renders)
        one = self.render("one", 3, *UNIFORM, "--spp", "2", frames="9")
        self.assert_refused(["merge", "--mean", renders[0], one, "-o", "m/f.####.exr"], ["other settings"])
        scores = json.loads(self.run_ok("compare", "mean/f.####.exr", "s1/f.####.exr", "--metrics", "relmse", "--json").stdout)
        self.assertTrue(math.isfinite(scores["sequence"][0]["scores"][0]["value"]))

    def test_a_mean_has_the_record_of_its_renders(self):
        renders = [self.render(f"s{seed}", seed, *FOVEATED, "--aov", "samples", frames="9") for seed in (1, 2)]
        self.merge("mean", renders)
        record = json.loads((self.folder / "mean/f.run.json").read_text())
        self.assertIn("courtyard.gltf", record["config_toml"])
        self.assertEqual(list(record["files"]), ["f.0009.exr"])
        # The screen, by which eccentricities are known, is that of the record.
        self.run_ok("compare", "mean/f.####.exr", "s1/f.####.exr", "--metrics", "flip")
        (self.folder / "s1/f.run.json").unlink()
        (self.folder / "s2/f.run.json").unlink()
        self.assertIn("the mean has none", self.merge("bare", renders).stderr)

    def test_what_does_not_belong_together(self):
        a = self.render("a", 1, *UNIFORM, "--spp", "2", "--map", "a/map.####.exr")
        b = self.render("b", 2, *UNIFORM, "--spp", "2")
        again = self.render("again", 1, *UNIFORM, "--spp", "3")
        bounces = self.render("bounces", 3, *UNIFORM, "--spp", "2", "--bounces", "2")
        short = self.render("short", 3, *UNIFORM, "--spp", "2", frames="9")
        unstated = [self.render(f"u{seed}", seed, *FOVEATED) for seed in (1, 2)]
        self.merge("mean", [a, b])
        for renders, words in (([a, again], ["seed 1", "same samples", "--seed"]), ([a, a], ["seed 1"]),
                               ([a, bounces], ["other settings"]), ([a, short], ["lack frames 10", "--allow-missing"]),
                               (["mean/f.####.exr", b], ["seed 2"]), (unstated, ["how many samples", "--aov samples"]),
                               ([a], ["two renders"]), ([a, b], ["exists already", "--resume"]), ([a, "none/f.####.exr"], ["none"]),
                               ([a, "a/map.####.exr"], ["map.0009.exr", "does not state the job"])):
            out = "mean" if words[0].startswith("exists") else "out"
            with self.subTest(renders=renders):
                self.assert_refused(["merge", "--mean", *renders, "-o", f"{out}/f.####.exr"], words)
        self.assert_refused(["merge", "--mean", a, b], ["--output"])
        self.assert_refused(["merge", "--mean", a, b, "-o", "m.png"], [".exr"])
        self.assert_refused(["merge", "--mean", a, b, "-o", a, "--overwrite"], ["replace an input"])
        same = a.replace("####", "%04d")  # the same files, spelled otherwise
        self.assert_refused(["merge", "--mean", a, b, "-o", same, "--overwrite"], ["replace an input"])
        beside = a.replace(".####", "_####")  # a record of the same name
        self.assert_refused(["merge", "--mean", a, b, "-o", beside, "--overwrite"], ["record of a render"])
        self.assert_refused(["merge", "--mean", b, "-o", a, "--resume"], ["is a render"])
        for idle in (["--threads", "2"], ["--trust-files"]):
            self.assert_refused(["merge", "--mean", a, b, "-o", "out/f.####.exr", *idle], ["leave out", idle[0]])
        self.assert_refused(["merge", "a", "b"], ["--mean"])
        self.assertIn("lack frames 10", self.merge("some", [a, short], "--allow-missing").stderr)
        self.assertEqual(self.exr("some", 10).text("gazetrace:mean_of"), "1:2")


if __name__ == "__main__":
    harness.main()
