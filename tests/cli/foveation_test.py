# SPDX-License-Identifier: Apache-2.0
"""Fall-off models, budgets and presets from the command line."""

import csv
import json

import harness

GAZE = [*harness.SCREEN, "--size", "64x36", "--gaze-at", "0.4,0.5"]  # a still, whose records are named after it
TABLE = "ecc_deg,density\n0,1\n5,0.5\n30,0.1\n"


def config(text):
    """The settings that --print-config wrote."""
    lines = [line.split(" = ", 1) for line in text.splitlines() if " = " in line and not line.startswith("#")]
    return {name: value.strip('"') for name, value in lines}


class Foveation(harness.CliTest):
    def counts(self, *arguments, at=GAZE):
        return json.loads(self.run_ok("plan", "--counts", "--json", *at, *arguments).stdout)[0]

    def names(self, family):
        return json.loads(self.run_ok("list", family, "--json").stdout)[family]

    def print_config(self, *arguments):
        return self.run_ok("render", *arguments, "--print-config").stdout

    def test_every_model_meets_its_budget_and_renders(self):
        self.write("table.csv", TABLE)
        models = [member["name"] for member in self.names("densities")] + ["table.csv"]
        self.assertIn("geisler-perry", models)
        self.write("box.gltf", json.dumps(harness.box_gltf()))
        for model in models:
            with self.subTest(model=model):
                arguments = ["--density", model, "--spp", "1.5"]
                traced = self.counts(*arguments)["traced_samples"]
                self.assertAlmostEqual(traced, 1.5 * 64 * 36, delta=1.1)
                model = model.removesuffix(".csv")
                self.run_ok("render", "box.gltf", *GAZE, *arguments, "-o", f"{model}/f.exr", "--map", f"{model}/map.exr",
                            "--quiet")
                with open(self.folder / model / "f.timing.csv", newline="") as file:
                    row = next(csv.DictReader(file))
                self.assertEqual(int(row["samples"]), traced)
                regions = [name[:-7] for name in row if name.endswith("_pixels")]
                self.assertEqual(sum(int(row[f"{name}_samples"]) for name in regions), traced)
                self.assertEqual(sum(int(row[f"{name}_pixels"]) for name in regions), 64 * 36)

    def test_slopes_and_saccades(self):
        fine = [*harness.SCREEN, "--size", "640x360", "--gaze-at", "0.4,0.5"]
        steep = self.counts(*fine, "--density", "mar", at=[])["traced_ratio"]
        flat = self.counts(*fine, "--density", "mar:slope=0.01", at=[])["traced_ratio"]
        self.assertGreater(steep, 1.2 * flat)
        self.write("gaze.csv", harness.gaze_csv(
            # Half a second still, then 20 ms of 400 deg/s, then still again.
            f"{i * 2_000_000},{0.3 + 0.4 * min(max((i - 250) / 10, 0), 1):.4f},0.5,ok,cyclopean" for i in range(500)))
        plan = json.loads(self.run_ok("plan", "--gaze", "gaze.csv", *harness.SCREEN, "--size", "64x36", "--fps", "250",
                                      "--density", "acuity", "--eye", "0,0,3", "--target", "0,0,0", "--json").stdout)
        self.assertTrue(any(frame["eye_in_saccade"] for frame in plan["frames"]))
        self.assertFalse(plan["frames"][50]["eye_in_saccade"])

    def test_what_is_refused(self):
        self.write("bad.csv", "ecc_deg,density\n0,1\n10,0.5\n5,0.2\n")
        self.write("over.csv", "ecc_deg,density\n0,1.5\n")
        self.write("empty.csv", "ecc_deg,density\n")
        self.write("head.csv", "0,1\n")
        for words, *arguments in [
            ("bad.csv:4: eccentricity 5 does not come after 10", "--density", "bad.csv"),
            ("over.csv:2", "--density", "over.csv"),
            ("no points", "--density", "empty.csv"),
            ("ecc_deg,density", "--density", "head.csv"),
            ("this option is gone; give --spp", "--budget-samples", "5"),
            ("--spp", "--spp", "0"),
            ("--max-block", "--max-block", "12"),
            ("contrast", "--density", "geisler-perry:contrast=0.01"),
            ("inner=5 is not less than outer=5", "--density", "linear:outer=5"),
            ("give it with its --density", "--falloff-ramp", "5,5,0.1"),
            ("did you mean 'adaptive'", "--sampling", "adaptiv"),
            ("did you mean 'geisler-perry'", "--density", "geisler-pery"),
            ("relative-to=display", "--density", "mar:foveal=0,relative-to=fovea"),
            ("did you mean 'paper'", "--preset", "papr"),
        ]:
            with self.subTest(arguments=arguments):
                result = self.run_program("plan", "--counts", *GAZE, *arguments)
                self.assertEqual(result.returncode, 2)
                self.assertIn(words, result.stderr)
                self.assertEqual(result.stderr.count("\n"), 1)

    def test_the_filter_by_itself_suits_the_frame(self):
        self.write("box.gltf", json.dumps(harness.box_gltf()))
        for i, (expected, *more) in enumerate([
                ("guided",), ("guided", "--sampling", "uniform", "--spp", "1"), ("guided", "--shutter", "0.5"),
                ("guided", "--sampling", "uniform", "--spp", "1", "--accumulate", "window"),
                ("none", "--filter", "none")]):
            self.run_ok("render", "box.gltf", *GAZE, *more, "-o", f"{i}/f.exr", "--quiet")
            record = json.loads(next((self.folder / str(i)).glob("*run*.json")).read_text())
            self.assertEqual(config(record["config_toml"])["filter"], expected, more)
        # Without gaze all frames are uniform, whatever the sampling.
        self.run_ok("render", "box.gltf", "--size", "64x36", "--spp", "2", "-o", "eyeless/f.exr", "--quiet")
        record = json.loads((self.folder / "eyeless/f.run.json").read_text())
        self.assertEqual(config(record["config_toml"])["filter"], "guided")

    def test_presets_are_what_the_list_says(self):
        presets = {member["name"]: member["description"] for member in self.names("presets")}
        self.assertEqual(list(presets), ["paper", "paper-radius", "default", "reference"])
        for name, description in presets.items():
            values = config(self.print_config("--preset", name))
            for setting in description.split(": ")[-1].split(" "):
                option, _, value = setting.partition("=")
                shown = values[option].strip("[]").replace(", ", ",")
                self.assertEqual(shown, value, f"{name}: {option}")
        plain = config(self.print_config())
        default = config(self.print_config("--preset", "default"))
        self.assertEqual({k: v for k, v in plain.items() if k != "preset"}, {k: v for k, v in default.items() if k != "preset"})
        # The paper to the sample, in either reading.
        paper = ["--screen", "paper", "--size", "3840x2160", "--gaze-at", "0.5,0.5", "--json"]
        for name, pixels in (("paper", [68488, 673600, 7552312]), ("paper-radius", [273988, 2694376, 5326036])):
            frame = json.loads(self.run_ok("plan", "--counts", "--preset", name, *paper).stdout)[0]
            self.assertEqual([region["pixels"] for region in frame["regions"]], pixels)

    def test_presets_lie_below_the_options_of_their_own_place(self):
        self.assertEqual(config(self.print_config("--preset", "paper", "--bounces", "7"))["bounces"], "7")
        self.assertEqual(config(self.print_config("--bounces", "7", "--preset", "paper"))["bounces"], "7")
        self.write("job.toml", "bounces = 5\nregion-eccentricities = [1, 2]\n")
        both = config(self.print_config("--config", "job.toml", "--preset", "paper"))
        # A preset on the command line stands above the file.
        self.assertEqual((both["bounces"], both["region-eccentricities"], both["sampling"]), ("3", "[2.6, 8.5]", "regions:shape=disc"))
        self.write("job.toml", "bounces = 5\npreset = \"paper\"\nview = \"raw\"\n")
        within = config(self.print_config("--config", "job.toml"))
        self.assertEqual((within["bounces"], within["view"], within["sampling"]), ("5", "raw", "regions:shape=disc"))
        text = self.print_config("--preset", "paper", "--spp", "3")
        self.write("again.toml", text)
        self.assertEqual(self.print_config("--config", "again.toml"), text)


if __name__ == "__main__":
    harness.main()
